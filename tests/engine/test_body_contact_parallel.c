/* Contact of bodies has the same bits on every grid, with any number of threads, by every scheme,
 * by every instruction set, with random delays, and whenever the search is made. */
#include "engine/body_contact_test.h"

#include "base/hash.h"
#include "parallel/computer.h"

static const brick lower_brick = {{6, 4, 2}, 0.01, 0.08, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};
static const brick upper_brick = {{4, 3, 2}, 0.008, 0.05, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};

/* A body slides over another one and falls off it: contact wanders from processor to processor. */
static lar_model *sliding_model(bool self) {
    lar_model *model = two_bricks(&lower_brick, &upper_brick, 0.002, true);
    int32_t first =
        (lower_brick.cells[0] + 1) * (lower_brick.cells[1] + 1) * (lower_brick.cells[2] + 1);
    throw_nodes(model, first, model->mesh.node_count, (double[]){0.15, 0.05, -0.3});
    memcpy(model->gravity, (double[]){0, 0, -9.81}, 24);
    model->damping = 3;
    if (self) touch_self(model);
    return model;
}

typedef struct outcome {
    uint64_t hash;
    double contact, external; /* [J] */
    lar_contact_info info;
    int32_t touched; /* nodes, added up over the samples */
} outcome;

static outcome run(const lar_model *model, lar_options options, uint64_t steps) {
    enum { STRIDE = 20 };
    outcome all = {0};
    lar_simulation *s = start_with(model, options);
    for (uint64_t i = 0; i < steps; i += STRIDE) {
        advance(s, STRIDE);
        lar_simulation_contact(s, &all.info);
        all.touched += all.info.touching;
        if (i % (4 * STRIDE) == 0) all.hash = lar_hash_word(all.hash, lar_simulation_hash(s));
    }
    all.hash = lar_hash_word(all.hash, lar_simulation_hash(s));
    lar_energy e;
    lar_simulation_energy(s, &e);
    all.contact = e.contact;
    all.external = e.external;
    lar_simulation_destroy(s);
    return all;
}

static void compare(const lar_model *model, const outcome *one, lar_options options,
                    uint64_t steps) {
    outcome other = run(model, options, steps);
    if (other.hash != one->hash)
        fail_msg("grid %s, %d threads, scheme %s, delays %d, always %d: other bits", options.grid,
                 (int)options.threads, options.scheme ? options.scheme : "all", (int)options.delays,
                 options.search_always);
    assert_int_equal(other.info.touching, one->info.touching);
    assert_int_equal(other.touched, one->touched);
    assert_true(other.info.deepest == one->info.deepest);
    assert_true(other.info.deepest_ever == one->info.deepest_ever);
    assert_int_equal(other.info.possible, one->info.possible);
    assert_int_equal(other.info.steps, one->info.steps);
    assert_below(fabs(other.contact - one->contact), 1e-9 * fabs(one->external));
    if (options.search_always)
        assert_int_equal(other.info.searches, steps);
    else
        assert_true(other.info.searches > 0 && other.info.searches < steps / 4);
}

static bool everywhere; /* the slow run */

static void bits_do_not_depend_on_the_division(void **unused) {
    (void)unused;
    static const char *const grids[] = {"1x1x1", "2x1x1", "2x2x1", "3x1x1", "1x1x2"};
    static const char *const schemes[] = {"all", "local", "one", "two"};
    const uint64_t steps = everywhere ? 800 : 240;
    for (int self = 0; self < 2; self++) {
        lar_model *model = sliding_model(self != 0);
        outcome one = run(model, lar_options_default(), steps);
        assert_true(one.touched > 50);
        for (int g = 0; g < 5; g += everywhere ? 1 : test_every(2))
            for (int threads = 1; threads <= 2; threads++)
                for (int scheme = 0; scheme < 4; scheme++) {
                    if (!everywhere && (threads != 1 + (g + self) % 2 || scheme != (g + self) % 4))
                        continue;
                    lar_options options = lar_options_default();
                    options.grid = grids[g];
                    options.threads = threads;
                    options.scheme = schemes[scheme];
                    options.isa = g % 2 ? LAR_ISA_C : LAR_ISA_AUTO;
                    compare(model, &one, options, steps);
                }
        lar_model_destroy(model);
    }
}

static void nor_on_delays_nor_on_searches(void **unused) {
    (void)unused;
    enum { STEPS = 120 };
    lar_model *model = sliding_model(true);
    outcome one = run(model, lar_options_default(), STEPS);
    lar_options options = lar_options_default();
    options.grid = "2x2x1";
    options.threads = 2;
    for (uint64_t delays = 1; delays <= 2; delays++) {
        options.delays = delays;
        options.scheme = delays == 1 ? "two" : "local";
        compare(model, &one, options, STEPS);
    }
    options.delays = 0;
    options.search_always = 1;
    compare(model, &one, options, STEPS);
    lar_model_destroy(model);
}

/* Steps of a run with a callback are not interrupted, and the callback still ends it. */
static int until_step(void *context, uint64_t step) {
    uint64_t *last = context;
    assert_true(step == *last + 1);
    *last = step;
    return step < 300;
}

static void searches_are_not_seen_from_outside(void **unused) {
    (void)unused;
    lar_model *model = sliding_model(false);
    lar_options options = lar_options_default();
    options.grid = "2x1x1";
    lar_simulation *s = start_with(model, options);
    uint64_t last = 0;
    lar_error error;
    assert_int_equal(lar_simulation_advance_with(s, 1000, until_step, &last, &error), LAR_OK);
    assert_true(last >= 300 && last < 310);
    assert_int_equal(lar_simulation_steps(s), last);
    lar_contact_info info;
    lar_simulation_contact(s, &info);
    assert_int_equal(info.steps, last);
    assert_true(info.searches > 1);
    finish(s, model);
}

