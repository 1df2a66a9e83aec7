/* Where tools touch, point by point: the forces of the points are the tool's force of the step that
 * follows, points lie on their faces, and looking changes nothing. The same on every grid. */
#include "base/vector.h"
#include "engine/engine_test.h"
#include "engine/fleet_test.h"
#include "engine/tools_test.h"

enum { ROOM = 600 };

typedef struct seen {
    int32_t count, kind[3];
    lar_touch touch[ROOM];
} seen;

static void look_at(const lar_simulation *simulation, int32_t tool, seen *s) {
    lar_error error;
    memset(s, 0, sizeof *s);
    if (lar_simulation_tool_touches(simulation, tool, ROOM, s->touch, &s->count, &error))
        fail_msg("%s", error.message);
    assert_true(s->count <= ROOM);
    for (int32_t i = 0; i < s->count; i++) s->kind[s->touch[i].kind]++;
}

/* Sums are exact: their order does not matter. */
static void add_up(const seen *s, double sum[3]) {
    double back[3] = {0, 0, 0};
    memset(sum, 0, 3 * sizeof *sum);
    for (int32_t i = 0; i < s->count; i++)
        for (int k = 0; k < 3; k++) {
            sum[k] += s->touch[i].force[k];
            back[k] += s->touch[s->count - 1 - i].force[k];
        }
    assert_memory_equal(sum, back, sizeof back);
}

/* What draws the surface: places as they are, normals outwards, of a body that has turned as well.
 */
static void check_surface(const lar_model *model, const double (*u)[3], const double middle[3]) {
    lar_surface_info surface;
    lar_model_surface(model, &surface);
    const double(*rest)[3] = lar_model_positions(model);
    float(*place)[3] = lar_calloc((size_t)surface.nodes, sizeof *place);
    float(*normal)[3] = lar_calloc((size_t)surface.nodes, sizeof *normal);
    lar_model_surface_move(model, u, place, normal);
    for (int32_t n = 0; n < surface.nodes; n++) {
        double square = 0, out = 0;
        for (int i = 0; i < 3; i++) {
            double at = rest[surface.node[n]][i] + (u ? u[surface.node[n]][i] : 0);
            assert_true(place[n][i] == (float)at);
            square += (double)normal[n][i] * (double)normal[n][i];
            out += (double)normal[n][i] * (at - middle[i]);
        }
        assert_true(fabs(square - 1) < 1e-6 && out > 0);
    }
    free(place);
    free(normal);
}

static void surfaces_are_drawn_as_they_are(void **unused) {
    (void)unused;
    lar_model *model = brick_model(&soft_brick);
    int32_t nodes = lar_model_node_count(model);
    const double(*rest)[3] = lar_model_positions(model);
    double(*u)[3] = lar_calloc((size_t)nodes, sizeof *u), low[3], high[3], middle[3];
    for (int i = 0; i < 3; i++) low[i] = high[i] = rest[0][i];
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) {
            low[i] = fmin(low[i], rest[n][i]);
            high[i] = fmax(high[i], rest[n][i]);
        }
    for (int i = 0; i < 3; i++) middle[i] = 0.5 * (low[i] + high[i]);
    check_surface(model, NULL, middle);
    for (int32_t n = 0; n < nodes; n++) /* a quarter of a turn about z */
        for (int i = 0; i < 2; i++)
            u[n][i] = (i ? 1 : -1) * (rest[n][1 - i] - middle[1 - i]) + middle[i] - rest[n][i];
    check_surface(model, (const double(*)[3])u, middle);
    lar_model_surface_move(NULL, NULL, NULL, NULL);
    lar_model_surface_move(model, NULL, NULL, NULL);
    free(u);
    lar_model_destroy(model);
}

