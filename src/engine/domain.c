#include "engine/domain.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/order.h"
#include "mechanics/hex8_full.h"

static const lar_material *material_of(const lar_model *model, lar_gid e) {
    return &model->material[model->element_material[e]];
}

/* The element's own highest frequency [rad/s]; its hex8 form when asked for. */
static double element_frequency(const lar_model *model, lar_element_kind kind, lar_gid e,
                                lar_hex8 *hex8) {
    double corner[8][3];
    const lar_material *material = material_of(model, e);
    lar_mesh_corners(&model->mesh, e, corner);
    lar_hex8_prepare(corner, material, hex8);
    return kind == LAR_ELEMENT_HEX8 ? lar_hex8_frequency(hex8, material)
                                    : lar_hex8_full_frequency(corner, material);
}

lar_status lar_stable_step(const lar_model *model, lar_element_kind kind, double *step,
                           lar_gid *worst, lar_error *error) {
    double fastest = 0;
    *worst = 0;
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        lar_hex8 hex8;
        double frequency = element_frequency(model, kind, e, &hex8);
        if (!(frequency <= fastest)) {
            fastest = frequency;
            *worst = e;
        }
    }
    if (!(fastest > 0) || !isfinite(fastest))
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: element %lld has no finite frequency; check its shape and material",
                        model->source ? model->source : "model",
                        (long long)model->mesh.element_id[*worst]);
    *step = 2 / fastest;
    return LAR_OK;
}

static lar_status choose_step(lar_domain *domain, const lar_options *options, lar_error *error) {
    const lar_model *model = domain->model;
    lar_status status =
        lar_stable_step(model, domain->kind, &domain->stable_step, &domain->stable_worst, error);
    if (status) return status;
    double wanted = options->time_step != 0 ? options->time_step : model->time_step;
    if (wanted == 0) {
        domain->time_step = LAR_AUTO_STEP * domain->stable_step;
        return LAR_OK;
    }
    if (!(wanted > 0) || !isfinite(wanted))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s: the time step must be a positive number of seconds, or auto",
                        model->source ? model->source : "model");
    if (wanted > domain->stable_step)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: time step %g s is above the stable step %.4g s (set by element "
                        "%lld); use time_step: auto, a smaller step, larger or softer elements",
                        model->source ? model->source : "model", wanted, domain->stable_step,
                        (long long)model->mesh.element_id[domain->stable_worst]);
    domain->time_step = wanted;
    return LAR_OK;
}

/* Local nodes in the order in which the elements first use them. */
static lar_status number_nodes(lar_domain *domain, lar_error *error) {
    const lar_mesh *mesh = &domain->model->mesh;
    size_t count = (size_t)mesh->node_count;
    domain->global = lar_calloc(count, sizeof *domain->global);
    domain->local = lar_calloc(count, sizeof *domain->local);
    if (!domain->global || !domain->local)
        return lar_fail_memory(error, 2 * count * sizeof *domain->local, "the node numbering");
    for (int32_t n = 0; n < mesh->node_count; n++) domain->local[n] = -1;
    for (int32_t i = 0; i < domain->block_count * LAR_BLOCK; i++) {
        lar_gid e = domain->element[i];
        for (int a = 0; e >= 0 && a < 8; a++) {
            lar_gid node = mesh->element[e][a];
            if (domain->local[node] >= 0) continue;
            domain->local[node] = domain->node_count;
            domain->global[domain->node_count++] = node;
        }
    }
    domain->node_padded = (domain->node_count + 2) & ~1; /* one spare at least, even */
    return LAR_OK;
}

