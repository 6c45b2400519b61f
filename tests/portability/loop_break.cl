// Leaves a loop early in the work-items from number n on. The loop is in another one, and a barrier follows.
//   out    a number for each of 4 work-items; expected: 7
__kernel void defect(__global uint *out, uint n) {
    const uint leaves = get_local_id(0) < n ? 0 : 1;
    uint i = 0;
    for (uint k = 0; k < 2; ++k)
        for (i = 0; i < 2; ++i)
            if (leaves) break;
    barrier(CLK_LOCAL_MEM_FENCE);
    out[get_local_id(0)] = leaves ? 7 + i : 5 + i;
}
