/* Supports that are set and released while a simulation runs: they do what supports of the model
 * do, nothing jumps, every joule is accounted for, and the bits are the same on every grid, between
 * processes, and through checkpoints and states in memory. */
#include "simulation/checkpoint.h"
#include "engine/engine_test.h"
#include "engine/changes_test.h"
#include "engine/tool_contact_test.h"

#define PATH LAR_TEST_BUILD "/supports.checkpoint"

static const brick body = {{6, 5, 4}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

static void name(lar_model *model, const char *set, lar_node_list nodes) {
    lar_error error;
    assert_int_equal(
        lar_mesh_add_set(&model->mesh, set, LAR_SET_NODES, nodes.node, nodes.count, &error),
        LAR_OK);
}

/* Heavy, with the ends "left" and "right", of which the left one may be fixed. */
static lar_model *make(bool fixed) {
    lar_model *model = brick_model(&body);
    lar_error error;
    if (fixed) fix_nodes(model, brick_side(&body, 0, 0), LAR_AXIS_ALL);
    model->damping = 3;
    model->gravity[2] = -5;
    assert_int_equal(lar_mesh_add_set(&model->mesh, "faces", LAR_SET_FACES,
                                      lar_calloc(1, sizeof(int32_t)), 1, &error),
                     LAR_OK);
    name(model, "left", brick_side(&body, 0, 0));
    name(model, "right", brick_side(&body, 0, -1));
    return model;
}

static void set_on(lar_simulation *simulation, const char *set, unsigned axes, int held) {
    lar_error error;
    if (lar_simulation_set_support_on(simulation, set, axes, held, &error))
        fail_msg("%s", error.message);
}

static void set_at(lar_simulation *simulation, int32_t node, unsigned axes, int held) {
    lar_error error;
    if (lar_simulation_set_support(simulation, node, axes, held, &error))
        fail_msg("%s", error.message);
}

static int32_t right_node(void) {
    return brick_node(&body, 6, 2, 2);
}

/* ---- what they do --------------------------------------------------------------------------- */

/* Set before the first step, and released before it. */
static void they_are_supports_of_the_model(void **unused) {
    (void)unused;
    for (int fixed = 0; fixed < 2; fixed++) {
        uint64_t hash[2];
        lar_energy energy[2];
        for (int set = 0; set < 2; set++) {
            lar_model *model = make(fixed != set);
            lar_simulation *simulation = start(model);
            if (set) set_on(simulation, "left", LAR_AXIS_ALL, fixed);
            /* A model's nodes are half a step before the start as its supports let them be. */
            memset(simulation->state.v, 0, 3 * simulation->state.stride * sizeof(double));
            advance(simulation, 400);
            hash[set] = lar_simulation_hash(simulation);
            lar_simulation_energy(simulation, &energy[set]);
            assert_int_equal(lar_simulation_support(simulation, 0), fixed ? LAR_AXIS_ALL : 0);
            finish(simulation, model);
        }
        assert_int_equal(hash[0], hash[1]);
        assert_true(energy[0].kinetic == energy[1].kinetic && energy[0].kinetic > 0);
        assert_below(fabs(energy[0].external - energy[1].external), 1e-12 * energy[0].kinetic);
        assert_below(fabs(energy[0].damping - energy[1].damping), 1e-12 * energy[0].kinetic);
    }
}

/* What its support exerts on a node. */
static void borne(lar_simulation *simulation, int32_t node, double force[3]) {
    double(*all)[3] = lar_calloc((size_t)simulation->domain.model->mesh.node_count, sizeof *all);
    assert_int_equal(lar_simulation_nodal_forces(simulation, LAR_CAUSE_SUPPORTS, 0, all, NULL),
                     LAR_OK);
    memcpy(force, all[node], sizeof *all);
    free(all);
}

/* Held in full motion: it stops there, to the last bit, on these axes; and goes on from rest. */
static void a_held_node_stays_where_it_is(void **unused) {
    (void)unused;
    lar_model *model = make(true);
    lar_simulation *simulation = start(model);
    const int32_t node = right_node();
    advance(simulation, 200);
    double before[3], now[3];
    memcpy(before, node_u(simulation, node), sizeof before);
    assert_true(fabs(node_v(simulation, node)[2]) > 0.01);
    set_at(simulation, node, LAR_AXIS_Z | LAR_AXIS_X, 1);
    assert_int_equal(lar_simulation_support(simulation, node), LAR_AXIS_Z | LAR_AXIS_X);
    for (int i = 0; i < 200; i++) {
        advance(simulation, 1);
        memcpy(now, node_u(simulation, node), sizeof now);
        assert_true(now[0] == before[0] && now[2] == before[2]);
        assert_true(node_v(simulation, node)[2] == 0);
    }
    assert_true(now[1] != before[1]);
    double force[3];
    borne(simulation, node, force);
    assert_true(force[2] != 0 && force[1] == 0);
    set_at(simulation, node, LAR_AXIS_X, 0); /* on the other axis it stays */
    advance(simulation, 50);
    assert_true(node_u(simulation, node)[2] == before[2]);
    assert_true(node_u(simulation, node)[0] != before[0]);
    double dt = lar_simulation_time_step(simulation);
    double mass = simulation->domain.mass[simulation->domain.layout.local[node]];
    borne(simulation, node, force);
    set_at(simulation, node, LAR_AXIS_ALL, 0);
    assert_int_equal(simulation->tools.supports.count, 0); /* as if nothing had been set */
    advance(simulation, 1);
    assert_below(fabs(node_u(simulation, node)[2] - before[2] + force[2] * dt * dt / mass),
                 0.01 * fabs(force[2]) * dt * dt / mass);
    finish(simulation, model);
}

/* What hung falls, with all of its weight and from where it is. */
static void a_released_body_falls(void **unused) {
    (void)unused;
    lar_model *model = make(true);
    model->damping = 0;
    lar_simulation *simulation = start(model);
    double momentum[2], dt = lar_simulation_time_step(simulation), mass = 0;
    advance(simulation, 300);
    set_on(simulation, "left", LAR_AXIS_ALL, 0);
    for (int k = 0; k < 2; k++) {
        momentum[k] = mass = 0;
        for (int32_t n = 0; n < model->mesh.node_count; n++) {
            double own = simulation->domain.mass[simulation->domain.layout.local[n]];
            momentum[k] += own * node_v(simulation, n)[2];
            mass += own;
        }
        if (k == 0) advance(simulation, 100);
    }
    assert_below(fabs((momentum[1] - momentum[0]) / (-5 * mass * 100 * dt) - 1), 1e-9);
    finish(simulation, model);
}

/* What moves along a curve stops where it is held, and flies on with its speed when released. */
static void what_moves_is_stopped_and_let_go(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&body);
    int ramp = add_table(model, 0, 2, (const double[][2]){{0, 0}, {1, 1}});
    move_nodes(model, brick_side(&body, 0, -1), LAR_AXIS_Z, 0.1, ramp);
    name(model, "right", brick_side(&body, 0, -1));
    const int32_t node = right_node();
    lar_simulation *simulation = start(model);
    advance(simulation, 100);
    double before = node_u(simulation, node)[2];
    set_on(simulation, "right", LAR_AXIS_Z, 1);
    advance(simulation, 50);
    assert_true(node_u(simulation, node)[2] == before);
    assert_int_equal(lar_simulation_reset(simulation, NULL), LAR_OK);
    assert_int_equal(simulation->tools.supports.count, 0);
    advance(simulation, 100);
    assert_true(node_u(simulation, node)[2] == before);
    assert_below(fabs(node_v(simulation, node)[2] - 0.1), 1e-9);
    set_at(simulation, node, LAR_AXIS_Z, 0);
    assert_int_equal(lar_simulation_support(simulation, node), 0);
    advance(simulation, 1);
    double speed = node_v(simulation, node)[2];
    assert_true(speed != 0.1 && fabs(speed - 0.1) < 0.01);
    finish(simulation, model);
}

