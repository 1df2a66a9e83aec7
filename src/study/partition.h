/* Dividing a model among processors, and what the thesis says about a division (T 6.8, 3.7).
 *
 * The work is in `divide`; here the ways to make a distribution are tried, the best is kept, files
 * are written, and the figures are collected for the command.
 */
#ifndef LAR_STUDY_PARTITION_H
#define LAR_STUDY_PARTITION_H

#include <stdbool.h>

#include "lariat.h"

typedef enum lar_partition_method {
    LAR_PARTITION_BEST = 0, /* of cut, genetic and, where there is one, metis */
    LAR_PARTITION_CUT,
    LAR_PARTITION_GENETIC,
    LAR_PARTITION_METIS,
    LAR_PARTITION_RANDOM,
    LAR_PARTITION_FILE, /* read, not made */
    LAR_PARTITION_METHODS
} lar_partition_method;

enum { LAR_PARTITION_SCHEMES = 4 };

/* Called during the genetic search: the share that is done, the cost of the cut and the best so
 * far. */
typedef void lar_partition_progress(void *context, double done, int64_t start, int64_t best);

typedef struct lar_partition_options {
    const char *grid; /* "2x2x3"; with a file NULL or the file's */
    lar_partition_method method;
    const char *read; /* LAR_PARTITION_FILE: the distribution file */
    uint64_t seed;
    double seconds;        /* of the genetic search; 0: no limit */
    int64_t generations;   /* of the genetic search; 0: no limit */
    int scheme, channels;  /* lar_scheme, lar_channel_use: whose schedules are written */
    int32_t threads;       /* of a processor; 0: one */
    const char *out;       /* distribution file to write, or NULL */
    const char *schedules; /* folder for schedule files, or NULL */
    const char *vtu;       /* mesh with the cell field "processor" to write, or NULL */
    lar_partition_progress *progress;
    void *context;
} lar_partition_options;

/* Cost of eq. 6.8: of the processor that pays most, and of all. */
typedef struct lar_partition_cost {
    bool known; /* whether this method was tried */
    int64_t worst, total;
} lar_partition_cost;

/* What processors send in one step under one scheme of T 3.7: the greatest of all processors, and
 * the mean, counted from the scheme's schedules. A vector has 24 bytes. */
typedef struct lar_partition_scheme {
    const char *name;
    int64_t local_max, global_max, vectors_max; /* vectors */
    double local_mean, global_mean, vectors_mean;
    int64_t bytes_max;
    double bytes_mean;
    int64_t packets_max;
    double packets_mean;
    int64_t packet_bytes_max; /* the largest packet */
    double packet_bytes_mean;
} lar_partition_scheme;

/* The chosen schedules: the greatest of all processors, and the mean. */
typedef struct lar_partition_schedules {
    int32_t threads;
    const char *scheme, *channels;
    int64_t batches_max, waits_max; /* of a processor, all threads */
    double batches_mean, waits_mean;
    int64_t buffer_bytes_max; /* of a receive buffer, both halves */
} lar_partition_schedules;

typedef struct lar_partition_report {
    int32_t grid[3], processors, elements, nodes;
    int32_t diameter;                     /* of the grid */
    int32_t load_min, load_max;           /* elements per processor */
    bool balanced;                        /* eq. 6.7 */
    double mean_processors;               /* n_pav: processors per node */
    int32_t shared, irregular, scattered; /* nodes of several processors; of these eq. 3.22; and
                                             those that partial sums cannot serve */
    lar_partition_method method;          /* whose distribution was kept */
    lar_partition_cost cost[LAR_PARTITION_METHODS]; /* of each that was tried */
    double reduction;    /* of the worst against the plain cut, 0.2 is a fifth less */
    int64_t generations; /* of the genetic search, and how long it took */
    double seconds;
    lar_partition_scheme scheme[LAR_PARTITION_SCHEMES];
    lar_partition_schedules schedules;
} lar_partition_report;

/* Names of the methods, in their order; NULL ends them. */
extern const char *const lar_partition_method_name[LAR_PARTITION_METHODS + 1];
bool lar_partition_has_metis(void);

lar_status lar_partition(const lar_model *model, const lar_partition_options *options,
                         lar_partition_report *report, lar_error *error);

#endif
