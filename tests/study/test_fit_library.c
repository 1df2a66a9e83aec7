/* liblariat-fit as a program sees it: linked as it is installed, through lariat_fit.h alone. All
 * memory is counted, so that what one library takes the other one gives back to the same place. */
#include "testing.h"

#include <math.h>
#include <pthread.h>
#include <unistd.h>

#include "lariat_fit.h"

/* Where the files of this program lie. */
static const char FOLDER[] = LAR_TEST_BUILD "/fit_library";

/* ---- memory ---------------------------------------------------------------------------------- */

static int64_t live; /* blocks; atomic */

static void *take(void *context, size_t bytes, size_t alignment) {
    (void)context;
    void *memory = NULL;
    if (alignment < sizeof(void *)) alignment = sizeof(void *);
    if (posix_memalign(&memory, alignment, bytes ? bytes : 1)) return NULL;
    __atomic_fetch_add(&live, 1, __ATOMIC_RELAXED);
    return memory;
}

static void *resize(void *context, void *memory, size_t bytes) {
    (void)context;
    if (!memory) __atomic_fetch_add(&live, 1, __ATOMIC_RELAXED);
    return realloc(memory, bytes);
}

static void release(void *context, void *memory) {
    (void)context;
    if (memory) __atomic_fetch_sub(&live, 1, __ATOMIC_RELAXED);
    free(memory);
}

/* ---- an experiment --------------------------------------------------------------------------- */

static const char *path_of(const char *name) {
    static char path[4][1024];
    static int next;
    next = (next + 1) % 4;
    snprintf(path[next], sizeof path[next], "%s/%s", FOLDER, name);
    return path[next];
}

static void write_file(const char *name, const char *text) {
    FILE *out = fopen(path_of(name), "w");
    assert_non_null(out);
    fputs(text, out);
    assert_int_equal(fclose(out), 0);
}

static const char MESH[] =
    "# vtk DataFile Version 3.0\none element, 10 x 10 x 20 mm\nASCII\nDATASET UNSTRUCTURED_GRID\n"
    "POINTS 8 double\n0 0 0  0.01 0 0  0.01 0.01 0  0 0.01 0\n"
    "0 0 0.02  0.01 0 0.02  0.01 0.01 0.02  0 0.01 0.02\n"
    "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n";
static const char SCENE[] =
    "lariat: 1\nmesh: one.vtk\nmaterials:\n"
    "  - { cells: all, name: gel, law: neo-hookean, density: 1050, shear_modulus: 1.0e3, "
    "bulk_modulus: 4.0e4 }\n"
    "sets: [ { name: top, nodes: { plane: { point: [0, 0, 0.02], normal: [0, 0, 1] } } } ]\n"
    "fix:\n  - { nodes: { plane: { point: [0, 0, 0], normal: [0, 0, 1] } }, axes: z }\n"
    "  - { nodes: { nearest: [0, 0, 0] }, axes: xy }\n"
    "  - { nodes: { nearest: [0.01, 0, 0] }, axes: y }\n"
    "move: [ { nodes: top, axes: z, by: 0.002, over: 1 } ]\n";
/* Force of a neo-Hookean bar that keeps its volume, G = 2000 Pa: G A (s - 1 / s^2). */
static const char TABLE[] =
    "displacement,force\n0.001,0.0286\n0.002,0.0547\n0.003,0.0788\n0.004,0.1011\n";
#define PARAMETERS                                                                                 \
    "lariat-fit: 1\ntitle: A bar\nparameters:\n"                                                   \
    "  - { material: gel, parameter: shear_modulus, guess: 1.5e3, bounds: [1.0e2, 1.0e5] }\n"
#define EXPERIMENTS                                                                                \
    "experiments:\n  - { kind: tension, name: bar, scene: one.yaml, data: one.csv }\n"
static const char FIT[] = PARAMETERS EXPERIMENTS;
/* A free bar in tension does not know the second one. */
static const char TWO[] = PARAMETERS "  - { material: gel, parameter: bulk_modulus, guess: 4.0e4, "
                                     "bounds: [1.0e4, 1.0e6] }\n" EXPERIMENTS;

