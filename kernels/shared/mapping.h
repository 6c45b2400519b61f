// The mapping: which PE owns which pixel, in closed form both ways. Read by host and kernels;
// nobody else knows the formulas.
//
// The slot mappings. Pixel (row j, column x) lies in slot c = (x - j p) mod W of the sheared image: the
// cyclic mapping with offset p (Kohata & Ito 1993, cyclic mapping; p = 0 is their column split). The fold
// maps slots to PEs where P != W:
//
//   RAYA_FOLD_CYCLIC   P <= W   PE i owns the slots i, i + P, i + 2P, ...
//                      P >  W   slot c has the PEs c, c + W, c + 2W, ..., its rows go to them in turn
//   RAYA_FOLD_BLOCK    P <= W   PE i owns the slots c with floor(c P / W) = i
//                      P >  W   slot c has the PEs floor(c P / W) to floor((c + 1) P / W) - 1, each takes a run of rows
//
// The others, by the PE that owns pixel (j, x):
//
//   RAYA_ROWS     j mod P: scan lines in turn
//   RAYA_BLOCKS   floor(j P / H): contiguous scan lines
//   RAYA_GRID     (j mod A) B + (x mod B), P = A B: an array of A rows of B PEs (CAP 16 x 16, Pixel Machine 8 x 8)
//   RAYA_TILES    t mod P: tiles of w x h pixels in turn, t = (j div h)(W div w) + (x div w); w divides W, h divides H
//   RAYA_RANDOM   (scrambled number j W + x) mod P: see shared/scramble.h; no two shares differ by more than a pixel
//
// Every share is a lattice of slots (or columns) and rows, a list of tiles, or a list of scrambled numbers, so pixel k
// of PE i has a closed form as well. A PE may own nothing: P > H with rows, more PEs than tiles. Legal: 1 <= W, H <=
// 16384, 1 <= P <= W H, 0 <= p < W. Then j p < 2^28 and c P < 2^42, which is why 64 bits appear.
#ifndef RAYA_SHARED_MAPPING_H
#define RAYA_SHARED_MAPPING_H
#include "kernels/shared/portable.h"
#include "kernels/shared/ratios.h"
#include "kernels/shared/scramble.h"

#define RAYA_FOLD_CYCLIC 0u
#define RAYA_FOLD_BLOCK 1u
#define RAYA_ROWS 2u
#define RAYA_BLOCKS 3u
#define RAYA_GRID 4u
#define RAYA_TILES 5u
#define RAYA_RANDOM 6u

typedef struct {
    raya_u32 width, height;  // W, H: pixels
    raya_u32 pes;            // P
    raya_u32 parameter;      // slots: p, by which a row is shifted against the row above. grid: raya_pair(A, B). tiles:
                             // raya_pair(w, h). random: the seed. Else 0
    raya_u32 kind;           // RAYA_FOLD_* of a slot mapping, or RAYA_ROWS .. RAYA_RANDOM
} raya_mapping;
RAYA_SHARED_SIZE(raya_mapping, 20);

// What one PE owns. Tiles and random: pe and size tell all. The others: slots first_slot + m slot_step (m < slots)
// crossed with the rows first_row, first_row + row_step, ...
typedef struct {
    raya_u32 pe, size;  // size: pixels
    raya_u32 first_slot, slot_step, slots;
    raya_u32 first_row, row_step;
} raya_share;

typedef struct {
    raya_u32 row, column;
} raya_pixel;

// Two numbers below 2^16 in the parameter of a mapping.
RAYA_SHARED_FUNCTION raya_u32 raya_pair(raya_u32 first, raya_u32 second) { return first << 16 | second; }
RAYA_SHARED_FUNCTION raya_u32 raya_first_of(raya_u32 pair) { return pair >> 16; }
RAYA_SHARED_FUNCTION raya_u32 raya_second_of(raya_u32 pair) { return pair & 0xffffu; }

RAYA_SHARED_FUNCTION int raya_has_slots(raya_mapping m) { return m.kind <= RAYA_FOLD_BLOCK; }

// Slots by which a row is shifted against the row above: where there is no shear, slots are columns.
RAYA_SHARED_FUNCTION raya_u32 raya_shear(raya_mapping m) { return raya_has_slots(m) ? m.parameter : 0; }

RAYA_SHARED_FUNCTION raya_u32 raya_slot_of(raya_mapping m, raya_u32 row, raya_u32 column) {
    return (column + m.width - row * raya_shear(m) % m.width) % m.width;
}

// Number of the tile in which a pixel lies.
RAYA_SHARED_FUNCTION raya_u32 raya_tile_of(raya_mapping m, raya_u32 row, raya_u32 column) {
    const raya_u32 w = raya_first_of(m.parameter), h = raya_second_of(m.parameter);
    return row / h * (m.width / w) + column / w;
}

// raya_owner of the slot mappings.
RAYA_SHARED_FUNCTION raya_u32 raya_slot_owner(raya_mapping m, raya_u32 row, raya_u32 column) {
    const raya_u32 slot = raya_slot_of(m, row, column);
    if (m.kind == RAYA_FOLD_CYCLIC) {
        if (m.pes <= m.width) return slot % m.pes;
        return slot + m.width * (row % raya_steps_below(slot, m.width, m.pes));
    }
    const raya_u32 first = raya_floor_ratio(slot, m.pes, m.width);
    if (m.pes <= m.width) return first;
    const raya_u32 sharers = raya_floor_ratio(slot + 1, m.pes, m.width) - first;
    return first + raya_floor_ratio(row, sharers, m.height);
}

