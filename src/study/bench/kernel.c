#include "study/bench/kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "simulation/simulation.h"
#include "model/model.h"
#include "study/bench/fma_peak.h"

/* ---- the block -------------------------------------------------------------------------- */

static const double SIDE = 0.005;  /* of an element [m] */
static const double JITTER = 0.12; /* of a side; scaled Jacobians stay above 0.3 */

static int64_t ratio_of(const int32_t edge[3]) {
    int32_t min = edge[0], max = edge[0];
    for (int i = 1; i < 3; i++) {
        min = edge[i] < min ? edge[i] : min;
        max = edge[i] > max ? edge[i] : max;
    }
    return (int64_t)max * 1000 / min;
}

/* The better of two divisions: nearer to the wanted number, then nearer to a cube. */
static bool is_better(const int32_t edge[3], const int32_t best[3], int32_t wanted) {
    int64_t off = llabs((int64_t)edge[0] * edge[1] * edge[2] - wanted);
    int64_t best_off = llabs((int64_t)best[0] * best[1] * best[2] - wanted);
    return off != best_off ? off < best_off : ratio_of(edge) < ratio_of(best);
}

void lar_bench_edges(int32_t elements, int32_t edge[3]) {
    int32_t side = (int32_t)lround(cbrt(elements));
    int32_t cube = side > 0 ? side : 1;
    int32_t best[3] = {cube, cube, cube};
    /* x >= y >= z; z lies below the cube root, y below the root of the rest. */
    for (int32_t z = cube / 3 > 0 ? cube / 3 : 1; z <= cube + 1; z++)
        for (int32_t y = z; (int64_t)y * y * z <= elements + (int64_t)y * z; y++) {
            int32_t x = (int32_t)llround((double)elements / ((double)y * z));
            const int32_t tried[3] = {x, y, z};
            if (x < 1) continue;
            bool exact = (int64_t)x * y * z == elements;
            if (ratio_of(tried) <= (exact ? 3000 : 2000) && is_better(tried, best, elements))
                memcpy(best, tried, sizeof best);
        }
    memcpy(edge, best, sizeof best);
}

/* -1..1 from a fixed sequence: the same block on every machine. */
static double next_random(uint64_t *state) {
    *state = *state * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(int32_t)(*state >> 32) * 0x1p-31;
}

static lar_status fill_mesh(lar_mesh *mesh, const int32_t edge[3], bool general, lar_error *error) {
    const int32_t along_x = edge[0] + 1, along_y = edge[1] + 1;
    mesh->node_count = along_x * along_y * (edge[2] + 1);
    mesh->element_count = edge[0] * edge[1] * edge[2];
    lar_status status = lar_mesh_allocate(mesh, "block", (size_t)mesh->node_count,
                                          (size_t)mesh->element_count, error);
    if (status) return status;
    uint64_t random = 1;
    for (int32_t n = 0; n < mesh->node_count; n++) {
        const int32_t at[3] = {n % along_x, n / along_x % along_y, n / along_x / along_y};
        mesh->node_id[n] = n;
        for (int i = 0; i < 3; i++)
            mesh->position[n][i] = SIDE * (at[i] + (general ? JITTER * next_random(&random) : 0));
    }
    for (int32_t e = 0; e < mesh->element_count; e++) {
        const int32_t at[3] = {e % edge[0], e / edge[0] % edge[1], e / edge[0] / edge[1]};
        mesh->element_id[e] = e;
        for (int a = 0; a < 8; a++) {
            int32_t corner[3];
            for (int i = 0; i < 3; i++) corner[i] = at[i] + (lar_node_sign[a][i] > 0);
            mesh->element[e][a] = corner[0] + along_x * (corner[1] + along_y * corner[2]);
        }
    }
    return lar_mesh_check(mesh, error);
}

lar_material lar_bench_material(void) {
    lar_material material = {.law = LAR_LAW_neo_hookean, .density = 1050};
    lar_material_from_shear_bulk(&material, 1.5e3, 3e5);
    return material;
}

/* Two families, 74 degrees apart; models take what their materials have. */
static lar_status lay_fibres(lar_mesh *mesh, lar_error *error) {
    size_t elements = (size_t)mesh->element_count;
    mesh->fibre = lar_calloc(elements, sizeof *mesh->fibre);
    mesh->second = lar_calloc(elements, sizeof *mesh->second);
    if (!mesh->fibre || !mesh->second) return lar_fail_memory(error, 48 * elements, "the block");
    for (size_t e = 0; e < elements; e++) {
        mesh->fibre[e][0] = mesh->second[e][0] = 0.8;
        mesh->fibre[e][2] = 0.6;
        mesh->second[e][2] = -0.6;
    }
    return LAR_OK;
}

