/* What the tests of friction on planes and between bodies share: a block on a slope, where it
 * starts to slide, and the same bits everywhere. */
#ifndef LAR_TESTS_FRICTION_TEST_H
#define LAR_TESTS_FRICTION_TEST_H

#include "engine/engine_test.h"
#include "engine/tool_contact_test.h"

/* Stiff, so that the block is nearly rigid; low and long, so that no edge of it lifts. */
static const brick block = {{6, 4, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e5, 4e5, 1000};
static const double weight = 9.81;

/* Gravity is turned instead of what the block stands on. */
TEST_UNUSED static void tilt(lar_model *model, double friction, double angle) {
    model->contact[0].friction = friction;
    model->gravity[0] = weight * sin(angle);
    model->gravity[2] = -weight * cos(angle);
}

/* Mean displacement and velocity along the slope, of the nodes from `first` on. */
TEST_UNUSED static void mean_slide_of(const lar_simulation *s, int32_t first, double *way,
                                      double *speed) {
    double mass = 0, u = 0, v = 0;
    for (int32_t n = first; n < s->domain.model->mesh.node_count; n++) {
        double m = s->domain.mass[s->domain.layout.local[n]];
        u += m * node_u(s, n)[0];
        v += m * node_v(s, n)[0];
        mass += m;
    }
    *way = u / mass;
    *speed = v / mass;
}

/* A block on a slope; its nodes are those from `first` on. */
typedef struct slope {
    lar_model *(*make)(double friction, double angle);
    int32_t first;
    double settled; /* when it has come to rest on the slope, which is steep after 0.4 s [s] */
} slope;

/* How far it gets in 0.3 s. Damping keeps what slides from trembling, and slows it: to a / c. */
TEST_UNUSED static double slides(const slope *on, double friction, double angle, double damping) {
    lar_model *model = on->make(friction, angle);
    model->damping = damping;
    model->gravity_curve[0] = add_ramp(model, 0.4);
    lar_simulation *s = start(model);
    double way, before, speed;
    while (lar_simulation_time(s) < on->settled) advance(s, 100);
    mean_slide_of(s, on->first, &before, &speed);
    while (lar_simulation_time(s) < on->settled + 0.3) advance(s, 100);
    mean_slide_of(s, on->first, &way, &speed);
    finish(s, model);
    return way - before;
}

TEST_UNUSED static void starts_to_slide_at_the_angle_of_friction(const slope *on) {
    static const double frictions[] = {0.1, 0.3, 0.5}, damping = 100;
    for (int i = 0; i < 3; i++) {
        double angle = atan(frictions[i]), below = slides(on, frictions[i], 0.99 * angle, damping);
        double above = slides(on, frictions[i], 1.01 * angle, damping);
        double a = weight * (sin(1.01 * angle) - frictions[i] * cos(1.01 * angle));
        print_message("friction %.1f: slides %.2e m in 0.3 s at 0.99 of its angle, %.2e m at 1.01; "
                      "rigid %.2e m\n",
                      frictions[i], below, above, a / damping * 0.3);
        assert_below(fabs(below), 1e-9);
        assert_below(0.5 * a / damping * 0.3, above);
        assert_below(above, 6 * a / damping * 0.3);
    }
}

/* ---- the same bits --------------------------------------------------------------------------- */

/* A run in two parts: `half_way` steps and the rest. */
typedef struct halves {
    uint64_t half_way, end;
} halves;

/* At the end; from a checkpoint half way, where there is one. */
TEST_UNUSED static uint64_t hash_of(const lar_model *model, lar_options options, const char *from,
                                    halves run) {
    lar_simulation *s = start_with(model, options);
    lar_error error;
    if (from && lar_simulation_load(s, from, &error)) fail_msg("%s", error.message);
    advance(s, from ? run.end - run.half_way : run.end);
    uint64_t hash = lar_simulation_hash(s);
    lar_simulation_destroy(s);
    return hash;
}

/* On grids and threads, whole and from the checkpoint, and with every instruction set. */
TEST_UNUSED static void has_the_same_bits(const lar_model *model, const char *checkpoint,
                                          halves run, uint64_t hash) {
    static const char *const grids[] = {"1x1x1", "2x1x1", "2x2x1", "1x1x1", "2x1x1", "1x1x2"};
    static const int32_t threads[] = {1, 1, 1, 3, 2, 2};
    static const lar_isa sets[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    for (int g = 0; g < 6; g++) {
        lar_options options = lar_options_default();
        options.grid = grids[g];
        options.threads = threads[g];
        assert_true(hash_of(model, options, NULL, run) == hash);
        assert_true(hash_of(model, options, checkpoint, run) == hash);
    }
    for (int i = 0; i < 4; i++) {
        const lar_kernels *kernels;
        if (lar_kernels_find(sets[i], &kernels, NULL)) continue;
        lar_options options = lar_options_default();
        options.isa = sets[i];
        assert_true(hash_of(model, options, NULL, run) == hash);
    }
}

#endif
