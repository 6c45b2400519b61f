// n loops of n turns, one within the other: how many turns they took together.
//   out    one number for each work-item: n * n where right
// A count of turns that is kept for a whole kernel, and not for each loop, ends them all early: pixels x rays
// x objects pass any such limit.
__kernel void defect(
    __global uint *out,  // one for each work-item
    uint n               // turns of each loop
) {
    uint turns = 0;
    for (uint i = 0; i < n; ++i)
        // out holds zeros: the loops must be run to know
        for (uint j = 0; j < n; ++j) turns += 1 + (out[get_global_id(0)] & j & 1);
    out[get_global_id(0)] = turns;
}
