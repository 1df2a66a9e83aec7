/* Tools that are added and removed while a simulation runs: what is not there changes nothing, what
 * is there is as a tool of the scene, the bits are the same on every grid, with every backend, and
 * through checkpoints, and what cannot be is refused with a sentence. */
#include "engine/engine_test.h"
#include "engine/fleet_test.h"
#include "engine/tools_test.h"
#include "model/contact_check.h"
#include "simulation/checkpoint.h"

#define PATH LAR_TEST_BUILD "/spares.checkpoint"

static int32_t add(lar_simulation *simulation, lar_tool_shape shape, double radius, double length) {
    lar_error error;
    int32_t tool = -1;
    const lar_tool_info wanted = {.shape = shape, .radius = radius, .length = length};
    if (lar_simulation_add_tool(simulation, &wanted, &tool, &error)) fail_msg("%s", error.message);
    return tool;
}

static void drop(lar_simulation *simulation, int32_t tool) {
    lar_error error;
    if (lar_simulation_remove_tool(simulation, tool, &error)) fail_msg("%s", error.message);
}

static lar_options with_spares(int32_t spares) {
    lar_options options = lar_options_default();
    options.hands = 1;
    options.spares = spares;
    return options;
}

static lar_tool_pose pose_of(const lar_simulation *simulation, int32_t tool) {
    lar_tool_pose pose;
    assert_int_equal(lar_simulation_tool_pose(simulation, tool, &pose, NULL), LAR_OK);
    return pose;
}

/* Without gaps between its members, which copies may fill with anything. */
static void assert_same_force(const lar_tool_force *a, const lar_tool_force *b) {
    assert_memory_equal(a->force, b->force, sizeof a->force);
    assert_memory_equal(a->torque, b->torque, sizeof a->torque);
    assert_int_equal(a->touching, b->touching);
    assert_int_equal(a->held, b->held);
    assert_int_equal(a->limited, b->limited);
    assert_true(a->limit == b->limit && a->depth == b->depth && a->apart == b->apart &&
                a->grasp_force == b->grasp_force);
}

static lar_tool_force force_of(const lar_simulation *simulation, int32_t tool) {
    lar_tool_force force;
    assert_int_equal(lar_simulation_tool_force(simulation, tool, &force, NULL), LAR_OK);
    return force;
}

/* ---- what is not there ---------------------------------------------------------------------- */

static void spares_that_are_not_there_change_nothing(void **unused) {
    (void)unused;
    for (int kind = 0; kind < 4; kind++) {
        /* With tools; and without, where steps are so long that tools would be decided about more
         * often than elements are. */
        bool with = kind < 2;
        lar_model *model = with ? tool_model() : everything_model(&tool_brick);
        if (!with) throw_body(model, (double[]){0, 0, 0}, (double[]){20, 20, 0}, 2);
        uint64_t hash[2];
        lar_energy energy[2];
        lar_contact_info contact[2];
        lar_bytes bytes[2] = {{0}};
        for (int i = 0; i < 2; i++) {
            lar_options options = with_spares(i ? 4 : 0);
            options.grid = kind % 2 ? "2x1x1" : NULL;
            if (!with) options.time_step = 5e-4;
            if (!with) options.hands = 0;
            lar_simulation *simulation = start_with(model, options);
            if (with) act(simulation, 0, 15);
            if (!with) advance(simulation, 60);
            hash[i] = lar_simulation_hash(simulation);
            lar_simulation_energy(simulation, &energy[i]);
            lar_simulation_contact(simulation, &contact[i]);
            if (!with) assert_true(lar_simulation_divided_steps(simulation, NULL) > 0);
            assert_int_equal(lar_simulation_pack(simulation, "memory", &bytes[i], NULL), LAR_OK);
            lar_simulation_destroy(simulation);
        }
        assert_int_equal(hash[1], hash[0]);
        assert_memory_equal(&energy[1], &energy[0], sizeof energy[0]);
        assert_memory_equal(&contact[1], &contact[0], sizeof contact[0]);
        assert_int_equal(bytes[1].size, bytes[0].size);
        assert_memory_equal(bytes[1].data, bytes[0].data, bytes[0].size);
        for (int i = 0; i < 2; i++) lar_bytes_free(&bytes[i]);
        lar_model_destroy(model);
    }
}

