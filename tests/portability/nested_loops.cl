// Counts the iterations of two nested loops with n iterations each.
//   out    one number per work-item; expected: n * n
// A compiler with this defect limits the total iterations of all loops of a work-item. raya's kernels loop over pixels
// x rays x objects and would exceed the limit.
__kernel void defect(
    __global uint *out,  // one per work-item
    uint n               // number of iterations of each loop
) {
    uint iterations = 0;
    for (uint i = 0; i < n; ++i)
        // out contains zeros. The compiler does not know these values, so it cannot remove the loops.
        for (uint j = 0; j < n; ++j) iterations += 1 + (out[get_global_id(0)] & j & 1);
    out[get_global_id(0)] = iterations;
}
