/* Forces that are set on nodes while a simulation runs: they do what loads of the model do, every
 * joule of theirs is accounted for, and the bits are the same on every grid, between processes, and
 * through checkpoints and states in memory. */
#include "simulation/checkpoint.h"
#include "engine/engine_test.h"
#include "engine/changes_test.h"
#include "engine/tools_test.h"

#define PATH LAR_TEST_BUILD "/forces.checkpoint"

static const brick body = {{6, 5, 4}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

/* Held at one end; the other end is the set "end", and its first node is in "corner", too. */
static lar_model *make(bool loaded) {
    lar_model *model = brick_model(&body);
    lar_error error;
    fix_nodes(model, brick_side(&body, 0, 0), LAR_AXIS_ALL);
    model->damping = 3;
    lar_node_list end = brick_side(&body, 0, -1), corner = single_node(end.node[0]);
    if (loaded) {
        int ramp = add_table(model, 0, 1, (const double[][2]){{0, 1}});
        load_nodes(model, brick_side(&body, 0, -1), 0.002, 0, -0.001, ramp);
        load_nodes(model, single_node(end.node[0]), 0, 0.003, 0, ramp);
    }
    assert_int_equal(lar_mesh_add_set(&model->mesh, "faces", LAR_SET_FACES,
                                      lar_calloc(1, sizeof(int32_t)), 1, &error),
                     LAR_OK);
    assert_int_equal(
        lar_mesh_add_set(&model->mesh, "end", LAR_SET_NODES, end.node, end.count, &error), LAR_OK);
    assert_int_equal(
        lar_mesh_add_set(&model->mesh, "corner", LAR_SET_NODES, corner.node, 1, &error), LAR_OK);
    return model;
}

static void set_on(lar_simulation *simulation, const char *set, double x, double y, double z) {
    lar_error error;
    if (lar_simulation_set_force_on(simulation, set, (const double[]){x, y, z}, &error))
        fail_msg("%s", error.message);
}

static void set_at(lar_simulation *simulation, int32_t node, double x, double y, double z) {
    lar_error error;
    if (lar_simulation_set_force(simulation, node, (const double[]){x, y, z}, &error))
        fail_msg("%s", error.message);
}

static int32_t corner_node(void) {
    return brick_node(&body, 6, 0, 0);
}

/* ---- what they do --------------------------------------------------------------------------- */

static void they_are_loads_of_the_model(void **unused) {
    (void)unused;
    uint64_t hash[2];
    lar_energy energy[2];
    for (int set = 0; set < 2; set++) {
        lar_model *model = make(!set);
        lar_simulation *simulation = start(model);
        if (set) {
            set_on(simulation, "end", 0.002, 0, -0.001);
            set_at(simulation, corner_node(), 0, 0.003, 0);
        }
        /* Those of a model with loads are half a step before the start already. */
        memset(simulation->state.v, 0, 3 * simulation->state.stride * sizeof(double));
        advance(simulation, 400);
        hash[set] = lar_simulation_hash(simulation);
        lar_simulation_energy(simulation, &energy[set]);
        finish(simulation, model);
    }
    assert_int_equal(hash[0], hash[1]);
    assert_true(energy[0].external > 1e-6);
    assert_below(fabs(energy[0].external - energy[1].external), 1e-12 * energy[0].external);
}

static void they_end_when_they_are_removed(void **unused) {
    (void)unused;
    lar_model *model = make(false);
    lar_simulation *simulation = start(model);
    double force[3];
    set_on(simulation, "end", 1, 2, 3);
    set_on(simulation, "corner", 1, 0, 0);
    set_at(simulation, corner_node(), 0, 0, 4);
    set_at(simulation, 0, 5, 0, 0);
    lar_simulation_force(simulation, corner_node(), force);
    assert_true(force[0] == 2 && force[1] == 2 && force[2] == 7);
    set_on(simulation, "end", 0, 0, 1); /* in its place */
    lar_simulation_force(simulation, corner_node(), force);
    assert_true(force[0] == 1 && force[1] == 0 && force[2] == 5);
    assert_int_equal(lar_simulation_set_force_on(simulation, "end", NULL, NULL), LAR_OK);
    set_at(simulation, corner_node(), 0, 0, 0);
    lar_simulation_force(simulation, corner_node(), force);
    assert_true(force[0] == 1 && force[1] == 0 && force[2] == 0);
    assert_int_equal(simulation->tools.forces.count, 2);
    assert_int_equal(lar_simulation_set_force(simulation, -1, NULL, NULL), LAR_OK);
    assert_int_equal(simulation->tools.forces.count, 0);
    set_at(simulation, 7, 1, 0, 0);
    assert_int_equal(lar_simulation_reset(simulation, NULL), LAR_OK);
    assert_int_equal(simulation->tools.forces.count, 0);
    uint64_t hash = lar_simulation_hash(simulation);
    set_at(simulation, 7, 1, 0, 0);
    set_at(simulation, 7, 0, 0, 0);
    advance(simulation, 10);
    lar_simulation *other = start(model);
    assert_int_equal(lar_simulation_hash(other), hash);
    advance(other, 10);
    assert_int_equal(lar_simulation_hash(other), lar_simulation_hash(simulation));
    lar_simulation_destroy(other);
    finish(simulation, model);
}

static void what_makes_no_sense_is_refused(void **unused) {
    (void)unused;
    lar_model *model = make(false);
    lar_simulation *simulation = start(model);
    const lar_tools before = simulation->tools;
    const double one[3] = {1, 0, 0}, much[3] = {0, 1e9, 0}, nan[3] = {0, 0, NAN};
    lar_error error;
    assert_int_equal(lar_simulation_set_force(NULL, 0, one, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_set_force(simulation, -1, one, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_set_force(simulation, 100000, NULL, &error),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "no node 100000"));
    assert_int_equal(lar_simulation_set_force(simulation, 1, nan, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_set_force(simulation, 1, much, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "check the unit"));
    assert_int_equal(lar_simulation_set_force_on(simulation, "faces", one, &error),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "'faces'"));
    assert_int_equal(lar_simulation_set_force_on(simulation, NULL, one, &error),
                     LAR_ERROR_ARGUMENT);
    assert_memory_equal(&before, &simulation->tools, sizeof before);
    for (int32_t n = 0; n < LAR_FORCES_MAX; n++) set_at(simulation, n, 1e-3, 0, 0);
    set_at(simulation, 5, 2e-3, 0, 0);
    assert_int_equal(lar_simulation_set_force(simulation, LAR_FORCES_MAX, one, &error),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "128"));
    finish(simulation, model);
}

/* ---- energy --------------------------------------------------------------------------------- */

static void change_often(lar_simulation *simulation, int i) {
    if (i % 10 == 2) set_on(simulation, "end", 0, 0.004, -0.001 * (i % 3));
    if (i % 10 == 5) set_at(simulation, corner_node(), 0.01, 0, 0);
    if (i % 10 == 7) set_at(simulation, corner_node(), 0, 0, 0);
    if (i % 20 == 18) lar_simulation_set_force(simulation, -1, NULL, NULL);
}

/* Set and removed again and again, in a body that moves. */
static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    for (int grid = 0; grid < 2; grid++) {
        lar_model *model = make(false);
        lar_options options = lar_options_default();
        options.time_step = 5e-5;
        options.grid = grid ? "2x1x1" : NULL;
        lar_simulation *simulation = start_with(model, options);
        assert_below(changed_account(simulation, change_often), 3e-4);
        finish(simulation, model);
    }
}

