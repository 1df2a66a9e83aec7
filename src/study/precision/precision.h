/* How much precision an element needs (T 5.1.1): the same model computed three ways, step by step
 * beside each other.
 *
 *     double   production's kernels
 *     mixed    elements in single precision, from differences of displacements formed in double;
 *              sums of forces, velocities and displacements as in production
 *     single   displacements, velocities and everything of the elements in single precision; sums
 *              of forces stay integers, which is kinder than sums of floats
 */
#ifndef LAR_STUDY_PRECISION_PRECISION_H
#define LAR_STUDY_PRECISION_PRECISION_H

#include <stdbool.h>

#include "lariat.h"
#include "study/bench/kernel.h"
#include "study/precision/precision_cases.h"

typedef enum lar_precision {
    LAR_PRECISION_DOUBLE,
    LAR_PRECISION_MIXED,
    LAR_PRECISION_SINGLE,
    LAR_PRECISION_COUNT
} lar_precision;

extern const char *const lar_precision_names[LAR_PRECISION_COUNT];

enum { LAR_PRECISION_LOOKS = 20 }; /* times that the three are compared */

typedef struct lar_precision_options {
    lar_precision_case what;
    const lar_model *model; /* of LAR_CASE_MODEL */
    int32_t elements;       /* about so many, of the other cases */
    uint64_t steps;
    lar_isa isa; /* c and avx512 have kernels in single precision; AUTO: the widest of these */
} lar_precision_options;

typedef struct lar_precision_way {
    bool went;              /* false: stopped, and nothing below is after that */
    double difference;      /* largest of a node from double at the end, of `largest` */
    double difference_max;  /* the same, the worst look */
    double left;            /* largest displacement at the end, of `largest` */
    double speed;           /* largest velocity of an axis at the end [m/s] */
    double strain;          /* strain energy at the end, of the largest in double */
    double drift;           /* change of all energy, of the most there was in double */
    uint64_t hash;          /* of the state at the end */
    double bytes;           /* of blocks, per element */
    lar_spread nanoseconds; /* of a step per element, over the looks */
} lar_precision_way;

typedef struct lar_precision_result {
    int32_t elements, nodes;
    const char *isa;
    double time_step;
    double largest; /* displacement of a node in double, over the looks, without the metre of
                       LAR_CASE_FAR [m] */
    lar_precision_way way[LAR_PRECISION_COUNT];
} lar_precision_result;

/* Fails for options out of range, for models that double cannot run, for want of memory, for an
 * instruction set without single precision. */
lar_status lar_precision_compare(const lar_precision_options *options, lar_precision_result *result,
                                 lar_error *error);

/* The largest step, over the stable bound of the engine, with which a block swings for `steps`
 * steps without growing; to 0.1 %. */
lar_status lar_precision_stable(const lar_precision_options *options,
                                double ratio[LAR_PRECISION_COUNT], lar_error *error);

#endif
