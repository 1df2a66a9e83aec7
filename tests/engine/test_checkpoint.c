/* Saving, loading and going back: from then on everything is as if nothing had been. */
#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include "simulation/checkpoint.h"
#include "engine/body_contact_test.h"
#include "engine/engine_test.h"
#include "engine/fleet_test.h"
#include "engine/tools_test.h"

static const char *const grids[] = {NULL, "2x1x1", "2x2x1", "1x2x3"};
static const char *const schemes[] = {NULL, "all", "local", "two"};
enum { GRIDS = 4 };

#define PATH LAR_TEST_BUILD "/test.checkpoint"

static lar_options setting(int grid) {
    lar_options options = lar_options_default();
    options.grid = grids[grid];
    options.scheme = schemes[grid];
    options.threads = grid ? 1 + grid % 2 : 0;
    options.delays = grid ? (uint64_t)(17 + grid) : 0;
    options.hands = 1;
    return options;
}

static void save(lar_simulation *simulation, const char *path) {
    lar_error error;
    if (lar_simulation_save(simulation, path, &error)) fail_msg("%s", error.message);
}

static void load(lar_simulation *simulation, const char *path) {
    lar_error error;
    if (lar_simulation_load(simulation, path, &error)) fail_msg("%s", error.message);
}

static lar_saved *save_to(const lar_simulation *simulation) {
    lar_saved *saved = NULL;
    lar_error error;
    if (lar_saved_create(simulation, &saved, &error) ||
        lar_simulation_save_to(simulation, saved, &error))
        fail_msg("%s", error.message);
    return saved;
}

static void load_from(lar_simulation *simulation, const lar_saved *saved) {
    lar_error error;
    if (lar_simulation_load_from(simulation, saved, &error)) fail_msg("%s", error.message);
}

static void reset(lar_simulation *simulation) {
    lar_error error;
    if (lar_simulation_reset(simulation, &error)) fail_msg("%s", error.message);
}

/* Hashes of a run that nothing interrupts, after 0, 8 and 20 ticks. */
typedef struct course {
    uint64_t start, middle, end;
    lar_energy energy; /* at the end */
} course;

static course straight_course(const lar_model *model) {
    lar_simulation *simulation = start_with(model, setting(0));
    course c = {.start = lar_simulation_hash(simulation)};
    act(simulation, 0, 8);
    c.middle = lar_simulation_hash(simulation);
    act(simulation, 8, 20);
    c.end = lar_simulation_hash(simulation);
    lar_simulation_energy(simulation, &c.energy);
    lar_simulation_destroy(simulation);
    return c;
}

/* Saved on one grid, taken up on another: with tools and what they hold. */
static void a_loaded_run_goes_on_as_if_never_stopped(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    course c = straight_course(model);
    for (int from = 0; from < GRIDS; from += test_every(3)) {
        lar_simulation *simulation = start_with(model, setting(from));
        act(simulation, 0, 8);
        save(simulation, PATH);
        assert_int_equal(lar_simulation_hash(simulation), c.middle);
        act(simulation, 8, 20);
        assert_int_equal(lar_simulation_hash(simulation), c.end);
        lar_simulation_destroy(simulation);

        int to = (from + 1) % GRIDS;
        lar_simulation *other = start_with(model, setting(to));
        if (from % 2) { /* wherever it has been before, in the same step too */
            act(other, 0, 5);
            advance(other, 3 * TICK_STEPS);
        }
        load(other, PATH);
        assert_int_equal(lar_simulation_steps(other), 8 * TICK_STEPS);
        assert_int_equal(lar_simulation_hash(other), c.middle);
        act(other, 8, 20);
        assert_int_equal(lar_simulation_hash(other), c.end);
        lar_energy energy;
        lar_simulation_energy(other, &energy);
        double scale = c.energy.strain + c.energy.kinetic + fabs(c.energy.external);
        assert_true(fabs(energy.external - c.energy.external) <= 1e-10 * scale);
        assert_true(fabs(energy.damping - c.energy.damping) <= 1e-10 * scale);
        lar_simulation_destroy(other);
    }
    lar_model_destroy(model);
}

