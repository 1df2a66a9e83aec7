#include "meshing/starter/elastic_factor.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

/* ---- the order ------------------------------------------------------------------------------ */

/* Unknowns, ascending. */
typedef struct list {
    int32_t *one;
    size_t count, capacity;
} list;

/* Who knows whom of those that are left, and chains of equal degree. */
typedef struct graph {
    int32_t count;
    list *near;                    /* [count] */
    int32_t *first, *next, *prior; /* [count] -1: none */
    list merged, row;              /* scratch; all columns' rows, as unknowns */
} graph;

static void unchain(graph *g, int32_t v) {
    if (g->next[v] >= 0) g->prior[g->next[v]] = g->prior[v];
    if (g->prior[v] >= 0)
        g->next[g->prior[v]] = g->next[v];
    else
        g->first[g->near[v].count] = g->next[v];
}

static void chain(graph *g, int32_t v) {
    int32_t *first = &g->first[g->near[v].count];
    g->prior[v] = -1;
    g->next[v] = *first;
    if (*first >= 0) g->prior[*first] = v;
    *first = v;
}

static int compare(const void *a, const void *b) {
    const int32_t *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

static bool append(list *to, int32_t v) {
    if (!LAR_GROW(to->one, to->capacity, to->count)) return false;
    to->one[to->count++] = v;
    return true;
}

static bool know_each_other(graph *g, const int32_t (*pair)[2], size_t pairs) {
    for (size_t k = 0; k < pairs; k++)
        for (int end = 0; end < 2; end++)
            if (pair[k][0] != pair[k][1] && !append(&g->near[pair[k][end]], pair[k][!end]))
                return false;
    for (int32_t v = 0; v < g->count; v++) {
        list *near = &g->near[v];
        size_t kept = 0;
        if (near->count > 1) qsort(near->one, near->count, sizeof *near->one, compare);
        for (size_t k = 0; k < near->count; k++)
            if (kept == 0 || near->one[kept - 1] != near->one[k]) near->one[kept++] = near->one[k];
        near->count = kept;
    }
    return true;
}

/* w now knows all that v knew, and v no longer. */
static bool inherit(graph *g, int32_t w, int32_t v) {
    const list *own = &g->near[w], *more = &g->near[v];
    size_t i = 0, k = 0;
    g->merged.count = 0;
    while (i < own->count || k < more->count) {
        int32_t a = i < own->count ? own->one[i] : INT32_MAX;
        int32_t b = k < more->count ? more->one[k] : INT32_MAX;
        int32_t next = a < b ? a : b;
        i += a == next;
        k += b == next;
        if (next != v && next != w && !append(&g->merged, next)) return false;
    }
    unchain(g, w);
    const list old = *own;
    g->near[w] = g->merged;
    g->merged = old;
    chain(g, w);
    return true;
}

/* Takes v out; its column is what it knew. */
static bool eliminate(graph *g, int32_t v) {
    list *near = &g->near[v];
    unchain(g, v);
    bool ready = append(&g->row, v);
    for (size_t k = 0; ready && k < near->count; k++)
        ready = append(&g->row, near->one[k]) && inherit(g, near->one[k], v);
    free(near->one);
    *near = (list){0};
    return ready;
}

static bool begin(graph *g, int32_t count, const int32_t (*pair)[2], size_t pairs) {
    const size_t n = (size_t)count;
    *g = (graph){.count = count,
                 .near = lar_calloc(n, sizeof *g->near),
                 .first = lar_calloc(n, sizeof *g->first),
                 .next = lar_calloc(n, sizeof *g->next),
                 .prior = lar_calloc(n, sizeof *g->prior)};
    if (!g->near || !g->first || !g->next || !g->prior) return false;
    if (!know_each_other(g, pair, pairs)) return false;
    for (int32_t v = 0; v < count; v++) g->first[v] = -1;
    for (int32_t v = count - 1; v >= 0; v--) chain(g, v);
    return true;
}

static void end(graph *g) {
    for (int32_t v = 0; g->near && v < g->count; v++) free(g->near[v].one);
    free(g->near);
    free(g->first);
    free(g->next);
    free(g->prior);
    free(g->merged.one);
    free(g->row.one);
}

/* ---- the blocks ----------------------------------------------------------------------------- */

/* Where columns start, and which unknown becomes which. */
static bool order(graph *g, size_t *start, int32_t *place) {
    int32_t degree = 0;
    for (int32_t column = 0; column < g->count; column++) {
        degree = degree > 0 ? degree - 1 : 0; /* of a neighbour of the last one */
        while (g->first[degree] < 0) degree++;
        const int32_t v = g->first[degree];
        place[v] = column;
        start[column] = g->row.count;
        if (!eliminate(g, v)) return false;
    }
    start[g->count] = g->row.count;
    return true;
}

lar_status lar_factor_lay(int32_t count, const int32_t (*pair)[2], size_t pairs, int32_t *place,
                          lar_factor *factor, lar_error *error) {
    graph g;
    *factor =
        (lar_factor){.count = count, .start = lar_calloc((size_t)count + 1, sizeof *factor->start)};
    bool ready = begin(&g, count, pair, pairs) && factor->start;
    ready = ready && order(&g, factor->start, place);
    const size_t blocks = ready ? g.row.count : pairs;
    if (ready) {
        factor->row = g.row.one;
        g.row.one = NULL;
        for (size_t k = 0; k < blocks; k++) factor->row[k] = place[factor->row[k]];
        for (int32_t c = 0; c < count; c++)
            qsort(factor->row + factor->start[c], factor->start[c + 1] - factor->start[c],
                  sizeof *factor->row, compare);
        factor->block = lar_calloc(blocks, sizeof *factor->block);
    }
    end(&g);
    if (ready && (factor->block || blocks == 0)) return LAR_OK;
    lar_factor_clear(factor);
    return lar_fail_memory(error, blocks * sizeof *factor->block, "a coarse matrix");
}

void lar_factor_clear(lar_factor *factor) {
    free(factor->start);
    free(factor->row);
    free(factor->block);
    *factor = (lar_factor){0};
}

lar_factor_block *lar_factor_at(lar_factor *factor, int32_t row, int32_t column) {
    size_t low = factor->start[column], high = factor->start[column + 1] - 1;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (factor->row[middle] < row)
            low = middle + 1;
        else
            high = middle;
    }
    return &factor->block[low];
}

