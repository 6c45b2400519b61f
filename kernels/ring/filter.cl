// The 3 x 3 filter: every pixel becomes the mean of its 3 x 3 neighbourhood (Kohata & Ito 1993, anti-aliasing):
//
//     rows:     sum = (pixel + left) + right        of the colours
//     columns:  sum = (pixel + above) + below       of the row sums
//     pixel = sum / 9                               at the image's border: sum / number of pixels summed (6, 4, ...)
//
// Sums and quotient are rounded to the number format. For each of the two sums, the host first copies each PE's own
// values to `sums`. Then it rotates the blocks and launches add_neighbours after each rotation that brings neighbours
// to PEs. At the end the host launches take_means.
//
// One work-group is one PE; its work-items process the PE's pixels in turn. A PE reads only its own block and the block
// that it has received.
#include "kernels/ring/arrived.clh"

// Adds the neighbour on `side` to the sum of each of the PE's pixels, if the neighbour is in the arrived block.
__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void add_neighbours(__global const uint* restrict broadcast,  // the job's words (kernels/shared/job.h)
                    const uint side,                          // RAYA_LEFT..RAYA_BELOW
                    const uint distance,                      // the block comes from PE (i + distance) mod P
                    const uint begin,                         // index of the block's first pixel in its owner's share
                    const uint band,                          // number of pixels in the block
                    const uint capacity,                      // capacity of a PE's memory, in pixels; 0: do nothing
                    const uint first_pe,                      // number of the PE that is work-group 0
                    __global const float* restrict arrived,   // [PE][3][band]
                    __global float* restrict sums)            // [PE][3][capacity]: sums so far
{
    const uint group = get_group_id(0);
    const raya_mapping m = ((__global const raya_job*)broadcast)->mapping;
    const arrived_block block = open_arrived(m, first_pe, distance, side, begin, band, arrived);
    __global float* own_sums = sums + (size_t)group * capacity * 3;
    const uint end = min(capacity, raya_share_size(block.share));
    for (uint k = get_local_id(0); k < end; k += RAYA_GROUP) {
        const uint n = arrived_neighbour(&block, k);
        if (n == RAYA_NOT_HERE) continue;
        const vec sum = vec_add(colour_at(own_sums, capacity, k), colour_at(block.words, band, n));
        own_sums[k] = sum.x;
        own_sums[capacity + k] = sum.y;
        own_sums[2 * capacity + k] = sum.z;
    }
}

// Divides each sum by the number of pixels of the neighbourhood that lie in the image.
__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void take_means(__global const uint* restrict broadcast,  // the job's words (kernels/shared/job.h)
                const uint capacity,                      // capacity of a PE's memory, in pixels; 0: do nothing
                const uint first_pe,                      // number of the PE that is work-group 0
                __global float* restrict sums)            // [PE][3][capacity]: sums on entry, means on return
{
    const uint group = get_group_id(0);
    const raya_mapping m = ((__global const raya_job*)broadcast)->mapping;
    const raya_share share = raya_share_of(m, first_pe + group);
    __global float* own_sums = sums + (size_t)group * capacity * 3;
    const uint end = min(capacity, raya_share_size(share));
    for (uint k = get_local_id(0); k < end; k += RAYA_GROUP) {
        const raya_pixel pixel = raya_pixel_of(m, share, k);
        const uint columns = 1 + raya_has_neighbour(m, pixel, RAYA_LEFT) + raya_has_neighbour(m, pixel, RAYA_RIGHT);
        const uint rows = 1 + raya_has_neighbour(m, pixel, RAYA_ABOVE) + raya_has_neighbour(m, pixel, RAYA_BELOW);
        const real pixels = num_from_index(rows * columns);
        for (uint i = 0; i < 3; ++i) own_sums[i * capacity + k] = num_div(own_sums[i * capacity + k], pixels);
    }
}
