/* Processors of mpirun. Without arguments: what is refused where there is no mpirun. Under mpirun
 * (mpi.sh) what cannot happen elsewhere:
 *
 *     test_comm_mpi find                       who am I
 *     test_comm_mpi large                      packets beyond what MPI sends at once, left at once
 *     test_comm_mpi lose BACKEND KIND VICTIM   all exchange for ever, one goes: kill stop fail hang
 *
 * These end with status 1 and a message on the error stream when they fail. */
#include "fleet.h"

typedef struct trouble {
    const char *kind;
    int32_t victim;
} trouble;

static void happen(lar_comm *comm, const char *kind) {
    fprintf(stderr, "processor %d: %s\n", (int)lar_comm_self(comm), kind);
    if (strcmp(kind, "kill") == 0) kill(getpid(), SIGKILL);
    if (strcmp(kind, "stop") == 0) kill(getpid(), SIGSTOP);
    if (strcmp(kind, "fail") == 0) lar_comm_abort(comm);
    if (strcmp(kind, "hang") == 0) sleep(20);
}

static const char *exchange_for_ever(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    const trouble *t = context;
    lar_error error;
    char data[200] = {0};
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    for (uint64_t step = 1;; step++) {
        if (self == t->victim && step == 1000) happen(comm, t->kind);
        for (int32_t p = 0; p < count; p++)
            if (lar_comm_put(comm, p, 256 * (size_t)self, data, 200, step, &error))
                return fleet_say(text, "%s", error.message);
        for (int32_t p = 0; p < count; p++)
            if (lar_comm_wait(comm, p, 256 * (size_t)p, 200, step, NULL, &error))
                return fleet_say(text, "%s", error.message);
    }
}

/* Each sends 3 MB and leaves as soon as it has its own: what was put still arrives. */
enum { LARGE = 3 << 20 };
static const char *large(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context;
    lar_error error;
    unsigned char *data = malloc(LARGE);
    if (!data) return "no memory";
    int32_t peer = 1 - lar_comm_self(comm);
    const char *wrong = NULL;
    for (uint64_t step = 1; step <= 5 && !wrong; step++) {
        const void *payload;
        memset(data, (int)step, LARGE);
        if (step == 5 && peer == 0) usleep(300000);
        if (lar_comm_put(comm, peer, 0, data, LARGE, step, &error) ||
            (step == 5 && peer == 1 ? LAR_OK
                                    : lar_comm_wait(comm, peer, 0, LARGE, step, &payload, &error)))
            wrong = fleet_say(text, "%s", error.message);
        else if ((step < 5 || peer == 0) && memcmp(payload, data, LARGE) != 0)
            wrong = "a packet of another step";
    }
    free(data);
    return wrong;
}

/* One fleet over one backend of the job; true when it was good. */
static bool run(lar_comm_job *job, fleet f) {
    lar_comm_options o = lar_comm_options_default();
    lar_error error;
    char text[FLEET_TEXT] = "";
    if (lar_comm_job_meet(job, &o, &error)) {
        snprintf(text, sizeof text, "%s", error.message);
    } else {
        f.listener = o.listener;
        memcpy(f.master, o.master, sizeof f.master);
        fleet_live(&f, job->self, text);
    }
    if (text[0]) fprintf(stderr, "[%d] %s\n", (int)job->self, text);
    return !text[0];
}

static int complain(const lar_error *error) {
    fprintf(stderr, "%s\n", error->message);
    return 1;
}

/* ---- without mpirun ------------------------------------------------------------------------- */

