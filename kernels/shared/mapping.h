// The mapping: which PE owns which pixel, in closed form both ways. Read by host and kernels; nobody else knows the formulas.
//
// Pixel (row j, column x) lies in slot c = (x - j p) mod W of the sheared image: the cyclic mapping with offset p
// (Kohata & Ito 1993, cyclic mapping; p = 0 is their column split). The fold gives slots to PEs where P != W:
//
//   P <= W   cyclic: PE i owns the slots i, i + P, i + 2P, ...        block: PE i owns the slots c with floor(c P / W) = i
//   P >  W   a slot's PEs share its rows. cyclic: slot c has the PEs c, c + W, c + 2W, ..., its rows go to them in turn
//            block: slot c has the PEs from floor(c P / W) to floor((c + 1) P / W) - 1, each takes a run of rows
//
// So every share is a lattice of slots and rows, and pixel k of PE i has a closed form as well.
// Legal: 1 <= W, H <= 16384, 1 <= P <= W H, 0 <= p < W. Then j p < 2^28 and c P < 2^42, which is why 64 bits appear.
#ifndef RAYA_SHARED_MAPPING_H
#define RAYA_SHARED_MAPPING_H
#include "shared/portable.h"

#define RAYA_FOLD_CYCLIC 0u
#define RAYA_FOLD_BLOCK 1u

typedef struct {
    raya_u32 width, height;  // W, H: pixels
    raya_u32 pes;            // P
    raya_u32 offset;         // p: slots by which a row is shifted against the row above
    raya_u32 fold;           // RAYA_FOLD_*
} raya_mapping;
RAYA_SHARED_SIZE(raya_mapping, 20);

// What one PE owns: slots first_slot + m slot_step (m < slots) crossed with rows first_row + r row_step (r < rows).
typedef struct {
    raya_u32 first_slot, slot_step, slots;
    raya_u32 first_row, row_step, rows;
} raya_share;

typedef struct {
    raya_u32 row, column;
} raya_pixel;

// ceil(a b / c)
RAYA_SHARED_FUNCTION raya_u32 raya_ceil_ratio(raya_u32 a, raya_u32 b, raya_u32 c) {
    return (raya_u32)(((raya_u64)a * b + c - 1) / c);
}

// floor(a b / c)
RAYA_SHARED_FUNCTION raya_u32 raya_floor_ratio(raya_u32 a, raya_u32 b, raya_u32 c) {
    return (raya_u32)((raya_u64)a * b / c);
}

RAYA_SHARED_FUNCTION raya_u32 raya_slot_of(raya_mapping m, raya_u32 row, raya_u32 column) {
    return (column + m.width - row * m.offset % m.width) % m.width;
}

// The PE that owns a pixel.
RAYA_SHARED_FUNCTION raya_u32 raya_owner(raya_mapping m, raya_u32 row, raya_u32 column) {
    const raya_u32 slot = raya_slot_of(m, row, column);
    if (m.fold == RAYA_FOLD_CYCLIC) {
        if (m.pes <= m.width) return slot % m.pes;
        const raya_u32 sharers = (m.pes - slot - 1) / m.width + 1;
        return slot + m.width * (row % sharers);
    }
    const raya_u32 first = raya_floor_ratio(slot, m.pes, m.width);
    if (m.pes <= m.width) return first;
    const raya_u32 sharers = raya_floor_ratio(slot + 1, m.pes, m.width) - first;
    return first + raya_floor_ratio(row, sharers, m.height);
}

// All that a PE owns; the inverse of raya_owner.
RAYA_SHARED_FUNCTION raya_share raya_share_of(raya_mapping m, raya_u32 pe) {
    raya_share s = {0, 1, 1, 0, 1, m.height};
    if (m.fold == RAYA_FOLD_CYCLIC) {
        s.first_slot = pe % m.width;
        s.slot_step = m.pes;
        if (m.pes <= m.width) {
            s.slots = (m.width - pe - 1) / m.pes + 1;
        } else {
            s.first_row = pe / m.width;
            s.row_step = (m.pes - s.first_slot - 1) / m.width + 1;
            s.rows = s.first_row < m.height ? (m.height - s.first_row - 1) / s.row_step + 1 : 0;
        }
        return s;
    }
    if (m.pes <= m.width) {
        s.first_slot = raya_ceil_ratio(pe, m.width, m.pes);
        s.slots = raya_ceil_ratio(pe + 1, m.width, m.pes) - s.first_slot;
    } else {
        s.first_slot = (raya_u32)(((raya_u64)(pe + 1) * m.width - 1) / m.pes);
        const raya_u32 first = raya_floor_ratio(s.first_slot, m.pes, m.width);
        const raya_u32 sharers = raya_floor_ratio(s.first_slot + 1, m.pes, m.width) - first;
        s.first_row = raya_ceil_ratio(pe - first, m.height, sharers);
        s.rows = raya_ceil_ratio(pe - first + 1, m.height, sharers) - s.first_row;
    }
    return s;
}

RAYA_SHARED_FUNCTION raya_u32 raya_share_size(raya_share s) { return s.slots * s.rows; }

// Pixel k of a share, row by row, k < raya_share_size.
RAYA_SHARED_FUNCTION raya_pixel raya_pixel_of(raya_mapping m, raya_share s, raya_u32 k) {
    const raya_u32 row = s.first_row + k / s.slots * s.row_step;
    const raya_u32 slot = s.first_slot + k % s.slots * s.slot_step;
    const raya_pixel pixel = {row, (slot + row * m.offset) % m.width};
    return pixel;
}

// The number of a pixel in the share of its owner; the inverse of raya_pixel_of.
RAYA_SHARED_FUNCTION raya_u32 raya_index_of(raya_mapping m, raya_share s, raya_pixel pixel) {
    const raya_u32 slot = raya_slot_of(m, pixel.row, pixel.column);
    return (pixel.row - s.first_row) / s.row_step * s.slots + (slot - s.first_slot) / s.slot_step;
}

#endif