// The PE that owns a pixel.
RAYA_SHARED_FUNCTION raya_u32 raya_owner(raya_mapping m, raya_u32 row, raya_u32 column) {
    if (raya_has_slots(m)) return raya_slot_owner(m, row, column);
    if (m.kind == RAYA_ROWS) return row % m.pes;
    if (m.kind == RAYA_BLOCKS) return raya_floor_ratio(row, m.pes, m.height);
    if (m.kind == RAYA_GRID) {
        const raya_u32 across = raya_second_of(m.parameter);
        return row % raya_first_of(m.parameter) * across + column % across;
    }
    if (m.kind == RAYA_TILES) return raya_tile_of(m, row, column) % m.pes;
    return raya_scramble(row * m.width + column, m.width * m.height, m.parameter) % m.pes;
}

// raya_share_of of the slot mappings.
RAYA_SHARED_FUNCTION raya_share raya_slot_share(raya_mapping m, raya_u32 pe) {
    raya_share s = {pe, 0, pe % m.width, 1, 1, 0, 1};
    raya_u32 rows = m.height;
    if (m.kind == RAYA_FOLD_CYCLIC) {
        s.slot_step = m.pes;
        if (m.pes <= m.width) {
            s.slots = raya_steps_below(pe, m.pes, m.width);
        } else {
            s.first_row = pe / m.width;
            s.row_step = raya_steps_below(s.first_slot, m.width, m.pes);
            rows = raya_steps_below(s.first_row, s.row_step, m.height);
        }
    } else if (m.pes <= m.width) {
        s.first_slot = raya_ceil_ratio(pe, m.width, m.pes);
        s.slots = raya_ceil_ratio(pe + 1, m.width, m.pes) - s.first_slot;
    } else {
        s.first_slot = (raya_u32)(((raya_u64)(pe + 1) * m.width - 1) / m.pes);
        const raya_u32 first = raya_floor_ratio(s.first_slot, m.pes, m.width);
        const raya_u32 sharers = raya_floor_ratio(s.first_slot + 1, m.pes, m.width) - first;
        s.first_row = raya_ceil_ratio(pe - first, m.height, sharers);
        rows = raya_ceil_ratio(pe - first + 1, m.height, sharers) - s.first_row;
    }
    s.size = s.slots * rows;
    return s;
}

// All that a PE owns; the inverse of raya_owner.
RAYA_SHARED_FUNCTION raya_share raya_share_of(raya_mapping m, raya_u32 pe) {
    if (raya_has_slots(m)) return raya_slot_share(m, pe);
    raya_share s = {pe, 0, 0, 1, m.width, pe, m.pes};  // as of RAYA_ROWS
    const raya_u32 first = raya_first_of(m.parameter), second = raya_second_of(m.parameter);
    const raya_u32 pixels = m.width * m.height;
    if (m.kind == RAYA_ROWS) s.size = raya_steps_below(pe, m.pes, m.height) * m.width;
    if (m.kind == RAYA_BLOCKS) {
        s.first_row = raya_ceil_ratio(pe, m.height, m.pes);
        s.row_step = 1;
        s.size = (raya_ceil_ratio(pe + 1, m.height, m.pes) - s.first_row) * m.width;
    }
    if (m.kind == RAYA_GRID) {
        s.first_slot = pe % second;
        s.slot_step = second;
        s.slots = raya_steps_below(s.first_slot, second, m.width);
        s.first_row = pe / second;
        s.row_step = first;
        s.size = s.slots * raya_steps_below(s.first_row, first, m.height);
    }
    if (m.kind == RAYA_TILES) s.size = raya_steps_below(pe, m.pes, pixels / (first * second)) * first * second;
    if (m.kind == RAYA_RANDOM) s.size = raya_steps_below(pe, m.pes, pixels);
    return s;
}

RAYA_SHARED_FUNCTION raya_u32 raya_share_size(raya_share s) { return s.size; }

// Pixel k of a share, k < raya_share_size: row by row, tile by tile (each row by row), or by scrambled number.
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

// A pixel of a share, and those that follow it at equal distances in its row: raya_pixel_of without its divisions.
typedef struct {
    raya_pixel pixel;
    raya_u32 number;  // in the share
    raya_u32 left;    // how many follow
    raya_u32 step;    // columns from one to the next, modulo the width
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

// The run at pixel k of the share, where it goes on to that; else another one.
RAYA_SHARED_FUNCTION raya_pixel_run raya_pixel_run_at(raya_pixel_run run, raya_mapping m, raya_share s, raya_u32 k) {
    if (k != run.number + 1 || run.left == 0) return raya_pixel_run_of(m, s, k);
    run.pixel.column += run.step;
    if (run.pixel.column >= m.width) run.pixel.column -= m.width;
    run.number = k;
    --run.left;
    return run;
}

// The number of a pixel in the share of its owner; the inverse of raya_pixel_of.
RAYA_SHARED_FUNCTION raya_u32 raya_index_of(raya_mapping m, raya_share s, raya_pixel pixel) {
    if (m.kind == RAYA_TILES) {
        const raya_u32 w = raya_first_of(m.parameter), h = raya_second_of(m.parameter);
        const raya_u32 turn = raya_tile_of(m, pixel.row, pixel.column) / m.pes;  // of the owner's tiles, which one
        return (turn * h + pixel.row % h) * w + pixel.column % w;
    }
    if (m.kind == RAYA_RANDOM)
        return raya_scramble(pixel.row * m.width + pixel.column, m.width * m.height, m.parameter) / m.pes;
    const raya_u32 slot = raya_slot_of(m, pixel.row, pixel.column);
    return (pixel.row - s.first_row) / s.row_step * s.slots + (slot - s.first_slot) / s.slot_step;
}

#endif
