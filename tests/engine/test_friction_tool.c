/* Friction of tools: what two of them hold between them, balance, energy, and the same bits. */
#include "contact/tool_friction.h"
#include "engine/engine_test.h"
#include "engine/tool_contact_test.h"

static const double upright[4] = {1, 0, 0, 0};
static const brick tissue = {{3, 2, 2}, 0.01, 0.1, LAR_LAW_neo_hookean, 4e3, 2e5, 1000};

/* ---- held by friction alone ------------------------------------------------------------------ */

static const brick block = {{3, 3, 3}, 0.01, 0, LAR_LAW_neo_hookean, 2e5, 4e5, 1000};

/* Two balls, so large that they are nearly flat, beside a block. */
static lar_model *squeezed_model(double friction) {
    const double radius = 1, middle = 0.015;
    lar_model *model = brick_model(&block);
    lar_tool ball = {.shape = LAR_TOOL_SPHERE, .radius = radius, .friction = friction};
    touch_tool(model, "left", ball, (double[]){-radius - 0.001, middle, middle});
    touch_tool(model, "right", ball, (double[]){0.03 + radius + 0.001, middle, middle});
    model->damping = 100;
    return model;
}

/* Weight comes in 0.2 s, after the balls: so many times what they may hold. */
static int add_weight(lar_model *model) {
    static const double points[3][2] = {{0, 0}, {0.3, 0}, {0.5, 1}};
    return add_table(model, LAR_CURVE_SMOOTH, 3, points);
}

typedef struct hold {
    double pressed, lift; /* by one ball; by both, upwards [N] */
    double slipped;       /* in the last tenth of a second [m] */
} hold;

static double mean_height(const lar_simulation *s) {
    double sum = 0;
    for (int32_t n = 0; n < s->domain.model->mesh.node_count; n++)
        sum += s->domain.mass[s->domain.layout.local[n]] * node_u(s, n)[2];
    return sum / (27e-6 * block.density);
}

static hold hold_block(double friction, double weight) {
    lar_model *model = squeezed_model(friction);
    model->gravity[2] = -weight / (27e-6 * block.density);
    model->gravity_curve[2] = add_weight(model);
    lar_simulation *s = start(model);
    const double in = 0.0005, away = 1 - in, middle = 0.015;
    uint64_t steps = (uint64_t)(0.1 / lar_simulation_time_step(s));
    lar_tool_force left, right;
    place(s, 0, (double[]){-away, middle, middle}, upright, 1, steps);
    place(s, 1, (double[]){0.03 + away, middle, middle}, upright, 1, steps);
    while (lar_simulation_time(s) < 0.6) advance(s, 100);
    double before = mean_height(s);
    while (lar_simulation_time(s) < 0.7) advance(s, 50);
    hold out = {.slipped = before - mean_height(s)};
    assert_int_equal(lar_simulation_tool_force(s, 0, &left, NULL), LAR_OK);
    assert_int_equal(lar_simulation_tool_force(s, 1, &right, NULL), LAR_OK);
    assert_false(left.limited || right.limited);
    out.pressed = 0.5 * (right.force[0] - left.force[0]);
    out.lift = -left.force[2] - right.force[2];
    finish(s, model);
    return out;
}

/* What two tools press with N each they hold as long as it weighs less than 2 mu N. */
static void two_tools_hold_what_they_press(void **unused) {
    (void)unused;
    static const double frictions[] = {0.2, 0.6};
    for (int i = 0; i < 2; i++) {
        /* Under its weight the block sags, and is pressed by 2 % less. */
        double pressed = hold_block(frictions[i], 0.01).pressed;
        pressed = hold_block(frictions[i], 0.95 * 2 * frictions[i] * pressed).pressed;
        double max = 2 * frictions[i] * pressed;
        hold below = hold_block(frictions[i], 0.98 * max);
        hold above = hold_block(frictions[i], 1.01 * max);
        print_message("friction %.1f: pressed with %.4f N; held %.4f of 2 mu N, slips %.1e m in "
                      "0.1 s; with 1.01 %.1e m (lift %.4f)\n",
                      frictions[i], below.pressed, below.lift / max, below.slipped, above.slipped,
                      above.lift / max);
        assert_below(fabs(below.lift / max - 0.98), 1e-3);
        assert_below(fabs(below.slipped), 1e-9);
        /* What is too heavy falls against damping, at a / c: the balls hold it less the lower it
         * is. */
        assert_below(0.01 * max / 0.027 / 100 * 0.1, above.slipped);
    }
}

/* ---- sliding ----------------------------------------------------------------------------------
 */

/* What a large ball feels that is drawn over a block which stands on its base. The block's middle
 * plane, in which the ball's way lies, may be held across it. */