/* The last one that names an axis of a node counts. */
static void the_last_word_counts(void **unused) {
    (void)unused;
    lar_model *model = make(true);
    lar_simulation *simulation = start(model);
    set_on(simulation, "right", LAR_AXIS_ALL, 1);
    set_at(simulation, right_node(), LAR_AXIS_Y | LAR_AXIS_Z, 0);
    assert_int_equal(lar_simulation_support(simulation, right_node()), LAR_AXIS_X);
    set_on(simulation, "right", LAR_AXIS_Y, 1);
    assert_int_equal(lar_simulation_support(simulation, right_node()), LAR_AXIS_X | LAR_AXIS_Y);
    assert_int_equal(simulation->tools.supports.count, 3);
    set_on(simulation, "right", LAR_AXIS_ALL, 0);
    assert_int_equal(lar_simulation_support(simulation, right_node()), 0);
    set_at(simulation, right_node(), LAR_AXIS_ALL, 0);
    assert_int_equal(simulation->tools.supports.count, 0);
    set_on(simulation, "left", LAR_AXIS_X, 0);
    set_on(simulation, "left", LAR_AXIS_X, 1);
    assert_int_equal(simulation->tools.supports.count, 1);
    assert_int_equal(lar_simulation_support(simulation, -1), 0);
    assert_int_equal(lar_simulation_support(simulation, 100000), 0);
    assert_int_equal(lar_simulation_support(NULL, 0), 0);
    finish(simulation, model);
}

