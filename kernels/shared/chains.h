// Number of independent chains of operations in each work-item of number/operations.cl. The host needs it to compute
// operations per second.
#ifndef RAYA_SHARED_CHAINS_H
#define RAYA_SHARED_CHAINS_H
#define RAYA_CHAINS 8
#endif
