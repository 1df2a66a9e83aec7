#include "step/domain.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/vector.h"
#include "contact/tool_body.h"
#include "mechanics/hex8_full.h"
#include "mechanics/hex8_guard.h"
#include "step/activation.h"
#include "step/mass/compressible.h"
#include "step/mass_scaling.h"
#include "step/materials.h"
#include "step/viscous_history.h"

/* Steps that fit into ticks of the host's clock: the longest that are not longer. */
static lar_status fit_tick(lar_domain *domain, double tick, bool may_shorten, lar_error *error) {
    static const double ROUNDING = 1e-9;
    if (tick == 0) return LAR_OK;
    if (!(tick >= LAR_STEP_MIN) || !isfinite(tick))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s: a tick must be 1e-15 s at least, or 0 for none",
                        lar_model_source(domain->model));
    double steps = fmax(1, ceil(tick / domain->time_step * (1 - ROUNDING)));
    if (may_shorten) domain->time_step = tick / steps;
    if (fabs(steps * domain->time_step - tick) <= ROUNDING * tick) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "%s: steps of %g s do not make a tick of %g s; use time_step: auto, or %.9g s",
                    lar_model_source(domain->model), domain->time_step, tick, tick / steps);
}

static lar_status choose_step(lar_domain *domain, const lar_options *options, lar_error *error) {
    const lar_model *model = domain->model;
    size_t elements = (size_t)model->mesh.element_count;
    domain->rate = lar_calloc(elements, sizeof *domain->rate);
    if (!domain->rate)
        return lar_fail_memory(error, elements * sizeof *domain->rate, "the elements");
    lar_step_bound bound;
    lar_status status = lar_step_bound_find(model, domain->kind, domain->rate, &bound, error);
    if (!status) status = lar_mass_scaling_check(model, domain->rate, &bound, error);
    if (status) return status;
    domain->stable_step = bound.step;
    domain->stable_worst = bound.worst;
    domain->adds = bound.step > bound.without;
    memcpy(domain->fastest, bound.fastest, sizeof domain->fastest);
    char line[LAR_LINE_TEXT];
    double wanted = options->time_step != 0 ? options->time_step : model->time_step;
    if (wanted == 0) {
        domain->time_step = lar_auto_step(model, domain->stable_step);
        return fit_tick(domain, options->tick, true, error);
    }
    if (!(wanted >= LAR_STEP_MIN) || !isfinite(wanted))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s: the time step must be 1e-15 s at least, or auto",
                        lar_model_source(model));
    if (wanted > domain->stable_step)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s%s: time step %g s is above the stable step %.4g s (set by element "
                        "%lld); use time_step: auto, a smaller step, larger or softer elements",
                        lar_model_source(model),
                        lar_line_text(options->time_step != 0 ? 0 : model->time_step_line, line),
                        wanted, domain->stable_step,
                        (long long)model->mesh.element_id[domain->stable_worst]);
    domain->time_step = wanted;
    return fit_tick(domain, options->tick, false, error);
}

static lar_status list_spares(lar_domain *domain, lar_error *error) {
    const lar_layout *layout = &domain->layout;
    domain->spare = lar_calloc((size_t)layout->node_padded, sizeof *domain->spare);
    if (!domain->spare)
        return lar_fail_memory(error, (size_t)layout->node_padded * 4, "the spare nodes");
    for (lar_lid n = 0; n < layout->node_padded; n++)
        if (layout->global[n] < 0) domain->spare[domain->spare_count++] = n;
    return LAR_OK;
}

/* Lean rows know their lines only. */
static void put_node(const lar_block_run *run, void *block, int a, int lane, lar_lid node) {
    if (!run->rest)
        ((lar_block_head *)block)->node[a][lane] = node;
    else if (run->rows == LAR_ROWS_NONE)
        ((lar_loose_block *)block)->node[a][lane] = node;
    else if (lane % 4 == 0 && (a == 0 || a == 3 || a == 4 || a == 7))
        ((lar_lean_block *)block)->line[a / 2][lane / 4] = node;
}

