/* The promise: the same bits for every number of processors and threads, every scheme, every
 * distribution, with random delays, as without any of that (docs/determinism.md).
 *
 * test_engine_parallel          a choice of combinations in which every pair of values appears
 * test_engine_parallel full     all of them, 1,000 steps, also on the demonstration organ
 *
 * In builds with assertions every step also checks how far apart processors are (T 6.5.2), and
 * every gathering that shared nodes have the same bits everywhere. */
#include "engine/engine_test.h"
#include "model/demo/demo.h"

static const char *const grids[] = {"1x1x1", "2x1x1", "2x2x1", "2x2x3", "3x3x3"};
static const char *const schemes[] = {"all", "local", "one", "two"};
static const char *const distributions[] = {"cut", "genetic", "random", "metis"};
enum { GRIDS = 5, SCHEMES = 4, DISTRIBUTIONS = 4, THREADS = 3 };

/* Slightly irregular, no row of it straight; big enough for 27 processors. */
static const brick small = {{6, 5, 4}, 0.01, 0.1, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};

static lar_model *organ_model(void) {
    lar_model *model = NULL;
    lar_error error;
    if (lar_demo_write(LAR_TEST_BUILD "/parallel-organ", &error) ||
        lar_model_open(LAR_TEST_BUILD "/parallel-organ/uterus.yaml", &model, &error))
        fail_msg("%s", error.message);
    return model;
}

/* ---- the same bits ------------------------------------------------------------------------ */

static uint64_t hash_of(const lar_model *model, lar_options options, uint64_t steps) {
    lar_simulation *simulation = start_with(model, options);
    advance(simulation, steps);
    uint64_t hash = lar_simulation_hash(simulation);
    lar_simulation_destroy(simulation);
    return hash;
}

static bool is_missing(const char *distribution) {
    return strcmp(distribution, "metis") == 0 && !lar_distribution_has_metis();
}

static void compare(const lar_model *model, lar_options options, uint64_t steps, uint64_t wanted) {
    if (is_missing(options.distribution)) return;
    uint64_t hash = hash_of(model, options, steps);
    if (hash != wanted)
        fail_msg("grid %s, %d threads, scheme %s %s, distribution %s: hash %016llx instead of "
                 "%016llx",
                 options.grid, (int)options.threads, options.scheme,
                 options.channels ? options.channels : "", options.distribution,
                 (unsigned long long)hash, (unsigned long long)wanted);
}

/* Number i of the combinations. */
static lar_options combination(int grid, int threads, int scheme, int distribution) {
    lar_options options = lar_options_default();
    options.grid = grids[grid];
    options.threads = threads;
    options.scheme = schemes[scheme];
    options.distribution = distributions[distribution];
    options.delays = (uint64_t)(1 + grid + 7 * threads + 31 * scheme + 101 * distribution);
    return options;
}

/* With delays every pair of (grid, scheme), (grid, distribution), (threads, scheme) and so on comes
 * up: the distribution is chosen by the sum of the others. */
static void the_hash_is_the_same_everywhere(void **unused) {
    (void)unused;
    enum { STEPS = 60 };
    lar_model *model = everything_model(&small);
    uint64_t wanted = hash_of(model, lar_options_default(), STEPS);
    for (int grid = 0; grid < GRIDS; grid++)
        for (int scheme = 0; scheme < SCHEMES; scheme++) {
            int threads = 1 + (grid + scheme) % THREADS;
            int distribution = (grid + 2 * scheme + scheme / 2) % DISTRIBUTIONS;
            compare(model, combination(grid, threads, scheme, distribution), STEPS, wanted);
        }
    lar_options concurrent = combination(3, 2, 1, 0);
    concurrent.channels = "concurrent";
    compare(model, concurrent, STEPS, wanted);
    lar_model_destroy(model);
}

