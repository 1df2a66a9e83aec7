/* Where the energy goes: undamped bodies keep it, and with damping, gravity, moved supports,
 * pressure and nodal loads every joule is accounted for. */
#include "engine/engine_test.h"

static double total(const lar_energy *e) {
    return e->kinetic + e->strain + e->hourglass;
}

/* Slope of a regression line through `count` equidistant values, times the whole time, and its
 * standard error. */
static double trend(const double *value, int count, double *standard_error) {
    double mean = 0, sxy = 0, sxx = 0, squares = 0;
    for (int i = 0; i < count; i++) mean += value[i] / count;
    for (int i = 0; i < count; i++) {
        double x = i - 0.5 * (count - 1);
        sxx += x * x;
        sxy += x * (value[i] - mean);
    }
    for (int i = 0; i < count; i++) {
        double rest = value[i] - mean - sxy / sxx * (i - 0.5 * (count - 1));
        squares += rest * rest;
    }
    *standard_error = sqrt(squares / (count - 2) / sxx) * count;
    return sxy / sxx * count;
}

/* The total is not quite constant: what central differences conserve differs from it by a ripple of
 * second order in the step, whose mean wanders a little while the modes exchange their energy. A
 * scheme or an element that makes or eats energy would show as a trend above it. */
static void vibrate(lar_law law, bool held) {
    enum { SAMPLES = 2000, STRIDE = 50 };
    static double value[SAMPLES];
    brick b = soft_brick;
    b.law = law;
    lar_model *model = brick_model(&b);
    if (held) fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
    throw_body(model, (double[]){0, 0, 0}, (double[]){0, held ? 2 : 1, -1}, 0.06);
    lar_options options = lar_options_default();
    /* A sixth of the stable step; half of that for a law that stiffens in this swing, whose ripple
     * is four times as large: over 100,000 steps of 2e-4 s its mean goes down by 1.2e-4. */
    options.time_step = law == LAR_LAW_veronda_westmann ? 1e-4 : 2e-4;
    lar_simulation *simulation = start_with(model, options);
    lar_energy energy;
    advance(simulation, STRIDE);
    double strain = 0, highest = 0, lowest = INFINITY;
    for (int i = 0; i < SAMPLES; i++) {
        lar_simulation_energy(simulation, &energy);
        value[i] = total(&energy);
        highest = fmax(highest, value[i]);
        lowest = fmin(lowest, value[i]);
        strain = fmax(strain, (energy.strain + energy.hourglass) / value[i]);
        advance(simulation, STRIDE);
    }
    assert_true(lar_simulation_steps(simulation) >= 100000);
    assert_true(strain > 0.2);                       /* a real vibration */
    assert_below((highest - lowest) / lowest, 2e-3); /* within 0.1% of the middle */
    double error, slope = trend(value, SAMPLES, &error);
    assert_below(fabs(slope) / value[0], 1e-4);
    print_message("%s, %s: spread %.2g, trend %.2g +- %.2g over 100,000 steps\n", lar_law_name[law],
                  held ? "held" : "free", (highest - lowest) / lowest, slope / value[0],
                  error / value[0]);
    finish(simulation, model);
}

static void an_undamped_body_keeps_its_energy(void **unused) {
    (void)unused;
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        for (int held = law % test_every(2); held < 2; held += test_every(2))
            vibrate((lar_law)law, held);
}

/* ---- the balance ---------------------------------------------------------------------------- */

enum { DAMPED = 1, HEAVY = 2, HEAVY_CURVE = 4, MOVED = 8, PRESSED = 16, LOADED = 32 };

static lar_model *busy_model(unsigned what) {
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    static const double up_and_down[4][2] = {{0, 0}, {0.1, 1}, {0.2, -0.5}, {0.3, 0.8}};
    int ramp = add_ramp(model, 0.1);
    int table = add_table(model, LAR_CURVE_SMOOTH, 4, up_and_down);
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
    if (what & DAMPED) model->damping = 8;
    if (what & (HEAVY | HEAVY_CURVE)) memcpy(model->gravity, (double[]){3, -2, -9.81}, 24);
    if (what & HEAVY_CURVE)
        for (int i = 0; i < 3; i++) model->gravity_curve[i] = table;
    if (what & MOVED) move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_X, 0.006, table);
    if (what & MOVED) move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_Y, 0.004, ramp);
    if (what & PRESSED) press(model, 5, 150, table);
    if (what & LOADED) load_nodes(model, brick_side(&b, 2, -1), 0.001, 0.002, -0.003, table);
    return model;
}

/* Largest error of the balance over the largest external work. */
static double imbalance(unsigned what, lar_element_kind kind, double step, double *work) {
    lar_model *model = busy_model(what);
    lar_options options = lar_options_default();
    options.element = kind;
    options.time_step = step;
    lar_simulation *simulation = start_with(model, options);
    double worst = 0;
    *work = 0;
    while (lar_simulation_time(simulation) < 0.5) {
        lar_energy e;
        advance(simulation, 10);
        lar_simulation_energy(simulation, &e);
        worst = fmax(worst, fabs(total(&e) + e.damping - e.external));
        *work = fmax(*work, fabs(e.external));
    }
    finish(simulation, model);
    return worst / *work;
}

