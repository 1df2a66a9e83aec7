/* Decks of FEBio's own test suite, read as they are and run with the element that FEBio uses. What
 * is compared is FEBio's gold standard: the L2 norm of the free displacement unknowns at the end. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "validation/reference.h"

static double gold_standard(const char *deck) {
    lar_bytes bytes;
    lar_error error;
    double value = NAN;
    assert_int_equal(
        lar_bytes_read(reference_path("data/bench/febio/gold_standards.csv"), &bytes, &error),
        LAR_OK);
    lar_text text = lar_text_from(&bytes);
    for (lar_span line; lar_text_line(&text, &line);) {
        lar_span head, rest = line;
        if (!lar_span_split(line, ',', &head, &rest) || !lar_span_equal(head, deck)) continue;
        while (lar_span_split(rest, ',', &head, &rest)) continue;
        lar_span_double(lar_span_trim(head), &value); /* the last column */
    }
    lar_bytes_free(&bytes);
    assert_false(isnan(value));
    return value;
}

static lar_model *open_deck(const char *deck) {
    char relative[128];
    lar_model *model = NULL;
    lar_error error;
    snprintf(relative, sizeof relative, "data/bench/febio/%s.feb", deck);
    if (lar_model_open(reference_path(relative), &model, &error)) fail_msg("%s", error.message);
    return model;
}

/* L2 norm over the displacements that nothing fixes or prescribes. */
static double free_norm(const lar_simulation *simulation) {
    const lar_domain *domain = &simulation->domain;
    double square = 0;
    for (int32_t n = 0; n < domain->node_count; n++)
        for (int i = 0; i < 3; i++) {
            double u = simulation->state.u[4 * n + i];
            square += u * u;
        }
    for (int32_t i = 0; i < domain->conditions.constraint_count; i++) {
        double u = simulation->state.u[domain->conditions.constraint[i].value];
        square -= u * u;
    }
    return sqrt(square);
}

static void static_deck(const char *deck) {
    for (int kind = 1; kind >= 0; kind--) {
        lar_model *model = open_deck(deck);
        assert_true(model->damping > 0);
        lar_simulation *simulation = start(model, kind ? LAR_ELEMENT_HEX8_FULL : LAR_ELEMENT_HEX8);
        begin_report();
        run_until(simulation, lar_model_duration(model));
        run_to_rest(simulation, 1e-9, 100 / model->damping);
        double difference = report(deck, kind ? "hex8-full" : "hex8", "deck", "L2 norm [m]",
                                   gold_standard(deck), free_norm(simulation), simulation);
        assert_within(difference, 0.02);
        lar_simulation_destroy(simulation);
        lar_model_destroy(model);
    }
}

/* A Mooney-Rivlin block, 20x5x5, pulled between clamped ends. */
static void tu01_a_stretched_block(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    static_deck("tu01");
}

/* A Mooney-Rivlin block with graded elements, stretched. */
static void mi27_a_graded_block(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    static_deck("mi27");
}

/* L2 norm at the model's end for one time step (0: automatic). */
static double dynamic_norm(const char *deck, lar_element_kind kind, double step) {
    lar_model *model = open_deck(deck);
    lar_options options = lar_options_default();
    lar_simulation *simulation = NULL;
    lar_error error;
    options.element = kind;
    options.time_step = step;
    if (lar_simulation_create(model, &options, &simulation, &error)) fail_msg("%s", error.message);
    begin_report();
    uint64_t steps = (uint64_t)llround(lar_model_duration(model) /
                                       lar_simulation_time_step(simulation));
    if (lar_simulation_advance(simulation, steps, &error)) fail_msg("%s", error.message);
    char mesh[64];
    snprintf(mesh, sizeof mesh, "deck, step %.3g s", lar_simulation_time_step(simulation));
    double norm = free_norm(simulation);
    report(deck, kind ? "hex8-full" : "hex8", mesh, "L2 norm [m]", gold_standard(deck), norm,
           simulation);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return norm;
}

/* One element in free fall for a second: sqrt(8) / 2 g. */
static void dy01_free_fall(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    assert_within(fabs(dynamic_norm("dy01", LAR_ELEMENT_HEX8_FULL, 1e-3) / sqrt(2) - 1), 0.002);
    assert_within(fabs(dynamic_norm("dy01", LAR_ELEMENT_HEX8, 1e-4) / sqrt(2) - 1), 0.0002);
}

static void dy02_a_board_that_swings(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    dynamic_norm("dy02", LAR_ELEMENT_HEX8_FULL, 0);
    dynamic_norm("dy02", LAR_ELEMENT_HEX8_FULL, 0.001);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tu01_a_stretched_block),
        cmocka_unit_test(mi27_a_graded_block),
        cmocka_unit_test(dy01_free_fall),
        cmocka_unit_test(dy02_a_board_that_swings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
