/* What Lariat needs of PETSc, as a table that a loadable module fills.
 *
 *     lariat  --dlopen-->  liblariat-petsc.so  --linked-->  libpetsc, and with it an MPI
 *
 * PETSc pulls in an MPI and some dozen libraries, which no run of the engine needs: nothing but
 * this module links it. Sequential matrices on PETSC_COMM_SELF; one thread at a time.
 */
#ifndef LAR_STUDY_IMPLICIT_PETSC_SHIM_H
#define LAR_STUDY_IMPLICIT_PETSC_SHIM_H

#include "study/implicit/linear_solver.h"

/* Changes with every change of the table. */
enum { LAR_PETSC_VERSION = 1 };

typedef struct lar_petsc {
    int version;
    char name[32]; /* "PETSc 3.18.5" */
    /* 0 or PETSc's error code. The matrix must stay where it is. */
    int (*start)(void);
    int (*solve)(const lar_linear_options *options, const lar_sparse *A, const double *b, double *x,
                 lar_linear_result *result);
} lar_petsc;

/* The symbol that the module exports. */
#define LAR_PETSC_SYMBOL "lar_petsc_table"

#endif
