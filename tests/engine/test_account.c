/* The account of energy goes on where it was: after a state is loaded from memory or from a file,
 * or cloned, as in the run that never stopped, while elements nearly fold and steps have parts. */
#include <unistd.h>

#include "engine/engine_test.h"

enum { BLOCKS = 2, SIDE = 3, NODES = (SIDE + 1) * (SIDE + 1) * (SIDE + 1) * BLOCKS };
enum { ELEMENTS = SIDE * SIDE * SIDE * BLOCKS };

static const char PATH[] = "account_goes_on.checkpoint";

/* A ball presses on two blocks of 3 cm that stand side by side on the ground. */
static lar_model *blocks(void) {
    static const char SCENE[] =
        "lariat: 1\ngravity: [0, 0, -9.81]\ndamping: 5\n"
        "materials: [ { cells: all, law: neo-hookean, density: 1000, shear_modulus: 3.0e3, "
        "bulk_modulus: 3.0e4 } ]\n"
        "contact: [ { faces: all, plane: { through: [0, 0, 0], normal: [0, 0, 1] }, friction: 0.4 "
        "}, { self: true } ]\n"
        "tools: [ { name: p, shape: sphere, radius: 0.006, at: [0.015, 0.015, 0.042] } ]\n";
    static double place[NODES][3];
    static int32_t element[ELEMENTS][8];
    const double h = 0.01;
    int32_t n = 0, e = 0;
    for (int b = 0; b < BLOCKS; b++) {
        const int32_t y = SIDE + 1, z = y * y, first = n;
        for (int i = 0; i < z * y; i++, n++) {
            place[n][0] = i % y * h + b * (SIDE + 1) * h;
            place[n][1] = i / y % y * h;
            place[n][2] = 0.0005 + i / z * h;
        }
        for (int i = 0; i < SIDE * SIDE * SIDE; i++, e++) {
            int32_t o = first + i % SIDE + y * (i / SIDE % SIDE) + z * (i / (SIDE * SIDE));
            const int32_t corner[8] = {o,     o + 1,     o + 1 + y,     o + y,
                                       o + z, o + 1 + z, o + 1 + y + z, o + y + z};
            memcpy(element[e], corner, sizeof corner);
        }
    }
    const lar_mesh_arrays arrays = {.nodes = n,
                                    .elements = e,
                                    .position = (const double(*)[3])place,
                                    .element = (const int32_t(*)[8])element};
    lar_model *model = NULL;
    lar_error error;
    if (lar_model_from_arrays(&arrays, SCENE, &model, &error)) fail_msg("%s", error.message);
    return model;
}

static lar_simulation *simulate(const lar_model *model, const char *grid) {
    lar_options options = lar_options_default();
    options.grid = grid;
    lar_simulation *simulation = NULL;
    lar_error error;
    if (lar_simulation_create(model, &options, &simulation, &error)) fail_msg("%s", error.message);
    return simulation;
}

static void compare(const lar_simulation *one, const lar_simulation *other, const char *how) {
    lar_energy a, b;
    lar_simulation_energy(one, &a);
    lar_simulation_energy(other, &b);
    assert_int_equal(lar_simulation_hash(one), lar_simulation_hash(other));
    const double pair[][2] = {{a.contact, b.contact},
                              {a.external, b.external},
                              {a.damping, b.damping},
                              {a.kinetic, b.kinetic}};
    for (int i = 0; i < 4; i++)
        if (fabs(pair[i][0] - pair[i][1]) > 1e-11 * fabs(pair[i][0]))
            fail_msg("%s, step %d: energy %d is %.12g, and %.12g after that", how,
                     (int)lar_simulation_steps(one), i, pair[i][0], pair[i][1]);
}

/* At once, after one step, and after some. */
static void compare_on(lar_simulation *one, lar_simulation *other, const char *how) {
    const uint64_t steps[] = {0, 1, 1, 5, 20};
    for (int i = 0; i < 5; i++) {
        advance(one, steps[i]);
        advance(other, steps[i]);
        compare(one, other, how);
    }
}

static void press_on(lar_simulation *simulation, int k) {
    const lar_tool_pose pose = {{0.012 + 0.0001 * k, 0.014, 0.026 + 0.0001 * k}, {1, 0, 0, 0}, 1};
    lar_error error;
    if (lar_simulation_tool_move(simulation, 0, &pose, 120, &error)) fail_msg("%s", error.message);
    advance(simulation, (uint64_t)(60 + 3 * k));
}

static void goes_on_from(const char *grid, const char *later) {
    lar_model *model = blocks();
    lar_error error;
    int divided = 0;
    for (int k = 15; k < 45; k += 3) {
        lar_simulation *run = simulate(model, grid), *loaded = simulate(model, later);
        lar_saved *saved = NULL;
        press_on(run, k);
        divided += lar_simulation_step_parts(run) > 1;
        if (k % 2) {
            assert_int_equal(lar_saved_create(run, &saved, &error), LAR_OK);
            assert_int_equal(lar_simulation_save_to(run, saved, &error), LAR_OK);
            if (lar_simulation_load_from(loaded, saved, &error)) fail_msg("%s", error.message);
            compare_on(run, loaded, "from memory");
        } else {
            assert_int_equal(lar_simulation_save(run, PATH, &error), LAR_OK);
            if (lar_simulation_load(loaded, PATH, &error)) fail_msg("%s", error.message);
            compare_on(run, loaded, "from a file");
        }
        lar_saved_destroy(saved);
        lar_simulation_destroy(run);
        lar_simulation_destroy(loaded);
    }
    assert_true(divided > 0);
    unlink(PATH);
    lar_model_destroy(model);
}

static void on_one_processor(void **state) {
    (void)state;
    goes_on_from(NULL, NULL);
}

static void on_several_processors(void **state) {
    (void)state;
    goes_on_from("2x1x1", NULL);
    goes_on_from(NULL, "2x1x1");
}

static void in_a_clone(void **state) {
    (void)state;
    lar_model *model = blocks();
    lar_error error;
    for (int k = 15; k < 45; k++) {
        lar_simulation *run = simulate(model, NULL), *clone;
        press_on(run, k);
        if (lar_simulation_clone(run, &clone, &error)) fail_msg("%s", error.message);
        compare_on(run, clone, "cloned");
        lar_simulation_destroy(run);
        lar_simulation_destroy(clone);
    }
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(on_one_processor),
        cmocka_unit_test(on_several_processors),
        cmocka_unit_test(in_a_clone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
