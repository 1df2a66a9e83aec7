#include "study/arrival.h"

#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>

#include "base/error.h"
#include "base/thread.h"

/* Looks every 2 ms; who is stopped for a second, other than by a terminal that stops all, will not
 * come. */
enum { LOOK = 2000000 /* [ns] */, STOPPED_LOOKS = 500 };

/* The first process that has ended or is stopped; 0: none. It stays for others to wait for. */
static int32_t look(const lar_arrival *a, siginfo_t *how) {
    for (int32_t k = 1; k < a->count; k++) {
        memset(how, 0, sizeof *how);
        if (a->pid[k] > 0 &&
            waitid(P_PID, (id_t)a->pid[k], how, WEXITED | WSTOPPED | WNOHANG | WNOWAIT) == 0 &&
            how->si_pid == a->pid[k])
            return k;
    }
    return 0;
}

static void *arrival_thread(void *context) {
    lar_arrival *a = context;
    int stopped = 0;
    while (!__atomic_load_n(&a->over, __ATOMIC_ACQUIRE)) {
        siginfo_t how;
        int32_t k = look(a, &how);
        stopped = k && how.si_code == CLD_STOPPED ? stopped + 1 : 0;
        if (k && (how.si_code != CLD_STOPPED || stopped > STOPPED_LOOKS)) {
            a->missing = k;
            a->how = how;
            shutdown(a->listener, SHUT_RDWR);
            return NULL;
        }
        nanosleep(&(struct timespec){.tv_nsec = LOOK}, NULL);
    }
    return NULL;
}

void lar_arrival_begin(lar_arrival *a) {
    a->runs = lar_thread_start(&a->thread, arrival_thread, a) == 0;
}

static void describe(const lar_arrival *a, lar_error *error) {
    int k = (int)a->missing, what = a->how.si_status;
    if (a->how.si_code == CLD_EXITED)
        lar_fail(error, LAR_ERROR_PEER,
                 "processor %d ended with status %d before it came to processor 0; see what it "
                 "says itself",
                 k, what);
    else
        lar_fail(error, LAR_ERROR_PEER,
                 "processor %d was %s by signal %d (%s) before it came to "
                 "processor 0; start again",
                 k, a->how.si_code == CLD_STOPPED ? "stopped" : "ended", what, strsignal(what));
}

int32_t lar_arrival_end(lar_arrival *a, lar_error *error) {
    if (!a->runs) return 0;
    __atomic_store_n(&a->over, 1, __ATOMIC_RELEASE);
    lar_thread_join(&a->thread);
    a->runs = false;
    if (a->missing) describe(a, error);
    return a->missing;
}