/* ---- the same bits -------------------------------------------------------------------------- */

static void change(lar_simulation *simulation, int i) {
    if (i == 1) set_on(simulation, "end", 0.001, 0.0003, -0.001);
    if (i == 2) set_at(simulation, corner_node(), 0, 0.01, 0);
    if (i == 3) set_at(simulation, brick_node(&body, 3, 2, 4), 0, 0, -0.02);
    if (i == 4) set_on(simulation, "end", 0, 0, 0);
    if (i == 5) set_at(simulation, corner_node(), 0.002, 0, 0);
}

static lar_model *whole_body(void) {
    return make(false);
}

static const changed_run changed = {whole_body, change, 6, 37, 1, false, PATH};

static void the_hash_is_the_same_everywhere(void **unused) {
    (void)unused;
    check_changed_everywhere(&changed);
}

static void processes_agree(void **unused) {
    (void)unused;
    check_changed_in_processes(&changed);
}

/* ---- going back ----------------------------------------------------------------------------- */

static uint32_t version(const lar_simulation *simulation) {
    return simulation->tools.forces.count > 0 ? 8 : 6;
}

static void set_another(lar_simulation *simulation) {
    set_at(simulation, 3, 0.1, 0, 0);
}

static void a_run_goes_on_with_its_forces(void **unused) {
    (void)unused;
    check_changed_goes_on(&changed, set_another, version);
}

