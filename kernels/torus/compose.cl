// compose: adds the contributions of each pixel in the order of the pixel's ray tree. The contributions have reached
// the root in any order; the host has sorted them.
//
//     pixel = 0; for each contribution: pixel = colour * weight + pixel, rounded once
//
// The ring machine adds contributions in the same order and rounds in the same way (kernels/README.md, Shading).
// Work-item i of n computes the pixels i, i + n, i + 2 n, ... The kernel is built for one lane.
#include "kernels/geometry/vec.clh"
#include "kernels/shared/loop_canary.clh"
#include "kernels/shared/portable.h"

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void compose(__global const float* restrict contributions,  // [contribution][4]: red, green, blue, weight
             __global const uint* restrict starts,          // [pixels + 1]: index of each pixel's first contribution
             const uint pixels,
             __global float* restrict image,                // [pixels][3]: linear red, green, blue
             __global uint* restrict cut)                   // [1]: set to 1 if the device ends loops early
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