/* Each is where its nodes say, and those are a face of the surface. */
static void check_points(const lar_simulation *simulation, const seen *s) {
    lar_simulation_info info;
    lar_surface_info surface;
    lar_simulation_inspect(simulation, &info);
    lar_model_surface(info.model, &surface);
    const double(*rest)[3] = lar_model_positions(info.model);
    int32_t nodes = lar_model_node_count(info.model);
    double(*u)[3] = lar_calloc((size_t)nodes, sizeof *u);
    lar_simulation_displacements(simulation, u);
    for (int32_t i = 0; i < s->count; i++) {
        const lar_touch *t = &s->touch[i];
        double place[3] = {0}, weight = 0;
        for (int a = 0; a < 4; a++) {
            weight += t->weight[a];
            assert_true(t->node[a] >= 0 || t->weight[a] == 0);
            if (t->face >= 0) assert_int_equal(t->node[a], surface.face[t->face][a]);
            for (int k = 0; k < 3 && t->node[a] >= 0; k++)
                place[k] += t->weight[a] * (rest[t->node[a]][k] + u[t->node[a]][k]);
        }
        assert_below(fabs(weight - 1), 1e-12);
        for (int k = 0; k < 3; k++) assert_below(fabs(place[k] - t->place[k]), 1e-12);
        double length = lar_length(t->normal);
        if (t->kind == LAR_TOUCH_HELD)
            assert_true(length == 0 && t->depth == 0);
        else
            assert_below(fabs(length - 1), 1e-9);
        if (t->kind == LAR_TOUCH_PRESSED) {
            assert_true(t->depth > 0);
            assert_true(lar_dot(t->force, t->normal) <= 1e-9);
        }
    }
    free(u);
}

/* A step that is not divided, of a tool that goes on as it went. */
static int compare_with_step(const lar_simulation *simulation, int32_t tool, const seen *s) {
    lar_tool_force force;
    double sum[3], size = 1e-12;
    lar_simulation_tool_force(simulation, tool, &force, NULL);
    assert_int_equal(s->kind[LAR_TOUCH_PRESSED], force.touching);
    assert_int_equal(s->kind[LAR_TOUCH_HELD], force.held);
    add_up(s, sum);
    for (int k = 0; k < 3; k++) size = fmax(size, fabs(force.force[k]));
    for (int k = 0; k < 3; k++)
        if (!(fabs(sum[k] - force.force[k]) <= 4e-16 * size))
            fail_msg("tool %d: %.17g instead of %.17g", (int)tool, sum[k], force.force[k]);
    return s->count > 0;
}

static void they_add_up_to_what_the_tool_feels(void **unused) {
    (void)unused;
    static seen s[TEST_TOOLS];
    for (int rough = 0; rough < 2; rough++) {
        lar_model *model = touched(rough ? 0.3 : 0);
        lar_options options = lar_options_default();
        options.hands = 1;
        lar_simulation *simulation = start_with(model, options);
        int compared[TEST_TOOLS] = {0}, kinds[3] = {0};
        for (int tick = 0; tick < 40; tick++) {
            act_gently(simulation, tick);
            for (int step = 0; step < TICK_STEPS; step++) {
                for (int t = 0; t < TEST_TOOLS; t++) look_at(simulation, t, &s[t]);
                uint64_t divided = lar_simulation_divided_steps(simulation, NULL);
                int32_t parts = lar_simulation_step_parts(simulation);
                bool was_limited[TEST_TOOLS];
                for (int t = 0; t < TEST_TOOLS; t++) {
                    lar_tool_force force;
                    lar_simulation_tool_force(simulation, t, &force, NULL);
                    was_limited[t] = force.limited != 0;
                }
                for (int t = 0; t < TEST_TOOLS && step == 0; t++) check_points(simulation, &s[t]);
                advance(simulation, 1);
                if (parts > 1 || lar_simulation_divided_steps(simulation, NULL) > divided) continue;
                for (int t = 0; t < TEST_TOOLS; t++) {
                    lar_tool_force force;
                    lar_simulation_tool_force(simulation, t, &force, NULL);
                    if (force.limited || was_limited[t])
                        continue; /* its way may have been decided anew */
                    compared[t] += compare_with_step(simulation, t, &s[t]);
                    for (int k = 0; k < 3; k++) kinds[k] += s[t].kind[k];
                }
            }
        }
        print_message("friction %g: %d %d %d %d steps; %d pressed, %d held, %d rubbed\n",
                      rough ? 0.3 : 0.0, compared[0], compared[1], compared[2], compared[3],
                      kinds[0], kinds[1], kinds[2]);
        for (int t = 0; t < TEST_TOOLS; t++) assert_true(compared[t] > 20);
        assert_true(kinds[0] > 100 && kinds[1] > 100 && (kinds[2] > 100) == (rough == 1));
        finish(simulation, model);
    }
}

