// The order of the pixels in a PE's share (mapping.h): raya_pixel_of() returns pixel k of a share, raya_index_of() is
// its inverse. raya_pixel_run enumerates pixels without a division for each pixel.
#ifndef RAYA_SHARED_SHARE_PIXELS_H
#define RAYA_SHARED_SHARE_PIXELS_H
#include "kernels/shared/mapping.h"

// Returns pixel k of a share, k < raya_share_size(). Pixels are ordered row by row; with RAYA_TILES tile by tile and in
// a tile row by row; with RAYA_RANDOM by their scrambled numbers.
RAYA_SHARED_FUNCTION raya_pixel raya_pixel_of(raya_mapping m, raya_share s, raya_u32 k) {
    raya_pixel pixel;
    if (m.kind == RAYA_TILES) {
        const raya_u32 w = raya_first_of(m.parameter), h = raya_second_of(m.parameter), across = m.width / w;
        const raya_u32 tile = s.pe + k / (w * h) * m.pes;
        pixel.row = tile / across * h + k % (w * h) / w;
        pixel.column = tile % across * w + k % w;
    } else if (m.kind == RAYA_RANDOM) {
        const raya_u32 number = raya_unscramble(s.pe + k * m.pes, m.width * m.height, m.parameter);
        pixel.row = number / m.width;
        pixel.column = number % m.width;
    } else {
        const raya_u32 slot = s.first_slot + k % s.slots * s.slot_step;
        pixel.row = s.first_row + k / s.slots * s.row_step;
        pixel.column = (slot + pixel.row * raya_shear(m)) % m.width;
    }
    return pixel;
}

// A run: a pixel of a share, and the pixels that follow it in the share at equal distances in the same row.
typedef struct {
    raya_pixel pixel;
    raya_u32 number;  // k: index of the pixel in the share
    raya_u32 left;    // number of pixels that follow in the run
    raya_u32 step;    // distance from one pixel of the run to the next, in columns, modulo the width
} raya_pixel_run;

RAYA_SHARED_FUNCTION raya_pixel_run raya_pixel_run_of(raya_mapping m, raya_share s, raya_u32 k) {
    raya_pixel_run run = {raya_pixel_of(m, s, k), k, 0, 0};
    if (m.kind == RAYA_TILES) {
        run.left = raya_first_of(m.parameter) - 1 - k % raya_first_of(m.parameter);
        run.step = 1;
    } else if (m.kind != RAYA_RANDOM) {
        run.left = s.slots - 1 - k % s.slots;
        run.step = s.slot_step;
    }
    return run;
}

// Advances the run to pixel k of the share if k is its next pixel; else returns a new run that starts at k.
RAYA_SHARED_FUNCTION raya_pixel_run raya_pixel_run_at(raya_pixel_run run, raya_mapping m, raya_share s, raya_u32 k) {
    if (k != run.number + 1 || run.left == 0) return raya_pixel_run_of(m, s, k);
    run.pixel.column += run.step;
    if (run.pixel.column >= m.width) run.pixel.column -= m.width;
    run.number = k;
    --run.left;
    return run;
}

// Returns the index k of a pixel in its owner's share: the inverse of raya_pixel_of().
RAYA_SHARED_FUNCTION raya_u32 raya_index_of(raya_mapping m, raya_share s, raya_pixel pixel) {
    if (m.kind == RAYA_TILES) {
        const raya_u32 w = raya_first_of(m.parameter), h = raya_second_of(m.parameter);
        const raya_u32 tile_index = raya_tile_of(m, pixel.row, pixel.column) / m.pes;  // index among the owner's tiles
        return (tile_index * h + pixel.row % h) * w + pixel.column % w;
    }
    if (m.kind == RAYA_RANDOM)
        return raya_scramble(pixel.row * m.width + pixel.column, m.width * m.height, m.parameter) / m.pes;
    const raya_u32 slot = raya_slot_of(m, pixel.row, pixel.column);
    return (pixel.row - s.first_row) / s.row_step * s.slots + (slot - s.first_slot) / s.slot_step;
}

#endif