/* `memory`: the block; `whole`: where the gradients and shapes of a general one go. */
static void fill_lane(const lar_domain *domain, const lar_block_run *run, void *memory,
                      lar_hex8_block *whole, int lane, lar_gid e, double *steepest,
                      lar_lane_base *base) {
    lar_block_shape shape = run->shape;
    const lar_mesh *mesh = &domain->model->mesh;
    const lar_gid *node = domain->layout.corner[e];
    double corner[8][3];
    lar_hex8 hex8;
    for (int a = 0; a < 8; a++) memcpy(corner[a], mesh->position[node[a]], sizeof corner[a]);
    lar_hex8_prepare((const double(*)[3])corner, lar_model_material_of(domain->model, e), &hex8);
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
        for (int i = 0; i < 3; i++) {
            *steepest = fmax(*steepest, fabs(hex8.gradient[m][i]));
            if (shape == LAR_SHAPE_GENERAL)
                whole->gradient[m][i][lane] = hex8.gradient[m][i];
            else if (m < 3 && i == (m + run->turn) % 3)
                ((lar_box_block *)memory)->gradient[m][lane] = hex8.gradient[m][i];
        }
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
        for (int i = 0; shape == LAR_SHAPE_GENERAL && i < 3; i++)
            whole->shape[m][i][lane] = hex8.shape[m][i];
    if (run->rest) ((lar_lean_block *)memory)->volume[lane] = hex8.volume;
    for (int a = 0; a < 8; a++) put_node(run, memory, a, lane, domain->layout.local[node[a]]);
    base->volume = hex8.volume;
    memcpy(base->stiffness, hex8.stiffness, sizeof base->stiffness);
    base->limit =
        lar_hex8_corner_limit(&hex8, (const double(*)[3])corner) * domain->scale * domain->scale;
    base->largest = lar_hex8_largest_corner((const double(*)[3])corner);
    base->areas = lar_hex8_areas((const double(*)[3])corner);
    base->corner = lar_layout_turn(&domain->layout, mesh, e);
    double limit = lar_hex8_area_limit(&hex8);
    bool compressible = lar_material_compressible(lar_model_material_of(domain->model, e));
    domain->area_limit[base - domain->base] = compressible ? lar_compressible_limit(limit) : limit;
}

/* How many bytes of blocks caches hold, beside nodes and other programs: of the second level, from
 * where on they are asked for, and of the third, from where on they are lean. A twelfth of what the
 * system says that there is, for a server's cores share it. Where it says nothing, 12 MiB. Decides
 * about time only. */
enum { SECOND_LEVEL_BYTES = 1 << 20, THIRD_LEVEL_MIN = 12 << 20, THIRD_LEVEL_MAX = 40 << 20 };

/* Linux says what the first core shares; the C library adds up all caches of some processors. */
static size_t third_level_bytes(void) {
    long bytes = 0;
    FILE *said = fopen("/sys/devices/system/cpu/cpu0/cache/index3/size", "re");
    if (said) {
        char unit = 0;
        if (fscanf(said, "%ld%c", &bytes, &unit) == 2 && unit == 'K') bytes *= 1024;
        fclose(said);
    }
#ifdef _SC_LEVEL3_CACHE_SIZE
    if (bytes <= 0) bytes = sysconf(_SC_LEVEL3_CACHE_SIZE);
#endif
    bytes /= 12;
    return bytes < THIRD_LEVEL_MIN   ? THIRD_LEVEL_MIN
           : bytes > THIRD_LEVEL_MAX ? THIRD_LEVEL_MAX
                                     : (size_t)bytes;
}

/* Many lines asked for cost less than blocks made anew. But several processors that read so much
 * may wait for each other, and models that fill the memory shall still fit into it. */
static bool stays_whole(const lar_domain *domain, bool alone) {
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    return alone && pages > 0 && page > 0 &&
           domain->block_bytes <= (size_t)pages / 8 * (size_t)page && lar_kernels_ask_many();
}