static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    static const unsigned cases[] = {
        HEAVY,           HEAVY_CURVE,
        MOVED,           PRESSED,
        LOADED,          HEAVY | DAMPED,
        MOVED | DAMPED,  PRESSED | DAMPED,
        LOADED | DAMPED, MOVED | HEAVY_CURVE | PRESSED | LOADED | DAMPED};
    for (size_t i = 0; i < 2 * sizeof cases / sizeof cases[0]; i += (size_t)test_every(3)) {
        const unsigned what = cases[i / 2];
        const lar_element_kind kind = i % 2 ? LAR_ELEMENT_HEX8_FULL : LAR_ELEMENT_HEX8;
        double work, error = imbalance(what, kind, 1e-4, &work);
        print_message("conditions %2u, %s: %.2g of %.3g J\n", what, kind ? "hex8-full" : "hex8",
                      error, work);
        assert_below(error, 1e-4);
    }
}

/* A body that is stretched to more than twice its length, and pressed flat, needs divided steps;
 * what a step is has then more than one meaning, and every account must know which. A change of the
 * step's length costs some accuracy. */
static void divided_steps_keep_the_account(void **unused) {
    (void)unused;
    static const double way[] = {0.05, -0.019};
    for (int i = 0; i < 2; i++) {
        brick b = soft_brick;
        lar_model *model = brick_model(&b);
        int ramp = add_ramp(model, 0.3);
        fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
        move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_X, way[i], ramp);
        model->damping = 80;
        lar_simulation *simulation = start_with(model, lar_options_default());
        while (lar_simulation_time(simulation) < 0.5) advance(simulation, 10);
        lar_energy e;
        lar_simulation_energy(simulation, &e);
        double error = fabs(total(&e) + e.damping + e.contact - e.external) / e.external;
        uint64_t divided = lar_simulation_divided_steps(simulation, NULL);
        print_message("moved by %g mm: %llu steps divided, %.2g of %.3g J\n", 1e3 * way[i],
                      (unsigned long long)divided, error, e.external);
        assert_true(divided > 0);
        assert_below(error, 0.005);
        finish(simulation, model);
    }
}

/* A node is led far out of its place, through its elements, and back: corners below zero whose
 * edges are long, and steps in many parts. */
static void long_corners_keep_the_account(void **unused) {
    (void)unused;
    static const double there_and_back[4][2] = {{0, 0}, {0.5, 1}, {1, -0.4}, {1.5, 0}};
    static const double way[][3] = {{-0.09, 0.05, 0.02}, {0.03, 0.03, -0.1}, {-0.07, -0.07, 0.07}};
    for (int i = 0; i < 3; i++) {
        brick b = soft_brick;
        lar_model *model = brick_model(&b);
        int table = add_table(model, LAR_CURVE_SMOOTH, 4, there_and_back);
        fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
        for (int k = 0; k < 3; k++)
            move_nodes(model, single_node(brick_node(&b, 2, 1, 1)), 1u << k, way[i][k], table);
        model->damping = 20;
        lar_simulation *simulation = start_with(model, lar_options_default());
        double worst = 0, most = 0;
        lar_energy e;
        while (lar_simulation_time(simulation) < 2) {
            advance(simulation, 20);
            lar_simulation_energy(simulation, &e);
            most = fmax(most, total(&e) + e.damping + e.contact);
            worst = fmax(worst, fabs(total(&e) + e.damping + e.contact - e.external));
        }
        print_message("pulled by %g, %g, %g mm: %.2g of %.3g J, %.3g J damped by barriers\n",
                      1e3 * way[i][0], 1e3 * way[i][1], 1e3 * way[i][2], worst / most, most,
                      e.contact);
        assert_true(e.contact > 0);
        assert_below(worst, 0.001 * most);
        finish(simulation, model);
    }
}

/* A free body that flies and stops: damping takes what it had half a step before the start. */
static void damping_counts_from_half_a_step_before(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    throw_body(model, (double[]){0, 0, 1}, (double[]){0, 0, 0}, 0);
    lar_options options = lar_options_default();
    options.time_step = 2e-4;
    model->damping = 500;
    lar_simulation *simulation = start_with(model, options);
    const double half = 0.5 * model->damping * options.time_step;
    double thrown = 0;
    for (int32_t n = 0; n < simulation->domain.layout.node_count; n++)
        thrown += 0.5 * simulation->domain.mass[n];
    lar_energy e;
    lar_simulation_energy(simulation, &e);
    assert_below(fabs(e.kinetic + e.damping - (1 + half) * (1 + half) * thrown), 1e-9 * thrown);
    advance(simulation, 1000);
    lar_simulation_energy(simulation, &e);
    assert_below(fabs(e.damping - (1 + half) * (1 + half) * thrown), 1e-9 * thrown);
    finish(simulation, model);
}

