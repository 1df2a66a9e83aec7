/* The step is quiet: after warm-up it allocates nothing, takes no lock and asks the system for
 * nothing.
 *
 * Memory and locks are counted by the linker's --wrap, which leads every call from the library to
 * the functions below; system calls are forbidden by a seccomp filter in a child process, which the
 * kernel kills at the first one. Where the sandbox of the test allows no filter, that part says so
 * and is skipped. */
#include "engine/body_contact_test.h"
#include "engine/tool_contact_test.h"

#include <errno.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

static int calls;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *memory);
int __real_pthread_mutex_lock(pthread_mutex_t *mutex);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __wrap_free(void *memory);
int __wrap_pthread_mutex_lock(pthread_mutex_t *mutex);

void *__wrap_malloc(size_t size) {
    calls++;
    return __real_malloc(size);
}
void *__wrap_calloc(size_t count, size_t size) {
    calls++;
    return __real_calloc(count, size);
}
void *__wrap_realloc(void *old, size_t size) {
    calls++;
    return __real_realloc(old, size);
}
void *__wrap_aligned_alloc(size_t alignment, size_t size) {
    calls++;
    return __real_aligned_alloc(alignment, size);
}
void __wrap_free(void *memory) {
    calls++;
    __real_free(memory);
}
int __wrap_pthread_mutex_lock(pthread_mutex_t *mutex) {
    calls++;
    return __real_pthread_mutex_lock(mutex);
}

static void a_step_allocates_and_locks_nothing(void **unused) {
    (void)unused;
    for (int kind = LAR_ELEMENT_HEX8; kind <= LAR_ELEMENT_HEX8_MATRIX; kind++) {
        lar_model *model = everything_model(&soft_brick);
        lar_options options = lar_options_default();
        options.element = (lar_element_kind)kind;
        int before = calls;
        lar_simulation *simulation = start_with(model, options);
        assert_true(calls > before); /* the counting works */
        advance(simulation, 10);
        lar_error error;
        before = calls;
        lar_status status = lar_simulation_advance(simulation, 300, &error);
        int counted = calls - before;
        assert_int_equal(status, LAR_OK);
        assert_int_equal(counted, 0);
        finish(simulation, model);
    }
}

/* Also while bodies touch, and the search for what may touch is made anew. */
static void contact_allocates_and_locks_nothing(void **unused) {
    (void)unused;
    lar_model *model = two_bricks(&soft_brick, &soft_brick, 0.004, false);
    throw_nodes(model, model->mesh.node_count / 2, model->mesh.node_count,
                (double[]){0.02, 0, -0.3});
    lar_simulation *simulation = start(model);
    advance(simulation, 1);
    lar_error error;
    lar_contact_info before, after;
    lar_simulation_contact(simulation, &before);
    int from = calls;
    lar_status status = lar_simulation_advance(simulation, 100, &error);
    int counted = calls - from;
    lar_simulation_contact(simulation, &after);
    assert_int_equal(status, LAR_OK);
    assert_int_equal(counted, 0);
    assert_true(after.tested > before.tested && after.searches > before.searches);
    finish(simulation, model);
}

/* Also while a tool, a hand and a plane are at work. */
static void tools_allocate_and_lock_nothing(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&soft_brick);
    touch_tool(model, "ball", (lar_tool){.shape = LAR_TOOL_SPHERE, .radius = 0.006},
               (double[]){0.015, 0.01, 0.0275});
    add_plane(model, (double[]){0, 0, -0.0012}, (double[]){0, 0, 1});
    lar_options options = lar_options_default();
    options.hands = 1;
    lar_simulation *simulation = start_with(model, options);
    lar_error error;
    lar_contact_info info;
    place(simulation, 1, (double[]){0.03, 0.02, 0.02}, (double[]){1, 0, 0, 0}, 0, 1);
    place(simulation, 0, (double[]){0.017, 0.01, 0.023}, (double[]){1, 0, 0, 0}, 1, 200);
    advance(simulation, 10);
    int before = calls;
    lar_status status = lar_simulation_advance(simulation, 300, &error);
    int counted = calls - before;
    lar_simulation_contact(simulation, &info);
    assert_int_equal(status, LAR_OK);
    assert_int_equal(counted, 0);
    assert_true(simulation->report.tool[0].touching > 0 && simulation->report.tool[1].held > 0);
    /* Nor does going back to a state in memory. */
    lar_saved *saved = NULL;
    assert_int_equal(lar_saved_create(simulation, &saved, &error), LAR_OK);
    before = calls;
    status = lar_simulation_save_to(simulation, saved, &error);
    for (int i = 0; i < 3 && !status; i++) {
        status = lar_simulation_advance(simulation, 5, &error);
        if (!status) status = lar_simulation_load_from(simulation, saved, &error);
    }
    counted = calls - before;
    assert_int_equal(status, LAR_OK);
    assert_int_equal(counted, 0);
    lar_saved_destroy(saved);
    assert_true(info.searches > 2 && info.touching > 0);
    finish(simulation, model);
}

