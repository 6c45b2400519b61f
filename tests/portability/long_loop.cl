// Counts the iterations of a loop of n.
//   out    one number per work-item; expected: n
// raya's kernels loop over objects, over pixels of a PE and over voxels. With this defect, the loops over more than
// 65,535 spheres, or over more pixels of a PE in one launch, end early.
__kernel void defect(
    __global uint *out,  // one per work-item
    uint n               // iterations
) {
    uint turns = 0;
    // out contains zeros, which the compiler cannot know: it must execute the loop
    for (uint i = 0; i < n; ++i) turns += 1 + (out[get_global_id(0)] & i & 1);
    out[get_global_id(0)] = turns;
}
