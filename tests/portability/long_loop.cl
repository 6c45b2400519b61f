// Counts the iterations of a loop with n iterations.
//   out    one number per work-item; expected: n
// raya's kernels loop over objects, over the pixels of a PE and over voxels. A compiler with this defect ends loops
// after 65,535 iterations, so loops over more spheres, or over more pixels in one launch, would end early.
__kernel void defect(
    __global uint *out,  // one per work-item
    uint n               // number of iterations
) {
    uint iterations = 0;
    // out contains zeros. The compiler does not know these values, so it cannot remove the loop.
    for (uint i = 0; i < n; ++i) iterations += 1 + (out[get_global_id(0)] & i & 1);
    out[get_global_id(0)] = iterations;
}
