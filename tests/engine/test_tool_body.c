/* A tool that is pushed into tissue: stays outside, says that it is kept from following its hand,
 * and comes back to it. */
#include "base/vector.h"
#include "contact/tool_body.h"
#include "engine/engine_test.h"
#include "engine/tool_contact_test.h"
#include "step/mass/needs.h"
#include "step/mass/pressed.h"

static const brick block = {{6, 6, 4}, 0.005, 0.05, LAR_LAW_neo_hookean, 2e3, 2e5, 1000};
static const double upright[4] = {1, 0, 0, 0};
static const double above[3] = {0.016, 0.014, 0.026}, below[3] = {0.016, 0.014, -0.004};
static const lar_tool ball = {.shape = LAR_TOOL_SPHERE, .radius = 0.005};
enum { TICK = 10 };

static lar_model *pressed_model(void) {
    lar_model *model = brick_model(&block);
    fix_nodes(model, brick_side(&block, 2, 0), LAR_AXIS_ALL);
    model->damping = 20;
    touch_tool(model, "ball", ball, above);
    return model;
}

static lar_tool_force force_of(lar_simulation *simulation) {
    lar_tool_force force;
    lar_error error;
    if (lar_simulation_tool_force(simulation, 0, &force, &error)) fail_msg("%s", error.message);
    return force;
}

typedef struct pushed {
    double force, apart, depth; /* the largest */
    double pressing;            /* mean force while the hand rests below */
    int32_t limited;            /* ticks */
    int32_t parts;
} pushed;

/* So many steps in ticks; the tool's centre never comes inside. */
static pushed vicinity(lar_simulation *simulation, uint64_t steps) {
    pushed seen = {0};
    uint64_t ticks = steps / TICK;
    for (uint64_t i = 0; i < ticks; i++) {
        lar_tool_pose pose;
        advance(simulation, TICK);
        lar_tool_force force = force_of(simulation);
        assert_int_equal(lar_simulation_tool_pose(simulation, 0, &pose, NULL), LAR_OK);
        assert_below(winding(simulation, pose.position), 0.5);
        assert_true(force.limited == 0 || force.limited == 1);
        assert_true(force.limited || force.apart == 0);
        seen.force = fmax(seen.force, size_of(force.force));
        seen.pressing += size_of(force.force) / (double)ticks;
        seen.apart = fmax(seen.apart, force.apart);
        seen.depth = fmax(seen.depth, force.depth);
        seen.limited += force.limited;
        int32_t parts = lar_simulation_step_parts(simulation);
        seen.parts = parts > seen.parts ? parts : seen.parts;
    }
    return seen;
}

typedef struct held {
    double low, high, least, most; /* of the tool [m] and of its force [N] */
    double shake;                  /* mean change of the force from tick to tick [N] */
    double limit;
    int32_t parts; /* at most */
} held;

/* A quarter of a second, after the hand has gone in `travel` and rested for `wait` seconds. */
static held held_at(lar_model *model, const double beyond[3], double travel, double wait) {
    lar_simulation *simulation = start(model);
    double second = 1 / lar_simulation_time_step(simulation);
    place(simulation, 0, beyond, upright, 1, (uint64_t)(travel * second));
    advance(simulation, (uint64_t)((travel + wait) * second));
    double before = size_of(force_of(simulation).force);
    held seen = {INFINITY, 0, INFINITY, 0, 0, force_of(simulation).limit, 0};
    uint64_t ticks = (uint64_t)(0.25 * second) / TICK;
    for (uint64_t i = 0; i < ticks; i++) {
        lar_tool_pose pose;
        advance(simulation, TICK);
        double force = size_of(force_of(simulation).force);
        lar_simulation_tool_pose(simulation, 0, &pose, NULL);
        seen.low = fmin(seen.low, pose.position[2]);
        seen.high = fmax(seen.high, pose.position[2]);
        seen.least = fmin(seen.least, force);
        seen.most = fmax(seen.most, force);
        seen.shake += fabs(force - before) / (double)ticks;
        before = force;
        int32_t parts = lar_simulation_step_parts(simulation);
        seen.parts = parts > seen.parts ? parts : seen.parts;
    }
    print_message("%.2f to %.2f N of %.2f, by %.3f a tick, %.2f to %.2f mm, %d parts\n", seen.least,
                  seen.most, seen.limit, seen.shake, 1e3 * seen.low, 1e3 * seen.high, seen.parts);
    finish(simulation, model);
    return seen;
}

