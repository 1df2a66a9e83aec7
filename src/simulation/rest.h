/* When a body has come to rest: see lar_rest in lariat.h.
 *
 *      since                                              loads constant from here on
 *        |---window 1---|---window 2----|-----window 3------|   each at least half a slow period,
 *        x  x  x  x  x  x  x  x  x  x ...                       and a quarter of all before it;
 *                                                              x: a look, sixteen per period
 *
 * A swinging body stands still twice in a period, so one look at the kinetic energy K proves
 * nothing: of a window the largest counts. A body that creeps under strong damping has little
 * kinetic energy and far to go: there counts what damping will still take. It takes 2 c K per
 * second (c: damping per mass), and K fades from one window to the next by q, the ratio of their
 * means; so a window T with the mean M has
 *
 *     R = 2 c M T (q + q^2 + ...) = 2 c M T q / (1 - q)
 *
 * before it. The body rests when largest K + R (and M) is below 1e-10 of the strain energy: the
 * displacements are then within about the root of that, 1e-5, of those at rest.
 *
 * A body that comes back to its own shape has no strain energy at rest: that fades as the motion
 * does, and what both end in is rounding. Forces are whole units, one of which makes a node faster
 * by `push` in a step; from one look to the next such errors add up to a kinetic energy of about
 *
 *     Q n,   Q = sum of m push^2 / 2 over the nodes,   n: steps between two looks
 *
 * So the body rests as well when largest K + R is below 1e4 Q n, whatever the strain energy: two
 * orders above what trembles with a hundredth of the critical damping, and displacements within
 * about 1e-11 of the size of its elements. A body that swings through its own shape has its energy
 * in K.
 *
 * What viscous terms remember lets a body go on for as long as their times, however slowly: g_i H_i
 * of law/viscosity.h is stress that will be gone. What it stores, in springs as stiff as the law's
 * shear modulus G, goes with its square, as K does, and counts beside it:
 *
 *     M = sum of V g_i |H_i|^2 / (4 G) over the elements and their terms
 *
 * Energies are summed in the order of the mesh from the whole state, whose bits do not depend on
 * the division, with functions of our own: every grid and instruction set ends in the same step.
 *
 * Where nobody says how such a body is damped, that is the less of two, known before the first
 * step:
 *
 *     shear wave along the body    model/rest.h     also for loose bodies
 *     its slowest motion           slowest.h        a beam 20 times as long as thick bends 20 times
 *                                                   more slowly, and would creep with the former
 */
#ifndef LAR_SIMULATION_REST_H
#define LAR_SIMULATION_REST_H

#include "simulation/simulation.h"

/* Energies of the state as it stands, velocities half a step back [J]; `strain` may be NULL. */
void lar_rest_energies(const lar_domain *domain, const lar_state *state, double *kinetic,
                       double *strain);

/* The damping with which the model's body comes to rest soonest [1/s]. */
double lar_rest_damping(const lar_model *model);

/* Gives it to a model that nobody gave a damping, and a notice where it is another one; without
 * memory for that the model is destroyed and NULL. */
lar_status lar_model_damp_itself(lar_model **model, lar_error *error);

#endif