/* The same of four processors with two threads each. Threads take a lock to fall asleep and to wake
 * up between two advances and between two intervals of one (step/interval.h), so it is counted
 * within intervals, by processor zero, when the slowest has woken up; not while every step is an
 * interval, for something is sudden. */
static int calls_from, calls_within, intervals;
static bool sudden;

static int count_within(void *context, uint64_t step) {
    const lar_simulation *simulation = context;
    uint64_t interval = simulation->domain.interval, place = step % interval;
    assert_true(interval >= 8);
    sudden = (sudden && place != 0) || lar_division_is_close(&simulation->tools.division);
    if (place == 4) calls_from = calls;
    if (place != interval - 1 || step < 50 || sudden) return 1;
    calls_within += calls - calls_from;
    intervals++;
    return 1;
}

static void processors_allocate_and_lock_nothing(void **unused) {
    (void)unused;
    static const char *const schemes[] = {"all", "local", "one", "two"};
    for (int i = 0; i < 4; i++) {
        lar_model *model = everything_model(&soft_brick);
        lar_options options = lar_options_default();
        options.grid = "2x2x1";
        options.threads = 2;
        options.scheme = schemes[i];
        lar_simulation *simulation = start_with(model, options);
        lar_error error;
        calls_within = intervals = 0;
        if (lar_simulation_advance_with(simulation, 2000, count_within, simulation, &error))
            fail_msg("%s", error.message);
        assert_true(intervals > 40);
        assert_int_equal(calls_within, 0);
        finish(simulation, model);
    }
}

/* From here on every system call but exit_group kills the process. */
static bool forbid_system_calls(void) {
    struct sock_filter rules[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
    };
    struct sock_fprog program = {sizeof rules / sizeof rules[0], rules};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

enum { QUIET = 0, FAILED = 1, NO_FILTER = 77 };

/* Runs in a child: its exit status, or 256 + the signal that ended it. */
static int in_child(lar_simulation *simulation, uint64_t steps) {
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (!forbid_system_calls()) _exit(NO_FILTER);
        lar_status status = LAR_OK;
        if (steps > 0)
            status = lar_simulation_advance(simulation, steps, NULL);
        else
            (void)syscall(SYS_getppid);
        syscall(SYS_exit_group, status ? FAILED : QUIET);
    }
    int result;
    while (waitpid(child, &result, 0) < 0) assert_int_equal(errno, EINTR);
    return WIFEXITED(result) ? WEXITSTATUS(result) : 256 + WTERMSIG(result);
}

static void a_step_makes_no_system_call(void **unused) {
    (void)unused;
    lar_model *model = everything_model(&soft_brick);
    lar_simulation *simulation = start(model);
    advance(simulation, 10);
    int caught = in_child(simulation, 0);
    if (caught == NO_FILTER) {
        print_message("skipped: this system allows no seccomp filter\n");
        finish(simulation, model);
        skip();
    }
    assert_int_equal(caught, 256 + SIGSYS); /* the filter works */
    assert_int_equal(in_child(simulation, 1000), QUIET);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_step_allocates_and_locks_nothing),
        cmocka_unit_test(contact_allocates_and_locks_nothing),
        cmocka_unit_test(tools_allocate_and_lock_nothing),
        cmocka_unit_test(processors_allocate_and_lock_nothing),
        cmocka_unit_test(a_step_makes_no_system_call),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
