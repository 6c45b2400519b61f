// Test kernel for masks. A work-group is one work-item, which processes the next V rows of numbers. The number of rows
// is a multiple of V.
#include "kernels/checks/rows.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void masks(__global const float* restrict operands,  // [row][2]: a, b
           __global uint* restrict results)          // [row][9]: results for the mask a < b, as stored below
{
    const uint first = get_group_id(0) * RAYA_LANES;
    const real a = load_lanes(operands + first * 2, 2), b = load_lanes(operands + first * 2 + 1, 2);
    const mask m = a < b;
    lanes_index number, truth;
    for (uint lane = 0; lane < RAYA_LANES; ++lane) number.lane[lane] = first + lane;
    truth.truth = m;
    __global uint* to = results + first * 9;
    store_bits(to, 9, choose(m, a, b));
    store_index(to + 1, 9, choose_index(m, number.all, (index)(12345)));
    store_index(to + 2, 9, tally(number.all, m));
    store_index(to + 3, 9, tally_by(number.all, m, 5));
    store_index(to + 4, 9, (index)(mask_any(m) ? 1 : 0));
    store_index(to + 5, 9, (index)(mask_any(mask_not(m)) ? 1 : 0));
    store_index(to + 6, 9, choose_index(truth.all == RAYA_TRUE, (index)(1), (index)(0)));
    store_index(to + 7, 9, (index)((mask_any(mask_all(0)) ? 1 : 0) + (mask_any(mask_all(1)) ? 2 : 0)));
    store_bits(to + 8, 9, to_lanes_real(number.all));
}
