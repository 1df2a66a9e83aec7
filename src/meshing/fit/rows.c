#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel_for.h"
#include "meshing/fit/work.h"

/* A sweep on all cores with the bits of a sweep on one. What a node's move looks at, and changes,
 * belongs to nodes that are near it on the grid. So the order matters between near nodes only, and
 * for them it is kept: cores take rows of nodes one after the other, and in its row each stays
 * behind those in the rows before, by what may still be near.
 *
 *     row 7   o o o o o o o o o o o o o     done
 *     row 8   o o o o o o o o x . . . .     one core, at x
 *     row 9   o o o x . . . . . . . . .     the next one: all that is near x in row 8 is done
 *
 * This is the wavefront of Gauss-Seidel sweeps over grids (Lamport 1974, "The parallel execution of
 * DO loops"). */

enum { POLLS = 2000 }; /* then the core is left to others */
static const int32_t DONE = INT32_MAX;

void lar_fit_rows_clear(lar_fit_rows *rows) {
    free(rows->start);
    free(rows->ahead);
    *rows = (lar_fit_rows){0};
}

static bool follows(const int32_t before[3], const int32_t after[3]) {
    return before[2] == after[2] && before[1] == after[1] && before[0] < after[0];
}

lar_status lar_fit_rows_create(lar_fit_work *work, const lar_unfitted_mesh *unfitted,
                               lar_error *error) {
    lar_fit_rows *rows = &work->rows;
    const int32_t nodes = unfitted->mesh.node_count;
    rows->point = (const int32_t(*)[3])unfitted->point;
    rows->count = 0;
    for (int32_t n = 0; n < nodes; n++)
        rows->count += n == 0 || !follows(rows->point[n - 1], rows->point[n]);
    rows->start = lar_calloc((size_t)rows->count + 1, sizeof *rows->start);
    rows->ahead = lar_calloc((size_t)rows->count, sizeof *rows->ahead);
    if (!rows->start || !rows->ahead)
        return lar_fail_memory(error, 8 * (size_t)rows->count, "the rows of nodes");
    int32_t row = 0;
    for (int32_t n = 0; n < nodes; n++)
        if (n == 0 || !follows(rows->point[n - 1], rows->point[n])) rows->start[row++] = n;
    rows->start[row] = nodes;
    for (int i = 0; i < 3; i++) rows->touch[i] = 1;
    for (int32_t s = 0; s < unfitted->slot_count; s++)
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < a; b++)
                for (int i = 0; i < 3; i++) {
                    const int32_t far = abs(rows->point[unfitted->slot[s][a]][i] -
                                            rows->point[unfitted->slot[s][b]][i]);
                    if (far > rows->touch[i]) rows->touch[i] = far;
                }
    memcpy(rows->reach, rows->touch, sizeof rows->reach);
    return LAR_OK;
}

void lar_fit_rows_reach(lar_fit_rows *rows, const int32_t near[3]) {
    for (int i = 0; i < 3; i++)
        rows->reach[i] = near[i] > rows->touch[i] ? near[i] : rows->touch[i];
}

/* ---- the sweep ------------------------------------------------------------------------------- */

typedef struct sweep {
    lar_fit_work *work;
    lar_fit_visit *visit;
    int32_t sum; /* atomic */
} sweep;

/* Between two looks at what another core does. */
static void relax(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

static int32_t where_is(const lar_fit_rows *rows, int32_t row) {
    return __atomic_load_n(&rows->ahead[row], __ATOMIC_ACQUIRE);
}

/* Until a row has nothing left up to point `to` of the first axis. */
static void wait_for(const lar_fit_rows *rows, int32_t row, int32_t to) {
    for (int polls = 1; where_is(rows, row) <= to; polls++)
        if (polls % POLLS)
            relax();
        else
            sched_yield();
}

/* Whether nodes of two rows may be near each other. */
static bool are_near(const lar_fit_rows *rows, int32_t row, int32_t other) {
    const int32_t *a = rows->point[rows->start[row]], *b = rows->point[rows->start[other]];
    return abs(a[1] - b[1]) <= rows->reach[1] && abs(a[2] - b[2]) <= rows->reach[2];
}

/* The rows are taken in ascending order, so that those it waits for go on without it. */
static int32_t sweep_row(const sweep *all, int32_t row) {
    lar_fit_rows *rows = &all->work->rows;
    int32_t first = row, sum = 0; /* no row before `first` has nodes left that are near */
    while (first > 0 && rows->point[rows->start[row]][2] - rows->point[rows->start[first - 1]][2] <=
                            rows->reach[2])
        first--;
    for (int32_t n = rows->start[row]; n < rows->start[row + 1]; n++) {
        const int32_t to = rows->point[n][0] + rows->reach[0];
        while (first < row && (!are_near(rows, row, first) || where_is(rows, first) == DONE))
            first++;
        for (int32_t before = first; before < row; before++)
            if (are_near(rows, row, before)) wait_for(rows, before, to);
        sum += all->visit(all->work, n);
        const bool last = n + 1 == rows->start[row + 1];
        __atomic_store_n(&rows->ahead[row], last ? DONE : rows->point[n + 1][0], __ATOMIC_RELEASE);
    }
    return sum;
}

static void sweep_rows(void *context, int32_t first, int32_t end) {
    sweep *all = context;
    for (int32_t row = first; row < end; row++)
        __atomic_fetch_add(&all->sum, sweep_row(all, row), __ATOMIC_RELAXED);
}

int32_t lar_fit_rows_visit(lar_fit_work *work, lar_fit_visit *visit) {
    lar_fit_rows *rows = &work->rows;
    sweep all = {.work = work, .visit = visit};
    for (int32_t row = 0; row < rows->count; row++)
        rows->ahead[row] = rows->point[rows->start[row]][0];
    lar_parallel_for(rows->count, 1, sweep_rows, &all);
    return all.sum;
}
