/* Geometry of the eight-node hexahedron, shared by all its elements.
 *
 *          7-------6        Local node a sits at the natural coordinates lar_node_sign[a]
 *         /|      /|        (model/mesh/mesh.h); its shape function is
 *        4-------5 |            N_a = (1 + xi_a xi)(1 + eta_a eta)(1 + zeta_a zeta) / 8
 *        | 3-----|-2        The rule of integration is 2x2x2 Gauss, all weights 1: exact for the
 *        |/      |/         volume of any hexahedron and for everything in a parallelepiped.
 *        0-------1
 */
#ifndef LAR_MECHANICS_HEXAHEDRON_H
#define LAR_MECHANICS_HEXAHEDRON_H

enum { LAR_GAUSS_POINTS = 8 };

/* Natural coordinates of Gauss point g = 0..7, the one in the corner of node g. */
void lar_gauss_point(int g, double at[3]);

/* J = dx/dxi at the natural point `at`, from the corner positions [m]. */
void lar_hexahedron_jacobian(const double corner[8][3], const double at[3], double J[3][3]);

/* Gradients grad N_a [1/m] at the natural point `at`; returns det dx/dxi [m^3], which is the
 * volume of a Gauss point. The corners must not make it zero. */
double lar_hexahedron_gradients(const double corner[8][3], const double at[3],
                                double gradient[8][3]);

#endif
