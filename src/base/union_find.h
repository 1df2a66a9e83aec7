/* Which things hang together: a forest in which the least member of a group is its root
 * (union-find with path halving, Tarjan and van Leeuwen 1984). */
#ifndef LAR_BASE_UNION_FIND_H
#define LAR_BASE_UNION_FIND_H

#include <stdint.h>

/* Everybody alone: parent[i] = i. */
static inline void lar_union_start(int32_t *parent, int32_t count) {
    for (int32_t i = 0; i < count; i++) parent[i] = i;
}

/* The least member of i's group. */
static inline int32_t lar_union_root(int32_t *parent, int32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Makes one group of those of a and b. */
static inline void lar_union_join(int32_t *parent, int32_t a, int32_t b) {
    a = lar_union_root(parent, a);
    b = lar_union_root(parent, b);
    parent[a > b ? a : b] = a > b ? b : a;
}

#endif
