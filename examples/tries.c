/* Lariat inside a program that has its mesh in memory and tries things out: a block with a ridge,
 * made of arrays; a grasper takes hold of the ridge, a probe presses into the block beside it;
 * gravity turns, a load comes and goes; and from the state that is then, a thousand pushes of the
 * probe are tried to find the one whose force comes nearest to what was asked for.
 *     cc tries.c $(pkg-config --cflags --libs lariat) -o tries && ./tries
 */
#include <inttypes.h>
#include <lariat.h>
#include <math.h>
#include <stdio.h>

enum { NX = 8, NY = 6, NZ = 4, RIDGE = 5, PROBE = 0, GRASPER = 1, ROOM = 400, TRIES = 1000 };
static const double EDGE = 0.01; /* of a cell [m] */

static const char scene[] =
    "lariat: 1\n"
    "title: A block with a ridge\n"
    "gravity: [0, 0, -9.81]\n"
    "damping: 20\n"
    "materials:\n"
    "  - { cells: 1, law: neo-hookean, density: 1050, shear_modulus: 3.0e3, bulk_modulus: 3.0e4 }\n"
    "  - { cells: 2, law: neo-hookean, density: 1050, shear_modulus: 6.0e3, bulk_modulus: 6.0e4 }\n"
    "fix: [ { nodes: floor, axes: xyz } ]\n"
    "tools:\n"
    "  - { name: probe, shape: sphere, radius: 0.008, at: [0.02, 0.03, 0.042] }\n"
    "  - { name: grasper, shape: grasper, radius: 0.003, length: 0.03, spread: 40,\n"
    "      at: [0.055, 0.03, 0.08] }\n";

/* ---- the mesh ------------------------------------------------------------------------------- */

static double position[(NX + 1) * (NY + 1) * (NZ + 1)][3];
static int32_t element[NX * NY * NZ][8], tag[NX * NY * NZ];
static int32_t node_at[NX + 1][NY + 1][NZ + 1], floor_nodes[(NX + 1) * (NY + 1)];
static int32_t end_nodes[(NY + 1) * (NZ + 1)];

/* The node at a corner of the grid, made when it is first asked for. */
static int32_t node_of(lar_mesh_arrays *mesh, int i, int j, int k) {
    int32_t *node = &node_at[i][j][k];
    if (*node > 0) return *node - 1;
    position[mesh->nodes][0] = i * EDGE;
    position[mesh->nodes][1] = j * EDGE;
    position[mesh->nodes][2] = k * EDGE;
    *node = ++mesh->nodes;
    return *node - 1;
}

static lar_status make_model(lar_model **model, lar_error *error) {
    lar_array_set set[2] = {{.name = "floor", .index = floor_nodes},
                            {.name = "end", .index = end_nodes}};
    lar_mesh_arrays mesh = {.sets = 2,
                            .position = (const double(*)[3])position,
                            .element = (const int32_t(*)[8])element,
                            .tag = tag,
                            .set = set};
    for (int k = 0; k < NZ; k++)
        for (int j = 0; j < NY; j++)
            for (int i = 0; i < NX; i++) {
                if (k == NZ - 1 && i != RIDGE) continue;
                for (int a = 0; a < 8; a++) /* counter-clockwise below, then above */
                    element[mesh.elements][a] =
                        node_of(&mesh, i + (a % 4 == 1 || a % 4 == 2), j + (a % 4 > 1), k + a / 4);
                tag[mesh.elements++] = k == NZ - 1 ? 2 : 1;
            }
    for (int32_t n = 0; n < mesh.nodes; n++) {
        if (position[n][2] == 0) floor_nodes[set[0].count++] = n;
        if (position[n][0] == NX * EDGE) end_nodes[set[1].count++] = n;
    }
    return lar_model_from_arrays(&mesh, scene, model, error);
}

/* ---- what is done with it ------------------------------------------------------------------- */

/* The tip goes to (x, y, z) within so many steps. */
static lar_status move(lar_simulation *simulation, int32_t tool, double x, double y, double z,
                       uint64_t steps, lar_error *error) {
    const lar_tool_pose pose = {{x, y, z}, {1, 0, 0, 0}, 1};
    return lar_simulation_tool_move(simulation, tool, &pose, steps, error);
}

static lar_status take_hold(lar_simulation *simulation, lar_error *error) {
    lar_tool_force force;
    lar_status status = move(simulation, GRASPER, 0.055, 0.03, 0.064, 500, error);
    if (!status) status = lar_simulation_advance(simulation, 500, error);
    if (!status) status = lar_simulation_grasp(simulation, GRASPER, NULL, 500, NULL, error);
    if (!status) status = lar_simulation_advance(simulation, 500, error);
    if (!status) status = lar_simulation_tool_force(simulation, GRASPER, &force, error);
    if (!status)
        printf("grasper  holds %d points, presses with %.3f N\n", (int)force.held,
               force.grasp_force);
    return status;
}