static void the_full_matrix(void **unused) {
    (void)unused;
    enum { STEPS = 1000 };
    for (int organ = 0; organ < 2; organ++) {
        lar_model *model = organ ? organ_model() : everything_model(&small);
        uint64_t wanted = hash_of(model, lar_options_default(), STEPS);
        int step = organ ? 2 : 1; /* half of them are enough for the organ */
        for (int i = 0; i < GRIDS * THREADS * SCHEMES * DISTRIBUTIONS; i += step) {
            lar_options options =
                combination(i % GRIDS, 1 + i / GRIDS % THREADS, i / (GRIDS * THREADS) % SCHEMES,
                            i / (GRIDS * THREADS * SCHEMES));
            compare(model, options, STEPS, wanted);
            options.channels = "concurrent";
            if (strcmp(options.scheme, "local") == 0) compare(model, options, STEPS, wanted);
        }
        lar_model_destroy(model);
    }
}

/* Elements in boxes, rows along the axes, and the slow elements too. */
static void boxes_and_oracles_agree_with_themselves(void **unused) {
    (void)unused;
    brick regular = small;
    regular.shift = 0;
    regular.cells[0] = 20;
    lar_model *model = everything_model(&regular);
    for (int kind = LAR_ELEMENT_HEX8; kind <= LAR_ELEMENT_HEX8_FULL; kind++) {
        lar_options options = lar_options_default();
        options.element = (lar_element_kind)kind;
        uint64_t wanted = hash_of(model, options, 20);
        options.grid = "2x2x1";
        options.threads = 2;
        assert_int_equal(hash_of(model, options, 20), wanted);
    }
    lar_model_destroy(model);
}

/* ---- stopping ----------------------------------------------------------------------------- */

static int stop_at(void *context, uint64_t step) {
    return step < *(const uint64_t *)context;
}

typedef struct meddler {
    lar_simulation *simulation;
    lar_saved *saved;
    int calls;
} meddler;

/* An advance that is begun anew in each of its steps would have no end. */
static int meddle(void *context, uint64_t step) {
    static const double up[3] = {0, 0, 1};
    meddler *m = context;
    lar_session *session = NULL;
    lar_error error;
    m->calls++;
    assert_int_equal(lar_simulation_reset(m->simulation, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "a callback may not"));
    const lar_status refused[] = {lar_simulation_advance(m->simulation, 1, &error),
                                  lar_simulation_load(m->simulation, "none", &error),
                                  lar_simulation_load_from(m->simulation, m->saved, &error),
                                  lar_replay(m->simulation, "none", NULL, NULL, NULL, &error),
                                  lar_session_open(m->simulation, NULL, &session, &error),
                                  lar_simulation_set_gravity(m->simulation, up, &error),
                                  lar_simulation_release(m->simulation, 0, 1, &error)};
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++)
        assert_int_equal(refused[i], LAR_ERROR_ARGUMENT);
    lar_status looks = lar_simulation_save_to(m->simulation, m->saved, &error);
    bool alone =
        lar_simulation_processors(m->simulation) * lar_simulation_threads(m->simulation) == 1;
    assert_int_equal(looks, alone ? LAR_OK : LAR_ERROR_ARGUMENT);
    return step > 0;
}

static void a_callback_changes_nothing(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&small);
    uint64_t wanted = hash_of(model, lar_options_default(), 40);
    for (int k = 0; k < 3; k++) {
        const lar_options how = k ? combination(k == 1, k, 1, 0) : lar_options_default();
        meddler m = {start_with(model, how), NULL, 0};
        lar_error error;
        assert_int_equal(lar_saved_create(m.simulation, &m.saved, &error), LAR_OK);
        if (lar_simulation_advance_with(m.simulation, 40, meddle, &m, &error))
            fail_msg("%s", error.message);
        assert_int_equal(m.calls, 40);
        assert_int_equal(lar_simulation_hash(m.simulation), wanted);
        assert_int_equal(lar_simulation_reset(m.simulation, &error), LAR_OK);
        lar_saved_destroy(m.saved);
        lar_simulation_destroy(m.simulation);
    }
    lar_model_destroy(model);
}

