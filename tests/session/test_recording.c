/* A recording plays with the same hashes on any grid; one that is damaged, altered or of something
 * else is refused by name. */
#define NAME "session"
#include "session/recording_test.h"

static void plays_on_every_grid(void **unused) {
    (void)unused;
    static const struct {
        const char *grid;
        int threads;
    } divided[] = {{NULL, 0}, {"2x1x1", 1}, {"1x2x1", 2}, {"3x1x2", 1}};
    for (int recorded = 0; recorded < 2; recorded++) {
        uint64_t end = record(recorded ? "2x1x1" : NULL, recorded ? 2 : 0);
        for (int k = 0; k < 4; k++) {
            lar_replay_report report;
            DONE(replay(PATH, divided[k].grid, divided[k].threads, &report));
            assert_true(report.hashes > 20);
            assert_true(report.steps > 1200);
            assert_true(report.different == UINT64_MAX);
            assert_true(report.recorded_hash == report.replayed_hash);
            assert_true(report.steps >= end);
        }
    }
}

/* A run that breaks does so again in its replay; one that was taken up before its end does not. */
static void broken_runs_break_again(void **unused) {
    (void)unused;
    for (int taken_up = 0; taken_up < 2; taken_up++) {
        lar_session_options options = lar_session_options_default();
        options.record = PATH;
        bench b = open_bench_of(torn_block(), "2x1x1", 1, &options);
        DONE(lar_session_start(b.session, &failure));
        lar_session_status stopped = await(&b, LAR_SESSION_STOPPED, 200);
        if (taken_up) {
            lar_session_pause(b.session);
            DONE(lar_session_reset(b.session, &failure));
            lar_session_pause(b.session);
            await(&b, LAR_SESSION_PAUSED, 0);
        }
        close_bench(&b);
        lar_model *model = torn_block();
        lar_simulation *simulation = start_with(model, block_options(NULL, 0));
        lar_replay_report report;
        failure.message[0] = '\0';
        lar_status status = lar_replay(simulation, PATH, NULL, NULL, &report, &failure);
        assert_int_equal(status, taken_up ? LAR_OK : LAR_ERROR_UNSTABLE);
        if (!taken_up) assert_string_equal(failure.message, stopped.message);
        assert_int_equal(report.broken, !taken_up);
        assert_true(report.different == UINT64_MAX);
        finish(simulation, model);
    }
}

/* ---- altered on purpose -------------------------------------------------------------------- */

static lar_bytes file;

static uint64_t *word_at(size_t byte) {
    assert_true(byte % 8 == 0 && byte < file.size);
    return (uint64_t *)(void *)(file.data + byte);
}

/* Byte where the record behind the one at `at` begins. */
static size_t behind(size_t at) {
    return at + 8 * (3 + (size_t)((*word_at(at + 8) + 7) / 8));
}

static const size_t FIRST = 8 * (2 + LAR_RECORDING_HEADER_WORDS);

/* All checksums as they should be now. */
static void sign(void) {
    uint64_t sum = lar_chain(0, word_at(0), 1 + LAR_RECORDING_HEADER_WORDS);
    *word_at(FIRST - 8) = sum;
    for (size_t at = FIRST; at < file.size; at = behind(at)) {
        size_t words = (behind(at) - at) / 8 - 1;
        sum = lar_chain(sum, word_at(at), words);
        *word_at(at + 8 * words) = sum;
    }
}

static void write_bad(size_t size) {
    FILE *out = fopen(BAD, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(file.data, 1, size, out), size);
    assert_int_equal(fclose(out), 0);
}

static void refused(lar_status status, const char *word) {
    lar_replay_report report;
    failure.message[0] = '\0';
    assert_int_equal(replay(BAD, NULL, 0, &report), status);
    if (!strstr(failure.message, word) || !strstr(failure.message, BAD))
        fail_msg("'%s' lacks '%s'", failure.message, word);
}

static size_t find(lar_record_kind kind, int which) {
    for (size_t at = FIRST; at < file.size; at = behind(at))
        if (*word_at(at) == (uint64_t)kind && which-- == 0) return at;
    fail_msg("no record of kind %d", (int)kind);
    return 0;
}

static void reload(void) {
    lar_bytes_free(&file);
    DONE(lar_bytes_read(PATH, &file, &failure));
}