lar_status lar_bench_block_of(const int32_t edge[3], bool general, const lar_material *material,
                              lar_model **model, lar_error *error) {
    lar_model *made = lar_model_create();
    if (!made) return lar_fail_memory(error, sizeof *made, "the block");
    lar_status status = fill_mesh(&made->mesh, edge, general, error);
    if (!status && lar_fibre_here(&material->fibre)) status = lay_fibres(&made->mesh, error);
    if (!status) {
        lar_material *own = LAR_MODEL_APPEND(made, material);
        made->element_material = lar_calloc((size_t)made->mesh.element_count, sizeof(int32_t));
        made->title = lar_strdup("Block");
        made->source = lar_strdup("block");
        made->damping = 1;
        if (!own || !made->element_material || !made->title || !made->source)
            status = lar_fail_memory(error, 4 * (size_t)made->mesh.element_count, "the block");
        else
            *own = *material;
    }
    if (!status) status = lar_model_check(made, error);
    if (status)
        lar_model_destroy(made);
    else
        *model = made;
    return status;
}

lar_status lar_bench_block(const int32_t edge[3], bool general, lar_model **model,
                           lar_error *error) {
    const lar_material material = lar_bench_material();
    return lar_bench_block_of(edge, general, &material, model, error);
}

/* ---- measuring -------------------------------------------------------------------------- */

/* A smooth motion, one wave over the block, of a hundredth of an element. */
static void set_in_motion(lar_simulation *simulation) {
    const lar_domain *domain = &simulation->domain;
    const lar_mesh *mesh = &domain->model->mesh;
    const double *end = mesh->position[mesh->node_count - 1];
    for (lar_gid g = 0; g < mesh->node_count; g++) {
        const double *place = mesh->position[g];
        lar_lid n = domain->layout.local[g];
        for (int i = 0; i < 3; i++) {
            double phase = acos(-1) * place[(i + 1) % 3] / (end[(i + 1) % 3] + SIDE);
            size_t at = lar_state_at(&simulation->state, n, i);
            simulation->state.u[at] = 0.01 * SIDE * cos(phase);
            simulation->state.v[at] = 0.1 * SIDE * sin(phase);
        }
    }
}

double lar_bench_time(lar_simulation *simulation, uint64_t steps, lar_status *status,
                      lar_error *error) {
    double begin = lar_clock_seconds();
    *status = lar_simulation_advance(simulation, steps, error);
    return lar_clock_seconds() - begin;
}

/* The result of the peak's loop goes here, so that no compiler leaves the loop out. */
static volatile double peak_result;

