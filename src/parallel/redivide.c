/* Dividing anew under way. Where instruments press, elements are measured, kept from turning inside
 * out and pushed, which costs many times what an element at rest does, and all of it stands on the
 * processors that have these elements (docs/performance.md).
 *
 *     some stretches are timed    busy seconds of each processor, waits for others left out
 *     now and then                what elements are known to be at --> weights --> cut (cut.h)
 *     where that is faster        gather --> a new computer --> scatter, between two advances
 *
 * State and bits are the same on any division, so it does not matter when that happens, and clocks
 * may decide.
 */
#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/clock.h"
#include "parallel/computer.h"
#include "step/mass/heavier.h"
#include "step/mass/strained.h"

/* One stretch of so many is timed; a decision takes so many timed ones. */
enum { SAMPLE = 4, TIMED_MIN = 40 };
/* Looked at so often at most [s]; and making computers takes no more than this part of all time. */
static const double PAUSE = 1, SHARE_OF_TIME = 0.01;
/* Where another division did not help, it takes longer until the next, so long at most [s]. */
static const double PAUSE_MAX = 32;
/* Of the time that passes: who computes less than this waits for clocks and devices, not for it. */
static const double COMPUTES = 0.5;
/* The part of the slowest processor's time that must be saved. */
static const double WORTH = 0.1;

/* What an element costs besides, in elements at rest: where it is listed as strained, where its
 * barriers are at work, and for a face of it that a tool pushes. From samples of the demonstration
 * organ with both instruments deep; what is measured corrects all three together. */
static const float LISTED = 1, BARRIER = 18, PUSHED = 25;

lar_status lar_balance_create(lar_balance *balance, int32_t processors, lar_error *error) {
    balance->busy = lar_calloc((size_t)processors, sizeof *balance->busy);
    return balance->busy ? LAR_OK : lar_fail_memory(error, 8 * (size_t)processors, "processors");
}

void lar_balance_begin(lar_computer *computer, double cost) {
    lar_balance *balance = &computer->balance;
    for (int32_t p = 0; p < computer->division.grid.count && balance->busy; p++)
        balance->busy[p] = 0;
    balance->computed = 0;
    balance->count = 0;
    balance->since = lar_clock_seconds();
    balance->next = balance->since + fmax(fmax(PAUSE, balance->pause), cost / SHARE_OF_TIME);
}

void lar_balance_sample(lar_computer *computer) {
    lar_balance *balance = &computer->balance;
    balance->samples = balance->adapts && balance->count % SAMPLE == 0;
    balance->count++;
}

void lar_balance_note(lar_computer *computer, const lar_processor *p, double seconds) {
    lar_balance *balance = &computer->balance;
    balance->busy[p->self] += seconds - lar_comm_time_waited(p->comm);
    lar_comm_time_waits(p->comm, false);
    if (p->self == 0) balance->computed += seconds;
}

/* ---- what elements cost ---------------------------------------------------------------------- */

static void weigh_strained(const lar_processor *p, float *more) {
    const lar_domain *domain = &p->domain;
    for (int32_t r = 0; r < domain->run_count; r++) {
        size_t first = LAR_BLOCK * (size_t)domain->run_first[r];
        const int32_t *lane = p->strained.lane + first;
        const lar_damped *damped = p->strained.damped + first;
        for (int32_t i = 0; i < p->strained.listed_count[r]; i++) {
            lar_gid e = lar_lane_element(domain, r, (uint32_t)(lane[i] & ~LAR_LANE_FLAT));
            if (e >= 0) more[e] += LISTED;
        }
        for (int32_t i = 0; i < p->strained.damped_count[r]; i++)
            more[damped[i].element] += BARRIER;
    }
}

static void weigh_pushed(const lar_computer *computer, const lar_processor *p, float *more) {
    const lar_surface *surface = &computer->whole->model->surface;
    const lar_tool_contact *contact = &p->worker[0].interactions.tool_contact;
    for (int32_t i = 0; i < contact->loaded_count; i++)
        more[surface->element[contact->faces->face[contact->loaded[i].face].of]] += PUSHED;
}

/* What each processor has: elements, and what these cost besides. */
static void add_up(const lar_computer *computer, const int32_t *processor, const float *more,
                   double (*has)[2]) {
    for (int32_t p = 0; p < computer->division.grid.count; p++) has[p][0] = has[p][1] = 0;
    for (int32_t e = 0; e < computer->whole->model->mesh.element_count; e++) {
        has[processor[e]][0] += 1;
        has[processor[e]][1] += (double)more[e];
    }
}

/* By how much `more` must be corrected so that the busy seconds are those of elements that cost the
 * same: least squares in the cost of an element at rest and in that. */
