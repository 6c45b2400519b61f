// How many chains of operations each work-item of number/operations.cl follows at once: the
// kernel repeats, the host counts.
#ifndef RAYA_SHARED_CHAINS_H
#define RAYA_SHARED_CHAINS_H
#define RAYA_CHAINS 8
#endif
