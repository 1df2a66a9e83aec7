/* The state hash: 64 bits over a sequence of 64-bit words, in order.
 *
 * Not cryptographic; every word changes about half of all bits (multiply and fold, with the
 * constants of the golden ratio and of Steele and Vigna's splitmix64 finaliser).
 */
#ifndef LAR_BASE_HASH_H
#define LAR_BASE_HASH_H

#include <stdint.h>
#include <string.h>

static inline uint64_t lar_hash_word(uint64_t hash, uint64_t word) {
    uint64_t x = (hash ^ word) + 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

static inline uint64_t lar_hash_double(uint64_t hash, double value) {
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    return lar_hash_word(hash, word);
}

#endif
