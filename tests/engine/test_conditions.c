/* Supports, motion, loads and gravity, each against what can be said exactly. */
#include "engine/engine_test.h"

static const brick cube = {{2, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

static lar_simulation *start_step(const lar_model *model, double step) {
    lar_options options = lar_options_default();
    options.time_step = step;
    return start_with(model, options);
}

/* Central differences that start with the exact velocities half a step back follow a parabola to
 * the last bits, whatever the step. (Starting there with v0 itself would add g t dt / 2.) */
static void free_fall_is_exact(void **unused) {
    (void)unused;
    const double g[3] = {1, -2, -9.81}, v0[3] = {0.3, 0.7, 2};
    for (int half = 0; half < 2; half++) {
        const double dt = half ? 1e-4 : 2e-4, end = 0.5;
        const int steps = half ? 5000 : 2500;
        lar_model *model = brick_model(&soft_brick);
        memcpy(model->gravity, g, sizeof g);
        throw_body(model, v0, (double[]){0, 0, 0}, 0);
        lar_simulation *simulation = start_step(model, dt);
        advance(simulation, (uint64_t)steps);
        for (int32_t n = 0; n < model->mesh.node_count; n++)
            for (int i = 0; i < 3; i++) {
                assert_below(fabs(node_u(simulation, n)[i] - v0[i] * end - g[i] * end * end / 2),
                             1e-11);
                assert_below(fabs(node_v(simulation, n)[i] - v0[i] - g[i] * dt * (steps - 0.5)),
                             1e-10);
            }
        finish(simulation, model);
    }
}

/* u of a damped fall, v' = g - c v. */
static double damped_fall(double v0, double g, double c, double t) {
    return g * t / c + (v0 - g / c) * -expm1(-c * t) / c;
}

/* Half the step, a quarter of the error: against the exact solution where there is one. */
static void a_damped_fall_is_second_order(void **unused) {
    (void)unused;
    const double g = -9.81, v0 = 1.5, c = 20;
    double error[2];
    for (int half = 0; half < 2; half++) {
        lar_model *model = brick_model(&soft_brick);
        model->gravity[2] = g;
        model->damping = c;
        throw_body(model, (double[]){0, 0, v0}, (double[]){0, 0, 0}, 0);
        lar_simulation *simulation = start_step(model, half ? 2e-4 : 4e-4);
        advance(simulation, half ? 500 : 250);
        error[half] = node_u(simulation, 7)[2] - damped_fall(v0, g, c, 0.1);
        finish(simulation, model);
    }
    assert_below(fabs(error[0] / error[1] - 4), 0.01);
    assert_below(fabs(error[1]), 1e-6);
}

/* All that can act at the start acts: weight, damping, a load and a pressure that are there at
 * once, thrown nodes, a motion. Positions after steps of dt, dt/2, dt/4 approach each other by
 * four; a start of first order would show as two. */
static void a_busy_start_is_second_order(void **unused) {
    (void)unused;
    enum { STEPS = 50, HALVINGS = 3, NODES = 4 * 3 * 3 };
    static double u[HALVINGS][NODES][3];
    for (int h = 0; h < HALVINGS; h++) {
        brick b = soft_brick;
        lar_model *model = brick_model(&b);
        int at_once = add_ramp(model, 0), ramp = add_ramp(model, 0.03);
        assert_int_equal(model->mesh.node_count, NODES);
        memcpy(model->gravity, (double[]){2, 1, -9.81}, 24);
        model->damping = 10;
        fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
        move_nodes(model, single_node(brick_node(&b, 3, 0, 0)), LAR_AXIS_Y, 0.002, ramp);
        load_nodes(model, single_node(brick_node(&b, 2, 2, 2)), 0.01, -0.02, 0.01, at_once);
        press(model, 4, 100, at_once);
        throw_body(model, (double[]){0, 0, 0}, (double[]){0, 5, -3}, 0.05);
        lar_simulation *simulation = start_step(model, 2e-4 / (1 << h));
        advance(simulation, STEPS << h);
        lar_simulation_displacements(simulation, u[h]);
        finish(simulation, model);
    }
    double coarse = 0, fine = 0;
    for (int k = 0; k < 3 * NODES; k++) {
        coarse += pow((&u[0][0][0])[k] - (&u[1][0][0])[k], 2);
        fine += pow((&u[1][0][0])[k] - (&u[2][0][0])[k], 2);
    }
    print_message("a busy start: differences fall by %.3f\n", sqrt(coarse / fine));
    assert_true(coarse > 0);
    assert_below(fabs(sqrt(coarse / fine) - 4), 0.2);
}

static void gravity_follows_its_curve(void **unused) {
    (void)unused;
    const double dt = 1e-4;
    lar_model *model = brick_model(&soft_brick);
    model->gravity[1] = 4;
    model->gravity[2] = -9.81;
    model->gravity_curve[2] =
        add_table(model, LAR_CURVE_LINEAR, 2, (const double[][2]){{0.05, 0}, {0.15, 2}});
    lar_simulation *simulation = start_step(model, dt);
    double v = 0, u = 0;
    for (int n = 0; n < 2000; n++) {
        v += dt * -9.81 * lar_curve_value(&model->curve[0], n * dt);
        u += dt * v;
    }
    advance(simulation, 2000);
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        assert_below(fabs(node_u(simulation, n)[2] - u), 1e-10 * fabs(u));
        assert_below(fabs(node_u(simulation, n)[1] - 4 * 0.2 * 0.2 / 2), 1e-12);
    }
    finish(simulation, model);
}

/* v0 is the mean of the velocities half a step before and after the start. */
static void damping_slows_by_its_factor(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    model->damping = 30;
    throw_body(model, (double[]){0.5, 0, -0.25}, (double[]){0, 0, 0}, 0);
    lar_simulation *simulation = start_step(model, 2e-4);
    advance(simulation, 500);
    double keep = (1 - 0.003) / (1 + 0.003), exact = 0.5 * 2 / (1 + keep) * pow(keep, 500);
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        assert_below(fabs(node_v(simulation, n)[0] - exact), 1e-11);
    finish(simulation, model);
}

/* A support stands still, a moved node is where its curve says, to the last bit, whatever the rest
 * of the body does. */
static void motion_is_imposed_exactly(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    memcpy(model->gravity, (double[]){3, 0, -9.81}, 24);
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_X | LAR_AXIS_Z);
    int curve =
        add_table(model, LAR_CURVE_SMOOTH, 3, (const double[][2]){{0, 0}, {0.1, 1}, {0.17, -0.4}});
    move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_Y, 0.007, curve);
    lar_simulation *simulation = start(model);
    lar_node_list held = brick_side(&b, 0, 0), moved = brick_side(&b, 0, -1);
    for (int round = 0; round < 300; round++) {
        advance(simulation, 7);
        double time = lar_simulation_time(simulation);
        double expected = 0.007 * lar_curve_value(&model->curve[curve], time);
        for (int32_t i = 0; i < held.count; i++) {
            assert_true(node_u(simulation, held.node[i])[0] == 0);
            assert_true(node_u(simulation, held.node[i])[2] == 0);
            /* the step adds dt to a time that the test multiplies: an ulp between them */
            assert_below(fabs(node_u(simulation, moved.node[i])[1] - expected), 1e-15);
        }
        assert_true(node_u(simulation, held.node[0])[1] != 0 || round == 0);
    }
    free(held.node);
    free(moved.node);
    finish(simulation, model);
}

