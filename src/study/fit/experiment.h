/* What is fitted to what: the file of `lariat fit` (docs/formats.md), read and checked.
 *
 *     parameters          of materials, by name, with bounds and a first guess
 *        |
 *     experiment 1        a scene, and what was measured in it: a table
 *     experiment 2        the same parameters in another scene
 *
 * Of every experiment the model stands here as its scene has it. A run with other parameters takes
 * a shallow copy with materials of its own (study/fit/forward.h), so that mesh and sets are there
 * once, however many runs go at a time.
 */
#ifndef LAR_STUDY_FIT_EXPERIMENT_H
#define LAR_STUDY_FIT_EXPERIMENT_H

#include <stdbool.h>

#include "model/model.h"

enum { LAR_FIT_PARAMETERS_MAX = 12, LAR_FIT_EXPERIMENTS_MAX = 16 };

typedef enum lar_fit_kind {
    LAR_FIT_TENSION,     /* force of a moved support over its displacement or the stretch */
    LAR_FIT_COMPRESSION, /* the same, shorter instead of longer */
    LAR_FIT_INDENTATION, /* force on a sphere over its depth */
    LAR_FIT_ASPIRATION,  /* profile of the tissue that a falling pressure draws into a tube */
    LAR_FIT_MARKERS,     /* where points of the body have gone */
    LAR_FIT_SURFACE,     /* points that lie on the deformed surface */
    LAR_FIT_KINDS
} lar_fit_kind;

extern const char *const lar_fit_kind_name[LAR_FIT_KINDS];

typedef struct lar_fit_parameter {
    char *material, *name; /* the second as in scenes, or g0, g1, time1, ... */
    int line;              /* of the file */
    double guess, low, high;
    bool log; /* positive bounds: what counts are ratios */
} lar_fit_parameter;

/* Tissue in a tube (T 1.3). */
typedef struct lar_fit_aspiration {
    int load;                  /* of the model's pressures: the faces in the tube */
    double origin[3], axis[3]; /* heights count from here, along the unit axis out of the tissue */
    int32_t nodes, *node;      /* [nodes] of these faces */
    double width;              /* of the window that profiles are read through [m] */
    int32_t points;
    double (*suction)[2]; /* [points] time [s], pressure below the one outside [Pa]: in time the
                             measured curve, at rest one of every row; NULL: the scene has it */
} lar_fit_aspiration;

typedef struct lar_fit_experiment {
    lar_fit_kind kind;
    int line; /* of the file */
    char *name, *scene, *data;
    char *pressure; /* table of the pressure in the tube; NULL: none */
    lar_model *model;
    bool in_time;         /* rows are moments of one run; else each is followed to rest */
    int32_t rows, values; /* of the table; measured numbers, of markers three a row */
    int *row_line;        /* [rows] lines of the table's file */
    double *time;         /* [rows] [s]; NULL: not measured */
    double *along;        /* [rows] displacement, depth, or distance from the tube's axis [m]; NULL:
                             the scene moves by itself */
    double *measured;     /* [values] N; of profiles heights, of markers displacements, of surfaces
                             distances 0 [m] */
    lar_embedded_surface points; /* markers: bound to elements; surface: places alone */
    double largest;              /* of what is measured, in size: the scale of its errors */
    double noise;        /* standard deviation of a measured number, or a hundredth of `largest` */
    int move, tool;      /* of the model: what is driven; -1: nothing */
    double direction[3]; /* into the tissue, of a tool */
    lar_fit_aspiration aspiration;
} lar_fit_experiment;

typedef struct lar_fit_problem {
    char *path, *title;
    int parameters, experiments;
    lar_fit_parameter parameter[LAR_FIT_PARAMETERS_MAX];
    lar_fit_experiment experiment[LAR_FIT_EXPERIMENTS_MAX];
} lar_fit_problem;

/* Into a zeroed one; the caller clears in any case. */
lar_status lar_fit_problem_read(const char *path, lar_fit_problem *problem, lar_error *error);
void lar_fit_problem_clear(lar_fit_problem *problem); /* idempotent */

/* Measured numbers of all experiments together. */
int32_t lar_fit_problem_values(const lar_fit_problem *problem);

#endif