static double measured_correction(const lar_computer *computer, const double (*has)[2]) {
    static const double MIN = 0.3, MAX = 3;
    double nn = 0, nm = 0, mm = 0, nb = 0, mb = 0;
    for (int32_t p = 0; p < computer->division.grid.count; p++) {
        double n = has[p][0], m = has[p][1], busy = computer->balance.busy[p];
        nn += n * n;
        nm += n * m;
        mm += m * m;
        nb += n * busy;
        mb += m * busy;
    }
    double determinant = nn * mm - nm * nm;
    if (!(determinant > 1e-6 * nn * mm)) return 1;
    double each = (nb * mm - mb * nm) / determinant, besides = (mb * nn - nb * nm) / determinant;
    return each > 0 ? fmin(fmax(besides / each, MIN), MAX) : MAX;
}

static double slowest(const lar_computer *computer, const double (*has)[2], double corrected) {
    double max = 0;
    for (int32_t p = 0; p < computer->division.grid.count; p++)
        max = fmax(max, has[p][0] + corrected * has[p][1]);
    return max;
}

/* ---- the decision ---------------------------------------------------------------------------- */

/* Another distribution, where the slowest processor would have enough less to do with it. */
static bool find_better(lar_computer *computer, float *more, double (*has)[2],
                        lar_distribution *found) {
    const lar_mesh *mesh = &computer->whole->model->mesh;
    const lar_division *division = &computer->division;
    for (int32_t p = 0; p < division->grid.count; p++) {
        weigh_strained(&computer->processor[p], more);
        weigh_pushed(computer, &computer->processor[p], more);
    }
    add_up(computer, division->recoverer, more, has);
    /* Clocks are read beside other programs: one measurement is not believed alone. */
    double *corrected = &computer->balance.corrected;
    *corrected = sqrt(*corrected * measured_correction(computer, (const double(*)[2])has));
    double now = slowest(computer, (const double(*)[2])has, *corrected);
    float *weight = more;
    for (int32_t e = 0; e < mesh->element_count; e++) weight[e] = 1 + (float)*corrected * more[e];
    if (lar_distribution_cut_by_weight(mesh, &division->grid, weight, found, NULL)) return false;
    double then = 0;
    add_up(computer, found->processor, weight, has);
    for (int32_t p = 0; p < division->grid.count; p++) then = fmax(then, has[p][1]);
    if (then < (1 - WORTH) * now) return true;
    lar_distribution_clear(found);
    return false;
}

/* How much more than on average the slowest processor is busy, as a factor. */
static double unevenness(const lar_computer *computer) {
    double sum = 0, max = 0;
    for (int32_t p = 0; p < computer->division.grid.count; p++) {
        sum += computer->balance.busy[p];
        max = fmax(max, computer->balance.busy[p]);
    }
    return sum > 0 ? max * computer->division.grid.count / sum : 1;
}

/* Whether so much time is spent, and so much of it on waiting, that it is worth a look. */
static bool is_uneven(const lar_computer *computer) {
    const lar_balance *balance = &computer->balance;
    double elapsed = lar_clock_seconds() - balance->since;
    return SAMPLE * balance->computed > COMPUTES * elapsed &&
           1 < (1 - WORTH) * unevenness(computer);
}

static bool is_due(const lar_computer *computer) {
    const lar_balance *balance = &computer->balance;
    return balance->adapts && balance->count >= SAMPLE * TIMED_MIN && !computer->broken &&
           computer->process == getpid() && lar_clock_seconds() > balance->next;
}

/* The first look after a change says whether that was any good. */
static void learn(lar_computer *computer) {
    static const double BETTER = 0.97;
    lar_balance *balance = &computer->balance;
    if (balance->before == 0) return;
    bool good = unevenness(computer) < BETTER * balance->before;
    balance->pause = good ? PAUSE : fmin(2 * fmax(balance->pause, PAUSE), PAUSE_MAX);
    balance->before = 0;
}

/* Parts are made of what the whole weighs at rest. */
lar_status lar_computer_redistribute(lar_computer **computer, lar_domain *whole,
                                     const lar_distribution *distribution, lar_error *error) {
    const lar_heavy_now nothing = {0};
    const lar_tools *tools = (*computer)->tools;
    double before = unevenness(*computer);
    lar_status status = lar_computer_gather(*computer, error);
    if (status) return status;
    lar_burden_take(whole, &nothing, NULL);
    status = lar_computer_create_like(*computer, distribution, computer, error);
    lar_burden_take(whole, &tools->heavier, NULL);
    if (status) return status;
    (*computer)->balance.times++;
    (*computer)->balance.before = before;
    return LAR_OK;
}

bool lar_computer_redivide(lar_computer **computer, lar_domain *whole) {
    lar_computer *old = *computer;
    if (!is_due(old)) return false;
    double begin = lar_clock_seconds();
    lar_distribution found = {0};
    bool made = false;
    learn(old);
    if (is_uneven(old)) {
        float *more = lar_calloc((size_t)whole->model->mesh.element_count, sizeof *more);
        double(*has)[2] = lar_calloc((size_t)old->division.grid.count, sizeof *has);
        if (more && has && find_better(old, more, has, &found))
            made = !lar_computer_redistribute(computer, whole, &found, NULL);
        free(more);
        free(has);
    }
    lar_distribution_clear(&found);
    lar_balance_begin(*computer, lar_clock_seconds() - begin);
    return made;
}