/* Everyone stops in the same step, soon; going on gives what not stopping would have given. */
static void an_advance_with_a_callback_ends_in_a_common_step(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&small);
    uint64_t wanted = hash_of(model, lar_options_default(), 200);
    for (int grid = 0; grid < GRIDS; grid++) {
        lar_simulation *simulation = start_with(model, combination(grid, 2, 1, 0));
        uint64_t limit = 50;
        lar_error error;
        if (lar_simulation_advance_with(simulation, 200, stop_at, &limit, &error))
            fail_msg("%s", error.message);
        uint64_t stopped = lar_simulation_steps(simulation);
        assert_true(stopped >= limit && stopped <= limit + 8);
        assert_int_equal(lar_simulation_state(simulation)->step, stopped);
        advance(simulation, 200 - stopped);
        assert_int_equal(lar_simulation_hash(simulation), wanted);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* One processor's element breaks, or its node is too fast: all stop, with the
 * message that one processor gives, and go on no more. */
static void assert_stops_everywhere(const lar_model *model, int kind) {
    lar_error alone, error;
    lar_simulation *simulation = start(model);
    assert_int_equal(lar_simulation_advance(simulation, 500, &alone), LAR_ERROR_UNSTABLE);
    print_message("%s\n", alone.message);
    assert_int_equal(simulation->fault.kind, kind);
    lar_simulation_destroy(simulation);
    for (int grid = 0; grid < GRIDS; grid++) {
        simulation = start_with(model, combination(grid, 1 + grid % THREADS, 0, 0));
        assert_int_equal(lar_simulation_advance(simulation, 500, &error), LAR_ERROR_UNSTABLE);
        assert_string_equal(error.message, alone.message);
        assert_true(lar_simulation_steps(simulation) < 100);
        char first[sizeof error.message];
        strcpy(first, error.message);
        assert_int_equal(lar_simulation_advance(simulation, 1, &error), LAR_ERROR_UNSTABLE);
        assert_string_equal(error.message, first);
        lar_simulation_destroy(simulation);
    }
}

static void an_unstable_run_stops_everywhere(void **unused) {
    (void)unused;
    static const double crash[3] = {-200, 0, 0}, rush[3] = {0, 0, 1e5};
    lar_model *model = everything_model(&small);
    throw_node(model, brick_node(&small, 3, 2, 2), crash);
    assert_stops_everywhere(model, LAR_FAULT_ELEMENT);
    lar_model_destroy(model);
    model = everything_model(&small);
    throw_node(model, brick_node(&small, 3, 2, 2), rush);
    assert_stops_everywhere(model, LAR_FAULT_SPEED);
    lar_model_destroy(model);
}

/* ---- what is accounted for once ------------------------------------------------------------ */

static void assert_near(double a, double b, double scale) {
    if (!(fabs(a - b) <= 1e-10 * scale)) fail_msg("%.17g is not near %.17g", a, b);
}

static void energies_do_not_depend_on_the_division(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&small);
    lar_simulation *alone = start(model);
    lar_energy wanted, found;
    advance(alone, 300);
    lar_simulation_energy(alone, &wanted);
    double scale = wanted.kinetic + wanted.strain + fabs(wanted.external) + wanted.damping;
    assert_true(wanted.damping > 0 && wanted.external != 0);
    for (int grid = 0; grid < GRIDS; grid++) {
        lar_simulation *simulation = start_with(model, combination(grid, 3, grid % SCHEMES, 2));
        advance(simulation, 300);
        lar_simulation_energy(simulation, &found);
        assert_near(found.kinetic, wanted.kinetic, scale);
        assert_near(found.strain, wanted.strain, scale);
        assert_near(found.hourglass, wanted.hourglass, scale);
        assert_near(found.external, wanted.external, scale);
        assert_near(found.damping, wanted.damping, scale);
        lar_simulation_destroy(simulation);
    }
    finish(alone, model);
}

/* ---- verification ------------------------------------------------------------------------- */

