/* Gaps are filled with elements that no send needs, and their elements handed to threads.
 *
 * Numbers first: as water finds its level, gaps get so much that all are as long as the longest
 * allows, and threads so much that all have recovered as many elements at the end of each gap.
 * Then the elements: a set is cut across its longest axis, again and again, so that each thread has
 * one compact piece, near to what it has already; its piece of the rest is cut into slabs, one for
 * each gap. Neighbours stay together (the engine threads them into rows).
 */
#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"
#include "divide/schedule/plan.h"

/* ---- numbers ---------------------------------------------------------------------------- */

/* Pours `amount` over the entries that are in use so that have[i] + give[i] is as level as can be;
 * what does not come out even goes to the later ones. */
static void pour(int32_t count, const int64_t *have, const bool *use, int64_t amount,
                 int64_t *give) {
    int64_t low = INT64_MAX, high, poured = 0;
    for (int32_t i = 0; i < count; i++)
        if (use[i] && have[i] < low) low = have[i];
    assert(low < INT64_MAX);
    /* The highest level for which there is enough. */
    for (high = low + amount; low < high;) {
        int64_t level = low + (high - low + 1) / 2, need = 0;
        for (int32_t i = 0; i < count; i++)
            if (use[i] && have[i] < level) need += level - have[i];
        if (need <= amount)
            low = level;
        else
            high = level - 1;
    }
    for (int32_t i = 0; i < count; i++)
        poured += give[i] = use[i] && have[i] < low ? low - have[i] : 0;
    for (int32_t i = count - 1; i >= 0 && poured < amount; i--)
        if (use[i] && have[i] <= low) {
            give[i]++;
            poured++;
        }
    assert(poured == amount);
}

typedef struct shares {
    int32_t gaps, threads;
    int64_t needed[LAR_GAPS_MAX][LAR_THREADS_MAX]; /* of those the relay needs */
    int64_t fill[LAR_GAPS_MAX][LAR_THREADS_MAX];   /* of the others */
} shares;

static int64_t all_needed(const lar_plan *plan) {
    const lar_plan_gap *last = &plan->gap[plan->gap_count - 1];
    return last->first;
}

static void fill_gaps(const lar_plan *plan, int64_t *fill) {
    int64_t have[LAR_GAPS_MAX];
    bool use[LAR_GAPS_MAX], any = false;
    for (int32_t g = 0; g < plan->gap_count; g++) {
        have[g] = (int64_t)plan->gap[g].needed + plan->gap[g].before;
        any |= use[g] = plan->gap[g].receives;
    }
    if (!any) use[plan->gap_count - 1] = true;
    pour(plan->gap_count, have, use, plan->pooled - all_needed(plan), fill);
}

/* In each gap, threads come level; of what the relay needs each takes in proportion. */
static void count_shares(const lar_plan *plan, shares *s) {
    int64_t fill[LAR_GAPS_MAX], load[LAR_THREADS_MAX] = {0}, give[LAR_THREADS_MAX];
    bool use[LAR_THREADS_MAX];
    for (int32_t b = 0; b < plan->batch_count; b++)
        load[plan->batch[b].thread] += plan->batch[b].elements;
    for (int32_t t = 0; t < plan->threads; t++) use[t] = true;
    fill_gaps(plan, fill);
    for (int32_t g = 0; g < plan->gap_count; g++) {
        int64_t needed = plan->gap[g].needed, amount = needed + fill[g], left = needed;
        pour(plan->threads, load, use, amount, give);
        for (int32_t t = 0; t < plan->threads; t++) {
            s->needed[g][t] = amount > 0 ? give[t] * needed / amount : 0;
            left -= s->needed[g][t];
            load[t] += give[t];
        }
        for (int32_t t = 0; t < plan->threads; t++) {
            int64_t more = give[t] - s->needed[g][t] < left ? give[t] - s->needed[g][t] : left;
            s->needed[g][t] += more;
            s->fill[g][t] = give[t] - s->needed[g][t];
            left -= more;
        }
    }
}

/* ---- cutting ---------------------------------------------------------------------------- */

typedef struct item {
    double key[3]; /* centre, along the longest axis first */
    int32_t element;
} item;

static int compare_items(const void *a, const void *b) {
    const item *x = a, *y = b;
    for (int i = 0; i < 3; i++)
        if (x->key[i] != y->key[i]) return x->key[i] < y->key[i] ? -1 : 1;
    return x->element < y->element ? -1 : x->element > y->element;
}

/* What the elements that a thread has already amount to. */
typedef struct weight {
    double sum[3];
    int64_t count;
} weight;

typedef struct cutter {
    lar_plan *plan;
    item *item; /* scratch */
    weight weight[LAR_THREADS_MAX];
} cutter;

/* Axes of the bounding box, the longest first. */
static void order_axes(const cutter *c, const int32_t *element, int64_t count, int axis[3]) {
    double length[3];
    for (int i = 0; i < 3; i++) {
        double low = 0, high = 0;
        for (int64_t j = 0; j < count; j++) {
            double x = c->plan->site->centre[element[j]][i];
            if (j == 0 || x < low) low = x;
            if (j == 0 || x > high) high = x;
        }
        length[i] = high - low;
        int at = i;
        for (; at > 0 && length[axis[at - 1]] < length[i]; at--) axis[at] = axis[at - 1];
        axis[at] = i;
    }
}

