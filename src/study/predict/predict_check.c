#include "study/predict/predict_check.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "study/bench/scaling.h"

static const char *const GRIDS = "1x1x1,2x1x1";

/* The same pace for the whole processor. */
static void set_pace(lar_cluster *m, double factor) {
    m->number[LAR_CLUSTER_ELEMENT] *= factor;
    m->number[LAR_CLUSTER_NODE] *= factor;
    m->source[LAR_CLUSTER_ELEMENT] = "measured: the benchmark's plain loop";
}

static lar_status compare(const lar_model *model, const lar_bench_scaling_result *r,
                          lar_cluster *machine, lar_predict_check *out, lar_error *error) {
    lar_status status = LAR_OK;
    double plain = 1e-6 * r->row[0].microseconds.min;
    set_pace(machine, plain / lar_cluster_alone(machine, r->info.elements, r->info.nodes));
    for (int i = 0; i < LAR_PREDICT_CHECKS && !status; i++) {
        const lar_bench_scaling_row *row = &r->row[i + 1];
        lar_prediction p = {0};
        lar_options options = lar_options_default();
        options.grid = row->grid;
        if (row->missing)
            return lar_fail(error, LAR_ERROR_UNSUPPORTED, "%s by %s: %s", row->grid, row->comm,
                            row->missing);
        memcpy(out->grid[i], row->grid, sizeof row->grid);
        out->measured[i].min = 1e-6 * row->microseconds.min;
        out->measured[i].median = 1e-6 * row->microseconds.median;
        out->measured[i].max = 1e-6 * row->microseconds.max;
        status = lar_predict_model(model, &options, machine, 0, &p, error);
        if (!status) out->predicted[i] = p.network.step;
        lar_prediction_clear(&p);
    }
    return status;
}

lar_status lar_predict_check_here(const lar_model *model, const char *scene, const char *comm,
                                  int repeat, lar_cluster *machine, lar_predict_check *out,
                                  lar_error *error) {
    const lar_bench_scaling_options options = {.model = model,
                                               .processors = "1,2",
                                               .grids = GRIDS,
                                               .comm = comm,
                                               .pin = true,
                                               .repeat = repeat,
                                               .command = "bench scaling",
                                               .argument = {"--", scene}};
    lar_predict_check made = {.comm = comm};
    lar_cluster paced = *machine;
    lar_bench_scaling_result *r = lar_calloc(1, sizeof *r);
    if (!r) return lar_fail_memory(error, sizeof *r, "the benchmark");
    lar_status status = lar_bench_scaling(&options, r, error);
    if (!status && r->rows != LAR_PREDICT_CHECKS + 1)
        status =
            lar_fail(error, LAR_ERROR_UNSUPPORTED,
                     "the prediction is compared by one process only; start it without mpirun");
    if (!status) status = compare(model, r, &paced, &made, error);
    free(r);
    if (!status) {
        *machine = paced;
        *out = made;
    }
    return status;
}
