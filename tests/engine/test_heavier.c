/* Strained elements that are heavier in place of steps in parts: who they are does not depend on
 * who looked, what they gain and lose is accounted for, what has gone by leaves nothing behind, and
 * what becomes slower by how much. (That all of it is the same on every grid, in processes and
 * after a checkpoint: test_divided.c, engine/divided_heavier.) */
#include "engine/engine_test.h"
#include "engine/tool_contact_test.h"
#include "engine/tools_test.h"
#include "step/mass/heavier.h"

#define PATH LAR_TEST_BUILD "/heavier.checkpoint"

/* ---- what is needed most -------------------------------------------------------------------- */

enum { MANY = 500, LISTS = 7 };

/* Some are equal, and more than find room. */
static double need_of(int i) {
    return floor(40 * (1 + noise((uint32_t)i))) / 10;
}

static int by_need(const void *a, const void *b) {
    int i = *(const int *)a, k = *(const int *)b;
    if (need_of(i) != need_of(k)) return need_of(i) > need_of(k) ? -1 : 1;
    return i - k;
}

static void who_looked_does_not_matter(void **unused) {
    (void)unused;
    int order[MANY];
    for (int i = 0; i < MANY; i++) order[i] = i;
    qsort(order, MANY, sizeof *order, by_need);
    for (int split = 1; split <= LISTS; split++) {
        static lar_needs part[LISTS];
        static lar_needs all;
        memset(part, 0, sizeof part);
        memset(&all, 0, sizeof all);
        for (int i = 0; i < MANY; i++) {
            int e = split % 2 ? i : MANY - 1 - i;
            lar_needs_add(&part[e * 31 % 11 % split], e, need_of(e));
        }
        for (int k = 0; k < split; k++) lar_needs_join(&all, &part[split - 1 - k]);
        assert_int_equal(all.count, LAR_HEAVIER_MAX);
        for (int i = 0; i < LAR_HEAVIER_MAX; i++) assert_int_equal(all.of[i].element, order[i]);
        assert_true(all.beyond == need_of(order[LAR_HEAVIER_MAX]));
    }
}

/* ---- a body that is pressed flat on a plane, and let go ------------------------------------- */

static const brick block = {{6, 4, 4}, 0.01, 0.1, LAR_LAW_neo_hookean, 5e3, 1e5, 1000};

static lar_model *pressed_block(double share) {
    static const double there_and_back[4][2] = {{0, 0}, {0.3, 1}, {0.45, 0.8}, {0.7, 0}};
    lar_model *model = brick_model(&block);
    int table = add_table(model, LAR_CURVE_SMOOTH, 4, there_and_back);
    model->gravity_curve[0] = table;
    memcpy(model->gravity, (double[]){3, 0, -9.81}, 24);
    add_plane(model, (double[]){0, 0, -0.003}, (double[]){0.1, 0, 1});
    move_nodes(model, brick_side(&block, 2, -1), LAR_AXIS_Z, -0.024, table);
    move_nodes(model, brick_side(&block, 2, -1), LAR_AXIS_X | LAR_AXIS_Y, 0, table);
    model->damping = 15;
    model->strained_share = share;
    return model;
}

static lar_simulation *on(const lar_model *model, const char *grid, int threads) {
    lar_options options = lar_options_default();
    options.grid = grid;
    options.threads = grid ? threads : 0;
    return start_with(model, options);
}

/* What is missing in the account, as a part of the work; *hash of the state in the end. */
static double imbalance(const lar_model *model, const char *grid, lar_heavier *told,
                        uint64_t *hash) {
    lar_simulation *simulation = on(model, grid, 2);
    double worst = 0, work = 0;
    while (lar_simulation_time(simulation) < 0.6) {
        lar_energy e;
        advance(simulation, 10);
        lar_simulation_energy(simulation, &e);
        double sum = e.kinetic + e.strain + e.hourglass + e.damping + e.contact;
        worst = fmax(worst, fabs(sum - e.external));
        work = fmax(work, fabs(e.external));
    }
    lar_simulation_heavier(simulation, told);
    *hash = lar_simulation_hash(simulation);
    print_message("share %g, %s: %.2g of %.3g J missing, %d of %d steps divided; heavier by %.3g "
                  "on average, %.3g at most\n",
                  model->strained_share, grid ? grid : "alone", worst / work, work,
                  (int)lar_simulation_divided_steps(simulation, NULL),
                  (int)lar_simulation_steps(simulation), told->mean_share, told->largest_share);
    lar_simulation_destroy(simulation);
    return worst / work;
}