/* A motion whose curve does not begin with 0 begins there: no work comes from nowhere. */
static void a_motion_may_begin_displaced(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    fix_nodes(model, brick_side(&b, 0, 0), LAR_AXIS_ALL);
    int curve = add_table(model, LAR_CURVE_LINEAR, 2, (const double[][2]){{0, 1}, {0.05, 2}});
    move_nodes(model, brick_side(&b, 0, -1), LAR_AXIS_X, 2e-4, curve);
    lar_simulation *simulation = start_step(model, 5e-5);
    assert_true(node_u(simulation, brick_node(&b, 3, 1, 1))[0] == 2e-4);
    double kept[2];
    for (int end = 0; end < 2; end++) {
        lar_energy e;
        lar_simulation_energy(simulation, &e);
        kept[end] = e.kinetic + e.strain + e.hourglass + e.damping - e.external;
        if (end == 0) advance(simulation, 1000);
    }
    assert_true(kept[0] > 0);
    assert_below(fabs(kept[1] / kept[0] - 1), 1e-3);
    finish(simulation, model);
}

/* Nothing that is not part of the body may fall out of the range of the monitor: without damping,
 * for longer than a free fall takes to become too fast. */
static void a_heavy_body_swings_for_ever(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    model->gravity[2] = -9.81;
    fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
    lar_simulation *simulation = start(model);
    while (9.81 * lar_simulation_time(simulation) < 1.02 * simulation->domain.leapfrog.speed)
        advance(simulation, 1000);
    finish(simulation, model);
}

