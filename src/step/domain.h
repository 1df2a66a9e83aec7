/* The compiled model: what one processor needs to step, in the order in which it reads it.
 *
 *     model (global, by file order)             domain (local, by use; layout/layout.h)
 *     elements 0..E-1                 ---->     runs of blocks of one law, shape and kind of rows
 *     nodes 0..N-1                    ---->     local nodes, those of a row one after the other,
 *                                               and spare ones for even beginnings and empty lanes
 *
 * Constant: a step changes nothing of it. What the steps change stands beside it: the state
 * (layout/state.h), what contact knows of that (contact/interactions.h), and the strained elements
 * (step/guard.h). Between steps lar_domain_stiffen compiles materials anew. The element kinds that
 * are not hex8 keep their elements in the plain list `element` and go the slow way.
 */
#ifndef LAR_STEP_DOMAIN_H
#define LAR_STEP_DOMAIN_H

#include "contact/surroundings.h"
#include "layout/part_layout.h"
#include "mechanics/hex8_block.h"
#include "model/model.h"
#include "model/parameters.h"
#include "step/mass/masses.h"
#include "step/stable_step.h"

/* What a lane follows from besides gradients and shape, with the model's material. */
typedef struct lar_lane_base {
    double volume;                        /* [m^3] */
    double stiffness[LAR_HEX8_HOURGLASS]; /* c_m [N/m] */
    double limit;                         /* of corner_limit */
    double largest;                       /* corner at rest [m^3] (mechanics/hex8_guard.h) */
    double areas;                         /* lar_hex8_areas at rest [m^4] */
    uint32_t corner; /* which corner of the mesh each of the layout's is, four bits each */
} lar_lane_base;

typedef struct lar_domain {
    const lar_model *model;
    const lar_kernels *kernels;
    lar_element_kind kind;

    lar_layout layout;
    int32_t run_count;
    lar_block_run *run; /* [run_count] of one thread, batch and kind; `blocks` for hex8 only */
    int32_t *run_first; /* [run_count] the run's first block in layout.block */
    void *blocks;       /* all blocks of all runs */
    bool lean;          /* general ones are lean */
    lar_lean_parameters *lean_parameters; /* [materials + 1] behind the blocks; NULL: none is */
    lar_lane_base *base;                  /* [8 for each block] */
    lar_material *material; /* [materials of the model] as they are now; names are lent, parameters
                               atomic */
    lar_parameters set;     /* that `material` follows */
    double factor[LAR_FACTORS_MAX];     /* of their stiffness (model/settings.h); atomic */
    double faster[LAR_FACTORS_MAX];     /* what the squares of frequencies of their elements are,
                                           times the model's: by stiffness and parameters */
    double activation[LAR_FACTORS_MAX]; /* what was set of their activation, likewise */
    bool activates;                     /* activation is not 1 everywhere at all times */
    double now;                         /* time of the last state [s], of a whole; atomic */
    double *place;                      /* [8 for each block] on the way of waves [m]; NULL: there
                                           are none */
    double fastest[LAR_FACTORS_MAX];    /* square of the highest frequency at rest among the
                                            elements of these materials [1/s^2]; a whole's */
    double *corner_limit; /* [8 for each block] lar_hex8_corner_limit, in squared force units */
    double *area_limit;   /* [8 for each block] lar_hex8_area_limit, of compressible tissue below 0
                             (mass/compressible.h); NULL: all are of neither kind */
    double *rest;         /* [3][layout.axis_stride] where nodes are at rest [m] */
    lar_element_rate *rate; /* [elements of the model] */
    bool rate_lent;         /* `rate` belongs to the whole */
    size_t block_bytes;
    lar_block_more *more; /* [blocks] of models that have a law with so many parameters, or NULL */
    size_t more_bytes;
    lar_viscous_block *relaxing; /* [blocks] of models that are viscous somewhere, or NULL */
    size_t relaxing_bytes;
    lar_fibre_block *fibres; /* [blocks] of models that have fibres somewhere, or NULL */
    size_t fibre_bytes;
    lar_fibre_block *second; /* [blocks] of models with pairs of fibres somewhere, or NULL */
    lar_fold_block *folds;   /* [blocks] of models some of whose elements might fold, or NULL */
    size_t fold_bytes;
    size_t history_count;     /* values of a state's history, lanes without an element among them */
    size_t *run_history;      /* [run_count] where a viscous run's begin */
    int64_t *element_history; /* [elements of the model] where an element's begin, one in eight;
                                 -1: it has none here. NULL where nothing is viscous */
    int32_t grip_count; /* of free bodies (contact/history/tool_grip.h): the first in a history */
    lar_gid *grip;      /* [grip_count] nodes of the model */
    const lar_contact_surface *rubbing; /* whose nodes' values are the last; lent; NULL: none */
    int32_t spare_count;
    lar_lid *spare; /* nodes without mass, ascending */
    double *mass;   /* [layout.node_padded] kg; spare nodes 0 */
    double *weight; /* the same, 0 where another processor accounts for the node; in a whole model
                       `mass` itself */
    double *added;  /* [layout.node_padded] of `mass`, what has no weight; NULL: nothing */
    double *push;   /* [layout.node_padded] see lar_node_update */
    lar_burden *burden; /* what strained elements may have more (step/mass/heavier.h); NULL:
                                  nothing, and the four above never change */

    double scale;       /* force units per newton, a power of two */
    double time_step;   /* [s] */
    uint64_t interval;  /* steps after which is decided (step/interval.h) */
    double stable_step; /* the elements' bound at rest [s] */
    lar_step_room room; /* of a step, where tools touch */
    lar_gid stable_worst;
    double thinnest; /* element at rest, of hex8 [m] */
    double memory;   /* of how finely steps were divided lately: lar_model_memory [s] */
    bool adds;       /* mass, see mass_scaling.h */
    lar_hex8_limits limits;
    lar_leapfrog leapfrog; /* without gravity when gravity follows a curve */

    lar_surroundings surroundings;    /* of a part: none, they belong to its threads */
    struct lar_domain_shared *shared; /* with whom it has constants in common (domain_share.h);
                                         NULL: nobody */
} lar_domain;

