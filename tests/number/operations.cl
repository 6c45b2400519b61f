// The number layer's operations on rows of operands. A work-group is one work-item, which takes the next V
// rows; their number is a multiple of V. Everything lies column by column: operand k of row i at k * rows + i,
// bits of result k of row i likewise.
//
// RAYA_TEST_DEVICE_ERROR stands in for a device whose division errs by up to 2 units in the last place
// and whose square root by up to 3.
#include "kernels/number/lanes.clh"

#ifdef RAYA_TEST_DEVICE_ERROR
// A number up to `reach` units away from z, by the operands' bits. Only where z is certainly
// normal: the layer refines no others.
static inline real err_by(real z, mask bits, int reach) {
    const count mixed = as_lanes_uint(bits) * 2654435761u;
    const mask step = as_lanes_int((mixed >> 16) % (count)(2 * reach + 1)) - reach;
    const mask normal = (fabs(z) > 0x1p-126f) & (fabs(z) < INFINITY);
    return choose(normal, as_lanes_real(as_lanes_int(z) + step), z);
}
static inline real erring_quotient(real a, real b) {
    return err_by(a / b, as_lanes_int(a) ^ (as_lanes_int(b) >> 1), 2);
}
static inline real erring_root(real a) { return err_by(sqrt(a), as_lanes_int(a), 3); }
#define RAYA_DEVICE_DIVIDE(a, b) erring_quotient(a, b)
#define RAYA_DEVICE_SQRT(a) erring_root(a)
#endif

#include "kernels/number/power.clh"

static inline real operand(__global const float* operands, uint rows, uint k) {
    return *(__global const real*)(operands + k * rows + get_group_id(0) * RAYA_LANES);
}

static inline void store_result(__global uint* results, uint rows, uint k, real value) {
    *(__global count*)(results + k * rows + get_group_id(0) * RAYA_LANES) = as_lanes_uint(value);
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void operations(__global const float* restrict operands,  // [3][rows]: a, b, c
                const uint rows,
                __global uint* restrict results)          // [6][rows], in the order below
{
    const real a = operand(operands, rows, 0), b = operand(operands, rows, 1), c = operand(operands, rows, 2);
    store_result(results, rows, 0, num_add(a, b));
    store_result(results, rows, 1, num_sub(a, b));
    store_result(results, rows, 2, num_mul(a, b));
    store_result(results, rows, 3, num_div(a, b));
    store_result(results, rows, 4, num_sqrt(a));
    store_result(results, rows, 5, num_mad(a, b, c));
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void powers(__global const float* restrict operands,  // [3][rows]: x, n, y
            const uint rows,
            __global uint* restrict results)          // [3][rows]: x^n, log2(x), 2^y
{
    const real x = operand(operands, rows, 0);
    store_result(results, rows, 0, num_power(x, operand(operands, rows, 1)));
    store_result(results, rows, 1, num_log2(x));
    store_result(results, rows, 2, num_exp2(operand(operands, rows, 2)));
}

__kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void conversions(__global const float* restrict operands,  // [3][rows]: a, b, and any fp32 number
                 const uint rows,
                 __global uint* restrict results)          // [6][rows], in the order below
{
    const real a = operand(operands, rows, 0), b = operand(operands, rows, 1), wide = operand(operands, rows, 2);
    lanes_index row;
    for (uint lane = 0; lane < RAYA_LANES; ++lane) row.lane[lane] = get_group_id(0) * RAYA_LANES + lane;
    store_result(results, rows, 0, num_neg(a));
    store_result(results, rows, 1, num_abs(a));
    store_result(results, rows, 2, num_max(a, b));
    store_result(results, rows, 3, num_floor(a));
    store_result(results, rows, 4, num_round(wide));
    store_result(results, rows, 5, num_from_index(row.all));
}
