// Integer ratios for the mappings (mapping.h). Products are computed in 64 bits.
#ifndef RAYA_SHARED_RATIOS_H
#define RAYA_SHARED_RATIOS_H
#include "kernels/shared/portable.h"

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

#endif