static void first_difference_is_named(void **unused) {
    (void)unused;
    record(NULL, 0);
    reload();
    /* A hash that was altered. */
    size_t at = find(LAR_RECORD_HASH, 4);
    uint64_t step = *word_at(at + 16);
    *word_at(at + 24) ^= 1;
    sign();
    write_bad(file.size);
    lar_replay_report report;
    assert_int_equal(replay(BAD, NULL, 0, &report), LAR_ERROR_FORMAT);
    assert_true(report.different == step);
    assert_int_equal(report.hashes, 5);
    assert_true(report.recorded_hash == (report.replayed_hash ^ 1));
    char name[40];
    snprintf(name, sizeof name, "at step %llu", (unsigned long long)step);
    assert_non_null(strstr(failure.message, name));
    lar_bytes_free(&file);
}

static void damage_is_found(void **unused) {
    (void)unused;
    record(NULL, 0);
    reload();
    for (size_t bit = 5; bit < 8 * file.size; bit += 8 * file.size / 40) {
        file.data[bit / 8] ^= (unsigned char)(1u << bit % 8);
        write_bad(file.size);
        failure.message[0] = '\0';
        assert_int_equal(replay(BAD, NULL, 0, NULL), LAR_ERROR_FORMAT);
        assert_non_null(strstr(failure.message, BAD));
        file.data[bit / 8] ^= (unsigned char)(1u << bit % 8);
    }
    for (size_t size = 1; size < file.size; size += file.size / 40) {
        lar_replay_report report;
        write_bad(size);
        refused(LAR_ERROR_FORMAT, size < 8 ? "is no recording" : "cut off");
        if (replay(BAD, NULL, 0, &report) && size > FIRST)
            assert_true(report.different == UINT64_MAX);
    }
    lar_bytes_free(&file);
}

/* Gravity, damping and stiffness are played at their steps, in a session too. */
static void settings_are_played(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    options.record = PATH;
    options.hash_every = 50;
    bench b = open_bench("2x1x1", 1, &options);
    const double bulk = 0.8 * lar_simulation_parameter(b.simulation, 0, "bulk_modulus");
    const double gravity[3] = {0.5, 0, -3};
    double now[3];
    DONE(lar_session_start(b.session, &failure));
    lead(&b, 100);
    DONE(lar_session_set_gravity(b.session, gravity, &failure));
    lead(&b, 100);
    DONE(lar_session_set_stiffness(b.session, -1, 3, &failure));
    DONE(lar_session_set_damping(b.session, 7, &failure));
    DONE(lar_session_set_parameter(b.session, 0, "bulk_modulus", bulk, &failure));
    lead(&b, 200);
    lar_session_gravity(b.session, now);
    assert_memory_equal(now, gravity, sizeof now);
    assert_true(lar_session_damping(b.session) == 7);
    assert_true(lar_session_stiffness(b.session, 0) == 3);
    assert_true(lar_session_stiffness(b.session, 1) == 0);
    assert_int_equal(lar_session_set_stiffness(b.session, 0, 9, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_session_set_parameter(b.session, 0, "ksi", 9, &failure),
                     LAR_ERROR_ARGUMENT);
    lar_session_pause(b.session);
    await(&b, LAR_SESSION_PAUSED, 0);
    DONE(lar_session_set_gravity(b.session, NULL, &failure));
    DONE(lar_session_set_parameter(b.session, 0, NULL, 0, &failure));
    lar_session_play(b.session);
    lead(&b, 100);
    DONE(lar_session_reset(b.session, &failure));
    assert_true(lar_session_stiffness(b.session, 0) == 1);
    DONE(lar_session_set_stiffness(b.session, 0, 0.5, &failure));
    lead(&b, 100);
    close_bench(&b);
    for (int grid = 0; grid < 2; grid++) {
        lar_replay_report report;
        DONE(replay(PATH, grid ? "2x2x1" : NULL, 1, &report));
        assert_true(report.hashes > 8 && report.different == UINT64_MAX);
    }
    options.record = NULL;
    b = open_bench(NULL, 0, &options);
    DONE(lar_session_start(b.session, &failure));
    DONE(lar_session_replay(b.session, PATH, &failure));
    await(&b, LAR_SESSION_PAUSED, 0);
    assert_string_equal(status_of(&b).message, "");
    assert_true(lar_session_stiffness(b.session, 0) == 0.5);
    assert_int_equal(lar_session_set_damping(b.session, 1, &failure), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "is being played"));
    DONE(lar_session_replay(b.session, NULL, &failure));
    DONE(lar_session_set_damping(b.session, 1, &failure));
    close_bench(&b);

    /* One that was altered. */
    static const struct {
        int word;
        uint64_t value;
        const char *why;
    } forged[] = {{1, LAR_SETTING_KINDS, "sets what cannot be set"},
                  {1, LAR_SETTING_SUPPORT, "there is no node -1 to support"},
                  {1, LAR_SETTING_PARAMETER, "of material -1"},
                  {2, (uint64_t)-2, "sets what cannot be set"},
                  {2, 1, "there is no material 1"},
                  {3, 0x7ff8000000000000, "sets what cannot be: "}};
    for (int i = 0; i < 6; i++) {
        reload();
        *word_at(find(LAR_RECORD_SET, 1) + 16 + 8 * (size_t)forged[i].word) = forged[i].value;
        sign();
        write_bad(file.size);
        refused(LAR_ERROR_FORMAT, forged[i].why);
    }
    lar_bytes_free(&file);
}

