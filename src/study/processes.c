#include "study/processes.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "base/clock.h"
#include "base/memory.h"
#include "comm/comm.h"
#include "comm/job.h"
#include "study/arrival.h"

/* How long a process may take to end, and to say why [s]; the short one is for a failure that all
 * have alike, which is told once. */
static const double GRACE = 1.5, SHORT_GRACE = 0.3, HESITATION = 1.0, LAST_GRACE = 0.5;

/* Whoever wants more on one machine has mistyped the grid. */
enum { STARTED_MAX = 64 };

/* By this variable of the environment a process knows which one has started it. */
static const char PARENT[] = "LARIAT_PARENT";

static const char PROGRAM[] = "/proc/self/exe"; /* that this process runs */

extern char **environ;

struct lar_processes {
    lar_processes_setting setting;
    lar_comm_start start;
    int32_t self;
    bool several;    /* processors are processes */
    bool has_parent; /* processor zero has started this one */
    lar_comm_job job;
    /* of those that were started here */
    int32_t count;
    pid_t *pid;   /* [count], 0: not running; of processor 0 it is not used */
    int listener; /* kept for every rendezvous; -1: none */
    char address[LAR_COMM_ADDRESS_TEXT];
    int32_t named; /* whose end has been told already; 0: nobody's */
};

static void nap(void) {
    nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
}

static bool by_hand(const lar_processes *p) {
    return p->setting.processor >= 0;
}

/* ---- the parent ----------------------------------------------------------------------------- */

/* Processor zero's word that it is over: a signal that nobody else sends. */
enum { OVER = SIGVTALRM };

static bool created; /* once the others have been met here */

static void end_soon(int signal_number) {
    (void)signal_number;
    const bool leaves_something = lar_comm_interrupt() || created;
    const struct itimerval end = {.it_value = {leaves_something ? 2 : 0, 1}};
    setitimer(ITIMER_REAL, &end, NULL);
}

/* When processor zero ends, this process has two seconds to find out and to say so; one that has
 * not come to the others yet ends at once, both by SIGALRM. The signal may come more than once: for
 * each thread of the dying process that was the parent for a moment. */
static void follow_parent(void) {
    struct sigaction action = {.sa_handler = end_soon, .sa_flags = SA_RESTART};
    sigset_t over;
    sigemptyset(&action.sa_mask);
    sigaction(OVER, &action, NULL);
    sigemptyset(&over);
    sigaddset(&over, OVER);
    sigprocmask(SIG_UNBLOCK, &over, NULL);
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, OVER);
#endif
}

static lar_status find_parent(lar_processes *p, lar_error *error) {
    const char *text = getenv(PARENT);
    if (!by_hand(p) || p->self == 0 || !text) return LAR_OK;
    p->has_parent = true;
    follow_parent();
    if (strtol(text, NULL, 10) == (long)getppid()) return LAR_OK;
    return lar_fail(error, LAR_ERROR_PEER,
                    "processor 0, which has started processor %d, has ended; see what it says "
                    "itself (or unset %s)",
                    (int)p->self, PARENT);
}

/* ---- who am I ------------------------------------------------------------------------------ */

/* How processors of a backend are started; false for one that does not exist. */
static bool find_start(const char *comm, lar_comm_start *start) {
    lar_comm_backend_info info;
    for (int i = 0; lar_comm_backend_list(i, &info); i++)
        if (strcmp(info.name, comm) == 0) {
            *start = info.start;
            return true;
        }
    return false;
}

static lar_status check_launcher(const lar_processes *p, lar_error *error) {
    if (lar_comm_job_launched() && by_hand(p))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "mpirun or srun says which processor this is; leave --processor out");
    if (lar_comm_job_launched() && !p->several)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "mpirun or srun has started this command more than once, and every one "
                        "would compute everything; give --comm mpi and --grid, or start it alone");
    return LAR_OK;
}

lar_status lar_processes_begin(const lar_processes_setting *setting, lar_processes **processes,
                               lar_error *error) {
    lar_processes *p = lar_calloc(1, sizeof *p);
    if (!p) return lar_fail_memory(error, sizeof *p, "the processes");
    p->setting = *setting;
    p->listener = -1;
    p->start = LAR_COMM_BY_TEAM;
    p->job.count = 1;
    if (setting->comm) find_start(setting->comm, &p->start);
    p->several = p->start != LAR_COMM_BY_TEAM;
    p->self = by_hand(p) ? setting->processor : 0;
    lar_status status = check_launcher(p, error);
    if (!status) status = find_parent(p, error);
    if (!status && p->several && !by_hand(p)) {
        status = lar_comm_job_find(&p->job, error);
        if (p->job.count > 1) p->self = p->job.self;
    }
    if (status)
        free(p);
    else
        *processes = p;
    return status;
}