/* Sorts elements along the longest axis of their box, which is returned. */
static int sort_along(cutter *c, int32_t *element, int64_t count) {
    int axis[3];
    order_axes(c, element, count, axis);
    for (int64_t j = 0; j < count; j++) {
        const double *centre = c->plan->site->centre[element[j]];
        c->item[j] = (item){{centre[axis[0]], centre[axis[1]], centre[axis[2]]}, element[j]};
    }
    qsort(c->item, (size_t)count, sizeof *c->item, compare_items);
    for (int64_t j = 0; j < count; j++) element[j] = c->item[j].element;
    return axis[0];
}

/* Threads in the order of where their elements are along an axis; one without any stands at the
 * middle of what is cut now. */
static void order_threads(const cutter *c, int axis, double middle, int32_t *thread,
                          int32_t threads) {
    double at[LAR_THREADS_MAX];
    for (int32_t i = 0; i < threads; i++) {
        const weight *w = &c->weight[thread[i]];
        double here = w->count > 0 ? w->sum[axis] / (double)w->count : middle;
        int32_t t = thread[i], j = i;
        for (; j > 0 && at[j - 1] > here; j--) {
            at[j] = at[j - 1];
            thread[j] = thread[j - 1];
        }
        at[j] = here;
        thread[j] = t;
    }
}

/* Reorders the elements so that each of these threads has its share[thread] in one piece, which is
 * noted in piece[thread]. */
static void cut_for_threads(cutter *c, int32_t *element, int64_t count, const int64_t *share,
                            int32_t *thread, int32_t threads, int32_t **piece) {
    if (threads == 1) {
        piece[thread[0]] = element;
        return;
    }
    int axis = sort_along(c, element, count);
    double middle = count > 0 ? c->plan->site->centre[element[count / 2]][axis] : 0;
    order_threads(c, axis, middle, thread, threads);
    int32_t half = threads / 2;
    int64_t first = 0;
    for (int32_t i = 0; i < half; i++) first += share[thread[i]];
    cut_for_threads(c, element, first, share, thread, half, piece);
    cut_for_threads(c, element + first, count - first, share, thread + half, threads - half, piece);
}

static void put(cutter *c, const int32_t *element, int64_t count, int32_t batch) {
    lar_plan *plan = c->plan;
    weight *w = &c->weight[plan->batch[batch].thread];
    for (int64_t j = 0; j < count; j++) {
        plan->site->batch[element[j]] = batch;
        for (int i = 0; i < 3; i++) w->sum[i] += plan->site->centre[element[j]][i];
    }
    w->count += count;
    plan->batch[batch].elements += (int32_t)count;
}

static void weigh_units(cutter *c) {
    const lar_plan_site *site = c->plan->site;
    for (int32_t i = 0; i < c->plan->element_count; i++) {
        int32_t e = c->plan->element[i];
        if (site->batch[e] < 0) continue;
        weight *w = &c->weight[c->plan->batch[site->batch[e]].thread];
        for (int axis = 0; axis < 3; axis++) w->sum[axis] += site->centre[e][axis];
        w->count++;
    }
}

static void cut_needed(cutter *c, const shares *s) {
    int32_t thread[LAR_THREADS_MAX], *piece[LAR_THREADS_MAX];
    for (int32_t g = 0; g < c->plan->gap_count; g++) {
        const lar_plan_gap *gap = &c->plan->gap[g];
        for (int32_t t = 0; t < c->plan->threads; t++) thread[t] = t;
        cut_for_threads(c, c->plan->pool + gap->first, gap->needed, s->needed[g], thread,
                        c->plan->threads, piece);
        for (int32_t t = 0; t < c->plan->threads; t++)
            put(c, piece[t], s->needed[g][t], gap->batch[t]);
    }
}

static void cut_rest(cutter *c, const shares *s) {
    int32_t thread[LAR_THREADS_MAX], *piece[LAR_THREADS_MAX];
    int64_t share[LAR_THREADS_MAX] = {0}, first = all_needed(c->plan);
    for (int32_t t = 0; t < c->plan->threads; t++) {
        thread[t] = t;
        for (int32_t g = 0; g < c->plan->gap_count; g++) share[t] += s->fill[g][t];
    }
    cut_for_threads(c, c->plan->pool + first, c->plan->pooled - first, share, thread,
                    c->plan->threads, piece);
    for (int32_t t = 0; t < c->plan->threads; t++) {
        if (c->plan->gap_count > 1) sort_along(c, piece[t], share[t]);
        for (int32_t g = 0; g < c->plan->gap_count; g++) {
            put(c, piece[t], s->fill[g][t], c->plan->gap[g].batch[t]);
            piece[t] += s->fill[g][t];
        }
    }
}

lar_status lar_plan_shares(lar_plan *plan, lar_error *error) {
    cutter c = {.plan = plan, .item = lar_calloc((size_t)plan->pooled, sizeof *c.item)};
    shares *s = lar_calloc(1, sizeof *s);
    lar_status status = LAR_OK;
    if (c.item && s) {
        count_shares(plan, s);
        weigh_units(&c);
        cut_needed(&c, s);
        cut_rest(&c, s);
    } else {
        status = lar_fail_memory(error, (size_t)plan->pooled * sizeof *c.item, "shares of threads");
    }
    free(c.item);
    free(s);
    return status;
}
