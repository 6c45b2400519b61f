// Counts the iterations of two nested loops of n.
//   out    one number per work-item; expected: n * n
// A limit on the iterations of a whole kernel, rather than of each loop, ends the loops early: pixels x rays x objects
// exceed any such limit.
__kernel void defect(
    __global uint *out,  // one per work-item
    uint n               // iterations of each loop
) {
    uint turns = 0;
    for (uint i = 0; i < n; ++i)
        // out contains zeros, which the compiler cannot know: it must execute the loops
        for (uint j = 0; j < n; ++j) turns += 1 + (out[get_global_id(0)] & j & 1);
    out[get_global_id(0)] = turns;
}