static int write_files(void **state) {
    (void)state;
    char command[1200];
    snprintf(command, sizeof command, "rm -rf '%s' && mkdir -p '%s'", FOLDER, FOLDER);
    if (system(command)) return -1;
    write_file("one.vtk", MESH);
    write_file("one.yaml", SCENE);
    write_file("one.csv", TABLE);
    write_file("fit.yaml", FIT);
    write_file("two.yaml", TWO);
    return 0;
}

static lar_fit *opened_as(const char *name) {
    lar_error error = {0};
    lar_fit *fit = NULL;
    if (lar_fit_open(path_of(name), &fit, &error)) fail_msg("%s", error.message);
    return fit;
}

static lar_fit *opened(void) {
    return opened_as("fit.yaml");
}

static void run_one(lar_fit *fit, const lar_fit_options *options) {
    lar_error error = {0};
    if (lar_fit_run(fit, options, &error)) fail_msg("%s", error.message);
}

static lar_fit_parameter_info parameter(const lar_fit *fit, int32_t index) {
    lar_error error = {0};
    lar_fit_parameter_info info;
    if (lar_fit_parameter(fit, index, &info, &error)) fail_msg("%s", error.message);
    return info;
}

static lar_fit_info inspected(const lar_fit *fit) {
    lar_error error = {0};
    lar_fit_info info;
    if (lar_fit_inspect(fit, &info, &error)) fail_msg("%s", error.message);
    return info;
}

/* ---- answers --------------------------------------------------------------------------------- */

static void before_it_runs_the_file_is_told(void **state) {
    (void)state;
    lar_error error = {0};
    lar_fit_experiment_info e;
    lar_fit *fit = opened_as("two.yaml");
    lar_fit_info info = inspected(fit);
    assert_int_equal(info.parameters, 2);
    assert_int_equal(info.experiments, 1);
    assert_int_equal(info.values, 4);
    assert_string_equal(info.title, "A bar");
    assert_string_equal(info.file, path_of("two.yaml"));
    assert_false(info.done || info.converged || info.interrupted || info.notes || info.runs);
    lar_fit_parameter_info p = parameter(fit, 1);
    assert_string_equal(p.name, "bulk_modulus");
    assert_string_equal(p.unit, "Pa");
    assert_true(p.value == 4e4 && p.lower_bound == 1e4 && p.upper_bound == 1e6 && isnan(p.low));
    assert_int_equal(lar_fit_experiment(fit, 0, &e, &error), LAR_OK);
    assert_null(e.model);
    assert_true(e.values == 4 && e.measured[3] == 0.1011);
    assert_true(isnan(lar_fit_correlation(fit, 0, 1)));
    assert_null(lar_fit_note(fit, 0));
    assert_int_equal(lar_fit_write(fit, path_of("early"), &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "call lar_fit_run first"));
    lar_fit_destroy(fit);
}

typedef struct heard {
    int calls, runs, stop_after;
    pthread_t thread;
} heard;

static int hear(void *context, const lar_fit_progress *progress) {
    heard *h = context;
    assert_true(pthread_equal(h->thread, pthread_self()));
    assert_non_null(progress->doing);
    assert_true(progress->runs >= h->runs);
    h->runs = progress->runs;
    return ++h->calls == h->stop_after;
}

