/* A grid that is divided anew under way has the bits of one that is not, whatever the division:
 * tools that press, rub and hold, bodies that touch and rub, strained elements that are heavier,
 * what viscous ones remember, settings; and what has been felt and counted goes on. */
#include "divide/distribution.h"
#include "divide/random.h"
#include "engine/body_contact_test.h"
#include "engine/tools_test.h"

enum { TICKS = 20 };

/* By weights at random, of which some are a hundred times the others; at last anywhere. */
static void divide_anew(lar_simulation *simulation, int time) {
    const lar_mesh *mesh = &simulation->domain.model->mesh;
    const lar_grid grid = simulation->computer->division.grid;
    lar_random random = {(uint64_t)(17 * time + 3)};
    float *weight = lar_calloc((size_t)mesh->element_count, sizeof *weight);
    lar_distribution made;
    lar_error error;
    for (int32_t e = 0; e < mesh->element_count; e++)
        weight[e] = lar_random_below(&random, 8) == 0 ? 100 : 1;
    lar_status status = time % 5 == 4
                            ? lar_distribution_random(mesh, &grid, (uint64_t)time, &made, &error)
                            : lar_distribution_cut_by_weight(mesh, &grid, weight, &made, &error);
    assert_int_equal(status, LAR_OK);
    if (lar_computer_redistribute(&simulation->computer, &simulation->domain, &made, &error))
        fail_msg("%s", error.message);
    lar_distribution_clear(&made);
    free(weight);
}

/* What is compared in the end. */
typedef struct outcome {
    uint64_t hash, divided;
    lar_tool_force force;
    lar_energy energy;
    lar_contact_info contact;
} outcome;

static void look(const lar_simulation *simulation, outcome *out) {
    *out = (outcome){.hash = lar_simulation_hash(simulation),
                     .divided = lar_simulation_divided_steps(simulation, NULL)};
    if (simulation->domain.model->tool_count > 0)
        assert_int_equal(lar_simulation_tool_force(simulation, TEST_BALL, &out->force, NULL),
                         LAR_OK);
    lar_simulation_energy(simulation, &out->energy);
    lar_simulation_contact(simulation, &out->contact);
}

typedef struct scene {
    lar_model *(*make)(void);
    void (*tick)(lar_simulation *simulation, int tick);
    int steps;
} scene;

static void play(const scene *s, const lar_model *model, const char *grid, bool anew,
                 outcome *out) {
    lar_options options = lar_options_default();
    options.grid = grid;
    options.hands = 1;
    lar_simulation *simulation = start_with(model, options);
    for (int tick = 0; tick < TICKS; tick++) {
        s->tick(simulation, tick);
        if (anew && tick % 3 == 1) divide_anew(simulation, tick);
        advance(simulation, (uint64_t)s->steps);
        if (anew && tick % 7 == 2) divide_anew(simulation, tick + 1);
    }
    look(simulation, out);
    lar_simulation_destroy(simulation);
}

static bool nearly(double a, double b) {
    return fabs(a - b) <= 1e-9 * (fabs(a) + fabs(b));
}

static void check(const scene *s) {
    static const char *const grids[] = {"2x1x1", "1x2x2", "2x2x3"};
    lar_model *model = s->make();
    outcome plain, one, other;
    play(s, model, NULL, false, &plain);
    for (int i = 0; i < 3; i++) {
        play(s, model, grids[i], false, &one);
        play(s, model, grids[i], true, &other);
        assert_int_equal(one.hash, plain.hash);
        assert_int_equal(other.hash, plain.hash);
        assert_int_equal(other.divided, plain.divided);
        assert_memory_equal(&other.force, &one.force, sizeof one.force);
        assert_true(nearly(other.energy.external, one.energy.external));
        assert_true(nearly(other.energy.damping, one.energy.damping));
        assert_true(nearly(other.energy.contact, one.energy.contact));
        assert_true(other.contact.steps == one.contact.steps);
        assert_true(other.contact.possible == one.contact.possible);
        assert_true(other.contact.searches >= one.contact.searches);
        assert_true(other.contact.touching == one.contact.touching);
        assert_true(other.contact.deepest == one.contact.deepest);
        assert_true(other.contact.deepest_ever == one.contact.deepest_ever);
    }
    lar_model_destroy(model);
}

/* ---- what is divided ------------------------------------------------------------------------- */

