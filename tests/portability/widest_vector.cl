// Passes vectors of 1024 bits, which no register holds, to a builtin function.
//   out    one number per work-item; expected: n
__kernel void defect(__global uint *out, uint n) { out[get_global_id(0)] = (uint)max((ulong16)(n), (ulong16)(1)).s5; }