/* With a tool that was added, too: version 9. And no damage goes unnoticed. */
static void a_damaged_one_is_refused(void **unused) {
    (void)unused;
    lar_model *model = make(false);
    lar_options options = lar_options_default();
    options.spares = 1;
    lar_simulation *simulation = start_with(model, options);
    const lar_tool_info sphere = {.shape = LAR_TOOL_SPHERE, .radius = 0.01};
    lar_bytes bytes;
    lar_error error;
    set_at(simulation, 3, 0.01, 0, 0);
    set_on(simulation, "end", 0, 0, 0.01);
    assert_int_equal(lar_simulation_add_tool(simulation, &sphere, NULL, &error), LAR_OK);
    advance(simulation, 10);
    assert_int_equal(lar_simulation_save(simulation, PATH, NULL), LAR_OK);
    assert_int_equal(changed_version(PATH), 9);
    assert_int_equal(lar_simulation_load(simulation, PATH, &error), LAR_OK);
    assert_int_equal(simulation->tools.forces.count, 2);
    assert_int_equal(lar_checkpoint_read(PATH, &bytes, &error), LAR_OK);
    const size_t settings = 144 + 56 + 552 + 4 * 104;
    /* Their number, its padding, then of, on_set and force of each: there is no fourth
     * set, and the first one is of faces. */
    static const struct {
        size_t at;
        int32_t value;
    } damage[] = {{0, -1}, {0, 129},     {0, 1},  {0, 3},  {4, 1},
                  {8, -1}, {8, 1 << 20}, {12, 2}, {12, 1}, {40, 0}};
    for (size_t i = 0; i < sizeof damage / sizeof *damage; i++) {
        lar_checkpoint checkpoint;
        lar_bytes bad = {lar_calloc(bytes.size, 1), bytes.size};
        memcpy(bad.data, bytes.data, bytes.size);
        memcpy(bad.data + settings + damage[i].at, &damage[i].value, sizeof damage[i].value);
        uint64_t sum = lar_checkpoint_sum(bad.data, bad.size / 8 - 1);
        memcpy(bad.data + bad.size - 8, &sum, sizeof sum);
        assert_int_equal(lar_checkpoint_parse(PATH, &bad, &simulation->domain, &checkpoint, &error),
                         LAR_ERROR_FORMAT);
        lar_bytes_free(&bad);
    }
    lar_bytes_free(&bytes);
    finish(simulation, model);
}

#define SETS LAR_TEST_BUILD "/sets.checkpoint"

/* A set is a number in a file: in a model that has another one there, it is refused. */
static void a_file_knows_its_sets(void **unused) {
    (void)unused;
    lar_model *model = make(false), *other = make(false);
    lar_simulation *simulation = start_with(model, lar_options_default());
    lar_error error = {0};
    set_on(simulation, "end", 0.001, 0, 0);
    assert_int_equal(lar_simulation_save(simulation, SETS, &error), LAR_OK);
    if (lar_simulation_load(simulation, SETS, &error)) fail_msg("%s", error.message);
    lar_simulation_destroy(simulation);
    other->mesh.set[1].count--;
    simulation = start_with(other, lar_options_default());
    assert_int_equal(lar_simulation_load(simulation, SETS, &error), LAR_ERROR_MODEL);
    assert_non_null(strstr(error.message, "sets of nodes"));
    /* One in which nothing is set on them does not mind. */
    assert_int_equal(lar_simulation_save(simulation, SETS, &error), LAR_OK);
    lar_simulation_destroy(simulation);
    simulation = start_with(model, lar_options_default());
    if (lar_simulation_load(simulation, SETS, &error)) fail_msg("%s", error.message);
    finish(simulation, model);
    lar_model_destroy(other);
}

/* Whoever pulls too hard at a node reads that, in the same words on every grid, and not of a ball
 * that hangs in the air beside it. */
