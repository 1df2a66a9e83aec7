/* What the tests of the engine share: small bodies made in memory, and running them.
 *
 *     brick_model: nx x ny x nz hexahedra, x fastest, ids from 1; inner and outer nodes may be
 *     shifted a little so that no element is a box
 */
#ifndef LAR_TESTS_ENGINE_TEST_H
#define LAR_TESTS_ENGINE_TEST_H

#include "law/every_term.h"
#include "step/measure.h"
#include "simulation/simulation.h"
#include "model/model.h"
#include "testing.h"

/* Pseudo-random in [-1, 1), the same everywhere. */
TEST_UNUSED static double noise(uint32_t n) {
    n = (n ^ 61) ^ (n >> 16);
    n *= 9;
    n ^= n >> 4;
    n *= 0x27d4eb2d;
    n ^= n >> 15;
    return (double)n / 2147483648.0 - 1;
}

typedef struct brick {
    int cells[3];
    double edge;  /* of a cell [m] */
    double shift; /* of nodes, as a share of the edge */
    lar_law law;
    double shear, bulk, density;
} brick;

/* Soft tissue, 10 mm cells, slightly irregular. */
static const brick soft_brick = {{3, 2, 2}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

static inline int32_t brick_node(const brick *b, int i, int j, int k) {
    return i + (b->cells[0] + 1) * (j + (b->cells[1] + 1) * k);
}

TEST_UNUSED static void brick_mesh(const brick *b, lar_mesh *mesh) {
    const int *c = b->cells;
    mesh->source = lar_strdup("brick");
    mesh->node_count = (c[0] + 1) * (c[1] + 1) * (c[2] + 1);
    mesh->element_count = c[0] * c[1] * c[2];
    mesh->position = lar_calloc((size_t)mesh->node_count, sizeof *mesh->position);
    mesh->node_id = lar_calloc((size_t)mesh->node_count, sizeof *mesh->node_id);
    mesh->element = lar_calloc((size_t)mesh->element_count, sizeof *mesh->element);
    mesh->element_id = lar_calloc((size_t)mesh->element_count, sizeof *mesh->element_id);
    mesh->element_tag = lar_calloc((size_t)mesh->element_count, sizeof *mesh->element_tag);
    for (int32_t n = 0; n < mesh->node_count; n++) {
        int at[3] = {n % (c[0] + 1), n / (c[0] + 1) % (c[1] + 1), n / (c[0] + 1) / (c[1] + 1)};
        mesh->node_id[n] = n + 1;
        for (int i = 0; i < 3; i++)
            mesh->position[n][i] = b->edge * (at[i] + b->shift * noise((uint32_t)(3 * n + i + 7)));
    }
    for (int32_t e = 0; e < mesh->element_count; e++) {
        int i = e % c[0], j = e / c[0] % c[1], k = e / c[0] / c[1];
        mesh->element_id[e] = e + 1;
        for (int a = 0; a < 8; a++)
            mesh->element[e][a] =
                brick_node(b, i + (lar_node_sign[a][0] > 0), j + (lar_node_sign[a][1] > 0),
                           k + (lar_node_sign[a][2] > 0));
    }
}

/* Holmes and Mow's law falls in at large stretches where lambda is more than 2 mu. */
TEST_UNUSED static double upright_bulk(lar_law law, double shear, double bulk) {
    return law == LAR_LAW_holmes_mow ? fmin(bulk, 2 * shear) : bulk;
}

TEST_UNUSED static lar_model *brick_model(const brick *b) {
    lar_model *model = lar_model_create();
    assert_non_null(model);
    brick_mesh(b, &model->mesh);
    lar_material *material = LAR_MODEL_APPEND(model, material);
    material->law = b->law;
    material->density = b->density;
    lar_material_from_shear_bulk(material, b->shear, upright_bulk(b->law, b->shear, b->bulk));
    every_term(material, 0.25);
    model->element_material = lar_calloc((size_t)model->mesh.element_count, sizeof(int32_t));
    return model;
}

/* Nodes of the brick with index `at` along `axis` (-1: the last). */
TEST_UNUSED static lar_node_list brick_side(const brick *b, int axis, int at) {
    const int *c = b->cells;
    if (at < 0) at = c[axis];
    lar_node_list list = {
        0, lar_calloc((size_t)((c[0] + 1) * (c[1] + 1) * (c[2] + 1)), sizeof(int32_t))};
    for (int k = 0; k <= c[2]; k++)
        for (int j = 0; j <= c[1]; j++)
            for (int i = 0; i <= c[0]; i++)
                if ((int[]){i, j, k}[axis] == at) list.node[list.count++] = brick_node(b, i, j, k);
    return list;
}

TEST_UNUSED static lar_node_list single_node(int32_t node) {
    lar_node_list list = {1, lar_calloc(1, sizeof(int32_t))};
    list.node[0] = node;
    return list;
}

TEST_UNUSED static void fix_nodes(lar_model *model, lar_node_list nodes, unsigned axes) {
    *(lar_fix *)LAR_MODEL_APPEND(model, fix) = (lar_fix){nodes, axes};
}

/* Smooth ramp from 0 to 1. */
TEST_UNUSED static int add_ramp(lar_model *model, double over) {
    *(lar_curve *)LAR_MODEL_APPEND(model, curve) =
        (lar_curve){.kind = LAR_CURVE_RAMP, .over = over};
    return model->curve_count - 1;
}

/* Through `count` points (time, value). */
TEST_UNUSED static int add_table(lar_model *model, lar_curve_shape shape, int count,
                                 const double (*point)[2]) {
    lar_curve *curve = LAR_MODEL_APPEND(model, curve);
    *curve = (lar_curve){.kind = LAR_CURVE_TABLE,
                         .shape = shape,
                         .count = count,
                         .point = lar_calloc((size_t)count, sizeof *point)};
    memcpy(curve->point, point, (size_t)count * sizeof *point);
    return model->curve_count - 1;
}

TEST_UNUSED static void move_nodes(lar_model *model, lar_node_list nodes, unsigned axes, double by,
                                   int curve) {
    *(lar_move *)LAR_MODEL_APPEND(model, move) =
        (lar_move){.nodes = nodes, .axes = axes, .by = by, .curve = curve};
}

TEST_UNUSED static void load_nodes(lar_model *model, lar_node_list nodes, double x, double y,
                                   double z, int curve) {
    *(lar_nodal_load *)LAR_MODEL_APPEND(model, load) = (lar_nodal_load){nodes, {x, y, z}, curve, 0};
}

/* Pressure on the whole boundary, or on local face `face` of the boundary. */
TEST_UNUSED static void press(lar_model *model, int face, double pressure, int curve) {
    int32_t *faces, count, kept = 0;
    assert_int_equal(lar_mesh_boundary(&model->mesh, &faces, &count, NULL), LAR_OK);
    for (int32_t i = 0; i < count; i++)
        if (face < 0 || faces[i] % 6 == face) faces[kept++] = faces[i];
    *(lar_pressure_load *)LAR_MODEL_APPEND(model, pressure) =
        (lar_pressure_load){kept, faces, pressure, curve};
}

TEST_UNUSED static void throw_node(lar_model *model, int32_t node, const double velocity[3]) {
    lar_initial_velocity *initial = LAR_MODEL_APPEND(model, initial);
    initial->nodes = single_node(node);
    memcpy(initial->velocity, velocity, sizeof initial->velocity);
}

/* Every node gets translation + spin x position + shake * noise. */
TEST_UNUSED static void throw_body(lar_model *model, const double translation[3],
                                   const double spin[3], double shake) {
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        const double *x = model->mesh.position[n];
        double v[3];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            v[i] = translation[i] + spin[j] * x[k] - spin[k] * x[j] +
                   shake * noise((uint32_t)(1000 + 3 * n + i));
        }
        throw_node(model, n, v);
    }
}