static void every_joule_is_accounted_for(void **unused) {
    (void)unused;
    static const char *const grids[] = {"1x1x1", "2x1x1", "2x2x1"};
    uint64_t plain, hash, other;
    lar_heavier told;
    lar_model *model = pressed_block(0);
    double without = imbalance(model, NULL, &told, &plain);
    assert_true(told.largest_share == 0 && told.mean_share == 0 && told.elements == 0);
    lar_model_destroy(model);
    model = pressed_block(0.2);
    double with = imbalance(model, NULL, &told, &hash);
    assert_true(hash != plain && told.largest_share > 0.05 && told.largest_share <= 0.2);
    assert_true(told.mean_share > 0 && told.mean_share < told.largest_share);
    assert_below(with, 2 * without + 1e-4);
    for (int i = 0; i < 3; i++) {
        assert_below(imbalance(model, grids[i], &told, &other), 2 * without + 1e-4);
        assert_int_equal(other, hash);
    }
    lar_model_destroy(model);
}

static void what_has_gone_by_leaves_nothing_behind(void **unused) {
    (void)unused;
    lar_model *model = pressed_block(0.2), *plain = pressed_block(0);
    lar_simulation *simulation = on(model, NULL, 0), *light = on(plain, NULL, 0), *clone;
    const lar_domain *a = &simulation->domain, *b = &light->domain;
    size_t bytes = (size_t)a->layout.node_padded * sizeof *a->mass;
    lar_error error;
    lar_heavier told = {0};
    while (told.elements == 0) {
        advance(simulation, 10);
        lar_simulation_heavier(simulation, &told);
        assert_true(lar_simulation_time(simulation) < 0.6);
    }
    double mass = 0, own = 0;
    for (lar_lid n = 0; n < a->layout.node_padded; n++) {
        mass += a->mass[n];
        own += b->mass[n];
        assert_true(fabs(lar_domain_weighs(a, n) - b->mass[n]) <= 1e-15 * b->mass[n]);
        assert_true(a->mass[n] >= b->mass[n] && a->push[n] <= b->push[n]);
    }
    assert_true(fabs((mass - own) / own - told.share) < 1e-12);
    if (lar_simulation_clone(simulation, &clone, &error)) fail_msg("%s", error.message);
    assert_int_equal(lar_simulation_save(simulation, PATH, &error), LAR_OK);
    assert_int_equal(lar_simulation_load(light, PATH, &error), LAR_ERROR_MODEL);
    while (lar_simulation_time(simulation) < 1.5) {
        advance(simulation, 100);
        advance(clone, 100);
    }
    assert_int_equal(lar_simulation_hash(simulation), lar_simulation_hash(clone));
    lar_simulation_heavier(simulation, &told);
    assert_true(told.elements == 0 && told.share == 0);
    assert_memory_equal(a->mass, b->mass, bytes);
    assert_memory_equal(a->push, b->push, bytes);
    /* And back to where it was heavier, and to the start. */
    assert_int_equal(lar_simulation_load(simulation, PATH, &error), LAR_OK);
    lar_simulation_heavier(simulation, &told);
    assert_true(told.elements > 0 && memcmp(a->mass, b->mass, bytes) != 0);
    assert_int_equal(lar_simulation_reset(simulation, &error), LAR_OK);
    assert_memory_equal(a->mass, b->mass, bytes);
    lar_simulation_destroy(clone);
    finish(simulation, model);
    finish(light, plain);
}

/* ---- tools that are harder ------------------------------------------------------------------ */

