// Chooses a case by the lowest two bits of a product.
//   out    a number, before the launch 0; expected: 7, for n = 3
__kernel void defect(__global uint *out, uint n) {
    switch (n * 3 & 3u) {
    case 0:
        break;
    case 1:
        out[0] = 1;
    default:
        out[0] += 6;
    }
}
