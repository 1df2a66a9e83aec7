/* A domain that recovers its elements in single precision, for the study (single.h). */
#ifndef LAR_STUDY_PRECISION_SINGLE_DOMAIN_H
#define LAR_STUDY_PRECISION_SINGLE_DOMAIN_H

#include "step/domain.h"

typedef struct lar_single_domain {
    lar_kernels kernels;
    void *blocks;
    size_t bytes;
} lar_single_domain;

/* Puts kernels and blocks in single precision into a domain that has just been compiled; everything
 * else of a step stays production's. With `single_state` nodes are moved in single precision too;
 * the arrays of the state then hold doubles that are floats. Elements are not watched (that an
 * element turns inside out is not noticed). *adopted must outlive the domain's last step. Fails for
 * elements other than hex8, for instruction sets other than c and avx512, for want of memory. */
lar_status lar_single_adopt(lar_domain *domain, bool single_state, lar_single_domain *adopted,
                            lar_error *error);
void lar_single_release(lar_single_domain *adopted); /* idempotent */

#endif
