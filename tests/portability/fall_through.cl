// Falls through from a case with a loop to the next case of a switch, with vectors of two chars.
//   out    one number per work-item, before the launch 0; expected: four bytes of 1
__kernel void defect(__global uint *out, uint n) {
    __global char2 *place = (__global char2 *)(out + get_global_id(0));
    switch (out[n]) {
    case 0:
        for (uint i = 0; i < 4; ++i) place[1] = (char)out[n];
    case 1:
        place[0] = place[1] = (char2)(1, 1);
    }
}