static void what_makes_no_sense_is_refused(void **unused) {
    (void)unused;
    lar_model *model = make(true);
    lar_simulation *simulation = start(model);
    const lar_tools before = simulation->tools;
    lar_error error;
#define REFUSED(call, part)                                                                        \
    assert_int_equal(call, LAR_ERROR_ARGUMENT);                                                    \
    assert_non_null(strstr(error.message, part))
    REFUSED(lar_simulation_set_support(NULL, 0, 7, 1, &error), "lar_simulation_set_support");
    REFUSED(lar_simulation_set_support(simulation, -1, 7, 1, &error), "no node -1");
    REFUSED(lar_simulation_set_support(simulation, 100000, 7, 0, &error), "no node 100000");
    REFUSED(lar_simulation_set_support(simulation, 1, 0, 1, &error), "axes 0");
    REFUSED(lar_simulation_set_support(simulation, 1, 8, 1, &error), "axes 8");
    REFUSED(lar_simulation_set_support_on(simulation, "faces", 7, 1, &error), "'faces'");
    REFUSED(lar_simulation_set_support_on(simulation, NULL, 7, 1, &error), "no set of nodes");
    assert_memory_equal(&before, &simulation->tools, sizeof before);
    for (int32_t n = 0; n < LAR_SUPPORTS_MAX; n++) set_at(simulation, n, 7, 1);
    set_at(simulation, 5, 7, 1);
    REFUSED(lar_simulation_set_support(simulation, 209, 7, 1, &error), "128");
    set_at(simulation, 1, 7, 0);
    set_at(simulation, 209, 7, 1);
    finish(simulation, model);
}

/* What is told of nodes one by one is what all of them are marked with. */
static void what_is_told_is_so(void **unused) {
    (void)unused;
    lar_model *model = make(true);
    move_nodes(model, brick_side(&body, 0, -1), LAR_AXIS_Z, 0.01, add_ramp(model, 1));
    lar_simulation *simulation = start(model);
    uint8_t *mark = lar_calloc((size_t)model->mesh.node_count, 1);
    for (uint32_t i = 0; i < 60; i++) {
        unsigned axes = 1 + i * 5 % 7;
        if (i % 3 == 0)
            set_on(simulation, i % 2 ? "left" : "right", axes, i % 5 > 1);
        else
            set_at(simulation, (int32_t)(i * 37 % 210), axes, i % 5 > 1);
        lar_supports_mark(&simulation->tools.supports, model, mark);
        for (int32_t n = 0; n < model->mesh.node_count; n++)
            assert_int_equal(lar_simulation_support(simulation, n), mark[n] & LAR_AXIS_ALL);
    }
    free(mark);
    finish(simulation, model);
}

/* ---- energy --------------------------------------------------------------------------------- */

static void change_often(lar_simulation *simulation, int i) {
    if (i % 10 == 2) set_on(simulation, "right", 1u + (unsigned)i % 7, 1);
    if (i % 10 == 5) set_at(simulation, right_node(), LAR_AXIS_ALL, i % 20 == 5);
    if (i % 10 == 7) set_on(simulation, "right", LAR_AXIS_ALL, 0);
}

static void change_all(lar_simulation *simulation, int i) {
    change_often(simulation, i);
    if (i == 60) set_on(simulation, "left", LAR_AXIS_ALL, 0);
    if (i == 90) set_on(simulation, "left", LAR_AXIS_ALL, 1);
}

