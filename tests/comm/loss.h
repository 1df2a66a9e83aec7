/* For the tests of losses: fleets of processes in which one gets into trouble, and what the others
 * must show then. Everyone writes its results into shared memory, each with its own clock, so that
 * the time from the trouble to the end of a process does not depend on when the test looks. What
 * the machine itself was late in that time, a sleeping thread measures, and that is allowed for. */
#ifndef LAR_TESTS_COMM_LOSS_H
#define LAR_TESTS_COMM_LOSS_H

#include "fleet.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>

enum { LOSS_MAX = 8, LOSS_BYTES = 256 * LOSS_MAX };
static const double LOSS_LIMIT = 2.0;     /* [s], the promise */
static const unsigned LOSS_TOO_LONG = 60; /* [s], then a process that hangs is ended */

typedef enum loss_kind {
    LOSS_KILL,    /* SIGKILL */
    LOSS_STOP,    /* SIGSTOP */
    LOSS_CUT,     /* every connection shut down, as when the network goes */
    LOSS_CUT_ONE, /* one connection */
    LOSS_FAIL,    /* lar_comm_abort */
    LOSS_HANG     /* lives, but sends nothing */
} loss_kind;

typedef struct loss_entry {
    uint64_t step;         /* atomic: the one being exchanged */
    double reported;       /* when the wait failed; 0: it never did */
    double ended;          /* after closing */
    int status, fds, lost; /* of the failed wait; open before; fewer (-) or more at the end */
} loss_entry;

/* In memory that all share. */
typedef struct loss_results {
    int32_t victim;
    loss_kind kind;
    int cut;        /* LOSS_CUT_ONE: which of its sockets */
    long self_kill; /* [us] after its start the victim kills itself; 0: it does not */
    double began;   /* when the trouble came */
    int released;   /* atomic: who hangs may end */
    loss_entry entries[LOSS_MAX];
} loss_results;

