/* Which thread takes which unit, and in which order (T 6.7).
 *
 * Packets of equal urgency become units, small ones several together: a vector with empty lanes
 * takes as long as a full one. n units can be given to T threads in n! T^n orders, less for threads
 * that are alike. A branch of the search places one unit after the other:
 *
 *     clock      elements of the units on a thread so far, and its waiting
 *     elements   a unit gets those at its nodes that no unit before it has
 *     waiting    others have sums that it sends: it can send when they are done. What comes less
 *                than SLACK elements after that counts too: clocks are only expectations
 *
 * Least waiting is best, then the earliest end. A branch that cannot become better than the best is
 * cut; the first one takes the best next unit each time, so that an early end is a good end.
 *
 * Elements with the same set of units behave alike and are counted together.
 */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "divide/schedule/plan.h"

enum { UNITS_MAX = 24, SLACK = 8 };

typedef struct unit {
    lar_plan_packet **packet;
    int32_t packets;
    int64_t ready[LAR_THREADS_MAX]; /* when the batches so far of a thread have what it sends */
} unit;

typedef struct move {
    int32_t unit, thread;
    int64_t gain; /* elements */
    int64_t wait, finish;
} move;

typedef struct search {
    int32_t units, threads, kinds;
    const unit *unit;
    uint64_t *kind;    /* [kinds] units that need these elements */
    int64_t *elements; /* [kinds] */
    move *moves;       /* [units][units * threads] scratch of each depth */
    uint64_t placed;
    int64_t clock[LAR_THREADS_MAX];
    uint64_t needs[UNITS_MAX]; /* units that have elements of this one */
    move path[UNITS_MAX];      /* by unit: where and when */
    int32_t order[UNITS_MAX], best_order[UNITS_MAX];
    move best[UNITS_MAX];
    int64_t best_wait, best_end, enough;
    int64_t tried, max;
    bool found, done;
} search;

/* ---- the search ------------------------------------------------------------------------- */

/* What each unit would get now; returns what is left for all. */
static int64_t find_gains(const search *s, int64_t *gain) {
    int64_t left = 0;
    memset(gain, 0, (size_t)s->units * sizeof *gain);
    for (int32_t c = 0; c < s->kinds; c++) {
        if (s->kind[c] & s->placed) continue;
        left += s->elements[c];
        for (int32_t u = 0; u < s->units; u++)
            if (s->kind[c] >> u & 1) gain[u] += s->elements[c];
    }
    return left;
}

static move look_at(const search *s, int32_t u, int32_t thread, int64_t gain) {
    int64_t ready = s->clock[thread] + gain, others = 0;
    for (int32_t t = 0; t < s->threads; t++)
        if (t != thread && s->unit[u].ready[t] > others) others = s->unit[u].ready[t];
    for (int32_t v = 0; v < s->units; v++)
        if (s->needs[u] >> v & 1 && s->path[v].thread != thread && s->path[v].finish > others)
            others = s->path[v].finish;
    move m = {u, thread, gain, 0, ready > others ? ready : others};
    if (others > 0 && others + SLACK > ready) m.wait = others + SLACK - ready;
    return m;
}

static int compare_moves(const void *a, const void *b) {
    const move *x = a, *y = b;
    if (x->wait != y->wait) return x->wait < y->wait ? -1 : 1;
    if (x->finish != y->finish) return x->finish < y->finish ? -1 : 1;
    if (x->unit != y->unit) return x->unit < y->unit ? -1 : 1;
    return x->thread < y->thread ? -1 : x->thread > y->thread;
}

static int32_t list_moves(const search *s, const int64_t *gain, move *moves) {
    int32_t count = 0;
    for (int32_t u = 0; u < s->units; u++) {
        if (s->placed >> u & 1) continue;
        bool idle = false; /* threads without work are alike */
        for (int32_t t = 0; t < s->threads; t++) {
            if (idle && s->clock[t] == 0) continue;
            idle |= s->clock[t] == 0;
            moves[count++] = look_at(s, u, t, gain[u]);
        }
    }
    qsort(moves, (size_t)count, sizeof *moves, compare_moves);
    return count;
}

/* No end can be earlier than this. */
static int64_t earliest_end(const search *s, int64_t left) {
    int64_t end = 0, sum = left;
    for (int32_t t = 0; t < s->threads; t++) {
        if (s->clock[t] > end) end = s->clock[t];
        sum += s->clock[t];
    }
    int64_t mean = (sum + s->threads - 1) / s->threads;
    return mean > end ? mean : end;
}

static bool hopeless(const search *s, int64_t wait, int64_t left) {
    if (!s->found || wait < s->best_wait) return false;
    return wait > s->best_wait || earliest_end(s, left) >= s->best_end;
}

