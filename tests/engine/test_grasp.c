/* Jaws that hold tissue: what they press it with, that opening lets go without a jump, and that two
 * of them stretch an organ between them. */
#include "engine/engine_test.h"
#include "engine/tool_contact_test.h"

static const double upright[4] = {1, 0, 0, 0};

/* A fold of tissue, 6 mm thick, that stands up from what holds it at its bottom. */
static const brick fold = {{2, 8, 6}, 0.003, 0, LAR_LAW_neo_hookean, 3e3, 6e4, 1000};
static const lar_tool jaws = {
    .shape = LAR_TOOL_GRASPER, .radius = 0.002, .length = 0.02, .spread = 0.8726646259971648};

static lar_model *fold_model(void) {
    lar_model *model = brick_model(&fold);
    fix_nodes(model, brick_side(&fold, 2, 0), LAR_AXIS_ALL);
    model->damping = 40;
    return model;
}

static lar_tool_force felt(const lar_simulation *simulation, int32_t tool) {
    lar_tool_force force;
    lar_error error;
    if (lar_simulation_tool_force(simulation, tool, &force, &error)) fail_msg("%s", error.message);
    return force;
}

static uint64_t steps_of(const lar_simulation *simulation, double seconds) {
    return (uint64_t)(seconds / lar_simulation_time_step(simulation));
}

/* Where a hand has asked a tool to be, and leads it to in ticks of a millisecond, evenly. */
static void lead(lar_simulation *simulation, int32_t tool, const double position[3], double opening,
                 double seconds) {
    const lar_tool_pose from = simulation->tools.follower[tool].hand.to;
    uint64_t tick = steps_of(simulation, 0.001), ticks = (uint64_t)ceil(seconds / 0.001);
    for (uint64_t i = 1; i <= ticks; i++) {
        double share = (double)i / (double)ticks, at[3];
        for (int k = 0; k < 3; k++)
            at[k] = from.position[k] + share * (position[k] - from.position[k]);
        place(simulation, tool, at, upright, from.opening + share * (opening - from.opening), tick);
        advance(simulation, tick);
    }
}

static void wait(lar_simulation *simulation, double seconds) {
    advance(simulation, steps_of(simulation, seconds));
}

