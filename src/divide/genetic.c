#include "divide/genetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "divide/cut.h"
#include "divide/exchange.h"

enum { POPULATION_MAX = 1000, TRIBES = 6 };

typedef struct individual {
    double (*logical)[3];
    int32_t *processor;
    lar_cost cost;
} individual;

typedef struct search {
    const lar_mesh *mesh;
    const lar_incidence *incidence;
    const lar_grid *grid;
    lar_genetic_options options;
    lar_random random;
    lar_exchange exchange;
    lar_cut_item *item;
    individual *pool;  /* [population] */
    individual best;   /* ever seen */
    double (*rest)[3]; /* [elements] logical positions at the start */
    double *logicals;  /* memory of all individuals */
    int32_t *processors;
    double began;
    double done;
} search;

lar_genetic_options lar_genetic_options_default(void) {
    return (lar_genetic_options){.seed = 1,
                                 .seconds = 25,
                                 .population = 4,
                                 .rate = 0.00005,
                                 .sigma = 0.02,
                                 .warping = 1,
                                 .crossing = 0.05,
                                 .shaping = 0.6,
                                 .exchanges = 300,
                                 .slack = 0.2};
}

static lar_status check_options(const lar_genetic_options *o, lar_error *error) {
    if (o->population < 2 || o->population > POPULATION_MAX || o->population % 2)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a population of %d cannot be paired; give an even number from 2 to %d",
                        (int)o->population, POPULATION_MAX);
    if (!(o->seconds >= 0) || o->generations < 0 || (o->seconds == 0 && o->generations == 0))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a genetic search needs an end; limit its seconds or its generations");
    const double share[] = {o->rate, o->warping, o->crossing, o->shaping, o->slack};
    bool good = o->sigma >= 0 && o->sigma <= 1e6 && o->exchanges >= 0 && o->exchanges <= 100000;
    for (int i = 0; i < 5; i++) good &= share[i] >= 0 && share[i] <= 1;
    if (!good)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "rates, sigma, exchanges or slack of the genetic search are out of range; "
                        "begin with lar_genetic_options_default");
    return LAR_OK;
}

static void copy_individual(const search *s, individual *to, const individual *from) {
    size_t elements = (size_t)s->mesh->element_count;
    memcpy(to->logical, from->logical, elements * sizeof *to->logical);
    memcpy(to->processor, from->processor, elements * sizeof *to->processor);
    to->cost = from->cost;
}

static void evaluate(search *s, individual *one) {
    lar_cut(s->grid, s->mesh->element_count, (const double(*)[3])one->logical, s->item,
            one->processor);
    one->cost = lar_cost_measure(s->incidence, one->processor, s->grid->count, s->exchange.set,
                                 s->exchange.pays);
}

static lar_status search_allocate(search *s, lar_error *error) {
    size_t elements = (size_t)s->mesh->element_count;
    size_t individuals = (size_t)s->options.population * TRIBES + 1;
    lar_status status =
        lar_exchange_create(s->mesh, s->incidence, s->grid->count, &s->exchange, error);
    if (status) return status;
    s->item = lar_calloc(elements, sizeof *s->item);
    s->rest = lar_calloc(elements, sizeof *s->rest);
    s->pool = lar_calloc(individuals, sizeof *s->pool);
    s->logicals = lar_calloc(individuals, elements * sizeof *s->best.logical);
    s->processors = lar_calloc(individuals, elements * sizeof *s->processors);
    if (!s->item || !s->rest || !s->pool || !s->logicals || !s->processors)
        return lar_fail_memory(error, individuals * elements * 28, "the genetic search");
    for (size_t i = 0; i < individuals; i++) {
        individual *one = i + 1 < individuals ? &s->pool[i] : &s->best;
        one->logical = (double(*)[3])s->logicals + i * elements;
        one->processor = s->processors + i * elements;
    }
    return LAR_OK;
}