/* Of forces of a cause on all nodes, where these are now, about a point. */
static void moment_of(const lar_simulation *simulation, lar_cause cause, const double about[3],
                      double moment[3]) {
    enum { NODES = 512 };
    double force[NODES][3], u[NODES][3], sum[6] = {0};
    const lar_mesh *mesh = &simulation->domain.model->mesh;
    assert_true(mesh->node_count <= NODES);
    lar_simulation_displacements(simulation, u);
    assert_int_equal(lar_simulation_nodal_forces(simulation, cause, 0, force, NULL), LAR_OK);
    for (int n = 0; n < mesh->node_count; n++)
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, k = (i + 2) % 3;
            sum[i] += (mesh->position[n][j] + u[n][j] - about[j]) * force[n][k] -
                      (mesh->position[n][k] + u[n][k] - about[k]) * force[n][j];
        }
    memcpy(moment, sum, 3 * sizeof *moment);
}

/* Reactions of a body at rest carry its weight and its loads, and what these turn it with. */
static void reactions_carry_the_weight(void **unused) {
    (void)unused;
    for (int kind = LAR_ELEMENT_HEX8; kind <= LAR_ELEMENT_HEX8_FULL; kind++) {
        brick b = soft_brick;
        lar_model *model = brick_model(&b);
        int ramp = add_ramp(model, 0.2);
        memcpy(model->gravity, (double[]){0, 1.5, -9.81}, 24);
        fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
        fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_Y | LAR_AXIS_Z); /* twice is once */
        load_nodes(model, brick_side(&b, 2, -1), 0.002, 0, 0.001, ramp);
        model->damping = 60;
        lar_options options = lar_options_default();
        options.element = (lar_element_kind)kind;
        lar_simulation *simulation = start_with(model, options);
        while (lar_simulation_time(simulation) < 2) advance(simulation, 100);
        lar_model_info info;
        assert_int_equal(lar_model_inspect(model, &info, NULL), LAR_OK);
        lar_node_list bottom = brick_side(&b, 2, 0);
        const double about[3] = {0.3, -0.2, 0.1};
        double reaction[6], weight[3], loads[3], load = (double)bottom.count;
        lar_measure_reaction(&simulation->domain, &simulation->scratch->measure, &simulation->state,
                             &bottom, false, about, reaction, NULL);
        moment_of(simulation, LAR_CAUSE_GRAVITY, about, weight);
        moment_of(simulation, LAR_CAUSE_LOADS, about, loads);
        for (int i = 0; i < 3; i++)
            assert_below(fabs(reaction[3 + i] + weight[i] + loads[i]), 1e-8);
        assert_true(fabs(reaction[3]) > 1e-4 && fabs(reaction[4]) > 1e-4);
        assert_below(fabs(reaction[0] + 0.002 * load), 1e-8);
        assert_below(fabs(reaction[1] + 1.5 * info.mass), 1e-8);
        assert_below(fabs(reaction[2] - 9.81 * info.mass + 0.001 * load), 1e-8);
        free(bottom.node);
        finish(simulation, model);
    }
}