static inline double loss_now(void) {
    struct timespec at;
    clock_gettime(CLOCK_MONOTONIC, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

static inline loss_results *loss_results_create(int32_t victim, loss_kind kind) {
    loss_results *results =
        mmap(NULL, sizeof *results, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    assert_true(results != MAP_FAILED);
    results->victim = victim;
    results->kind = kind;
    return results;
}

/* ---- in the victim --------------------------------------------------------------------------- */

static loss_results *loss_mine;          /* for signal handlers */
static volatile sig_atomic_t loss_asked; /* the trouble begins at the next step */

/* In both directions: a connection that is being closed carries nothing. */
static inline bool loss_connected(int fd) {
    struct tcp_info info;
    socklen_t length = sizeof info;
    return getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &length) == 0 &&
           info.tcpi_state == TCP_ESTABLISHED;
}

static inline void loss_cut(int signal) {
    (void)signal;
    int number = 0, error = errno;
    for (int pass = 0; pass < 2; pass++) {
        for (int fd = 3; fd < 256; fd++) {
            if (!loss_connected(fd)) continue;
            if (pass == 0) number++;
            if (pass == 1 && (loss_mine->kind == LOSS_CUT || number-- == 0))
                shutdown(fd, SHUT_RDWR);
        }
        if (number > 0) number = loss_mine->cut % number;
    }
    errno = error;
}

static inline void loss_ask(int signal) {
    (void)signal;
    loss_asked = 1;
}

static inline void loss_die(int signal) {
    (void)signal;
    loss_mine->began = loss_now();
    kill(getpid(), SIGKILL);
}

/* ---- in every process ------------------------------------------------------------------------ */

static inline int loss_count_fds(void) {
    int count = 0;
    DIR *folder = opendir("/proc/self/fd");
    if (!folder) return 0;
    while (readdir(folder)) count++;
    closedir(folder);
    return count;
}

static inline void loss_around(void *context, int32_t self, bool closed) {
    loss_results *results = context;
    loss_entry *own = &results->entries[self];
    if (closed) {
        own->ended = loss_now();
        /* The listener of processor 0 was there before and is taken over. */
        own->lost = loss_count_fds() - own->fds + (self == 0);
        return;
    }
    alarm(LOSS_TOO_LONG);
    own->fds = loss_count_fds();
    if (self != results->victim) return;
    loss_mine = results;
    signal(SIGUSR1, loss_cut);
    signal(SIGUSR2, loss_ask);
    if (!results->self_kill) return;
    signal(SIGALRM, loss_die);
    struct itimerval timer = {.it_value.tv_usec = results->self_kill};
    setitimer(ITIMER_REAL, &timer, NULL);
}

/* With both neighbours of a ring. Where one connection is cut, with everyone: a connection that
 * nobody uses is nobody's loss. */
static inline lar_status loss_exchange(lar_comm *comm, bool everyone, uint64_t step,
                                       lar_error *error) {
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    lar_status status = LAR_OK;
    char data[200] = {0};
    for (int pass = 0; pass < 2; pass++) /* put, then wait */
        for (int32_t hop = 1; hop < count && !status; hop++) {
            int32_t p = (self + hop) % count;
            if (!everyone && hop != 1 && hop != count - 1) continue;
            if (pass == 0)
                status = lar_comm_put(comm, p, 256 * (size_t)self, data, 200, step, error);
            else
                status = lar_comm_wait(comm, p, 256 * (size_t)p, 200, step, NULL, error);
        }
    return status;
}

/* Exchange for ever. */
static inline const char *loss_ring(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    loss_results *results = context;
    loss_entry *own = &results->entries[lar_comm_self(comm)];
    lar_error error;
    for (uint64_t step = 1;; step++) {
        __atomic_store_n(&own->step, step, __ATOMIC_RELEASE);
        if (loss_asked && results->kind == LOSS_FAIL) {
            lar_comm_abort(comm);
            return "its own failure";
        }
        while (loss_asked && !__atomic_load_n(&results->released, __ATOMIC_ACQUIRE)) usleep(1000);
        lar_status status = loss_exchange(comm, results->kind == LOSS_CUT_ONE, step, &error);
        if (!status) continue;
        own->reported = loss_now();
        own->status = status;
        return fleet_say(text, "%s", error.message);
    }
}

/* ---- in the test ----------------------------------------------------------------------------- */

typedef struct loss_control {
    pthread_t thread;
    int over;    /* atomic */
    double late; /* all that its sleeps took too long [s] */
} loss_control;

static inline void *loss_sleep(void *context) {
    loss_control *control = context;
    while (!__atomic_load_n(&control->over, __ATOMIC_ACQUIRE)) {
        double begin = loss_now();
        usleep(10000);
        control->late += loss_now() - begin - 0.01;
    }
    return NULL;
}

static inline void loss_control_start(loss_control *control) {
    *control = (loss_control){.over = 0};
    assert_int_equal(pthread_create(&control->thread, NULL, loss_sleep, control), 0);
}

static inline double loss_control_stop(loss_control *control) {
    __atomic_store_n(&control->over, 1, __ATOMIC_RELEASE);
    pthread_join(control->thread, NULL);
    return control->late;
}

/* Waits until everyone exchanges. */
static inline void loss_await_steps(const loss_results *results, int32_t count, uint64_t step) {
    double deadline = loss_now() + 30;
    for (int32_t p = 0; p < count; p++)
        while (__atomic_load_n(&results->entries[p].step, __ATOMIC_ACQUIRE) < step) {
            assert_true(loss_now() < deadline);
            usleep(500);
        }
}

static inline void loss_begin(loss_results *results, pid_t victim) {
    static const int signals[] = {SIGKILL, SIGSTOP, SIGUSR1, SIGUSR1, SIGUSR2, SIGUSR2};
    results->began = loss_now();
    assert_int_equal(kill(victim, signals[results->kind]), 0);
}

/* Our objects that nobody alive owns; those of tests that run beside this one are locked, or go
 * within a moment. */
static inline int loss_objects_left(void) {
    int count = 1;
    for (int attempt = 0; attempt < 100 && count > 0; attempt++) {
        count = 0;
        if (attempt) usleep(20000);
        DIR *folder = opendir("/dev/shm");
        if (!folder) return 0;
        for (struct dirent *entry; (entry = readdir(folder));) {
            if (strncmp(entry->d_name, "lariat-comm-", 12) != 0) continue;
            char path[300];
            snprintf(path, sizeof path, "/dev/shm/%s", entry->d_name);
            int object = open(path, O_RDWR);
            if (object >= 0 && flock(object, LOCK_EX | LOCK_NB) == 0) count++;
            if (object >= 0) close(object);
        }
        closedir(folder);
    }
    return count;
}

/* Sockets that still listen or are connected at the port of processor zero, two seconds after all
 * have ended: on a busy machine the last word of a killed processor is still on its way when it is
 * gone. */
static inline int loss_sockets_left(const char *master) {
    unsigned port = (unsigned)atoi(strrchr(master, ':') + 1), from, to, state;
    int count = 1;
    char line[300];
    for (int attempt = 0; attempt < 100 && count > 0; attempt++) {
        count = 0;
        if (attempt) usleep(20000);
        FILE *table = fopen("/proc/net/tcp", "r");
        while (table && fgets(line, sizeof line, table))
            if (sscanf(line, "%*d: %*x:%x %*x:%x %x", &from, &to, &state) == 3 &&
                (from == port || to == port) && (state == 1 || state == 10))
                count++;
        if (table) fclose(table);
    }
    return count;
}

/* What everyone but the victim must show after a loss in the step loop; counts what is wrong. */
static inline int loss_check(const loss_results *results, const char *backend, int32_t p,
                             const char *text, double late) {
    const loss_entry *own = &results->entries[p];
    char lost[40], complete[80];
    snprintf(lost, sizeof lost, "processor %d is lost", (int)results->victim);
    snprintf(complete, sizeof complete, "the last complete step of processor %d is %llu;", (int)p,
             (unsigned long long)own->step - 1);
    /* Of one connection that is cut there are two ends. */
    bool named = strstr(text, lost) || (results->kind == LOSS_CUT_ONE &&
                                        (strstr(text, "is lost") || strstr(text, "given up")));
    bool stepped = strstr(text, complete) != NULL;
    bool in_time = own->ended > 0 && own->ended - results->began < LOSS_LIMIT + late;
    bool clean = own->status == LAR_ERROR_PEER && own->lost == 0;
    if (named && stepped && in_time && clean) return 0;
    print_error("%s, victim %d, kind %d: processor %d ends with status %d after %.3f s "
                "(the machine: %.3f s late), %d descriptors more, and says: %s\n",
                backend, (int)results->victim, (int)results->kind, (int)p, own->status,
                own->ended - results->began, late, own->lost, text);
    return 1;
}

#endif
