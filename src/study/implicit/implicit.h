/* The same model integrated implicitly, to compare with (T 2.2.4): no second engine.
 *
 *     for every time-step             Newmark, alpha = 1/2, beta = 1/4 (T 2.8 to 2.11, where the
 *       until the residual is small   second factor of 2.9 is alpha/beta - 1)
 *         K = tangent (study/implicit/tangent.h) + (1/(beta dt^2) + c alpha/(beta dt)) M
 *         solve K d = -r              study/implicit/linear_solver.h
 *         u += s d                    s = 1, halved until no element is inverted and the residual
 *                                     along d has shrunk (line search)
 *
 * Elements, lumped masses, damping, supports, curves and loads are the engine's own: the residual
 * is made of lar_hex8_force and lar_conditions_load. Quasi-static, masses and damping are left out
 * of it, and steps are as large as Newton's method bears. The tangent leaves out that pressures
 * follow the faces; their forces do, so Newton only takes more iterations. Contact and tools are
 * not there and refused.
 *
 * A step that fails is tried again in halves, as often as allowed; then the run ends with
 * LAR_ERROR_UNSTABLE and a sentence that says where and why. One thread, plain C.
 */
#ifndef LAR_STUDY_IMPLICIT_IMPLICIT_H
#define LAR_STUDY_IMPLICIT_IMPLICIT_H

#include "model/model.h"
#include "study/implicit/linear_solver.h"

typedef struct lar_implicit_options {
    double time_step; /* [s] */
    bool quasi_static;
    double tolerance;          /* of the residual, against the forces that balance in it */
    int newton_max;            /* iterations of a step */
    int halvings_max;          /* of a step that fails */
    lar_linear_solver *solver; /* stays the caller's */
} lar_implicit_options;

/* 0.01 s, dynamic, 1e-6, 25 iterations, no halving, no solver. */
lar_implicit_options lar_implicit_options_default(void);

typedef struct lar_implicit_tally {
    int64_t steps, newton, linear; /* steps done; iterations of both kinds, of failures, too */
    int64_t halved;                /* steps that failed and were tried again */
    int64_t searches;              /* iterations that took less than the whole of d */
    double assembly, solving;      /* seconds spent building matrices, and solving with them */
} lar_implicit_tally;

typedef struct lar_implicit lar_implicit;

lar_status lar_implicit_create(const lar_model *model, const lar_implicit_options *options,
                               lar_implicit **implicit, lar_error *error);
void lar_implicit_destroy(lar_implicit *implicit); /* NULL is fine */

/* Goes on to that time. After an error the state is that of the last step that was done. */
lar_status lar_implicit_advance(lar_implicit *implicit, double until, lar_error *error);

double lar_implicit_time(const lar_implicit *implicit);
const lar_implicit_tally *lar_implicit_count(const lar_implicit *implicit);
int32_t lar_implicit_rows(const lar_implicit *implicit); /* of the matrix */
int64_t lar_implicit_values(const lar_implicit *implicit);

/* Displacements at the present time [m], in the order of the model's nodes. */
void lar_implicit_displacements(const lar_implicit *implicit, double (*out)[3]);

#endif