int32_t lar_processes_self(const lar_processes *p) {
    return p->self;
}

bool lar_processes_has_parent(const lar_processes *p) {
    return p->has_parent;
}

bool lar_processes_by_hand(const lar_processes *p) {
    return by_hand(p) && !p->has_parent;
}

/* ---- starting the others ------------------------------------------------------------------- */

/* The command line of processor k: the command's words, who it is, and what this process was
 * given. Freed by the caller. */
static char **make_command(const lar_processes *p, char *words, char number[16]) {
    enum { WORDS = 8 };
    int count = p->setting.argument_count;
    char **command = lar_calloc((size_t)count + WORDS + 5, sizeof *command);
    int used = 0;
    if (!command) return NULL;
    for (char *rest = words, *word; used < WORDS && (word = strtok_r(NULL, " ", &rest));)
        command[used++] = word;
    command[used++] = (char *)"--processor";
    command[used++] = number;
    command[used++] = (char *)"--master";
    command[used++] = (char *)p->address;
    memcpy(command + used, p->setting.argument, (size_t)count * sizeof *command);
    return command;
}

/* What it leaves to processor zero; and OVER, until it can hear it. */
static void block_signals(posix_spawnattr_t *attributes) {
    static const int left[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU, OVER};
    sigset_t blocked;
    pthread_sigmask(SIG_BLOCK, NULL, &blocked);
    for (size_t i = 0; i < sizeof left / sizeof left[0]; i++) sigaddset(&blocked, left[i]);
    posix_spawnattr_setsigmask(attributes, &blocked);
    posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGMASK);
}

/* It reads nothing, and writes messages only. */
static int spawn(char **command, char **environment, pid_t *child) {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    int reason = posix_spawnattr_init(&attributes);
    if (reason) return reason;
    block_signals(&attributes);
    reason = posix_spawn_file_actions_init(&files);
    if (reason) {
        posix_spawnattr_destroy(&attributes);
        return reason;
    }
    reason = posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    if (!reason)
        reason = posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (!reason) reason = posix_spawn(child, PROGRAM, &files, &attributes, command, environment);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    return reason;
}

static lar_status start_one(lar_processes *p, int32_t k, char **environment, lar_error *error) {
    char number[16], words[128];
    snprintf(number, sizeof number, "%d", (int)k);
    snprintf(words, sizeof words, "lariat %s", p->setting.command);
    char **command = make_command(p, words, number);
    if (!command) return lar_fail_memory(error, sizeof *command, "a command line");
    int reason = spawn(command, environment, &p->pid[k]);
    free(command);
    if (!reason) return LAR_OK;
    p->pid[k] = 0;
    const char *lacks = access("/dev/null", F_OK) != 0 ? "/dev/null"
                        : access(PROGRAM, F_OK) != 0   ? PROGRAM
                                                       : NULL;
    if (lacks)
        return lar_fail(error, LAR_ERROR_IO,
                        "the system starts no process for processor %d: there is no %s; mount "
                        "/dev and /proc, or use --comm threads",
                        (int)k, lacks);
    return lar_fail(error, LAR_ERROR_MEMORY,
                    "the system starts no process for processor %d: %s; use fewer processors, or "
                    "%s",
                    (int)k, strerror(reason), lar_remedy(reason, "raise the limit (ulimit -u)"));
}

static lar_processes *parent_of_all; /* for a signal: this process has started others */

static lar_status start_all(lar_processes *p, lar_error *error) {
    char parent[40];
    size_t variables = 0;
    while (environ[variables]) variables++;
    char **environment = lar_calloc(variables + 2, sizeof *environment);
    if (!environment) return lar_fail_memory(error, variables, "the environment");
    snprintf(parent, sizeof parent, "%s=%ld", PARENT, (long)getpid());
    environment[0] = parent;
    memcpy(environment + 1, environ, variables * sizeof *environment);
    parent_of_all = p;
    lar_status status = LAR_OK;
    for (int32_t k = 1; k < p->count && !status; k++) status = start_one(p, k, environment, error);
    free(environment);
    return status;
}