static lar_status press(lar_simulation *simulation, lar_error *error) {
    static lar_touch touch[ROOM];
    int32_t count;
    double sum[3] = {0}, deepest = 0;
    lar_status status = move(simulation, PROBE, 0.02, 0.03, 0.035, 500, error);
    if (!status) status = lar_simulation_advance(simulation, 700, error);
    if (!status)
        status = lar_simulation_tool_touches(simulation, PROBE, ROOM, touch, &count, error);
    if (status) return status;
    for (int32_t i = 0; i < count && i < ROOM; i++) {
        for (int k = 0; k < 3; k++) sum[k] += touch[i].force[k];
        deepest = fmax(deepest, touch[i].depth);
    }
    printf("probe    touches %d points, %.2f mm deep, force %.4f %.4f %.4f N\n", (int)count,
           1e3 * deepest, sum[0], sum[1], sum[2]);
    return LAR_OK;
}

/* How far the end of the block is above where it was at rest [mm]. */
static double end_height(const lar_simulation *simulation) {
    static double u[(NX + 1) * (NY + 1) * (NZ + 1)][3];
    lar_simulation_displacements(simulation, u);
    return 1e3 * u[end_nodes[(NY + 1) * (NZ - 1) + NY / 2]][2];
}

static lar_status turn_and_load(lar_simulation *simulation, lar_error *error) {
    static const double aside[3] = {0, -9.81, 0}, up[3] = {0, 0, 0.01};
    double before = 0, loaded = 0;
    lar_status status = lar_simulation_set_gravity(simulation, aside, error);
    if (!status) status = lar_simulation_advance(simulation, 1000, error);
    if (!status) before = end_height(simulation);
    if (!status) status = lar_simulation_set_force_on(simulation, "end", up, error);
    if (!status) status = lar_simulation_advance(simulation, 1000, error);
    if (!status) loaded = end_height(simulation);
    if (!status) status = lar_simulation_set_force_on(simulation, "end", NULL, error);
    if (!status) status = lar_simulation_advance(simulation, 1000, error);
    if (!status)
        printf("load     lifts the end by %.3f mm; without it %.3f mm are left\n", loaded - before,
               end_height(simulation) - before);
    return status;
}

/* From one state, a thousand pushes of some steps each: the one that comes nearest to 0.4 N. */
static lar_status try_pushes(lar_simulation *simulation, lar_saved *saved, lar_error *error) {
    const uint64_t hash = lar_simulation_hash(simulation);
    double best = INFINITY, found = 0, force_found = 0;
    int32_t different = 0;
    lar_status status = LAR_OK;
    for (int32_t i = 0; i < TRIES && !status; i++) {
        lar_tool_force force;
        double depth = 0.002 * i / TRIES;
        status = lar_simulation_save_to(simulation, saved, error);
        if (!status) status = move(simulation, PROBE, 0.02, 0.03, 0.035 - depth, 10, error);
        if (!status) status = lar_simulation_advance(simulation, 20, error);
        if (!status) status = lar_simulation_tool_force(simulation, PROBE, &force, error);
        if (!status) status = lar_simulation_load_from(simulation, saved, error);
        if (status) break;
        different += lar_simulation_hash(simulation) != hash;
        if (!(fabs(force.force[2] - 0.4) < best)) continue;
        best = fabs(force.force[2] - 0.4);
        found = depth;
        force_found = force.force[2];
    }
    if (!status)
        printf("tries    %d, each back to the same state but %d; best %.2f mm deeper: %.4f N\n",
               TRIES, (int)different, 1e3 * found, force_found);
    return status;
}

int main(void) {
    lar_error error;
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    lar_saved *saved = NULL;
    lar_status status = make_model(&model, &error);
    if (!status) status = lar_simulation_create(model, NULL, &simulation, &error);
    if (!status) status = lar_saved_create(simulation, &saved, &error);
    if (!status)
        printf("block    %d nodes, %d elements\n", (int)lar_model_node_count(model),
               (int)lar_model_element_count(model));
    if (!status) status = take_hold(simulation, &error);
    if (!status) status = press(simulation, &error);
    if (!status) status = turn_and_load(simulation, &error);
    if (!status) status = try_pushes(simulation, saved, &error);
    if (!status)
        printf("hash     %016" PRIx64 " at step %" PRIu64 "\n", lar_simulation_hash(simulation),
               lar_simulation_steps(simulation));
    if (status) fprintf(stderr, "tries: %s\n", error.message);
    lar_saved_destroy(saved);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return status != LAR_OK;
}
