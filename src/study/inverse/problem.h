/* What is asked: parameters of materials, and experiments in which they show.
 *
 *     parameters          of materials, by name, with bounds and a first guess
 *        |
 *     experiment 1        a scene, and what was measured in it: a table
 *     experiment 2        the same parameters in another scene
 *
 * Of every experiment the model stands here as its scene has it. A run with other parameters takes
 * a shallow copy with materials of its own (study/inverse/forward.h), so that mesh and sets are
 * there once, however many runs go at a time. The file is read in study/inverse/experiment.h.
 */
#ifndef LAR_STUDY_INVERSE_PROBLEM_H
#define LAR_STUDY_INVERSE_PROBLEM_H

#include <stdbool.h>

#include "model/model.h"

enum { LAR_INVERSE_PARAMETERS_MAX = 12, LAR_INVERSE_EXPERIMENTS_MAX = 16 };

typedef enum lar_inverse_kind {
    LAR_INVERSE_TENSION,     /* force of a moved support over its displacement or the stretch */
    LAR_INVERSE_COMPRESSION, /* the same, shorter instead of longer */
    LAR_INVERSE_INDENTATION, /* force on a sphere over its depth */
    LAR_INVERSE_ASPIRATION,  /* profile of the tissue that a falling pressure draws into a tube */
    LAR_INVERSE_MARKERS,     /* where points of the body have gone */
    LAR_INVERSE_SURFACE,     /* points that lie on the deformed surface */
    LAR_INVERSE_KINDS
} lar_inverse_kind;

extern const char *const lar_inverse_kind_name[LAR_INVERSE_KINDS];

typedef struct lar_inverse_parameter {
    char *material, *name; /* the second as in scenes, or g0, g1, time1, ... */
    int line;              /* of the file */
    double guess, low, high;
    bool log; /* positive bounds: what counts are ratios */
} lar_inverse_parameter;

/* Tissue in a tube (T 1.3). */
typedef struct lar_inverse_aspiration {
    int load;                  /* of the model's pressures: the faces in the tube */
    double origin[3], axis[3]; /* heights count from here, along the unit axis out of the tissue */
    int32_t nodes, *node;      /* [nodes] of these faces */
    double width;              /* of the window that profiles are read through [m] */
    int32_t points;
    double (*suction)[2]; /* [points] time [s], pressure below the one outside [Pa]: in time the
                             measured curve, at rest one of every row; NULL: the scene has it */
} lar_inverse_aspiration;

typedef struct lar_inverse_experiment {
    lar_inverse_kind kind;
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
    double whole;   /* what is left is a share of this: `largest`, of surfaces the body's length */
    double noise;   /* standard deviation of a measured number, or a hundredth of `largest` */
    double *error;  /* [values] of each; NULL: `noise` of all */
    int move, tool; /* of the model: what is driven; -1: nothing */
    double way;     /* 1 or -1: where the driven support's positive way goes on its axis */
    double direction[3]; /* into the tissue, of a tool */
    lar_inverse_aspiration aspiration;
} lar_inverse_experiment;

typedef struct lar_inverse_problem {
    char *path, *title;
    int parameters, experiments;
    lar_inverse_parameter parameter[LAR_INVERSE_PARAMETERS_MAX];
    lar_inverse_experiment experiment[LAR_INVERSE_EXPERIMENTS_MAX];
} lar_inverse_problem;

void lar_inverse_problem_clear(lar_inverse_problem *problem); /* idempotent */

/* Whether row i of profiles is of another moment than the row before it: of another time, or at
 * rest of another pressure. */
bool lar_inverse_new_moment(const lar_inverse_experiment *e, int32_t i);

/* What the relative residual is a share of, for sentences. */
const char *lar_inverse_whole(const lar_inverse_experiment *e);

/* Measured numbers of all experiments together. */
int32_t lar_inverse_problem_values(const lar_inverse_problem *problem);

#endif
