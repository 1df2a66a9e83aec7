/* Predictions: a model on a machine, bodies that grow with the machine, and how small a sub-domain
 * may be (T 5.1.7, 8.3.1).
 *
 *     scene      its real schedules for a grid                                  one row
 *     blocks     n x n x n elements per processor, 100 to 100,000 processors    size scaling
 *     critical   the smallest of these blocks with 90 % efficiency              T 8.3.1
 *
 * Efficiency is the time of all elements and nodes on one processor, one thread, divided by what
 * all threads take together: only exchange and waiting count against it.
 */
#ifndef LAR_STUDY_PREDICT_PREDICT_H
#define LAR_STUDY_PREDICT_PREDICT_H

#include "study/predict/network.h"

enum { LAR_PREDICT_SCHEMES = 5 }; /* all, local sequential, local concurrent, one, two */

/* "all", "local sequential", ... */
extern const char *const lar_predict_scheme_name[LAR_PREDICT_SCHEMES];

typedef struct lar_prediction {
    lar_network_result network;
    int32_t elements, nodes; /* of the model */
    double alone;            /* step of one processor with one thread [s] */
    double speed_up, efficiency;
    double time_step;        /* of the simulation [s]; 0: the model has none */
    double real_time_factor; /* simulated by needed time; 0: no time step */
} lar_prediction;

/* The parallel part of lar_options says how the model is divided; `steps` as in
 * lar_network_options. Clear the prediction. */
lar_status lar_predict_model(const lar_model *model, const lar_options *options,
                             const lar_cluster *machine, int32_t steps, lar_prediction *out,
                             lar_error *error);
void lar_prediction_clear(lar_prediction *prediction); /* idempotent */

/* ---- size scaling --------------------------------------------------------------------------- */

typedef struct lar_block_options {
    int32_t elements;   /* of each processor, about; 1..LAR_PREDICT_BLOCK_MAX */
    int32_t processors; /* a near cube of so many, exactly */
    int32_t threads;    /* of a processor; 0: 1 */
    int scheme;         /* 0..LAR_PREDICT_SCHEMES - 1 */
    int32_t steps;      /* as in lar_network_options */
} lar_block_options;

enum { LAR_PREDICT_BLOCK_MAX = 64000 };

typedef struct lar_block_prediction {
    int32_t grid[3], edge[3]; /* processors; elements of a block */
    double step, alone;       /* [s]; alone: one processor's share of it all */
    double efficiency, occupation;
    int32_t steps; /* simulated; the others as in lar_network_result */
    double fastest, slowest;
    bool settled;
    int64_t bytes_max, packets_max; /* a processor sends per step */
} lar_block_prediction;

lar_status lar_predict_block(const lar_block_options *options, const lar_cluster *machine,
                             lar_block_prediction *out, lar_error *error);

/* Edges of the most cubic grid of exactly so many processors. */
void lar_predict_grid(int32_t processors, int32_t grid[3]);

/* ---- critical sub-domain -------------------------------------------------------------------- */

typedef struct lar_critical {
    int32_t elements[LAR_PREDICT_SCHEMES];  /* smallest cube with the efficiency, 0: none is */
    double efficiency[LAR_PREDICT_SCHEMES]; /* there, or of the largest tried */
    bool unsettled[LAR_PREDICT_SCHEMES];    /* paces of some block did not settle, and lie on both
                                               sides of the efficiency */
} lar_critical;

/* For `machines` machines at once: cubes of 1, 2^3, ... edge_most^3 elements (beyond 12 not every
 * edge) on each of so many processors. The answer is the smallest that has the efficiency together
 * with the next larger one that was tried: none has it by chance. */
typedef struct lar_critical_options {
    const lar_cluster *machine;
    int32_t machines, processors, threads, edge_max;
    int32_t steps; /* as in lar_network_options */
    double efficiency;
    void (*tell)(void *context, int scheme, int32_t edge); /* before each block; may be NULL */
    void *context;
} lar_critical_options;

lar_status lar_predict_critical(const lar_critical_options *options, lar_critical *out,
                                lar_error *error);

#endif