static void search_clear(search *s) {
    lar_exchange_clear(&s->exchange);
    free(s->item);
    free(s->rest);
    free(s->pool);
    free(s->logicals);
    free(s->processors);
    *s = (search){0};
}

/* How many coordinates until the next one that mutates: rate r has the mean gap 1/r, and a
 * uniform gap up to twice that needs no logarithm. */
static int64_t next_gap(search *s) {
    return 1 + (int64_t)(2 * lar_random_unit(&s->random) / s->options.rate);
}

static void mutate(search *s, individual *one) {
    static const double MIN_RATE = 1e-12; /* below it nothing ever mutates */
    if (s->options.rate < MIN_RATE) return;
    double *coordinate = &one->logical[0][0];
    int64_t count = 3 * (int64_t)s->mesh->element_count;
    bool changed = false;
    for (int64_t i = next_gap(s) - 1; i < count; i += next_gap(s)) {
        coordinate[i] += s->options.sigma * lar_random_normal(&s->random);
        changed = true;
    }
    if (changed) evaluate(s, one);
}

/* Moves a region: one coordinate of all elements within a ball around a random one, most in its
 * middle. A cut bends there as a whole, where single coordinates would only roughen it. */
static void warp(search *s, individual *one) {
    int32_t elements = s->mesh->element_count;
    int32_t middle = lar_random_below(&s->random, elements);
    int axis = lar_random_below(&s->random, 3);
    double radius = 0.05 + 0.5 * lar_random_unit(&s->random);
    double by = 0.5 * radius * lar_random_normal(&s->random);
    const double *centre = s->rest[middle];
    for (int32_t e = 0; e < elements; e++) {
        double far = 0;
        for (int i = 0; i < 3; i++) {
            double d = (s->rest[e][i] - centre[i]) / radius;
            far += d * d;
        }
        if (far < 1) one->logical[e][axis] += by * (1 - far) * (1 - far);
    }
    evaluate(s, one);
}

/* Swaps the genes behind a random point. */
static void cross_over(search *s, individual *a, individual *b) {
    int32_t elements = s->mesh->element_count;
    for (int32_t e = lar_random_below(&s->random, elements); e < elements; e++)
        for (int i = 0; i < 3; i++) {
            double swap = a->logical[e][i];
            a->logical[e][i] = b->logical[e][i];
            b->logical[e][i] = swap;
        }
    evaluate(s, a);
    evaluate(s, b);
}

/* Pairs the individuals pool[0 .. count) anew: a random order, to be taken two by two. */
static void shuffle(search *s, individual *pool, int32_t count) {
    for (int32_t i = count - 1; i > 0; i--) {
        int32_t j = lar_random_below(&s->random, i + 1);
        individual swap = pool[i];
        pool[i] = pool[j];
        pool[j] = swap;
    }
}

/* A generation of a large model may take longer than there is time for. */
static bool late(const search *s) {
    return s->options.seconds > 0 && lar_clock_seconds() - s->began > s->options.seconds;
}

static void vary(search *s, individual *pool, int32_t count) {
    const lar_genetic_options *o = &s->options;
    bool shaping = s->done < o->shaping;
    for (int32_t i = 0; i < count && !late(s); i++) {
        mutate(s, &pool[i]);
        if (shaping && lar_random_unit(&s->random) < o->warping) warp(s, &pool[i]);
    }
    shuffle(s, pool, count);
    for (int32_t i = 0; i < count; i += 2)
        if (lar_random_unit(&s->random) < o->crossing) cross_over(s, &pool[i], &pool[i + 1]);
    int64_t trials = (int64_t)s->mesh->element_count * o->exchanges / 100;
    if (trials > INT32_MAX) trials = INT32_MAX;
    double slack = o->slack * (1 - s->done) * (1 - s->done);
    for (int32_t i = 0; i < count; i++) {
        individual *one = &pool[i];
        if (!shaping && !late(s))
            lar_exchange_run(&s->exchange, &s->random, (int32_t)trials, slack, one->processor,
                             one->logical, &one->cost);
        if (lar_cost_less(one->cost, s->best.cost)) copy_individual(s, &s->best, one);
    }
}

