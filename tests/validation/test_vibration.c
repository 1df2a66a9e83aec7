/* The cantilever's first natural frequency against CalculiX: a small free vibration, timed by the
 * zero crossings of its share of the static shape. */
#include "validation/beam.h"

#include <math.h>
#include <stdlib.h>

#define CONVERGED_FREQUENCY 0.2805 /* Hz, nu = 0.45 */

/* The shape under a weight so small that everything is linear: nearly the first mode. */
static void static_shape(const beam_mesh *mesh, double (*shape)[3]) {
    lar_model *model = beam_model(mesh, 45);
    set_ramp(model, 0, 0, 1, 0, 1e-5);
    lar_simulation *simulation = start(model, LAR_ELEMENT_HEX8);
    run_until(simulation, 1);
    run_to_rest(simulation, 1e-7, 40);
    lar_simulation_displacements(simulation, shape);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

/* sum m u . shape over the nodes: higher modes hardly appear in it. */
static double modal_share(const lar_simulation *simulation, double (*shape)[3]) {
    double sum = 0;
    const lar_domain *domain = &simulation->domain;
    for (int32_t g = 0; g < domain->model->mesh.node_count; g++)
        for (int i = 0; i < 3; i++)
            sum += domain->mass[domain->layout.local[g]] * displacement(simulation, g, i) *
                   shape[g][i];
    return sum;
}

static double frequency(const beam_mesh *mesh) {
    enum { CROSSINGS = 9, STRIDE = 20 };
    lar_model *model = beam_model(mesh, 45);
    model->damping = 0;
    double(*shape)[3] = lar_calloc((size_t)model->mesh.node_count, sizeof *shape);
    assert_non_null(shape);
    static_shape(mesh, shape);
    lar_simulation *simulation = start(model, LAR_ELEMENT_HEX8);
    set_displacements(simulation, shape);
    begin_report();
    double first = 0, last = 0, before = modal_share(simulation, shape);
    for (int crossing = 0; crossing < CROSSINGS && lar_simulation_time(simulation) < 60;) {
        double from = lar_simulation_time(simulation);
        lar_error error;
        assert_int_equal(lar_simulation_advance(simulation, STRIDE, &error), LAR_OK);
        double now = modal_share(simulation, shape);
        if ((before < 0) != (now < 0)) {
            last = from + (lar_simulation_time(simulation) - from) * before / (before - now);
            if (crossing++ == 0) first = last;
        }
        before = now;
    }
    double result = 0.5 * (CROSSINGS - 1) / (last - first);
    report("vibration, nu 0.45", "hex8", mesh->name, "first frequency [Hz]", CONVERGED_FREQUENCY,
           result, simulation);
    free(shape);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return result;
}

static void the_beam_vibrates_at_its_frequency(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    assert_within(fabs(frequency(&beam_meshes[0]) / CONVERGED_FREQUENCY - 1), 0.05);
    assert_within(fabs(frequency(&beam_meshes[1]) / CONVERGED_FREQUENCY - 1), 0.01);
    assert_within(fabs(frequency(&beam_meshes[2]) / CONVERGED_FREQUENCY - 1), 0.005);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_beam_vibrates_at_its_frequency)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