static void parameters_are_told(void **state) {
    (void)state;
    lar_error error = {0};
    lar_fit_experiment_info e;
    heard h = {.thread = pthread_self()};
    lar_fit *fit = opened_as("two.yaml");
    lar_fit_options options = lar_fit_options_default();
    options.progress = hear;
    options.context = &h;
    run_one(fit, &options);
    lar_fit_info info = inspected(fit);
    assert_true(info.done && info.converged && !info.interrupted && info.seconds > 0);
    assert_true(h.calls > 2 && info.runs >= h.runs);
    lar_fit_parameter_info shear = parameter(fit, 0), bulk = parameter(fit, 1);
    assert_true(shear.told && shear.value > 1950 && shear.value < 2050);
    assert_true(shear.low < shear.value && shear.value < shear.high && shear.sensitivity > 1);
    assert_false(bulk.told);
    assert_true(info.notes >= 1);
    assert_non_null(lar_fit_note(fit, info.notes - 1));
    assert_null(lar_fit_note(fit, info.notes));
    assert_true(lar_fit_correlation(fit, 0, 0) == 1 && fabs(lar_fit_correlation(fit, 0, 1)) <= 1);
    assert_int_equal(lar_fit_experiment(fit, 0, &e, &error), LAR_OK);
    assert_string_equal(e.name, "bar");
    assert_string_equal(e.kind, "tension");
    for (int i = 0; i < e.values; i++) assert_true(fabs(e.model[i] - e.measured[i]) < 1e-3);
    assert_true(e.relative < 0.01 && e.rms > 0);
    lar_fit_destroy(fit);
}

/* The truth, 2000 Pa, lies beyond a bound, and both parameters say it. */
static void a_bound_is_told(void **state) {
    (void)state;
    char text[sizeof TWO + 1];
    lar_error error = {0};
    lar_fit *fit = NULL;
    strcpy(text, TWO);
    memcpy(strstr(text, "1.0e5]"), "1.6e3]", 6);
    if (lar_fit_from_text(text, FOLDER, &fit, &error)) fail_msg("%s", error.message);
    run_one(fit, NULL);
    lar_fit_parameter_info shear = parameter(fit, 0), bulk = parameter(fit, 1);
    assert_true(shear.at_bound && !shear.told && !shear.given_bound && isnan(shear.low));
    assert_true(!bulk.at_bound && bulk.given_bound);
    assert_true(inspected(fit).notes > 0);
    lar_fit_destroy(fit);
}

/* To the last bit, from a file and from its text. */
static void workers_change_nothing(void **state) {
    (void)state;
    lar_error error = {0};
    lar_fit *fit = opened(), *text = NULL;
    if (lar_fit_from_text(FIT, FOLDER, &text, &error)) fail_msg("%s", error.message);
    lar_fit_options options = lar_fit_options_default();
    run_one(fit, &options);
    for (int workers = 1; workers <= 3; workers += 2) {
        options.workers = workers;
        run_one(text, &options);
        lar_fit_parameter_info a = parameter(fit, 0), b = parameter(text, 0);
        assert_memory_equal(&a.value, &b.value, sizeof a.value);
        assert_memory_equal(&a.high, &b.high, sizeof a.high);
    }
    lar_fit_destroy(fit);
    lar_fit_destroy(text);
}

static void files_are_those_of_the_command(void **state) {
    (void)state;
    static const char *const made[] = {"made/gel.tissue.yaml", "made/1_bar.svg", "made/fit.json",
                                       "gel.tissue.yaml",      "bar.svg",        "bar.json"};
    lar_error error = {0};
    lar_fit *fit = opened();
    run_one(fit, NULL);
    assert_int_equal(lar_fit_write(fit, path_of("made"), &error), LAR_OK);
    assert_int_equal(lar_fit_write_tissue(fit, path_of(made[3]), NULL, &error), LAR_OK);
    assert_int_equal(lar_fit_write_tissue(fit, path_of(made[3]), "gel", &error), LAR_OK);
    assert_int_equal(lar_fit_write_svg(fit, path_of(made[4]), 0, &error), LAR_OK);
    assert_int_equal(lar_fit_write_json(fit, path_of(made[5]), &error), LAR_OK);
    for (size_t i = 0; i < sizeof made / sizeof *made; i++)
        assert_int_equal(access(path_of(made[i]), R_OK), 0);
    /* A scene takes it. */
    lar_model *model = NULL;
    lar_material_info material;
    write_file("with.yaml", "lariat: 1\nmesh: one.vtk\nmaterials: [ { cells: all, tissue: "
                            "made/gel.tissue.yaml } ]\n");
    if (lar_model_open(path_of("with.yaml"), &model, &error)) fail_msg("%s", error.message);
    assert_int_equal(lar_model_material(model, 0, &material, &error), LAR_OK);
    assert_true(fabs(material.shear_modulus / 2000 - 1) < 0.03);
    lar_model_destroy(model);
    lar_fit_destroy(fit);
}