enum { PRESS_STEPS = 2000, PRESS_TICK = 10 };

/* A thin rod lies on the block and is pressed into it. */
static lar_model *under_a_rod(double share) {
    lar_model *model = brick_model(&block);
    fix_nodes(model, brick_side(&block, 2, 0), LAR_AXIS_ALL);
    add_tool(model, "rod", LAR_TOOL_CAPSULE, 0.005, 0.021, 0.043);
    model->tool[0].radius = 0.0015;
    model->tool[0].length = 0.05;
    model->damping = 20;
    model->strained_share = share;
    return model;
}

typedef struct pressing {
    int harder, whole; /* looks at which the rod was harder than at rest; at undivided steps */
    double heaviest, missing; /* share of the mass; of the account of energy */
    uint64_t hash;
} pressing;

static pressing press_rod(const lar_model *model, const char *grid, int threads) {
    lar_simulation *simulation = on(model, grid, threads);
    const lar_step_division *division = &simulation->tools.division;
    pressing p = {0};
    while (lar_simulation_steps(simulation) < PRESS_STEPS) {
        double done = (double)lar_simulation_steps(simulation) / PRESS_STEPS;
        double way = 0.008 * fmin(1, 2 * done);
        place_tool(simulation, 0, 0.005, 0.021, 0.043 - way, 1, PRESS_TICK);
        advance(simulation, PRESS_TICK);
        p.harder += division->hardness > 1;
        p.whole += division->hardness > 1 && division->parts == 1;
    }
    lar_heavier told;
    lar_simulation_heavier(simulation, &told);
    p.heaviest = told.largest_share;
    lar_energy e;
    lar_simulation_energy(simulation, &e);
    double sum = e.kinetic + e.strain + e.hourglass + e.damping + e.contact;
    p.missing = fabs(sum - e.external) / e.external;
    p.hash = lar_simulation_hash(simulation);
    print_message("%s: harder at %d looks, undivided at %d of these; heavier by up to %.3g, %.2g "
                  "missing\n",
                  grid ? grid : "alone", p.harder, p.whole, p.heaviest, p.missing);
    lar_simulation_destroy(simulation);
    return p;
}

/* Elements that it presses on bear that with more mass, and the others need no parts of steps. */
static void a_harder_tool_leaves_steps_whole(void **unused) {
    (void)unused;
    static const char *const grids[] = {"1x1x1", "2x1x1", "3x2x1"};
    lar_model *model = under_a_rod(0);
    pressing without = press_rod(model, NULL, 0);
    assert_true(without.harder > 20 && without.whole == 0);
    lar_model_destroy(model);
    model = under_a_rod(0.05);
    pressing with = press_rod(model, NULL, 0);
    assert_true(with.whole > 20 && with.heaviest > 0 && with.heaviest <= 0.05);
    assert_below(fmax(with.missing, without.missing), 1e-3);
    for (int i = 0; i < 3; i++)
        assert_int_equal(press_rod(model, grids[i], 1 + i % 2).hash, with.hash);
    lar_model_destroy(model);
}

/* ---- what becomes slower -------------------------------------------------------------------- */

/* A held bar that swings while its free end is drawn wide (pressed by dead forces it would buckle):
 * where mass matters most. */
