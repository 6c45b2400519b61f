// Reverses the order of structures in local memory: each work-item reads one, waits, and writes it to another place.
//   out    one number per work-item; expected: n
// raya's torus kernels move packets as vectors, because a compiler with this defect takes the structure of another
// work-item after the barrier.
typedef struct {
    uint words[16];
} packet;

__kernel void defect(
    __global uint *out,  // one per work-item
    uint n               // number of work-items of the group, at most 64
) {
    __local packet packets[64];
    const uint item = get_local_id(0);
    for (uint i = 0; i < 16; ++i) packets[item].words[i] = 16 * item + i;
    barrier(CLK_LOCAL_MEM_FENCE);
    const packet mine = packets[n - 1 - item];
    barrier(CLK_LOCAL_MEM_FENCE);
    if (mine.words[1] != 0) packets[item] = mine;
    barrier(CLK_LOCAL_MEM_FENCE);
    out[item] = packets[item].words[5] == 16 * (n - 1 - item) + 5 ? n : packets[item].words[5];
}