/* LARIAT_BLOCKS chooses for measurements and tests: the result is the same to the bit. */
static lar_status choose_blocks(lar_domain *domain, bool alone, lar_error *error) {
    const char *wanted = getenv("LARIAT_BLOCKS");
    if (!wanted || !*wanted || strcmp(wanted, "auto") == 0)
        domain->lean = domain->block_bytes > third_level_bytes() && !stays_whole(domain, alone);
    else if (strcmp(wanted, "lean") == 0 || strcmp(wanted, "whole") == 0)
        domain->lean = *wanted == 'l';
    else
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "LARIAT_BLOCKS is '%.40s'; it must be auto, lean or whole", wanted);
    return LAR_OK;
}

static bool same_run(const lar_lanes *a, const lar_lanes *b) {
    return a->thread == b->thread && a->batch == b->batch && a->law == b->law &&
           a->shape == b->shape && a->turn == b->turn && a->rows == b->rows &&
           a->viscous == b->viscous && a->fibrous == b->fibrous;
}

/* The runs of equal blocks, of at most so many, and the memory they need. */
static lar_status list_runs(lar_domain *domain, int32_t max, lar_error *error) {
    const lar_layout *layout = &domain->layout;
    int32_t runs = 0;
    for (int32_t b = 0, length = 0; b < layout->block_count; b++) {
        bool begins =
            b == 0 || length == max || !same_run(&layout->block[b - 1], &layout->block[b]);
        runs += begins;
        length = begins ? 1 : length + 1;
    }
    domain->run = lar_calloc((size_t)runs, sizeof *domain->run);
    domain->run_first = lar_calloc((size_t)runs, sizeof *domain->run_first);
    if (!domain->run || !domain->run_first)
        return lar_fail_memory(error, (size_t)runs * sizeof *domain->run, "the runs of elements");
    for (int32_t b = 0; b < layout->block_count; b++) {
        const lar_lanes *lanes = &layout->block[b];
        if (b == 0 || domain->run[domain->run_count - 1].count == max ||
            !same_run(lanes - 1, lanes)) {
            domain->run_first[domain->run_count] = b;
            domain->run[domain->run_count++] = (lar_block_run){.law = lanes->law,
                                                               .shape = lanes->shape,
                                                               .rows = lanes->rows,
                                                               .turn = lanes->turn,
                                                               .axis_stride = layout->axis_stride,
                                                               .viscous = lanes->viscous,
                                                               .fibrous = lanes->fibrous};
        }
        domain->run[domain->run_count - 1].count++;
        domain->block_bytes += lar_block_size(lanes->shape);
        if (lar_law_has_more(lanes->law))
            domain->more_bytes = (size_t)layout->block_count * sizeof *domain->more;
    }
    return LAR_OK;
}

static lar_status allocate_blocks(lar_domain *domain, lar_error *error) {
    domain->blocks = lar_calloc_aligned(domain->block_bytes, 1);
    if (domain->more_bytes) domain->more = lar_calloc_aligned(domain->more_bytes, 1);
    size_t elements = LAR_BLOCK * (size_t)domain->layout.block_count;
    domain->corner_limit = lar_calloc_aligned(elements, sizeof *domain->corner_limit);
    domain->area_limit = lar_calloc_aligned(elements, sizeof *domain->area_limit);
    domain->base = lar_calloc(elements, sizeof *domain->base);
    domain->rest = lar_calloc_aligned(3 * domain->layout.axis_stride, sizeof *domain->rest);
    if (!domain->blocks || (domain->more_bytes && !domain->more) || !lar_beside_plan(domain) ||
        !domain->base || !domain->corner_limit || !domain->area_limit || !domain->rest)
        return lar_fail_memory(error, domain->block_bytes, "the elements");
    for (lar_lid n = 0; n < domain->layout.node_padded; n++)
        if (domain->layout.global[n] >= 0)
            lar_axes_put(domain->rest, domain->layout.axis_stride, n,
                         domain->model->mesh.position[domain->layout.global[n]]);
    return LAR_OK;
}

/* Whether a lean block makes what it should, to the bit. */
static bool same_numbers(const lar_domain *domain, const lar_block_run *run, int32_t b,
                         const lar_lanes *lanes, const lar_hex8_block *wanted) {
    lar_hex8_block made;
    domain->kernels->expand(run, b, &made);
    for (int lane = 0; lane < LAR_BLOCK; lane++)
        for (int i = 0; i < 3 && lanes->element[lane] >= 0; i++) {
            for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
                if (made.gradient[m][i][lane] != wanted->gradient[m][i][lane]) return false;
            for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
                if (made.shape[m][i][lane] != wanted->shape[m][i][lane]) return false;
        }
    return true;
}