/* ---- the factor ----------------------------------------------------------------------------- */

/* The lower half of a block on the diagonal, which keeps inverses on it. `whole`: what stood on the
 * diagonal at first. */
static void compute_diagonal(lar_factor_block a, const double whole[LAR_FACTOR_BLOCK]) {
    static const double NOTHING = 1e-9;
    for (int r = 0; r < LAR_FACTOR_BLOCK; r++) {
        double pivot = a[r][r];
        for (int c = 0; c < r; c++) {
            for (int k = 0; k < c; k++) a[r][c] -= a[r][k] * a[c][k];
            a[r][c] *= a[c][c];
            pivot -= a[r][c] * a[r][c];
        }
        a[r][r] = pivot > NOTHING * whole[r] ? 1 / sqrt(pivot) : 0;
    }
}

/* A block below becomes that times the inverse of the diagonal one, transposed. */
static void compute_below(lar_factor_block b, const lar_factor_block diagonal) {
    for (int r = 0; r < LAR_FACTOR_BLOCK; r++)
        for (int c = 0; c < LAR_FACTOR_BLOCK; c++) {
            for (int k = 0; k < c; k++) b[r][c] -= b[r][k] * diagonal[c][k];
            b[r][c] *= diagonal[c][c];
        }
}

/* What is left of a later column: to -= a b^T. */
static void subtract(lar_factor_block to, const lar_factor_block a, const lar_factor_block b) {
    for (int r = 0; r < LAR_FACTOR_BLOCK; r++)
        for (int c = 0; c < LAR_FACTOR_BLOCK; c++)
            for (int k = 0; k < LAR_FACTOR_BLOCK; k++) to[r][c] -= a[r][k] * b[c][k];
}

lar_status lar_factor_compute(lar_factor *factor, lar_error *error) {
    double(*whole)[LAR_FACTOR_BLOCK] = lar_calloc((size_t)factor->count, sizeof *whole);
    if (!whole && factor->count > 0)
        return lar_fail_memory(error, (size_t)factor->count * sizeof *whole, "a coarse matrix");
    for (int32_t c = 0; c < factor->count; c++)
        for (int i = 0; i < LAR_FACTOR_BLOCK; i++)
            whole[c][i] = factor->block[factor->start[c]][i][i];
    for (int32_t c = 0; c < factor->count; c++) {
        lar_factor_block *block = factor->block;
        const int32_t *row = factor->row;
        const size_t own = factor->start[c], last = factor->start[c + 1];
        compute_diagonal(block[own], whole[c]);
        for (size_t k = own + 1; k < last; k++)
            compute_below(block[k], (const double(*)[LAR_FACTOR_BLOCK])block[own]);
        for (size_t k = own + 1; k < last; k++)
            for (size_t i = k; i < last; i++)
                subtract(*lar_factor_at(factor, row[i], row[k]),
                         (const double(*)[LAR_FACTOR_BLOCK])block[i],
                         (const double(*)[LAR_FACTOR_BLOCK])block[k]);
    }
    free(whole);
    return LAR_OK;
}

/* ---- in use --------------------------------------------------------------------------------- */

void lar_factor_solve(const lar_factor *factor, lar_pair *x) {
    for (int32_t c = 0; c < factor->count; c++) {
        lar_pair *own = x + (size_t)c * LAR_FACTOR_BLOCK;
        const lar_factor_block *diagonal = &factor->block[factor->start[c]];
        for (int r = 0; r < LAR_FACTOR_BLOCK; r++) {
            for (int k = 0; k < r; k++) own[r] -= (*diagonal)[r][k] * own[k];
            own[r] *= (*diagonal)[r][r];
        }
        for (size_t b = factor->start[c] + 1; b < factor->start[c + 1]; b++) {
            lar_pair *to = x + (size_t)factor->row[b] * LAR_FACTOR_BLOCK;
            for (int r = 0; r < LAR_FACTOR_BLOCK; r++)
                for (int k = 0; k < LAR_FACTOR_BLOCK; k++) to[r] -= factor->block[b][r][k] * own[k];
        }
    }
    for (int32_t c = factor->count - 1; c >= 0; c--) {
        lar_pair *own = x + (size_t)c * LAR_FACTOR_BLOCK;
        const lar_factor_block *diagonal = &factor->block[factor->start[c]];
        for (size_t b = factor->start[c] + 1; b < factor->start[c + 1]; b++) {
            const lar_pair *from = x + (size_t)factor->row[b] * LAR_FACTOR_BLOCK;
            for (int r = 0; r < LAR_FACTOR_BLOCK; r++)
                for (int k = 0; k < LAR_FACTOR_BLOCK; k++)
                    own[k] -= factor->block[b][r][k] * from[r];
        }
        for (int r = LAR_FACTOR_BLOCK - 1; r >= 0; r--) {
            own[r] *= (*diagonal)[r][r];
            for (int k = 0; k < r; k++) own[k] -= (*diagonal)[r][k] * own[r];
        }
    }
}
