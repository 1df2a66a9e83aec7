/* What stands beside the blocks of a domain: the coefficients of viscosity, and fibres. */
#ifndef LAR_STEP_BESIDE_H
#define LAR_STEP_BESIDE_H

#include "step/domain.h"

/* Beside one block. */
typedef struct lar_beside {
    lar_viscous_block *relaxing; /* NULL: it is elastic */
    lar_fibre_block *fibres;     /* NULL: it has none */
    lar_fibre_block *second;     /* of the other family; NULL: they are no pair */
} lar_beside;

/* Fills a lane with what `material` says, a material `factor` times as stiff as in the model. */
void lar_fill_viscosity(const lar_domain *domain, const lar_lane_base *base,
                        lar_viscous_block *block, int lane, const lar_material *material,
                        double factor);
/* The same of the fibres of element e. */
void lar_fill_fibres(const lar_domain *domain, const lar_lane_base *base, lar_beside beside,
                     int lane, const lar_material *material, lar_gid e);

/* Makes the blocks of fibres, where there are any, and lets the runs point to them. False: there
 * was no memory. */
bool lar_fibres_plan(lar_domain *domain);

/* Refuses kinds of elements that cannot have fibres. */
lar_status lar_fibres_check(const lar_domain *domain, lar_error *error);

#endif
