/* How fast elements of compressible tissue become when they are strained.
 *
 * Of nearly incompressible tissue the change of volume is the fastest motion at rest, and what
 * shear gains by strain is hidden behind it: means over all directions will do (lar_hex8_growth).
 * Where K < 4 G (a Poisson's ratio below 0.385) shear decides. A cube with nu = 0 that is pressed
 * to 0.6 along one axis is 2.6 times as stiff along it, and the means say 1.3. So of such elements
 * the largest eigenvalue of the law's tangent is taken, of the mean gradient's: exact for a cube,
 * whose gradients point along all axes alike. Of a flat element, which feels what goes along its
 * short edges, the largest stiffness along a principal axis, against K + 4/3 G.
 */
#ifndef LAR_STEP_MASS_COMPRESSIBLE_H
#define LAR_STEP_MASS_COMPRESSIBLE_H

#include "mechanics/hex8_block.h"

/* Whether it is one, by its moduli at once. */
bool lar_material_compressible(const lar_material *material);

/* What the monitor has for such an element instead of lar_hex8_area_limit: below 0, so that it is
 * listed by |F^-1|^2 as well. */
double lar_compressible_limit(double area_limit);

/* How the square of its frequency has grown with `strain`, barriers and fibres apart; `limit` as
 * above. 0 where the gradient is turned over. */
double lar_compressible_growth(const lar_material *material, double limit,
                               const float strain[LAR_STRAIN_NUMBERS]);

#endif
