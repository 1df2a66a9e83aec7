#include "study/implicit/linear_solver.h"

#include <dlfcn.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "study/implicit/petsc_shim.h"

struct lar_linear_solver {
    lar_linear_options options;
    const lar_petsc *petsc; /* NULL: own */
    char name[80];
    int32_t rows;
    double *work; /* [4 * rows], own */
};

lar_linear_options lar_linear_options_default(void) {
    return (lar_linear_options){.method = "own", .tolerance = 1e-8, .iterations_max = 20000};
}

/* ---- the module of PETSc -------------------------------------------------------------------- */

/* "folder of the command/inner/liblariat-petsc.so" */
static bool beside(const char *command, const char *inner, char path[PATH_MAX]) {
    const char *slash = strrchr(command, '/');
    if (!slash) return false;
    int length = snprintf(path, PATH_MAX, "%.*s/%sliblariat-petsc.so", (int)(slash - command),
                          command, inner);
    return length < PATH_MAX && access(path, R_OK) == 0;
}

/* Beside the command, where it is installed, or in the build folder above its tests. */
static bool find_module(char path[PATH_MAX]) {
    char command[PATH_MAX] = "";
    ssize_t length = readlink("/proc/self/exe", command, sizeof command - 1);
    command[length > 0 ? length : 0] = '\0';
    return beside(command, "", path) || beside(command, LAR_PETSC_FROM_BIN "/", path) ||
           beside(command, "../", path);
}

bool lar_linear_solver_petsc(void) {
    char path[PATH_MAX];
    return find_module(path);
}

/* In builds that look for leaks: what MPI leaves behind, PETSc's users cannot release. */
__attribute__((weak)) void __lsan_disable(void);
__attribute__((weak)) void __lsan_enable(void);

/* Symbols global: MPI's plugins look for those of its library. Never unloaded. */
static lar_status load_module(const lar_petsc **petsc, lar_error *error) {
    char path[PATH_MAX];
    if (!find_module(path))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "the module liblariat-petsc.so is not there; install petsc-dev and build "
                        "Lariat again, or take the solver own");
    void *module = dlopen(path, RTLD_NOW | RTLD_GLOBAL);
    if (!module)
        return lar_fail(error, LAR_ERROR_IO,
                        "the module for PETSc cannot be loaded: %s; install petsc-dev and build "
                        "Lariat again, or take the solver own",
                        dlerror());
    const lar_petsc *table = dlsym(module, LAR_PETSC_SYMBOL);
    if (!table || table->version != LAR_PETSC_VERSION)
        return lar_fail(error, LAR_ERROR_IO,
                        "%s belongs to another version of Lariat; build and install both together",
                        path);
    int code = table->start();
    if (code)
        return lar_fail(error, LAR_ERROR_IO,
                        "%s does not start (its error %d); take the solver own", table->name, code);
    *petsc = table;
    return LAR_OK;
}

static lar_status load(const lar_petsc **petsc, lar_error *error) {
    if (__lsan_disable) __lsan_disable();
    lar_status status = load_module(petsc, error);
    if (__lsan_enable) __lsan_enable();
    return status;
}

lar_status lar_linear_solver_open(const lar_linear_options *options, lar_linear_solver **solver,
                                  lar_error *error) {
    const lar_petsc *petsc = NULL;
    bool own = strcmp(options->method, "own") == 0;
    lar_status status = own ? LAR_OK : load(&petsc, error);
    if (status) return status;
    lar_linear_solver *made = lar_calloc(1, sizeof *made);
    if (!made) return lar_fail_memory(error, sizeof *made, "a linear solver");
    made->options = *options;
    made->petsc = petsc;
    if (own)
        snprintf(made->name, sizeof made->name, "own cg + jacobi");
    else
        snprintf(made->name, sizeof made->name, "%s %s + %s", petsc->name, options->method,
                 options->preconditioner);
    *solver = made;
    return LAR_OK;
}

void lar_linear_solver_close(lar_linear_solver *solver) {
    if (!solver) return;
    free(solver->work);
    free(solver);
}

const char *lar_linear_solver_name(const lar_linear_solver *solver) {
    return solver->name;
}

/* ---- own ------------------------------------------------------------------------------------ */

static double dot(int32_t n, const double *a, const double *b) {
    double sum = 0;
    for (int32_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

static void give_up(lar_linear_result *result, const char *reason) {
    snprintf(result->reason, sizeof result->reason, "%s", reason);
}

/* Conjugate gradients (Hestenes and Stiefel 1952) with the diagonal as preconditioner. Stops where
 * a direction shows that the matrix is not positive definite. */
static void conjugate_gradients(const lar_linear_options *o, const lar_sparse *A, const double *b,
                                double *x, double *work, lar_linear_result *result) {
    int32_t n = A->rows;
    double *r = work, *p = work + n, *Ap = work + 2 * (size_t)n, *inverse = work + 3 * (size_t)n;
    for (int32_t i = 0; i < n; i++) {
        double diagonal = *lar_sparse_at(A, i, i);
        if (!(diagonal > 0)) {
            give_up(result,
                    "the matrix is not positive definite: a diagonal value is not positive");
            return;
        }
        inverse[i] = 1 / diagonal;
        r[i] = b[i];
        p[i] = inverse[i] * b[i];
    }
    double norm = sqrt(dot(n, b, b)), rz = dot(n, r, p);
    for (; result->iterations < o->iterations_max; result->iterations++) {
        result->residual = norm > 0 ? sqrt(dot(n, r, r)) / norm : 0;
        result->solved = result->residual <= o->tolerance;
        if (result->solved) return;
        lar_sparse_multiply(A, p, Ap);
        double curvature = dot(n, p, Ap);
        if (!(curvature > 0)) {
            give_up(result, "the matrix is not positive definite");
            return;
        }
        double step = rz / curvature, before = rz;
        for (int32_t i = 0; i < n; i++) {
            x[i] += step * p[i];
            r[i] -= step * Ap[i];
        }
        rz = 0;
        for (int32_t i = 0; i < n; i++) rz += r[i] * r[i] * inverse[i];
        for (int32_t i = 0; i < n; i++) p[i] = inverse[i] * r[i] + rz / before * p[i];
    }
    give_up(result, "too many iterations");
}

lar_status lar_linear_solve(lar_linear_solver *s, const lar_sparse *A, const double *b, double *x,
                            lar_linear_result *result, lar_error *error) {
    *result = (lar_linear_result){0};
    memset(x, 0, (size_t)A->rows * sizeof *x);
    if (s->petsc) {
        int code = s->petsc->solve(&s->options, A, b, x, result);
        return code ? lar_fail(error, LAR_ERROR_UNSUPPORTED,
                               "%s fails with its error %d; take another preconditioner", s->name,
                               code)
                    : LAR_OK;
    }
    if (s->rows < A->rows) {
        free(s->work);
        s->rows = 0;
        s->work = lar_calloc(4 * (size_t)A->rows, sizeof *s->work);
        if (!s->work) return lar_fail_memory(error, 32 * (size_t)A->rows, "a linear solver");
        s->rows = A->rows;
    }
    conjugate_gradients(&s->options, A, b, x, s->work, result);
    return LAR_OK;
}