/* Everything that a step can do: all laws, supports, motion, loads, pressure, varying gravity,
 * damping. */
TEST_UNUSED static lar_model *everything_model(const brick *b) {
    lar_model *model = brick_model(b);
    static const double points[3][2] = {{0, 0}, {0.02, 1}, {0.05, -0.5}};
    int ramp = add_ramp(model, 0.03), table = add_table(model, LAR_CURVE_SMOOTH, 3, points);
    for (int law = 1; law < LAR_LAW_COUNT; law++) {
        lar_material *material = LAR_MODEL_APPEND(model, material);
        material->law = (lar_law)law;
        material->density = b->density;
        lar_material_from_shear_bulk(material, b->shear,
                                     upright_bulk((lar_law)law, b->shear, b->bulk));
        model->element_material[law] = law;
    }
    memcpy(model->gravity, (double[]){2, 1, -9.81}, 24);
    model->gravity_curve[0] = table;
    model->damping = 3;
    fix_nodes(model, brick_side(b, 0, 0), LAR_AXIS_ALL);
    move_nodes(model, brick_side(b, 0, -1), LAR_AXIS_Y, 0.004, table);
    press(model, 4, 60, ramp);
    load_nodes(model, single_node(brick_node(b, 1, 1, 1)), 0.002, -0.001, 0.001, ramp);
    return model;
}