static double time_peak(const lar_fma_peak *peak, uint64_t rounds) {
    double begin = lar_clock_seconds();
    peak_result = peak->run(rounds);
    return lar_clock_seconds() - begin;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Of sorted samples: the first with so many per cent of all at or below it. */
static double percentile(const double *sample, int count, int percent) {
    return sample[(count * percent + 99) / 100 - 1];
}

lar_spread lar_spread_of(double *sample, int count) {
    qsort(sample, (size_t)count, sizeof *sample, compare);
    return (lar_spread){.min = sample[0],
                        .p25 = percentile(sample, count, 25),
                        .median = 0.5 * (sample[(count - 1) / 2] + sample[count / 2]),
                        .p75 = percentile(sample, count, 75),
                        .p95 = percentile(sample, count, 95),
                        .max = sample[count - 1]};
}

/* What else runs takes the core away for milliseconds: the median of shorter sections does not see
 * it while most of them are spared. */
enum { SECTIONS = 20 };

/* Nanoseconds of a step. */
static double sample_steps(lar_simulation *simulation, uint64_t steps, lar_status *status,
                           lar_error *error) {
    double section[SECTIONS] = {0};
    int count = steps < SECTIONS ? (int)steps : SECTIONS;
    uint64_t each = steps / (uint64_t)count;
    *status = LAR_OK;
    for (int i = 0; i < count && !*status; i++)
        section[i] = 1e9 * lar_bench_time(simulation, each, status, error) / (double)each;
    return lar_spread_of(section, count).median;
}

/* Gflop/s. */
static double sample_peak(const lar_fma_peak *peak, uint64_t rounds) {
    double section[SECTIONS];
    uint64_t each = rounds / SECTIONS + 1;
    for (int i = 0; i < SECTIONS; i++)
        section[i] = 1e-9 * (double)each * peak->operations / time_peak(peak, each);
    return lar_spread_of(section, SECTIONS).median;
}

/* Repetitions that take about `wanted` seconds; doubles until the clock can see them. The fastest
 * of a few tries counts: in the others the core may have been taken away. */
static lar_status calibrate(lar_simulation *simulation, const lar_fma_peak *peak, double wanted,
                            uint64_t *steps, uint64_t *rounds, lar_error *error) {
    enum { TRIES = 5 };
    lar_status status = LAR_OK;
    double took = 0;
    for (*steps = 1; !status && took <= 0.25 * wanted; *steps *= 2) {
        took = INFINITY;
        for (int i = 0; i < TRIES && !status && took > 0.25 * wanted; i++)
            took = fmin(took, lar_bench_time(simulation, *steps, &status, error));
    }
    *steps = (uint64_t)fmax(1, 0.5 * (double)*steps * wanted / took);
    for (*rounds = 256, took = 0; !status && took <= 0.25 * wanted; *rounds *= 2) {
        took = INFINITY;
        for (int i = 0; i < TRIES && took > 0.25 * wanted; i++)
            took = fmin(took, time_peak(peak, *rounds));
    }
    *rounds = (uint64_t)fmax(1, 0.5 * (double)*rounds * wanted / took);
    return status;
}

static lar_status measure(lar_simulation *simulation, const lar_fma_peak *peak,
                          lar_bench_kernel_result *result, lar_error *error) {
    static const double SAMPLE = 0.02; /* [s] */
    double step_sample[LAR_BENCH_REPEAT_MAX], peak_sample[LAR_BENCH_REPEAT_MAX];
    uint64_t rounds = 0;
    lar_status status = calibrate(simulation, peak, SAMPLE, &result->steps, &rounds, error);
    if (result->steps > SECTIONS) result->steps -= result->steps % SECTIONS;
    for (int i = 0; i < result->repeat && !status; i++) {
        step_sample[i] = sample_steps(simulation, result->steps, &status, error) / result->elements;
        peak_sample[i] = sample_peak(peak, rounds);
    }
    if (status) return status;
    result->nanoseconds = lar_spread_of(step_sample, result->repeat);
    result->peak_gflops = lar_spread_of(peak_sample, result->repeat);
    result->fraction_of_peak =
        LAR_BENCH_OPERATIONS / result->nanoseconds.median / result->peak_gflops.median;
    return LAR_OK;
}

/* The environment chooses how blocks are kept; what stood there stands there again. */
static lar_status create(const lar_model *model, const lar_options *options, const char *blocks,
                         lar_simulation **simulation, lar_error *error) {
    const char *stood = getenv("LARIAT_BLOCKS");
    char *before = stood ? lar_strdup(stood) : NULL;
    if (stood && !before) return lar_fail_memory(error, strlen(stood), "the block");
    if (blocks) setenv("LARIAT_BLOCKS", blocks, 1);
    lar_status status = lar_simulation_create(model, options, simulation, error);
    if (before)
        setenv("LARIAT_BLOCKS", before, 1);
    else
        unsetenv("LARIAT_BLOCKS");
    free(before);
    return status;
}

lar_status lar_bench_start(const lar_model *model, const lar_bench_kernel_options *options,
                           lar_simulation **simulation, lar_error *error) {
    lar_options simulation_options = lar_options_default();
    simulation_options.isa = options->isa;
    lar_status status = create(model, &simulation_options, options->blocks, simulation, error);
    if (!status) set_in_motion(*simulation);
    return status;
}

static lar_status bench_model(const lar_model *model, const lar_bench_kernel_options *options,
                              lar_bench_kernel_result *result, lar_error *error) {
    lar_simulation *simulation = NULL;
    lar_model_info info;
    lar_status status = lar_model_inspect(model, &info, error);
    if (!status) status = lar_bench_start(model, options, &simulation, error);
    if (status) return status;
    result->lean = simulation->domain.lean;
    result->elements = info.elements;
    result->nodes = info.nodes;
    result->scaled_jacobian_min = info.scaled_jacobian_min;
    result->bytes_per_element = (double)lar_simulation_bytes(simulation) / info.elements;
    result->isa = lar_simulation_isa(simulation);
    const lar_fma_peak *peak = lar_fma_peak_find(result->isa);
    if (peak)
        status = measure(simulation, peak, result, error);
    else
        status = lar_fail(error, LAR_ERROR_UNSUPPORTED,
                          "this build has no peak measurement for %s; choose another --isa",
                          result->isa);
    lar_simulation_destroy(simulation);
    return status;
}

lar_status lar_bench_check(const lar_bench_kernel_options *options, lar_error *error) {
    enum { MAX_ELEMENTS = 20000000 };
    if (options->elements < 1 || options->elements > MAX_ELEMENTS || options->repeat < 1 ||
        options->repeat > LAR_BENCH_REPEAT_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a benchmark needs 1 to %d elements and 1 to %d samples", MAX_ELEMENTS,
                        LAR_BENCH_REPEAT_MAX);
    return LAR_OK;
}

lar_status lar_bench_kernel(const lar_bench_kernel_options *options,
                            lar_bench_kernel_result *result, lar_error *error) {
    lar_status status = lar_bench_check(options, error);
    if (status) return status;
    lar_bench_kernel_result made = {.repeat = options->repeat};
    lar_model *model = NULL;
    lar_bench_edges(options->elements, made.edge);
    status = lar_bench_block(made.edge, options->general, &model, error);
    if (!status) status = bench_model(model, options, &made, error);
    lar_model_destroy(model);
    if (!status) *result = made;
    return status;
}
