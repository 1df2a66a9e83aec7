/* Random numbers whose sequence is part of the program: the same for a seed on every machine.
 *
 * The state walks in steps of the golden ratio, the finaliser of base/hash.h mixes it (Steele and
 * Vigna's splitmix64). No libm: the normal variate is the sum of twelve uniform ones, less six,
 * near enough to a Gaussian for mutations.
 */
#ifndef LAR_DIVIDE_RANDOM_H
#define LAR_DIVIDE_RANDOM_H

#include "base/hash.h"

typedef struct lar_random {
    uint64_t state;
} lar_random;

static inline uint64_t lar_random_word(lar_random *random) {
    return lar_hash_word(0, random->state += 0x9e3779b97f4a7c15ULL);
}

/* Uniform in [0, 1). */
static inline double lar_random_unit(lar_random *random) {
    return (double)(lar_random_word(random) >> 11) * 0x1p-53;
}

/* Uniform in 0 .. count - 1; count up to 2^31. */
static inline int32_t lar_random_below(lar_random *random, int32_t count) {
    return (int32_t)((lar_random_word(random) >> 32) * (uint64_t)count >> 32);
}

/* Mean 0, variance 1. */
static inline double lar_random_normal(lar_random *random) {
    double sum = -6;
    for (int i = 0; i < 12; i++) sum += lar_random_unit(random);
    return sum;
}

#endif