/* Who leaves a recording that is not played disturbs neither the run nor its hashes. */
static void nothing_to_leave_changes_nothing(void **unused) {
    (void)unused;
    lar_session_options options = lar_session_options_default();
    options.record = PATH;
    options.hash_every = 50;
    bench b = open_bench(NULL, 0, &options);
    DONE(lar_session_start(b.session, &failure));
    for (int i = 0; i < 20; i++) {
        lead(&b, 20);
        DONE(lar_session_replay(b.session, NULL, &failure));
    }
    close_bench(&b);
    reload();
    uint64_t before = 0, ticks = 2 * *word_at(64);
    for (size_t at = FIRST; at < file.size; at = behind(at)) {
        if (*word_at(at) != LAR_RECORD_HASH) continue;
        assert_true(*word_at(at + 16) - before <= 50 + ticks);
        before = *word_at(at + 16);
    }
    assert_true(before >= 400);
    lar_bytes_free(&file);
}

/* Version 1 is what is left without settings. */
static void recordings_of_before_are_played(void **unused) {
    (void)unused;
    record(NULL, 0);
    reload();
    *word_at(8) = 1;
    sign();
    write_bad(file.size);
    lar_replay_report report;
    DONE(replay(BAD, NULL, 0, &report));
    lar_bytes_free(&file);
}

static void forged_files_are_refused(void **unused) {
    (void)unused;
    record(NULL, 0);
    static const struct {
        lar_record_kind kind;
        int which; /* record */
        int word;  /* of the payload */
        uint64_t value;
        const char *name;
    } forged[] = {
        {LAR_RECORD_MOVE, 3, 0, 0, "back in time"},
        {LAR_RECORD_MOVE, 3, 0, UINT64_MAX, "beyond all range"},
        {LAR_RECORD_MOVE, 3, 0, 1u << 31, "more steps after the last state hash"},
        {LAR_RECORD_MOVE, 3, 1, 3, "a tool that the recording does not have"},
        {LAR_RECORD_MOVE, 3, 2, 0, "where none can be"},
        {LAR_RECORD_MOVE, 3, 3, 0x7ff8000000000000, "where none can be"},
        {LAR_RECORD_MOVE, 3, 10, 0x4000000000000000, "where none can be"},
        {LAR_RECORD_MOVE, 3, -1, 16, "wrong length"},
        {LAR_RECORD_MOVE, 3, -2, 77, "unknown kind"},
        {LAR_RECORD_STATE, 0, 0, 5, "a state of another step"},
        {LAR_RECORD_STATE, 0, 3, 5, "checkpoint"},
        {LAR_RECORD_STATE, 0, -2, LAR_RECORD_END, "wrong length"},
    };
    for (size_t i = 0; i < sizeof forged / sizeof forged[0]; i++) {
        reload();
        size_t at = find(forged[i].kind, forged[i].which);
        size_t next = behind(at);
        uint64_t *word = word_at(at + 16) + forged[i].word;
        *word = forged[i].value;
        if (forged[i].word != -1)
            sign();
        else {
            /* Up to the record itself the chain must hold. */
            *word = 88;
            sign();
            *word = forged[i].value;
        }
        (void)next;
        write_bad(file.size);
        refused(LAR_ERROR_FORMAT, forged[i].name);
    }
    reload();
    *word_at(8) = 4;
    write_bad(file.size);
    refused(LAR_ERROR_FORMAT, "version 4");
    reload();
    *word_at(8 * 7) = 0; /* time step */
    sign();
    write_bad(file.size);
    refused(LAR_ERROR_FORMAT, "numbers that no recording has");
    lar_bytes_free(&file);
}

