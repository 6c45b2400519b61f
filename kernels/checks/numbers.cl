// Checks of the number layer: applies every operation to rows of operands.
//
// Work-group g is one work-item, which processes the V rows from row g V on; `rows` is a multiple of V. Arrays are
// column-major: element k * rows + i is operand k of row i, or the bits of result k of row i. Every operation is
// applied to every row, but the host compares only the results of the operations for which the row was made
// (host/verify/numbers.hpp).
#include "kernels/checks/rows.clh"
#include "kernels/number/power.clh"

RAYA_KERNEL_BODY void store_operations(real a, real b, real c, __global uint* to, uint rows) {
    store_bits(to, 1, num_add(a, b));
    store_bits(to + rows, 1, num_sub(a, b));
    store_bits(to + 2 * rows, 1, num_mul(a, b));
    store_bits(to + 3 * rows, 1, num_div(a, b));
    store_bits(to + 4 * rows, 1, num_sqrt(a));
    store_bits(to + 5 * rows, 1, num_mad(a, b, c));
    store_bits(to + 6 * rows, 1, num_add(num_mul(a, b), c));  // two roundings: must not be contracted to num_mad
    store_bits(to + 7 * rows, 1, num_max(a, b));
    store_bits(to + 8 * rows, 1, num_floor(a));
    store_bits(to + 9 * rows, 1, num_round(a));
    store_bits(to + 10 * rows, 1, num_from_index(as_lanes_uint(a)));
    store_bits(to + 11 * rows, 1, num_power(a, b));
    store_bits(to + 12 * rows, 1, num_neg(a));
    store_bits(to + 13 * rows, 1, num_abs(a));
    store_bits(to + 14 * rows, 1, num_log2(a));
    store_bits(to + 15 * rows, 1, num_exp2(c));
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void operations(
    __global const float* restrict operands,  // [3][rows]: a, b, c; num_from_index() takes the bits of a
    const uint rows,
    __global uint* restrict results)  // [16][rows], in the order of store_operations()
{
    const uint first = get_group_id(0) * RAYA_LANES;
    const real a = load_lanes(operands + first, 1), b = load_lanes(operands + rows + first, 1);
    const real c = load_lanes(operands + 2 * rows + first, 1);
    store_operations(a, b, c, results + first, rows);
}
