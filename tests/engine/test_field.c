/* Values for pictures: those of results, at any displacements, while somebody else computes. */
#include <pthread.h>

#include "engine/engine_test.h"
#include "mechanics/stress.h"

static const brick body = {{4, 3, 3}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

static double (*displacements(const lar_simulation *simulation))[3] {
    size_t nodes = (size_t)simulation->domain.model->mesh.node_count;
    double(*u)[3] = lar_calloc(nodes, sizeof *u);
    lar_simulation_displacements(simulation, u);
    return u;
}

/* Of an element, as results have it. */
static double expected_of(const lar_simulation *simulation, lar_field field, lar_gid e) {
    double cauchy[6];
    double energy =
        lar_measure_stress(&simulation->domain, lar_simulation_state(simulation), e, cauchy);
    return field == LAR_FIELD_ENERGY     ? energy
           : field == LAR_FIELD_PRESSURE ? lar_mean_pressure(cauchy)
                                         : lar_von_mises(cauchy);
}

static void compare_field(const lar_simulation *simulation, lar_field field) {
    const lar_mesh *mesh = &simulation->domain.model->mesh;
    size_t nodes = (size_t)mesh->node_count;
    double(*u)[3] = displacements(simulation), *sum = lar_calloc(nodes, sizeof *sum);
    float *out = lar_calloc(nodes, sizeof *out);
    int *count = lar_calloc(nodes, sizeof *count);
    lar_error error;
    if (lar_simulation_field(simulation, field, (const double(*)[3])u, out, &error))
        fail_msg("%s", error.message);
    for (lar_gid e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 8; a++) {
            sum[mesh->element[e][a]] += expected_of(simulation, field, e);
            count[mesh->element[e][a]]++;
        }
    for (size_t n = 0; n < nodes; n++) {
        double alone;
        if (out[n] != (float)(sum[n] / count[n]) || out[n] == 0)
            fail_msg("field %d, node %zu: %.9g instead of %.9g", (int)field, n, (double)out[n],
                     sum[n] / count[n]);
        assert_int_equal(lar_simulation_node_value(simulation, field, (int32_t)n,
                                                   (const double(*)[3])u, &alone, &error),
                         LAR_OK);
        assert_true(alone == sum[n] / count[n]);
    }
    for (lar_gid e = 0; e < mesh->element_count; e++) {
        double alone;
        assert_int_equal(lar_simulation_element_value(simulation, field, e, (const double(*)[3])u,
                                                      &alone, &error),
                         LAR_OK);
        assert_true(alone == expected_of(simulation, field, e));
    }
    free(count);
    free(out);
    free(sum);
    free(u);
}

/* All that the body stores at these displacements, as it says itself. */
static void compare_stored(const lar_simulation *simulation) {
    double(*u)[3] = displacements(simulation), strain, hourglass;
    lar_energy energy;
    lar_error error;
    assert_int_equal(lar_simulation_stored_energy(simulation, (const double(*)[3])u, &strain,
                                                  &hourglass, &error),
                     LAR_OK);
    lar_simulation_energy(simulation, &energy);
    assert_true(energy.strain > 0 && fabs(strain - energy.strain) <= 1e-9 * energy.strain);
    assert_true(fabs(hourglass - energy.hourglass) <= 1e-9 * energy.hourglass);
    free(u);
}

static void stresses_are_those_of_results(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&body);
    for (int kind = LAR_ELEMENT_HEX8; kind <= LAR_ELEMENT_HEX8_MATRIX; kind++) {
        lar_options options = lar_options_default();
        options.element = (lar_element_kind)kind;
        options.grid = kind == LAR_ELEMENT_HEX8 ? "2x1x1" : NULL;
        lar_simulation *simulation = start_with(model, options);
        advance(simulation, 40);
        compare_field(simulation, LAR_FIELD_VON_MISES);
        compare_field(simulation, LAR_FIELD_PRESSURE);
        compare_field(simulation, LAR_FIELD_ENERGY);
        compare_stored(simulation);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* All components, against the two numbers that results have of them, on every grid. */
static void tensors_of_elements(void **unused) {
    (void)unused;
    enum { MOST = 100 };
    static double stress[2][MOST][6], strain[2][MOST][6];
    lar_model *model = everything_model(&body);
    const int32_t elements = model->mesh.element_count;
    assert_true(elements <= MOST);
    lar_error error;
    for (int divided = 0; divided < 2; divided++) {
        lar_options options = lar_options_default();
        options.grid = divided ? "2x2x1" : NULL;
        lar_simulation *simulation = start_with(model, options);
        advance(simulation, 40);
        double(*u)[3] = displacements(simulation);
        assert_int_equal(
            lar_simulation_stresses(simulation, stress[divided], strain[divided], &error), LAR_OK);
        assert_int_equal(lar_simulation_stresses(simulation, NULL, NULL, &error), LAR_OK);
        for (int32_t e = 0; e < elements; e++) {
            double mises, pressure;
            const double *s = stress[divided][e];
            assert_int_equal(lar_simulation_element_value(simulation, LAR_FIELD_VON_MISES, e,
                                                          (const double(*)[3])u, &mises, &error),
                             LAR_OK);
            assert_int_equal(lar_simulation_element_value(simulation, LAR_FIELD_PRESSURE, e,
                                                          (const double(*)[3])u, &pressure, &error),
                             LAR_OK);
            assert_true(lar_von_mises(s) == mises && lar_mean_pressure(s) == pressure);
        }
        free(u);
        lar_simulation_destroy(simulation);
    }
    assert_memory_equal(stress[0], stress[1], (size_t)elements * sizeof stress[0][0]);
    assert_memory_equal(strain[0], strain[1], (size_t)elements * sizeof strain[0][0]);
    assert_true(strain[0][0][0] != 0);
    assert_int_equal(lar_simulation_stresses(NULL, stress[0], NULL, &error), LAR_ERROR_ARGUMENT);
    lar_model_destroy(model);
}

static void lengths_and_processors(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&body);
    lar_options options = lar_options_default();
    options.grid = "2x2x1";
    lar_simulation *divided = start_with(model, options), *alone = start(model);
    advance(divided, 30);
    double(*u)[3] = displacements(divided);
    float out[100];
    int32_t nodes = model->mesh.node_count, seen = 0;
    lar_error error;
    assert_true(nodes <= 100);
    assert_int_equal(
        lar_simulation_field(divided, LAR_FIELD_DISPLACEMENT, (const double(*)[3])u, out, &error),
        LAR_OK);
    for (int32_t n = 0; n < nodes; n++)
        assert_true(out[n] ==
                    (float)sqrt(u[n][0] * u[n][0] + u[n][1] * u[n][1] + u[n][2] * u[n][2]));
    assert_int_equal(
        lar_simulation_field(divided, LAR_FIELD_PROCESSOR, (const double(*)[3])u, out, &error),
        LAR_OK);
    for (int32_t n = 0; n < nodes; n++) {
        assert_true(out[n] == (float)divided->computer->division.reporter[n]);
        seen |= 1 << (int)out[n];
    }
    assert_int_equal(seen, 15);
    assert_int_equal(
        lar_simulation_field(alone, LAR_FIELD_PROCESSOR, (const double(*)[3])u, out, &error),
        LAR_OK);
    for (int32_t n = 0; n < nodes; n++) assert_true(out[n] == 0);
    free(u);
    lar_simulation_destroy(alone);
    finish(divided, model);
}

/* No NaN in a picture: an element that is inside out is left out, a torn body is refused. */
static void broken_bodies(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&body);
    lar_simulation *simulation = start(model);
    double(*u)[3] = displacements(simulation);
    float out[100];
    lar_error error = {0};
    int32_t corner = brick_node(&body, 4, 3, 3), middle = brick_node(&body, 2, 2, 2);
    u[corner][0] = -0.05;
    u[middle][2] = 1e20;
    assert_int_equal(
        lar_simulation_field(simulation, LAR_FIELD_VON_MISES, (const double(*)[3])u, out, &error),
        LAR_OK);
    for (int32_t n = 0; n < model->mesh.node_count; n++) assert_true(isfinite(out[n]));
    assert_true(out[corner] == 0);
    double value = 7;
    assert_int_equal(lar_simulation_node_value(simulation, LAR_FIELD_VON_MISES, corner,
                                               (const double(*)[3])u, &value, &error),
                     LAR_OK);
    assert_true(value == 0);
    u[middle][2] = NAN;
    assert_int_equal(
        lar_simulation_field(simulation, LAR_FIELD_VON_MISES, (const double(*)[3])u, out, &error),
        LAR_ERROR_UNSTABLE);
    assert_non_null(strstr(error.message, "node 53 "));
    assert_int_equal(
        lar_simulation_field(simulation, LAR_FIELD_VELOCITY, (const double(*)[3])u, out, &error),
        LAR_ERROR_UNSTABLE);
    u[middle][2] = 0;
    assert_int_equal(
        lar_simulation_field(simulation, LAR_FIELD_VELOCITY, (const double(*)[3])u, out, &error),
        LAR_ERROR_ARGUMENT);
    assert_int_equal(
        lar_simulation_field(simulation, (lar_field)6, (const double(*)[3])u, out, &error),
        LAR_ERROR_ARGUMENT);
    free(u);
    finish(simulation, model);
}

