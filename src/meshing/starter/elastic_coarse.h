/* What conjugate gradients are slow at: the body's large, soft motions.
 *
 *     .------.------.------.------.      nodes in groups, as boxes of a few elements cut the body;
 *     |  o   |  o   |  o   |  o   |      each group moves as a rigid body, six numbers for each
 *     '------'------'------'------'
 *
 * The stiffness P^T K P between these motions is small and is solved directly; added to the
 * diagonal's preconditioner it leaves to conjugate gradients what happens within a box (Nicolaides,
 * SIAM Journal on Numerical Analysis 24, 1987; Vanek, Mandel and Brezina, Computing 56, 1996).
 * Bending is what needs it: a rod of n elements has a condition of n^4. */
#ifndef LAR_MESHING_STARTER_ELASTIC_COARSE_H
#define LAR_MESHING_STARTER_ELASTIC_COARSE_H

#include "meshing/starter/elastic_factor.h"

enum { LAR_RIGID = LAR_FACTOR_BLOCK }; /* motions of a group */

typedef struct lar_coarse {
    int32_t node_count, group_count;
    int32_t *group;       /* [nodes] -1: still */
    const uint8_t *still; /* of the body, which must stay */
    double (*arm)[3];     /* [nodes] from the group's centre, in boxes */
    lar_factor factor;    /* of P^T K P */
} lar_coarse;

lar_status lar_coarse_create(const lar_elastic *elastic, lar_coarse *coarse, lar_error *error);
void lar_coarse_clear(lar_coarse *coarse);

/* z += P (P^T K P)^-1 P^T r. way: [6 groups] of the caller's. */
void lar_coarse_add(const lar_coarse *coarse, lar_pair *way, const lar_pair_vectors *r,
                    lar_pair_vectors *z);

#endif