/* A support that sets out at a speed throws its nodes to it in the first step. That is in the
 * forces by cause and in the energies, and in no reaction of a moment at which nothing has moved.
 */
static void nothing_pulls_before_it_moves(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
    move_nodes(model, brick_side(&b, 2, -1), LAR_AXIS_Z, 0.002,
               add_table(model, LAR_CURVE_LINEAR, 2, (const double[2][2]){{0, 0}, {0.1, 1}}));
    lar_simulation *simulation = start(model);
    lar_node_list top = brick_side(&b, 2, -1);
    double reaction[3];
    for (int i = 0; i < 2; i++) {
        lar_measure_reaction(&simulation->domain, &simulation->scratch->measure, &simulation->state,
                             &top, false, NULL, reaction, NULL);
        if (i == 0) assert_true(reaction[0] == 0 && reaction[1] == 0 && reaction[2] == 0);
        if (i == 1) assert_true(reaction[2] > 0);
        advance(simulation, 1);
    }
    free(top.node);
    finish(simulation, model);
}

/* A pressure on a closed surface neither pulls nor turns, however the body is deformed. */
static void a_closed_pressure_is_balanced(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    press(model, -1, 500, add_ramp(model, 0));
    lar_simulation *simulation = start(model);
    lar_state *state = &simulation->state;
    for (int32_t n = 0; n < simulation->domain.layout.node_count; n++)
        for (int i = 0; i < 3; i++)
            state->u[lar_state_at(state, n, i)] = 0.002 * noise((uint32_t)(4 * n + i));
    double *force = residual_forces(simulation);
    double sum[3] = {0}, moment[3] = {0}, size = 0;
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        const double *X = model->mesh.position[n], *u = node_u(simulation, n);
        const double *f = three_of(force, state->stride, simulation->domain.layout.local[n]);
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            sum[i] += f[i];
            moment[i] += (X[j] + u[j]) * f[k] - (X[k] + u[k]) * f[j];
            size += fabs(f[i]);
        }
    }
    assert_true(size > 0.1 * 500 * 1e-4);
    for (int i = 0; i < 3; i++) {
        assert_below(fabs(sum[i]), 1e-12 * size);
        assert_below(fabs(moment[i]), 1e-12 * size * 0.03);
    }
    free(force);
    finish(simulation, model);
}

/* All-round pressure p makes J = 1 - p / K, whatever G. The pressure on one face is p times the
 * deformed area. */
static void a_pressurised_cube_shrinks_by_its_bulk_modulus(void **unused) {
    (void)unused;
    brick b = cube;
    lar_model *model = brick_model(&b);
    for (int axis = 0; axis < 3; axis++) fix_nodes(model, brick_side(&b, axis, 0), 1u << axis);
    press(model, -1, 4000, add_ramp(model, 0.05));
    model->damping = 300;
    lar_simulation *simulation = start(model);
    while (lar_simulation_time(simulation) < 0.5) advance(simulation, 100);
    double side = cbrt(1 - 4000 / b.bulk);
    const double *corner = node_u(simulation, brick_node(&b, 2, 2, 2));
    for (int i = 0; i < 3; i++) assert_below(fabs(corner[i] / 0.02 + 1 - side), 1e-9);
    double reaction[3];
    lar_node_list left = brick_side(&b, 0, 0);
    lar_measure_reaction(&simulation->domain, &simulation->scratch->measure, &simulation->state,
                         &left, false, NULL, reaction, NULL);
    /* the pressure on the held face itself and the support share nothing: all of it is balanced */
    assert_below(fabs(reaction[0]), 1e-6 * 4000 * 4e-4);
    free(left.node);
    finish(simulation, model);
}