static void place(search *s, const move *m) {
    for (int32_t c = 0; c < s->kinds; c++) {
        if (s->kind[c] & s->placed || !(s->kind[c] >> m->unit & 1)) continue;
        for (int32_t v = 0; v < s->units; v++)
            if (s->kind[c] >> v & 1) s->needs[v] |= 1ULL << m->unit;
    }
    s->placed |= 1ULL << m->unit;
    s->path[m->unit] = *m;
    s->clock[m->thread] = m->finish;
}

static void take_back(search *s, const move *m, int64_t clock) {
    for (int32_t v = 0; v < s->units; v++) s->needs[v] &= ~(1ULL << m->unit);
    s->placed &= ~(1ULL << m->unit);
    s->clock[m->thread] = clock;
}

static void keep_best(search *s, int64_t wait) {
    int64_t end = earliest_end(s, 0);
    s->tried++;
    s->found = true;
    s->best_wait = wait;
    s->best_end = end;
    memcpy(s->best, s->path, sizeof s->best);
    memcpy(s->best_order, s->order, sizeof s->best_order);
    s->done = wait == 0 && end <= s->enough;
}

static void explore(search *s, int32_t depth, int64_t wait) {
    int64_t gain[UNITS_MAX];
    int64_t left = find_gains(s, gain);
    if (hopeless(s, wait, left)) {
        s->tried++;
        return;
    }
    if (depth == s->units) {
        keep_best(s, wait);
        return;
    }
    move *moves = s->moves + (size_t)depth * (size_t)(s->units * s->threads);
    int32_t count = list_moves(s, gain, moves);
    for (int32_t i = 0; i < count && !s->done; i++) {
        int64_t clock = s->clock[moves[i].thread];
        s->order[depth] = moves[i].unit;
        place(s, &moves[i]);
        explore(s, depth + 1, wait + moves[i].wait);
        take_back(s, &moves[i], clock);
        s->done |= s->found && s->tried >= s->max;
    }
}

/* ---- what is searched ------------------------------------------------------------------- */

