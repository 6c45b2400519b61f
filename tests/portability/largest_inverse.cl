// Computes the largest of the work-items' numbers, which are inverted, by an atomic maximum in local memory.
//   out    a number, before the launch 0; expected: ~n
__kernel void defect(__global uint *out, uint n) {
    __local uint largest;
    if (get_local_id(0) == 0) largest = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    atomic_max(&largest, ~(out[get_local_id(0)] + n));
    barrier(CLK_LOCAL_MEM_FENCE);
    out[get_local_id(0)] = largest;
}
