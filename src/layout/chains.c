#include "layout/chains.h"

#include <stdlib.h>
#include <string.h>

/* The element that begins where e ends, or -1. */
static lar_gid follower(const lar_chains *chains, lar_gid e) {
    const int32_t *node = chains->corner[e];
    for (int32_t at = chains->first[node[lar_line_right[0]]]; at > 0; at = chains->other[at - 1]) {
        lar_gid n = (at - 1) / 4;
        bool fits = n != e && chains->previous[n] == 0;
        for (int line = 0; fits && line < 4; line++)
            fits = chains->corner[n][lar_line_left[line]] == node[lar_line_right[line]];
        if (fits) return n;
    }
    return -1;
}

bool lar_chains_create(const lar_mesh *mesh, const int32_t (*corner)[8], const lar_gid *elements,
                       int32_t count, lar_chains *chains) {
    size_t all = (size_t)mesh->element_count;
    *chains = (lar_chains){.corner = corner};
    chains->next = lar_calloc(all, sizeof *chains->next);
    chains->previous = lar_calloc(all, sizeof *chains->previous);
    chains->first = lar_calloc((size_t)mesh->node_count, sizeof *chains->first);
    chains->other = lar_calloc(4 * all, sizeof *chains->other);
    if (!chains->next || !chains->previous || !chains->first || !chains->other) return false;
    for (int32_t i = 0; i < count; i++)
        for (int line = 0; line < 4; line++) {
            int32_t edge = 4 * elements[i] + line;
            int32_t *first = &chains->first[corner[elements[i]][lar_line_left[line]]];
            chains->other[edge] = *first;
            *first = 1 + edge;
        }
    for (int32_t i = 0; i < count; i++) {
        lar_gid e = elements[i], n = follower(chains, e);
        if (n < 0) continue;
        chains->next[e] = 1 + n;
        chains->previous[n] = 1 + e;
    }
    return true;
}

void lar_chains_destroy(lar_chains *chains) {
    free(chains->next);
    free(chains->previous);
    free(chains->first);
    free(chains->other);
    *chains = (lar_chains){0};
}

static int trace_chain(const lar_row_ways *ways, const lar_draft *draft, lar_gid e, int front,
                       int max, int32_t *run, int32_t (*corner)[8]) {
    const lar_chains *chains = ways->map;
    const bool *usable = draft->open;
    (void)front; /* there is only one */
    lar_gid first = e, at;
    for (int steps = 0; steps < max / 2; steps++) {
        lar_gid behind = chains->previous[first] - 1;
        if (behind < 0 || !usable[behind] || behind == e) break;
        first = behind;
    }
    int length = 0;
    for (at = first; at >= 0 && usable[at] && length < max; at = chains->next[at] - 1) {
        if (length > 0 && at == first) break;
        memcpy(corner[length], chains->corner[at], sizeof corner[0]);
        run[length++] = at;
    }
    return length;
}

static lar_gid beyond_edge(const lar_row_ways *ways, const lar_draft *draft, lar_gid *e,
                           lar_gid from, lar_gid to) {
    const lar_chains *chains = ways->map;
    (void)draft;
    for (int backwards = 0; backwards < 2; backwards++) {
        lar_gid left = backwards ? to : from, right = backwards ? from : to;
        const int32_t *link = backwards ? chains->previous : chains->next;
        const int *end = backwards ? lar_line_left : lar_line_right;
        for (int32_t at = chains->first[left]; at > 0; at = chains->other[at - 1]) {
            lar_gid here = (at - 1) / 4, there = link[here] - 1;
            int line = (at - 1) % 4;
            if (chains->corner[here][lar_line_right[line]] != right || there < 0) continue;
            *e = there;
            return chains->corner[there][end[line]];
        }
    }
    return -1;
}

lar_row_ways lar_chains_ways(const lar_chains *chains) {
    return (lar_row_ways){
        .map = chains, .turned = true, .trace = trace_chain, .beyond = beyond_edge};
}
