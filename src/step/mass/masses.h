/* Masses of the nodes: an eighth of each element's, with what mass scaling adds (mass_scaling.h),
 * and beside them, where the model lets strained elements be heavier for a while (heavier.h), what
 * they are without that. */
#ifndef LAR_STEP_MASS_MASSES_H
#define LAR_STEP_MASS_MASSES_H

#include "contact/tools.h"
#include "layout/layout.h"
#include "step/stable_step.h"

/* Adds up mass[nodes of the layout], and of it what is added (NULL: nothing). */
void lar_masses_spread(const lar_model *model, const lar_layout *layout,
                       const lar_element_rate *rate, double *mass, double *added);

/* Beside a domain whose model lets elements be heavier. */
typedef struct lar_burden {
    double *mass;      /* [layout.node_padded] without what is more for a while [kg] */
    double *added;     /* the same of lar_domain.added; NULL: nothing */
    double most;       /* that strained elements may have more [kg] */
    lar_heavy_now now; /* who is heavier */
    int32_t node_count;
    lar_lid node[8 * LAR_HEAVIER_MAX]; /* their nodes, of those that are here */
} lar_burden;

/* With masses as they are now; `most` is the caller's to set. NULL: there is no memory. */
lar_burden *lar_burden_create(const double *mass, const double *added, size_t nodes);
lar_burden *lar_burden_copy(const lar_burden *from, size_t nodes);
void lar_burden_destroy(lar_burden *burden); /* accepts NULL */

/* What strained elements of a model may have more [kg]. */
double lar_burden_most(const lar_model *model, const lar_element_rate *rate);

#endif