/* ---- stopping -------------------------------------------------------------------------------- */

static void a_callback_stops_with_the_best_so_far(void **state) {
    (void)state;
    heard h = {.thread = pthread_self(), .stop_after = 2};
    lar_fit *fit = opened();
    lar_fit_options options = lar_fit_options_default();
    options.progress = hear;
    options.context = &h;
    run_one(fit, &options);
    lar_fit_info info = inspected(fit);
    assert_true(info.done && info.interrupted && isnan(info.deviation));
    /* Of the first guess nothing is to be concluded. */
    assert_int_equal(info.notes, 1);
    assert_non_null(strstr(lar_fit_note(fit, 0), "interrupted"));
    assert_int_equal(h.calls, 2);
    lar_fit_parameter_info p = parameter(fit, 0);
    assert_true(isnan(p.low) && !p.told && p.value > 100);
    assert_true(isnan(lar_fit_correlation(fit, 0, 0)));
    /* And it can be begun again. */
    h = (heard){.thread = pthread_self()};
    run_one(fit, &options);
    assert_false(inspected(fit).interrupted);
    lar_fit_destroy(fit);
}

static void a_stop_before_the_first_guess_leaves_the_former_answer(void **state) {
    (void)state;
    lar_error error = {0};
    lar_fit *fit = opened();
    lar_fit_stop(fit);
    assert_int_equal(lar_fit_run(fit, NULL, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "stopped before the first guess"));
    assert_false(inspected(fit).done);
    run_one(fit, NULL);
    const double value = parameter(fit, 0).value;
    lar_fit_stop(fit);
    assert_int_equal(lar_fit_run(fit, NULL, NULL), LAR_ERROR_ARGUMENT);
    assert_true(parameter(fit, 0).value == value && inspected(fit).done);
    lar_fit_destroy(fit);
}

static void *stop_soon(void *fit) {
    usleep(200000);
    lar_fit_stop(fit);
    return NULL;
}

/* Its first run alone would take minutes. */
static void another_thread_stops_it(void **state) {
    (void)state;
    char text[1024];
    lar_error error = {0};
    lar_fit *fit = NULL;
    pthread_t thread;
    snprintf(text, sizeof text, "%stime_step: 1.0e-8\n", SCENE);
    write_file("slow.yaml", text);
    write_file("slow_fit.yaml",
               "lariat-fit: 1\nparameters:\n  - { material: gel, parameter: shear_modulus, guess: "
               "1.5e3, bounds: [1.0e2, 1.0e5] }\nexperiments:\n"
               "  - { kind: tension, scene: slow.yaml, data: one.csv }\n");
    if (lar_fit_open(path_of("slow_fit.yaml"), &fit, &error)) fail_msg("%s", error.message);
    assert_int_equal(pthread_create(&thread, NULL, stop_soon, fit), 0);
    assert_int_equal(lar_fit_run(fit, NULL, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "stopped before the first guess"));
    pthread_join(thread, NULL);
    lar_fit_destroy(fit);
}

/* ---- misuse ---------------------------------------------------------------------------------- */

#define REFUSED(call, wanted, part)                                                                \
    do {                                                                                           \
        lar_error error = {0};                                                                     \
        assert_int_equal(call, wanted);                                                            \
        if (!strstr(error.message, part)) fail_msg("%s", error.message);                           \
        assert_int_equal(error.status, wanted);                                                    \
    } while (0)

