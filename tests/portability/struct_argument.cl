// Reads an element of an array inside a structure argument. The index depends on the work-item.
//   out    one number per work-item: 10, 20 or 30; expected: 20 for work-item 0
// raya's kernels read structures from buffers, because a compiler with this defect crashes on structure arguments.
typedef struct {
    uint side[3];
} sides;

__kernel void defect(
    __global uint *out,  // one per work-item
    const sides s        // 10, 20, 30
) {
    out[get_global_id(0)] = s.side[(get_global_id(0) + 1) % 3];
}
