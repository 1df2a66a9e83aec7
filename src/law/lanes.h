/* The laws for a lane (base/simd.h): what the kernels of every instruction set, the oracles and
 * the energies share. The file of the law NAME has
 *
 *   lar_lane lar_NAME_stress(F[9], P[9], J, I1, p)
 *       F row by row, J = det F > 0, I1 = |F|^2, p the parameters of its row, those in pascal times
 *       any common factor. P holds cof F on entry and the first Piola-Kirchhoff stress (times that
 *       factor) on return. Returns a number not below |P|^2 in order of magnitude (for the overflow
 *       guard): the sum of the squares of the terms P is made of, with |cof F| <= I1.
 *   lar_lane lar_NAME_energy(F[9], J, I1, p)
 *       energy per reference volume (times the factor).
 *   unsigned lar_NAME_stiffened(J, I1, area, p, share)
 *       a bit for each lane whose shear has stiffened by more than `share` of K + 4/3 G at rest, so
 *       that its step must be looked at; area = |cof F|^2. 0 for laws that never do.
 *
 * and, where LAR_LAW_ROWS is defined (law/law.c), the rest of its row. No libm, no branch on the
 * data in what is for lanes: the same bits everywhere.
 */
#ifndef LAR_LAW_LANES_H
#define LAR_LAW_LANES_H

#define LAR_LAW_FILES
#include "law/list.h"

#endif