static void other_models_are_refused(void **unused) {
    (void)unused;
    record(NULL, 0);
    static const struct {
        size_t word;
        uint64_t value;
        const char *name;
    } other[] = {{3, 5, "another model"},
                 {4, 5, "another model"},
                 {7, 0x3f1a36e2eb1c432e, "time step"},
                 {2, 1, "elements hex8-full"},
                 {5, 7, "7 tools"}};
    for (size_t i = 0; i < sizeof other / sizeof other[0]; i++) {
        reload();
        *word_at(8 * other[i].word) = other[i].value;
        sign();
        write_bad(file.size);
        refused(LAR_ERROR_MODEL, other[i].name);
    }
    lar_bytes_free(&file);
}

/* ---- the file ------------------------------------------------------------------------------ */

static void killed_writers_leave_a_beginning(void **unused) {
    (void)unused;
    remove(PATH);
    pid_t child = fork();
    if (child == 0) {
        lar_session_options options = lar_session_options_default();
        options.record = PATH;
        bench b = open_bench(NULL, 0, &options);
        if (lar_session_start(b.session, &failure)) _exit(1);
        lead(&b, 1000000);
        _exit(1);
    }
    assert_true(child > 0);
    struct stat about = {0};
    /* Handed over as it comes, not block by block. */
    for (int i = 0; i < 1000 && (about.st_size < 12000 || about.st_size % 4096 == 0); i++) {
        nap(0.01);
        stat(PATH, &about);
    }
    assert_true(about.st_size >= 12000 && about.st_size % 4096 != 0);
    kill(child, SIGKILL);
    assert_int_equal(waitpid(child, NULL, 0), child);
    lar_replay_report report;
    assert_int_equal(replay(PATH, "2x1x1", 1, &report), LAR_ERROR_FORMAT);
    assert_non_null(strstr(failure.message, "cut off"));
    assert_true(report.hashes > 0);
    assert_true(report.different == UINT64_MAX);
}