/* A state that is put back starts with a search of its own. */
static void going_back_repeats_every_bit(void **unused) {
    (void)unused;
    lar_model *model = sliding_model(true);
    lar_options options = lar_options_default();
    options.grid = "2x1x1";
    options.threads = 2;
    lar_simulation *s = start_with(model, options);
    advance(s, 500);
    uint64_t hash = lar_simulation_hash(s), searches;
    lar_error error;
    lar_contact_info info;
    /* Just after a search nothing else than going back asks for the next one. */
    lar_simulation_contact(s, &info);
    for (searches = info.searches; info.searches == searches;) {
        advance(s, 1);
        lar_simulation_contact(s, &info);
    }
    assert_int_equal(lar_simulation_reset(s, &error), LAR_OK);
    advance(s, 1);
    lar_simulation_contact(s, &info);
    assert_int_equal(info.searches, 1);
    assert_int_equal(info.steps, 1);
    advance(s, 499);
    assert_true(lar_simulation_hash(s) == hash);
    finish(s, model);
}

/* The upper body becomes fast from one step to the next, in all processors that have its nodes. */
static void hurl(lar_simulation *s) {
    int32_t first =
        (lower_brick.cells[0] + 1) * (lower_brick.cells[1] + 1) * (lower_brick.cells[2] + 1);
    for (int32_t i = 0; i < s->computer->hosted; i++) {
        lar_processor *p = &s->computer->processor[i];
        for (int32_t n = first; n < s->domain.model->mesh.node_count; n++) {
            lar_lid local = p->domain.layout.local[n];
            if (local >= 0) p->worker[0].state.v[lar_state_at(&p->worker[0].state, local, 2)] = 60;
        }
    }
}

/* Who is too fast for the search is named, and where it is, and the tool beside it. (Where all stop
 * after every round, as with tools and the step that this model would take, nothing is.) */
static void what_is_too_fast_says_who_and_where(void **unused) {
    (void)unused;
    for (int with_tool = 0; with_tool < 2; with_tool++)
        for (int too_many_pairs = 0; too_many_pairs < 2; too_many_pairs++) {
            lar_model *model = sliding_model(false);
            if (with_tool)
                *(lar_tool *)LAR_MODEL_APPEND(model, tool) =
                    (lar_tool){.name = lar_strdup("probe"),
                               .shape = LAR_TOOL_SPHERE,
                               .radius = 0.02,
                               .rest = {{0.035, 0.012, 0.0595}, {1, 0, 0, 0}, 1}};
            lar_options options = lar_options_default();
            options.grid = "2x1x1";
            options.time_step = 7e-5;
            lar_simulation *s = start_with(model, options);
            lar_error error = {0};
            advance(s, 17);                  /* what is sudden is watched at the start */
            s->tools.division.untouched = 1; /* a tool has touched the body lately */
            hurl(s);
            s->computer->contact.too_many_pairs = too_many_pairs;
            assert_int_equal(lar_simulation_advance(s, 50, &error), LAR_ERROR_UNSTABLE);
            print_message("%s\n", error.message);
            assert_int_equal(s->fault.kind, LAR_FAULT_TOO_FAST);
            assert_non_null(strstr(error.message, "node "));
            assert_non_null(strstr(error.message, " near ("));
            assert_true((strstr(error.message, "tool probe") != NULL) == with_tool);
            assert_true((strstr(error.message, "crowd") != NULL) == too_many_pairs);
            finish(s, model);
        }
}

/* A run that stops before its first step has felt nothing. */
static void too_many_pairs_before_the_first_step_leave_no_forces(void **unused) {
    (void)unused;
    lar_model *model = sliding_model(false);
    *(lar_tool *)LAR_MODEL_APPEND(model, tool) =
        (lar_tool){.name = lar_strdup("probe"),
                   .shape = LAR_TOOL_SPHERE,
                   .radius = 0.01,
                   .rest = {{0.03, 0.02, 0.2}, {1, 0, 0, 0}, 1}};
    lar_options options = lar_options_default();
    options.grid = "2x1x1";
    lar_simulation *s = start_with(model, options);
    lar_error error = {0};
    lar_tool_force force;
    advance(s, 10);
    s->computer->report.tool[0].force[0] = 1 << 20; /* as if it had felt something */
    s->computer->contact.valid = false;
    s->computer->contact.search->list.face_room = s->computer->contact.search->next.face_room = 0;
    assert_int_equal(lar_simulation_advance(s, 10, &error), LAR_ERROR_UNSTABLE);
    assert_int_equal(s->fault.kind, LAR_FAULT_TOO_MANY_PAIRS);
    assert_int_equal(lar_simulation_tool_force(s, 0, &force, NULL), LAR_OK);
    assert_true(force.force[0] == 0);
    finish(s, model);
}

int main(int count, char **argument) {
    everywhere = count > 1 && strcmp(argument[1], "everywhere") == 0;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bits_do_not_depend_on_the_division),
        cmocka_unit_test(nor_on_delays_nor_on_searches),
        cmocka_unit_test(searches_are_not_seen_from_outside),
        cmocka_unit_test(going_back_repeats_every_bit),
        cmocka_unit_test(what_is_too_fast_says_who_and_where),
        cmocka_unit_test(too_many_pairs_before_the_first_step_leave_no_forces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