typedef struct painter {
    const lar_simulation *simulation;
    const double (*u)[3];
    const float *expected;
    bool *stop;
    int pictures, different;
} painter;

static void *paint(void *context) {
    painter *p = context;
    size_t nodes = (size_t)p->simulation->domain.model->mesh.node_count;
    float *out = lar_calloc(nodes, sizeof *out);
    do {
        lar_error error;
        lar_status status =
            lar_simulation_field(p->simulation, LAR_FIELD_VON_MISES, p->u, out, &error);
        p->different += status || memcmp(out, p->expected, nodes * sizeof *out) != 0;
        p->pictures++;
    } while (!__atomic_load_n(p->stop, __ATOMIC_RELAXED) || p->pictures < 3);
    free(out);
    return NULL;
}

/* Several ask for the first time at once, and on while the state moves and goes back. */
static void pictures_while_it_computes(void **unused) {
    (void)unused;
    enum { PAINTERS = 3 };
    lar_model *model = everything_model(&body);
    lar_options options = lar_options_default();
    options.grid = "2x1x1";
    lar_simulation *simulation = start_with(model, options), *other = start(model);
    advance(other, 40);
    double(*u)[3] = displacements(other);
    float *expected = lar_calloc((size_t)model->mesh.node_count, sizeof *expected);
    lar_error error;
    assert_int_equal(
        lar_simulation_field(other, LAR_FIELD_VON_MISES, (const double(*)[3])u, expected, &error),
        LAR_OK);
    bool stop = false;
    pthread_t thread[PAINTERS];
    painter p[PAINTERS];
    for (int i = 0; i < PAINTERS; i++) {
        p[i] = (painter){simulation, (const double(*)[3])u, expected, &stop, 0, 0};
        assert_int_equal(pthread_create(&thread[i], NULL, paint, &p[i]), 0);
    }
    for (int i = 0; i < 3; i++) {
        advance(simulation, 50);
        if (lar_simulation_reset(simulation, &error)) fail_msg("%s", error.message);
    }
    __atomic_store_n(&stop, true, __ATOMIC_RELAXED);
    for (int i = 0; i < PAINTERS; i++) {
        pthread_join(thread[i], NULL);
        assert_int_equal(p[i].different, 0);
    }
    free(expected);
    free(u);
    lar_simulation_destroy(other);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tensors_of_elements),
        cmocka_unit_test(stresses_are_those_of_results),
        cmocka_unit_test(lengths_and_processors),
        cmocka_unit_test(broken_bodies),
        cmocka_unit_test(pictures_while_it_computes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
