/* The same slow loading, integrated explicitly by the engine and implicitly
 * (study/implicit/implicit.h): answers and costs beside each other (T 2.2.4, 2.2.5, table 2.1).
 *
 * Both have the same mesh, materials, lumped masses, damping, supports, loads and curves. What the
 * implicit way does not know, contact and tools, is left out of both. The engine runs on one
 * processor; the implicit side on one thread in plain C, its linear systems solved by whoever is
 * asked for. Times are what the clock says, once: the two differ by far more than a clock errs.
 *
 * Cases made in memory:
 *
 *     slow      a block of 6 x 6 x 6 hexahedra, held on one side, pulled on the other
 *
 *     buckle    a symmetric arch, clamped at both ends, pressed at its crown by a growing force:
 *               its tangent turns singular, then indefinite; conjugate gradients end there
 *
 *     loose     a block held on one side and a piece that nothing holds, under gravity: without
 *               masses the matrix is singular (T 2.2.4: "some tissue moves freely")
 */
#ifndef LAR_STUDY_IMPLICIT_BENCH_IMPLICIT_H
#define LAR_STUDY_IMPLICIT_BENCH_IMPLICIT_H

#include "simulation/simulation.h"
#include "study/implicit/implicit.h"

typedef enum lar_implicit_case {
    LAR_IMPLICIT_SLOW,
    LAR_IMPLICIT_BUCKLE,
    LAR_IMPLICIT_LOOSE,
    LAR_IMPLICIT_CASES
} lar_implicit_case;

/* The caller destroys the model. */
lar_status lar_implicit_case_create(lar_implicit_case which, lar_model **model, lar_error *error);

typedef struct lar_bench_implicit_options {
    lar_model *model; /* as it was, afterwards */
    double until;     /* [s]; 0: the model's duration */
    lar_linear_options linear;
    lar_implicit_options implicit; /* its solver is made from `linear` */
} lar_bench_implicit_options;

typedef struct lar_bench_implicit_result {
    lar_model_info info;
    int32_t left_out;     /* contacts and tools */
    double until;         /* what the engine reached [s] */
    double explicit_step; /* [s] */
    uint64_t explicit_steps;
    double explicit_seconds;
    char solver[80];
    int32_t rows;
    int64_t values;
    double implicit_seconds;
    lar_implicit_tally tally;
    bool failed;        /* the implicit way; the figures are of what it did until then */
    double reached;     /* [s] */
    char reason[512];   /* why it failed */
    double largest;     /* displacement of an axis, explicitly [m] */
    double apart;       /* largest difference against it, at `until`; -1 where it failed */
    double kinetic_max; /* of the engine, seen a hundred times in the run [J] */
} lar_bench_implicit_result;

/* Fails where the engine fails or PETSc is asked for and not there; not where the implicit way
 * finds no solution. */
lar_status lar_bench_implicit(const lar_bench_implicit_options *options,
                              lar_bench_implicit_result *result, lar_error *error);

#endif
