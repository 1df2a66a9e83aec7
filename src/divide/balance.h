/* Brings a distribution from elsewhere (METIS) to balance, with few and cheap moves.
 *
 *     too many   p --> r --> q   too few     one border element moves on along a way of
 *                                            touching processors: p loses one, q gains one
 *
 * Of the elements that can move the one is taken that raises the cost (eq. 6.8, summed) least.
 */
#ifndef LAR_DIVIDE_BALANCE_H
#define LAR_DIVIDE_BALANCE_H

#include "divide/cost.h"

/* Changes processor[] until the numbers of elements differ by one at most. Fails only without
 * memory. */
lar_status lar_balance(const lar_mesh *mesh, const lar_incidence *incidence, int32_t processors,
                       int32_t *processor, lar_error *error);

#endif
