/* Gravity, damping and stiffness that are changed while a simulation runs: their effect is that of
 * a model that had them from the start, every joule is accounted for, and the bits are the same on
 * every grid, with every backend, and through checkpoints. */
#include "simulation/checkpoint.h"
#include "engine/engine_test.h"
#include "engine/changes_test.h"
#include "engine/tools_test.h"

#define PATH LAR_TEST_BUILD "/settings.checkpoint"

static void set_gravity(lar_simulation *simulation, double x, double y, double z) {
    lar_error error;
    const double gravity[3] = {x, y, z};
    if (lar_simulation_set_gravity(simulation, gravity, &error)) fail_msg("%s", error.message);
}

static void set_damping(lar_simulation *simulation, double damping) {
    lar_error error;
    if (lar_simulation_set_damping(simulation, damping, &error)) fail_msg("%s", error.message);
}

static void set_stiffness(lar_simulation *simulation, int32_t material, double factor) {
    lar_error error;
    if (lar_simulation_set_stiffness(simulation, material, factor, &error))
        fail_msg("%s", error.message);
}

/* ---- what they do --------------------------------------------------------------------------- */

/* Velocities are those of half a step before: g counts for every step since it was set. */
static void a_falling_body_falls_as_gravity_says(void **unused) {
    (void)unused;
    brick b = soft_brick;
    b.shift = 0;
    lar_model *model = brick_model(&b);
    lar_simulation *simulation = start(model);
    double dt = lar_simulation_time_step(simulation), g[3];
    advance(simulation, 50);
    assert_true(node_v(simulation, 5)[2] == 0);
    set_gravity(simulation, 0, 0, -5);
    advance(simulation, 100);
    assert_below(fabs(node_v(simulation, 5)[2] + 5 * 100 * dt), 1e-9);
    lar_simulation_gravity(simulation, g);
    assert_true(g[0] == 0 && g[2] == -5);
    set_gravity(simulation, 3, 0, 0);
    advance(simulation, 40);
    assert_below(fabs(node_v(simulation, 5)[0] - 3 * 40 * dt), 1e-9);
    assert_below(fabs(node_v(simulation, 5)[2] + 5 * 100 * dt), 1e-9);
    assert_int_equal(lar_simulation_set_gravity(simulation, NULL, NULL), LAR_OK);
    lar_simulation_gravity(simulation, g);
    assert_true(g[0] == 0 && g[2] == 0);
    finish(simulation, model);
}

static void damping_slows_as_it_says(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    throw_body(model, (double[]){0.4, 0, 0}, (double[]){0, 0, 0}, 0);
    lar_simulation *simulation = start(model);
    double dt = lar_simulation_time_step(simulation), before, c = 10;
    advance(simulation, 20);
    assert_below(fabs(node_v(simulation, 3)[0] - 0.4), 1e-12);
    set_damping(simulation, c);
    before = node_v(simulation, 3)[0];
    advance(simulation, 200);
    double slower = pow((1 - 0.5 * c * dt) / (1 + 0.5 * c * dt), 200);
    assert_below(fabs(node_v(simulation, 3)[0] - slower * before), 1e-12);
    assert_below(fabs(slower - exp(-c * 200 * dt)), 1e-3);
    assert_true(lar_simulation_damping(simulation) == c);
    set_damping(simulation, 0);
    before = node_v(simulation, 3)[0];
    advance(simulation, 200);
    assert_below(fabs(node_v(simulation, 3)[0] - before), 1e-12);
    finish(simulation, model);
}

