// operations: a benchmark of the operations of the number layer. Its results have no meaning.
//
// Every work-item repeats one operation `rounds` times in each of RAYA_CHAINS independent chains of V lanes. The chains
// are independent so that the benchmark measures throughput, not latency. The results are stored so that compilers
// cannot remove the work.
#include "number.clh"
#include "kernels/shared/chains.h"

#ifndef RAYA_GROUP
#define RAYA_GROUP 1  // L: number of work-items in a work-group, 1..1024
#endif

// The chains are unrolled by macros, because compilers would keep an array that is indexed in a loop in memory.
#define RAYA_ALL_CHAINS(step) step(0) step(1) step(2) step(3) step(4) step(5) step(6) step(7)
#define RAYA_REPEAT(step) \
    for (uint i = 0; i < rounds; ++i) { RAYA_ALL_CHAINS(step) }
#define RAYA_ADD(k) a[k] = num_add(x, num_neg(a[k]));
#define RAYA_MULTIPLY(k) a[k] = num_mul(a[k], x);
#define RAYA_MAD(k) a[k] = num_mad(a[k], y, x);
#define RAYA_DIVIDE(k) a[k] = num_div(x, a[k]);
#define RAYA_SQRT(k) a[k] = num_sqrt(a[k]);

__kernel __attribute__((reqd_work_group_size(RAYA_GROUP, 1, 1)))
void operations(const uint kind,                    // 0 add, 1 multiply, 2 multiply-accumulate, 3 divide, 4 square root
                const uint rounds,                  // number of operations in each chain
                const float start,                  // operand, about 1
                __global float* restrict results)   // [work-item][V]
{
    real a[RAYA_CHAINS];
    const real x = num_const(start), y = num_const(start * 0.5f);
    for (uint k = 0; k < RAYA_CHAINS; ++k) a[k] = num_const(start + (float)k);
    if (kind == 0) RAYA_REPEAT(RAYA_ADD)
    if (kind == 1) RAYA_REPEAT(RAYA_MULTIPLY)
    if (kind == 2) RAYA_REPEAT(RAYA_MAD)
    if (kind == 3) RAYA_REPEAT(RAYA_DIVIDE)
    if (kind == 4) RAYA_REPEAT(RAYA_SQRT)
    lanes_real sum;
    sum.all = num_const(0.0f);
    for (uint k = 0; k < RAYA_CHAINS; ++k) sum.all = num_add(sum.all, a[k]);
    for (uint lane = 0; lane < RAYA_LANES; ++lane) results[get_global_id(0) * RAYA_LANES + lane] = sum.lane[lane];
}