static void a_spare_that_is_not_there_is_nothing(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, with_spares(2));
    lar_tool_info info;
    lar_error error;
    assert_int_equal(lar_simulation_tool_count(simulation), TEST_TOOLS + 2);
    assert_int_equal(lar_simulation_tool(simulation, TEST_TOOLS + 1, &info, NULL), LAR_OK);
    assert_int_equal(info.shape, LAR_TOOL_NONE);
    assert_string_equal(info.name, "");
    lar_tool_force force = force_of(simulation, TEST_TOOLS);
    assert_true(force.limit == 0 && force.touching == 0 && force.held == 0);
    lar_tool_pose pose = pose_of(simulation, TEST_TOOLS);
    assert_int_equal(lar_simulation_tool_move(simulation, TEST_TOOLS, &pose, 1, &error),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "is not there"));
    finish(simulation, model);
}

/* ---- what is there -------------------------------------------------------------------------- */

/* Down into the top and along it. */
static void press_down(lar_simulation *simulation, int32_t tool, int ticks) {
    lar_tool_pose at = pose_of(simulation, tool);
    for (int tick = 1; tick <= ticks; tick++) {
        lar_tool_pose to = at;
        to.position[2] -= 0.0016 * (tick < 8 ? tick : 8);
        to.position[1] += 0.0004 * tick;
        place_tool(simulation, tool, to.position[0], to.position[1], to.position[2], 1, TICK_STEPS);
        advance(simulation, TICK_STEPS);
    }
}

/* The same tool in the model, at the same place, gives the same bits and forces. */
static void an_added_tool_is_as_one_of_the_scene(void **unused) {
    (void)unused;
    uint64_t hash[2];
    lar_tool_force force[2];
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, with_spares(4));
    int32_t tool = add(simulation, LAR_TOOL_SPHERE, 0.008, 0);
    lar_tool_info info;
    assert_int_equal(tool, TEST_TOOLS);
    assert_int_equal(lar_simulation_tool(simulation, tool, &info, NULL), LAR_OK);
    assert_string_equal(info.name, "sphere 1");
    press_down(simulation, tool, 12);
    hash[0] = lar_simulation_hash(simulation);
    force[0] = force_of(simulation, tool);
    assert_true(force[0].touching > 0 && force[0].force[2] > 0.01 && force[0].limit > 0);
    finish(simulation, model);

    model = tool_model();
    add_tool(model, "added", LAR_TOOL_SPHERE, info.rest.position[0], info.rest.position[1],
             info.rest.position[2]);
    simulation = start_with(model, with_spares(0));
    press_down(simulation, 3, 12);
    hash[1] = lar_simulation_hash(simulation);
    force[1] = force_of(simulation, 3);
    assert_int_equal(hash[1], hash[0]);
    assert_same_force(&force[1], &force[0]);
    finish(simulation, model);
}

static double highest(const lar_simulation *simulation) {
    const lar_mesh *mesh = &simulation->domain.model->mesh;
    double max = -INFINITY;
    for (int32_t n = 0; n < mesh->node_count; n++)
        max = fmax(max, mesh->position[n][2] + node_u(simulation, n)[2]);
    return max;
}

/* Above the body at rest, and above one that has risen. */
static void tools_are_added_beside_the_body(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    lar_simulation *simulation = start_with(model, with_spares(4));
    for (int risen = 0; risen < 2; risen++) {
        static const lar_tool_shape shape[] = {LAR_TOOL_SPHERE, LAR_TOOL_CAPSULE, LAR_TOOL_GRASPER,
                                               LAR_TOOL_SPHERE};
        for (int i = 0; i < 4; i++) {
            int32_t tool = add(simulation, shape[i], 0.004, shape[i] ? 0.02 : 0);
            const lar_tool *added = &simulation->list.tool[tool];
            int32_t face;
            assert_int_equal(tool, 1 + i);
            assert_true(lar_tool_gap(model, added, &face) > 0);
            double below = added->shape == LAR_TOOL_GRASPER ? added->length : 0;
            assert_true(added->rest.position[2] - below - added->radius > highest(simulation));
            advance(simulation, 1); /* it comes nearer by the second time */
            assert_int_equal(force_of(simulation, tool).touching, 0);
        }
        for (int i = 0; i < 4; i++) drop(simulation, 1 + i);
        const double up[3] = {0, 0, 50};
        assert_int_equal(lar_simulation_set_gravity(simulation, up, NULL), LAR_OK);
        advance(simulation, 500);
    }
    assert_true(highest(simulation) > 0.1);
    finish(simulation, model);
}