static lar_model *pressed(void) {
    lar_model *model = touched(0.4);
    model->strained_share = 0.1;
    model->material[0].viscosity =
        (lar_viscosity){.terms = 2, .rest = 1, .share = {0.5, 0.3}, .time = {0.01, 0.1}};
    return model;
}

static void press_and_set(lar_simulation *simulation, int tick) {
    act_at(simulation, tick);
    if (tick == 4)
        assert_int_equal(lar_simulation_set_gravity(simulation, (double[]){1, 0, -5}, NULL), 0);
    if (tick == 8) assert_int_equal(lar_simulation_set_stiffness(simulation, 0, 0.7, NULL), 0);
    if (tick == 12) assert_int_equal(lar_simulation_set_stiffness(simulation, 0, 1.2, NULL), 0);
}

static void tools_and_settings_go_on(void **unused) {
    (void)unused;
    check(&(scene){pressed, press_and_set, TICK_STEPS});
}

static lar_model *falling(void) {
    const brick one = {{4, 3, 2}, 0.01, 0, LAR_LAW_neo_hookean, 5e3, 2e4, 1000};
    lar_model *model = empty_model(&one);
    add_brick(model, &one, (double[]){0, 0, 0});
    add_brick(model, &one, (double[]){0.007, 0.004, 0.0202});
    touch_between(model, 24);
    model->contact[0].friction = 0.3;
    fix_nodes(model, brick_side(&one, 2, 0), LAR_AXIS_ALL);
    memcpy(model->gravity, (double[]){3, 1, -9.81}, 24);
    return model;
}

static void nothing(lar_simulation *simulation, int tick) {
    (void)simulation, (void)tick;
}

static void bodies_go_on(void **unused) {
    (void)unused;
    check(&(scene){falling, nothing, 40});
}

/* ---- who decides ----------------------------------------------------------------------------- */

static uint64_t elements_of_first(const lar_simulation *simulation) {
    uint64_t count = 0;
    for (int32_t e = 0; e < simulation->domain.model->mesh.element_count; e++)
        count += simulation->computer->division.recoverer[e] == 0;
    return count;
}

/* As if two processors had computed for a while, the first one so many times as long. */
static void pretend(lar_simulation *simulation, double times) {
    lar_balance *balance = &simulation->computer->balance;
    balance->count = 1000;
    balance->busy[0] = balance->computed = 1e3 * times;
    balance->busy[1] = 1e3;
    balance->next = 0;
}

/* The tools press at the end that the first processor has. */
static lar_simulation *press_one_end(const lar_model *model, const char *distribution) {
    lar_options options = lar_options_default();
    options.grid = "2x1x1";
    options.distribution = distribution;
    options.pin = 2; /* as commands do */
    lar_simulation *simulation = start_with(model, options);
    for (int tick = 0; tick < TICKS; tick++) {
        place_tool(simulation, TEST_BALL, 0.012, 0.025, 0.0485 - 0.0006 * tick, 1, TICK_STEPS);
        advance(simulation, TICK_STEPS);
    }
    return simulation;
}

/* Clocks say that one has more to do, and what is known of elements which these are. */
static void times_and_elements_decide(void **unused) {
    (void)unused;
    bool adapts = lar_usable_cores() >= 2; /* before this thread is bound to one */
    lar_model *model = tool_model_of(&fine_tool_brick);
    lar_simulation *simulation = press_one_end(model, NULL);
    uint64_t wanted = elements_of_first(simulation), fixed;
    lar_simulation *kept = press_one_end(model, "cut");
    pretend(simulation, 1); /* nobody waits */
    advance(simulation, 1);
    assert_int_equal(lar_simulation_redivisions(simulation), 0);
    pretend(simulation, 2);
    advance(simulation, 1);
    assert_int_equal(lar_simulation_redivisions(simulation), adapts);
    fixed = elements_of_first(simulation);
    assert_true(adapts ? fixed < wanted : fixed == wanted);
    pretend(simulation, 1); /* again */
    advance(simulation, 1);
    assert_int_equal(lar_simulation_redivisions(simulation), adapts);
    pretend(kept, 2); /* asked for */
    advance(kept, 3);
    assert_int_equal(lar_simulation_redivisions(kept), 0);
    assert_int_equal(lar_simulation_hash(kept), lar_simulation_hash(simulation));
    lar_simulation_destroy(kept);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(tools_and_settings_go_on),
                                       cmocka_unit_test(bodies_go_on),
                                       cmocka_unit_test(times_and_elements_decide)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
