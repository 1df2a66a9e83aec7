/* The energy of one corner of a hexahedron, and how it changes when a node moves.
 *
 * Three edges e_1 e_2 e_3 leave a corner; d is their determinant, s the scaled Jacobian
 * d / (|e_1| |e_2| |e_3|), q the sum of their squares and r that of the areas |e_i x e_j| squared.
 * With the cell's edge as the unit of length
 *
 *     energy = shape * (q + r / d^2 - 6)             0 for the cell itself
 *            + steep * (aim - s)^2 / (s - floor)     while s < aim; infinite at the floor
 *
 * The first term is the symmetric Dirichlet energy (Smith and Schaefer, Bijective parameterization
 * with free boundaries, ACM Trans. Graphics 34, 2015): |J|^2 + |J^-1|^2 with the edges as columns
 * of J, the sum of x^2 + 1 / x^2 over the stretches x. The rows of J^-1 are one over the heights
 * between opposite faces, with the shortest of which an explicit solver's stable step goes;
 * measures of angles and of volume let elements become thinner for the same distance to the
 * boundary. The second makes it an interior point method: a valid mesh stays valid.
 *
 * For a node that moves by x, d is linear in x and the other sums are quadratic, whether the node
 * is the corner itself (all three edges change by -x) or the end of one edge, so all derivatives
 * are short.
 */
#ifndef LAR_MESHING_FIT_QUALITY_H
#define LAR_MESHING_FIT_QUALITY_H

#include <stdint.h>

typedef struct lar_fit_law {
    double shape, steep;
    double aim, floor;
} lar_fit_law;

/* The ends of the three edges at each corner of a hexahedron, right-handed. */
extern const uint8_t lar_fit_edge[8][3];

/* Which of a corner's nodes moves: the end of edge 0, 1, 2, or the corner. */
enum { LAR_FIT_MOVES_CORNER = 3 };

/* A function of a node's place: value, gradient, and Hessian (xx yy zz xy yz zx). */
typedef struct lar_fit_newton {
    double value, gradient[3], hessian[6];
} lar_fit_newton;

/* Energy of a corner; INFINITY where s is not above the floor or d not above 0. */
double lar_fit_corner_energy(const lar_fit_law *law, const double edge[3][3]);

/* Adds a corner's energy and derivatives. The corner must be above the floor. */
void lar_fit_corner_newton(const lar_fit_law *law, const double edge[3][3], int moves,
                           lar_fit_newton *sum);

#endif