/* A place is free again, another tool in it is another one, and the others keep theirs. */
static void places_are_used_again(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    free(model->tool[0].name);
    model->tool[0].name = lar_strdup("shaft 1"); /* which the first place would have */
    lar_simulation *simulation = start_with(model, with_spares(2));
    lar_tool_info info;
    int32_t first = add(simulation, LAR_TOOL_SPHERE, 0.008, 0);
    int32_t second = add(simulation, LAR_TOOL_GRASPER, 0.003, 0.02);
    drop(simulation, first);
    lar_simulation_tool(simulation, second, &info, NULL);
    assert_string_equal(info.name, "grasper 2");
    assert_true(info.spread > 1.04 && info.spread < 1.05);
    assert_int_equal(add(simulation, LAR_TOOL_CAPSULE, 0.004, 0.05), first);
    lar_simulation_tool(simulation, first, &info, NULL);
    assert_string_equal(info.name, "shaft 5");
    assert_true(info.shape == LAR_TOOL_CAPSULE && info.length == 0.05 && info.radius == 0.004);
    finish(simulation, model);
}

/* Of a body whose tools press and hold, and are taken away meanwhile. */
static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_options options = with_spares(2);
    options.time_step = 5e-5;
    lar_simulation *simulation = start_with(model, options);
    double worst = 0, max = 0;
    for (int turn = 0; turn < 3; turn++) {
        int32_t tool = add(simulation, LAR_TOOL_SPHERE, 0.008, 0);
        press_down(simulation, tool, 12);
        drop(simulation, tool);
        for (int i = 0; i < 30; i++) {
            lar_energy e;
            advance(simulation, 10);
            lar_simulation_energy(simulation, &e);
            worst = fmax(worst, fabs(e.kinetic + e.strain + e.hourglass + e.damping + e.contact -
                                     e.external));
            max = fmax(max, fabs(e.external));
        }
    }
    print_message("%.2g of %.3g J\n", worst / max, max);
    assert_below(worst / max, 2e-3);
    finish(simulation, model);
}

/* ---- the same bits -------------------------------------------------------------------------- */

enum { BALL = TEST_TOOLS, JAWS, PARTS = 26, STRIDE = 13 };

static void go_to(lar_simulation *simulation, int32_t tool, double down, double opening) {
    lar_tool_info info;
    lar_simulation_tool(simulation, tool, &info, NULL);
    const double *at = info.rest.position;
    place_tool(simulation, tool, at[0], at[1], at[2] - down, opening, STRIDE);
}

/* A ball is added and pressed in, a grasper that takes hold and lifts; the ball is taken away while
 * it presses and a rod comes in its place, the grasper while it holds. At odd steps, in the middle
 * of intervals. */
static void change(lar_simulation *simulation, int i) {
    if (i == 1) assert_int_equal(add(simulation, LAR_TOOL_SPHERE, 0.008, 0), BALL);
    if (i >= 2 && i < 11) go_to(simulation, BALL, 0.0015 * (i - 1), 1); /* then it rests */
    if (i == 3) assert_int_equal(add(simulation, LAR_TOOL_GRASPER, 0.003, 0.02), JAWS);
    if (i > 3 && i < 9) go_to(simulation, JAWS, 0.0038 * (i - 3), 1);
    if (i >= 9 && i < 20) go_to(simulation, JAWS, 0.019 - 0.0008 * (i - 9), 0);
    if (i == 13) drop(simulation, BALL);
    if (i == 15) assert_int_equal(add(simulation, LAR_TOOL_CAPSULE, 0.006, 0.03), BALL);
    if (i > 15) go_to(simulation, BALL, 0.0013 * (i - 15), 1);
    if (i == 20) drop(simulation, JAWS);
}