static const brick bar = {{12, 2, 2}, 0.01, 0, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

static double period_of(double share, double *held) {
    lar_model *model = brick_model(&bar);
    int ramp = add_ramp(model, 0.3);
    int32_t tip = brick_node(&bar, bar.cells[0], 1, 1);
    model->strained_share = share;
    fix_nodes(model, brick_side(&bar, 0, 0), LAR_AXIS_ALL);
    for (int j = 0; j <= 2; j += 2)
        for (int i = 10; i <= 12; i++)
            for (int k = 0; k <= 2; k++)
                load_nodes(model, single_node(brick_node(&bar, i, j, k)), 0, j ? 0.2 : -0.2, 0,
                           ramp);
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        double x = model->mesh.position[n][0] / 0.12;
        throw_node(model, n, (double[]){0, 0, 1e-2 * x * x});
    }
    model->damping = 0.2;
    lar_simulation *simulation = start(model);
    double before = 0, first = 0, last = 0, step = lar_simulation_time_step(simulation);
    double steps = 0;
    *held = 0;
    for (int passed = 0; passed <= 8;) {
        lar_heavier told;
        advance(simulation, 1);
        double now = node_u(simulation, tip)[2];
        assert_true(lar_simulation_time(simulation) < 40);
        if (before < 0 && now >= 0 && lar_simulation_time(simulation) > 1) {
            last = lar_simulation_time(simulation) - step * now / (now - before);
            if (passed++ == 0) first = last;
        }
        before = now;
        lar_simulation_heavier(simulation, &told);
        if (passed > 0) *held += told.share;
        steps += passed > 0;
    }
    *held /= steps;
    finish(simulation, model);
    return (last - first) / 8;
}

/* The tip of such a bar moves with four times the mean square of its points. */
static void a_strained_end_swings_no_slower_than_told(void **unused) {
    (void)unused;
    double share, none, plain = period_of(0, &none), heavy = period_of(0.2, &share);
    double slower = 1 - plain / heavy, told = 1 - 1 / sqrt(1 + 4 * share);
    print_message("%.3g %% more mass at the free end: %.2f %% slower (periods of %.4f and %.4f s), "
                  "told up to %.2f %%\n",
                  100 * share, 100 * slower, plain, heavy, 100 * told);
    assert_true(none == 0 && share > 0.02);
    assert_true(slower > 0.3 * told && slower < told);
}

/* ---- what is refused ------------------------------------------------------------------------ */

static void what_cannot_be_is_refused(void **unused) {
    (void)unused;
    static const double bad[] = {NAN, -0.01, 0.21, INFINITY};
    lar_model *model = pressed_block(0.1);
    lar_error error;
    lar_simulation *simulation = on(model, NULL, 0);
    const lar_heavy one = {.element = 3, .factor = 1.5, .lately = 1, .held = 1.5};
    lar_heavy_list list = {.count = 1, .of = {one}};
    assert_true(lar_heavier_good(&simulation->domain, &list));
    const lar_heavy wrong[] = {
        {.element = -1, .factor = 1.5, .lately = 1, .held = 1.5},
        {.element = 96, .factor = 1.5, .lately = 1, .held = 1.5},
        {.element = 3, .factor = 0.5, .lately = 1, .held = 1.5},
        {.element = 3, .factor = NAN, .lately = 1, .held = 1.5},
        {.element = 3, .factor = 99, .lately = 1, .held = 1.5},
        {.element = 3, .factor = 1.5, .lately = -1, .held = 1.5},
        {.element = 3, .factor = 1.5, .lately = 1, .held = INFINITY},
        {.element = 3, .padding = 1, .factor = 1.5, .lately = 1, .held = 1.5}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        list.of[0] = wrong[i];
        assert_false(lar_heavier_good(&simulation->domain, &list));
    }
    list = (lar_heavy_list){.count = 2, .of = {one, one}}; /* twice */
    assert_false(lar_heavier_good(&simulation->domain, &list));
    list.count = 129;
    assert_false(lar_heavier_good(&simulation->domain, &list));
    lar_simulation_destroy(simulation);
    for (int i = 0; i < 4; i++) {
        model->strained_share = bad[i];
        assert_int_equal(lar_model_check(model, &error), LAR_ERROR_MODEL);
        assert_non_null(strstr(error.message, "strained elements"));
    }
    lar_model_destroy(model);
    lar_heavier told = {.elements = 7};
    lar_simulation_heavier(NULL, &told);
    assert_int_equal(told.elements, 0);
    lar_simulation_heavier(NULL, NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_looked_does_not_matter),
        cmocka_unit_test(every_joule_is_accounted_for),
        cmocka_unit_test(what_has_gone_by_leaves_nothing_behind),
        cmocka_unit_test(a_harder_tool_leaves_steps_whole),
        cmocka_unit_test(a_strained_end_swings_no_slower_than_told),
        cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