static lar_status check_count(const lar_processes *p, int32_t count, lar_error *error) {
    if (p->job.count > 1 && p->job.count != count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%d processes were started for a grid of %d processors; start as many as "
                        "the grid has, or change --grid",
                        (int)p->job.count, (int)count);
    if (count > 1 && p->start == LAR_COMM_BY_LAUNCHER && p->job.count == 1)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "communication by %s needs a launcher: mpirun -n %d lariat ..., or srun; "
                        "without one there are threads, shm, tcp and, where it is built in, ucx",
                        p->setting.comm, (int)count);
    if (p->self >= count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "processor %d of a grid of %d; they count from 0", (int)p->self,
                        (int)count);
    return LAR_OK;
}

lar_status lar_processes_start(lar_processes *p, int32_t count, lar_error *error) {
    lar_status status = p->several ? check_count(p, count, error) : LAR_OK;
    bool starts = p->several && p->start == LAR_COMM_BY_ADDRESS && p->job.count == 1 &&
                  !by_hand(p) && count > 1;
    if (status || !starts) return status;
    if (count > STARTED_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%d processes on one machine; at most %d are started here: leave --comm "
                        "out, or start them by hand or by mpirun on several machines",
                        (int)count, STARTED_MAX);
    p->pid = lar_calloc((size_t)count, sizeof *p->pid);
    if (!p->pid) return lar_fail_memory(error, (size_t)count * sizeof *p->pid, "processes");
    p->count = count;
    status = lar_comm_listen("127.0.0.1:0", &p->listener, p->address, error);
    return status ? status : start_all(p, error);
}

/* In a handler: whom this process has started ends before it. Where all have met nothing is left of
 * who is killed. */
static void end_started(lar_processes *p) {
    double until = created ? 0 : lar_clock_seconds() + LAST_GRACE;
    for (int32_t k = 1; k < p->count && !created; k++)
        if (p->pid[k] > 0) kill(p->pid[k], OVER);
    for (int32_t k = 1; k < p->count; k++) {
        while (p->pid[k] > 0 && waitpid(p->pid[k], NULL, WNOHANG) == 0) {
            if (lar_clock_seconds() > until) kill(p->pid[k], SIGKILL);
            nap();
        }
        p->pid[k] = 0;
    }
}

/* ---- rendezvous ----------------------------------------------------------------------------- */

lar_status lar_processes_meet_in_job(lar_comm_job *job, lar_options *options, lar_error *error) {
    lar_comm_options comm = lar_comm_options_default();
    lar_status status = lar_comm_job_meet(job, &comm, error);
    if (status) return status;
    options->processor = comm.self;
    options->master = comm.master;
    options->listener = comm.listener;
    return LAR_OK;
}

