/* Values for pictures, at any displacements: what a viewer colours the surface by.
 *
 * Asked for by threads that draw, while another one computes: only constants of the simulation are
 * read. What an element needs for it (its mean gradient, hex8.h) is prepared once, at the first
 * question; of several that ask at first one's work is kept. A node has the mean of its elements,
 * each counting the same. Stresses are those that results have, to the bit (measure.h).
 */
#ifndef LAR_SIMULATION_FIELD_H
#define LAR_SIMULATION_FIELD_H

typedef struct lar_field_plan lar_field_plan;

void lar_field_plan_destroy(lar_field_plan *plan); /* accepts NULL */

#endif