/* The tests' models are their own to complete; const where they are handed around. */
TEST_UNUSED static lar_simulation *start_with(const lar_model *model, lar_options options) {
    lar_simulation *simulation = NULL;
    lar_error error = {0};
    if (lar_model_check((lar_model *)model, &error)) fail_msg("%s", error.message);
    if (lar_simulation_create(model, &options, &simulation, &error)) fail_msg("%s", error.message);
    return simulation;
}

TEST_UNUSED static lar_simulation *start(const lar_model *model) {
    return start_with(model, lar_options_default());
}

TEST_UNUSED static void advance(lar_simulation *simulation, uint64_t steps) {
    lar_error error;
    if (lar_simulation_advance(simulation, steps, &error)) fail_msg("%s", error.message);
}

TEST_UNUSED static void finish(lar_simulation *simulation, lar_model *model) {
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

/* Three values of a local node, good until sixteen others have been asked for. */
TEST_UNUSED static double *three_of(const double *axes, size_t stride, lar_lid n) {
    static _Thread_local double kept[16][3];
    static _Thread_local unsigned next;
    double *three = kept[next++ % 16];
    lar_axes_get(axes, stride, n, three);
    return three;
}

/* Displacement and velocity of a global node, as they are now: likewise. */
TEST_UNUSED static const double *node_u(const lar_simulation *simulation, int32_t node) {
    const lar_state *state = &simulation->state;
    return three_of(state->u, state->stride, simulation->domain.layout.local[node]);
}

TEST_UNUSED static const double *node_v(const lar_simulation *simulation, int32_t node) {
    const lar_state *state = &simulation->state;
    return three_of(state->v, state->stride, simulation->domain.layout.local[node]);
}

/* One axis of a global node in u, v or force of the whole state. */
TEST_UNUSED static size_t node_at(const lar_simulation *simulation, int32_t node, int axis) {
    return lar_state_at(&simulation->state, simulation->domain.layout.local[node], axis);
}

TEST_UNUSED static void clear_forces(lar_simulation *simulation) {
    lar_state *state = &simulation->state;
    memset(state->force, 0, 3 * state->stride * sizeof *state->force);
}

/* Loads and internal forces at the present state, [3][stride of the state] in newtons: internal
 * minus external. The caller frees. */
TEST_UNUSED static double *residual_forces(lar_simulation *simulation) {
    lar_state *state = &simulation->state;
    size_t values = 3 * state->stride;
    double *force = lar_calloc(values, sizeof *force);
    lar_fault fault = {0};
    lar_step_forces(&simulation->domain, &simulation->scratch->measure.interactions, state, &fault);
    for (size_t i = 0; i < values; i++)
        force[i] = (double)state->force[i] / simulation->domain.scale;
    clear_forces(simulation);
    return force;
}

/* (K + 4 G / 3) edge^2. */
TEST_UNUSED static double characteristic_force(const brick *b) {
    return (b->bulk + 4 * b->shear / 3) * b->edge * b->edge;
}

/* Goes on for so long [s]: the account of energy is closed then to 10^-4. */
TEST_UNUSED static lar_energy balanced_after(lar_simulation *s, double seconds) {
    lar_energy e;
    advance(s, (uint64_t)(seconds / s->domain.time_step));
    lar_simulation_energy(s, &e);
    double spent = e.kinetic + e.strain + e.hourglass + e.damping + e.contact + e.viscous;
    assert_below(fabs(spent - e.external), 1e-4 * e.external);
    return e;
}

#endif
