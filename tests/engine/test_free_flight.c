/* Nothing comes from nothing: a free body keeps its momentum, and a closed path of loads leaves no
 * force behind. */
#include "engine/engine_test.h"

typedef struct momentum {
    double linear[3], angular[3];
    double linear_size, angular_size; /* sums of the absolute contributions */
} momentum;

static momentum measure_momentum(const lar_simulation *simulation) {
    const lar_domain *domain = &simulation->domain;
    momentum sum = {0};
    for (int32_t g = 0; g < domain->model->mesh.node_count; g++) {
        int32_t n = domain->layout.local[g];
        const double *v = node_v(simulation, g), *u = node_u(simulation, g);
        const double *X = domain->model->mesh.position[g];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            double left = domain->mass[n] * (X[j] + u[j]) * v[k];
            double right = domain->mass[n] * (X[k] + u[k]) * v[j];
            sum.linear[i] += domain->mass[n] * v[i];
            sum.angular[i] += left - right;
            sum.linear_size += fabs(domain->mass[n] * v[i]);
            sum.angular_size += fabs(left) + fabs(right);
        }
    }
    return sum;
}

static void compare(const momentum *a, const momentum *b) {
    for (int i = 0; i < 3; i++) {
        assert_below(fabs(a->linear[i] - b->linear[i]) / a->linear_size, 1e-12);
        assert_below(fabs(a->angular[i] - b->angular[i]) / a->angular_size, 1e-10);
    }
}

static void tumble(lar_law law, lar_element_kind kind, int rounds) {
    brick b = soft_brick;
    b.law = law;
    lar_model *model = brick_model(&b);
    throw_body(model, (double[]){0.3, -0.2, 0.1}, (double[]){20, -35, 15}, 0.15);
    lar_options options = lar_options_default();
    options.element = kind;
    options.time_step = 3e-4;
    lar_simulation *simulation = start_with(model, options);
    momentum before = measure_momentum(simulation);
    double share = 0; /* of strain energy, at its highest: any one moment may be a zero crossing */
    for (int round = 0; round < 100 * rounds; round++) {
        lar_energy energy;
        advance(simulation, 10);
        lar_simulation_energy(simulation, &energy);
        share = fmax(share, (energy.strain + energy.hourglass) / energy.kinetic);
        if (round % 100 != 99) continue;
        momentum now = measure_momentum(simulation);
        compare(&before, &now);
    }
    assert_true(share > 0.02); /* it does vibrate */
    finish(simulation, model);
}

static void a_tumbling_body_keeps_its_momentum(void **unused) {
    (void)unused;
    for (int law = 0; law < LAR_LAW_COUNT; law++) tumble((lar_law)law, LAR_ELEMENT_HEX8, 12);
}

static void the_oracle_elements_keep_it_too(void **unused) {
    (void)unused;
    tumble(LAR_LAW_neo_hookean, LAR_ELEMENT_HEX8_FULL, 1);
}

/* Four nodes lead the top of a body around a closed path; when it is back and has come to rest, all
 * forces are zero again. */
static void a_closed_path_leaves_no_force(void **unused) {
    (void)unused;
    static const double there_and_back[4][2] = {{0, 0}, {0.2, 1}, {0.4, -0.7}, {0.6, 0}};
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        brick b = soft_brick;
        b.law = (lar_law)law;
        lar_model *model = brick_model(&b);
        fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
        int curve = add_table(model, LAR_CURVE_SMOOTH, 4, there_and_back);
        move_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_X, 0.008, curve);
        move_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_Z, 0.005, curve);
        model->damping = 60;
        lar_simulation *simulation = start(model);
        double highest = 0;
        while (lar_simulation_time(simulation) < 2.5) {
            advance(simulation, 100);
            double *force = residual_forces(simulation);
            for (size_t i = 0; i < 3 * simulation->state.stride; i++)
                if (lar_simulation_time(simulation) < 0.6) highest = fmax(highest, fabs(force[i]));
            free(force);
        }
        double *force = residual_forces(simulation);
        for (size_t i = 0; i < 3 * simulation->state.stride; i++)
            assert_below(fabs(force[i]), 1e-12 * characteristic_force(&b));
        assert_true(highest > 0.01 * characteristic_force(&b));
        free(force);
        finish(simulation, model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tumbling_body_keeps_its_momentum),
        cmocka_unit_test(the_oracle_elements_keep_it_too),
        cmocka_unit_test(a_closed_path_leaves_no_force),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