/* A ball larger than elements, which elements bear less of than the tissue as a whole: while its
 * hand waits far beyond, it stands, and what is felt stays. (It gave way until elements had been
 * slow for a while, out of the tissue, and came back, ten times a second: 0.03 to 9.4 N, 32 to 101
 * mm.) */
static void a_held_tool_stands_still(void **unused) {
    (void)unused;
    static const brick soft = {{10, 10, 10}, 0.008, 0.05, LAR_LAW_neo_hookean, 1e3, 2e5, 1000};
    static const double out[3] = {0.039, 0.041, 0.102}, beyond[3] = {0.039, 0.041, -0.06};
    lar_tool large = ball;
    large.radius = 0.02;
    lar_model *model = brick_model(&soft);
    fix_nodes(model, brick_side(&soft, 2, 0), LAR_AXIS_ALL);
    model->damping = 20;
    touch_tool(model, "ball", large, out);
    const held seen = held_at(model, beyond, 0.5, 0);
    assert_below(0.5 * seen.limit, seen.least);
    assert_below(seen.most, seen.limit);
    assert_below(seen.most - seen.least, 0.02 * seen.limit);
    assert_below(seen.high - seen.low, 0.1e-3);
    assert_true(seen.parts > 1 && seen.parts <= 8);
}

/* Without what is more than `wall` cells below its surface. */
static void hollow(const brick *b, int wall, lar_mesh *mesh) {
    const int *c = b->cells;
    int32_t *to = lar_calloc((size_t)mesh->node_count, sizeof *to), elements = 0, nodes = 0;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        int at[3] = {e % c[0], e / c[0] % c[1], e / c[0] / c[1]};
        bool inside = true;
        for (int i = 0; i < 3; i++) inside &= at[i] >= wall && at[i] < c[i] - wall;
        if (inside) continue;
        memmove(mesh->element[elements++], mesh->element[e], sizeof *mesh->element);
        for (int n = 0; n < 8; n++) to[mesh->element[elements - 1][n]] = 1;
    }
    for (int32_t n = 0; n < mesh->node_count; n++) {
        if (!to[n]) continue;
        memmove(mesh->position[nodes], mesh->position[n], sizeof *mesh->position);
        to[n] = nodes++;
    }
    for (int32_t e = 0; e < elements; e++)
        for (int n = 0; n < 8; n++) mesh->element[e][n] = to[mesh->element[e][n]];
    mesh->element_count = elements;
    mesh->node_count = nodes;
    free(to);
}

/* A ball that may press with more than twice what crushes the walls of a box: what it does must not
 * go with what it may. (It was thrown back by all of its limit whenever an element became too fast,
 * and drawn in by a tenth of it at once.) */
static void a_large_tool_crushes_calmly(void **unused) {
    (void)unused;
    static const brick box = {{10, 10, 10}, 0.005, 0, LAR_LAW_neo_hookean, 2e3, 2e5, 1000};
    static const double out[3] = {0.022, 0.027, 0.082}, beyond[3] = {0.022, 0.027, 0.028};
    lar_tool large = ball;
    large.radius = 0.03;
    lar_model *model = brick_model(&box);
    fix_nodes(model, brick_side(&box, 2, 0), LAR_AXIS_ALL);
    hollow(&box, 2, &model->mesh);
    model->damping = 20;
    touch_tool(model, "ball", large, out);
    const held seen = held_at(model, beyond, 0.6, 0.2);
    assert_below(1, seen.least);
    assert_below(seen.shake, 0.5);
}

