/* Values for pictures, at any displacements: what a viewer colours the surface by.
 *
 * Asked for by threads that draw, while another one computes: only constants of the simulation are
 * read. What an element needs for it (its mean gradient, hex8.h) is prepared once, at the first
 * question; of several that ask at first one's work is kept. A node has the mean of its elements,
 * each counting the same. Stresses are those that results have, to the bit (measure.h).
 */
#ifndef LAR_SIMULATION_FIELD_H
#define LAR_SIMULATION_FIELD_H

#include "step/domain.h"

typedef struct lar_field_plan lar_field_plan;

/* Prepares all elements of the model. */
lar_status lar_field_plan_create(const lar_domain *whole, lar_field_plan **plan, lar_error *error);
void lar_field_plan_destroy(lar_field_plan *plan); /* accepts NULL */

/* A field of stress or energy at u, [nodes][3] in the mesh's order, into out [nodes]. An element
 * that is inside out has none: it is left out; a node with no other one has 0. */
lar_status lar_field_of_elements(const lar_field_plan *plan, const lar_domain *whole,
                                 lar_field field, const double (*u)[3], float *out,
                                 lar_error *error);

#endif