static int compare_words(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Notes in site->kind which elements unit u needs, and when it has the sums of batches before. */
static void look_around(lar_plan *plan, unit *own, int32_t u) {
    const lar_plan_site *site = plan->site;
    for (int32_t i = 0; i < own->packets; i++) {
        const int32_t *node = site->packets.node + own->packet[i]->first;
        for (int32_t k = 0; k < own->packet[i]->count; k++)
            for (int64_t j = site->incidence->first[node[k]];
                 j < site->incidence->first[node[k] + 1]; j++) {
                int32_t e = site->incidence->element[j], batch = site->batch[e];
                if (site->distribution->processor[e] != plan->processor) continue;
                if (batch == LAR_NOWHERE) site->kind[e] |= 1ULL << u;
                if (batch < plan->first_unit) continue;
                int64_t *ready = &own->ready[plan->batch[batch].thread];
                if (plan->batch[batch].finish > *ready) *ready = plan->batch[batch].finish;
            }
    }
}

/* Collects the different kinds among the processor's elements. */
static lar_status find_kinds(lar_plan *plan, search *s, lar_error *error) {
    size_t max = (size_t)plan->element_count, count = 0;
    uint64_t *kind = lar_calloc(max, sizeof *kind);
    int64_t *elements = lar_calloc(max, sizeof *elements);
    s->kind = kind;
    s->elements = elements;
    if (!kind || !elements) return lar_fail_memory(error, max * sizeof *kind, "kinds of elements");
    for (size_t i = 0; i < max; i++) {
        uint64_t *of = &plan->site->kind[plan->element[i]];
        if (*of) kind[count++] = *of;
        *of = 0;
    }
    qsort(kind, count, sizeof *kind, compare_words);
    for (size_t i = 0; i < count; i++) {
        if (i == 0 || kind[i] != kind[s->kinds - 1]) kind[s->kinds++] = kind[i];
        elements[s->kinds - 1]++;
    }
    return LAR_OK;
}

static lar_status run_search(lar_plan *plan, unit *units, int32_t count, search *s,
                             lar_error *error) {
    *s = (search){.units = count, .threads = plan->threads, .unit = units};
    for (int32_t u = 0; u < count; u++) look_around(plan, &units[u], u);
    lar_status status = find_kinds(plan, s, error);
    size_t moves = (size_t)count * (size_t)(count * plan->threads);
    s->moves = lar_calloc(moves, sizeof *s->moves);
    if (!s->moves) status = lar_fail_memory(error, moves * sizeof *s->moves, "a search");
    if (status == LAR_OK) {
        int64_t gain[UNITS_MAX];
        memcpy(s->clock, plan->clock, sizeof s->clock);
        s->enough = earliest_end(s, find_gains(s, gain));
        /* Half of what is left: the groups that follow want to search, too. */
        s->max = (plan->site->options->search - plan->tried + 1) / 2;
        explore(s, 0, 0);
        plan->tried += s->tried;
    }
    free(s->kind);
    free(s->elements);
    free(s->moves);
    return status;
}

/* ---- units ------------------------------------------------------------------------------ */

/* Elements that a vector or, of a small group, each thread should have at least. */
static int32_t min_elements(const lar_plan *plan, int32_t elements) {
    int32_t share = (elements + plan->threads - 1) / plan->threads;
    return share < LAR_UNIT_MIN ? share : LAR_UNIT_MIN;
}

/* Packets that follow each other form a unit until it has enough elements. Returns the units. */
static int32_t make_units(lar_plan *plan, lar_plan_packet **packet, int32_t count, unit *units,
                          int32_t *fresh) {
    int32_t *list = plan->pool + plan->pooled, total = 0, made = 0, have = 0;
    for (int32_t i = 0; i < count; i++)
        total += fresh[i] = lar_plan_claim(plan, packet[i], LAR_POOLED, list + total);
    for (int32_t i = 0; i < total; i++) plan->site->batch[list[i]] = LAR_NOWHERE;
    int32_t min = min_elements(plan, total);
    for (int32_t i = 0; i < count; i++) {
        if (i == 0 || have >= min) {
            units[made++] = (unit){.packet = packet + i};
            have = 0;
        }
        units[made - 1].packets++;
        have += fresh[i];
    }
    return made;
}

/* A unit's batch: a new one, or the last of all where that is small and on the same thread. */
static int32_t batch_for(lar_plan *plan, int32_t thread) {
    int32_t last = plan->batch_count - 1;
    if (last >= plan->first_unit && plan->batch[last].thread == thread &&
        plan->batch[last].elements < LAR_UNIT_MIN / plan->threads)
        return last;
    return lar_plan_add_batch(plan, thread);
}

static lar_status settle(lar_plan *plan, const unit *own, const move *m, lar_error *error) {
    int32_t batch = batch_for(plan, m->thread);
    if (batch == LAR_NOWHERE) return lar_fail_memory(error, sizeof *plan->batch, "batches");
    for (int32_t i = 0; i < own->packets; i++) {
        own->packet[i]->sent_in = batch;
        int32_t elements = lar_plan_claim(plan, own->packet[i], batch, NULL);
        plan->batch[batch].elements += elements;
        plan->since += elements;
    }
    plan->batch[batch].finish = m->finish;
    plan->clock[m->thread] = m->finish;
    return LAR_OK;
}

/* Whether a thread would have more than its share of all elements, so that nothing could make the
 * threads even again. */
static bool overloads(const lar_plan *plan, const search *s) {
    int64_t load[LAR_THREADS_MAX] = {0};
    for (int32_t b = 0; b < plan->batch_count; b++)
        load[plan->batch[b].thread] += plan->batch[b].elements;
    for (int32_t u = 0; u < s->units; u++) load[s->best[u].thread] += s->best[u].gain;
    for (int32_t t = 0; t < plan->threads; t++)
        if ((load[t] - 1) * plan->threads >= plan->element_count) return true;
    return false;
}

static lar_status settle_searched(lar_plan *plan, unit *units, int32_t count, lar_error *error) {
    search s;
    lar_status status = run_search(plan, units, count, &s, error);
    if (status == LAR_OK && plan->gap_count < LAR_GAPS_MAX / 2 && overloads(plan, &s)) {
        int32_t packets = 0;
        for (int32_t u = 0; u < count; u++) packets += units[u].packets;
        return lar_plan_split(plan, units->packet, packets, error);
    }
    for (int32_t j = 0; j < count && status == LAR_OK; j++) {
        const move *m = &s.best[s.best_order[j]];
        status = settle(plan, &units[m->unit], m, error);
    }
    return status;
}

static lar_status settle_all(lar_plan *plan, unit *units, int32_t count, lar_error *error) {
    lar_status status = LAR_OK;
    if (plan->threads == 1)
        for (int32_t i = 0; i < count && status == LAR_OK; i++)
            status = settle(plan, &units[i], &(move){.unit = i}, error);
    else
        for (int32_t i = 0; i < count && status == LAR_OK; i += UNITS_MAX)
            status = settle_searched(plan, units + i, count - i < UNITS_MAX ? count - i : UNITS_MAX,
                                     error);
    return status;
}

lar_status lar_plan_units(lar_plan *plan, lar_plan_packet **packet, int32_t count,
                          lar_error *error) {
    unit *units = lar_calloc((size_t)count, sizeof *units);
    int32_t *fresh = lar_calloc((size_t)count, sizeof *fresh);
    lar_status status;
    if (units && fresh)
        status = settle_all(plan, units, make_units(plan, packet, count, units, fresh), error);
    else
        status = lar_fail_memory(error, (size_t)count * sizeof *units, "units");
    free(units);
    free(fresh);
    return status;
}
