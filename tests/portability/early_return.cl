// Returns from the kernel at once if the result is not 0; then searches a private array by a function that returns from
// its loop.
//   out    one number per work-item, before the launch 0; expected: n + 1, where n is a multiple of 7
static uint first_other(const uint *a) {
    for (uint i = 0; i < 3; ++i) {
        uint value = a[i];
        if (value % 7) return value;
    }
    return 0;
}

__kernel void defect(__global uint *out, uint n) {
    if (n && out[get_global_id(0)]) return;
    uint a[3];
    for (uint i = 0; i < 3; ++i) a[i] = n + i;
    out[get_global_id(0)] = first_other(a);
}