/* Fills domain->element and the groups: every law begins a new block. */
static lar_status order_elements(lar_domain *domain, lar_error *error) {
    const lar_model *model = domain->model;
    int32_t count = model->mesh.element_count;
    int32_t lanes = (count / LAR_BLOCK + LAR_LAW_COUNT) * LAR_BLOCK;
    lar_gid *order = lar_calloc((size_t)count, sizeof *order);
    domain->element = lar_calloc((size_t)lanes, sizeof *domain->element);
    lar_status status = order && domain->element
                            ? lar_order_elements(model, order, error)
                            : lar_fail_memory(error, (size_t)lanes * 8, "the element order");
    int32_t lane = 0;
    for (int32_t i = 0; !status && i < count; i++) {
        lar_law law = material_of(model, order[i])->law;
        lar_block_group *last =
            domain->group_count ? &domain->group[domain->group_count - 1] : NULL;
        if (!last || last->law != law) {
            while (lane % LAR_BLOCK) domain->element[lane++] = -1;
            last = &domain->group[domain->group_count++];
            *last = (lar_block_group){law, lane / LAR_BLOCK, 0};
        }
        domain->element[lane++] = order[i];
        last->count = (lane + LAR_BLOCK - 1) / LAR_BLOCK - last->first;
    }
    while (lane % LAR_BLOCK) domain->element[lane++] = -1;
    domain->block_count = lane / LAR_BLOCK;
    domain->element_count = count;
    free(order);
    return status;
}

static void fill_lane(const lar_domain *domain, lar_hex8_block *block, int lane, lar_gid e,
                      double *steepest) {
    const lar_mesh *mesh = &domain->model->mesh;
    const lar_material *material = material_of(domain->model, e);
    double corner[8][3];
    lar_hex8 hex8;
    lar_mesh_corners(mesh, e, corner);
    lar_hex8_prepare(corner, material, &hex8);
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
        for (int i = 0; i < 3; i++) {
            block->gradient[m][i][lane] = hex8.gradient[m][i];
            *steepest = fmax(*steepest, fabs(hex8.gradient[m][i]));
        }
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        for (int i = 0; i < 3; i++) block->shape[m][i][lane] = hex8.shape[m][i];
        block->stiffness[m][lane] = hex8.stiffness[m] * domain->scale;
    }
    for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
        block->modulus[k][lane] = material->parameter[k] * hex8.volume * domain->scale;
    for (int a = 0; a < 8; a++) block->node[a][lane] = 4 * domain->local[mesh->element[e][a]];
}

static lar_status build_blocks(lar_domain *domain, lar_error *error) {
    domain->block = lar_calloc_aligned((size_t)domain->block_count, sizeof *domain->block);
    if (!domain->block)
        return lar_fail_memory(error, (size_t)domain->block_count * sizeof *domain->block,
                               "the elements");
    double steepest = 0;
    for (int32_t i = 0; i < domain->block_count * LAR_BLOCK; i++) {
        lar_hex8_block *block = &domain->block[i / LAR_BLOCK];
        int lane = i % LAR_BLOCK;
        if (domain->element[i] >= 0)
            fill_lane(domain, block, lane, domain->element[i], &steepest);
        else
            for (int a = 0; a < 8; a++) block->node[a][lane] = 4 * domain->node_count;
    }
    /* Modal forces S B stay below 2^54 units for |S| below this, hourglass forces below 2^54 too:
     * a node with hundreds of elements cannot overflow 63 bits. */
    double stress = 0x1p54 / (3 * steepest);
    domain->limits = (lar_hex8_limits){.least_volume = 0.01,
                                       .stress_square = stress * stress,
                                       .hourglass_square = 0x1p54 * 0x1p54};
    return LAR_OK;
}

/* Force units: the characteristic force, (K + 4 G/3) V^(2/3) of the stiffest element, is 2^45 to
 * 2^46 units, so rounding is 1e-14 of it and 2^8 times it still fits (DESIGN 5). */
