// mark_contrasts: marks the pixels to supersample. A pixel is marked if one of its four neighbours differs from it by
// the threshold or more in red, green or blue, each clamped to 0..1 (Kohata & Ito 1993, anti-aliasing). The difference
// is a number of the format, rounded once.
//
// The host rotates the blocks of pixels as for the filter (filter.cl) and launches mark_contrasts after each rotation
// that brings neighbours to PEs.
//
// One work-group is one PE; its work-items process the PE's pixels in turn. A PE reads only its own block and the block
// that it has received.
#include "kernels/ring/arrived.clh"

static inline real clamped(real a) { return choose(a > 1.0f, num_all(1.0f), num_max(a, num_all(0.0f))); }

static inline mask differs(real a, real b, real threshold) {
    return num_abs(num_sub(clamped(a), clamped(b))) >= threshold;
}

// Sets the marks of the PE's pixels that differ from their neighbour on `side`, if the neighbour is in the arrived
// block.
__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void mark_contrasts(__global const uint* restrict broadcast,  // the job's words (kernels/shared/job.h)
                    const uint side,                          // RAYA_LEFT..RAYA_BELOW
                    const uint distance,                      // the block comes from PE (i + distance) mod P
                    const uint begin,                         // index of the block's first pixel in its owner's share
                    const uint band,                          // number of pixels in the block
                    const uint capacity,                      // capacity of a PE's memory, in pixels; 0: do nothing
                    const uint first_pe,                      // number of the PE that is work-group 0
                    const float threshold,                    // a number of the format, 0..1
                    __global const float* restrict arrived,   // [PE][3][band]
                    __global const float* restrict pixels,    // [PE][3][capacity]
                    __global uchar* restrict marks)           // [PE][capacity]: set to 1 for pixels that differ
{
    const uint group = get_group_id(0);
    const raya_mapping m = ((__global const raya_job*)broadcast)->mapping;
    const arrived_block block = open_arrived(m, first_pe, distance, side, begin, band, arrived);
    __global const float* own_pixels = pixels + (size_t)group * capacity * 3;
    __global uchar* own_marks = marks + (size_t)group * capacity;
    const uint end = min(capacity, raya_share_size(block.share));
    for (uint k = get_local_id(0); k < end; k += RAYA_GROUP) {
        const uint n = arrived_neighbour(&block, k);
        if (n == RAYA_NOT_HERE) continue;
        const vec a = colour_at(own_pixels, capacity, k), b = colour_at(block.words, band, n);
        if (differs(a.x, b.x, threshold) || differs(a.y, b.y, threshold) || differs(a.z, b.z, threshold))
            own_marks[k] = 1;
    }
}