/* Pushed 30 mm, which is more than the block is high, kept there, and withdrawn. */
static void a_pushed_tool_stays_outside_and_comes_back(void **unused) {
    (void)unused;
    lar_model *model = pressed_model();
    lar_simulation *simulation = start(model);
    double way = above[2] - below[2];
    uint64_t second = (uint64_t)(1 / lar_simulation_time_step(simulation));
    lar_tool_force force = force_of(simulation);
    const double limit = force.limit;
    assert_true(limit > 0 && force.depth == 0 && force.apart == 0 && force.limited == 0);
    assert_true(winding(simulation, (double[]){0.015, 0.015, 0.01}) > 0.99);

    place(simulation, 0, below, upright, 1, second / 4);
    pushed in = vicinity(simulation, second / 4), rest = vicinity(simulation, second / 4);
    force = force_of(simulation);
    print_message("limit %.3g N: up to %.3g N on the way, %.3g N at rest, %.3g mm apart, tissue "
                  "up to %.3g mm deep; up to %d parts\n",
                  limit, fmax(in.force, rest.force), rest.pressing, 1e3 * force.apart,
                  1e3 * fmax(in.depth, rest.depth), (int)in.parts);
    assert_int_equal(force.limited, 1);
    assert_true(force.apart > 0.2 * way && force.apart < way);
    assert_true(rest.pressing > 0.6 * limit && rest.pressing < 1.4 * limit);
    assert_true(rest.depth > 0 && rest.depth < ball.radius);

    place(simulation, 0, above, upright, 1, second / 4);
    vicinity(simulation, second / 2);
    force = force_of(simulation);
    lar_tool_pose pose, wanted = {.orientation = {1, 0, 0, 0}, .opening = 1};
    memcpy(wanted.position, above, sizeof wanted.position);
    assert_int_equal(lar_simulation_tool_pose(simulation, 0, &pose, NULL), LAR_OK);
    assert_memory_equal(&pose, &wanted, sizeof pose);
    assert_int_equal(force.limited, 0);
    assert_true(force.apart == 0 && force.depth == 0 && size_of(force.force) == 0);
    assert_int_equal(force.touching, 0);
    finish(simulation, model);
}

/* What is said is the same on every grid, and divided steps are counted as they were done. */
static void what_is_said_does_not_depend_on_the_grid(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1"};
    lar_model *model = pressed_model();
    lar_tool_force force[2];
    uint64_t divided[2], counted = 0;
    int32_t max[2];
    for (int g = 0; g < 2; g++) {
        lar_options options = lar_options_default();
        options.grid = grids[g];
        lar_simulation *simulation = start_with(model, options);
        uint64_t steps = (uint64_t)(0.25 / lar_simulation_time_step(simulation));
        place(simulation, 0, below, upright, 1, steps);
        for (uint64_t i = 0; i < steps; i++) {
            advance(simulation, 1);
            if (g == 0) counted += lar_simulation_step_parts(simulation) > 1;
        }
        assert_int_equal(lar_simulation_tool_force(simulation, 0, &force[g], NULL), LAR_OK);
        divided[g] = lar_simulation_divided_steps(simulation, &max[g]);
        lar_simulation_destroy(simulation);
    }
    print_message("%.0f steps divided, into %d parts at most\n", (double)divided[0], (int)max[0]);
    assert_int_equal(force[0].limited, 1);
    assert_true(divided[0] > 0 && max[0] > 1);
    assert_int_equal(divided[0], counted);
    assert_int_equal(divided[0], divided[1]);
    assert_int_equal(max[0], max[1]);
    assert_memory_equal(&force[0], &force[1], sizeof force[0]);
    lar_model_destroy(model);
}

/* The fastest element and the springs of a tool make all of the room that a step has: no rounding
 * makes parts of it. */