static lar_status meet(lar_processes *p, lar_options *options, lar_error *error) {
    options->listener = -1;
    if (!p->several) return LAR_OK;
    if (p->job.count > 1) return lar_processes_meet_in_job(&p->job, options, error);
    options->processor = p->self;
    options->master = by_hand(p) ? p->setting.master : p->address;
    if (p->listener < 0) return LAR_OK;
    /* The others of a second rendezvous may come before the first one is over: they queue here. */
    options->listener = fcntl(p->listener, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (options->listener >= 0) return LAR_OK;
    return lar_fail(error, LAR_ERROR_IO, "no second number for a socket: %s; see ulimit -n",
                    strerror(errno));
}

/* Only what calling off has caused has a better reason: a refusal ends processes as well. */
static lar_status name_missing(lar_processes *p, lar_arrival *arrival, lar_status status,
                               lar_error *error) {
    lar_error why;
    int32_t missing = lar_arrival_end(arrival, &why);
    if (!missing || !status || strcmp(error->message, lar_comm_called_off) != 0) return status;
    p->named = missing;
    *error = why;
    return why.status;
}

lar_status lar_processes_create(lar_processes *p, const lar_model *model,
                                const lar_options *options, lar_simulation **simulation,
                                lar_error *error) {
    lar_options mine = *options;
    lar_status status = p ? meet(p, &mine, error) : LAR_OK;
    if (status) return status;
    lar_arrival arrival = {.listener = -1};
    if (p && p->pid) {
        arrival = (lar_arrival){.pid = p->pid, .count = p->count, .listener = p->listener};
        lar_arrival_begin(&arrival);
    }
    status = lar_simulation_create(model, &mine, simulation, error);
    created = true;
    /* Asked when all had just come: the others are ended before they find this one gone. */
    if (!status && p && p->several && lar_comm_check_interrupt(error)) {
        if (p->pid) end_started(p);
        lar_simulation_destroy(*simulation);
        *simulation = NULL;
        status = LAR_ERROR_PEER;
    }
    return name_missing(p, &arrival, status, error);
}

bool lar_processes_interrupt(void) {
    if (lar_comm_interrupt()) return true;
    if (parent_of_all) end_started(parent_of_all);
    return false;
}

bool lar_processes_interrupted(const lar_error *error) {
    return strcmp(error->message, lar_comm_interrupted) == 0;
}

void lar_processes_hesitate(const lar_processes *p) {
    for (double until = lar_clock_seconds() + HESITATION;
         p->has_parent && lar_clock_seconds() < until;)
        nap();
}

/* ---- the end ------------------------------------------------------------------------------- */

static void describe_end(int32_t k, int status, lar_error *error) {
    if (WIFSIGNALED(status))
        lar_fail(error, LAR_ERROR_PEER, "processor %d was ended by signal %d (%s)", (int)k,
                 WTERMSIG(status), strsignal(WTERMSIG(status)));
    else
        lar_fail(error, LAR_ERROR_PEER,
                 "processor %d ended with status %d; see what it says itself", (int)k,
                 WEXITSTATUS(status));
}

/* Who is stopped will not end by itself. */
static void end_stopped(const lar_processes *p, int32_t k, int status, lar_error *worst) {
    if (!worst->status && k != p->named)
        lar_fail(worst, LAR_ERROR_PEER,
                 "processor %d was stopped by signal %d (%s) and is now ended", (int)k,
                 WSTOPSIG(status), strsignal(WSTOPSIG(status)));
    kill(p->pid[k], SIGKILL);
}

/* Returns how many are still there. *worst becomes the first bad end, if there is none yet; a
 * failure that spreads (`failure`) has been told by everyone who could. */
static int32_t reap(lar_processes *p, lar_status failure, lar_error *worst) {
    int32_t left = 0;
    for (int32_t k = 1; k < p->count; k++) {
        int status;
        if (p->pid[k] == 0) continue;
        pid_t found = waitpid(p->pid[k], &status, WNOHANG | WUNTRACED);
        if (found == p->pid[k] && WIFSTOPPED(status)) {
            if (failure) end_stopped(p, k, status, worst);
        } else if (found != 0) {
            bool ended = WIFEXITED(status) || (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM);
            bool told = k == p->named || (failure && found > 0 && ended);
            p->pid[k] = 0;
            if (found > 0 && status != 0 && !told && !worst->status) describe_end(k, status, worst);
            continue;
        }
        left++;
    }
    return left;
}

static void end_all(const lar_processes *p, lar_status failure, lar_error *worst) {
    for (int32_t k = 1; k < p->count; k++) {
        if (p->pid[k] == 0) continue;
        kill(p->pid[k], SIGKILL);
        if (!failure && !worst->status)
            lar_fail(worst, LAR_ERROR_PEER, "processor %d did not end when told to and was killed",
                     (int)k);
    }
}

static void reap_all(lar_processes *p, lar_status failure, lar_error *worst) {
    double patience = failure && failure != LAR_ERROR_PEER ? SHORT_GRACE : GRACE;
    double until = lar_clock_seconds() + patience;
    lar_error ignored = {.status = LAR_OK};
    bool killed = false;
    /* Who still waits for others leaves nothing behind. */
    for (int32_t k = 1; failure && k < p->count; k++)
        if (p->pid[k] > 0) kill(p->pid[k], OVER);
    while (reap(p, failure, killed ? &ignored : worst) > 0) {
        if (!killed && lar_clock_seconds() > until) {
            end_all(p, failure, worst);
            killed = true;
        }
        nap();
    }
}

lar_status lar_processes_end(lar_processes *p, lar_status failure, lar_error *error) {
    if (!p) return LAR_OK;
    lar_error worst = {.status = LAR_OK};
    if (p->listener >= 0) close(p->listener);
    if (p->pid) reap_all(p, failure, &worst);
    lar_status status = LAR_OK;
    if (p->job.count > 1) status = lar_comm_job_end(&p->job, failure != LAR_OK, error);
    if (!status && worst.status) {
        status = worst.status;
        if (error) *error = worst;
    }
    parent_of_all = NULL;
    free(p->pid);
    free(p);
    return status;
}
