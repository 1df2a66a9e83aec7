/* What keeps flat elements from folding under pressure.
 *
 * Hourglass control is as stiff along the thickness of a flat element as along its width (hex8.h),
 * which is what bending asks for. Where nearly incompressible tissue cannot escape, nodes in the
 * middle of a layer then go up and down in turns: elements tilt against each other, and what they
 * lose in height costs no volume of the mean gradient, the only one that is counted.
 *
 *      pressed          folds              So what the hourglass modes strain along it counts as
 *     ___________      __/\____/\__        volume that is gone, of elements under pressure:
 *     |__|__|__|__|    |_/__\_/__\|
 *     |__|__|__|__|    | \__/ \__/|            W = V K'/4 (<t + Q>^2 - <t>^2),   t = 0.999 - J
 *
 *     Q = 1/2 sum over m of (w_m q_m . F N)^2,    N = sqrt(k/2) B_i,    <x> = max(x, 0)
 *
 * i: the element's shortest axis; m: the hourglass modes; w_m = 1 for the two that are a product of
 * i and another axis, 1/sqrt(3) for xi eta zeta, else 0; k as in hex8.h. Of a box, whose B_i is
 * 1/(4 L_i) along that axis, they are held along it with 1/L_i^2, as a flat element needs it, and
 * with 3/4 of the pressure. K' is what K is more than 20 G: with less nothing folds. Nothing at all
 * happens before a thousandth of the volume is gone, or counts as gone: bending is as soft as ever.
 * W is never below zero and does not see how an element is turned. That it is a quarter and no half
 * of K': what is bent and not pressed answers to a change of its volume with 3/2 K, and a step of
 * 0.8 of the stable one bears 1.56. For elements of more than 1.8 : 1: others do not fold
 * (docs/decisions.md, 234).
 */
#ifndef LAR_MECHANICS_FOLD_HEX8_FOLD_H
#define LAR_MECHANICS_FOLD_HEX8_FOLD_H

#include "mechanics/hex8.h"

typedef struct lar_hex8_fold {
    double axis[3];                    /* N [1/m] */
    double weight[LAR_HEX8_HOURGLASS]; /* w_m */
    double bulk, from;                 /* K'/2 [Pa]; t is that less J */
} lar_hex8_fold;

/* Whether an element is so flat that it might fold, and a material so incompressible. */
bool lar_hex8_is_flat(const double corner[8][3]);
bool lar_hex8_may_fold(const lar_material *material);

/* Of an element with these gradients. */
void lar_hex8_fold_prepare(const double corner[8][3], const double gradient[3][3],
                           const lar_material *material, lar_hex8_fold *fold);

/* W [J] for displacements u, 0 of elements that do not fold; its derivative by them [N] is added to
 * `force` (may be NULL). Plain C, the oracle of the kernels. */
double lar_hex8_fold_force(const double corner[8][3], const lar_material *material,
                           const double u[8][3], double force[8][3]);

#endif