static void run(lar_simulation *simulation, int first, int end) {
    for (int i = first; i < end; i++) {
        change(simulation, i);
        advance(simulation, STRIDE);
    }
}

typedef struct outcome {
    uint64_t hash;
    lar_tool_force ball;
} outcome;

static outcome outcome_of(const lar_simulation *simulation) {
    return (outcome){lar_simulation_hash(simulation), force_of(simulation, BALL)};
}

static outcome straight(const lar_model *model) {
    lar_simulation *simulation = start_with(model, with_spares(2));
    run(simulation, 0, 13);
    assert_true(force_of(simulation, BALL).touching > 0);
    assert_true(force_of(simulation, JAWS).held > 0);
    run(simulation, 13, PARTS);
    outcome o = outcome_of(simulation);
    assert_true(o.ball.touching > 0);
    lar_simulation_destroy(simulation);
    return o;
}

static void check_outcome(const lar_simulation *simulation, const outcome *wanted) {
    outcome o = outcome_of(simulation);
    assert_int_equal(o.hash, wanted->hash);
    assert_same_force(&o.ball, &wanted->ball);
}

static void the_hash_is_the_same_everywhere(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "1x1x1", "2x1x1", "2x2x1", "2x2x3"};
    static const lar_isa isas[] = {LAR_ISA_C, LAR_ISA_AVX2, LAR_ISA_AVX512, LAR_ISA_AUTO};
    lar_model *model = tool_model();
    outcome wanted = straight(model);
    for (int grid = 0; grid < 5; grid++)
        for (int threads = 1; threads <= (grid && grid < 4 ? 2 : 1); threads++)
            for (int i = 0; i < (grid < 3 ? 4 : 1); i++) {
                lar_options options = with_spares(2 + i % 3); /* how many does not matter either */
                options.grid = grids[grid];
                options.threads = threads;
                options.isa = isas[i];
                options.search_always = grid == 2 && i == 0;
                options.delays = (uint64_t)(3 + grid);
                lar_simulation *simulation = NULL;
                if (lar_simulation_create(model, &options, &simulation, NULL)) continue;
                run(simulation, 0, PARTS);
                check_outcome(simulation, &wanted);
                lar_simulation_destroy(simulation);
            }
    lar_model_destroy(model);
}

static void processes_agree(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    outcome wanted = straight(model);
    for (int i = 0; i < 2; i++) {
        lar_options options = with_spares(2);
        fleet f;
        options.grid = i ? "2x2x1" : "2x1x1";
        options.comm = i ? "tcp" : "shm";
        start_fleet(&f, model, options, i ? 4 : 2, NULL);
        run(f.zero, 0, 12);
        assert_int_equal(lar_simulation_save(f.zero, PATH, NULL), LAR_OK);
        run(f.zero, 12, PARTS);
        check_outcome(f.zero, &wanted);
        assert_int_equal(lar_simulation_load(f.zero, PATH, NULL), LAR_OK);
        run(f.zero, 12, PARTS);
        check_outcome(f.zero, &wanted);
        end_fleet(&f);
    }
    lar_model_destroy(model);
}

/* ---- files ---------------------------------------------------------------------------------- */