static double fastest(const lar_simulation *simulation) {
    double max = 0;
    for (int32_t n = 0; n < simulation->domain.model->mesh.node_count; n++) {
        const double *v = node_v(simulation, n);
        max = fmax(max, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    return max;
}

/* ---- what they press with ------------------------------------------------------------------- */

static const double above[3] = {0.003, 0.012, 0.0335}; /* the fold's upper edge */

/* Capsules where the jaws are feel what the jaws feel, each its own. `pushed`: outwards. */
static void press_capsules(double half, double pushed[2]) {
    lar_model *model = fold_model();
    lar_tool jaw = {.shape = LAR_TOOL_CAPSULE, .radius = jaws.radius, .length = jaws.length};
    for (int s = 0; s < 2; s++) {
        touch_tool(model, s ? "left" : "right", jaw,
                   (double[]){above[0] + (s ? -0.006 : 0.006), above[1], above[2]});
        /* Its shaft along the jaw: a turn about y. */
        double turn = acos(-1) + (s ? half : -half);
        memcpy(model->tool[s].rest.orientation, (double[]){cos(turn / 2), 0, sin(turn / 2), 0},
               sizeof upright);
    }
    lar_simulation *simulation = start(model);
    for (int s = 0; s < 2; s++)
        place(simulation, s, above, model->tool[s].rest.orientation, 1, steps_of(simulation, 0.5));
    wait(simulation, 1);
    wait(simulation, 0.001);
    for (int s = 0; s < 2; s++) {
        lar_tool_force force = felt(simulation, s);
        assert_true(force.grasp_force == 0); /* it has no jaws */
        pushed[s] = (s ? -1 : 1) * force.force[0] * cos(half) + force.force[2] * sin(half);
    }
    finish(simulation, model);
}

static void grasp_is_what_one_jaw_is_pushed_with(void **unused) {
    (void)unused;
    double opening = 0.5, pushed[2];
    lar_model *model = fold_model();
    touch_tool(model, "jaws", jaws, above);
    lar_simulation *simulation = start(model);
    assert_true(felt(simulation, 0).grasp_force == 0);
    lead(simulation, 0, above, opening, 0.5);
    wait(simulation, 0.5);
    wait(simulation, 0.001);
    lar_tool_force grasped = felt(simulation, 0);
    const lar_tool_sum *sum = &simulation->report.tool[0];
    double differ = (double)(sum->jaw[0] - sum->jaw[1]) / (double)(sum->jaw[0] + sum->jaw[1]);
    assert_true(grasped.limited == 0 && grasped.held == 0);
    finish(simulation, model);

    press_capsules(0.5 * jaws.spread * opening, pushed);
    print_message("jaws grasp with %.4g N, capsules in their place with %.4g and %.4g N; the jaws "
                  "differ by %.1g of it; %.2g N across\n",
                  grasped.grasp_force, pushed[0], pushed[1], differ, grasped.force[0]);
    assert_true(grasped.grasp_force > 0.02);
    assert_below(fabs(differ), 1e-6); /* action and reaction */
    assert_below(fabs(grasped.force[0]), 1e-6 * grasped.grasp_force);
    for (int s = 0; s < 2; s++)
        assert_below(fabs(pushed[s] - grasped.grasp_force), 0.01 * grasped.grasp_force);
}

/* Jaws that are asked to close hold a fold by both sides and stop before they have crushed it: it
 * rests, and is as it was when they have opened. */
static void jaws_hold_a_fold_without_crushing_it(void **unused) {
    (void)unused;
    lar_model *model = fold_model();
    touch_tool(model, "jaws", jaws, above);
    lar_simulation *simulation = start(model);
    lead(simulation, 0, above, 0, 0.4);
    wait(simulation, 0.6);
    lar_tool_force force = felt(simulation, 0);
    lar_tool_pose pose;
    lar_simulation_tool_pose(simulation, 0, &pose, NULL);
    int side[2] = {0};
    for (int32_t i = 0; i < simulation->tools.grasp_count; i++) {
        double across = simulation->tools.grasps[i].anchor[0];
        side[0] += across < -0.0015;
        side[1] += across > 0.0015;
    }
    double left = node_u(simulation, brick_node(&fold, 0, 4, 6))[0];
    double right = node_u(simulation, brick_node(&fold, 2, 4, 6))[0];
    double parts = simulation->tools.division.parts, speed = fastest(simulation);
    print_message("%d points held, %d and %d of them at the sides, with %.3g N; jaws at %.2f, the "
                  "fold's edge %.2g mm thick; %.2g m/s, %.0f parts\n",
                  (int)force.held, side[0], side[1], force.grasp_force, pose.opening,
                  6 + 1e3 * (right - left), speed, parts);
    assert_true(side[0] > 5 && side[1] > 5);
    assert_true(force.limited == 1 && force.grasp_force > 0.05);
    assert_true(pose.opening > 0.2 && right - left > -0.0052);
    assert_below(speed, 1e-3);
    assert_true(parts <= 2);
    lead(simulation, 0, above, 1, 0.1);
    wait(simulation, 1);
    force = felt(simulation, 0);
    assert_true(force.held == 0 && force.grasp_force == 0 && force.limited == 0);
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        assert_below(size_of(node_u(simulation, n)), 1e-5);
    finish(simulation, model);
}

/* Pulled away closed, jaws keep a fold as long as it is within their length, and lose it then:
 * nobody is pulled by an instrument that is not there. The same on every grid. */
static void what_slips_out_of_jaws_is_held_no_longer(void **unused) {
    (void)unused;
    static const char *const grid[] = {NULL, "1x1x1", "2x2x1"};
    uint64_t hash[3];
    for (int i = 0; i < 3; i++) {
        lar_model *model = fold_model();
        lar_options options = lar_options_default();
        options.grid = grid[i];
        touch_tool(model, "jaws", jaws, above);
        lar_simulation *simulation = start_with(model, options);
        lead(simulation, 0, above, 0, 0.4);
        wait(simulation, 0.2);
        int32_t held = felt(simulation, 0).held;
        lead(simulation, 0, (double[]){above[0], above[1], above[2] + 0.01}, 0, 0.1);
        assert_true(held > 10 && felt(simulation, 0).held == held);
        lead(simulation, 0, (double[]){above[0], above[1], above[2] + 0.3}, 0, 0.6);
        wait(simulation, 0.5);
        lar_tool_force force = felt(simulation, 0);
        assert_true(force.held == 0 && force.force[2] == 0 && force.grasp_force == 0);
        hash[i] = lar_simulation_hash(simulation); /* gathers the state, too */
        double lifted = node_u(simulation, brick_node(&fold, 1, 4, 6))[2];
        assert_below(fabs(lifted), 1e-4);
        print_message("%s: %d points were held\n", grid[i] ? grid[i] : "no grid", (int)held);
        finish(simulation, model);
    }
    assert_true(hash[1] == hash[0] && hash[2] == hash[0]);
}

/* ---- letting go ----------------------------------------------------------------------------- */

/* The tool is gone from one step to the next: what the tissue does then is its own. */
static void vanish(lar_simulation *simulation) {
    lar_tool_pose away = {{0, 0, 1}, {1, 0, 0, 0}, 1};
    lar_tools *tools = &simulation->tools;
    tools->grasp_count = 0;
    tools->motion[0] = (lar_tool_motion){.from = away, .to = away};
    tools->follower[0] = (lar_tool_follower){.hand = tools->motion[0]};
    lar_tool_contact_forget(&simulation->interactions.tool_contact);
}

typedef struct release {
    double held, max, fall, speed; /* force before [N]; the largest, and its largest fall in a
                                       millisecond [N]; of a node [m/s] */
} release;

/* Jaws close on the fold, draw it up by `way`, and open in `seconds`, 0: vanish. */
static release let_go(double way, double seconds) {
    const double up[3] = {above[0], above[1], above[2] + way};
    lar_model *model = fold_model();
    touch_tool(model, "jaws", jaws, above);
    lar_simulation *simulation = start(model);
    lead(simulation, 0, above, 0, 0.4);
    lead(simulation, 0, up, 0, 0.4);
    wait(simulation, 0.5);
    wait(simulation, 0.001);
    double before = size_of(felt(simulation, 0).force);
    release r = {.held = before};
    if (seconds == 0) vanish(simulation);
    for (int i = 1; i <= 300; i++) {
        if (seconds > 0)
            lead(simulation, 0, up, fmin(1, 0.001 * i / seconds), 0.001);
        else
            wait(simulation, 0.001);
        double now = size_of(felt(simulation, 0).force);
        r.max = fmax(r.max, now);
        r.fall = fmax(r.fall, before - now);
        before = now;
        r.speed = fmax(r.speed, fastest(simulation));
    }
    assert_true(before == 0);
    finish(simulation, model);
    return r;
}

static void opening_lets_go_without_a_jump(void **unused) {
    (void)unused;
    static const double ways[4] = {0.002, 0.0022, 0.003, 0.004}, opens[2] = {0.01, 0.1};
    for (int w = 0; w < 4; w++) {
        release free = let_go(ways[w], 0);
        for (int o = 0; o < 2; o++) {
            release r = let_go(ways[w], opens[o]);
            print_message("held with %.3g N, opened in %g s: up to %.3g N, falls by %.3g N in a "
                          "ms at most; %.3g m/s, tissue alone %.3g m/s\n",
                          r.held, opens[o], r.max, r.fall, r.speed, free.speed);
            assert_below(r.speed, (o == 0 ? 0.6 : 0.2) * free.speed);
            if (o == 0) continue;
            assert_below(r.max, r.held + 0.005);
            assert_below(r.fall, 0.01);
        }
    }
}

/* ---- two of them ---------------------------------------------------------------------------- */

/* A strip of 60 mm that lies on something smooth: along it nothing holds but two graspers. */
static const brick strip = {{2, 20, 4}, 0.003, 0, LAR_LAW_neo_hookean, 3e3, 6e4, 1000};
static const double top = 0.012, from_end = 0.006;

static void both(lar_simulation *simulation, double height, double apart, double opening,
                 double seconds) {
    const double length = strip.edge * strip.cells[1];
    uint64_t tick = steps_of(simulation, 0.001), ticks = (uint64_t)ceil(seconds / 0.001);
    lar_tool_pose from[2];
    for (int t = 0; t < 2; t++) from[t] = simulation->tools.follower[t].hand.to;
    for (uint64_t i = 1; i <= ticks; i++) {
        double share = (double)i / (double)ticks;
        for (int t = 0; t < 2; t++) {
            double y = t ? length - from_end + apart / 2 : from_end - apart / 2;
            double to[3] = {strip.edge, y, top + height}, at[3];
            for (int k = 0; k < 3; k++)
                at[k] = from[t].position[k] + share * (to[k] - from[t].position[k]);
            place(simulation, t, at, upright, from[t].opening + share * (opening - from[t].opening),
                  tick);
        }
        advance(simulation, tick);
        for (int t = 0; t < 2 && i % 20 == 0; t++) {
            lar_tool_pose pose;
            lar_simulation_tool_pose(simulation, t, &pose, NULL);
            assert_below(winding(simulation, pose.position), 0.5);
        }
    }
}

/* How far the tissue between the jaws has come apart: the strip's middle at both places. */
static double drawn(const lar_simulation *simulation) {
    int cell = (int)(from_end / strip.edge + 0.5);
    const double *low = node_u(simulation, brick_node(&strip, 1, cell, 3));
    const double *high = node_u(simulation, brick_node(&strip, 1, strip.cells[1] - cell, 3));
    return high[1] - low[1];
}

static void two_graspers_stretch_an_organ_between_them(void **unused) {
    (void)unused;
    const double way = 0.3 * strip.edge * strip.cells[1];
    lar_model *model = brick_model(&strip);
    fix_nodes(model, brick_side(&strip, 2, 0), LAR_AXIS_Z);
    model->damping = 40;
    for (int t = 0; t < 2; t++)
        touch_tool(model, t ? "right" : "left", jaws,
                   (double[]){strip.edge, t ? 0.06 - from_end : from_end, top + 0.03});
    lar_simulation *simulation = start(model);
    both(simulation, 0.0125, 0, 1, 0.3);
    both(simulation, 0.0125, 0, 0, 0.4);
    both(simulation, 0.0125, 0, 0, 0.3);
    assert_true(felt(simulation, 0).held > 10 && felt(simulation, 1).held > 10);
    double begun = drawn(simulation), before = 0;
    for (int i = 1; i <= 6; i++) {
        both(simulation, 0.0125, way * i / 6, 0, 0.2);
        both(simulation, 0.0125, way * i / 6, 0, 0.3);
        double pull[2] = {felt(simulation, 0).force[1], felt(simulation, 1).force[1]};
        print_message(
            "hands %.1f mm apart, tissue %.1f mm: %.3f and %.3f N, grasp %.3f and %.3f N, "
            "%d parts, %.2g m/s\n",
            1e3 * way * i / 6, 1e3 * (drawn(simulation) - begun), pull[0], pull[1],
            felt(simulation, 0).grasp_force, felt(simulation, 1).grasp_force,
            (int)simulation->tools.division.parts, fastest(simulation));
        assert_true(pull[0] > before && pull[1] < -before);
        assert_below(fabs(pull[0] + pull[1]), 0.05 * pull[0]);
        before = 0.5 * (pull[0] - pull[1]);
    }
    assert_true(drawn(simulation) - begun > 0.8 * way); /* it has not slipped out */
    both(simulation, 0.0125, way, 1, 0.2);
    both(simulation, 0.04, way, 1, 0.3);
    both(simulation, 0.04, way, 1, 0.5);
    lar_energy energy;
    lar_simulation_energy(simulation, &energy);
    print_message("let go: strain %.2g J, %.2g m/s, %.2g mm longer\n", energy.strain,
                  fastest(simulation), 1e3 * drawn(simulation));
    assert_true(felt(simulation, 0).held == 0 && felt(simulation, 1).held == 0);
    assert_below(energy.strain, 1e-9);
    assert_below(fabs(drawn(simulation)), 1e-5);
    finish(simulation, model);
}

/* From cells to whales: a hand in the middle of a face takes what is there, and not the body. */
static void a_hand_fits_the_body(void **unused) {
    (void)unused;
    static const double edges[] = {1e-5, 3e-4, 0.01, 0.25, 10};
    for (int i = 0; i < 5; i++) {
        const brick body = {{5, 5, 5}, edges[i], 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
        lar_model *model = brick_model(&body);
        fix_nodes(model, brick_side(&body, 0, 0), LAR_AXIS_ALL);
        lar_options options = lar_options_default();
        options.hands = 1;
        lar_simulation *simulation = start_with(model, options);
        lar_error error;
        const lar_tool_pose pose = {
            {5 * edges[i], 2.4 * edges[i], 2.3 * edges[i]}, {1, 0, 0, 0}, 0};
        assert_int_equal(lar_simulation_tool_move(simulation, 0, &pose, 1, &error), LAR_OK);
        advance(simulation, 1);
        int held = felt(simulation, 0).held;
        print_message("edges of %g m: %d held\n", edges[i], held);
        assert_true(held >= 1 && held <= 36);
        finish(simulation, model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grasp_is_what_one_jaw_is_pushed_with),
        cmocka_unit_test(jaws_hold_a_fold_without_crushing_it),
        cmocka_unit_test(what_slips_out_of_jaws_is_held_no_longer),
        cmocka_unit_test(opening_lets_go_without_a_jump),
        cmocka_unit_test(two_graspers_stretch_an_organ_between_them),
        cmocka_unit_test(a_hand_fits_the_body),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