/* A body is thrown against its clamp and crushed there, looked at in every step: what barriers damp
 * is in the account of the state at which they do. (Without that 0.95 and 0.014.) */
static void a_blow_keeps_the_account(void **unused) {
    (void)unused;
    static const double speed[] = {3, 4}, step[] = {0, 2e-4}, bound[] = {0.3, 0.012};
    for (int i = 0; i < 2; i++) {
        brick b = soft_brick;
        lar_model *model = brick_model(&b);
        fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
        throw_body(model, (double[]){-speed[i], 0, 0}, (double[]){0, 0, 0}, 0);
        model->damping = 20;
        lar_options options = lar_options_default();
        options.time_step = step[i];
        lar_simulation *simulation = start_with(model, options);
        double worst = 0, start = 0;
        lar_energy e;
        while (lar_simulation_time(simulation) < 0.1) {
            lar_simulation_energy(simulation, &e);
            double in = total(&e) + e.damping + e.contact - e.external;
            if (lar_simulation_steps(simulation) == 0) start = in;
            worst = fmax(worst, fabs(in - start));
            advance(simulation, 1);
        }
        print_message("thrown at %g m/s: %.2g of %.3g J, %.3g J damped by barriers\n", speed[i],
                      worst / start, start, e.contact);
        assert_true(e.contact > 0);
        assert_below(worst, bound[i] * start);
        finish(simulation, model);
    }
}

/* A cube that is pulled by a third within six steps: what is sudden is watched, so barriers are
 * there in time and take what they give. */
static void what_is_sudden_keeps_the_account(void **unused) {
    (void)unused;
    brick b = {{3, 3, 3}, 0.01 / 3, 0, LAR_LAW_neo_hookean, 1e3, 2e4, 1050};
    lar_model *model = brick_model(&b);
    fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_Z);
    for (int at = 0; at <= 3; at++) fix_nodes(model, brick_side(&b, 1, at), LAR_AXIS_Y);
    move_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_Z, 0.003, add_ramp(model, 0.002));
    model->damping = 300;
    lar_simulation *simulation = start(model);
    lar_energy e;
    double least = 0, start;
    lar_simulation_energy(simulation, &e);
    start = total(&e);
    for (int step = 0; step < 140; step++) {
        advance(simulation, 1);
        lar_simulation_energy(simulation, &e);
        least = fmin(least, e.contact);
    }
    double open = total(&e) + e.damping + e.contact - e.external - start;
    print_message("pulled at once: %.2g of %.2g J open, barriers gave %.2g\n", open, e.external,
                  -least);
    assert_true(least == 0);
    assert_below(fabs(open), 0.05 * e.external);

    /* Had they given all the same, nothing touches, and nobody says that a surface is folded. */
    simulation->state.contact -= e.external;
    advance(simulation, 140);
    finish(simulation, model);
}

/* Pressed at once with twice the shear modulus, at the automatic step: the cube is as flat as with
 * a step of a quarter, and has not gone through itself. */
static void sudden_loads_end_where_small_steps_do(void **unused) {
    (void)unused;
    static const double always[2][2] = {{0, 1}, {1, 1}};
    double at[2];
    for (int way = 0; way < 2; way++) {
        brick b = {{2, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 3846, 8333, 1000};
        lar_model *model = brick_model(&b);
        fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
        int curve = add_table(model, LAR_CURVE_LINEAR, 2, always);
        for (int i = 0; i <= 2; i++)
            for (int j = 0; j <= 2; j++) {
                double share = (i == 1 ? 2 : 1) * (j == 1 ? 2 : 1) / 16.0;
                load_nodes(model, single_node(brick_node(&b, i, j, 2)), 0, 0, -2 * share, curve);
            }
        model->damping = 60;
        lar_options options = lar_options_default();
        options.time_step = way ? 4e-4 : 0;
        lar_simulation *simulation = start_with(model, options);
        while (lar_simulation_time(simulation) < 1) advance(simulation, 50);
        at[way] = node_u(simulation, brick_node(&b, 0, 0, 2))[2];
        finish(simulation, model);
    }
    print_message("pressed at once: %.5f m, with a quarter of the step %.5f m\n", at[0], at[1]);
    assert_below(fabs(at[0] - at[1]), 1e-4 * fabs(at[1]));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_undamped_body_keeps_its_energy),
        cmocka_unit_test(every_joule_is_accounted_for),
        cmocka_unit_test(divided_steps_keep_the_account),
        cmocka_unit_test(long_corners_keep_the_account),
        cmocka_unit_test(damping_counts_from_half_a_step_before),
        cmocka_unit_test(a_blow_keeps_the_account),
        cmocka_unit_test(what_is_sudden_keeps_the_account),
        cmocka_unit_test(sudden_loads_end_where_small_steps_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