static void a_loaded_run_goes_on_with_its_tools(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    outcome wanted = straight(model);
    for (int part = 1; part < PARTS; part += 3) {
        lar_options options = with_spares(2);
        lar_simulation *simulation = start_with(model, options);
        lar_checkpoint_info info;
        run(simulation, 0, part);
        assert_int_equal(lar_simulation_save(simulation, PATH, NULL), LAR_OK);
        lar_simulation_destroy(simulation);
        assert_int_equal(lar_checkpoint_inspect(PATH, &info, NULL), LAR_OK);
        assert_int_equal(info.tools, TEST_TOOLS);
        int there = part < 2 ? 0 : part < 4 ? 1 : part <= 20 ? 2 : 1;
        assert_int_equal(info.spares, there);
        options.grid = "2x1x1";
        options.spares = 4;
        simulation = start_with(model, options);
        for (int i = 0; i < 4; i++) add(simulation, LAR_TOOL_SPHERE, 0.005, 0); /* others before */
        advance(simulation, 5);
        assert_int_equal(lar_simulation_load(simulation, PATH, NULL), LAR_OK);
        run(simulation, part, PARTS);
        check_outcome(simulation, &wanted);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

static void checkpoints_need_the_room(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, with_spares(2));
    lar_error error;
    lar_bytes bytes = {0};
    uint32_t version;
    run(simulation, 0, 5);
    assert_int_equal(lar_simulation_pack(simulation, "memory", &bytes, NULL), LAR_OK);
    memcpy(&version, bytes.data + 8, 4);
    assert_int_equal(version, 7);
    uint64_t hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    for (int spares = 0; spares < 2; spares++) {
        simulation = start_with(model, with_spares(spares));
        assert_int_equal(lar_simulation_unpack(simulation, "memory", &bytes, &error),
                         LAR_ERROR_MODEL);
        assert_non_null(strstr(error.message, "options.spares = 2"));
        lar_simulation_destroy(simulation);
    }
    simulation = start_with(model, with_spares(2));
    assert_int_equal(lar_simulation_unpack(simulation, "memory", &bytes, &error), LAR_OK);
    assert_int_equal(lar_simulation_hash(simulation), hash);
    /* What no tool can be, with a checksum that fits: behind head, division and settings. */
    enum { SPARES = 144 + 56 + 552 };
    static const struct {
        int at;
        double value;
    } forged[] = {{16, -1}, {16, NAN}, {24, 3}, {40, INFINITY}};
    for (size_t i = 0; i < sizeof forged / sizeof forged[0]; i++) {
        double kept;
        uint64_t sum, was;
        unsigned char *at = bytes.data + SPARES + forged[i].at;
        memcpy(&kept, at, 8);
        memcpy(&was, bytes.data + bytes.size - 8, 8);
        memcpy(at, &forged[i].value, 8);
        sum = lar_checkpoint_sum(bytes.data, bytes.size / 8 - 1);
        memcpy(bytes.data + bytes.size - 8, &sum, 8);
        assert_int_equal(lar_simulation_unpack(simulation, "memory", &bytes, &error),
                         LAR_ERROR_FORMAT);
        memcpy(at, &kept, 8);
        memcpy(bytes.data + bytes.size - 8, &was, 8);
    }
    lar_bytes_free(&bytes);
    finish(simulation, model);
}

static void a_reset_keeps_what_was_added(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    static const char *const grids[] = {NULL, "2x2x1"};
    for (int grid = 0; grid < 2; grid++) {
        lar_options options = with_spares(2);
        options.grid = grids[grid];
        lar_simulation *simulation = start_with(model, options);
        add(simulation, LAR_TOOL_SPHERE, 0.008, 0);
        press_down(simulation, BALL, 12);
        uint64_t wanted = lar_simulation_hash(simulation);
        assert_int_equal(lar_simulation_reset(simulation, NULL), LAR_OK);
        lar_tool_info info;
        lar_simulation_tool(simulation, BALL, &info, NULL);
        lar_tool_pose pose = pose_of(simulation, BALL);
        assert_string_equal(info.name, "sphere 1");
        assert_memory_equal(&pose, &info.rest, sizeof pose);
        assert_int_equal(force_of(simulation, BALL).touching, 0);
        press_down(simulation, BALL, 12);
        assert_int_equal(lar_simulation_hash(simulation), wanted);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* What is taken away before a step leaves no trace. */
static void what_never_was_changes_no_bit(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    uint64_t hash[2];
    for (int i = 0; i < 2; i++) {
        lar_simulation *simulation = start_with(model, with_spares(1));
        act(simulation, 0, 5);
        if (i) drop(simulation, add(simulation, LAR_TOOL_GRASPER, 0.005, 0.03));
        act(simulation, 5, 15);
        hash[i] = lar_simulation_hash(simulation);
        lar_simulation_destroy(simulation);
    }
    assert_int_equal(hash[1], hash[0]);
    lar_model_destroy(model);
}

/* ---- what cannot be ------------------------------------------------------------------------- */

static void what_makes_no_sense_is_refused(void **unused) {
    (void)unused;
    static const struct {
        lar_tool_shape shape;
        double radius, length, spread;
        const char *because;
    } bad[] = {
        {LAR_TOOL_SPHERE, 0, 0, 0, "radius must be finite and more than zero"},
        {LAR_TOOL_SPHERE, -0.01, 0, 0, "radius must be finite and more than zero"},
        {LAR_TOOL_SPHERE, NAN, 0, 0, "radius must be finite and more than zero"},
        {LAR_TOOL_SPHERE, INFINITY, 0, 0, "radius must be finite and more than zero"},
        {LAR_TOOL_SPHERE, 0.01, 0.1, 0, "a sphere has no length"},
        {LAR_TOOL_SPHERE, 1e-4, 0, 0, "too thin"},
        {LAR_TOOL_SPHERE, 0.2, 0, 0, "too large for a body"},
        {LAR_TOOL_SPHERE, 1e9, 0, 0, "must be below 1e6 m"},
        {LAR_TOOL_CAPSULE, 0.01, 0, 0, "length must be finite and more than zero"},
        {LAR_TOOL_GRASPER, 0.008, 0.03, 1e-3, "do not part"},
        {LAR_TOOL_CAPSULE, 0.01, 3, 0, "a length of 3000 mm is too large"},
        {LAR_TOOL_GRASPER, 0.005, 0.02, 4, "spread"},
        {LAR_TOOL_HAND, 0.01, 0, 0, "shape must be"},
        {LAR_TOOL_NONE, 0.01, 0, 0, "shape must be"},
    };
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, with_spares(1));
    lar_error error;
    const lar_tools before = simulation->tools;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        const lar_tool_info wanted = {.shape = bad[i].shape,
                                      .radius = bad[i].radius,
                                      .length = bad[i].length,
                                      .spread = bad[i].spread};
        assert_int_equal(lar_simulation_add_tool(simulation, &wanted, NULL, &error),
                         LAR_ERROR_ARGUMENT);
        if (!strstr(error.message, bad[i].because)) fail_msg("%s", error.message);
    }
    assert_int_equal(lar_simulation_add_tool(simulation, NULL, NULL, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_add_tool(NULL, NULL, NULL, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_remove_tool(simulation, TEST_TOOLS, &error),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "is not there"));
    assert_int_equal(lar_simulation_remove_tool(simulation, 0, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "ball belongs to the scene"));
    assert_int_equal(lar_simulation_remove_tool(simulation, 99, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_simulation_remove_tool(simulation, -1, &error), LAR_ERROR_ARGUMENT);
    assert_memory_equal(&before, &simulation->tools, sizeof before);
    const lar_tool_info ball = {.shape = LAR_TOOL_SPHERE, .radius = 0.008};
    const lar_tool_info rough = {.shape = LAR_TOOL_SPHERE, .radius = 0.008, .friction = 0.2};
    assert_int_equal(lar_simulation_add_tool(simulation, &rough, NULL, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "has no friction"));
    add(simulation, LAR_TOOL_SPHERE, 0.008, 0);
    assert_int_equal(lar_simulation_add_tool(simulation, &ball, NULL, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "no place is left"));
    lar_simulation_destroy(simulation);
    simulation = start_with(model, with_spares(0));
    assert_int_equal(lar_simulation_add_tool(simulation, &ball, NULL, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "options.spares"));
    lar_simulation_destroy(simulation);
    lar_options options = with_spares(5);
    assert_int_equal(lar_simulation_create(model, &options, &simulation, &error),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "0 to 4"));
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spares_that_are_not_there_change_nothing),
        cmocka_unit_test(a_spare_that_is_not_there_is_nothing),
        cmocka_unit_test(an_added_tool_is_as_one_of_the_scene),
        cmocka_unit_test(tools_are_added_beside_the_body),
        cmocka_unit_test(places_are_used_again),
        cmocka_unit_test(every_joule_is_accounted_for),
        cmocka_unit_test(the_hash_is_the_same_everywhere),
        cmocka_unit_test(processes_agree),
        cmocka_unit_test(a_loaded_run_goes_on_with_its_tools),
        cmocka_unit_test(checkpoints_need_the_room),
        cmocka_unit_test(a_reset_keeps_what_was_added),
        cmocka_unit_test(what_never_was_changes_no_bit),
        cmocka_unit_test(what_makes_no_sense_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