static void other_files_are_spared(void **unused) {
    (void)unused;
    bench b = open_bench(NULL, 0, NULL);
    FILE *out = fopen(BAD, "w");
    fputs("lariat: 1\n", out);
    fclose(out);
    assert_int_equal(lar_session_record(b.session, BAD, &failure), LAR_ERROR_IO);
    assert_non_null(strstr(failure.message, "is no recording"));
    assert_int_equal(lar_session_record(b.session, LAR_TEST_BUILD, &failure), LAR_ERROR_IO);
    assert_int_equal(lar_session_record(b.session, LAR_TEST_BUILD "/no/where", &failure),
                     LAR_ERROR_IO);
    remove(BAD);
    assert_int_equal(mkfifo(BAD, 0600), 0);
    assert_int_equal(lar_session_record(b.session, BAD, &failure), LAR_ERROR_IO);
    lar_replay_report report;
    assert_int_equal(replay(BAD, NULL, 0, &report), LAR_ERROR_IO); /* and does not wait */
    remove(BAD);
    assert_int_equal(symlink(PATH, BAD), 0); /* stays, also when a recording does not begin */
    assert_int_equal(lar_session_record(b.session, BAD, &failure), LAR_ERROR_IO);
    assert_non_null(strstr(failure.message, "is no plain file"));
    assert_int_equal(remove(BAD), 0);
    assert_int_equal(status_of(&b).recording, 0);
    close_bench(&b);
    assert_int_equal(replay(LAR_TEST_BUILD "/none", NULL, 0, &report), LAR_ERROR_IO);
    assert_int_equal(replay(NULL, NULL, 0, &report), LAR_ERROR_ARGUMENT);
    lar_recording_info info;
    assert_int_equal(lar_replay(NULL, PATH, NULL, NULL, NULL, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_recording_inspect(NULL, &info, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_recording_inspect(PATH, NULL, &failure), LAR_ERROR_ARGUMENT);
    assert_int_equal(replay(LAR_TEST_BUILD, NULL, 0, &report), LAR_ERROR_IO);
}

/* Two recordings in one file would be none. */
static void a_file_has_one_recording(void **unused) {
    (void)unused;
    lar_replay_report report;
    bench b = open_bench(NULL, 0, NULL), other = open_bench(NULL, 0, NULL);
    DONE(lar_session_start(b.session, &failure));
    DONE(lar_session_record(b.session, PATH, &failure));
    assert_int_equal(lar_session_record(b.session, PATH, &failure), LAR_ERROR_IO);
    assert_non_null(strstr(failure.message, "another recording"));
    assert_int_equal(lar_session_record(other.session, PATH, &failure), LAR_ERROR_IO);
    assert_int_equal(status_of(&b).recording, 1);
    lead(&b, 200);
    DONE(lar_session_record(b.session, NULL, &failure));
    assert_int_equal(replay(PATH, NULL, 0, &report), LAR_OK);
    assert_true(report.hashes > 0);
    DONE(lar_session_record(other.session, PATH, &failure));
    close_bench(&b);
    close_bench(&other);
}

/* A disk that is full: the session goes on, and closing tells. */
static void full_disks_are_told(void **unused) {
    (void)unused;
    struct rlimit before, small;
    bench b = open_bench(NULL, 0, NULL);
    DONE(lar_session_start(b.session, &failure));
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before);
    small = before;
    small.rlim_cur = 4096;
    setrlimit(RLIMIT_FSIZE, &small);
    DONE(lar_session_record(b.session, PATH, &failure));
    lead(&b, 500);
    lar_status status = lar_session_record(b.session, NULL, &failure);
    setrlimit(RLIMIT_FSIZE, &before);
    assert_int_equal(status, LAR_ERROR_IO);
    assert_non_null(strstr(failure.message, "could not be written completely"));
    assert_int_equal(status_of(&b).state, LAR_SESSION_PLAYING);
    close_bench(&b);
}

/* A state that cannot be recorded ends the recording: nothing may follow from another one. */
static void lost_states_end_a_recording(void **unused) {
    (void)unused;
    bench b = open_bench_of(torn_block(), NULL, 0, NULL);
    const lar_recording_header header = lar_session_recording_header(b.session);
    lar_recorder *recorder = NULL;
    DONE(lar_recorder_create(PATH, &header, &recorder, &failure));
    DONE(lar_recorder_put_state(recorder, b.simulation, &failure));
    DONE(lar_session_start(b.session, &failure));
    await(&b, LAR_SESSION_STOPPED, 200);
    assert_int_equal(lar_recorder_put_state(recorder, b.simulation, &failure), LAR_ERROR_UNSTABLE);
    assert_false(lar_recorder_put(recorder, &(lar_record){.kind = LAR_RECORD_END, .step = 1}));
    assert_int_equal(lar_recorder_close(recorder, &failure), LAR_ERROR_UNSTABLE);
    assert_non_null(strstr(failure.message, "breaks off at step 0, where"));
    close_bench(&b);
}

/* Of a simulation that has been advanced before: nothing goes back in time behind the state that
 * the recording begins with. */
static void a_reset_before_the_first_tick_is_played(void **unused) {
    (void)unused;
    lar_model *model = hanging_block();
    lar_simulation *simulation = start_with(model, block_options(NULL, 0));
    lar_session_options options = lar_session_options_default();
    lar_session *session = NULL;
    lar_replay_report report;
    options.record = PATH;
    options.paused = 1;
    DONE(lar_simulation_advance(simulation, 30, &failure));
    DONE(lar_session_open(simulation, &options, &session, &failure));
    DONE(lar_session_start(session, &failure));
    DONE(lar_session_reset(session, &failure));
    DONE(lar_session_close(session, &failure));
    DONE(replay(PATH, NULL, 0, &report));
    assert_true(report.different == UINT64_MAX);
    finish(simulation, model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plays_on_every_grid),
        cmocka_unit_test(broken_runs_break_again),
        cmocka_unit_test(nothing_to_leave_changes_nothing),
        cmocka_unit_test(first_difference_is_named),
        cmocka_unit_test(damage_is_found),
        cmocka_unit_test(settings_are_played),
        cmocka_unit_test(recordings_of_before_are_played),
        cmocka_unit_test(forged_files_are_refused),
        cmocka_unit_test(other_models_are_refused),
        cmocka_unit_test(killed_writers_leave_a_beginning),
        cmocka_unit_test(other_files_are_spared),
        cmocka_unit_test(a_file_has_one_recording),
        cmocka_unit_test(full_disks_are_told),
        cmocka_unit_test(lost_states_end_a_recording),
        cmocka_unit_test(a_reset_before_the_first_tick_is_played),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
