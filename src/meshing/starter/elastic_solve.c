#include <stdlib.h>
#include <string.h>

#include "base/parallel_for.h"
#include "meshing/starter/elastic_coarse.h"

enum { STEPS_MAX = 400, STEPS_LAST = 10 };

/* Two of the loads; all but numbers: [nodes], `way` as lar_coarse_add has it. */
typedef struct search {
    lar_pair_vectors *u, *r, *z, *p, *Kp;
    lar_pair *way;
    lar_pair rz, work;
    lar_pair gain[STEPS_LAST]; /* what the last steps have added to the work */
} search;

struct lar_elastic_solver {
    const lar_elastic *elastic;
    lar_coarse coarse;
    double (*inverse)[3]; /* [nodes] of the diagonal; 0 where still */
    search search[LAR_PAIRS];
    int steps;
    lar_status status;
    lar_error *error;
};

static lar_pair product(int32_t nodes, const lar_pair_vectors *a, const lar_pair_vectors *b) {
    lar_pair sum = {0};
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) sum += a[n][i] * b[n][i];
    return sum;
}

/* z from r, and r . z. */
static lar_pair precondition(const lar_elastic_solver *solver, const search *s) {
    const int32_t nodes = solver->elastic->node_count;
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) s->z[n][i] = solver->inverse[n][i] * s->r[n][i];
    lar_coarse_add(&solver->coarse, s->way, (const lar_pair_vectors *)s->r, s->z);
    return product(nodes, (const lar_pair_vectors *)s->r, (const lar_pair_vectors *)s->z);
}

static void turn(const search *s, int32_t nodes, lar_pair beta) {
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) s->p[n][i] = s->z[n][i] + beta * s->p[n][i];
}

/* a / b, 0 where b is not above it. */
static lar_pair ratio(lar_pair a, lar_pair b) {
    for (int l = 0; l < 2; l++) a[l] = b[l] > 0 ? a[l] / b[l] : 0;
    return a;
}

static void step(const lar_elastic_solver *solver, search *s) {
    const int32_t nodes = solver->elastic->node_count;
    lar_elastic_forces(solver->elastic, (const lar_pair_vectors *)s->p, s->Kp);
    const lar_pair pKp =
        product(nodes, (const lar_pair_vectors *)s->p, (const lar_pair_vectors *)s->Kp);
    const lar_pair alpha = ratio(s->rz, pKp), gain = alpha * s->rz;
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) {
            s->u[n][i] += alpha * s->p[n][i];
            s->r[n][i] -= alpha * s->Kp[n][i];
        }
    const lar_pair rz = precondition(solver, s);
    turn(s, nodes, ratio(rz, s->rz));
    s->rz = rz;
    s->work += gain;
    s->gain[solver->steps % STEPS_LAST] = gain;
}

static void step_some(void *context, int32_t first, int32_t end) {
    lar_elastic_solver *solver = context;
    for (int32_t k = first; k < end; k++) step(solver, &solver->search[k]);
}

/* Whether the last steps have added less than a hundredth to every load's work. */
static bool done(const lar_elastic_solver *solver) {
    static const double LITTLE = 0.01;
    if (solver->steps < STEPS_LAST) return false;
    for (int k = 0; k < LAR_PAIRS; k++) {
        const search *s = &solver->search[k];
        lar_pair last = {0};
        for (int i = 0; i < STEPS_LAST; i++) last += s->gain[i];
        for (int l = 0; l < 2; l++)
            if (last[l] > LITTLE * s->work[l]) return false;
    }
    return true;
}

/* ---- what is needed ------------------------------------------------------------------------- */

/* Two that need nothing from each other. */
static void prepare(void *context, int32_t first, int32_t end) {
    lar_elastic_solver *solver = context;
    for (int32_t part = first; part < end; part++) {
        if (part == 0)
            solver->status = lar_coarse_create(solver->elastic, &solver->coarse, solver->error);
        if (part == 1) lar_elastic_diagonal(solver->elastic, solver->inverse);
    }
}