/* False where a lean block would not be what a whole one is. */
static bool fill_block(lar_domain *domain, int32_t r, int32_t b, void *memory, double *steepest) {
    const lar_block_run *run = &domain->run[r];
    int32_t at = domain->run_first[r] + b;
    const lar_lanes *lanes = &domain->layout.block[at];
    double *limit = domain->corner_limit + LAR_BLOCK * at;
    lar_hex8_block scratch, *whole = run->rest ? &scratch : memory;
    for (int lane = 0; lane < LAR_BLOCK; lane++) {
        lar_gid e = lanes->element[lane];
        limit[lane] = domain->area_limit[LAR_BLOCK * at + lane] = INFINITY;
        if (e >= 0) {
            lar_lane_base *base = domain->base + LAR_BLOCK * at + lane;
            fill_lane(domain, run, memory, whole, lane, e, steepest, base);
            lar_materials_fill(domain, r, b, memory, lane);
            continue;
        }
        if (run->rest) {
            ((lar_lean_block *)memory)->volume[lane] = LAR_LEAN_NOTHING;
            ((lar_lean_block *)memory)->material[lane] = domain->model->material_count;
        }
        for (int a = 0; a < 8; a++) put_node(run, memory, a, lane, domain->layout.node_padded);
    }
    return !run->rest || same_numbers(domain, run, b, lanes, whole);
}

/* Where no element is flat or compressible nobody looks. */
static void keep_area_limits(lar_domain *domain) {
    for (int32_t i = 0; i < LAR_BLOCK * domain->layout.block_count; i++)
        if (domain->area_limit[i] < LAR_STRAINED_AREA) return;
    free(domain->area_limit);
    domain->area_limit = NULL;
}

/* Of blocks and nodes, u, v, f and mass, some part always stays in the third level; many lines of a
 * model that it holds nearly all of are asked for in vain. */
static int asked_lines(const lar_domain *domain) {
    enum { HELD_BYTES = 9 << 20, NODE_BYTES = 80 };
    size_t nodes = NODE_BYTES * (size_t)domain->layout.node_padded, blocks = domain->block_bytes;
    if (blocks <= SECOND_LEVEL_BYTES) return LAR_ASK_NOTHING;
    return blocks + nodes > HELD_BYTES && lar_kernels_ask_many() ? LAR_ASK_MANY : LAR_ASK_FEW;
}

static bool fill_blocks(lar_domain *domain) {
    char *memory = domain->blocks;
    double steepest = 0;
    bool same = true;
    int asks = asked_lines(domain);
    for (int32_t r = 0; r < domain->run_count && same; r++) {
        lar_block_run *run = &domain->run[r];
        run->blocks = memory;
        if (lar_law_has_more(run->law)) run->more = domain->more + domain->run_first[r];
        if (run->viscous) run->relaxing = domain->relaxing + domain->run_first[r];
        run->asks = asks;
        for (int32_t b = 0; b < run->count && same; b++) {
            same = fill_block(domain, r, b, memory, &steepest);
            memory += lar_run_stride(run);
        }
    }
    /* Modal forces S B stay below 2^54 units for |S| below this, hourglass forces below 2^54 too:
     * a node with hundreds of elements cannot overflow 63 bits. */
    double stress = 0x1p54 / (3 * steepest);
    domain->limits = (lar_hex8_limits){
        .min_volume = 0.01, .stress_square = stress * stress, .hourglass_square = 0x1p54 * 0x1p54};
    if (same) keep_area_limits(domain);
    return same;
}