/* Zero crossings of the tip of a held bar per second. */
static double frequency(double factor) {
    brick b = {{8, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    lar_model *model = brick_model(&b);
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
    int32_t tip = brick_node(&b, 8, 1, 1);
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        throw_node(model, n, (double[]){0, 0.02 * pow(model->mesh.position[n][0] / 0.08, 2), 0});
    lar_simulation *simulation = start(model);
    set_stiffness(simulation, -1, factor);
    double first = 0, last = 0, before = 1e-9;
    int crossings = 0;
    while (lar_simulation_time(simulation) < 3) {
        advance(simulation, 1);
        double now = node_u(simulation, tip)[1];
        if (now * before < 0) {
            double time = lar_simulation_time(simulation) -
                          lar_simulation_time_step(simulation) * now / (now - before);
            if (crossings++ == 0) first = time;
            last = time;
        }
        if (now != 0) before = now;
    }
    finish(simulation, model);
    return 0.5 * (crossings - 1) / (last - first);
}

static void frequencies_grow_with_the_root_of_stiffness(void **unused) {
    (void)unused;
    double usual = frequency(1), stiffer = frequency(4), softer = frequency(0.25);
    print_message("%.3f Hz, stiffer %.3f, softer %.3f\n", usual, stiffer, softer);
    assert_below(fabs(stiffer / usual - 2), 0.01);
    assert_below(fabs(softer / usual - 0.5), 0.005);
}

/* As a model whose materials are that stiff, but for the rounding of forces. */
static void a_stiffer_body_is_that_of_a_stiffer_model(void **unused) {
    (void)unused;
    for (int kind = 0; kind <= LAR_ELEMENT_HEX8_MATRIX; kind++)
        for (int i = 0; i < 2; i++) {
            double factor = i ? 0.3 : 1.9, u[2] = {0};
            brick b = soft_brick;
            for (int changed = 0; changed < 2; changed++) {
                lar_model *model = everything_model(&b);
                for (int m = 0; m < model->material_count && !changed; m++)
                    for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
                        if (lar_law_scales(model->material[m].law, k))
                            model->material[m].parameter[k] *= factor;
                lar_options options = lar_options_default();
                options.element = (lar_element_kind)kind;
                options.time_step = 2e-4;
                lar_simulation *simulation = start_with(model, options);
                if (changed) set_stiffness(simulation, -1, factor);
                advance(simulation, 200);
                u[changed] = node_u(simulation, brick_node(&b, 2, 1, 1))[1];
                assert_int_equal(lar_simulation_step_parts(simulation), 1);
                finish(simulation, model);
            }
            assert_true(fabs(u[0]) > 1e-5);
            assert_below(fabs(u[1] / u[0] - 1), 1e-7);
        }
}

/* One of two materials; the other half of the bar is as it was. */
static void materials_are_stiffer_one_by_one(void **unused) {
    (void)unused;
    brick b = {{12, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    lar_model *model = brick_model(&b);
    lar_material *other = LAR_MODEL_APPEND(model, material);
    *other = model->material[0];
    other->name = lar_strdup("other");
    for (int32_t e = 0; e < model->mesh.element_count; e++)
        model->element_material[e] = e % 12 >= 6;
    int ramp = add_ramp(model, 0.1);
    model->damping = 30;
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
    load_nodes(model, brick_side(&b, 0, -1), 0.002, 0, 0, ramp);
    lar_simulation *simulation = start(model);
    set_stiffness(simulation, 1, 3);
    assert_true(lar_simulation_stiffness(simulation, 0) == 1);
    assert_true(lar_simulation_stiffness(simulation, 1) == 3);
    assert_true(lar_simulation_stiffness(simulation, 2) == 0);
    while (lar_simulation_time(simulation) < 1.5) advance(simulation, 10);
    /* Strains away from the ends. */
    double soft = node_u(simulation, brick_node(&b, 4, 1, 1))[0] -
                  node_u(simulation, brick_node(&b, 3, 1, 1))[0];
    double hard = node_u(simulation, brick_node(&b, 9, 1, 1))[0] -
                  node_u(simulation, brick_node(&b, 8, 1, 1))[0];
    print_message("strains %.3g and %.3g\n", soft / b.edge, hard / b.edge);
    assert_true(soft > 5e-5);
    assert_below(fabs(soft / hard - 3), 0.2);
    finish(simulation, model);
}

/* ---- steps ---------------------------------------------------------------------------------- */

/* With a step near the limit of the model as it is. */
static void a_stiffer_body_stays_stable(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
    throw_body(model, (double[]){0, 0, 0}, (double[]){0, 1, 0}, 0.05);
    model->damping = 2;
    lar_simulation *simulation = start_near_limit(model, 0.97);
    lar_energy before, after;
    advance(simulation, 101); /* in the middle of an interval */
    lar_simulation_energy(simulation, &before);
    set_stiffness(simulation, 0, 4);
    advance(simulation, 3);
    assert_int_equal(lar_simulation_step_parts(simulation), 2);
    advance(simulation, 2000);
    lar_simulation_energy(simulation, &after);
    assert_below(after.kinetic + after.strain + after.hourglass,
                 4 * (before.kinetic + before.strain + before.hourglass));
    set_stiffness(simulation, -1, 0.8);
    advance(simulation, 1);
    assert_int_equal(lar_simulation_step_parts(simulation), 2);
    advance(simulation, (uint64_t)(1.01 / lar_simulation_time_step(simulation)));
    assert_int_equal(lar_simulation_step_parts(simulation), 1);
    advance(simulation, 500);
    finish(simulation, model);
}

/* Whoever seeks a stiffness goes to and fro: were steps divided and undivided with it, fast modes
 * had thousands of times their energy (before December 2026). */
static void switching_to_and_fro_gives_nothing(void **unused) {
    (void)unused;
    static const double factor[] = {1 + 1e-9, 1.02, 1.04};
    for (int i = 0; i < 3; i++) {
        const brick b = {{10, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 3e3, 3e4, 1000};
        lar_model *model = brick_model(&b);
        lar_energy e, began;
        fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
        throw_body(model, (double[]){0, 0, 0}, (double[]){0, 1, 0}, 0.05);
        lar_simulation *simulation = start(model);
        advance(simulation, 1);
        lar_simulation_energy(simulation, &began);
        for (int k = 0; k < 400; k++) {
            set_stiffness(simulation, -1, k % 2 ? 1 : factor[i]);
            advance(simulation, 10);
        }
        lar_simulation_energy(simulation, &e);
        const double share =
            (e.kinetic + e.strain + e.hourglass) / (began.kinetic + began.strain + began.hourglass);
        print_message("%.9g: %.4f of its energy, %d parts\n", factor[i], share,
                      (int)lar_simulation_step_parts(simulation));
        assert_true(share > 0.9 && share < (i ? 1.2 : 1.001));
        finish(simulation, model);
    }
}

/* A force before gravity or behind it, and as a load of the scene: the same bits. */
static void what_is_set_first_has_no_order(void **unused) {
    (void)unused;
    const double force[3] = {0.01, 0.02, -0.01}, pull[3] = {0, 1, -4};
    uint64_t hash[3];
    for (int k = 0; k < 3; k++) {
        lar_model *model = brick_model(&soft_brick);
        if (k == 2)
            load_nodes(model, single_node(3), force[0], force[1], force[2], add_ramp(model, 0));
        if (k == 2) memcpy(model->gravity, pull, sizeof pull);
        lar_simulation *simulation = start(model);
        if (k == 0) lar_simulation_set_force(simulation, 3, force, NULL);
        if (k < 2) lar_simulation_set_gravity(simulation, pull, NULL);
        if (k == 1) lar_simulation_set_force(simulation, 3, force, NULL);
        advance(simulation, 30);
        hash[k] = lar_simulation_hash(simulation);
        finish(simulation, model);
    }
    assert_true(hash[0] == hash[1]);
    assert_true(hash[0] == hash[2]);
}

static void what_makes_no_sense_is_refused(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    lar_simulation *simulation = start(model);
    static const double bad_factor[] = {0, -1, 0.05, 4.01, INFINITY, NAN};
    static const double bad_damping[] = {-1, 1e9, INFINITY, NAN};
    static const double bad_gravity[][3] = {{1000, 1, 0}, {NAN, 0, 0}, {0, -INFINITY, 0}};
    const lar_tools before = simulation->tools;
    lar_error error;
    for (int i = 0; i < 6; i++) {
        assert_int_equal(lar_simulation_set_stiffness(simulation, -1, bad_factor[i], &error),
                         LAR_ERROR_ARGUMENT);
        assert_non_null(strstr(error.message, "0.1 to 4"));
    }
    assert_int_equal(lar_simulation_set_stiffness(simulation, 1, 1, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "there is no material 1"));
    for (int i = 0; i < 4; i++) {
        assert_int_equal(lar_simulation_set_damping(simulation, bad_damping[i], &error),
                         LAR_ERROR_ARGUMENT);
        assert_non_null(strstr(error.message, "less than"));
    }
    for (int i = 0; i < 3; i++)
        assert_int_equal(lar_simulation_set_gravity(simulation, bad_gravity[i], &error),
                         LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_set_damping(NULL, 1, &error), LAR_ERROR_ARGUMENT);
    assert_memory_equal(&before, &simulation->tools, sizeof before);
    finish(simulation, model);
}

/* ---- energy --------------------------------------------------------------------------------- */

static void change_often(lar_simulation *simulation, int i) {
    if (i % 10 == 2) set_gravity(simulation, 0, 30, -10.0 * (i % 3));
    if (i % 20 == 8) lar_simulation_set_gravity(simulation, NULL, NULL);
    if (i % 10 == 4) set_damping(simulation, i % 20);
    if (i % 10 == 6) set_stiffness(simulation, i % 3, i % 20 == 6 ? 1.5 : 0.4);
    if (i % 30 == 7) set_stiffness(simulation, -1, 1);
}

/* All of them changed again and again, in a body that moves. */
static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    for (int kind = LAR_ELEMENT_HEX8; kind <= LAR_ELEMENT_HEX8_FULL; kind++)
        for (int grid = 0; grid < 2; grid++) {
            brick b = soft_brick;
            lar_model *model = everything_model(&b);
            for (int i = 1; i < 3; i++) model->gravity_curve[i] = model->gravity_curve[0];
            lar_options options = lar_options_default();
            options.element = (lar_element_kind)kind;
            options.time_step = 5e-5;
            options.grid = grid ? "2x1x1" : NULL;
            lar_simulation *simulation = start_with(model, options);
            assert_below(changed_account(simulation, change_often), 3e-4);
            finish(simulation, model);
        }
}

/* ---- the same bits -------------------------------------------------------------------------- */

static const brick larger = {{6, 5, 4}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

/* What is done before the steps of part `i` of a run, at odd steps, in the middle of intervals. */
static void change(lar_simulation *simulation, int i) {
    if (i == 1) set_gravity(simulation, 1, 2, -3);
    if (i == 2) set_stiffness(simulation, -1, 3.7);
    if (i == 3) set_damping(simulation, 11);
    if (i == 4) set_stiffness(simulation, 1, 0.2);
    if (i == 5) assert_int_equal(lar_simulation_set_gravity(simulation, NULL, NULL), LAR_OK);
    if (i == 6) set_stiffness(simulation, -1, 1);
}

static lar_model *everything(void) {
    return everything_model(&larger);
}

static const changed_run changed = {everything, change, 8, 13, 1, true, PATH};

static void the_hash_is_the_same_everywhere(void **unused) {
    (void)unused;
    changed_run every = changed;
    every.grid_stride = test_every(2);
    check_changed_everywhere(&every);
}

static void processes_agree(void **unused) {
    (void)unused;
    check_changed_in_processes(&changed);
}

/* With instruments that press, are kept back, and hold. */
static void tools_feel_the_same_everywhere(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1", "2x2x1", "1x2x3"};
    lar_model *model = tool_model();
    lar_tool_force force[2][TEST_TOOLS];
    uint64_t hash[2];
    for (int grid = 0; grid < 4; grid++) {
        lar_options options = lar_options_default();
        options.grid = grids[grid];
        options.hands = 1;
        lar_simulation *simulation = start_with(model, options);
        for (int tick = 0; tick < 20; tick++) {
            if (tick % 3 == 1) change(simulation, 1 + tick / 3);
            act_at(simulation, tick);
            advance(simulation, TICK_STEPS / 2 - 1);
            if (tick == 12) set_stiffness(simulation, -1, 2.5);
            advance(simulation, TICK_STEPS / 2 + 1);
        }
        hash[grid > 0] = lar_simulation_hash(simulation);
        for (int t = 0; t < TEST_TOOLS; t++)
            lar_simulation_tool_force(simulation, t, &force[grid > 0][t], NULL);
        if (grid > 0) {
            assert_int_equal(hash[1], hash[0]);
            assert_memory_equal(force[1], force[0], sizeof force[0]);
        }
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* What a tool bears before it stays behind its hand goes with the tissue. */
static void tools_press_harder_on_stiffer_tissue(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, lar_options_default());
    lar_tool_force usual, softer;
    lar_simulation_tool_force(simulation, TEST_BALL, &usual, NULL);
    set_stiffness(simulation, -1, 0.2);
    lar_simulation_tool_force(simulation, TEST_BALL, &softer, NULL);
    assert_below(softer.limit, 0.6 * usual.limit);
    assert_int_equal(lar_simulation_reset(simulation, NULL), LAR_OK);
    lar_simulation_tool_force(simulation, TEST_BALL, &softer, NULL);
    assert_true(softer.limit == usual.limit);
    finish(simulation, model);
}

static void set_others(lar_simulation *simulation) {
    set_stiffness(simulation, 0, 0.5);
    set_gravity(simulation, 9, 9, 9);
}

static void a_loaded_run_goes_on_with_its_settings(void **unused) {
    (void)unused;
    check_changed_goes_on(&changed, set_others, NULL);
}

static void a_reset_goes_back_to_the_model(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&larger);
    static const char *const grids[] = {NULL, "2x2x1"};
    for (int grid = 0; grid < 2; grid++) {
        lar_options options = lar_options_default();
        options.grid = grids[grid];
        lar_simulation *simulation = start_with(model, options);
        advance(simulation, 40);
        uint64_t wanted = lar_simulation_hash(simulation), begin = 0;
        /* The first time the start is computed, afterwards it is there. */
        for (int again = 0; again < 3; again++) {
            run_changed(&changed, simulation, again, 4);
            assert_int_equal(lar_simulation_reset(simulation, NULL), LAR_OK);
            assert_true(lar_simulation_stiffness(simulation, 0) == 1);
            assert_true(lar_simulation_damping(simulation) == model->damping);
            if (again == 0) begin = lar_simulation_hash(simulation);
            assert_int_equal(lar_simulation_hash(simulation), begin);
            advance(simulation, 40);
            assert_int_equal(lar_simulation_hash(simulation), wanted);
        }
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* What the model says anyway, and what is taken back before a step, leaves no trace. */
static void settings_that_change_nothing_change_no_bit(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&larger);
    for (int i = 0; i < 3; i++) model->gravity_curve[i] = -1;
    lar_simulation *simulation = start(model);
    advance(simulation, 60);
    uint64_t wanted = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    simulation = start(model);
    advance(simulation, 21);
    set_stiffness(simulation, -1, 2.7);
    set_stiffness(simulation, -1, 1);
    set_gravity(simulation, model->gravity[0], model->gravity[1], model->gravity[2]);
    set_damping(simulation, model->damping + 1);
    set_damping(simulation, model->damping);
    advance(simulation, 39);
    assert_int_equal(lar_simulation_hash(simulation), wanted);
    finish(simulation, model);
}

/* ---- files of before ------------------------------------------------------------------------ */

enum {
    HEAD = 144,
    TOOLS = 136,
    DAMPED = 112,
    DIVISION = 56,
    SETTINGS = 552,
    MOTION = 152,
    FOLLOWER = 240
};

static void cut(lar_bytes *bytes, size_t at, size_t count) {
    memmove(bytes->data + at, bytes->data + at + count, bytes->size - at - count);
    bytes->size -= count;
}

/* A checkpoint as version 4 had it: a step had 32 shares where it has 96; or as version 3: without
 * settings, and with damping's sum without damping. */
static void make_older(lar_bytes *bytes, uint32_t version, double damping) {
    int32_t tools;
    memcpy(&tools, bytes->data + TOOLS, sizeof tools);
    size_t first = HEAD + DIVISION + SETTINGS + MOTION * (size_t)tools;
    for (int32_t t = 0; t < tools; t++) {
        size_t at = first + FOLLOWER * (size_t)t;
        for (size_t i = 0; i < 7; i++) {
            int64_t sum;
            memcpy(&sum, bytes->data + at + MOTION + 8 * i, 8);
            assert_int_equal(sum % 3, 0);
            sum /= 3;
            memcpy(bytes->data + at + MOTION + 8 * i, &sum, 8);
        }
    }
    if (version == 3) {
        double damped;
        memcpy(&damped, bytes->data + DAMPED, 8);
        damped /= damping;
        memcpy(bytes->data + DAMPED, &damped, 8);
        cut(bytes, HEAD + DIVISION - 8, 8 + SETTINGS);
    }
    uint64_t size = bytes->size;
    memcpy(bytes->data + 8, &version, 4);
    memcpy(bytes->data + 16, &size, 8);
    uint64_t sum = lar_checkpoint_sum(bytes->data, size / 8 - 1);
    memcpy(bytes->data + size - 8, &sum, 8);
}

static void a_checkpoint_of_before_is_taken_up(uint32_t version) {
    lar_model *model = everything_model(&larger);
    lar_simulation *simulation = start(model);
    advance(simulation, 33);
    lar_energy before, after;
    lar_bytes bytes = {0};
    lar_simulation_energy(simulation, &before);
    assert_int_equal(lar_simulation_pack(simulation, "memory", &bytes, NULL), LAR_OK);
    advance(simulation, 30);
    uint64_t wanted = lar_simulation_hash(simulation);
    make_older(&bytes, version, model->damping);
    lar_error error;
    set_stiffness(simulation, -1, 2);
    if (lar_simulation_unpack(simulation, "memory", &bytes, &error)) fail_msg("%s", error.message);
    lar_simulation_energy(simulation, &after);
    assert_below(fabs(after.damping - before.damping), 1e-9 * before.damping);
    advance(simulation, 30);
    assert_int_equal(lar_simulation_hash(simulation), wanted);
    version = 2;
    memcpy(bytes.data + 8, &version, 4);
    assert_int_equal(lar_simulation_unpack(simulation, "memory", &bytes, &error),
                     LAR_ERROR_UNSUPPORTED);
    lar_bytes_free(&bytes);
    finish(simulation, model);
}

static void checkpoints_of_before_are_taken_up(void **unused) {
    (void)unused;
    a_checkpoint_of_before_is_taken_up(3);
    a_checkpoint_of_before_is_taken_up(4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_falling_body_falls_as_gravity_says),
        cmocka_unit_test(damping_slows_as_it_says),
        cmocka_unit_test(frequencies_grow_with_the_root_of_stiffness),
        cmocka_unit_test(a_stiffer_body_is_that_of_a_stiffer_model),
        cmocka_unit_test(materials_are_stiffer_one_by_one),
        cmocka_unit_test(a_stiffer_body_stays_stable),
        cmocka_unit_test(switching_to_and_fro_gives_nothing),
        cmocka_unit_test(what_is_set_first_has_no_order),
        cmocka_unit_test(what_makes_no_sense_is_refused),
        cmocka_unit_test(every_joule_is_accounted_for),
        cmocka_unit_test(the_hash_is_the_same_everywhere),
        cmocka_unit_test(processes_agree),
        cmocka_unit_test(tools_feel_the_same_everywhere),
        cmocka_unit_test(tools_press_harder_on_stiffer_tissue),
        cmocka_unit_test(a_loaded_run_goes_on_with_its_settings),
        cmocka_unit_test(a_reset_goes_back_to_the_model),
        cmocka_unit_test(settings_that_change_nothing_change_no_bit),
        cmocka_unit_test(checkpoints_of_before_are_taken_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
