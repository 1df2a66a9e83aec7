#include "study/requirements/requirements.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "divide/distribution.h"
#include "divide/schedule/schedule.h"
#include "layout/layout.h"
#include "mechanics/hex8_full.h"
#include "mechanics/hex8_matrix.h"
#include "model/demo/demo.h"
#include "study/bench/kernel.h"
#include "study/real_time.h"

/* Which node of which element: the demonstration organ's (demo.h). */
static const uint64_t DEMONSTRATION = 0x8931f41fa32444edULL;

_Static_assert(LAR_REQUIREMENTS_SCHEMES == (int)LAR_SCHEMES, "there is a place for each scheme");
_Static_assert(LAR_REQUIREMENTS_SHAPES == (int)LAR_SHAPE_COUNT, "there is a place for each shape");

static void tell(const lar_requirements_options *options, const char *what) {
    if (options->progress) options->progress(options->context, what);
}

/* ---- counted from the mesh ---------------------------------------------------------------- */

/* Pairs of nodes that an element joins, each node with itself too: a third of the values that are
 * not zero in the rows that the node has in the assembled matrix. seen[nodes] is scratch. */
static int64_t count_pairs(const lar_mesh *mesh, const lar_incidence *incidence, int32_t *seen) {
    int64_t pairs = 0;
    for (int32_t k = 0; k < mesh->node_count; k++) seen[k] = -1;
    for (int32_t k = 0; k < mesh->node_count; k++)
        for (int64_t i = incidence->first[k]; i < incidence->first[k + 1]; i++)
            for (int a = 0; a < 8; a++) {
                int32_t other = mesh->element[incidence->element[i]][a];
                pairs += seen[other] != k;
                seen[other] = k;
            }
    return pairs;
}

static lar_status count_mesh(const lar_mesh *mesh, const lar_incidence *incidence,
                             lar_quantities *q, lar_error *error) {
    size_t nodes = (size_t)mesh->node_count;
    int32_t *seen = lar_calloc(nodes, sizeof *seen);
    if (!seen) return lar_fail_memory(error, nodes * sizeof *seen, "marks of nodes");
    q->n_el = mesh->element_count;
    q->n_k = mesh->node_count;
    q->n_eav = (double)incidence->first[mesh->node_count] / mesh->node_count;
    q->df_el = 24;
    q->df_eav = 3 * (double)count_pairs(mesh, incidence, seen) / mesh->node_count;
    free(seen);
    return LAR_OK;
}

/* ---- what is sent --------------------------------------------------------------------------- */

static lar_status count_transfers(const lar_schedule_set *set, lar_requirements_sent *sent,
                                  lar_error *error) {
    size_t capacity = 0;
    for (int32_t p = 0; p < set->count; p++) {
        const lar_schedule *s = &set->of[p];
        int64_t bytes = 0;
        for (int32_t b = 0; b < s->batch_count; b++)
            for (int32_t i = 0; i < s->batch[b].sends.count; i++) {
                const lar_transfer *t = &s->transfer[s->batch[b].sends.first + i];
                const lar_requirements_packet packet = {
                    p, t->peer, lar_packet_payload(t->vectors.count) + LAR_TAIL_BYTES};
                if (!LAR_GROW(sent->packet, capacity, (size_t)sent->packets))
                    return lar_fail_memory(error, 2 * capacity * sizeof packet, "the packets");
                sent->packet[sent->packets++] = packet;
                sent->vectors += t->vectors.count;
                sent->empty += t->vectors.count == 0;
                bytes += packet.bytes;
            }
        sent->bytes += bytes;
        if (bytes > sent->bytes_max) sent->bytes_max = bytes;
    }
    return LAR_OK;
}

static lar_status count_sent(const lar_mesh *mesh, const lar_incidence *incidence,
                             const lar_distribution *distribution,
                             const lar_requirements_options *wanted, lar_requirements *r,
                             lar_error *error) {
    tell(wanted, "schedules");
    for (int i = 0; i < LAR_SCHEMES; i++) {
        lar_schedule_options options = lar_schedule_options_default();
        lar_schedule_set set = {0};
        options.scheme = (lar_scheme)i;
        lar_status status =
            lar_schedule_build(mesh, incidence, distribution, &options, &set, error);
        if (status) return status;
        r->sent[i] = (lar_requirements_sent){.scheme = lar_scheme_name[i]};
        status = count_transfers(&set, &r->sent[i], error);
        lar_schedule_set_clear(&set);
        if (status) return status;
    }
    return LAR_OK;
}

static lar_status distribute(const lar_model *model, const lar_requirements_options *options,
                             lar_distribution *out, lar_error *error) {
    enum { THESIS_PROCESSORS = 12 };
    lar_grid grid;
    bool small = model->mesh.element_count < THESIS_PROCESSORS;
    const char *asked = options->grid ? options->grid : small ? "1x1x1" : "3x2x2";
    lar_status status = lar_grid_parse(asked, &grid, error);
    if (status) return status;
    if (!options->distribution) return lar_distribution_cut(&model->mesh, &grid, out, error);
    status = lar_distribution_read(options->distribution, &model->mesh, out, error);
    if (!status && options->grid && memcmp(&out->grid, &grid, sizeof grid) != 0) {
        char has[LAR_GRID_TEXT];
        lar_grid_format(&out->grid, has);
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "%s: the file is for the grid %s, not for %s; leave --grid out or give "
                          "another file",
                          options->distribution, has, options->grid);
    }
    return status;
}

