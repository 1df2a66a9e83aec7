/* A better distribution by genetic adaptation (T 6.8.4).
 *
 *     gene         the logical position of one element      mutate -> cross over -> exchange
 *     individual   all genes                                    ^                      |
 *     fitness      cost (eq. 6.8) of what algorithm 3 cuts      +---- tournament <-----+
 *
 * Mutation moves random coordinates by Gaussian amounts. One-point cross-over swaps the tails of
 * two genomes. Binary tournament: of two individuals the fitter takes the place of the weaker.
 *
 * Beyond the thesis, because it finds lower costs in less time:
 *   tribes     six, one for each way in which the model's axes can lie in the grid; they compete
 *              among themselves first, so that a slow starter is not lost;
 *   shaping    (the first part of the search) mutation also moves whole regions, which bends cuts;
 *   polishing  (the rest) border elements are exchanged (exchange.h), with less and less slack;
 *   the best individual ever seen cannot be lost.
 * The start is one of the individuals: the result is never worse than the plain cut.
 *
 * Every individual meets eq. 6.7 whatever its genes are, because it is cut. With a limit on
 * generations and none on time the result depends on mesh, grid and options only, to the bit.
 */
#ifndef LAR_DIVIDE_GENETIC_H
#define LAR_DIVIDE_GENETIC_H

#include "divide/cost.h"
#include "divide/grid.h"

/* Called after every generation, with the best so far; false ends the search. */
typedef struct lar_genetic_progress {
    int64_t generation;
    double seconds;
    lar_cost start, best;
} lar_genetic_progress;
typedef bool lar_genetic_callback(void *context, const lar_genetic_progress *progress);

typedef struct lar_genetic_options {
    uint64_t seed;
    double seconds;      /* time limit; 0: none */
    int64_t generations; /* limit; 0: none. One of the two must be given. */
    int32_t population;  /* individuals of a tribe, even, 2 to 1000 */
    double rate;         /* share of an individual's coordinates that mutate */
    double sigma;        /* standard deviation of a mutation; the model is 1 wide */
    double warping;      /* share of the individuals of which a region moves, while shaping */
    double crossing;     /* share of the pairs that cross over */
    double shaping;      /* share of the search that comes before polishing */
    int32_t exchanges;   /* polishing: pairs looked at, in per cent of the number of elements */
    double slack;        /* polishing: share of the power by which it may rise at first */
    lar_genetic_callback *callback; /* may be NULL */
    void *context;
} lar_genetic_options;

/* Options that suit organs of some thousand elements; 25 seconds. */
lar_genetic_options lar_genetic_options_default(void);

typedef struct lar_genetic_result {
    lar_cost start, best; /* of the plain cut, and of what was found: never higher */
    int64_t generations;
    double seconds;
} lar_genetic_result;

/* Searches and fills processor[mesh->element_count]. `options` may be NULL, `result` too. */
lar_status lar_genetic_search(const lar_mesh *mesh, const lar_incidence *incidence,
                              const lar_grid *grid, const lar_genetic_options *options,
                              int32_t *processor, lar_genetic_result *result, lar_error *error);

#endif