static void what_tears_is_named(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1", "2x2x1"};
    char first[1016] = "";
    for (int g = 0; g < 3; g++) {
        lar_model *model = make(false);
        lar_error error = {0};
        lar_options options = lar_options_default();
        options.grid = grids[g];
        add_tool(model, "ball", LAR_TOOL_SPHERE, 0.065, -0.02, -0.02);
        lar_simulation *simulation = start_with(model, options);
        set_at(simulation, corner_node(), 0, -60, 0);
        assert_int_equal(lar_simulation_advance(simulation, 2000, &error), LAR_ERROR_UNSTABLE);
        if (!strstr(error.message, "the force of 60 N that was set on node"))
            fail_msg("%s", error.message);
        if (g == 0) memcpy(first, error.message, sizeof first);
        assert_string_equal(error.message, first);
        finish(simulation, model);
    }
}

/* Where the scene's own load tears, a force that is next to nothing beside it has no part in it,
 * nor a ball that moves through the air and touches nothing; a force as large as the load has. */
static void what_counts_for_nothing_is_not_named(void **unused) {
    (void)unused;
    static const double force[] = {1e-12, 0.1, 60};
    for (int k = 0; k < 3; k++) {
        lar_model *model = make(false);
        lar_error error = {0};
        lar_node_list end = brick_side(&body, 0, -1);
        load_nodes(model, end, 0, -60, 0, add_table(model, 0, 1, (const double[][2]){{0.02, 1}}));
        add_tool(model, "ball", LAR_TOOL_SPHERE, 0.08, -0.02, -0.02);
        lar_simulation *simulation = start(model);
        set_at(simulation, corner_node(), force[k], 0, 0);
        place_tool(simulation, 0, 0.08, 0, -0.02, 1, 2000);
        assert_int_equal(lar_simulation_advance(simulation, 2000, &error), LAR_ERROR_UNSTABLE);
        bool named = strstr(error.message, "that was set on node") != NULL;
        if (named != (force[k] == 60) || strstr(error.message, "tool"))
            fail_msg("%s", error.message);
        finish(simulation, model);
    }
}

/* Of two forces, one of them next to nothing, it is the other that tears, though it is farther. */
static void the_larger_force_is_named(void **unused) {
    (void)unused;
    lar_model *model = make(false);
    lar_error error = {0};
    lar_simulation *simulation = start(model);
    const int32_t corner = corner_node();
    for (int32_t node = 0; node < LAR_FORCES_MAX; node++) {
        int32_t other = brick_node(&body, 6 - node / 30, node / 5 % 6, node % 5);
        if (other != corner) set_at(simulation, other, 0, 1e-9, 0);
    }
    set_at(simulation, corner, 0, -60, 0);
    assert_int_equal(lar_simulation_advance(simulation, 2000, &error), LAR_ERROR_UNSTABLE);
    if (!strstr(error.message, "the force of 60 N that was set on node"))
        fail_msg("%s", error.message);
    finish(simulation, model);
}

/* Nor is it a ball that hardly touches where a force tears, though that is nearer. */
static void a_light_touch_is_not_named(void **unused) {
    (void)unused;
    lar_model *model = make(false);
    lar_error error = {0};
    add_tool(model, "ball", LAR_TOOL_SPHERE, 0.07, 0.005, 0.005);
    lar_simulation *simulation = start(model);
    place_tool(simulation, 0, 0.067, 0.005, 0.005, 1, 100);
    advance(simulation, 400);
    lar_tool_force felt;
    assert_int_equal(lar_simulation_tool_force(simulation, 0, &felt, &error), LAR_OK);
    assert_true(felt.force[0] > 1e-3 && felt.force[0] < 1e-2);
    set_at(simulation, corner_node(), 10, 0, 0);
    assert_int_equal(lar_simulation_advance(simulation, 2000, &error), LAR_ERROR_UNSTABLE);
    if (!strstr(error.message, "the force of 10 N that was set on node"))
        fail_msg("%s", error.message);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(they_are_loads_of_the_model),
                                       cmocka_unit_test(they_end_when_they_are_removed),
                                       cmocka_unit_test(what_makes_no_sense_is_refused),
                                       cmocka_unit_test(every_joule_is_accounted_for),
                                       cmocka_unit_test(the_hash_is_the_same_everywhere),
                                       cmocka_unit_test(processes_agree),
                                       cmocka_unit_test(a_run_goes_on_with_its_forces),
                                       cmocka_unit_test(a_damaged_one_is_refused),
                                       cmocka_unit_test(a_file_knows_its_sets),
                                       cmocka_unit_test(what_tears_is_named),
                                       cmocka_unit_test(what_counts_for_nothing_is_not_named),
                                       cmocka_unit_test(the_larger_force_is_named),
                                       cmocka_unit_test(a_light_touch_is_not_named)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
