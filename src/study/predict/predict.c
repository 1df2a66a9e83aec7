#include "study/predict/predict.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "parallel/division.h"
#include "model/model.h"
#include "study/bench/kernel.h"

const char *const lar_predict_scheme_name[LAR_PREDICT_SCHEMES] = {"all", "local sequential",
                                                                  "local concurrent", "one", "two"};

/* ---- a model -------------------------------------------------------------------------------- */

static lar_status find_time_step(const lar_model *model, lar_prediction *p, lar_error *error) {
    lar_model_info info;
    lar_status status = lar_model_inspect(model, &info, error);
    if (status) return status;
    p->elements = info.elements;
    p->nodes = info.nodes;
    p->time_step = isfinite(info.time_step) && info.time_step > 0 ? info.time_step : 0;
    return LAR_OK;
}

lar_status lar_predict_model(const lar_model *model, const lar_options *options,
                             const lar_cluster *machine, int32_t steps, lar_prediction *out,
                             lar_error *error) {
    lar_prediction made = {0};
    lar_division division = {0};
    lar_status status = find_time_step(model, &made, error);
    if (!status) status = lar_division_create(model, options, &division, error);
    if (status) return status;
    const lar_network_options simulated = {
        .machine = machine, .schedules = &division.schedules, .steps = steps, .record = true};
    status = lar_network_simulate(&simulated, &made.network, error);
    lar_division_destroy(&division);
    if (status) return status;
    made.alone = lar_cluster_alone(machine, made.elements, made.nodes);
    made.speed_up = made.alone / made.network.step;
    made.efficiency = made.speed_up / (made.network.processors * made.network.threads);
    made.real_time_factor = made.time_step / made.network.step;
    *out = made;
    return LAR_OK;
}

void lar_prediction_clear(lar_prediction *prediction) {
    lar_network_clear(&prediction->network);
}

/* ---- blocks --------------------------------------------------------------------------------- */

void lar_predict_grid(int32_t processors, int32_t grid[3]) {
    double best = INFINITY;
    for (int32_t x = 1; x <= processors; x++)
        for (int32_t y = x; processors % x == 0 && y <= processors / x; y++) {
            int32_t z = processors / x / y;
            if (x * y * z != processors || z < y) continue;
            double surface = (double)x * y + (double)y * z + (double)x * z;
            if (surface >= best) continue;
            best = surface;
            grid[0] = x;
            grid[1] = y;
            grid[2] = z;
        }
}

/* Schedules of blocks for as many processors as there are kinds of them (network.h). */
typedef struct blocks {
    int32_t grid[3], edge[3];
    lar_division division;
} blocks;

static lar_status divide_blocks(const int32_t edge[3], const int32_t grid[3], int scheme,
                                int32_t threads, blocks *out, lar_error *error) {
    static const char *const names[LAR_PREDICT_SCHEMES] = {"all", "local", "local", "one", "two"};
    char text[LAR_GRID_TEXT];
    int32_t body[3];
    lar_grid kinds;
    lar_model *model = NULL;
    *out = (blocks){0};
    for (int i = 0; i < 3; i++) {
        out->grid[i] = grid[i];
        out->edge[i] = edge[i];
        kinds.edge[i] = grid[i] < 3 ? grid[i] : 3;
        body[i] = kinds.edge[i] * edge[i];
    }
    lar_grid_format(&kinds, text);
    lar_options options = lar_options_default();
    options.grid = text;
    options.scheme = names[scheme];
    options.channels = scheme == 2 ? "concurrent" : NULL;
    options.threads = threads > 0 ? threads : 1;
    lar_status status = lar_bench_block(body, false, &model, error);
    if (!status) status = lar_division_create(model, &options, &out->division, error);
    lar_model_destroy(model);
    return status;
}

/* Elements and nodes of the whole body, which may be larger than any model. */
static double alone_time(const blocks *b, const lar_cluster *machine) {
    double elements = 1, nodes = 1;
    for (int i = 0; i < 3; i++) {
        elements *= (double)b->grid[i] * b->edge[i];
        nodes *= (double)b->grid[i] * b->edge[i] + 1;
    }
    return lar_cluster_alone(machine, elements, nodes);
}

