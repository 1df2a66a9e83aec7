/* hex8: the production element. Uniform strain, total hourglass control (T 3.2, algorithm 1).
 *
 * One stress evaluation per element from the MEAN gradient of the shape functions (Flanagan and
 * Belytschko 1981), so that the patch test holds on distorted meshes; the deformation is measured
 * from the reference shape (total Lagrangian), so that a closed load path returns to zero; the
 * modes that the mean gradient does not see are held by generalised hourglass forces from their
 * total displacement (Hutter, Hora and Niederer 2000; Joldes, Wittek and Miller 2008).
 *
 * Everything is done in MODES. The signs of the eight nodes form a Walsh-Hadamard basis
 *
 *     m    0    1    2     3         4        5       6          (and 1, translation,
 *     h_m  xi  eta  zeta  eta zeta  xi zeta  xi eta  xi eta zeta  which has no force)
 *
 * and the transform of the nodal displacements, U_m = sum_a h_m(a) u_a, costs 23 additions per
 * axis. With X_m the same of the reference positions and B_m the modal mean gradients,
 *
 *     H = sum_{m<6} U_m (x) B_m                   displacement gradient; F = I + H
 *     q_m = U_m - H X_m,  m = 3..6                what the linear field leaves over
 *     W = V w(F) + 1/2 sum_m c_m |q_m|^2          energy
 *     S = V P(F) - sum_m c_m q_m (x) X_m
 *     G_m = S B_m  (+ c_m q_m for m >= 3)         modal forces; f_a = sum_m h_m(a) G_m
 *
 * The volume V is a cubic form of X_0..X_5 in which X_6 does not appear, hence B_6 = 0: 18
 * gradients instead of 24.
 *
 * Hourglass stiffness: c_m = k G * 2 I2(M_m)/I1(M_m) / 64 with M_m = integral grad h (x) grad h
 * over the reference element, I1 and I2 its invariants. For a box 2 I2/I1 is the harmonic mean of
 * the bending stiffnesses 4V/(3 Lx^2) along the two directions of the mode, so slender elements
 * are not stiffened along their length, and the bulk modulus never enters: no locking.
 *
 * A bent beam of n elements through the thickness takes 1 - 1/n^2 of its exact energy from the
 * mean strains and k G/E of the missing 1/n^2 from the hourglass modes. Young's modulus would be
 * k = 3 and exact for this one mode; the others (torsion, xi eta zeta) then add too much. k = 1.58
 * keeps the hourglass energy just below 5% of the strain energy with four elements through the
 * thickness (k = 1.6 does not), and such beams within 1.5% of the converged deflection; with two
 * elements it leaves them 5 to 8% too soft under small loads. The sweep is in docs/validation.md.
 */
#ifndef LAR_MECHANICS_HEX8_H
#define LAR_MECHANICS_HEX8_H

#include "mechanics/stress.h"

enum { LAR_HEX8_GRADIENTS = 6, LAR_HEX8_HOURGLASS = 4 };

/* The factor k above. */
#define LAR_HOURGLASS_FACTOR 1.58

/* The volume's derivative by mode m of the corner positions is the sum of two terms
 * factor (X_left x X_right) / 64, in this order (hex8.c). */
static const struct {
    int left, right;
    double factor;
} LAR_HEX8_VOLUME_TERM[LAR_HEX8_GRADIENTS][2]
    __attribute__((unused)) = {{{1, 2, 1}, {5, 4, 1. / 3}},      {{2, 0, 1}, {3, 5, 1. / 3}},
                               {{0, 1, 1}, {4, 3, 1. / 3}},      {{2, 4, 1. / 3}, {5, 1, 1. / 3}},
                               {{3, 2, 1. / 3}, {0, 5, 1. / 3}}, {{1, 3, 1. / 3}, {4, 0, 1. / 3}}};

/* One element, ready to be recovered. */
typedef struct lar_hex8 {
    double gradient[LAR_HEX8_GRADIENTS][3]; /* B_m, m = 0..5 [1/m] */
    double shape[LAR_HEX8_HOURGLASS][3];    /* X_m, m = 3..6 [m] */
    double stiffness[LAR_HEX8_HOURGLASS];   /* c_m, m = 3..6 [N/m] */
    double volume;                          /* [m^3] */
    double fibre[6]; /* unit vectors along its fibres, of a pair two; 0: it has none */
} lar_hex8;

/* Prepares an element from its reference corners [8][3] and its material; without fibres, which
 * the caller puts in. */
void lar_hex8_prepare(const double corner[8][3], const lar_material *material, lar_hex8 *element);

/* What displacements are made of: the mean gradient and the hourglass displacements q_m [m]. */
void lar_hex8_modes(const lar_hex8 *element, const double u[8][3], double F[3][3],
                    double q[LAR_HEX8_HOURGLASS][3]);
/* And the forces on the nodes [N] of what works on these: a stress P [Pa] and the forces dW/dq_m
 * [N]. */
void lar_hex8_nodal(const lar_hex8 *element, const double P[3][3],
                    const double hourglass[LAR_HEX8_HOURGLASS][3], double force[8][3]);

/* Internal forces dW/du [8][3] in newtons for displacements u [8][3]; returns det F. Plain C, the
 * formulas above in order: the oracle of the kernels. */
double lar_hex8_force(const lar_hex8 *element, const lar_material *material, const double u[8][3],
                      double force[8][3]);

/* Energies [J] for displacements u; *hourglass may be NULL. Returns the strain energy V w(F). */
double lar_hex8_energy(const lar_hex8 *element, const lar_material *material, const double u[8][3],
                       double *hourglass);

/* The sum over the nodes of |dV/dx|^2 [m^4], V the volume between these corners: how much of the
 * element's faces looks at each node. */
double lar_hex8_areas(const double corner[8][3]);

/* Mean deformation gradient. */
void lar_hex8_gradient(const lar_hex8 *element, const double u[8][3], double F[3][3]);

/* Highest angular frequency [rad/s] of the element alone at rest with its mass lumped in eight
 * equal parts. No mode of any assembly of elements is faster (Flanagan and Belytschko 1984), so
 * 2 / max over elements is a safe bound of the central difference step. Never too low and at most
 * 0.05 % too high, for every material with positive moduli (auxetic ones among them). What fibres
 * add at rest, fully active, is counted as if the fastest mode were theirs: too high by so much. */
double lar_hex8_frequency(const lar_hex8 *element, const lar_material *material);

#endif