static lar_status max_elements(const lar_distribution *distribution, int32_t *max,
                               lar_error *error) {
    size_t processors = (size_t)distribution->grid.count;
    int32_t *load = lar_calloc(processors, sizeof *load);
    if (!load) return lar_fail_memory(error, processors * sizeof *load, "loads");
    lar_distribution_load(distribution, load);
    *max = 0;
    for (size_t p = 0; p < processors; p++)
        if (load[p] > *max) *max = load[p];
    free(load);
    return LAR_OK;
}

static lar_status count_division(const lar_model *model, const lar_requirements_options *options,
                                 lar_requirements *r, lar_error *error) {
    const lar_mesh *mesh = &model->mesh;
    lar_incidence incidence = {0};
    lar_distribution distribution = {0};
    lar_sharing sharing = {0};
    lar_status status = lar_incidence_build(mesh, &incidence, error);
    if (!status) status = count_mesh(mesh, &incidence, &r->quantities, error);
    if (!status) status = distribute(model, options, &distribution, error);
    if (!status) status = max_elements(&distribution, &r->elements_max, error);
    if (!status) status = lar_sharing_build(&incidence, &distribution, &sharing, error);
    if (!status) {
        memcpy(r->grid, distribution.grid.edge, sizeof r->grid);
        r->quantities.n_p = distribution.grid.count;
        r->quantities.n_pav = lar_sharing_mean(&sharing);
        status = count_sent(mesh, &incidence, &distribution, options, r, error);
    }
    lar_sharing_clear(&sharing);
    lar_distribution_clear(&distribution);
    lar_incidence_clear(&incidence);
    return status;
}

/* ---- what our kernels do -------------------------------------------------------------------- */

static void add_elements(lar_requirements_kernel *k, lar_kernel_kind kind, int law,
                         double elements) {
    lar_operations o = lar_operations_of_element(kind, law);
    lar_step_bytes bytes = lar_bytes_of_element(kind, law);
    k->floating += elements * (double)lar_operations_floating(&o);
    k->operations += elements * (double)lar_operations_all(&o);
    k->bytes += elements * (double)(bytes.read + bytes.written);
}

static void add_nodes(lar_requirements_kernel *k, double nodes) {
    lar_operations o = lar_operations_of_node();
    lar_step_bytes bytes = lar_bytes_of_node();
    k->floating += nodes * (double)lar_operations_floating(&o);
    k->operations += nodes * (double)lar_operations_all(&o);
    k->bytes += nodes * (double)(bytes.read + bytes.written);
}

/* The production element: by the shapes and laws that the layout has found. */
static lar_status count_hex8(const lar_model *model, lar_requirements *r, lar_error *error) {
    lar_layout layout;
    lar_status status = lar_layout_create(model, &layout, error);
    if (status) return status;
    int64_t elements[LAR_SHAPE_COUNT][LAR_LAW_COUNT] = {{0}}, lanes[LAR_SHAPE_COUNT] = {0};
    for (int32_t b = 0; b < layout.block_count; b++) {
        const lar_lanes *block = &layout.block[b];
        lanes[block->shape] += LAR_BLOCK;
        for (int i = 0; i < LAR_BLOCK; i++)
            elements[block->shape][block->law] += block->element[i] >= 0;
    }
    lar_layout_destroy(&layout);
    for (int s = 0; s < LAR_SHAPE_COUNT; s++) {
        lar_kernel_kind kind = s == LAR_SHAPE_BOX ? LAR_KERNEL_HEX8_BOX : LAR_KERNEL_HEX8;
        if (lanes[s] == 0) continue;
        lar_requirements_shape *shape = &r->shape[r->shape_count++];
        *shape = (lar_requirements_shape){.kind = kind, .lanes = lanes[s]};
        for (int law = 0; law < LAR_LAW_COUNT; law++) {
            if (elements[s][law] == 0) continue;
            add_elements(&r->kernel[LAR_NEEDS_HEX8], kind, law, (double)elements[s][law]);
            shape->elements += elements[s][law];
        }
    }
    return LAR_OK;
}