/* Should a lean block not say the same as a whole one, to the bit, there are none. */
static lar_status build_blocks(lar_domain *domain, bool alone, lar_error *error) {
    lar_status status = choose_blocks(domain, alone, error);
    size_t whole = domain->block_bytes;
    for (int32_t r = 0; r < domain->run_count && domain->lean; r++) {
        lar_block_run *run = &domain->run[r];
        if (run->shape != LAR_SHAPE_GENERAL) continue;
        size_t kept = run->rows == LAR_ROWS_NONE ? sizeof(lar_loose_block) : sizeof(lar_lean_block);
        domain->block_bytes -= (size_t)run->count * (sizeof(lar_hex8_block) - kept);
    }
    size_t blocks = domain->block_bytes, rows = (size_t)domain->model->material_count + 1;
    if (domain->lean) domain->block_bytes += rows * sizeof *domain->lean_parameters;
    if (!status) status = allocate_blocks(domain, error);
    if (status) return status;
    if (domain->lean) domain->lean_parameters = (void *)((char *)domain->blocks + blocks);
    for (int32_t r = 0; r < domain->run_count && domain->lean; r++) {
        if (domain->run[r].shape != LAR_SHAPE_GENERAL) continue;
        domain->run[r].rest = domain->rest;
        domain->run[r].parameters = domain->lean_parameters;
    }
    if (fill_blocks(domain)) return LAR_OK;
    free(domain->blocks);
    domain->lean = false;
    domain->lean_parameters = NULL;
    domain->block_bytes = whole;
    for (int32_t r = 0; r < domain->run_count; r++) domain->run[r].rest = NULL;
    domain->blocks = lar_calloc_aligned(whole, 1);
    if (!domain->blocks) return lar_fail_memory(error, whole, "the elements");
    fill_blocks(domain);
    return LAR_OK;
}

/* A cube counts for no more than 0.58 of its edge, a slab for what it is. */
static double thinnest_of(const lar_domain *domain) {
    double least = INFINITY;
    for (int32_t r = 0; r < domain->run_count; r++)
        for (size_t i = 0; i < LAR_BLOCK * (size_t)domain->run[r].count; i++) {
            size_t place = LAR_BLOCK * (size_t)domain->run_first[r] + i;
            const lar_lane_base *base = &domain->base[place];
            if (domain->layout.block[place / LAR_BLOCK].element[place % LAR_BLOCK] >= 0)
                least = fmin(least, base->volume / sqrt(2 * base->areas));
        }
    return least;
}

void lar_domain_element(const lar_domain *domain, int32_t r, int32_t b, int lane, lar_hex8 *hex8) {
    const lar_block_run *run = &domain->run[r];
    const lar_lane_base *base = domain->base + LAR_BLOCK * b + lane;
    const void *block = lar_run_block(run, b - domain->run_first[r]);
    const lar_hex8_block *general = block;
    lar_hex8_block made;
    if (run->rest) {
        domain->kernels->expand(run, b - domain->run_first[r], &made);
        general = &made;
    }
    const lar_box_block *box = block;
    *hex8 = (lar_hex8){.volume = base->volume};
    lar_model_fibres(domain->model, domain->layout.block[b].element[lane], hex8->fibre);
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
        hex8->stiffness[m] = general->head.stiffness[m][lane] / domain->scale;
    if (run->shape == LAR_SHAPE_BOX) {
        for (int m = 0; m < 3; m++) hex8->gradient[m][(m + run->turn) % 3] = box->gradient[m][lane];
        return;
    }
    for (int i = 0; i < 3; i++) {
        for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
            hex8->gradient[m][i] = general->gradient[m][i][lane];
        for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) hex8->shape[m][i] = general->shape[m][i][lane];
    }
}

static lar_status allocate_masses(lar_domain *domain, lar_error *error) {
    size_t nodes = (size_t)domain->layout.node_padded;
    domain->weight = domain->mass = lar_calloc_aligned(nodes, sizeof *domain->mass);
    domain->push = lar_calloc_aligned(nodes, sizeof *domain->push);
    if (domain->adds) domain->added = lar_calloc_aligned(nodes, sizeof *domain->added);
    bool made = domain->mass && domain->push && (!domain->adds || domain->added);
    return made ? LAR_OK : lar_fail_memory(error, 24 * nodes, "the masses");
}

