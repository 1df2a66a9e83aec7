#include "study/implicit/bench_implicit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"

enum { LOOKS = 100 }; /* at the kinetic energy */

static lar_status run_engine(const lar_model *model, lar_bench_implicit_result *r, double (*u)[3],
                             lar_error *error) {
    lar_simulation *simulation;
    lar_status status = lar_simulation_create(model, NULL, &simulation, error);
    if (status) return status;
    r->explicit_step = lar_simulation_time_step(simulation);
    uint64_t end = (uint64_t)ceil(r->until / r->explicit_step);
    for (int k = 1; k <= LOOKS && !status; k++) {
        uint64_t next = end * (uint64_t)k / LOOKS, now = lar_simulation_steps(simulation);
        double start = lar_clock_seconds();
        if (next > now) status = lar_simulation_advance(simulation, next - now, error);
        r->explicit_seconds += lar_clock_seconds() - start;
        lar_energy energy;
        lar_simulation_energy(simulation, &energy);
        r->kinetic_max = fmax(r->kinetic_max, energy.kinetic);
    }
    r->explicit_steps = lar_simulation_steps(simulation);
    r->until = lar_simulation_time(simulation);
    lar_simulation_displacements(simulation, u);
    lar_simulation_destroy(simulation);
    return status;
}

/* That it finds no solution is a result. */
static lar_status run_implicit(const lar_bench_implicit_options *o, lar_linear_solver *solver,
                               lar_bench_implicit_result *r, double (*u)[3], lar_error *error) {
    lar_implicit_options options = o->implicit;
    lar_implicit *implicit;
    lar_error stopped;
    options.solver = solver;
    snprintf(r->solver, sizeof r->solver, "%s", lar_linear_solver_name(solver));
    lar_status status = lar_implicit_create(o->model, &options, &implicit, error);
    if (status) return status;
    double start = lar_clock_seconds();
    status = lar_implicit_advance(implicit, r->until, &stopped);
    r->implicit_seconds = lar_clock_seconds() - start;
    r->rows = lar_implicit_rows(implicit);
    r->values = lar_implicit_values(implicit);
    r->tally = *lar_implicit_count(implicit);
    r->reached = lar_implicit_time(implicit);
    r->failed = status == LAR_ERROR_UNSTABLE;
    if (r->failed) snprintf(r->reason, sizeof r->reason, "%.*s", 500, stopped.message);
    lar_implicit_displacements(implicit, u);
    lar_implicit_destroy(implicit);
    if (status && !r->failed) return lar_fail(error, status, "%s", stopped.message);
    return LAR_OK;
}

static void compare(int32_t nodes, const double (*a)[3], const double (*b)[3],
                    lar_bench_implicit_result *r) {
    double difference = 0;
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) {
            r->largest = fmax(r->largest, fabs(b[n][i]));
            difference = fmax(difference, fabs(a[n][i] - b[n][i]));
        }
    r->apart = r->failed || !(r->largest > 0) ? -1 : difference / r->largest;
}

static lar_status run_both(const lar_bench_implicit_options *o, lar_linear_solver *solver,
                           lar_bench_implicit_result *r, lar_error *error) {
    size_t nodes = (size_t)o->model->mesh.node_count;
    double(*u)[3] = lar_calloc(2 * nodes, sizeof *u);
    if (!u) return lar_fail_memory(error, 2 * nodes * sizeof *u, "displacements");
    lar_status status = run_engine(o->model, r, u, error);
    if (!status) status = run_implicit(o, solver, r, u + nodes, error);
    if (!status) compare((int32_t)nodes, (const double(*)[3])(u + nodes), (const double(*)[3])u, r);
    free(u);
    return status;
}

lar_status lar_bench_implicit(const lar_bench_implicit_options *o,
                              lar_bench_implicit_result *result, lar_error *error) {
    lar_model *model = o->model;
    lar_bench_implicit_result made = {.until = o->until > 0 ? o->until : model->duration};
    lar_linear_solver *solver;
    if (!(made.until > 0))
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s does not say how long it lasts; give a time",
                        lar_model_source(model));
    lar_status status = lar_model_inspect(model, &made.info, error);
    if (!status) status = lar_linear_solver_open(&o->linear, &solver, error);
    if (status) return status;
    int contacts = model->contact_count, tools = model->tool_count;
    made.left_out = contacts + tools;
    model->contact_count = model->tool_count = 0;
    status = run_both(o, solver, &made, error);
    model->contact_count = contacts;
    model->tool_count = tools;
    lar_linear_solver_close(solver);
    if (!status) *result = made;
    return status;
}