static void a_process_alone_cannot_use_mpi(void **state) {
    (void)state;
    lar_comm_job job;
    lar_error error;
    assert_int_equal(lar_comm_job_find(&job, &error), LAR_OK);
    assert_int_equal(job.count, 1);
    lar_comm_options o = lar_comm_options_default();
    assert_int_equal(lar_comm_job_meet(&job, &o, &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_comm_job_end(&job, false, &error), LAR_OK);
    lar_comm_backend_info info;
    for (int row = 0; lar_comm_backend_list(row, &info); row++) {
        if (info.missing || info.start != LAR_COMM_BY_LAUNCHER) continue;
        lar_comm *comm;
        o.backend = info.name;
        o.count = 2;
        o.master = "127.0.0.1:1";
        assert_int_equal(lar_comm_open(&o, &comm, &error), LAR_ERROR_ARGUMENT);
        assert_non_null(strstr(error.message, "mpirun -n 2"));
    }
}

/* variable, value, ...: are these several? */
static bool launched(const char *const *variables) {
    static const char *const all[] = {
        "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "PMI_RANK",     "PMI_SIZE",
        "SLURM_PROCID",         "SLURM_STEP_NUM_TASKS", "SLURM_NTASKS", "PMIX_RANK"};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) unsetenv(all[i]);
    for (; *variables; variables += 2) setenv(variables[0], variables[1], 1);
    return lar_comm_job_launched();
}

static void launchers_are_recognised(void **state) {
    (void)state;
    assert_false(launched((const char *const[]){NULL}));
    assert_true(launched(
        (const char *const[]){"OMPI_COMM_WORLD_RANK", "1", "OMPI_COMM_WORLD_SIZE", "2", NULL}));
    assert_true(launched((const char *const[]){"PMI_RANK", "0", "PMI_SIZE", "3", NULL}));
    assert_true(
        launched((const char *const[]){"SLURM_PROCID", "0", "SLURM_STEP_NUM_TASKS", "2", NULL}));
    assert_true(launched((const char *const[]){"PMIX_RANK", "0", NULL}));
    /* One process alone, the script of a batch job, nonsense. */
    assert_false(launched((const char *const[]){"PMI_RANK", "0", "PMI_SIZE", "1", NULL}));
    assert_false(launched((const char *const[]){"SLURM_PROCID", "0", "SLURM_NTASKS", "8", NULL}));
    assert_false(launched((const char *const[]){"PMI_RANK", "x", "PMI_SIZE", "2", NULL}));
    assert_false(launched((const char *const[]){"PMI_RANK", "", "PMI_SIZE", "", NULL}));
}

static void a_missing_module_is_named(void **state) {
    (void)state;
    lar_comm_job job;
    lar_error error;
    assert_true(launched((const char *const[]){"PMI_RANK", "0", "PMI_SIZE", "2", NULL}));
    setenv("LARIAT_MPI", "carrier", 1);
    assert_int_equal(lar_comm_job_find(&job, &error), LAR_ERROR_UNSUPPORTED);
    assert_non_null(strstr(error.message, "liblariat-mpi-carrier.so"));
    setenv("LARIAT_MPI", "/nowhere/module.so", 1);
    assert_int_equal(lar_comm_job_find(&job, &error), LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "/nowhere/module.so"));
    setenv("LARIAT_MPI", "/dev/null", 1);
    assert_int_equal(lar_comm_job_find(&job, &error), LAR_ERROR_IO);
    unsetenv("LARIAT_MPI");
}

static int without_mpirun(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_process_alone_cannot_use_mpi),
                                       cmocka_unit_test(launchers_are_recognised),
                                       cmocka_unit_test(a_missing_module_is_named)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

int main(int argc, char **argv) {
    const char *mode = argc > 1 ? argv[1] : "";
    lar_comm_job job;
    lar_error error;
    bool good = true;
    if (argc < 2) return without_mpirun();
    if (lar_comm_job_find(&job, &error)) return complain(&error);
    if (strcmp(mode, "find") == 0) printf("%d of %d\n", (int)job.self, (int)job.count);
    if (strcmp(mode, "large") == 0)
        good = run(&job, (fleet){.backend = "mpi", .count = 2, .bytes = LARGE + 8, .body = large});
    trouble t = {argc > 3 ? argv[3] : "", argc > 4 ? atoi(argv[4]) : 0};
    if (strcmp(mode, "lose") == 0 && argc > 4)
        good = run(&job, (fleet){.backend = argv[2],
                                 .count = job.count,
                                 .bytes = 256 * FLEET_MAX,
                                 .body = exchange_for_ever,
                                 .context = &t});
    if (lar_comm_job_end(&job, !good, &error)) return complain(&error);
    return good ? 0 : 1;
}