static lar_status simulate_blocks(const blocks *b, const lar_cluster *machine, int32_t steps,
                                  lar_block_prediction *out, lar_error *error) {
    lar_network_result r = {0};
    lar_network_options options = {.machine = machine,
                                   .schedules = &b->division.schedules,
                                   .steps = steps,
                                   .grid = {b->grid[0], b->grid[1], b->grid[2]}};
    lar_status status = lar_network_simulate(&options, &r, error);
    if (status) return status;
    *out = (lar_block_prediction){.step = r.step,
                                  .occupation = r.occupation,
                                  .steps = r.steps,
                                  .fastest = r.fastest,
                                  .slowest = r.slowest,
                                  .settled = r.settled};
    out->alone = alone_time(b, machine) / r.processors / r.threads;
    out->efficiency = out->alone / r.step;
    for (int i = 0; i < 3; i++) {
        out->grid[i] = b->grid[i];
        out->edge[i] = b->edge[i];
    }
    for (int32_t p = 0; p < r.processors; p++) {
        if (r.of[p].bytes_sent > out->bytes_max) out->bytes_max = r.of[p].bytes_sent;
        if (r.of[p].packets > out->packets_max) out->packets_max = r.of[p].packets;
    }
    lar_network_clear(&r);
    return LAR_OK;
}

static lar_status check_block(const lar_block_options *o, lar_error *error) {
    if (o->elements < 1 || o->elements > LAR_PREDICT_BLOCK_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%d elements per processor; 1 to %d can be predicted", (int)o->elements,
                        LAR_PREDICT_BLOCK_MAX);
    if (o->processors < 1 || o->processors > LAR_NETWORK_PROCESSORS_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%d processors; 1 to %d can be predicted",
                        (int)o->processors, LAR_NETWORK_PROCESSORS_MAX);
    if (o->scheme < 0 || o->scheme >= LAR_PREDICT_SCHEMES)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "scheme number %d; there are 0 to %d", o->scheme,
                        LAR_PREDICT_SCHEMES - 1);
    return LAR_OK;
}

lar_status lar_predict_block(const lar_block_options *options, const lar_cluster *machine,
                             lar_block_prediction *out, lar_error *error) {
    int32_t edge[3], grid[3];
    blocks b = {0};
    lar_status status = check_block(options, error);
    if (status) return status;
    lar_bench_edges(options->elements, edge);
    lar_predict_grid(options->processors, grid);
    status = divide_blocks(edge, grid, options->scheme, options->threads, &b, error);
    if (!status) status = simulate_blocks(&b, machine, options->steps, out, error);
    lar_division_destroy(&b.division);
    return status;
}

/* ---- critical sub-domain -------------------------------------------------------------------- */

static int32_t next_edge(int32_t edge) {
    return edge < 12 ? edge + 1 : edge + edge / 8;
}

/* One size for all machines that have no answer yet. first[]: the size that had the efficiency,
 * when the last one tried did. Returns how many still have none. */
static lar_status try_edge(const lar_critical_options *o, int scheme, int32_t edge, int32_t *first,
                           lar_critical *out, int32_t *left, lar_error *error) {
    const int32_t cube[3] = {edge, edge, edge};
    int32_t grid[3];
    blocks b = {0};
    lar_predict_grid(o->processors, grid);
    lar_status status = divide_blocks(cube, grid, scheme, o->threads, &b, error);
    *left = 0;
    for (int32_t m = 0; m < o->machines && !status; m++) {
        lar_block_prediction p;
        if (out[m].elements[scheme]) continue;
        status = simulate_blocks(&b, &o->machine[m], o->steps, &p, error);
        if (status) break;
        out[m].unsettled[scheme] |= !p.settled && p.alone / p.slowest < o->efficiency &&
                                    p.alone / p.fastest >= o->efficiency;
        if (p.efficiency < o->efficiency) {
            first[m] = 0;
            out[m].efficiency[scheme] = p.efficiency;
        } else if (!first[m]) {
            first[m] = edge * edge * edge;
            out[m].efficiency[scheme] = p.efficiency;
        } else {
            out[m].elements[scheme] = first[m];
        }
        *left += !out[m].elements[scheme];
    }
    lar_division_destroy(&b.division);
    return status;
}

lar_status lar_predict_critical(const lar_critical_options *o, lar_critical *out,
                                lar_error *error) {
    int32_t *first = lar_calloc((size_t)o->machines, sizeof *first);
    if (!first) return lar_fail_memory(error, 4 * (size_t)o->machines, "machines");
    lar_status status = LAR_OK;
    for (int32_t m = 0; m < o->machines; m++) out[m] = (lar_critical){0};
    for (int scheme = 0; scheme < LAR_PREDICT_SCHEMES && !status; scheme++) {
        int32_t left = o->machines;
        for (int32_t m = 0; m < o->machines; m++) first[m] = 0;
        for (int32_t edge = 1; edge <= o->edge_max && left > 0 && !status; edge = next_edge(edge)) {
            if (o->tell) o->tell(o->context, scheme, edge);
            status = try_edge(o, scheme, edge, first, out, &left, error);
        }
        /* Of the largest block no larger one can be asked. */
        for (int32_t m = 0; m < o->machines && !status; m++)
            if (!out[m].elements[scheme]) out[m].elements[scheme] = first[m];
    }
    free(first);
    return status;
}
