/* Solving A x = b for the implicit comparison, by whoever can.
 *
 *     own      conjugate gradients with the diagonal as preconditioner: needs nothing, serves tests
 *     PETSc    its Krylov solvers and preconditioners, from the module liblariat-petsc.so that the
 *              build makes where PETSc is installed (study/implicit/petsc_shim.h); loaded when
 *              asked for
 *
 * That a system cannot be solved is a result, not an error: it is what the comparison is about
 * (T 2.2.4, table 2.1).
 */
#ifndef LAR_STUDY_IMPLICIT_LINEAR_SOLVER_H
#define LAR_STUDY_IMPLICIT_LINEAR_SOLVER_H

#include "study/implicit/sparse.h"

typedef struct lar_linear_result {
    bool solved;
    int iterations;
    double residual;  /* |b - A x| / |b| as the solver sees it */
    char reason[120]; /* why not */
} lar_linear_result;

typedef struct lar_linear_options {
    const char *method;         /* "own", or of PETSc "cg" or "bcgs" (BiCGSTAB) */
    const char *preconditioner; /* of PETSc: "jacobi", "icc", "ilu", "gamg"; else NULL */
    double tolerance;           /* of the residual, against |b| */
    int iterations_max;
} lar_linear_options;

/* "own", 1e-8, 20000. */
lar_linear_options lar_linear_options_default(void);

typedef struct lar_linear_solver lar_linear_solver;

/* Without the module: LAR_ERROR_UNSUPPORTED, with what to install. */
lar_status lar_linear_solver_open(const lar_linear_options *options, lar_linear_solver **solver,
                                  lar_error *error);
void lar_linear_solver_close(lar_linear_solver *solver); /* NULL is fine */

/* Whether PETSc's module is there; it is not loaded. */
bool lar_linear_solver_petsc(void);

/* Who solves, for tables: "PETSc 3.18.5 bcgs + ilu". */
const char *lar_linear_solver_name(const lar_linear_solver *solver);

/* x of A x = b from x = 0, A symmetric. */
lar_status lar_linear_solve(lar_linear_solver *solver, const lar_sparse *A, const double *b,
                            double *x, lar_linear_result *result, lar_error *error);

#endif