static void draw_over(double friction, bool held, double force[3]) {
    const brick wide = {{8, 4, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e4, 1e5, 1000};
    lar_model *model = brick_model(&wide);
    fix_nodes(model, brick_side(&wide, 2, 0), LAR_AXIS_ALL);
    if (held) fix_nodes(model, brick_side(&wide, 1, 2), LAR_AXIS_Y);
    touch_tool(model, "ball",
               (lar_tool){.shape = LAR_TOOL_SPHERE, .radius = 0.05, .friction = friction},
               (double[]){0.03, 0.02, 0.071});
    model->damping = 50;
    lar_simulation *s = start(model);
    uint64_t steps = (uint64_t)(0.1 / lar_simulation_time_step(s));
    lar_tool_force felt;
    place(s, 0, (double[]){0.03, 0.02, 0.069}, upright, 1, steps);
    advance(s, steps);
    place(s, 0, (double[]){0.05, 0.02, 0.069}, upright, 1, 4 * steps);
    advance(s, 2 * steps);
    assert_int_equal(lar_simulation_tool_force(s, 0, &felt, NULL), LAR_OK);
    memcpy(force, felt.force, sizeof felt.force);
    finish(s, model);
}

/* Friction is mu times what the ball presses with, besides what it feels without friction. */
static void what_slides_feels_mu_times_what_it_presses(void **unused) {
    (void)unused;
    double without[3], with[3];
    draw_over(0, false, without);
    draw_over(0.25, false, with);
    double found = (without[0] - with[0]) / with[2];
    print_message("pressed with %.4f N, drawn with %.5f N, without friction %.5f N: friction %.4f, "
                  "wanted 0.25\n",
                  with[2], -with[0], -without[0], found);
    assert_below(fabs(found / 0.25 - 1), 0.03);
}

/* By symmetry nothing leaves the middle plane anyway: its nodes rub along it, held or not. */
static void a_plane_of_symmetry_takes_no_friction(void **unused) {
    (void)unused;
    double free[3], held[3];
    draw_over(0.25, false, free);
    draw_over(0.25, true, held);
    print_message("drawn over a block %.6f N, its middle plane held %.6f N\n", free[0], held[0]);
    assert_below(0.1, fabs(free[0]));
    for (int i = 0; i < 3; i += 2) assert_below(fabs(held[i] - free[i]), 1e-6 * fabs(free[i]));
}

/* A ball that turns on the spot takes the tissue along. */
static void what_turns_takes_along(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&tissue);
    fix_nodes(model, brick_side(&tissue, 2, 0), LAR_AXIS_ALL);
    touch_tool(model, "ball", (lar_tool){.shape = LAR_TOOL_SPHERE, .radius = 0.02, .friction = 1},
               (double[]){0.015, 0.01, 0.041});
    model->damping = 50;
    lar_simulation *s = start(model);
    const double turned[4] = {cos(0.05), 0, sin(0.05), 0}; /* 0.1 rad about y */
    place(s, 0, (double[]){0.015, 0.01, 0.038}, upright, 1, 500);
    advance(s, 800);
    int32_t node = brick_node(&tissue, 1, 1, 2);
    double before = node_u(s, node)[0];
    place(s, 0, (double[]){0.015, 0.01, 0.038}, turned, 1, 500);
    advance(s, 800);
    double went = node_u(s, node)[0] - before;
    print_message("turned by 0.1 rad: the top goes %.2e m, its surface 1.9e-3 m\n", went);
    assert_below(went, -0.8e-3); /* the bottom of the ball goes backwards */
    finish(s, model);
}

/* ---- balance -----------------------------------------------------------------------------------
 */

static lar_model *poked_model(const brick *b, double friction) {
    lar_model *model = brick_model(b);
    touch_tool(model, "ball",
               (lar_tool){.shape = LAR_TOOL_SPHERE, .radius = 0.006, .friction = friction},
               (double[]){0.017, 0.012, 0.028});
    touch_tool(
        model, "rod",
        (lar_tool){
            .shape = LAR_TOOL_CAPSULE, .radius = 0.004, .length = 0.03, .friction = 2 * friction},
        (double[]){0.04, 0.004, 0.011});
    touch_tool(model, "jaws",
               (lar_tool){.shape = LAR_TOOL_GRASPER,
                          .radius = 0.002,
                          .length = 0.015,
                          .spread = 1.2,
                          .friction = friction},
               (double[]){0.004, 0.01, 0.04});
    return model;
}

static void poke(lar_simulation *s, int first, int last) {
    for (int tick = first; tick < last; tick++) {
        double t = tick / 40.0, down = t < 0.5 ? 0.02 * t : 0.01;
        place(s, 0, (double[]){0.017 + 0.01 * t, 0.012, 0.028 - down}, upright, 1, 10);
        place(s, 1, (double[]){0.04 - down, 0.004 + 0.01 * t, 0.011}, upright, 1, 10);
        place(s, 2, (double[]){0.004, 0.01, 0.04 - down}, upright, 1 - 0.5 * t, 10);
        advance(s, 10);
    }
}