/* Held and released again and again, in a body that swings; also in steps of two parts. */
static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1", NULL};
    for (int way = 0; way < 3; way++) {
        lar_model *model = make(true);
        lar_options options = lar_options_default();
        options.time_step = way < 2 ? 5e-5 : 7e-4;
        options.grid = grids[way];
        lar_simulation *simulation = start_with(model, options);
        if (way == 2) assert_int_equal(lar_simulation_set_stiffness(simulation, -1, 4, NULL), 0);
        assert_below(changed_account(simulation, way < 2 ? change_all : change_often), 3e-4);
        assert_true((lar_simulation_divided_steps(simulation, NULL) == 2000) == (way == 2));
        finish(simulation, model);
    }
}

/* Fixed above a plane, released, held on it and released again. */
static lar_model *over_a_plane(void) {
    lar_model *model = make(false);
    model->damping = 0.1;
    fix_nodes(model, brick_side(&body, 2, 0), LAR_AXIS_ALL);
    name(model, "low", brick_side(&body, 2, 0));
    add_plane(model, (double[]){0, 0, -0.003}, (double[]){0.1, 0, 1});
    model->contact[model->contact_count - 1].friction = 0.3;
    return model;
}

static void a_plane_stops_what_is_released(void **unused) {
    (void)unused;
    lar_model *model = over_a_plane();
    lar_simulation *simulation = start(model);
    double lowest = 0, worst = 0;
    for (int i = 0; i < 200; i++) {
        lar_energy e;
        advance(simulation, 10);
        if (i == 10) set_on(simulation, "low", LAR_AXIS_ALL, 0);
        if (i == 120) set_on(simulation, "low", LAR_AXIS_X | LAR_AXIS_Y, 1);
        if (i == 160) set_on(simulation, "low", LAR_AXIS_ALL, 0);
        for (int32_t n = 0; n < model->mesh.node_count; n++) {
            const double *u = node_u(simulation, n), *x = model->mesh.position[n];
            lowest = fmin(lowest, 0.1 * (x[0] + u[0]) + x[2] + u[2] + 0.003);
        }
        lar_simulation_energy(simulation, &e);
        worst = fmax(worst,
                     fabs(e.kinetic + e.strain + e.hourglass + e.damping + e.contact - e.external));
    }
    lar_contact_info info;
    lar_simulation_contact(simulation, &info);
    print_message("lowest %.3g m, %.2g J astray, %d nodes touch\n", lowest, worst,
                  (int)info.touching);
    assert_true(info.touching > 0);
    assert_true(lowest > -1e-9);
    finish(simulation, model);
}

/* ---- the same bits -------------------------------------------------------------------------- */

enum { PARTS = 6 };

static void change(lar_simulation *simulation, int i) {
    if (i == 1) set_on(simulation, "right", LAR_AXIS_Y | LAR_AXIS_Z, 1);
    if (i == 1) set_on(simulation, "low", LAR_AXIS_ALL, 0);
    if (i == 2) set_at(simulation, right_node(), LAR_AXIS_ALL, 0);
    if (i == 3) set_at(simulation, brick_node(&body, 3, 2, 4), LAR_AXIS_ALL, 1);
    if (i == 4) set_on(simulation, "right", LAR_AXIS_ALL, 0);
    if (i == 4) set_on(simulation, "left", LAR_AXIS_X, 1);
    if (i == 5) set_at(simulation, brick_node(&body, 0, 2, 2), LAR_AXIS_ALL, 0);
    /* And what else may change. */
    if (i == 2) lar_simulation_set_force(simulation, 7, (const double[]){0, 0.01, 0}, NULL);
    if (i == 3) assert_int_equal(lar_simulation_set_stiffness(simulation, -1, 3, NULL), LAR_OK);
}

static const changed_run changed = {over_a_plane, change, PARTS, 37, 1, true, PATH};

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
    return simulation->tools.supports.count > 0 ? 14 : 6;
}

static void set_another(lar_simulation *simulation) {
    set_at(simulation, 3, LAR_AXIS_ALL, 1);
}

static void a_run_goes_on_with_its_supports(void **unused) {
    (void)unused;
    check_changed_goes_on(&changed, set_another, version);
}