static void the_same_everywhere(void **unused) {
    (void)unused;
    static const char *const grids[] = {NULL, "2x1x1", "2x2x1", "1x2x3"};
    static seen wanted[TEST_TOOLS], found;
    for (int rough = 0; rough < 2; rough++) {
        lar_model *model = touched(rough ? 0.3 : 0);
        uint64_t hash = 0;
        for (int grid = 0; grid < 4; grid++)
            for (int look = 0; look < 2; look++) {
                lar_options options = lar_options_default();
                options.grid = grids[grid];
                options.hands = 1;
                lar_simulation *simulation = start_with(model, options);
                for (int tick = 0; tick < 14; tick++) {
                    act_at(simulation, tick);
                    for (int t = 0; t < TEST_TOOLS && look; t++) look_at(simulation, t, &found);
                    advance(simulation, TICK_STEPS);
                }
                if (hash == 0)
                    for (int t = 0; t < TEST_TOOLS; t++) look_at(simulation, t, &wanted[t]);
                for (int t = 0; t < TEST_TOOLS; t++) {
                    look_at(simulation, t, &found);
                    assert_memory_equal(&found, &wanted[t], sizeof found);
                }
                if (hash == 0) hash = lar_simulation_hash(simulation);
                assert_int_equal(lar_simulation_hash(simulation), hash); /* looking changes none */
                lar_simulation_destroy(simulation);
            }
        lar_model_destroy(model);
    }
}

static void processes_agree_and_so_do_states_that_are_loaded(void **unused) {
    (void)unused;
    static seen wanted, found;
    lar_model *model = tool_model();
    lar_options options = lar_options_default();
    options.hands = 1;
    lar_simulation *simulation = start_with(model, options);
    for (int tick = 0; tick < 6; tick++) {
        act_at(simulation, tick);
        advance(simulation, TICK_STEPS);
    }
    look_at(simulation, TEST_BALL, &wanted);
    assert_true(wanted.count > 0);
    lar_saved *saved = NULL;
    assert_int_equal(lar_saved_create(simulation, &saved, NULL), LAR_OK);
    assert_int_equal(lar_simulation_save_to(simulation, saved, NULL), LAR_OK);
    fleet f;
    options.grid = "2x1x1";
    options.comm = "shm";
    start_fleet(&f, model, options, 2, NULL);
    for (int tick = 0; tick < 6; tick++) {
        act_at(f.zero, tick);
        advance(f.zero, TICK_STEPS);
    }
    look_at(f.zero, TEST_BALL, &found);
    assert_memory_equal(&found, &wanted, sizeof found);
    end_fleet(&f);
    assert_int_equal(lar_simulation_reset(simulation, NULL), LAR_OK);
    look_at(simulation, TEST_BALL, &found);
    assert_int_equal(found.count, 0);
    assert_int_equal(lar_simulation_load_from(simulation, saved, NULL), LAR_OK);
    look_at(simulation, TEST_BALL, &found);
    assert_memory_equal(&found, &wanted, sizeof found);
    /* As many as there is room for; how many there are. */
    int32_t count = 0;
    lar_error error;
    assert_int_equal(lar_simulation_tool_touches(simulation, TEST_BALL, 0, NULL, &count, &error),
                     0);
    assert_int_equal(count, wanted.count);
    memset(&found, 0, sizeof found);
    assert_int_equal(
        lar_simulation_tool_touches(simulation, TEST_BALL, 3, found.touch, &count, &error), 0);
    assert_int_equal(count, wanted.count);
    assert_memory_equal(found.touch, wanted.touch, 3 * sizeof *found.touch);
    assert_true(found.touch[3].weight[0] == 0 && found.touch[3].depth == 0);
    lar_saved_destroy(saved);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_are_drawn_as_they_are),
        cmocka_unit_test(they_add_up_to_what_the_tool_feels), cmocka_unit_test(the_same_everywhere),
        cmocka_unit_test(processes_agree_and_so_do_states_that_are_loaded)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
