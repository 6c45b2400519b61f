// A loop of n turns: how many it took.
//   out    one number for each work-item: n where right
// raya's kernels loop over objects, over pixels of a PE and over voxels: a scene of more than 65,535 spheres, or a PE
// with more pixels than that in one launch, is cut short where this goes wrong.
__kernel void defect(
    __global uint *out,  // one for each work-item
    uint n               // turns
) {
    uint turns = 0;
    // out holds zeros: the loop must be run to know
    for (uint i = 0; i < n; ++i) turns += 1 + (out[get_global_id(0)] & i & 1);
    out[get_global_id(0)] = turns;
}
