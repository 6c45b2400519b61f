// compose: adds up the contributions of each pixel. They reach the root in any order; the host has sorted them into the
// order of the pixel's ray tree:
//
//     pixel = c1 w1, then c2 w2 + pixel, and so on, each step rounded once
//
// as the ring machine adds them (kernels/README.md, Shading). Work-item i of n takes the pixels i, i + n, ... One lane.
#include "kernels/geometry/vec.clh"
#include "kernels/shared/loop_canary.clh"

#ifndef RAYA_GROUP
#define RAYA_GROUP 1  // L: work-items in a work-group, 1..1024
#endif

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void compose(__global const float* restrict contributions,  // [contribution][4]: red, green, blue, weight
             __global const uint* restrict starts,          // [pixels + 1]: where those of each pixel start
             const uint pixels,
             __global float* restrict image,                // [pixels][3]: linear red, green, blue
             __global uint* restrict cut)                   // [1]: set to 1 if the device has ended loops early
{
    for (uint pixel = get_global_id(0); pixel < pixels; pixel += get_global_size(0)) {
        vec sum = vec_of(num_const(0.0f), num_const(0.0f), num_const(0.0f));
        for (uint i = starts[pixel]; i < starts[pixel + 1]; ++i) {
            const float4 c = vload4(i, contributions);
            sum = vec_mad(vec_of(c.x, c.y, c.z), c.w, sum);
        }
        vstore3((float3)(sum.x, sum.y, sum.z), pixel, image);
    }
    if (loops_were_cut(min(pixels + 1, 2u))) *cut = 1;
}
