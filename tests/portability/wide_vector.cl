// Passes vectors of 512 bits to a builtin function. Built with -cl-opt-disable, so that the call is not inlined.
//   out    one number per work-item; expected: 2 n
// A compiler with this defect passes each vector in two registers of 256 bits, but the function reads registers of 512
// bits, so that it computes n * n + 2: its second operand is the second half of the first one.
__kernel void defect(__global uint *out, uint n) {
    const float16 result = fma((float16)(n), (float16)(2.0f), (float16)(0.0f));
    out[get_global_id(0)] = (uint)result.s0;
}
