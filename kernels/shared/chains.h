// Independent chains of operations in each work-item of number/operations.cl; the host multiplies by it to count them.
#ifndef RAYA_SHARED_CHAINS_H
#define RAYA_SHARED_CHAINS_H
#define RAYA_CHAINS 8
#endif