/* Saved in memory on one grid, taken up on all; tools feel there what they felt. */
static void many_runs_go_on_from_one_state(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    course c = straight_course(model);
    lar_simulation *first = start_with(model, setting(1));
    act(first, 0, 8);
    lar_saved *saved = save_to(first);
    lar_tool_force before[TEST_TOOLS], after[TEST_TOOLS];
    int felt = 0;
    for (int32_t t = 0; t < TEST_TOOLS; t++) {
        assert_int_equal(lar_simulation_tool_force(first, t, &before[t], NULL), LAR_OK);
        felt += before[t].touching + before[t].held;
    }
    assert_true(felt > 0);
    act(first, 8, 20);
    assert_int_equal(lar_simulation_hash(first), c.end);
    lar_simulation_destroy(first);
    for (int grid = 0; grid < GRIDS; grid += test_every(3)) {
        lar_simulation *simulation = start_with(model, setting(grid));
        for (int again = 0; again < 2; again++) {
            act(simulation, 0, again);
            load_from(simulation, saved);
            for (int32_t t = 0; t < TEST_TOOLS; t++)
                assert_int_equal(lar_simulation_tool_force(simulation, t, &after[t], NULL), LAR_OK);
            assert_memory_equal(before, after, sizeof before);
            assert_int_equal(lar_simulation_steps(simulation), 8 * TICK_STEPS);
            assert_int_equal(lar_simulation_hash(simulation), c.middle);
            act(simulation, 8, 20);
            assert_int_equal(lar_simulation_hash(simulation), c.end);
            reset(simulation);
        }
        lar_simulation_destroy(simulation);
    }
    lar_saved_destroy(saved);
    lar_model_destroy(model);
}

static void check_rest(const lar_simulation *simulation, int32_t tool) {
    lar_tool_info info;
    lar_tool_pose pose;
    assert_int_equal(lar_simulation_tool(simulation, tool, &info, NULL), LAR_OK);
    assert_int_equal(lar_simulation_tool_pose(simulation, tool, &pose, NULL), LAR_OK);
    assert_memory_equal(&pose, &info.rest, sizeof pose);
}

/* Back and forth between past and future, after even and odd numbers of steps, so that packets of
 * every round have met those of another: rounds that were steps would take old packets for new. */