/* After the masses: beside them what they are without what strained elements have more. */
static lar_status create_burden(lar_domain *domain, lar_error *error) {
    size_t nodes = (size_t)domain->layout.node_padded;
    if (!(domain->model->strained_share > 0) || domain->kind != LAR_ELEMENT_HEX8) return LAR_OK;
    domain->burden = lar_burden_create(domain->mass, domain->added, nodes);
    if (domain->burden) domain->burden->most = lar_burden_most(domain->model, domain->rate);
    if (!domain->added) domain->added = lar_calloc_aligned(nodes, sizeof *domain->added);
    if (domain->burden && domain->added) return LAR_OK;
    return lar_fail_memory(error, 24 * nodes, "the masses");
}

static lar_status spread_mass(lar_domain *domain, lar_error *error) {
    lar_status status = allocate_masses(domain, error);
    if (status) return status;
    lar_masses_spread(domain->model, &domain->layout, domain->rate, domain->mass, domain->added);
    return create_burden(domain, error);
}

/* Constants of v' = keep v - push f + drift (docs/theory.md): central differences with damping c,
 *     m (v' - v)/dt + c m (v' + v)/2 = -f + m g. */
static void prepare_motion(lar_domain *domain, int finer) {
    const lar_model *model = domain->model;
    double dt = domain->time_step, half = 0.5 * model->damping * dt;
    double gravity[3], shortest = DBL_MAX;
    lar_gravity_at(model, NULL, 0, 0, gravity);
    domain->leapfrog = (lar_leapfrog){.keep = (1 - half) / (1 + half), .dt = dt, .push = 1};
    for (int i = 0; i < 3; i++) domain->leapfrog.drift[i] = gravity[i] * dt / (1 + half);
    for (int32_t n = 0; n < domain->layout.node_count; n++)
        if (domain->mass[n] > 0) domain->push[n] = lar_domain_push_of(domain, domain->mass[n]);
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(&model->mesh, e, corner);
        shortest = fmin(shortest, cbrt(lar_hexahedron_volume(corner)));
    }
    /* Between two looks of the monitor, no hourglass mode can grow beyond the integers. */
    domain->leapfrog.speed = ldexp(256, -finer) * shortest / dt;
}

/* Where the largest nodal force of the model stands. */
static int line_of_force(const lar_model *model) {
    double most = 0;
    int line = 0;
    for (int i = 0; i < model->load_count; i++) {
        const double *force = model->load[i].force;
        double square = lar_dot(force, force);
        if (!(square > most)) continue;
        most = square;
        line = model->load[i].line;
    }
    return line;
}

bool lar_division_asked(const lar_options *options) {
    return options->grid || options->threads > 1 || options->schedules || options->distribution ||
           options->comm || options->verify;
}

lar_status lar_domain_create(const lar_model *model, const lar_options *options, lar_domain *domain,
                             lar_error *error) {
    return lar_domain_create_styled(model, options, LAR_LAYOUT_ROWS, domain, error);
}

lar_status lar_domain_create_styled(const lar_model *model, const lar_options *options,
                                    lar_layout_style style, lar_domain *domain, lar_error *error) {
    *domain = (lar_domain){.model = model, .kind = options->element};
    lar_status status = lar_kernels_find(options->isa, &domain->kernels, error);
    if (!status) status = lar_fibres_check(domain, error);
    if (!status) status = lar_materials_copy(domain, error);
    if (!status) status = choose_step(domain, options, error);
    domain->interval = LAR_INTERVAL_MAX; /* with tools: lar_interval_length */
    if (!status) status = lar_layout_create_styled(model, style, &domain->layout, error);
    if (!status) status = list_spares(domain, error);
    if (!status) status = spread_mass(domain, error);
    if (!status) status = list_runs(domain, INT32_MAX, error);
    if (!status) {
        domain->room = lar_step_room_of(domain->time_step, domain->stable_step);
        prepare_motion(domain, lar_force_scale_choose(model, &domain->scale));
        status = lar_viscous_plan(domain, error);
        if (!status) status = lar_activation_plan(domain, error);
        if (!status && domain->kind == LAR_ELEMENT_HEX8)
            status = build_blocks(domain, !lar_division_asked(options), error);
        if (!status && domain->kind == LAR_ELEMENT_HEX8) domain->thinnest = thinnest_of(domain);
    }
    if (!status)
        status = lar_conditions_create(model, domain->layout.local, NULL,
                                       &domain->surroundings.conditions, error);
    double largest = status ? 0 : lar_conditions_largest(&domain->surroundings.conditions);
    if (!status && largest * domain->scale > 0x1p58) {
        char line[LAR_LINE_TEXT];
        status =
            lar_fail(error, LAR_ERROR_MODEL,
                     "%s%s: a nodal force of %g N is far beyond what this material can bear; "
                     "check its unit",
                     lar_model_source(model), lar_line_text(line_of_force(model), line), largest);
    }
    if (status) lar_domain_destroy(domain);
    return status;
}

