/* The module liblariat-petsc.so (petsc_shim.h). */
#include "study/implicit/petsc_shim.h"

#include <petscksp.h>
#include <stdio.h>
#include <string.h>

_Static_assert(sizeof(PetscInt) == sizeof(int32_t), "PETSc with 32-bit indices");
_Static_assert(sizeof(PetscScalar) == sizeof(double), "PETSc with real double precision");

static int start(void) {
    PetscBool before;
    if (PetscInitialized(&before)) return 1;
    if (before) return 0;
    PetscErrorCode code = PetscInitializeNoArguments();
    /* Errors come back as codes; nothing is printed, signals stay ours. */
    if (!code) code = PetscPushErrorHandler(PetscReturnErrorHandler, NULL);
    if (!code) code = PetscPopSignalHandler();
    return (int)code;
}

/* Options by hand, not by PETSc's data base, which environment and files may fill. */
static PetscErrorCode prepare(KSP ksp, const lar_linear_options *o, Mat matrix) {
    PC pc;
    PetscErrorCode code = KSPSetOperators(ksp, matrix, matrix);
    if (!code) code = KSPSetType(ksp, o->method);
    if (!code) code = KSPGetPC(ksp, &pc);
    if (!code) code = PCSetType(pc, o->preconditioner);
    /* Incomplete factors of stiff, nearly incompressible matrices may lose a pivot's sign. */
    if (!code && (!strcmp(o->preconditioner, PCILU) || !strcmp(o->preconditioner, PCICC)))
        code = PCFactorSetShiftType(pc, MAT_SHIFT_POSITIVE_DEFINITE);
    if (!code) code = KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED);
    if (!code && strcmp(o->method, KSPCG) != 0) code = KSPSetPCSide(ksp, PC_RIGHT);
    if (!code) code = KSPSetTolerances(ksp, o->tolerance, 0, 1e8, o->iterations_max);
    return code;
}

static PetscErrorCode iterate(KSP ksp, Vec right, Vec left, lar_linear_result *result) {
    KSPConvergedReason reason;
    PetscInt iterations;
    PetscReal norm, residual;
    PetscErrorCode code = KSPSolve(ksp, right, left);
    if (!code) code = KSPGetConvergedReason(ksp, &reason);
    if (!code) code = KSPGetIterationNumber(ksp, &iterations);
    if (!code) code = KSPGetResidualNorm(ksp, &residual);
    if (!code) code = VecNorm(right, NORM_2, &norm);
    if (code) return code;
    result->solved = reason > 0;
    result->iterations = (int)iterations;
    result->residual = norm > 0 ? residual / norm : 0;
    if (reason <= 0)
        snprintf(result->reason, sizeof result->reason, "PETSc says %s",
                 KSPConvergedReasons[reason]);
    return 0;
}

static int solve(const lar_linear_options *options, const lar_sparse *A, const double *b, double *x,
                 lar_linear_result *result) {
    Mat matrix = NULL;
    Vec right = NULL, left = NULL;
    KSP ksp = NULL;
    PetscInt n = A->rows;
    PetscErrorCode code =
        MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, A->start, A->column, A->value, &matrix);
    if (!code) code = MatSetBlockSize(matrix, 3);
    if (!code) code = MatSetOption(matrix, MAT_SYMMETRIC, PETSC_TRUE);
    if (!code) code = VecCreateSeqWithArray(PETSC_COMM_SELF, 3, n, b, &right);
    if (!code) code = VecCreateSeqWithArray(PETSC_COMM_SELF, 3, n, x, &left);
    if (!code) code = KSPCreate(PETSC_COMM_SELF, &ksp);
    if (!code) code = prepare(ksp, options, matrix);
    if (!code) code = iterate(ksp, right, left, result);
    KSPDestroy(&ksp);
    VecDestroy(&left);
    VecDestroy(&right);
    MatDestroy(&matrix);
    return (int)code;
}

#define TEXT_OF(number) #number
#define TEXT(number)    TEXT_OF(number)

extern const lar_petsc lar_petsc_table;
__attribute__((visibility("default"))) const lar_petsc lar_petsc_table = {
    .version = LAR_PETSC_VERSION,
    .name = "PETSc " TEXT(PETSC_VERSION_MAJOR) "." TEXT(PETSC_VERSION_MINOR) "." TEXT(
        PETSC_VERSION_SUBMINOR),
    .start = start,
    .solve = solve,
};
