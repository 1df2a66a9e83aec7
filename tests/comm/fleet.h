/* Processors for the tests of comm: as threads of this process or as forked processes, over every
 * backend of this build that can be started so. A body returns NULL or says what is wrong;
 * assertions stay with the caller. */
#ifndef LAR_TESTS_COMM_FLEET_H
#define LAR_TESTS_COMM_FLEET_H

#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "comm/channel.h"
#include "comm/comm.h"
#include "comm/job.h"

enum { FLEET_MAX = 32, FLEET_TEXT = 1100 };

typedef const char *(*fleet_body)(lar_comm *comm, void *context, char text[FLEET_TEXT]);

typedef struct fleet {
    const char *backend;
    int32_t count;
    size_t bytes;
    fleet_body body;
    void *context;
    double start_timeout, timeout, patience; /* 0: the default */
    uint64_t odd_identity;                   /* of processor 1, when not 0 */
    /* Called by each before it opens and after it closed, or NULL. */
    void (*around)(void *context, int32_t self, bool closed);
    lar_comm_team *team;
    int listener;
    char master[LAR_COMM_ADDRESS_TEXT];
} fleet;

/* Backend `index` of those whose processors a test can start itself (not by mpirun); false beyond
 * the last. */
static inline bool fleet_backend(int index, lar_comm_backend_info *info) {
    for (int row = 0; lar_comm_backend_list(row, info); row++)
        if (!info->missing && info->start != LAR_COMM_BY_LAUNCHER && index-- == 0) return true;
    return false;
}

static inline bool fleet_is_team(const char *backend) {
    lar_comm_backend_info info;
    for (int row = 0; lar_comm_backend_list(row, &info); row++)
        if (strcmp(info.name, backend) == 0) return info.start == LAR_COMM_BY_TEAM;
    return false;
}

typedef struct fleet_member {
    fleet *of;
    int32_t self;
    pthread_t thread;
    char text[FLEET_TEXT]; /* "" : good */
} fleet_member;

static inline lar_comm_options fleet_options(const fleet *f, int32_t self) {
    lar_comm_options o = lar_comm_options_default();
    o.backend = f->backend;
    o.self = self;
    o.count = f->count;
    o.receive_bytes = f->bytes;
    o.identity = self == 1 ? f->odd_identity : 0;
    o.team = f->team;
    o.master = f->master;
    if (self == 0) o.listener = f->listener;
    if (f->start_timeout > 0) o.start_timeout = f->start_timeout;
    if (f->timeout > 0) o.timeout = f->timeout;
    if (f->patience > 0) o.patience = f->patience;
    return o;
}

/* One processor's life. */
static inline void fleet_live(fleet *f, int32_t self, char text[FLEET_TEXT]) {
    if (f->around) f->around(f->context, self, false);
    lar_comm_options options = fleet_options(f, self);
    lar_comm *comm = NULL;
    lar_error error;
    text[0] = '\0';
    if (lar_comm_open(&options, &comm, &error)) {
        snprintf(text, FLEET_TEXT, "%s", error.message);
    } else {
        char own[FLEET_TEXT];
        const char *wrong = f->body(comm, f->context, own);
        if (wrong) snprintf(text, FLEET_TEXT, "%s", wrong);
        lar_comm_close(comm);
    }
    if (f->around) f->around(f->context, self, true);
}

static inline void *fleet_thread(void *member) {
    fleet_member *m = member;
    fleet_live(m->of, m->self, m->text);
    return NULL;
}

static inline void fleet_prepare(fleet *f) {
    lar_error error;
    f->listener = -1;
    if (fleet_is_team(f->backend))
        assert_int_equal(lar_comm_team_create(f->count, &f->team, &error), LAR_OK);
    else
        assert_int_equal(lar_comm_listen("127.0.0.1:0", &f->listener, f->master, &error), LAR_OK);
}

/* All as threads; texts[count] get what each says. */
static inline void fleet_threads(fleet f, char (*texts)[FLEET_TEXT]) {
    fleet_member *members = calloc((size_t)f.count, sizeof *members);
    assert_non_null(members);
    fleet_prepare(&f);
    for (int32_t p = 0; p < f.count; p++) {
        members[p] = (fleet_member){.of = &f, .self = p};
        assert_int_equal(pthread_create(&members[p].thread, NULL, fleet_thread, &members[p]), 0);
    }
    for (int32_t p = 0; p < f.count; p++) {
        pthread_join(members[p].thread, NULL);
        memcpy(texts[p], members[p].text, FLEET_TEXT);
    }
    lar_comm_team_destroy(f.team);
    free(members);
}

typedef struct fleet_processes {
    int32_t count;
    pid_t pid[FLEET_MAX];
    int words[FLEET_MAX]; /* the reading end of each one's pipe */
    char master[LAR_COMM_ADDRESS_TEXT];
} fleet_processes;