static void choose_scale(lar_domain *domain) {
    const lar_model *model = domain->model;
    double characteristic = DBL_MIN;
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3];
        const lar_material *material = material_of(model, e);
        lar_mesh_corners(&model->mesh, e, corner);
        double side = cbrt(lar_hexahedron_volume(corner));
        double modulus = lar_material_bulk(material) + 4 * lar_material_shear(material) / 3;
        characteristic = fmax(characteristic, modulus * side * side);
    }
    int exponent;
    frexp(characteristic, &exponent);
    domain->scale = ldexp(1, 46 - exponent);
}

static lar_status spread_mass(lar_domain *domain, lar_error *error) {
    const lar_model *model = domain->model;
    size_t nodes = (size_t)domain->node_padded;
    domain->mass = lar_calloc_aligned(nodes, sizeof *domain->mass);
    domain->push = lar_calloc_aligned(nodes, sizeof *domain->push);
    if (!domain->mass || !domain->push)
        return lar_fail_memory(error, 2 * nodes * sizeof *domain->mass, "the masses");
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(&model->mesh, e, corner);
        double share = material_of(model, e)->density * lar_hexahedron_volume(corner) / 8;
        for (int a = 0; a < 8; a++) domain->mass[domain->local[model->mesh.element[e][a]]] += share;
    }
    return LAR_OK;
}

/* Constants of v' = keep v - push f + drift (docs/theory.md): central differences with damping c,
 *     m (v' - v)/dt + c m (v' + v)/2 = -f + m g. */
static void prepare_motion(lar_domain *domain) {
    const lar_model *model = domain->model;
    double dt = domain->time_step, half = 0.5 * model->damping * dt;
    double gravity[3], shortest = DBL_MAX;
    lar_gravity_at(model, 0, gravity);
    domain->motion = (lar_motion){.keep = (1 - half) / (1 + half), .dt = dt};
    for (int i = 0; i < 3; i++) domain->motion.drift[i] = gravity[i] * dt / (1 + half);
    for (int32_t n = 0; n < domain->node_count; n++)
        domain->push[n] = dt / (domain->mass[n] * (1 + half) * domain->scale);
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(&model->mesh, e, corner);
        shortest = fmin(shortest, cbrt(lar_hexahedron_volume(corner)));
    }
    /* A node that crosses its element in one step is no motion the scheme can follow. */
    domain->motion.speed = shortest / dt;
}

lar_status lar_domain_create(const lar_model *model, const lar_options *options, lar_domain *domain,
                             lar_error *error) {
    *domain = (lar_domain){.model = model, .kind = options->element};
    lar_status status = lar_kernels_find(options->isa, &domain->kernels, error);
    if (!status) status = choose_step(domain, options, error);
    if (!status) status = order_elements(domain, error);
    if (!status) status = number_nodes(domain, error);
    if (!status) status = spread_mass(domain, error);
    if (!status) {
        choose_scale(domain);
        prepare_motion(domain);
        if (domain->kind == LAR_ELEMENT_HEX8) status = build_blocks(domain, error);
    }
    if (!status) status = lar_conditions_create(model, domain->local, &domain->conditions, error);
    double largest = status ? 0 : lar_conditions_largest(&domain->conditions);
    if (!status && largest * domain->scale > 0x1p58)
        status = lar_fail(error, LAR_ERROR_MODEL,
                          "%s: a nodal force of %g N is far beyond what this material can bear; "
                          "check its unit",
                          model->source ? model->source : "model", largest);
    if (status) lar_domain_destroy(domain);
    return status;
}

void lar_domain_destroy(lar_domain *domain) {
    lar_conditions_destroy(&domain->conditions);
    free(domain->element);
    free(domain->block);
    free(domain->global);
    free(domain->local);
    free(domain->mass);
    free(domain->push);
    *domain = (lar_domain){0};
}

void lar_domain_corners(const lar_domain *domain, const double *u, lar_gid e, double out[8][3]) {
    const lar_mesh *mesh = &domain->model->mesh;
    for (int a = 0; a < 8; a++)
        memcpy(out[a], u + 4 * domain->local[mesh->element[e][a]], 3 * sizeof(double));
}
