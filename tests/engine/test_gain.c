/* Contact that has given more than it took stops a run in the same step, with the same sentence,
 * however the run is divided into advances and among processors. No scene of a few elements does
 * that reliably, so energy is put into the books of contact by hand. */
#include "engine/body_contact_test.h"
#include "parallel/computer.h"
#include "simulation/checkpoint.h"

static const brick LOWER = {{5, 4, 2}, 0.01, 0, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};
static const brick UPPER = {{3, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};

static lar_model *thrown(void) {
    lar_model *model = two_bricks(&LOWER, &UPPER, 0.0005, true);
    throw_nodes(model, 6 * 5 * 3, model->mesh.node_count, (double[]){0, 0, -1});
    return model;
}

static void give(lar_simulation *s, double energy) {
    lar_state *state = s->computer ? &s->computer->processor[0].worker[0].state : &s->state;
    state->contact -= energy;
}

/* Advances until it stops: where, and what is said. */
static uint64_t run(const char *grid, uint64_t steps, uint64_t given_at, lar_error *error) {
    lar_model *model = thrown();
    lar_options options = lar_options_default();
    options.grid = grid;
    lar_simulation *s = start_with(model, options);
    lar_status status = lar_simulation_advance(s, given_at, error);
    assert_int_equal(status, LAR_OK);
    give(s, 0.1);
    while (!status && lar_simulation_steps(s) < 500)
        status = lar_simulation_advance(s, steps, error);
    uint64_t step = lar_simulation_steps(s);
    if (status) assert_int_equal(lar_simulation_advance(s, 1, error), status);
    finish(s, model);
    assert_int_equal(status, LAR_ERROR_UNSTABLE);
    return step;
}

static void it_stops_in_the_same_step(void **unused) {
    (void)unused;
    static const uint64_t advances[] = {1, 7, 100, 500}, times[] = {0, 50};
    static const char *const grids[] = {NULL, "1x1x1", "2x1x1", "1x2x2"};
    for (int t = 0; t < 2; t++) {
        lar_error first = {0}, error = {0};
        uint64_t step = run(NULL, 1, times[t], &first);
        assert_non_null(strstr(first.message, "contact has given"));
        assert_non_null(strstr(first.message, "element "));
        for (int g = 0; g < 4; g++)
            for (int a = 0; a < 4; a++) {
                assert_int_equal(run(grids[g], advances[a], times[t], &error), step);
                assert_string_equal(error.message, first.message);
            }
    }
}

/* Faces are flat: contact that slides gives and takes by what it exchanges, which a checkpoint
 * keeps. The bodies have parted when energy is put into the books. */
static void what_is_exchanged_counts(void **unused) {
    (void)unused;
    for (int grid = 0; grid < 2; grid++) {
        lar_model *model = thrown();
        lar_options options = lar_options_default();
        options.grid = grid ? "2x1x1" : NULL;
        lar_simulation *s = start_with(model, options), *later = start_with(model, options);
        lar_error error;
        assert_int_equal(lar_simulation_advance(s, 1024, &error), LAR_OK);
        lar_contact_info info;
        lar_simulation_contact(s, &info);
        assert_int_equal(info.touching, 0);
        lar_energy e;
        lar_simulation_energy(s, &e);
        const double slid = 5e-3 * s->state.exchanged;
        assert_true(1e-3 * (e.kinetic + e.strain + e.hourglass + e.damping) < 0.3 * slid);
        give(s, e.contact + 0.9 * slid);
        assert_int_equal(lar_simulation_advance(s, 64, &error), LAR_OK);
        assert_int_equal(lar_simulation_save(s, "gain.lariat", &error), LAR_OK);
        assert_int_equal(lar_simulation_load(later, "gain.lariat", &error), LAR_OK);
        assert_int_equal(lar_simulation_advance(later, 64, &error), LAR_OK);
        give(s, 0.5 * slid);
        assert_int_equal(lar_simulation_advance(s, 64, &error), LAR_ERROR_UNSTABLE);
        assert_non_null(strstr(error.message, "contact has given"));
        give(later, 0.5 * slid);
        assert_int_equal(lar_simulation_advance(later, 64, &error), LAR_ERROR_UNSTABLE);
        lar_simulation_destroy(later);
        finish(s, model);
    }
}

/* Whoever forges the checksum still gets no other exchange than one that can be. */
static void what_was_exchanged_can_be(void **unused) {
    (void)unused;
    static const double forged[] = {NAN, INFINITY, 0, -1};
    lar_model *model = thrown();
    lar_simulation *s = start_with(model, lar_options_default());
    lar_error error;
    lar_bytes bytes;
    assert_int_equal(lar_simulation_advance(s, 100, &error), LAR_OK);
    assert_int_equal(lar_simulation_save(s, "gain.lariat", &error), LAR_OK);
    assert_int_equal(lar_bytes_read("gain.lariat", &bytes, &error), LAR_OK);
    assert_int_equal(bytes.data[8], 20);
    size_t at = bytes.size - 16 - 56 * (size_t)model->mesh.node_count;
    for (size_t i = 0; i < sizeof forged / sizeof *forged; i++) {
        memcpy(bytes.data + at, &forged[i], 8);
        uint64_t sum = lar_checkpoint_sum(bytes.data, bytes.size / 8 - 1);
        memcpy(bytes.data + bytes.size - 8, &sum, sizeof sum);
        FILE *file = fopen("gain.lariat", "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(bytes.data, bytes.size, 1, file), 1);
        assert_int_equal(fclose(file), 0);
        assert_int_equal(lar_simulation_load(s, "gain.lariat", &error), LAR_ERROR_FORMAT);
        assert_non_null(strstr(error.message, "numbers beyond"));
    }
    lar_bytes_free(&bytes);
    finish(s, model);
}

/* What an advance reports is that of all its steps, also of those before a look. */
static void reports_are_of_whole_advances(void **unused) {
    (void)unused;
    lar_model *model = thrown();
    lar_options options = lar_options_default();
    for (int grid = 0; grid < 2; grid++) {
        options.grid = grid ? "2x1x1" : NULL;
        lar_simulation *s = start_with(model, options);
        lar_error error;
        lar_contact_info once, often;
        assert_int_equal(lar_simulation_advance(s, 100, &error), LAR_OK);
        uint64_t hash = lar_simulation_hash(s);
        lar_simulation_contact(s, &once);
        lar_simulation_destroy(s);
        s = start_with(model, options);
        for (int i = 0; i < 100; i++)
            assert_int_equal(lar_simulation_advance(s, 1, &error), LAR_OK);
        lar_simulation_contact(s, &often);
        assert_true(lar_simulation_hash(s) == hash);
        assert_true(once.steps == often.steps && once.touching == often.touching);
        assert_true(once.steps >= 100);
        lar_simulation_destroy(s);
    }
    lar_model_destroy(model);
}

/* Cells of some micrometres, upon each other and pressed so slowly that in the beginning rounding
 * is all that moves: it was taken for energy from nowhere. */
static void rounding_gives_nothing(void **unused) {
    (void)unused;
    static const brick lower = {{4, 4, 4}, 5e-6, 0, LAR_LAW_neo_hookean, 300, 6e3, 1000};
    static const brick upper = {{3, 3, 3}, 6e-6, 0, LAR_LAW_neo_hookean, 300, 6e3, 1000};
    lar_model *model = empty_model(&lower);
    add_brick(model, &lower, (double[]){0, 0, 0});
    add_brick(model, &upper, (double[]){2.3e-6, 1.7e-6, 2e-5});
    touch_self(model);
    fix_nodes(model, brick_side(&lower, 2, 0), LAR_AXIS_ALL);
    lar_node_list top = brick_side(&upper, 2, -1);
    for (int32_t n = 0; n < top.count; n++) top.node[n] += 5 * 5 * 5;
    model->damping = 20000;
    lar_node_list same = {top.count, lar_calloc((size_t)top.count, sizeof *top.node)};
    memcpy(same.node, top.node, (size_t)top.count * sizeof *top.node);
    fix_nodes(model, same, LAR_AXIS_X | LAR_AXIS_Y);
    move_nodes(model, top, LAR_AXIS_Z, -4e-6, add_ramp(model, 20));
    for (int grid = 0; grid < 2; grid++) {
        lar_options options = lar_options_default();
        options.grid = grid ? "2x1x1" : NULL;
        lar_simulation *s = start_with(model, options);
        lar_error error;
        if (lar_simulation_advance(s, 5000, &error)) fail_msg("%s", error.message);
        lar_simulation_destroy(s);
    }
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_stops_in_the_same_step), cmocka_unit_test(what_is_exchanged_counts),
        cmocka_unit_test(what_was_exchanged_can_be),
        cmocka_unit_test(reports_are_of_whole_advances), cmocka_unit_test(rounding_gives_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
