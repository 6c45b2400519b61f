// A seeded pseudo-random permutation of the numbers 0 .. count - 1, for the random mapping.
//
// It is a Feistel network on the smallest number of bits that holds count - 1, split into a high and a low half. Each
// round xors one half with a hash of the other half, so the rounds in reverse order are the inverse. A result that is
// not in 0 .. count - 1 goes through the network again (cycle walking). A number takes at most two passes on average,
// because more than half of all numbers of that many bits are in the range. 1 <= count <= 2^28.
#ifndef RAYA_SHARED_SCRAMBLE_H
#define RAYA_SHARED_SCRAMBLE_H
#include "kernels/shared/portable.h"

#define RAYA_SCRAMBLE_ROUNDS 6u

// The finaliser of MurmurHash3 (A. Appleby, public domain): every bit of the result depends on every bit of x.
RAYA_SHARED_FUNCTION raya_u32 raya_mix(raya_u32 x) {
    x = (x ^ x >> 16) * 0x85ebca6bu;
    x = (x ^ x >> 13) * 0xc2b2ae35u;
    return x ^ x >> 16;
}

RAYA_SHARED_FUNCTION raya_u32 raya_scramble_bits(raya_u32 count) {
    raya_u32 bits = 0;
    while (1u << bits < count) ++bits;
    return bits;
}

// One round of the network on `bits` bits. A round is its own inverse.
RAYA_SHARED_FUNCTION raya_u32 raya_scramble_round(raya_u32 number, raya_u32 bits, raya_u32 seed, raya_u32 round) {
    const raya_u32 low = bits - bits / 2, low_mask = (1u << low) - 1, high_mask = (1u << bits / 2) - 1;
    // The key is hashed, so that consecutive seeds give unrelated permutations.
    const raya_u32 key = raya_mix(seed + (round + 1) * 0x9e3779b9u);
    if (round & 1u) return number ^ (raya_mix(key ^ number >> low) & low_mask);
    return number ^ (raya_mix(key ^ (number & low_mask)) & high_mask) << low;
}

// Returns the number to which the permutation maps `number`, which must be < count.
RAYA_SHARED_FUNCTION raya_u32 raya_scramble(raya_u32 number, raya_u32 count, raya_u32 seed) {
    const raya_u32 bits = raya_scramble_bits(count);
    do {
        for (raya_u32 round = 0; round < RAYA_SCRAMBLE_ROUNDS; ++round)
            number = raya_scramble_round(number, bits, seed, round);
    } while (number >= count);
    return number;
}

// The inverse of raya_scramble().
RAYA_SHARED_FUNCTION raya_u32 raya_unscramble(raya_u32 number, raya_u32 count, raya_u32 seed) {
    const raya_u32 bits = raya_scramble_bits(count);
    do {
        for (raya_u32 round = RAYA_SCRAMBLE_ROUNDS; round > 0; --round)
            number = raya_scramble_round(number, bits, seed, round - 1);
    } while (number >= count);
    return number;
}

#endif
