/* Whose folder it is that results are written to, and how they may be called. */
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file/folder.h"
#include "engine/engine_test.h"

#define FOLDER LAR_TEST_BUILD "/results_folder"

static lar_error error;

typedef struct bench {
    lar_model *model;
    lar_simulation *simulation;
} bench;

static bench begin(const char *source) {
    bench b = {.model = everything_model(&soft_brick)};
    free(b.model->source);
    b.model->source = lar_strdup(source);
    b.simulation = start(b.model);
    return b;
}

static void end(bench *b) {
    static const char *const names[] = {"organ_000000.vtu", "organ.pvd", "probes.csv"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char *path = lar_folder_join(FOLDER, names[i]);
        remove(path);
        free(path);
    }
    assert_int_equal(rmdir(FOLDER), 0); /* nothing else was left there */
    finish(b->simulation, b->model);
}

static lar_results *opened(const bench *b) {
    lar_results *results = NULL;
    if (lar_results_open(FOLDER, b->simulation, &results, &error)) fail_msg("%s", error.message);
    return results;
}

static bool refused(const bench *b) {
    lar_results *results = NULL;
    lar_status status = lar_results_open(FOLDER, b->simulation, &results, &error);
    bool none = !results;
    lar_results_close(results, NULL);
    return status == LAR_ERROR_IO && none && strstr(error.message, "another run");
}

static void one_at_a_time(void **unused) {
    (void)unused;
    bench b = begin("some/organ.yaml");
    lar_results *results = opened(&b);
    struct stat frame;
    assert_int_equal(lar_results_add(results, b.simulation, &error), LAR_OK);
    assert_true(refused(&b));
    assert_int_equal(stat(FOLDER "/organ_000000.vtu", &frame), 0); /* nor has that removed it */
    assert_int_equal(lar_results_close(results, &error), LAR_OK);
    results = opened(&b);
    assert_int_equal(lar_results_close(results, &error), LAR_OK);
    end(&b);
}

static void killed_writers_leave_the_folder(void **unused) {
    (void)unused;
    bench b = begin("some/organ.yaml");
    int told[2];
    assert_int_equal(pipe(told), 0);
    pid_t child = fork();
    if (child == 0) {
        opened(&b);
        if (write(told[1], "", 1) != 1) _exit(1);
        for (;;) pause();
    }
    char byte;
    assert_int_equal(read(told[0], &byte, 1), 1);
    bool while_it_lived = refused(&b);
    kill(child, SIGKILL);
    assert_int_equal(waitpid(child, NULL, 0), child);
    assert_true(while_it_lived);
    lar_results *results = opened(&b);
    assert_int_equal(lar_results_close(results, &error), LAR_OK);
    close(told[0]);
    close(told[1]);
    end(&b);
}

/* Neither does its closing let others in, nor does what it has keep them out. */
static void a_forked_child_changes_nothing(void **unused) {
    (void)unused;
    bench b = begin("some/organ.yaml");
    lar_results *results = opened(&b);
    int told[2];
    assert_int_equal(pipe(told), 0);
    pid_t closes = fork();
    if (closes == 0) _exit(lar_results_close(results, &error));
    int status;
    assert_int_equal(waitpid(closes, &status, 0), closes);
    assert_int_equal(status, 0);
    assert_true(refused(&b));
    pid_t stays = fork();
    if (stays == 0)
        for (;;) pause();
    assert_int_equal(lar_results_close(results, &error), LAR_OK);
    bool again = !refused(&b);
    kill(stays, SIGKILL);
    assert_int_equal(waitpid(stays, NULL, 0), stays);
    assert_true(again);
    end(&b);
}

static void names_that_no_list_can_hold(void **unused) {
    (void)unused;
    static const char *const names[] = {"new\nline.yaml", "bell\a.yaml", "latin\xe4.yaml",
                                        "cut\xc3.yaml"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        bench b = begin(names[i]);
        lar_results *results = NULL;
        assert_int_equal(lar_results_open(FOLDER, b.simulation, &results, &error), LAR_ERROR_IO);
        assert_non_null(strstr(error.message, "rename"));
        assert_int_equal(access(FOLDER, F_OK), -1);
        finish(b.simulation, b.model);
    }
    bench b = begin("a \"name\"; <pr\xc3\xa4"
                    "fix> & more.yaml");
    lar_results *results = opened(&b);
    assert_int_equal(lar_results_close(results, &error), LAR_OK);
    end(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_at_a_time),
        cmocka_unit_test(killed_writers_leave_the_folder),
        cmocka_unit_test(a_forked_child_changes_nothing),
        cmocka_unit_test(names_that_no_list_can_hold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
