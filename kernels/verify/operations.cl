// operations: every operation of the number layer on rows of operands whose answers are known
// (host/verify/known_answers.csv).
//
// A work-group is one work-item, which takes the next V rows; their number is a multiple of V. Everything lies column
// by column: operand k of row i at k * rows + i, the bits of result k of row i likewise. Every operation is done on
// every row; the host looks at the one that the row is for.
#include "kernels/number/power.clh"
#include "kernels/verify/rows.clh"

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void operations(__global const float* restrict operands,  // [3][rows]: a, b, c; from_index reads a's bits
                const uint rows,
                __global uint* restrict results)          // [12][rows], in the order below
{
    const uint first = get_group_id(0) * RAYA_LANES;
    const real a = load_lanes(operands + first, 1), b = load_lanes(operands + rows + first, 1);
    const real c = load_lanes(operands + 2 * rows + first, 1);
    __global uint* to = results + first;
    store_bits(to, num_add(a, b));
    store_bits(to + rows, num_sub(a, b));
    store_bits(to + 2 * rows, num_mul(a, b));
    store_bits(to + 3 * rows, num_div(a, b));
    store_bits(to + 4 * rows, num_sqrt(a));
    store_bits(to + 5 * rows, num_mad(a, b, c));
    store_bits(to + 6 * rows, num_add(num_mul(a, b), c));  // two roundings: a compiler must not contract it to num_mad
    store_bits(to + 7 * rows, num_max(a, b));
    store_bits(to + 8 * rows, num_floor(a));
    store_bits(to + 9 * rows, num_round(a));
    store_bits(to + 10 * rows, num_from_index(as_lanes_uint(a)));
    store_bits(to + 11 * rows, num_power(a, b));
}