static void time_may_go_back_again_and_again(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    course c = straight_course(model);
    for (int grid = 0; grid < GRIDS; grid += test_every(3)) {
        lar_simulation *simulation = start_with(model, setting(grid));
        for (int i = 0; i < 3; i++) {
            act(simulation, 0, 2);
            advance(simulation, (uint64_t)(1 + i));
            reset(simulation);
            assert_int_equal(lar_simulation_steps(simulation), 0);
            assert_int_equal(lar_simulation_hash(simulation), c.start);
            for (int32_t t = 0; t < TEST_TOOLS; t++) check_rest(simulation, t);
            lar_contact_info contact;
            lar_simulation_contact(simulation, &contact);
            assert_true(contact.steps == 0 && contact.tested == 0 && contact.touching == 0);
            advance(simulation, 1);
            lar_simulation_contact(simulation, &contact);
            assert_int_equal(contact.steps, 1);
            reset(simulation);
        }
        act(simulation, 0, 8);
        assert_int_equal(lar_simulation_hash(simulation), c.middle);
        save(simulation, PATH);
        lar_saved *saved = save_to(simulation);
        for (int i = 0; i < 6; i++) {
            advance(simulation, (uint64_t)(2 + i));
            if (i % 2)
                load(simulation, PATH);
            else
                load_from(simulation, saved);
            assert_int_equal(lar_simulation_hash(simulation), c.middle);
        }
        lar_saved_destroy(saved);
        act(simulation, 8, 20);
        assert_int_equal(lar_simulation_hash(simulation), c.end);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* ---- runs that have broken off -------------------------------------------------------------- */

/* One node is thrown into the body. */
static lar_model *crashing_model(void) {
    lar_model *model = everything_model(&tool_brick);
    static const double crash[3] = {-200, 0, 0};
    throw_node(model, brick_node(&tool_brick, 3, 2, 2), crash);
    return model;
}

static void break_and_take_up(lar_simulation *simulation) {
    lar_error error;
    uint64_t begin = lar_simulation_hash(simulation);
    lar_saved *saved = save_to(simulation);
    save(simulation, PATH);
    for (int i = 0; i < 6; i++) {
        assert_int_equal(lar_simulation_advance(simulation, 500, &error), LAR_ERROR_UNSTABLE);
        assert_int_equal(lar_simulation_advance(simulation, 1, &error), LAR_ERROR_UNSTABLE);
        assert_int_equal(lar_simulation_save(simulation, PATH ".no", &error), LAR_ERROR_UNSTABLE);
        /* What was saved before stays. */
        assert_int_equal(lar_simulation_save_to(simulation, saved, &error), LAR_ERROR_UNSTABLE);
        if (i % 3 == 0)
            reset(simulation);
        else if (i % 3 == 1)
            load(simulation, PATH);
        else
            load_from(simulation, saved);
        assert_int_equal(lar_simulation_hash(simulation), begin);
        if (lar_simulation_advance(simulation, 1, &error)) fail_msg("%s", error.message);
    }
    lar_saved_destroy(saved);
    assert_int_equal(access(PATH ".no", F_OK), -1);
}

static void a_broken_run_is_taken_up_again(void **unused) {
    (void)unused;
    lar_model *model = crashing_model();
    for (int grid = 0; grid < GRIDS; grid += test_every(3)) {
        lar_simulation *simulation = start_with(model, setting(grid));
        break_and_take_up(simulation);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* ---- other processes: two simulations in two threads ---------------------------------------- */

static void go_back_and_forth(lar_simulation *simulation, const course *c) {
    act(simulation, 0, 3);
    advance(simulation, 1);
    reset(simulation);
    assert_int_equal(lar_simulation_hash(simulation), c->start);
    act(simulation, 0, 8);
    assert_int_equal(lar_simulation_hash(simulation), c->middle);
    save(simulation, PATH);
    lar_saved *saved = save_to(simulation);
    act(simulation, 9, 10);
    advance(simulation, 7);
    load(simulation, PATH);
    assert_int_equal(lar_simulation_hash(simulation), c->middle);
    advance(simulation, 5);
    load_from(simulation, saved);
    lar_saved_destroy(saved);
    assert_int_equal(lar_simulation_hash(simulation), c->middle);
    act(simulation, 8, 20);
    assert_int_equal(lar_simulation_hash(simulation), c->end);
}

static void processes_go_back_together(void **unused) {
    (void)unused;
    static const char *const backends[] = {"shm", "tcp", "shm"};
    static const char *const grid[] = {"2x1x1", "2x1x1", "2x2x1"};
    for (int i = 0; i < 3; i++) {
        lar_model *model = tool_model_of(i == 0 ? &fine_tool_brick : &tool_brick);
        course c = straight_course(model);
        lar_options options = setting(1);
        options.grid = grid[i];
        options.threads = 1 + i % 2;
        options.comm = backends[i];
        fleet f;
        start_fleet(&f, model, options, i == 2 ? 4 : 2, NULL);
        go_back_and_forth(f.zero, &c);
        end_fleet(&f);
        lar_model_destroy(model);
    }
}

static void processes_that_broke_off_are_taken_up_again(void **unused) {
    (void)unused;
    lar_model *model = crashing_model();
    lar_options options = setting(1);
    options.comm = "shm";
    fleet f;
    start_fleet(&f, model, options, 2, NULL);
    break_and_take_up(f.zero);
    end_fleet(&f);
    lar_model_destroy(model);
}

/* ---- bodies in contact ---------------------------------------------------------------------- */

static const brick anvil = {{6, 4, 2}, 0.01, 0.08, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};
static const brick hammer = {{4, 3, 2}, 0.008, 0.05, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};

/* Of a run that nothing interrupts: after 30 steps, when the bodies touch, and after 150. */
typedef struct impact {
    uint64_t begin, middle, end;
} impact;

static impact straight_impact(const lar_model *model) {
    lar_simulation *simulation = start_with(model, setting(0));
    impact w = {.begin = lar_simulation_hash(simulation)};
    lar_contact_info info;
    advance(simulation, 30);
    lar_simulation_contact(simulation, &info);
    assert_true(info.touching > 0);
    w.middle = lar_simulation_hash(simulation);
    save(simulation, PATH);
    advance(simulation, 120);
    w.end = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return w;
}

/* From near by and, with `far`, from a state in which other faces are near each other. Also in the
 * step that the state is of, where nothing else tells that it is another one. */
static void take_up_impact(lar_simulation *simulation, const impact *w, bool far) {
    lar_error error;
    lar_tool_pose aside = {{1, 1, 1}, {1, 0, 0, 0}, 1};
    for (int i = 1; i >= !far; i--) {
        advance(simulation, i ? 31 : 600);
        if (i == 1) reset(simulation);
        if (i == 1) advance(simulation, 30);
        if (lar_simulation_tool_move(simulation, 0, &aside, 5, &error))
            fail_msg("%s", error.message);
        load(simulation, PATH);
        assert_int_equal(lar_simulation_hash(simulation), w->middle);
        advance(simulation, 120);
        assert_int_equal(lar_simulation_hash(simulation), w->end);
        reset(simulation);
        assert_int_equal(lar_simulation_hash(simulation), w->begin);
        advance(simulation, 150);
        assert_int_equal(lar_simulation_hash(simulation), w->end);
    }
}

static void bodies_in_contact_are_taken_up_in_the_middle(void **unused) {
    (void)unused;
    lar_model *model = two_bricks(&anvil, &hammer, 0.002, true);
    int32_t first = (anvil.cells[0] + 1) * (anvil.cells[1] + 1) * (anvil.cells[2] + 1);
    throw_nodes(model, first, model->mesh.node_count, (double[]){0.15, 0.05, -0.3});
    memcpy(model->gravity, (double[]){0, 0, -9.81}, 24);
    impact w = straight_impact(model);
    for (int grid = 0; grid < GRIDS; grid += test_every(3)) {
        lar_simulation *simulation = start_with(model, setting(grid));
        take_up_impact(simulation, &w, grid > 1);
        lar_simulation_destroy(simulation);
    }
    for (int i = 0; i < 2; i++) {
        lar_options options = setting(i + 1);
        options.comm = i ? "shm" : "tcp";
        fleet f;
        start_fleet(&f, model, options, i ? 4 : 2, NULL);
        take_up_impact(f.zero, &w, false);
        end_fleet(&f);
    }
    lar_model_destroy(model);
}

/* ---- files ---------------------------------------------------------------------------------- */

static lar_bytes saved_bytes(lar_simulation *simulation) {
    lar_bytes bytes = {0};
    lar_error error;
    save(simulation, PATH);
    if (lar_bytes_read(PATH, &bytes, &error)) fail_msg("%s", error.message);
    return bytes;
}

static void write_bytes(const char *path, const lar_bytes *bytes) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    if (bytes->size) assert_int_equal(fwrite(bytes->data, bytes->size, 1, file), 1);
    assert_int_equal(fclose(file), 0);
}

#define BAD LAR_TEST_BUILD "/bad.checkpoint"

/* Refused with these words, and nothing has changed. */
static void refuse(lar_simulation *simulation, const char *path, lar_status status,
                   const char *why) {
    uint64_t before = lar_simulation_hash(simulation);
    lar_error error = {0};
    assert_int_equal(lar_simulation_load(simulation, path, &error), status);
    if (!strstr(error.message, why)) fail_msg("'%s' lacks '%s'", error.message, why);
    assert_int_equal(lar_simulation_hash(simulation), before);
}

static void repair_sum(lar_bytes *bytes) {
    uint64_t sum = lar_checkpoint_sum(bytes->data, bytes->size / 8 - 1);
    memcpy(bytes->data + bytes->size - 8, &sum, sizeof sum);
}

static void damaged_files_are_refused(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    act(simulation, 0, 8);
    lar_bytes good = saved_bytes(simulation);
    lar_bytes bad = {lar_calloc(good.size + 8, 1), good.size};
    memcpy(bad.data, good.data, good.size);
    for (size_t size = 1; size < good.size; size += size < 160 ? 1 : 977) {
        bad.size = size;
        write_bytes(BAD, &bad);
        refuse(simulation, BAD, LAR_ERROR_FORMAT, size < 8 ? "not a checkpoint" : "cut off");
    }
    bad.size = good.size + 8;
    write_bytes(BAD, &bad);
    refuse(simulation, BAD, LAR_ERROR_FORMAT, "altered");
    assert_int_equal(truncate(BAD, (off_t)1 << 40), 0); /* more than any memory */
    refuse(simulation, BAD, LAR_ERROR_FORMAT, "altered");
    bad.size = good.size;
    for (size_t at = 24; at < good.size; at += at < 200 ? 1 : 1009) {
        bad.data[at] ^= 0x10;
        write_bytes(BAD, &bad);
        refuse(simulation, BAD, LAR_ERROR_FORMAT, "checksum");
        bad.data[at] ^= 0x10;
    }
    bad.data[8] = 12;
    write_bytes(BAD, &bad);
    refuse(simulation, BAD, LAR_ERROR_UNSUPPORTED, "version 12");
    bad.data[8] = good.data[8];
    memcpy(bad.data + 12, (unsigned char[]){1, 2, 3, 4}, 4);
    write_bytes(BAD, &bad);
    refuse(simulation, BAD, LAR_ERROR_FORMAT, "order of bytes");
    memcpy(bad.data + 12, good.data + 12, 4);
    lar_bytes_free(&bad);
    lar_bytes_free(&good);
    refuse(simulation, LAR_TEST_BUILD "/nowhere/x", LAR_ERROR_IO, "nowhere");
    finish(simulation, model);
}

/* Whoever forges the checksum still gets no state that is none. */
static void forged_files_are_refused(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    act(simulation, 0, 8);
    lar_bytes bytes = saved_bytes(simulation);
    size_t offset = bytes.size - 8 - 56 * (size_t)model->mesh.node_count; /* of the first node */
    enum { DIVISION = 144, SETTINGS = DIVISION + 56, TOOL = SETTINGS + 552 };
    enum { FOLLOWER = TOOL + 152 * TEST_TOOLS, FELT = FOLLOWER + 152 };
    enum { HAND = FOLLOWER + 240 * TEST_HAND };
    const struct {
        size_t at, size;
        double value; /* as a double, or as a 32-bit integer */
        const char *why;
    } forged[] = {
        {96, 8, 1e300, "numbers beyond"}, /* the step */
        {104, 8, NAN, "numbers beyond"},  /* work */
        {136, 4, 3, "sizes"},             /* tools */
        {140, 4, 300, "sizes"},           /* holds */
        {DIVISION, 4, 0, "tool"},         /* parts of a step */
        {DIVISION, 4, 5, "tool"},
        {DIVISION, 4, 48, "tool"},
        {DIVISION, 4, 64, "tool"},
        {DIVISION, 4, -2, "tool"},
        {DIVISION + 4, 4, 9, "tool"},     /* and before */
        {DIVISION + 8, 8, 1e300, "tool"}, /* since when */
        {DIVISION + 16, 8, NAN, "tool"},  /* hardness */
        {DIVISION + 16, 8, 0.5, "tool"},
        {DIVISION + 16, 8, 65, "tool"},
        {DIVISION + 16, 8, INFINITY, "tool"},
        {DIVISION + 24, 8, NAN, "tool"}, /* need */
        {DIVISION + 24, 8, -1, "tool"},
        {DIVISION + 32, 8, -1, "tool"}, /* and lately */
        {DIVISION + 32, 8, 1025, "tool"},
        {DIVISION + 32, 8, NAN, "tool"},
        {DIVISION + 40, 8, 1e300, "tool"}, /* when decided */
        {DIVISION + 48, 4, 0, "tool"},     /* parts of stiffer materials */
        {DIVISION + 52, 4, 2, "tool"},     /* due */
        {SETTINGS, 4, 2, "tool"},          /* whether gravity is set */
        {SETTINGS + 4, 4, -1, "tool"},     /* and damping */
        {SETTINGS + 8, 8, 1001, "tool"},   /* gravity */
        {SETTINGS + 24, 8, NAN, "tool"},
        {SETTINGS + 32, 8, -1, "tool"}, /* damping */
        {SETTINGS + 32, 8, 1e9, "tool"},
        {SETTINGS + 40, 8, 0, "tool"}, /* the factor of the first material, and of the last */
        {SETTINGS + 40 + 63 * 8, 8, 4.5, "tool"},
        {TOOL, 8, INFINITY, "tool"}, /* a position */
        {TOOL, 8, -1e200, "tool"},
        {TOOL + 24, 8, 0.5, "tool"},    /* an orientation */
        {TOOL + 56, 8, 1.5, "tool"},    /* an opening */
        {TOOL + 128, 8, 1e300, "tool"}, /* the step at which it began */
        {TOOL + 144, 4, 2, "tool"},     /* whether it holds */
        {FOLLOWER, 8, NAN, "tool"},     /* where it was asked to go */
        {FOLLOWER + 64, 8, 1e200, "tool"},
        {FOLLOWER + 24, 8, 0.5, "tool"},
        {FOLLOWER + 64 + 56, 8, -1, "tool"},
        {FOLLOWER + 136, 8, -1, "tool"},
        {FOLLOWER + 144, 4, 1, "tool"}, /* the hand itself does not hold */
        {FOLLOWER + 148, 4, 1, "tool"},
        {FELT + 56, 8, NAN, "tool"}, /* depth */
        {FELT + 56, 8, -1e-3, "tool"},
        {FELT + 56, 8, 1, "tool"},
        {FELT + 64, 8, 1e300, "tool"},    /* steps */
        {FELT + 72, 8, INFINITY, "tool"}, /* load */
        {FELT + 72, 8, -1, "tool"},
        {FELT + 80, 4, 2, "tool"}, /* lagging */
        {FELT + 80, 4, -1, "tool"},
        {FELT + 84, 4, 1, "tool"},
        {HAND + 152 + 80, 4, 1, "tool"},      /* hands do not lag */
        {bytes.size - 16, 8, NAN, "numbers"}, /* a velocity */
        {bytes.size - 16, 8, 3, "hash"},
        {offset, 8, -1e-3, "numbers"}, /* from the side, outside */
        {offset, 8, 1e-3, "hash"},
    };
    for (size_t i = 0; i < sizeof forged / sizeof forged[0]; i++) {
        lar_bytes bad = {lar_calloc(bytes.size, 1), bytes.size};
        memcpy(bad.data, bytes.data, bytes.size);
        int32_t integer = forged[i].size == 4 ? (int32_t)forged[i].value : 0;
        const void *value = forged[i].size == 8 ? (const void *)&forged[i].value : &integer;
        memcpy(bad.data + forged[i].at, value, forged[i].size);
        repair_sum(&bad);
        write_bytes(BAD, &bad);
        refuse(simulation, BAD, LAR_ERROR_FORMAT, forged[i].why);
        lar_bytes_free(&bad);
    }
    lar_bytes_free(&bytes);
    finish(simulation, model);
}

static void refuse_with(const lar_model *model, lar_options options, const char *why) {
    lar_simulation *simulation = start_with(model, options);
    refuse(simulation, PATH, LAR_ERROR_MODEL, why);
    lar_simulation_destroy(simulation);
}

/* Says what is different. */
static void other_models_are_refused(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    act(simulation, 0, 3);
    save(simulation, PATH);
    double step = lar_simulation_time_step(simulation);
    lar_simulation_destroy(simulation);
    lar_options options = setting(0);
    options.time_step = step / 2;
    refuse_with(model, options, "time step");
    options = setting(0);
    options.element = LAR_ELEMENT_HEX8_FULL;
    refuse_with(model, options, "hex8-full");
    options = setting(0);
    options.hands = 2;
    refuse_with(model, options, "hands");
    options = setting(0);
    options.time_step = step;
    lar_model *other = tool_model();
    other->material[1].density *= 1.001;
    refuse_with(other, options, "materials");
    other->material[1].density = model->material[1].density;
    other->mesh.position[17][1] += 1e-9;
    refuse_with(other, options, "places");
    other->mesh.position[17][1] = model->mesh.position[17][1];
    other->damping += 1;
    refuse_with(other, options, "damping");
    other->damping -= 1;
    other->tool[1].radius *= 1.05;
    refuse_with(other, options, "tools");
    lar_model_destroy(other);
    other = everything_model(&soft_brick);
    refuse_with(other, setting(0), "12 elements");
    lar_model_destroy(other);
    lar_model_destroy(model);
}

/* Checkpoints that were begun and are still there. */
static int count_parts(void) {
    DIR *folder = opendir(LAR_TEST_BUILD);
    int count = 0;
    assert_non_null(folder);
    for (const struct dirent *entry; (entry = readdir(folder));)
        count += (strncmp(entry->d_name, "test.checkpoint.", 16) == 0 ||
                  strncmp(entry->d_name, "shared.checkpoint.", 18) == 0) &&
                 strstr(entry->d_name, ".part");
    closedir(folder);
    return count;
}

/* A file is whole or not there; what is no checkpoint is not overwritten. */
static void saving_spares_what_is_there(void **unused) {
    (void)unused;
    lar_model *model = tool_model();
    lar_simulation *simulation = start_with(model, setting(0));
    lar_error error = {0};
    lar_bytes scene = {(unsigned char *)lar_strdup("lariat: 1\nmesh: x.vtu\n"), 22};
    write_bytes(BAD, &scene);
    lar_bytes_free(&scene);
    assert_int_equal(lar_simulation_save(simulation, BAD, &error), LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "not overwritten"));
    assert_int_equal(lar_simulation_save(simulation, LAR_TEST_BUILD "/nowhere/x", &error),
                     LAR_ERROR_IO);
    assert_int_equal(lar_simulation_save(simulation, LAR_TEST_BUILD, &error), LAR_ERROR_IO);
    remove(BAD);
    assert_int_equal(mkfifo(BAD, 0600), 0);
    assert_int_equal(lar_simulation_save(simulation, BAD, &error), LAR_ERROR_IO);
    assert_int_equal(lar_simulation_load(simulation, BAD, &error), LAR_ERROR_IO);
    remove(BAD);
    save(simulation, PATH);
    save(simulation, PATH); /* a checkpoint is */
    assert_int_equal(count_parts(), 0);
    finish(simulation, model);
}

#define SHARED LAR_TEST_BUILD "/shared.checkpoint"

typedef struct saver {
    lar_bytes bytes;
    int failures;
} saver;

static void *save_often(void *argument) {
    saver *s = argument;
    for (int i = 0; i < 15; i++) s->failures += lar_checkpoint_store(SHARED, &s->bytes, NULL) != 0;
    return NULL;
}

/* Each writes a file of its own, and the last name given stands. */
static void several_save_to_one_path(void **unused) {
    (void)unused;
    enum { SAVERS = 4, MAX = 400000 };
    saver s[SAVERS];
    pthread_t thread[SAVERS];
    lar_bytes left;
    remove(SHARED);
    for (int k = 0; k < SAVERS; k++) {
        s[k] = (saver){.bytes = {malloc(MAX), (size_t)(MAX / (k + 1))}};
        memset(s[k].bytes.data, 'a' + k, MAX);
        memcpy(s[k].bytes.data, "LARIATCP", 8);
        assert_int_equal(pthread_create(&thread[k], NULL, save_often, &s[k]), 0);
    }
    for (int k = 0; k < SAVERS; k++) pthread_join(thread[k], NULL);
    assert_int_equal(lar_bytes_read(SHARED, &left, NULL), LAR_OK);
    int whose = left.data[8] - 'a';
    assert_in_range(whose, 0, SAVERS - 1);
    assert_int_equal(left.size, s[whose].bytes.size);
    assert_memory_equal(left.data, s[whose].bytes.data, left.size);
    for (int k = 0; k < SAVERS; k++) {
        assert_int_equal(s[k].failures, 0);
        lar_bytes_free(&s[k].bytes);
    }
    lar_bytes_free(&left);
    assert_int_equal(count_parts(), 0);
    remove(SHARED);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_loaded_run_goes_on_as_if_never_stopped),
        cmocka_unit_test(time_may_go_back_again_and_again),
        cmocka_unit_test(many_runs_go_on_from_one_state),
        cmocka_unit_test(a_broken_run_is_taken_up_again),
        cmocka_unit_test(processes_go_back_together),
        cmocka_unit_test(processes_that_broke_off_are_taken_up_again),
        cmocka_unit_test(bodies_in_contact_are_taken_up_in_the_middle),
        cmocka_unit_test(damaged_files_are_refused),
        cmocka_unit_test(forged_files_are_refused),
        cmocka_unit_test(other_models_are_refused),
        cmocka_unit_test(saving_spares_what_is_there),
        cmocka_unit_test(several_save_to_one_path),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