static void momentum_of(const lar_simulation *s, double linear[3], double angular[3]) {
    for (int i = 0; i < 3; i++) linear[i] = angular[i] = 0;
    for (int32_t n = 0; n < s->domain.model->mesh.node_count; n++) {
        double m = s->domain.mass[s->domain.layout.local[n]];
        const double *v = node_v(s, n), *u = node_u(s, n);
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            const double *x = s->domain.model->mesh.position[n];
            linear[i] += m * v[i];
            angular[i] += m * ((x[j] + u[j]) * v[k] - (x[k] + u[k]) * v[j]);
        }
    }
}

/* In every step the momentum of a free body changes by what the tools feel, turned round; so does
 * its moment of momentum. */
static void what_tools_feel_is_what_the_body_gets(void **unused) {
    (void)unused;
    lar_model *model = poked_model(&tissue, 0.5);
    lar_simulation *s = start(model);
    double worst = 0, worst_turn = 0, size = 0, turn_size = 0, rubbed = 0;
    poke(s, 0, 10);
    for (int tick = 0; tick < 200; tick++) {
        double before[2][3], after[2][3], got[2][3] = {{0}};
        if (tick % 10 == 0)
            for (int t = 0; t < 2; t++) {
                lar_tool_pose pose;
                lar_error error;
                assert_int_equal(lar_simulation_tool_pose(s, t, &pose, &error), LAR_OK);
                pose.position[1] += 0.0002;
                place(s, t, pose.position, upright, 1, 10);
            }
        momentum_of(s, before[0], before[1]);
        double where[3][3];
        for (int t = 0; t < 3; t++) {
            lar_tool_pose pose;
            lar_error error;
            assert_int_equal(lar_simulation_tool_pose(s, t, &pose, &error), LAR_OK);
            memcpy(where[t], pose.position, sizeof where[t]);
        }
        double dt = lar_simulation_time_step(s);
        advance(s, 1);
        momentum_of(s, after[0], after[1]);
        for (int t = 0; t < 3; t++) {
            lar_tool_force f;
            assert_int_equal(lar_simulation_tool_force(s, t, &f, NULL), LAR_OK);
            for (int i = 0; i < 3; i++) {
                int j = (i + 1) % 3, k = (i + 2) % 3;
                got[0][i] -= dt * f.force[i];
                got[1][i] -=
                    dt * (f.torque[i] + where[t][j] * f.force[k] - where[t][k] * f.force[j]);
                size = fmax(size, fabs(dt * f.force[i]));
                turn_size = fmax(turn_size, fabs(dt * f.torque[i]));
            }
        }
        rubbed += s->interactions.tool_contact.rubbed_count;
        for (int i = 0; i < 3; i++) {
            worst = fmax(worst, fabs(after[0][i] - before[0][i] - got[0][i]));
            worst_turn = fmax(worst_turn, fabs(after[1][i] - before[1][i] - got[1][i]));
        }
    }
    print_message("momentum: off by %.1e of the largest push, moment of momentum by %.1e of the "
                  "largest torque; %.1f nodes rub\n",
                  worst / size, worst_turn / turn_size, rubbed / 200);
    assert_true(size > 0);
    assert_below(worst / size, 1e-9);
    assert_below(worst_turn / turn_size, 1e-3);
    finish(s, model);
}

/* Work of tools is external; a body that slides along tools at rest loses energy only. */
static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    double part[2];
    for (int i = 0; i < 2; i++) {
        lar_model *model = poked_model(&tissue, 0.4 * i);
        fix_nodes(model, brick_side(&tissue, 2, 0), LAR_AXIS_ALL);
        model->damping = 8;
        lar_options options = lar_options_default();
        options.time_step = 1e-4;
        lar_simulation *s = start_with(model, options);
        double worst = 0, work = 0;
        for (int tick = 0; tick < 80; tick++) {
            lar_energy e;
            poke(s, tick, tick + 1);
            double now = body_energy(s, &e);
            worst = fmax(worst, fabs(now + e.damping + e.contact - e.external));
            work = fmax(work, fabs(e.external));
        }
        part[i] = worst / work;
        print_message("tools with friction %.1f: balance %.2g of %.3g J\n", 0.4 * i, part[i], work);
        finish(s, model);
    }
    assert_below(part[1], fmax(1e-3, 1.5 * part[0]));
}