/* Masses and pushes of a part are those of the whole: a node's mass is that of all its elements. */
static lar_status copy_nodes(const lar_domain *whole, const bool *counted, lar_domain *domain,
                             lar_error *error) {
    size_t nodes = (size_t)domain->layout.node_padded;
    lar_status status = allocate_masses(domain, error);
    if (status) return status;
    domain->weight = lar_calloc_aligned(nodes, sizeof *domain->weight);
    if (!domain->weight) return lar_fail_memory(error, 8 * nodes, "the masses");
    for (size_t n = 0; n < nodes; n++) {
        lar_gid g = domain->layout.global[n];
        if (g < 0) continue;
        lar_lid there = whole->layout.local[g];
        domain->mass[n] = whole->mass[there];
        domain->push[n] = whole->push[there];
        if (domain->added) domain->added[n] = whole->added[there];
        if (counted[g]) domain->weight[n] = domain->mass[n];
    }
    return create_burden(domain, error);
}

lar_status lar_domain_create_part(const lar_domain *whole, const lar_part *part,
                                  const bool *counted, int32_t run_max, lar_domain *domain,
                                  lar_error *error) {
    *domain = (lar_domain){.model = whole->model,
                           .kernels = whole->kernels,
                           .kind = whole->kind,
                           .scale = whole->scale,
                           .time_step = whole->time_step,
                           .interval = whole->interval,
                           .rate = whole->rate,
                           .rate_lent = true,
                           .stable_step = whole->stable_step,
                           .room = whole->room,
                           .thinnest = whole->thinnest,
                           .stable_worst = whole->stable_worst,
                           .adds = whole->adds,
                           .leapfrog = whole->leapfrog};
    lar_status status = lar_materials_copy(domain, error);
    if (!status)
        status = lar_layout_create_part(whole->model, &whole->layout, part, &domain->layout, error);
    if (!status) status = list_spares(domain, error);
    if (!status) status = copy_nodes(whole, counted, domain, error);
    if (!status) status = list_runs(domain, run_max, error);
    if (!status) status = lar_viscous_plan(domain, error);
    if (!status) status = lar_activation_plan(domain, error);
    if (!status && domain->kind == LAR_ELEMENT_HEX8) status = build_blocks(domain, false, error);
    domain->limits = whole->limits; /* a run stops for the same reason on any grid */
    if (status) lar_domain_destroy(domain);
    return status;
}

void lar_domain_destroy(lar_domain *domain) {
    lar_surroundings_destroy(&domain->surroundings);
    lar_layout_destroy(&domain->layout);
    free(domain->run);
    free(domain->run_first);
    free(domain->blocks);
    free(domain->more);
    free(domain->fibres);
    free(domain->second);
    free(domain->folds);
    lar_viscous_unplan(domain);
    lar_activation_unplan(domain);
    free(domain->material);
    free(domain->base);
    free(domain->corner_limit);
    free(domain->area_limit);
    free(domain->rest);
    if (!domain->rate_lent) free(domain->rate);
    free(domain->spare);
    lar_burden_destroy(domain->burden);
    if (domain->weight != domain->mass) free(domain->weight);
    free(domain->mass);
    free(domain->added);
    free(domain->push);
    *domain = (lar_domain){0};
}

void lar_domain_corners(const lar_domain *domain, const double *u, lar_gid e, double out[8][3]) {
    const lar_mesh *mesh = &domain->model->mesh;
    for (int a = 0; a < 8; a++)
        lar_axes_get(u, domain->layout.axis_stride, domain->layout.local[mesh->element[e][a]],
                     out[a]);
}