static void null_is_refused_or_nothing(void **state) {
    (void)state;
    lar_fit *fit = NULL;
    lar_fit_info info;
    lar_fit_parameter_info p;
    lar_fit_experiment_info e;
    REFUSED(lar_fit_open(NULL, &fit, &error), LAR_ERROR_ARGUMENT, "not NULL");
    REFUSED(lar_fit_open("x", NULL, &error), LAR_ERROR_ARGUMENT, "not NULL");
    REFUSED(lar_fit_from_text(NULL, NULL, &fit, &error), LAR_ERROR_ARGUMENT, "not NULL");
    REFUSED(lar_fit_run(NULL, NULL, &error), LAR_ERROR_ARGUMENT, "needs a fit");
    REFUSED(lar_fit_inspect(NULL, &info, &error), LAR_ERROR_ARGUMENT, "needs a fit");
    REFUSED(lar_fit_parameter(NULL, 0, &p, &error), LAR_ERROR_ARGUMENT, "needs a fit");
    REFUSED(lar_fit_experiment(NULL, 0, &e, &error), LAR_ERROR_ARGUMENT, "needs a fit");
    REFUSED(lar_fit_write(NULL, "x", &error), LAR_ERROR_ARGUMENT, "needs a fit");
    REFUSED(lar_fit_write_tissue(NULL, "x", NULL, &error), LAR_ERROR_ARGUMENT, "needs a fit");
    REFUSED(lar_fit_write_svg(NULL, "x", 0, &error), LAR_ERROR_ARGUMENT, "needs a fit");
    REFUSED(lar_fit_write_json(NULL, "x", &error), LAR_ERROR_ARGUMENT, "needs a fit");
    assert_int_equal(lar_fit_open(NULL, NULL, NULL), LAR_ERROR_ARGUMENT);
    assert_true(isnan(lar_fit_correlation(NULL, 0, 0)));
    assert_null(lar_fit_note(NULL, 0));
    lar_fit_stop(NULL);
    lar_fit_destroy(NULL);
    lar_fit_options_default_sized(NULL, 0);
    fit = opened();
    assert_int_equal(lar_fit_inspect_sized(fit, NULL, 0, NULL), LAR_OK);
    REFUSED(lar_fit_parameter(fit, 1, &p, &error), LAR_ERROR_ARGUMENT, "no parameter 1");
    REFUSED(lar_fit_parameter(fit, -1, &p, &error), LAR_ERROR_ARGUMENT, "no parameter -1");
    REFUSED(lar_fit_experiment(fit, 1, &e, &error), LAR_ERROR_ARGUMENT, "no experiment 1");
    REFUSED(lar_fit_write(fit, NULL, &error), LAR_ERROR_ARGUMENT, "needs a path");
    const lar_fit_options fewer = {.workers = -1};
    REFUSED(lar_fit_run(fit, &fewer, &error), LAR_ERROR_ARGUMENT, "-1 workers");
    lar_fit_destroy(fit);
}

static void broken_experiments_are_refused(void **state) {
    (void)state;
    lar_fit *fit = NULL;
    REFUSED(lar_fit_open(path_of("none.yaml"), &fit, &error), LAR_ERROR_IO, "none.yaml");
    write_file("broken.yaml", "lariat-fit: 1\nparameters: [ {\n");
    REFUSED(lar_fit_open(path_of("broken.yaml"), &fit, &error), LAR_ERROR_FORMAT, "broken.yaml:");
    char text[sizeof FIT + 1];
    strcpy(text, FIT);
    memcpy(strstr(text, "one.csv"), "two.csv", 7);
    REFUSED(lar_fit_from_text(text, FOLDER, &fit, &error), LAR_ERROR_IO, "two.csv");
    strcpy(text, FIT);
    memcpy(strstr(text, "shear_modulus"), "shear_modulos", 13);
    REFUSED(lar_fit_from_text(text, FOLDER, &fit, &error), LAR_ERROR_MODEL, "experiment:4:");
    REFUSED(lar_fit_from_text("", FOLDER, &fit, &error), LAR_ERROR_FORMAT, "experiment");
    REFUSED(lar_fit_from_text("- 1\n", NULL, &fit, &error), LAR_ERROR_FORMAT, "experiment:1");
    assert_null(fit);
}

