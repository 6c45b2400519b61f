// The number layer by itself. A work-group is one work-item, which takes the next V rows of numbers;
// there are a multiple of V of them.
#include "kernels/number/power.clh"

static inline void store_bits(__global uint* to, uint stride, real value) {
    store_index(to, stride, as_lanes_uint(value));
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void arithmetic(__global const float* restrict operands,  // [row][3]: a, b, c
                __global uint* restrict results)          // [row][11]: bits of the results, in the order below
{
    const uint first = get_group_id(0) * RAYA_LANES;
    const real a = load_lanes(operands + first * 3, 3), b = load_lanes(operands + first * 3 + 1, 3);
    const real c = load_lanes(operands + first * 3 + 2, 3);
    __global uint* to = results + first * 11;
    store_bits(to, 11, num_add(a, b));
    store_bits(to + 1, 11, num_sub(a, b));
    store_bits(to + 2, 11, num_mul(a, b));
    store_bits(to + 3, 11, num_div(a, b));
    store_bits(to + 4, 11, num_sqrt(num_abs(a)));
    store_bits(to + 5, 11, num_mad(a, b, c));
    store_bits(to + 6, 11, num_neg(a));
    store_bits(to + 7, 11, num_abs(a));
    store_bits(to + 8, 11, num_floor(a));
    store_bits(to + 9, 11, num_max(a, b));
    store_bits(to + 10, 11, num_add(num_mul(a, b), c));  // two roundings: nothing may contract it
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void powers(__global const float* restrict operands,  // [row][3]: x, n, y
            __global uint* restrict results)          // [row][3]: bits of x^n, log2(x), 2^y
{
    const uint first = get_group_id(0) * RAYA_LANES;
    const real x = load_lanes(operands + first * 3, 3), n = load_lanes(operands + first * 3 + 1, 3);
    store_bits(results + first * 3, 3, num_power(x, n));
    store_bits(results + first * 3 + 1, 3, num_log2(x));
    store_bits(results + first * 3 + 2, 3, num_exp2(load_lanes(operands + first * 3 + 2, 3)));
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void masks(__global const float* restrict operands,  // [row][2]: a, b
           __global uint* restrict results)          // [row][9], of m = a < b, in the order below
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