/* All as processes, which run when this returns. */
static inline void fleet_launch(fleet f, fleet_processes *running) {
    fleet_prepare(&f);
    running->count = f.count;
    memcpy(running->master, f.master, sizeof f.master);
    for (int32_t p = 0; p < f.count; p++) {
        int ends[2];
        assert_int_equal(pipe(ends), 0);
        fflush(NULL);
        running->pid[p] = fork();
        assert_true(running->pid[p] >= 0);
        if (running->pid[p] == 0) {
            char text[FLEET_TEXT];
            close(ends[0]);
            if (p != 0) close(f.listener);
            fleet_live(&f, p, text);
            _exit(write(ends[1], text, strlen(text)) < 0 ? 3 : text[0] ? 1 : 0);
        }
        close(ends[1]);
        running->words[p] = ends[0];
    }
    if (f.listener >= 0) close(f.listener);
}

/* Waits for one to end and takes what it said. Returns its wait status. */
static inline int fleet_reap(fleet_processes *running, int32_t p, char text[FLEET_TEXT]) {
    size_t filled = 0;
    for (ssize_t got = 1; got > 0 && filled<FLEET_TEXT - 1; filled += got> 0 ? (size_t)got : 0)
        got = read(running->words[p], text + filled, FLEET_TEXT - 1 - filled);
    text[filled] = '\0';
    close(running->words[p]);
    int status = 0;
    assert_int_equal(waitpid(running->pid[p], &status, 0), running->pid[p]);
    return status;
}

/* All as processes, to their end. */
static inline void fleet_fork(fleet f, char (*texts)[FLEET_TEXT]) {
    fleet_processes running;
    fleet_launch(f, &running);
    for (int32_t p = 0; p < f.count; p++) {
        int status = fleet_reap(&running, p, texts[p]);
        if (!texts[p][0] && status) snprintf(texts[p], FLEET_TEXT, "ended with status %d", status);
    }
}

static inline void fleet_expect_good(const char *what, const fleet *f, char (*texts)[FLEET_TEXT]) {
    int wrong = 0;
    for (int32_t p = 0; p < f->count; p++) {
        if (!texts[p][0]) continue;
        print_error("%s, %s, processor %d: %s\n", what, f->backend, (int)p, texts[p]);
        wrong++;
    }
    assert_int_equal(wrong, 0);
}

/* Under mpirun this process is one processor of every fleet, or looks on when the fleet is smaller.
 */
static inline lar_comm_job *fleet_job(void) {
    static lar_comm_job job;
    lar_error error;
    if (job.count == 0 && lar_comm_job_find(&job, &error)) fail_msg("%s", error.message);
    return job.count > 1 ? &job : NULL;
}

static inline void fleet_in_job(const char *what, fleet f) {
    lar_comm_backend_info info;
    lar_comm_job *job = fleet_job();
    assert_true(f.count <= job->count);
    for (int row = 0; lar_comm_backend_list(row, &info); row++) {
        if (info.missing || info.start == LAR_COMM_BY_TEAM) continue;
        lar_comm_options o = lar_comm_options_default();
        lar_error error;
        char text[FLEET_TEXT] = "";
        if (lar_comm_job_meet(job, &o, &error)) fail_msg("%s", error.message);
        f.backend = info.name;
        f.listener = o.listener;
        memcpy(f.master, o.master, sizeof f.master);
        if (job->self < f.count) fleet_live(&f, job->self, text);
        if (text[0]) fail_msg("%s, %s, processor %d: %s", what, f.backend, (int)job->self, text);
    }
}

/* The last words of main. */
static inline int fleet_end(int failed) {
    lar_error error;
    if (!fleet_job() || !lar_comm_job_end(fleet_job(), failed != 0, &error)) return failed;
    fprintf(stderr, "%s\n", error.message);
    return 1;
}

/* Every backend with threads, and those for processes with processes too. */
static inline void fleet_everywhere(const char *what, fleet f) {
    lar_comm_backend_info info;
    if (lar_comm_job_launched()) {
        fleet_in_job(what, f);
        return;
    }
    char(*texts)[FLEET_TEXT] = calloc((size_t)f.count, FLEET_TEXT);
    assert_non_null(texts);
    for (int i = 0; fleet_backend(i, &info); i++) {
        f.backend = info.name;
        fleet_threads(f, texts);
        fleet_expect_good(what, &f, texts);
        if (info.start == LAR_COMM_BY_TEAM) continue;
        fleet_fork(f, texts);
        fleet_expect_good(what, &f, texts);
    }
    free(texts);
}

/* For bodies: `return fleet_say(text, ...)`. */
static inline const char *fleet_say(char text[FLEET_TEXT], const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static inline const char *fleet_say(char text[FLEET_TEXT], const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(text, FLEET_TEXT, format, args);
    va_end(args);
    return text;
}

#endif
