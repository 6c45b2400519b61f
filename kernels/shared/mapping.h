// The mapping of pixels to PEs: the owner of a pixel and the share of a PE (the pixels that it owns), both in closed
// form. share_pixels.h enumerates the pixels of a share. Host and kernels use the same formulas: those in this file.
//
// The slot mappings implement the cyclic mapping with offset p (Kohata & Ito 1993, cyclic mapping; p = 0 is their
// column split). Pixel (row j, column x) lies in slot c = (x - j p) mod W. The fold assigns slots to PEs; it matters if
// P != W:
//
//   RAYA_FOLD_CYCLIC   P <= W   PE i owns the slots i, i + P, i + 2P, ...
//                      P >  W   the PEs c, c + W, c + 2W, ... own the rows of slot c in turn
//   RAYA_FOLD_BLOCK    P <= W   PE i owns the slots c with floor(c P / W) = i
//                      P >  W   each of the PEs floor(c P / W) to floor((c + 1) P / W) - 1 owns a run of rows of slot c
//
// The other mappings, with the number of the PE that owns pixel (j, x):
//
//   RAYA_ROWS     j mod P: interleaved scan lines
//   RAYA_BLOCKS   floor(j P / H): contiguous scan lines
//   RAYA_GRID     (j mod A) B + (x mod B), P = A B: A rows of B PEs (CAP: 16 x 16 PEs; Pixel Machine: 8 x 8 PEs)
//   RAYA_TILES    t mod P: tiles of w x h pixels, t = (j div h)(W div w) + (x div w); w divides W, h divides H
//   RAYA_RANDOM   raya_scramble(j W + x, W H, seed) mod P (scramble.h); share sizes differ by at most 1 pixel
//
// A share is a lattice of slots (or columns) and rows, every P-th tile, or every P-th scrambled number. So pixel k of
// PE i has a closed form too. Some PEs own no pixel, for example, if P > H with RAYA_ROWS or if P exceeds the number of
// tiles. Limits: 1 <= W, H <= 16384, 1 <= P <= W H, 0 <= p < W. So j p < 2^28 fits in 32 bits; c P < 2^42 needs 64
// bits.
#ifndef RAYA_SHARED_MAPPING_H
#define RAYA_SHARED_MAPPING_H
#include "kernels/shared/portable.h"
#include "kernels/shared/scramble.h"

// ceil(a b / c)
RAYA_SHARED_FUNCTION raya_u32 raya_ceil_ratio(raya_u32 a, raya_u32 b, raya_u32 c) {
    return (raya_u32)(((raya_u64)a * b + c - 1) / c);
}

// floor(a b / c)
RAYA_SHARED_FUNCTION raya_u32 raya_floor_ratio(raya_u32 a, raya_u32 b, raya_u32 c) {
    return (raya_u32)((raya_u64)a * b / c);
}

// Returns how many of first, first + step, first + 2 step, ... lie below end.
RAYA_SHARED_FUNCTION raya_u32 raya_steps_below(raya_u32 first, raya_u32 step, raya_u32 end) {
    return first < end ? (end - first - 1) / step + 1 : 0;
}

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
    raya_u32 parameter;      // slot mappings: p, in pixels. RAYA_GRID: raya_pair(A, B). RAYA_TILES:
                             // raya_pair(w, h). RAYA_RANDOM: the seed. Else 0
    raya_u32 kind;           // RAYA_FOLD_* for a slot mapping, or RAYA_ROWS .. RAYA_RANDOM
} raya_mapping;
RAYA_SHARED_SIZE(raya_mapping, 20);

// The share of one PE. With RAYA_TILES and RAYA_RANDOM only `pe` and `size` are used. With the other mappings the share
// is the slots (or columns) first_slot + m slot_step, 0 <= m < slots, in the rows first_row, first_row + row_step, ...
typedef struct {
    raya_u32 pe, size;  // number of the PE; number of its pixels
    raya_u32 first_slot, slot_step, slots;
    raya_u32 first_row, row_step;
} raya_share;

typedef struct {
    raya_u32 row, column;
} raya_pixel;

// Packs two numbers below 2^16 into the parameter of a mapping.
RAYA_SHARED_FUNCTION raya_u32 raya_pair(raya_u32 first, raya_u32 second) { return first << 16 | second; }
RAYA_SHARED_FUNCTION raya_u32 raya_first_of(raya_u32 pair) { return pair >> 16; }
RAYA_SHARED_FUNCTION raya_u32 raya_second_of(raya_u32 pair) { return pair & 0xffffu; }

RAYA_SHARED_FUNCTION int raya_has_slots(raya_mapping m) { return m.kind <= RAYA_FOLD_BLOCK; }

// Returns the shift of each row relative to the row above, in slots. If it is 0, slots are columns.
RAYA_SHARED_FUNCTION raya_u32 raya_shear(raya_mapping m) { return raya_has_slots(m) ? m.parameter : 0; }

RAYA_SHARED_FUNCTION raya_u32 raya_slot_of(raya_mapping m, raya_u32 row, raya_u32 column) {
    return (column + m.width - row * raya_shear(m) % m.width) % m.width;
}

// Returns the number of the tile in which a pixel lies.
RAYA_SHARED_FUNCTION raya_u32 raya_tile_of(raya_mapping m, raya_u32 row, raya_u32 column) {
    const raya_u32 w = raya_first_of(m.parameter), h = raya_second_of(m.parameter);
    return row / h * (m.width / w) + column / w;
}

// Returns the PE that owns a pixel. For the slot mappings only.
RAYA_SHARED_FUNCTION raya_u32 raya_slot_owner(raya_mapping m, raya_u32 row, raya_u32 column) {
    const raya_u32 slot = raya_slot_of(m, row, column);
    if (m.kind == RAYA_FOLD_CYCLIC) {
        if (m.pes <= m.width) return slot % m.pes;
        return slot + m.width * (row % raya_steps_below(slot, m.width, m.pes));
    }
    const raya_u32 first = raya_floor_ratio(slot, m.pes, m.width);
    if (m.pes <= m.width) return first;
    const raya_u32 slot_pes = raya_floor_ratio(slot + 1, m.pes, m.width) - first;
    return first + raya_floor_ratio(row, slot_pes, m.height);
}

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

// Returns the share of a PE. For the slot mappings only.
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
        const raya_u32 slot_pes = raya_floor_ratio(s.first_slot + 1, m.pes, m.width) - first;
        s.first_row = raya_ceil_ratio(pe - first, m.height, slot_pes);
        rows = raya_ceil_ratio(pe - first + 1, m.height, slot_pes) - s.first_row;
    }
    s.size = s.slots * rows;
    return s;
}

// Returns the share of a PE: the pixels whose raya_owner() is this PE.
RAYA_SHARED_FUNCTION raya_share raya_share_of(raya_mapping m, raya_u32 pe) {
    if (raya_has_slots(m)) return raya_slot_share(m, pe);
    raya_share s = {pe, 0, 0, 1, m.width, pe, m.pes};  // the share with RAYA_ROWS; changed below for other mappings
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

#endif