static void a_touch_at_rest_needs_no_parts(void **unused) {
    (void)unused;
    lar_model *model = pressed_model();
    lar_simulation *simulation = start(model);
    const lar_domain *whole = &simulation->domain;
    lar_state *state = &simulation->state;
    lar_needs_clear(state->needs);
    state->pressed = simulation->strained.pressed;
    state->hardness = 1;
    for (int32_t e = 0; e < model->mesh.element_count; e++) {
        double bound = whole->stable_step * whole->stable_step / 4;
        state->pressed[e] = LAR_PRESSED;
        lar_pressed_need(whole, e, whole->room.rest * whole->rate[e].square * bound, state);
        state->pressed[e] = 0;
    }
    assert_true(state->needs->beyond == 0);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

/* Tissue that pushes a tool aside, and a little the way that its hand wants to go, does not set it
 * free to go that way: a jaw in a fold was led through it like that. As far as it is pushed the
 * right way nothing holds it back. */
static void a_tool_pushed_aside_is_not_free_to_go_on(void **unused) {
    (void)unused;
    enum { STEPS = 4 };
    static const double PUSHED[2][2] = {{0.2, 0.98}, {1, 0}}; /* x, z of the force's direction */
    lar_model *model = pressed_model();
    lar_simulation *simulation = start(model);
    const double dt = lar_simulation_time_step(simulation);
    const double scale = LAR_STEP_SHARES * STEPS * simulation->domain.scale;
    for (int c = 0; c < 2; c++) {
        lar_tools tools = simulation->tools;
        lar_tool_follower *follower = &tools.follower[0];
        follower->lagging = 1;
        follower->hand.to.position[0] += 0.01;
        follower->felt.steps = STEPS;
        for (int i = 0; i < 2; i++) {
            double force = 2 * simulation->list.limits[0].force * PUSHED[c][i];
            follower->felt.force[2 * i] = (int64_t)(force * scale);
        }
        assert_true(lar_tools_follow(&simulation->list, &tools, 0, STEPS, dt, 0,
                                     1 / simulation->domain.scale));
        double way[3], length;
        lar_minus(tools.motion[0].to.position, tools.motion[0].from.position, way);
        length = lar_length(way);
        print_message("pushed by (%g, 0, %g): goes (%.3g, %.3g, %.3g) mm\n", PUSHED[c][0],
                      PUSHED[c][1], 1e3 * way[0], 1e3 * way[1], 1e3 * way[2]);
        assert_true(length > 0);
        if (c == 0) assert_below(way[0], 0.5 * length);
        if (c == 1) assert_true(way[0] > 0.999 * length && length > 0.4 * STEPS * dt);
    }
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

/* A tool that tissue is in goes no farther in a part of a step than a tenth of the thinnest
 * element; one that touches nothing goes as it likes. */
static void a_fast_tool_in_tissue_divides_steps(void **unused) {
    (void)unused;
    static const int32_t PARTS[2] = {1, 4};
    lar_model *model = pressed_model();
    lar_simulation *simulation = start(model);
    const lar_domain *whole = &simulation->domain;
    for (int touches = 0; touches < 2; touches++) {
        lar_tools tools = simulation->tools;
        lar_tool_motion *motion = &tools.motion[0];
        motion->to.position[0] = motion->from.position[0] + 10 * 0.35 * whole->thinnest;
        motion->start = 0;
        motion->end = 10;
        tools.follower[0].felt = (lar_tool_felt){.depth = touches ? 1e-6 : 0, .steps = 1};
        lar_interval_divide(whole, 1, 1e-4, &tools);
        assert_int_equal(tools.division.parts, PARTS[touches]);
        lar_interval_divide(whole, 10, 1e-4, &tools);
        assert_int_equal(tools.division.parts, 1);
    }
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

/* An element that is fast because it is squeezed becomes heavier where a scene allows it; in a blow
 * steps are divided instead. */
static void blows_divide_steps(void **unused) {
    (void)unused;
    lar_model *model = pressed_model();
    model->strained_share = 0.02;
    lar_simulation *simulation = start(model);
    const lar_domain *whole = &simulation->domain;
    int32_t parts[2], heavier[2];
    for (int blow = 0; blow < 2; blow++) {
        lar_tools tools = simulation->tools;
        lar_interval interval = {0};
        lar_report report = {.need = 6};
        report.needs.fastest = blow ? 0.2 * whole->thinnest / whole->time_step : 0;
        lar_needs_add(&report.needs, 7, report.need);
        lar_interval_harvest(&interval, whole, &report, 1, &tools);
        lar_interval_divide(whole, 8, 1e-4, &tools);
        parts[blow] = tools.division.parts;
        heavier[blow] = tools.heavier.count;
    }
    print_message("slow: %d parts and %d heavier, in a blow %d and %d\n", parts[0], heavier[0],
                  parts[1], heavier[1]);
    assert_int_equal(parts[0], 2);
    assert_int_equal(heavier[0], 1);
    assert_int_equal(parts[1], 3);
    assert_int_equal(heavier[1], 0);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

/* Hardness grows with time, not with the number of intervals, and is gone some time after. Parts of
 * steps bear it beside the fastest element, which is pressed. */
static void hardness_grows_with_time(void **unused) {
    (void)unused;
    static const double SECONDS = 1e-4;
    lar_model *model = pressed_model();
    lar_simulation *simulation = start(model);
    const lar_domain *whole = &simulation->domain;
    lar_tools tools = simulation->tools;
    for (int n = 1; n <= 100; n++) {
        double before = tools.division.hardness;
        double need = whole->room.rest + whole->room.springs * before;
        if (need > whole->room.max) tools.strained.beyond_need = need;
        tools.follower[0].felt = (lar_tool_felt){.depth = 0.6 * ball.radius, .steps = 1};
        lar_interval_divide(whole, (uint64_t)n, SECONDS, &tools);
        assert_below(tools.division.hardness, exp(n * SECONDS / 1e-3) * 1.001);
        assert_true(tools.division.hardness > before || before == LAR_HARDNESS_MAX);
        double room = whole->room.max * tools.division.parts * tools.division.parts;
        need = whole->room.rest + whole->room.springs * tools.division.hardness;
        assert_below(need, room * 1.0000001);
    }
    assert_true(tools.division.hardness == LAR_HARDNESS_MAX);
    for (int n = 0; n < 10000; n++) {
        tools.follower[0].felt = (lar_tool_felt){.steps = 1};
        lar_interval_divide(whole, (uint64_t)n, SECONDS, &tools);
    }
    assert_true(tools.division.hardness == 1 && tools.division.parts == 1);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

/* Hardness after so many decisions in which a tool is so deep, in radii, in each by so much deeper
 * than in the last, and presses with so many times its limit. */
static double hardness_by(const lar_simulation *simulation, double from, double depth,
                          double deeper, double load, int decisions) {
    static const double SECONDS = 1e-4;
    const lar_domain *whole = &simulation->domain;
    const lar_tool_limits *limits = whole->surroundings.list->limits;
    lar_tools tools = simulation->tools;
    int64_t force = (int64_t)(load * limits->force * LAR_STEP_SHARES * whole->scale);
    tools.hardness[0] = tools.division.hardness = from;
    for (int n = 1; n <= decisions; n++) {
        tools.follower[0].felt =
            (lar_tool_felt){.depth = depth * ball.radius, .steps = 1, .force = {0, 0, force}};
        lar_interval_divide(whole, (uint64_t)n, SECONDS, &tools);
        depth += deeper;
    }
    return tools.division.hardness;
}

static double hardness_of(const lar_simulation *simulation, double from, double depth, double load,
                          int decisions) {
    return hardness_by(simulation, from, depth, 0, load, decisions);
}

/* A tool that presses too hard already becomes no harder, and softer if it presses far too hard:
 * what was met at 1 m/s was pressed by a hard ball with forty times its limit. Not where tissue is
 * deep in it: in two milliseconds it would be at the middle line (decision 147), close to which the
 * tool holds whatever it takes, but takes no more than what stops the tissue (decision 156). */
static void a_tool_that_presses_too_hard_yields(void **unused) {
    (void)unused;
    lar_model *model = pressed_model();
    lar_simulation *simulation = start(model);
    assert_below(20, hardness_of(simulation, 10, 0.5, 0.5, 10));
    assert_true(hardness_of(simulation, 10, 0.5, 1.2, 10) == 10);
    assert_true(hardness_of(simulation, 10, 0.5, 2.5, 10) == 10);
    assert_below(hardness_of(simulation, 10, 0.35, 4, 10), 4);
    assert_true(hardness_of(simulation, 10, 0.35, 4, 100) == 1);
    assert_true(hardness_of(simulation, 10, 0.5, 4, 10) == 10);
    assert_below(20, hardness_by(simulation, 10, 0.7, 0.01, 4, 10));
    assert_below(hardness_by(simulation, 10, 0.8, -0.01, 4, 10), 11.01); /* by the first alone */
    assert_below(hardness_of(simulation, 10, 0.7, 4, 10), 11.01);
    assert_below(20, hardness_of(simulation, 10, 0.7, 0.9, 10));
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

/* A ball that is deep in tissue becomes hard, and one that lies on it elsewhere does not. */
static void only_the_tool_that_needs_it_becomes_hard(void **unused) {
    (void)unused;
    static const double beside[3] = {0.005, 0.005, 0.03};
    lar_model *model = pressed_model();
    touch_tool(model, "other", ball, beside);
    lar_simulation *simulation = start(model);
    const lar_domain *whole = &simulation->domain;
    lar_tools tools = simulation->tools;
    double before = 1;
    for (int n = 1; n <= 40; n++) {
        tools.follower[0].felt = (lar_tool_felt){.depth = 0.6 * ball.radius, .steps = 1};
        tools.follower[1].felt = (lar_tool_felt){.depth = 0.1 * ball.radius, .steps = 1};
        lar_interval_divide(whole, (uint64_t)n, 1e-4, &tools);
        assert_true(tools.hardness[0] > before && tools.hardness[1] == 1);
        assert_true(tools.division.hardness == tools.hardness[0]);
        before = tools.hardness[0];
    }
    assert_true(before > 20);
    /* The other begins as the first one fades: the hardest counts. */
    for (int n = 41; n <= 60; n++) {
        tools.follower[0].felt = (lar_tool_felt){.steps = 1};
        tools.follower[1].felt = (lar_tool_felt){.depth = 0.6 * ball.radius, .steps = 1};
        lar_interval_divide(whole, (uint64_t)n, 1e-4, &tools);
        assert_true(tools.division.hardness == fmax(tools.hardness[0], tools.hardness[1]));
        assert_int_equal(tools.division.still, 0);
    }
    assert_true(tools.hardness[0] < before && tools.hardness[1] > 5);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

/* A hard tool goes as its hand leads where the tissue pushes that way, and not where it resists: a
 * ball of 3 mm in a coarse liver came out of its own fold at 4 mm/s, while the hand was gone. */
static void nothing_holds_what_leaves_the_tissue(void **unused) {
    (void)unused;
    static const double SECONDS = 4e-4, UNIT = 1e-12;
    lar_model *model = pressed_model();
    lar_simulation *simulation = start(model);
    const lar_tool_list *list = simulation->domain.surroundings.list;
    const double limit = list->limits[0].force, inside[3] = {0.016, 0.014, 0.010};
    double went[2];
    for (int g = 0; g < 2; g++) {
        lar_tools tools = simulation->tools;
        tools.hardness[0] = tools.division.hardness = LAR_HARDNESS_MAX;
        lar_tool_motion *tool = &tools.motion[0];
        tool->from = tool->to = (lar_tool_pose){.orientation = {1, 0, 0, 0}, .opening = 1};
        memcpy(tool->from.position, inside, sizeof inside);
        memcpy(tool->to.position, inside, sizeof inside);
        tools.follower[0].hand = *tool;
        memcpy(tools.follower[0].hand.to.position, g ? below : above, sizeof above);
        memcpy(tools.follower[0].hand.from.position, g ? below : above, sizeof above);
        tools.follower[0].lagging = 1;
        tools.follower[0].felt =
            (lar_tool_felt){.depth = 0.6 * ball.radius,
                            .steps = 1,
                            .force = {0, 0, (int64_t)(0.2 * limit * LAR_STEP_SHARES / UNIT)}};
        lar_tools_follow(list, &tools, 0, 8, SECONDS / 8, 0, UNIT);
        went[g] = tools.motion[0].to.position[2] - inside[2];
    }
    print_message("outwards %.3g m/s, inwards %.3g m/s\n", went[0] / SECONDS, -went[1] / SECONDS);
    assert_below(0.49 * SECONDS, went[0]);
    assert_below(went[0], 0.51 * SECONDS);
    assert_below(-went[1], 0.1 * SECONDS);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

/* Out of the tissue nothing holds a tool back, however small the step is: with one far below what
 * the body bears drag is so hard that a grasper followed through the air at 22 mm/s. */
static void what_touches_nothing_follows_its_hand(void **unused) {
    (void)unused;
    static const double far[3] = {0.016, 0.014, 0.07};
    lar_model *model = pressed_model();
    lar_simulation *simulation = start(model);
    lar_options options = lar_options_default();
    options.time_step = lar_simulation_time_step(simulation) / 6;
    lar_simulation_destroy(simulation);
    simulation = start_with(model, options);
    uint64_t second = (uint64_t)(1 / options.time_step);
    place(simulation, 0, below, upright, 1, second / 10);
    advance(simulation, second / 5);
    assert_true(force_of(simulation).limited);
    place(simulation, 0, far, upright, 1, second / 20);
    advance(simulation, second / 4);
    lar_tool_force force = force_of(simulation);
    print_message("%.3g mm behind\n", 1e3 * force.apart);
    assert_true(force.apart == 0 && !force.limited);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pushed_tool_stays_outside_and_comes_back),
        cmocka_unit_test(a_held_tool_stands_still),
        cmocka_unit_test(a_large_tool_crushes_calmly),
        cmocka_unit_test(what_is_said_does_not_depend_on_the_grid),
        cmocka_unit_test(a_touch_at_rest_needs_no_parts),
        cmocka_unit_test(a_tool_pushed_aside_is_not_free_to_go_on),
        cmocka_unit_test(a_fast_tool_in_tissue_divides_steps),
        cmocka_unit_test(blows_divide_steps),
        cmocka_unit_test(hardness_grows_with_time),
        cmocka_unit_test(a_tool_that_presses_too_hard_yields),
        cmocka_unit_test(only_the_tool_that_needs_it_becomes_hard),
        cmocka_unit_test(nothing_holds_what_leaves_the_tissue),
        cmocka_unit_test(what_touches_nothing_follows_its_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