static void a_full_disk_is_told(void **state) {
    (void)state;
    if (access("/dev/full", W_OK)) skip();
    lar_fit *fit = opened();
    run_one(fit, NULL);
    assert_int_equal(symlink("/dev/full", path_of("full.tissue.yaml.part")), 0);
    assert_int_equal(symlink("/dev/full", path_of("full.json.part")), 0);
    REFUSED(lar_fit_write_tissue(fit, path_of("full.tissue.yaml"), "gel", &error), LAR_ERROR_IO,
            "full.tissue.yaml: ");
    REFUSED(lar_fit_write_json(fit, path_of("full.json"), &error), LAR_ERROR_IO, "No space left");
    REFUSED(lar_fit_write_svg(fit, path_of("no/folder.svg"), 0, &error), LAR_ERROR_IO,
            "folder.svg");
    REFUSED(lar_fit_write(fit, path_of("fit.yaml/x"), &error), LAR_ERROR_IO, "fit.yaml");
    REFUSED(lar_fit_write_tissue(fit, path_of("x.yaml"), "glue", &error), LAR_ERROR_ARGUMENT,
            "no material glue");
    assert_int_not_equal(access(path_of("full.tissue.yaml"), F_OK), 0);
    assert_true(parameter(fit, 0).told); /* nothing is lost */
    lar_fit_destroy(fit);
}

/* A program of another version: what it does not have stays away, what only it has is 0. */
static void sizes_may_differ(void **state) {
    (void)state;
    struct {
        lar_fit_options options;
        int64_t more;
    } newer = {lar_fit_options_default(), 0};
    lar_fit *fit = opened();
    struct {
        lar_fit_info info;
        int64_t more;
    } larger = {.more = 7};
    assert_int_equal(lar_fit_inspect_sized(fit, &larger.info, sizeof larger, NULL), LAR_OK);
    assert_true(larger.info.values == 4 && larger.more == 0);
    const char *file[2] = {NULL, "stays"};
    assert_int_equal(lar_fit_inspect_sized(fit, (lar_fit_info *)file, sizeof *file, NULL), LAR_OK);
    assert_non_null(file[0]);
    assert_string_equal(file[1], "stays");
    newer.more = 1;
    REFUSED(lar_fit_run_sized(fit, &newer.options, sizeof newer, &error), LAR_ERROR_UNSUPPORTED,
            "does not know");
    newer.more = 0;
    newer.options.workers = -1;
    REFUSED(lar_fit_run_sized(fit, &newer.options, sizeof newer, &error), LAR_ERROR_ARGUMENT,
            "workers");
    lar_fit_destroy(fit);
}

static void all_memory_is_given_back(void **state) {
    (void)state;
    assert_int_equal(__atomic_load_n(&live, __ATOMIC_RELAXED), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(before_it_runs_the_file_is_told),
        cmocka_unit_test(parameters_are_told),
        cmocka_unit_test(a_bound_is_told),
        cmocka_unit_test(workers_change_nothing),
        cmocka_unit_test(files_are_those_of_the_command),
        cmocka_unit_test(a_callback_stops_with_the_best_so_far),
        cmocka_unit_test(a_stop_before_the_first_guess_leaves_the_former_answer),
        cmocka_unit_test(another_thread_stops_it),
        cmocka_unit_test(null_is_refused_or_nothing),
        cmocka_unit_test(broken_experiments_are_refused),
        cmocka_unit_test(a_full_disk_is_told),
        cmocka_unit_test(sizes_may_differ),
        cmocka_unit_test(all_memory_is_given_back),
    };
    const lar_memory_hooks hooks = {.allocate = take, .resize = resize, .release = release};
    if (lar_memory_set(&hooks, NULL)) return 1;
    return cmocka_run_group_tests(tests, write_files, NULL);
}