static lar_status count_kernels(const lar_model *model, lar_requirements *r, lar_error *error) {
    if (lar_model_viscous(model))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: operations of viscous materials are not counted yet; take a model "
                        "without them",
                        lar_model_source(model), lar_model_viscous(model)->viscosity.line);
    if (lar_model_fibrous(model))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: operations of fibres are not counted yet; take a model without "
                        "them",
                        lar_model_source(model), lar_model_fibrous(model)->fibre.line);
    lar_status status = count_hex8(model, r, error);
    if (status) return status;
    int64_t elements[LAR_LAW_COUNT] = {0};
    for (lar_gid e = 0; e < model->mesh.element_count; e++)
        elements[lar_model_material_of(model, e)->law]++;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        if (elements[law] == 0) continue;
        add_elements(&r->kernel[LAR_NEEDS_FULL], LAR_KERNEL_FULL, law, (double)elements[law]);
        add_elements(&r->kernel[LAR_NEEDS_MATRIX], LAR_KERNEL_MATRIX, law, (double)elements[law]);
    }
    for (int k = 0; k < LAR_NEEDS; k++) add_nodes(&r->kernel[k], model->mesh.node_count);
    r->kernel[LAR_NEEDS_HEX8].name = "hex8";
    r->kernel[LAR_NEEDS_FULL].name = "hex8-full";
    r->kernel[LAR_NEEDS_MATRIX].name = "hex8-matrix";
    return LAR_OK;
}

/* ---- measured ------------------------------------------------------------------------------- */

typedef double element_force(const double corner[8][3], const lar_material *material,
                             const double u[8][3], double force[8][3]);

/* The result goes here, so that no compiler leaves the loop out. */
static volatile double force_sink;

/* Seconds for `count` elements of the model, from element `first` on. */
static double time_elements(const lar_model *model, element_force *recover, int64_t first,
                            int64_t count) {
    double total = 0, begin = lar_clock_seconds();
    for (int64_t i = first; i < first + count; i++) {
        lar_gid e = (lar_gid)(i % model->mesh.element_count);
        double corner[8][3], u[8][3], force[8][3];
        lar_mesh_corners(&model->mesh, e, corner);
        for (int a = 0; a < 8; a++)
            for (int k = 0; k < 3; k++) u[a][k] = 0.001 * (corner[a][(k + 1) % 3] - corner[0][k]);
        total += recover((const double(*)[3])corner, lar_model_material_of(model, e),
                         (const double(*)[3])u, force) +
                 force[0][0];
    }
    force_sink = total;
    return lar_clock_seconds() - begin;
}

/* Seconds for all elements of the model: the median of short samples, after one that warms. */
static double time_slow_kind(const lar_model *model, element_force *recover) {
    enum { SAMPLES = 9, ELEMENTS = 200 };
    double sample[SAMPLES];
    time_elements(model, recover, 0, ELEMENTS);
    for (int i = 0; i < SAMPLES; i++)
        sample[i] = time_elements(model, recover, (int64_t)(i + 1) * ELEMENTS, ELEMENTS);
    return lar_spread_of(sample, SAMPLES).median / ELEMENTS * model->mesh.element_count;
}

/* A measurement that cannot be made leaves its reason. */
static void measure(const lar_model *model, lar_requirements *r) {
    enum { BLOCK_MAX = 1000000, SAMPLES = 5 };
    static const double SECONDS = 0.15;
    int32_t elements = model->mesh.element_count;
    lar_bench_kernel_options block = {.elements = elements < BLOCK_MAX ? elements : BLOCK_MAX,
                                      .general = true,
                                      .repeat = SAMPLES};
    lar_bench_kernel_result bench;
    lar_real_time step;
    lar_error *error = &r->why_not;
    if (lar_real_time_measure(model, SECONDS, &step, error)) return;
    if (lar_bench_kernel(&block, &bench, error)) return;
    r->isa = bench.isa;
    r->peak_gflops = bench.peak_gflops.median;
    r->nanoseconds = bench.nanoseconds.median;
    r->kernel[LAR_NEEDS_HEX8].seconds = step.step;
    r->kernel[LAR_NEEDS_FULL].seconds = time_slow_kind(model, lar_hex8_full_force);
    r->kernel[LAR_NEEDS_MATRIX].seconds = time_slow_kind(model, lar_hex8_matrix_force);
    r->measured = true;
}

void lar_requirements_clear(lar_requirements *requirements) {
    for (int i = 0; i < LAR_REQUIREMENTS_SCHEMES; i++) {
        free(requirements->sent[i].packet);
        requirements->sent[i].packet = NULL;
    }
}

lar_status lar_requirements_of(const lar_model *model, const lar_requirements_options *options,
                               lar_requirements *out, lar_error *error) {
    lar_requirements made = {.quantities = lar_thesis_quantities()};
    lar_model_info info;
    tell(options, "the mesh");
    lar_status status = lar_model_inspect(model, &info, error);
    if (!status) status = count_division(model, options, &made, error);
    if (!status) tell(options, "kernels");
    if (!status) status = count_kernels(model, &made, error);
    if (status) {
        lar_requirements_clear(&made);
        return status;
    }
    if (options->iterations > 0) made.quantities.n_it = options->iterations;
    if (options->implicit_step > 0) made.quantities.step_im = options->implicit_step;
    made.quantities.step_ex = info.time_step;
    made.demonstration = model->mesh.element_count == LAR_DEMO_ELEMENTS &&
                         lar_mesh_fingerprint(&model->mesh) == DEMONSTRATION;
    if (options->measure) {
        tell(options, "steps on this machine");
        measure(model, &made);
    }
    *out = made;
    return LAR_OK;
}
