/* Bodies that hit a plane, another body and themselves, through the public header alone: contact
 * never adds energy, and what falls comes to rest. The meshes and scenes are those of
 * examples/scenes.
 *
 * Prints one line per case, from which docs/validation.md is made:
 *
 *     impact on | speed | steps | most energy, of the start's | balance | touching | deepest
 */
#include "testing.h"

#include <lariat.h>

#define SCENES LAR_TEST_EXAMPLES "/scenes/"

static lar_error error;

static void check(lar_status status) {
    if (status) fail_msg("%s", error.message);
}

/* A scene of the two blocks, flying at `speed`, with these contacts. */
static lar_model *flying_blocks(double speed, double shear, const char *who, const char *contact) {
    static const char path[] = LAR_TEST_BUILD "/impact.yaml";
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "lariat: 1\n"
            "mesh: %sblocks.inp\n"
            "scale: 0.001\n"
            "materials: [{cells: all, law: neo-hookean, density: 1050, shear_modulus: %g, "
            "bulk_modulus: %g}]\n"
            "initial: [{nodes: %s, velocity: [0, 0, %g]}]\n"
            "contact: [%s]\n",
            SCENES, shear, 100 * shear, who, -speed, contact);
    assert_int_equal(fclose(file), 0);
    lar_model *model = NULL;
    check(lar_model_open(path, &model, &error));
    return model;
}

/* A simulation at this part of the stable step. */
static lar_simulation *begin(const lar_model *model, double part) {
    lar_model_info info;
    lar_options options = lar_options_default();
    lar_simulation *simulation = NULL;
    check(lar_model_inspect(model, &info, &error));
    options.time_step = part * info.stable_step;
    check(lar_simulation_create(model, &options, &simulation, &error));
    return simulation;
}

/* Runs for `seconds` and compares the energy with that at the start, at every fourth step: of the
 * bodies alone it never grows, and together with what contacts keep or lose it stays. Returns the
 * most that it was, as a part of the start's. */
static double fly(lar_simulation *simulation, const char *what, double speed, double seconds) {
    enum { EVERY = 4 };
    lar_energy energy;
    lar_simulation_energy(simulation, &energy);
    double start = energy.kinetic, max = 1, balance = 0, deepest = 0;
    int32_t touching = 0;
    uint64_t steps = (uint64_t)(seconds / lar_simulation_time_step(simulation));
    while (lar_simulation_steps(simulation) < steps) {
        lar_contact_info info;
        check(lar_simulation_advance(simulation, EVERY, &error));
        lar_simulation_energy(simulation, &energy);
        lar_simulation_contact(simulation, &info);
        double bodies = energy.kinetic + energy.strain + energy.hourglass;
        max = fmax(max, bodies / start);
        balance = fmax(balance, fabs((bodies + energy.contact) / start - 1));
        deepest = fmax(deepest, info.deepest);
        touching = info.touching > touching ? info.touching : touching;
    }
    print_message("%s | %g m/s | %d | %.6f | %.1e | %d | %.3f mm\n", what, speed, (int)steps, max,
                  balance, (int)touching, 1e3 * deepest);
    assert_true(touching > 0);
    assert_below(balance, 0.02); /* the time integration's own, as the square of the step */
    return max;
}

/* A gel as soft as an organ (shear waves of 2 m/s), and a firmer one (6 m/s) for what would crush
 * it. */
static const struct {
    double speed, shear; /* [m/s], [Pa] */
} cases[] = {{0.01, 4e3}, {0.1, 4e3}, {1, 4e3}, {1, 4e4}, {5, 4e4}};
enum { CASES = sizeof cases / sizeof cases[0] };

static void each_speed(const char *what, const char *who, const char *contact, double gap) {
    for (int i = 0; i < CASES; i++)
        for (int part = test_in_full() ? 0 : 1; part < 2; part++) { /* 1: the larger step */
            double speed = cases[i].speed;
            lar_model *model = flying_blocks(speed, cases[i].shear, who, contact);
            lar_simulation *simulation = begin(model, part ? 0.999 : 0.5);
            double max = fly(simulation, what, speed, gap / speed + 0.15);
            assert_below(max, 1.001);
            lar_simulation_destroy(simulation);
            lar_model_destroy(model);
        }
}

static void test_on_a_plane(void **state) {
    (void)state;
    each_speed("a plane", "all",
               "{faces: upper, plane: {through: [0, 0, 0.0205], normal: [0, 0, 1]}}, "
               "{faces: lower, plane: {through: [0, 0, -0.0005], normal: [0, 0, 1]}}",
               0.0006);
}

static void test_on_a_block(void **state) {
    (void)state;
    each_speed("a block", "upper", "{between: [upper, lower]}", 0.0052);
}

/* The scene as it is in examples/scenes, and long enough to come to rest: on the table and on the
 * slab, hardly immersed (elements have edges of 4 mm). */
static void test_comes_to_rest(void **state) {
    (void)state;
    lar_model *model = NULL;
    check(lar_model_open(SCENES "blocks.yaml", &model, &error));
    lar_simulation *simulation = begin(model, 0.8);
    lar_contact_info info;
    lar_energy energy;
    double largest = 0;
    for (int i = 0; i < 30; i++) {
        uint64_t steps = (uint64_t)(0.1 / lar_simulation_time_step(simulation));
        check(lar_simulation_advance(simulation, steps, &error));
        lar_simulation_energy(simulation, &energy);
        lar_simulation_contact(simulation, &info);
        largest = fmax(largest, energy.kinetic);
    }
    print_message("rest: kinetic energy %.1e of the largest, %d touching, deepest %.4f mm\n",
                  energy.kinetic / largest, (int)info.touching, 1e3 * info.deepest);
    assert_true(info.touching > 0);
    assert_below(energy.kinetic, 1e-4 * largest);
    assert_below(info.deepest, 0.02 * 0.004);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_on_a_plane),
        cmocka_unit_test(test_on_a_block),
        cmocka_unit_test(test_comes_to_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