static bool create_search(search *s, size_t nodes, size_t groups) {
    s->u = lar_calloc(nodes, sizeof *s->u);
    s->r = lar_calloc(nodes, sizeof *s->r);
    s->z = lar_calloc(nodes, sizeof *s->z);
    s->p = lar_calloc(nodes, sizeof *s->p);
    s->Kp = lar_calloc(nodes, sizeof *s->Kp);
    s->way = lar_calloc(groups + 1, LAR_RIGID * sizeof *s->way);
    return s->u && s->r && s->z && s->p && s->Kp && s->way;
}

static lar_status create(lar_elastic_solver *solver, lar_error *error) {
    const size_t nodes = (size_t)solver->elastic->node_count;
    solver->inverse = lar_calloc(nodes, sizeof *solver->inverse);
    bool ready = solver->inverse != NULL;
    if (ready) lar_parallel_for(2, 1, prepare, solver);
    if (solver->status) return solver->status;
    for (int k = 0; ready && k < LAR_PAIRS; k++)
        ready = create_search(&solver->search[k], nodes, (size_t)solver->coarse.group_count);
    if (!ready)
        return lar_fail_memory(error,
                               nodes * (sizeof *solver->inverse + 10 * sizeof(lar_pair_vectors)),
                               "conjugate gradients");
    for (size_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++)
            solver->inverse[n][i] = solver->inverse[n][i] > 0 ? 1 / solver->inverse[n][i] : 0;
    return LAR_OK;
}

lar_status lar_elastic_solver_create(const lar_elastic *elastic, lar_elastic_solver **solver,
                                     lar_error *error) {
    lar_elastic_solver *made = lar_calloc(1, sizeof *made);
    if (!made) return lar_fail_memory(error, sizeof *made, "conjugate gradients");
    made->elastic = elastic;
    made->error = error;
    const lar_status status = create(made, error);
    if (status)
        lar_elastic_solver_destroy(made);
    else
        *solver = made;
    return status;
}

void lar_elastic_solver_destroy(lar_elastic_solver *solver) {
    if (!solver) return;
    for (int k = 0; k < LAR_PAIRS; k++) {
        search *s = &solver->search[k];
        void *const owned[] = {s->u, s->r, s->z, s->p, s->Kp, s->way};
        for (size_t i = 0; i < sizeof owned / sizeof *owned; i++) free(owned[i]);
    }
    lar_coarse_clear(&solver->coarse);
    free(solver->inverse);
    free(solver);
}

/* ---- solving -------------------------------------------------------------------------------- */

/* What r has where nothing moves does no work: z is 0 there. */
static void begin(lar_elastic_solver *solver, const lar_load_vectors *f) {
    const int32_t nodes = solver->elastic->node_count;
    solver->steps = 0;
    for (int k = 0; k < LAR_PAIRS; k++) {
        search *s = &solver->search[k];
        memset(s->u, 0, (size_t)nodes * sizeof *s->u);
        memset(s->p, 0, (size_t)nodes * sizeof *s->p);
        for (int32_t n = 0; n < nodes; n++)
            for (int i = 0; i < 3; i++) s->r[n][i] = (lar_pair){f[n][i][2 * k], f[n][i][2 * k + 1]};
        s->work = (lar_pair){0};
        s->rz = precondition(solver, s);
        turn(s, nodes, s->work);
    }
}

lar_status lar_elastic_solve(lar_elastic_solver *solver, const lar_load_vectors *f,
                             lar_load_vectors *u, double work[LAR_LOADS], lar_error *error) {
    const lar_elastic *elastic = solver->elastic;
    begin(solver, f);
    for (; solver->steps < STEPS_MAX && !done(solver); solver->steps++) {
        lar_parallel_for(LAR_PAIRS, 1, step_some, solver);
        if (elastic->goes_on && !elastic->goes_on(elastic->asker))
            return lar_fail(error, LAR_ERROR_ARGUMENT, "stopped as asked, while measuring");
    }
    LAR_EACH_LOAD {
        const search *s = &solver->search[l / 2];
        work[l] = s->work[l % 2];
        for (int32_t n = 0; n < elastic->node_count; n++)
            for (int i = 0; i < 3; i++) u[n][i][l] = s->u[n][i][l % 2];
    }
    return LAR_OK;
}
