// Converts a number that is constant in the second of two iterations, if another one converts to 0.
//   out    a number for each of 8 work-items; expected: 1, for n = 0
__kernel void defect(__global uint *out, uint n) {
    const float x = convert_float(n);
    float y = convert_float(as_int(0xdbf9f793u)) * 0x1p-12f;
    for (uint i = 0; i < 2; ++i) {
        out[get_global_id(0)] = convert_int_sat(x) ? 0 : convert_char_sat(y);
        y = 1;
    }
}