/* Whether the options ask for several processors, or for what these do. */
bool lar_division_asked(const lar_options *options);

/* Compiles a checked model. The step is options->time_step, or the model's, or automatic
 * (lar_auto_step). A step above the stable step is an error that names both. */
lar_status lar_domain_create(const lar_model *model, const lar_options *options, lar_domain *domain,
                             lar_error *error);
/* The same with a style of layout: LAR_LAYOUT_LOOSE shows that the layout changes no bit. */
lar_status lar_domain_create_styled(const lar_model *model, const lar_options *options,
                                    lar_layout_style style, lar_domain *domain, lar_error *error);
void lar_domain_destroy(lar_domain *domain); /* idempotent */

/* The domain of one processor of several: the same scale, step, limits and turned corners as the
 * whole, which must outlive it. counted[node of the model]: whether this processor accounts for the
 * node's energies, for one of several has to. Runs have at most run_max blocks. Conditions are
 * left to the caller: they belong to threads. */
lar_status lar_domain_create_part(const lar_domain *whole, const lar_part *part,
                                  const bool *counted, int32_t run_max, lar_domain *domain,
                                  lar_error *error);

/* The largest component of a force that may be set on a node [N]: a few hundred together, and more
 * from elements, still fit the force sums. */
static inline double lar_domain_force_max(const lar_domain *domain) {
    return 0x1p52 / domain->scale;
}

/* What gravity pulls at, of a node's mass [kg]. */
static inline double lar_domain_weighs(const lar_domain *domain, lar_lid n) {
    return domain->added ? domain->mass[n] - domain->added[n] : domain->mass[n];
}

/* The masses that springs of contact are fitted to: a spring must not become harder on the way. */
static inline const double *lar_domain_springs(const lar_domain *domain) {
    return domain->burden ? domain->burden->mass : domain->mass;
}

/* How a node of so much mass is pushed by a force: see lar_node_update. */
static inline double lar_domain_push_of(const lar_domain *domain, double mass) {
    double dt = domain->time_step;
    return dt / (mass * (1 + 0.5 * domain->model->damping * dt) * domain->scale);
}

/* The material of element e as it is now. */
static inline const lar_material *lar_domain_material(const lar_domain *domain, lar_gid e) {
    return &domain->material[domain->model->element_material[e]];
}

/* The same for threads that do not advance the simulation: a copy, as active as it is now; *factor
 * (may be NULL) is how many times as stiff it is as the model says. */
lar_material lar_domain_material_copy(const lar_domain *domain, lar_gid e, double *factor);

/* Between steps: makes materials as stiff as `settings` ask, with the `parameters` that were set.
 * Stresses, hourglass forces and barriers become what they would have been if the model had had
 * these materials: the element's numbers are made anew, so that it does not matter how stiff it was
 * before. True when something changed. What is active becomes as active as they ask, which costs
 * nothing and is not told. */
bool lar_domain_stiffen(lar_domain *domain, const lar_settings *settings,
                        const lar_parameters *parameters);
/* Whether there is something to do for it. */
bool lar_domain_follows(const lar_domain *domain, const lar_settings *settings,
                        const lar_parameters *parameters);

/* The element in a lane of block `b` (of layout.block), as stiff as it is now; hex8 only. */
void lar_domain_element(const lar_domain *domain, int32_t run, int32_t b, int lane, lar_hex8 *hex8);

/* Displacements of the corners of global element e, [8][3]. */
void lar_domain_corners(const lar_domain *domain, const double *u, lar_gid e, double out[8][3]);

#endif
