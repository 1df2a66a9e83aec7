/* Abaqus decks of a cube, read as they are and followed as `lariat run` does: what a viscous
 * material answers in static and quasi-static steps, against what is known in closed form, and
 * static answers whatever units a deck has. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "validation/reference.h"

#define CUBE                                                                                       \
    "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n"  \
    "8, 0, 1, 1\n*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=X0\n"        \
    "1, 4, 5, 8\n*NSET, NSET=X1\n2, 3, 6, 7\n*NSET, NSET=Y0\n1, 2, 5, 6\n*NSET, NSET=Z0\n"         \
    "1, 2, 3, 4\n*SOLID SECTION, ELSET=E, MATERIAL=M\n*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n"
#define PULL "*BOUNDARY\nX1, 1, 1, 0.01\n"
#define LOAD "*CLOAD\nX1, 1, 0.01\n"

typedef struct answer {
    double stress, displacement; /* along x */
    uint64_t steps;
} answer;

static answer follow(const char *text) {
    lar_model *model = NULL;
    lar_error error;
    lar_bytes bytes = {(unsigned char *)(uintptr_t)text, strlen(text)};
    if (lar_inp_deck_parse("deck.inp", &bytes, &model, &error)) fail_msg("%s", error.message);
    lar_simulation *simulation = start(model, LAR_ELEMENT_HEX8);
    lar_rest rest;
    lar_rest_begin(&rest, simulation);
    if (!lar_model_until_rest(model)) run_until(simulation, lar_model_duration(model));
    while (lar_model_until_rest(model) && !lar_rest_look(&rest, simulation) &&
           rest.next <= rest.limit)
        if (lar_simulation_advance(simulation, rest.next - lar_simulation_steps(simulation),
                                   &error))
            fail_msg("%s", error.message);
    assert_true(!lar_model_until_rest(model) || rest.reached);
    double cauchy[1][6];
    if (lar_simulation_stresses(simulation, cauchy, NULL, &error)) fail_msg("%s", error.message);
    answer found = {cauchy[0][0], displacement(simulation, 1, 0), lar_simulation_steps(simulation)};
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return found;
}

static void near(double value, double wanted, double bound) {
    assert_within(fabs(value / wanted - 1), bound);
}

/* G is 1 in the end and 2.5 at once, K = 100. */
static answer viscous(double tau, const char *option, const char *procedure, const char *load) {
    char text[2000];
    snprintf(text, sizeof text,
             CUBE "*MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n0.5, 0.02\n*VISCOELASTIC, "
                  "TIME=PRONY\n0.6, 0, %g\n*STEP, NLGEOM%s\n%s\n0.1, 1\n%s*END STEP\n",
             tau, option, procedure, load);
    return follow(text);
}

/* A static step does not know time; *VISCO relaxes by what is left of exp(-t/tau): of a sudden
 * strain at the end, of one that grows evenly on the mean. */
static void a_cube_that_relaxes(void **unused) {
    (void)unused;
    for (double tau = 0.1; tau < 2000; tau *= 10) {
        answer at_once = viscous(tau, "", "*STATIC", PULL);
        answer in_the_end = viscous(tau, "", "*STATIC, LONG TERM", PULL);
        near(at_once.stress, 0.07436, 1e-4);
        near(in_the_end.stress, 0.02990, 1e-4);
        double relaxes = at_once.stress - in_the_end.stress;
        answer sudden = viscous(tau, ", AMPLITUDE=STEP", "*VISCO", PULL);
        answer grown = viscous(tau, "", "*VISCO", PULL);
        near(sudden.stress, in_the_end.stress + relaxes * exp(-1 / tau), 3e-3);
        near(grown.stress, in_the_end.stress + relaxes * tau * (1 - exp(-1 / tau)), 1e-3);
        print_message("tau %g s: %.5f sudden, %.5f grown\n", tau, sudden.stress, grown.stress);
    }
}

/* Under a force that stays it creeps with the time tau G0/G. */
static void a_cube_that_creeps(void **unused) {
    (void)unused;
    for (double tau = 0.1; tau < 2000; tau *= 10) {
        double first = viscous(tau, "", "*STATIC", LOAD).displacement;
        double last = viscous(tau, "", "*STATIC, LONG TERM", LOAD).displacement;
        answer now = viscous(tau, "", "*VISCO", LOAD);
        print_message("tau %g s: %.6f m, from %.6f to %.6f\n", tau, now.displacement, first, last);
        near(now.displacement, last + (first - last) * exp(-1 / (2.5 * tau)), 0.015);
    }
}

/* Steps are those of loads that come in 2 to 20 periods. */
static void any_units(void **unused) {
    (void)unused;
    static const struct {
        const char *density, *step;
    } decks[] = {{"", "0.1, 1"},
                 {"*DENSITY\n1.1e-9\n", "0.1, 1"},
                 {"*DENSITY\n1e6\n", "0.1, 1"},
                 {"", "5e-8, 1e-6"},
                 {"*DENSITY\n1.1e-9\n", "100, 1e5"}};
    for (size_t i = 0; i < sizeof decks / sizeof *decks; i++) {
        char text[2000];
        snprintf(text, sizeof text,
                 CUBE "*MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n0.5, 0.02\n%s*STEP, NLGEOM\n"
                      "*STATIC\n%s\n" PULL "*END STEP\n",
                 decks[i].density, decks[i].step);
        answer found = follow(text);
        near(found.stress, 0.0298973, 3e-6);
        assert_true(found.steps < 5000);
    }
}

/* Whatever the mass is, what weighs keeps its weight: on the lower face of the cube. */
static void a_cube_with_weight(void **unused) {
    (void)unused;
    for (double density = 1e-9; density < 1e7; density *= 1e5) {
        char text[2000];
        snprintf(text, sizeof text,
                 CUBE "*MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n0.5, 0.02\n*DENSITY\n%g\n"
                      "*STEP, NLGEOM\n*STATIC\n*DLOAD\n, GRAV, %g, -1, 0, 0\n*END STEP\n",
                 density, 0.02 / density);
        answer found = follow(text);
        near(found.stress, -0.01, 0.02); /* half of it weighs on the middle */
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cube_that_relaxes),
        cmocka_unit_test(a_cube_that_creeps),
        cmocka_unit_test(any_units),
        cmocka_unit_test(a_cube_with_weight),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