static void a_tool_at_rest_takes_energy(void **unused) {
    (void)unused;
    double last[2];
    for (int i = 0; i < 2; i++) {
        brick b = tissue;
        lar_model *model = brick_model(&b);
        touch_tool(
            model, "rod",
            (lar_tool){
                .shape = LAR_TOOL_CAPSULE, .radius = 0.01, .length = 0.2, .friction = 0.5 * i},
            (double[]){0.015, 0.01, -0.0115});
        model->tool[0].rest.orientation[0] = sqrt(0.5);
        model->tool[0].rest.orientation[2] = sqrt(0.5); /* it lies along x */
        model->tool[0].rest.position[0] -= 0.1;
        throw_body(model, (double[]){0.3, 0, -0.3}, (double[]){0, 0, 0}, 0.01);
        lar_simulation *s = start(model);
        lar_energy e;
        double first = body_energy(s, &e), highest = 0, slowest = INFINITY;
        while (lar_simulation_time(s) < 0.06) {
            advance(s, 5);
            double linear[3], angular[3], now = body_energy(s, &e);
            momentum_of(s, linear, angular);
            slowest = fmin(slowest, linear[0]);
            highest = fmax(highest, now / first);
        }
        last[i] = slowest;
        print_message("friction %.1f: energy at most %.5f, ends with %.3f, slowed down to %.3f of "
                      "its momentum\n",
                      0.5 * i, highest, body_energy(s, &e) / first, slowest / (0.3 * 0.012));
        assert_below(highest, 1.002);
        finish(s, model);
    }
    assert_below(last[1], 0.8 * last[0]);
}

/* ---- the same bits --------------------------------------------------------------------------- */

enum { HALF = 21, TICKS = 42 };

static uint64_t poked_hash(const lar_model *model, lar_options options, const char *from,
                           lar_tool_force force[3]) {
    lar_simulation *s = start_with(model, options);
    lar_error error;
    if (from && lar_simulation_load(s, from, &error)) fail_msg("%s", error.message);
    poke(s, from ? HALF : 0, TICKS);
    uint64_t hash = lar_simulation_hash(s);
    for (int tool = 0; tool < 3; tool++)
        assert_int_equal(lar_simulation_tool_force(s, tool, &force[tool], &error), LAR_OK);
    lar_simulation_destroy(s);
    return hash;
}

static lar_model *everywhere_model(double friction) {
    lar_model *model = poked_model(&tissue, friction);
    add_plane(model, (double[]){0, 0, -0.0015}, (double[]){0.02, 0, 1});
    add_plane(model, (double[]){-0.0012, 0, 0}, (double[]){1, 0, 0});
    model->contact[0].friction = friction;
    memcpy(model->gravity, (double[]){-3, 0, -9.81}, 24);
    fix_nodes(model, brick_side(&tissue, 1, 0), LAR_AXIS_Y);
    return model;
}

static void the_same_bits_everywhere(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "1x1x1", "2x1x1", "2x2x1", "1x1x1", "2x1x1", "3x2x2"};
    static const int32_t threads[] = {1, 1, 1, 1, 3, 2, 1};
    static const lar_isa sets[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    const char *path = LAR_TEST_BUILD "/friction_tool.lar";
    lar_model *model = everywhere_model(0.4);
    lar_tool_force wanted[3], force[3];
    lar_simulation *s = start(model);
    lar_error error;
    poke(s, 0, HALF);
    if (lar_simulation_save(s, path, &error)) fail_msg("%s", error.message);
    lar_simulation_destroy(s);
    uint64_t hash = poked_hash(model, lar_options_default(), NULL, wanted);
    assert_true(wanted[0].touching > 0 && wanted[1].touching > 0);
    for (int g = 0; g < 7; g++)
        for (int always = 0; always < 2; always++) {
            lar_options options = lar_options_default();
            options.grid = grids[g];
            options.threads = threads[g];
            options.search_always = always;
            assert_true(poked_hash(model, options, NULL, force) == hash);
            assert_memory_equal(force, wanted, sizeof wanted);
            assert_true(poked_hash(model, options, path, force) == hash);
            assert_memory_equal(force, wanted, sizeof wanted);
        }
    for (int i = 0; i < 4; i++) {
        const lar_kernels *kernels;
        if (lar_kernels_find(sets[i], &kernels, NULL)) continue;
        lar_options options = lar_options_default();
        options.isa = sets[i];
        assert_true(poked_hash(model, options, NULL, force) == hash);
    }
    lar_model *smooth = everywhere_model(0);
    assert_true(poked_hash(smooth, lar_options_default(), NULL, force) != hash);
    lar_model_destroy(smooth);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_tools_hold_what_they_press),
        cmocka_unit_test(what_slides_feels_mu_times_what_it_presses),
        cmocka_unit_test(a_plane_of_symmetry_takes_no_friction),
        cmocka_unit_test(what_turns_takes_along),
        cmocka_unit_test(what_tools_feel_is_what_the_body_gets),
        cmocka_unit_test(every_joule_is_accounted_for),
        cmocka_unit_test(a_tool_at_rest_takes_energy),
        cmocka_unit_test(the_same_bits_everywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