/* A bar pulled by nodal loads: small strain F / (E A). */
static void a_pulled_bar_stretches(void **unused) {
    (void)unused;
    brick b = {{4, 1, 1}, 0.01, 0, LAR_LAW_coupled_neo_hookean, 2e3, 2e4, 1000};
    double young = 9 * b.bulk * b.shear / (3 * b.bulk + b.shear);
    lar_model *model = brick_model(&b);
    for (int axis = 0; axis < 3; axis++) fix_nodes(model, brick_side(&b, axis, 0), 1u << axis);
    load_nodes(model, brick_side(&b, 0, -1), 2.5e-6, 0, 0, add_ramp(model, 0.1));
    model->damping = 80;
    lar_simulation *simulation = start(model);
    while (lar_simulation_time(simulation) < 1) advance(simulation, 100);
    double strain = 1e-5 / (young * 1e-4);
    assert_below(fabs(node_u(simulation, brick_node(&b, 4, 1, 1))[0] / 0.04 / strain - 1), 1e-4);
    double lateral = node_u(simulation, brick_node(&b, 4, 1, 1))[1] / 0.01;
    double poisson = young / (2 * b.shear) - 1;
    assert_below(fabs(lateral / (-poisson * strain) - 1), 1e-4);
    finish(simulation, model);
}

/* A node by one screw after the other, with the functions of the C library. */
static void screwed(const lar_move *move, const double *factor, double x[3]) {
    for (int s = 0; s < move->screw_count; s++) {
        const lar_screw *k = &move->screw[s];
        double r[3], along = 0, angle = factor[s] * k->angle;
        for (int i = 0; i < 3; i++) r[i] = x[i] - k->point[i];
        for (int i = 0; i < 3; i++) along += k->axis[i] * r[i];
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, l = (i + 2) % 3;
            double cross = k->axis[j] * r[l] - k->axis[l] * r[j];
            x[i] = k->point[i] + cos(angle) * r[i] + sin(angle) * cross +
                   ((1 - cos(angle)) * along + factor[s] * k->slide) * k->axis[i];
        }
    }
}

static void add_screws(lar_model *model, lar_node_list nodes, double over) {
    lar_move *move = LAR_MODEL_APPEND(model, move);
    *move = (lar_move){.nodes = nodes, .axes = LAR_AXIS_ALL, .screw_count = 2};
    move->screw = lar_calloc(2, sizeof *move->screw);
    move->screw[0] = (lar_screw){{0.02, -0.01, 0.4}, {0, 0, 1}, 7, 0.003, add_ramp(model, over)};
    move->screw[1] = (lar_screw){{0, 0.03, 0}, {0.6, -0.8, 0}, -0.8, 0, add_ramp(model, 2 * over)};
    move->curve = move->screw[0].curve;
}

/* More than a whole turn and another behind it; as one body, that is: nothing is strained, and what
 * it took comes back when it stops. */
static void bodies_move_as_rigid_ones(void **unused) {
    (void)unused;
    brick b = soft_brick;
    lar_model *model = brick_model(&b);
    const int32_t nodes = model->mesh.node_count;
    lar_node_list all = {nodes, lar_calloc((size_t)nodes, sizeof(int32_t))};
    for (int32_t n = 0; n < nodes; n++) all.node[n] = n;
    add_screws(model, all, 0.25);
    lar_simulation *simulation = start_step(model, 0.25 / 1024);
    lar_energy e;
    for (int k = 1; k <= 3; k++) {
        advance(simulation, 1024);
        const double s = 0.5 * k, factor[2] = {1, s < 1 ? s * s * (3 - 2 * s) : 1};
        for (int32_t n = 0; n < nodes; n++) {
            double x[3];
            memcpy(x, model->mesh.position[n], sizeof x);
            screwed(model->move, factor, x);
            for (int i = 0; i < 3; i++)
                assert_below(fabs(x[i] - model->mesh.position[n][i] - node_u(simulation, n)[i]),
                             1e-15);
        }
        lar_simulation_energy(simulation, &e);
        assert_below(fabs(e.strain), 1e-12);
        assert_below(fabs(e.kinetic - e.external), 1e-12);
    }
    assert_true(e.kinetic == 0);
    finish(simulation, model);
}

