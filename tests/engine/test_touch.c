/* Tools and fixed planes against a body: energy, balance, rest, and the same bits everywhere. */
#include "engine/engine_test.h"
#include "engine/touch_test.h"

/* Nearly incompressible and firm: pressure waves of 45 m/s, shear waves above the 5 m/s at which it
 * is dropped. */
static const brick tissue = {{3, 2, 2}, 0.01, 0.1, LAR_LAW_neo_hookean, 4e4, 2e6, 1000};

/* ---- planes -------------------------------------------------------------------------------- */

/* A body that falls onto a plane: on its side, or on an edge when the plane is tilted. */
static lar_model *falling_model(const brick *b, double speed, bool tilted) {
    lar_model *model = brick_model(b);
    const double up[3] = {tilted ? 0.2 : 0, tilted ? -0.3 : 0, 1}, below[3] = {0, 0.02, -0.0025};
    add_plane(model, below, up);
    const double *normal = model->contact[0].normal;
    fall(model, (double[]){-speed * normal[0], -speed * normal[1], -speed * normal[2]});
    return model;
}

static void drop(const brick *b, double speed, bool tilted, double share_of_stable,
                 double damping) {
    lar_model *model = falling_model(b, speed, tilted);
    lar_options options = lar_options_default();
    options.time_step = share_of_stable * stable_step_of(model);
    model->damping = damping;
    lar_simulation *simulation = start_with(model, options);
    lar_energy e;
    double start = body_energy(simulation, &e), highest = 0, lowest = INFINITY, error = 0;
    uint64_t steps = (uint64_t)(0.02 / speed / options.time_step);
    uint64_t stride = steps / 1000 + 1;
    lar_contact_info info = {0};
    int32_t touching = 0;
    double deepest = 0;
    for (uint64_t i = 0; i < steps; i += stride) {
        advance(simulation, stride);
        double now = body_energy(simulation, &e);
        highest = fmax(highest, now / start);
        lowest = fmin(lowest, now / start);
        error = fmax(error, fabs(now + e.damping + e.contact - e.external - start) / start);
        info = simulation->domain.acting.touch.seen;
        if (info.touching > touching) touching = info.touching;
        deepest = fmax(deepest, info.deepest);
    }
    print_message("%.2f m/s at %.3f of the stable step: energy %.6f to %.6f of the start, balance "
                  "%.1e, %d nodes touched, %.1e m deep, %.0f searches in %.0f steps\n",
                  speed, share_of_stable, lowest, highest, error, (int)touching, deepest,
                  (double)info.searches, (double)info.steps);
    assert_true(touching > 0);
    assert_below(highest, 1.001);
    /* Second order in the step, as of all that is not linear (test_energy.c). */
    assert_below(error, share_of_stable < 0.5 ? 2e-3 : 5e-2);
    assert_below(deepest, 1e-12);
    finish(simulation, model);
}

static void a_dropped_body_gains_no_energy(void **unused) {
    (void)unused;
    static const double speeds[] = {0.01, 0.1, 1, 5}, shares[] = {0.2, 0.8, 0.999};
    brick regular = tissue;
    regular.shift = 0; /* its fastest mode is exactly at the elements' bound */
    for (int s = 0; s < 4; s++)
        for (int k = 0; k < 3; k++) {
            drop(&tissue, speeds[s], k > 1, shares[k], 0);
            drop(&regular, speeds[s], k < 1, shares[k], 0);
        }
}

static void every_joule_of_a_plane_is_accounted_for(void **unused) {
    (void)unused;
    drop(&tissue, 0.3, true, 0.3, 20);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_dropped_body_gains_no_energy),
        cmocka_unit_test(every_joule_of_a_plane_is_accounted_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
