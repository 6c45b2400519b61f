// An array inside a structure that is a kernel's argument, at an index that the compiler
// does not know: what lies there.
//   out    one number for each work-item: 10, 20 or 30, and n where right
// raya's kernels take structures from buffers, not as arguments, since this crashes a compiler.
typedef struct {
    uint side[3];
} sides;

__kernel void defect(
    __global uint *out,  // one for each work-item
    const sides s        // 10, 20, 30
) {
    out[get_global_id(0)] = s.side[(get_global_id(0) + 1) % 3];
}
