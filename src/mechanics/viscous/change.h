/* A viscous element whose law gets other parameters between two steps. That is no strain: neither
 * the element's, nor that which the dampers of its Maxwell elements have come to. With the law's
 * stress Se(E) a term that has the overstress H has the strain
 *
 *     E_d:   Se(E_d) = Se(E) - H        before
 *            H' = Se'(E) - Se'(E_d)     after; Se' is that of the new law
 *
 * so what has relaxed (E_d = E) stays so, and from moduli that are all lambda times as large
 * follows lambda H. What its spring holds, the integral of Se(x) - Se(E_d) from E_d to E, changes
 * with it.
 *
 * E_d is looked for by steps along the residual's strain in an isotropic body with the law's moduli
 * at rest, each as long as the last one says (Barzilai and Borwein 1988). Some laws do not reach
 * all stresses, the isochoric part none that has a pressure: of what is left over H' has as many
 * times as the shear modulus became larger, and springs hold nothing.
 */
#ifndef LAR_MECHANICS_VISCOUS_CHANGE_H
#define LAR_MECHANICS_VISCOUS_CHANGE_H

#include "mechanics/stress.h"

/* What an element remembers (law/viscosity.h, of the material as both of these are) becomes that of
 * the other material, of which only parameters differ; its work changes by what springs hold.
 * (Active stress does not relax.) `fibre` as in lar_viscous_stress_at. */
void lar_viscous_change(const lar_material *before, const lar_material *after, const double *fibre,
                        double *history);

#endif