static void every_element_arrives_at_every_node_once(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&small);
    for (int grid = 0; grid < GRIDS; grid++)
        for (int scheme = 0; scheme < SCHEMES; scheme++) {
            lar_options options = combination(grid, 1 + (grid + scheme) % 4, scheme, grid % 3);
            options.verify = 1;
            lar_simulation *simulation = start_with(model, options);
            advance(simulation, 5);
            lar_simulation_destroy(simulation);
        }
    lar_model_destroy(model);
}

/* A program that is wrong in one place is found, whatever the place. */
static void a_wrong_program_is_found(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&small);
    for (int fault = 0; fault < 3; fault++) {
        lar_options options = combination(2, 2, 1, 0);
        options.verify = 1;
        lar_simulation *simulation = start_with(model, options);
        lar_processor *p = &simulation->computer->processor[1];
        if (fault == 0) /* a vector goes to the wrong node */
            p->node[0] = p->node[p->packet[0].added - 1];
        else if (fault == 1) /* a run of elements is left out */
            p->batch[0].run_count--;
        else /* the last vector of a packet is forgotten */
            for (int i = 0; i < p->packet_count; i++)
                if (p->packet[i].added > 0) p->packet[i].added--;
        lar_error error;
        assert_int_equal(lar_simulation_advance(simulation, 3, &error), LAR_ERROR_FORMAT);
        assert_non_null(strstr(error.message, "verification"));
        assert_non_null(strstr(error.message, "element"));
        assert_int_equal(lar_simulation_advance(simulation, 3, &error), LAR_ERROR_PEER);
        lar_simulation_destroy(simulation);
    }
    lar_model_destroy(model);
}

/* ---- options ------------------------------------------------------------------------------ */

static void refuse(const lar_model *model, lar_options options, const char *why) {
    lar_simulation *simulation = NULL;
    lar_error error;
    assert_true(lar_simulation_create(model, &options, &simulation, &error) != LAR_OK);
    assert_null(simulation);
    if (!strstr(error.message, why)) fail_msg("'%s' lacks '%s'", error.message, why);
}

static void senseless_options_are_refused(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&small);
    lar_options options = combination(0, 1, 0, 0);
    options.grid = "2x2";
    refuse(model, options, "2x2");
    options.grid = "10x10x10";
    refuse(model, options, "120");
    options = combination(1, 17, 0, 0);
    refuse(model, options, "17 threads");
    options = combination(1, 1, 0, 0);
    options.scheme = "some";
    refuse(model, options, "some");
    options = combination(1, 1, 0, 0);
    options.channels = "often";
    refuse(model, options, "often");
    options = combination(1, 1, 0, 0);
    options.comm = "pigeons";
    refuse(model, options, "pigeons");
    options = combination(1, 1, 0, 0);
    options.distribution = "/nowhere/at.all";
    refuse(model, options, "/nowhere/at.all");
    options = combination(1, 1, 0, 0);
    options.schedules = "/nowhere";
    refuse(model, options, "/nowhere");
    options = combination(1, 1, 0, 0);
    options.processor = 2;
    refuse(model, options, "processor 2");
    lar_model_destroy(model);
}

int main(int count, char **argument) {
    const struct CMUnitTest full[] = {cmocka_unit_test(the_full_matrix)};
    const struct CMUnitTest fast[] = {
        cmocka_unit_test(the_hash_is_the_same_everywhere),
        cmocka_unit_test(boxes_and_oracles_agree_with_themselves),
        cmocka_unit_test(an_advance_with_a_callback_ends_in_a_common_step),
        cmocka_unit_test(a_callback_changes_nothing),
        cmocka_unit_test(an_unstable_run_stops_everywhere),
        cmocka_unit_test(energies_do_not_depend_on_the_division),
        cmocka_unit_test(every_element_arrives_at_every_node_once),
        cmocka_unit_test(a_wrong_program_is_found),
        cmocka_unit_test(senseless_options_are_refused),
    };
    if (count > 1 && strcmp(argument[1], "full") == 0)
        return cmocka_run_group_tests(full, NULL, NULL);
    return cmocka_run_group_tests(fast, NULL, NULL);
}