static void tournament(search *s, individual *pool, int32_t count) {
    shuffle(s, pool, count);
    for (int32_t i = 0; i < count; i += 2) {
        individual *a = &pool[i], *b = &pool[i + 1];
        if (a->cost.power < b->cost.power)
            copy_individual(s, b, a);
        else if (b->cost.power < a->cost.power)
            copy_individual(s, a, b);
    }
}

/* Tribes mix in the last third of shaping. */
static void generation(search *s) {
    static const double APART = 0.7;
    int32_t tribes = s->done < APART * s->options.shaping ? TRIBES : 1;
    int32_t count = s->options.population * (TRIBES / tribes);
    for (int32_t t = 0; t < tribes; t++) {
        vary(s, s->pool + t * count, count);
        tournament(s, s->pool + t * count, count);
    }
}

/* The model lies in the grid in another way: its axes in another order. */
static void turn(search *s, individual *one, int way) {
    static const int order[6][3] = {{0, 1, 2}, {2, 1, 0}, {1, 0, 2},
                                    {0, 2, 1}, {1, 2, 0}, {2, 0, 1}};
    for (int32_t e = 0; e < s->mesh->element_count; e++)
        for (int i = 0; i < 3; i++) one->logical[e][i] = s->rest[e][order[way][i]];
    evaluate(s, one);
    if (lar_cost_less(one->cost, s->best.cost)) copy_individual(s, &s->best, one);
}

/* How much of the search is behind us, 0 to 1. Without a time limit no clock has a say. */
static double share_done(const lar_genetic_options *o, const lar_genetic_progress *progress) {
    double done = o->generations ? (double)progress->generation / (double)o->generations : 0;
    double elapsed = o->seconds > 0 ? progress->seconds / o->seconds : 0;
    return fmin(fmax(done, elapsed), 1);
}

static void search_run(search *s, lar_genetic_result *result) {
    const lar_genetic_options *o = &s->options;
    lar_logical_positions(s->mesh, s->rest);
    memcpy(s->best.logical, s->rest, (size_t)s->mesh->element_count * sizeof *s->rest);
    evaluate(s, &s->best);
    lar_genetic_progress progress = {.start = s->best.cost, .best = s->best.cost};
    for (int32_t i = 0; i < o->population * TRIBES; i++) turn(s, &s->pool[i], i / o->population);
    bool more = s->best.cost.worst > 0;
    while (more && s->done < 1) {
        generation(s);
        progress.generation++;
        progress.seconds = lar_clock_seconds() - s->began;
        progress.best = s->best.cost;
        s->done = share_done(o, &progress);
        if (o->callback && !o->callback(o->context, &progress)) more = false;
    }
    *result = (lar_genetic_result){progress.start, s->best.cost, progress.generation,
                                   lar_clock_seconds() - s->began};
}

lar_status lar_genetic_search(const lar_mesh *mesh, const lar_incidence *incidence,
                              const lar_grid *grid, const lar_genetic_options *options,
                              int32_t *processor, lar_genetic_result *result, lar_error *error) {
    search s = {.mesh = mesh,
                .incidence = incidence,
                .grid = grid,
                .options = options ? *options : lar_genetic_options_default(),
                .began = lar_clock_seconds()};
    lar_status status = check_options(&s.options, error);
    if (status) return status;
    s.random.state = s.options.seed;
    status = search_allocate(&s, error);
    if (!status) {
        lar_genetic_result found;
        search_run(&s, &found);
        memcpy(processor, s.best.processor, (size_t)mesh->element_count * sizeof *processor);
        if (result) *result = found;
    }
    search_clear(&s);
    return status;
}