/* A bar whose end is turned about its own axis by a small angle: half torque times angle is what it
 * stores, and turned with both ends by any angle it stores what it would without. */
static void a_turned_bar_is_twisted(void **unused) {
    (void)unused;
    double strain[2];
    for (int both = 0; both < 2; both++) {
        const brick b = {{12, 4, 4}, 0.005, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
        lar_model *model = brick_model(&b);
        model->damping = 60;
        const int curve = add_ramp(model, 0.1);
        for (int end = 0; end < 2; end++) {
            lar_node_list side = brick_side(&b, 0, -end);
            if (end == 0 && !both) {
                fix_nodes(model, side, LAR_AXIS_ALL);
                continue;
            }
            lar_move *move = LAR_MODEL_APPEND(model, move);
            *move = (lar_move){
                .nodes = side, .axes = LAR_AXIS_ALL, .curve = curve, .screw_count = 1 + both};
            move->screw = lar_calloc(2, sizeof *move->screw);
            move->screw[0] = (lar_screw){{0, 0.01, 0.01}, {1, 0, 0}, end * 0.3, 0, curve};
            move->screw[1] = (lar_screw){{0.1, 0, 0}, {0, 0.6, 0.8}, 2.5, 0.01, curve};
        }
        lar_simulation *simulation = start(model);
        advance(simulation, 16000);
        lar_energy e;
        lar_simulation_energy(simulation, &e);
        strain[both] = e.strain + e.hourglass;
        finish(simulation, model);
    }
    /* Saint-Venant: torsion constant of a square 0.1406 a^4; coarse, and its ends do not warp. */
    const double stiffness = 2e3 * 0.1406 * 1.6e-7 / 0.06;
    assert_below(fabs(strain[0] / (0.5 * stiffness * 0.09) - 1.15), 0.2);
    assert_below(fabs(strain[1] / strain[0] - 1), 1e-6);
}

/* What acts on a held node goes into the ground: it changes nothing and is no reason to stop. */
static void a_load_on_a_support_does_nothing(void **unused) {
    (void)unused;
    brick b = soft_brick;
    uint64_t hash[2];
    for (int loaded = 0; loaded < 2; loaded++) {
        lar_model *model = brick_model(&b);
        model->gravity[2] = -9.81;
        fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
        if (loaded) load_nodes(model, brick_side(&b, 2, 0), 30, -20, 10, add_ramp(model, 0));
        lar_simulation *simulation = start(model);
        advance(simulation, 200);
        hash[loaded] = lar_simulation_hash(simulation);
        finish(simulation, model);
    }
    assert_true(hash[0] == hash[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(free_fall_is_exact),
        cmocka_unit_test(a_damped_fall_is_second_order),
        cmocka_unit_test(a_busy_start_is_second_order),
        cmocka_unit_test(gravity_follows_its_curve),
        cmocka_unit_test(damping_slows_by_its_factor),
        cmocka_unit_test(motion_is_imposed_exactly),
        cmocka_unit_test(a_motion_may_begin_displaced),
        cmocka_unit_test(bodies_move_as_rigid_ones),
        cmocka_unit_test(a_turned_bar_is_twisted),
        cmocka_unit_test(a_heavy_body_swings_for_ever),
        cmocka_unit_test(reactions_carry_the_weight),
        cmocka_unit_test(nothing_pulls_before_it_moves),
        cmocka_unit_test(a_closed_pressure_is_balanced),
        cmocka_unit_test(a_pressurised_cube_shrinks_by_its_bulk_modulus),
        cmocka_unit_test(a_pulled_bar_stretches),
        cmocka_unit_test(a_load_on_a_support_does_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
