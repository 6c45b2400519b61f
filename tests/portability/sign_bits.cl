// Counts the leading zeros of a number that was a char in one of two iterations.
//   out    two numbers, before the launch 0; expected: n = 7. The two work-items write the same.
__kernel void defect(__global uint *out, uint n) {
    int last = 0, next = 0;
    for (uint i = 0; i < 2; ++i) {
        last = next;
        next = (char)out[0];
    }
    if (clz(last)) {
        last = 7;
        out[1] = n;
    }
    out[0] = last;
}