static void a_clone_has_them(void **unused) {
    (void)unused;
    lar_model *model = over_a_plane();
    uint64_t wanted = changed_straight(&changed, model);
    for (int part = 1; part < PARTS; part++) {
        lar_simulation *first = start(model), *second = NULL;
        run_changed(&changed, first, 0, part);
        assert_int_equal(lar_simulation_clone(first, &second, NULL), LAR_OK);
        run_changed(&changed, second, part, PARTS);
        assert_int_equal(lar_simulation_hash(second), wanted);
        lar_simulation_destroy(first);
        lar_simulation_destroy(second);
    }
    lar_model_destroy(model);
}

/* With a tool that was added, too: version 15. And no damage goes unnoticed. */
static void a_damaged_one_is_refused(void **unused) {
    (void)unused;
    lar_model *model = make(true);
    lar_options options = lar_options_default();
    options.spares = 1;
    lar_simulation *simulation = start_with(model, options);
    const lar_tool_info sphere = {.shape = LAR_TOOL_SPHERE, .radius = 0.01};
    lar_bytes bytes;
    lar_error error;
    set_at(simulation, 3, LAR_AXIS_ALL, 1);
    set_on(simulation, "right", LAR_AXIS_Z, 1);
    assert_int_equal(lar_simulation_add_tool(simulation, &sphere, NULL, &error), LAR_OK);
    advance(simulation, 10);
    assert_int_equal(lar_simulation_save(simulation, PATH, NULL), LAR_OK);
    assert_int_equal(changed_version(PATH), 15);
    assert_int_equal(lar_simulation_load(simulation, PATH, &error), LAR_OK);
    assert_int_equal(simulation->tools.supports.count, 2);
    assert_int_equal(lar_checkpoint_read(PATH, &bytes, &error), LAR_OK);
    /* Behind no forces and no strained elements. */
    const size_t supports = 144 + 56 + 1064 + 4 * 104 + 8 + 24;
    /* Their number, its padding, then of; on_set, axes, held and padding of each: the first set is
     * one of faces, and there are three. */
    static const struct {
        size_t at;
        int32_t value;
    } damage[] = {{0, -1},          {0, 129},         {0, 1},           {0, 3},
                  {0, 0},           {4, 1},           {8, -1},          {8, 1 << 20},
                  {12, 0x00010002}, {12, 0x00010700}, {12, 0x00010000}, {12, 0x00010800},
                  {12, 0x00020700}, {12, 0x01010700}, {16, 0},          {16, 3}};
    for (size_t i = 0; i < sizeof damage / sizeof *damage; i++) {
        lar_checkpoint checkpoint;
        lar_bytes bad = {lar_calloc(bytes.size, 1), bytes.size};
        memcpy(bad.data, bytes.data, bytes.size);
        memcpy(bad.data + supports + damage[i].at, &damage[i].value, sizeof damage[i].value);
        uint64_t sum = lar_checkpoint_sum(bad.data, bad.size / 8 - 1);
        memcpy(bad.data + bad.size - 8, &sum, sizeof sum);
        bool sound = damage[i].value == 0x00010700; /* as it is */
        assert_int_equal(lar_checkpoint_parse(PATH, &bad, &simulation->domain, &checkpoint, &error),
                         sound ? LAR_OK : LAR_ERROR_FORMAT);
        lar_bytes_free(&bad);
    }
    lar_bytes_free(&bytes);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(they_are_supports_of_the_model),
                                       cmocka_unit_test(a_held_node_stays_where_it_is),
                                       cmocka_unit_test(a_released_body_falls),
                                       cmocka_unit_test(what_moves_is_stopped_and_let_go),
                                       cmocka_unit_test(the_last_word_counts),
                                       cmocka_unit_test(what_makes_no_sense_is_refused),
                                       cmocka_unit_test(what_is_told_is_so),
                                       cmocka_unit_test(every_joule_is_accounted_for),
                                       cmocka_unit_test(a_plane_stops_what_is_released),
                                       cmocka_unit_test(the_hash_is_the_same_everywhere),
                                       cmocka_unit_test(processes_agree),
                                       cmocka_unit_test(a_run_goes_on_with_its_supports),
                                       cmocka_unit_test(a_clone_has_them),
                                       cmocka_unit_test(a_damaged_one_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
