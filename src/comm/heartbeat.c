#include "comm/heartbeat.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/pin.h"
#include "base/socket.h"
#include "base/thread.h"

static const double HEARTBEAT = 0.1; /* between signs of life [s] */
/* Silence that says that someone is lost, as a share of the timeout: the rest is for telling the
 * others. As long as can be, because on a busy machine threads may get no turn for a second. */
static const double SILENCE = 0.75;
/* After the first connection has ended, zero waits so long for others: when all have ended it is
 * zero that is cut off [s]. */
static const double SETTLE = 0.02;
/* How long zero collects reports [s]. */
static const double REPORT_TIME = 0.05;
static const double VERDICT_TIME = 0.2; /* how long a report waits for its verdict [s] */

typedef enum frame_kind { FRAME_HEARTBEAT = 1, FRAME_LOST, FRAME_REPORT, FRAME_BYE } frame_kind;
typedef struct frame {
    uint32_t kind;
    uint32_t spare;
    uint64_t verdict;
    uint64_t step; /* of a report: the one that cannot be completed */
} frame;

typedef struct link_state {
    double heard;
    bool left;     /* said goodbye */
    size_t filled; /* bytes of `partial` */
    frame partial;
} link_state;

typedef struct lar_comm_heartbeat {
    lar_comm *comm;
    lar_thread thread;
    bool runs;
    int wake[2];            /* a pipe */
    int32_t ended;          /* the first whose connection ended without a goodbye, -1: none */
    double settled;         /* when that may be believed */
    uint64_t reported;      /* atomic: a verdict that this processor proposes */
    uint64_t reported_step; /* set before it */
    frame report;           /* zero: the best so far; kind 0: none */
    double judged;          /* zero: when it is believed */
    double looked;          /* at the clock, the last time */
    int leaving;            /* atomic */
    bool told;              /* the verdict is sent on */
    bool said_bye;
    link_state *links;     /* [count] */
    struct pollfd *polled; /* [count + 1] */
} lar_comm_heartbeat;

static bool is_open(const lar_comm_heartbeat *w, int32_t p) {
    return w->comm->links[p] >= 0;
}

static void shut(lar_comm_heartbeat *w, int32_t p) {
    close(w->comm->links[p]);
    w->comm->links[p] = -1;
}

static void decide(lar_comm_heartbeat *w, uint64_t verdict) {
    uint64_t nobody = 0;
    __atomic_compare_exchange_n(w->comm->verdict, &nobody, verdict, false, __ATOMIC_ACQ_REL,
                                __ATOMIC_ACQUIRE);
}

/* Frames are tiny: a socket that does not take one is as good as dead, and its silence tells. */
static void send_frame(lar_comm_heartbeat *w, int32_t p, uint32_t kind, uint64_t verdict) {
    frame f = {.kind = kind,
               .verdict = verdict,
               .step = __atomic_load_n(&w->reported_step, __ATOMIC_RELAXED)};
    if (is_open(w, p)) lar_socket_send(w->comm->links[p], &f, sizeof f, 0);
}

static void send_all(lar_comm_heartbeat *w, uint32_t kind, uint64_t verdict) {
    for (int32_t p = 0; p < w->comm->options.count; p++) send_frame(w, p, kind, verdict);
}

static int32_t accused(const frame *f) {
    return (int32_t)(f->verdict & 0xffffffffu) - 1;
}

/* Zero: keeps the report from the earliest step. Of one step, the report of an accused processor
 * goes before the one that accuses it. What a processor says of itself is final. */
static void weigh(lar_comm_heartbeat *w, int32_t reporter, const frame *f) {
    if (f->verdict >> 32 != LAR_LOSS_STALLED) decide(w, f->verdict);
    bool first = w->report.kind == 0;
    if (first) w->judged = lar_comm_now() + REPORT_TIME;
    if (!first && f->step > w->report.step) return;
    if (!first && f->step == w->report.step && accused(&w->report) != reporter) return;
    w->report = *f;
}

static void take_frame(lar_comm_heartbeat *w, int32_t p, const frame *f) {
    switch (f->kind) {
    case FRAME_LOST: /* from zero */
        if (f->verdict) decide(w, f->verdict);
        break;
    case FRAME_REPORT:
        if (f->verdict) weigh(w, p, f);
        break;
    case FRAME_BYE:
        w->links[p].left = true;
        /* Zero lets go; the other side waits for that. */
        if (w->comm->options.self == 0) shut(w, p);
        break;
    default:
        break;
    }
}

static void read_link(lar_comm_heartbeat *w, int32_t p, double now) {
    link_state *link = &w->links[p];
    while (is_open(w, p)) {
        ssize_t got = recv(w->comm->links[p], (char *)&link->partial + link->filled,
                           sizeof(frame) - link->filled, 0);
        if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return;
        if (got <= 0) {
            shut(w, p);
            if (!link->left && w->ended < 0) {
                w->ended = p;
                w->settled = w->comm->options.self == 0 ? now + SETTLE : now;
            }
            return;
        }
        link->heard = now;
        link->filled += (size_t)got;
        if (link->filled == sizeof(frame)) {
            link->filled = 0;
            take_frame(w, p, &link->partial);
        }
    }
}

/* Sleeps until something arrives or the next heartbeat is due, and reads it. */
static void listen_to_all(lar_comm_heartbeat *w, double next_heartbeat) {
    nfds_t n = 0;
    w->polled[n++] = (struct pollfd){.fd = w->wake[0], .events = POLLIN};
    for (int32_t p = 0; p < w->comm->options.count; p++)
        if (is_open(w, p))
            w->polled[n++] = (struct pollfd){.fd = w->comm->links[p], .events = POLLIN};
    double left = next_heartbeat - lar_comm_now();
    poll(w->polled, n, left > 0 ? (int)(1e3 * left) + 1 : 0);
    char bytes[64];
    if (w->polled[0].revents && read(w->wake[0], bytes, sizeof bytes) < 0) return;
    double now = lar_comm_now();
    for (int32_t p = 0; p < w->comm->options.count; p++) read_link(w, p, now);
}

static bool all_gone(const lar_comm_heartbeat *w) {
    for (int32_t p = 0; p < w->comm->options.count; p++)
        if (is_open(w, p)) return false;
    return true;
}

/* Held up for longer than a few heartbeats, or suspended: what the others said may still lie
 * unread, and they may have been suspended, too. */
static double look_at_clock(lar_comm_heartbeat *w) {
    double now = lar_comm_now();
    if (now - w->looked > 3 * HEARTBEAT)
        for (int32_t p = 0; p < w->comm->options.count; p++) w->links[p].heard = now;
    w->looked = now;
    return now;
}

static void look_for_losses(lar_comm_heartbeat *w, double now) {
    if (w->ended >= 0 && now >= w->settled) {
        bool cut_off = w->comm->options.self == 0 && w->comm->options.count > 2 && all_gone(w);
        decide(w, lar_comm_verdict(cut_off ? 0 : w->ended, LAR_LOSS_ENDED));
        w->ended = -1;
    }
    if (w->report.kind && now >= w->judged) {
        decide(w, w->report.verdict);
        w->report.kind = 0;
    }
    for (int32_t p = 0; p < w->comm->options.count; p++)
        if (is_open(w, p) && !w->links[p].left &&
            now - w->links[p].heard > SILENCE * w->comm->options.timeout)
            decide(w, lar_comm_verdict(p, LAR_LOSS_SILENT));
}

static void pass_on(lar_comm_heartbeat *w) {
    bool zero = w->comm->options.self == 0;
    uint64_t reported = __atomic_exchange_n(&w->reported, 0, __ATOMIC_ACQ_REL);
    frame own = {.kind = FRAME_REPORT,
                 .verdict = reported,
                 .step = __atomic_load_n(&w->reported_step, __ATOMIC_RELAXED)};
    if (reported && zero)
        weigh(w, 0, &own);
    else if (reported && !is_open(w, 0))
        decide(w, reported);
    else if (reported)
        send_frame(w, 0, FRAME_REPORT, reported);
    uint64_t verdict = __atomic_load_n(w->comm->verdict, __ATOMIC_ACQUIRE);
    if (!verdict || w->told) return;
    w->told = true;
    send_all(w, zero ? FRAME_LOST : FRAME_REPORT, verdict);
}

static void *run_heartbeat(void *context) {
    lar_comm_heartbeat *w = context;
    lar_pin_nowhere(); /* not where the one that it speaks for computes without a pause */
    double next_heartbeat = lar_comm_now(), give_up = 0;
    w->looked = next_heartbeat;
    for (;;) {
        double now = look_at_clock(w);
        if (now >= next_heartbeat) {
            send_all(w, FRAME_HEARTBEAT, 0);
            next_heartbeat = now + HEARTBEAT;
        }
        double until = next_heartbeat;
        if (w->ended >= 0 && w->settled < until) until = w->settled;
        if (w->report.kind && w->judged < until) until = w->judged;
        listen_to_all(w, until);
        look_for_losses(w, look_at_clock(w));
        pass_on(w);
        if (!__atomic_load_n(&w->leaving, __ATOMIC_ACQUIRE)) continue;
        if (!w->said_bye) {
            w->said_bye = true;
            give_up = lar_comm_now() + w->comm->options.timeout;
            send_all(w, FRAME_BYE, 0);
        }
        /* After a verdict nobody waits for a proper end. */
        if (w->told || all_gone(w) || lar_comm_now() > give_up) return NULL;
    }
}

lar_status lar_heartbeat_start(lar_comm *comm, lar_error *error) {
    if (comm->options.count == 1) return LAR_OK;
    size_t count = (size_t)comm->options.count;
    lar_comm_heartbeat *w = comm->heartbeat = lar_calloc(1, sizeof *w);
    if (!w) return lar_fail_memory(error, sizeof *w, "the heartbeat");
    w->comm = comm;
    w->wake[0] = w->wake[1] = -1;
    w->ended = -1;
    w->links = lar_calloc(count, sizeof *w->links);
    w->polled = lar_calloc(count + 1, sizeof *w->polled);
    if (!w->links || !w->polled) return lar_fail_memory(error, count * 48, "watched processors");
    double now = lar_comm_now();
    for (size_t p = 0; p < count; p++) w->links[p].heard = now;
    if (pipe2(w->wake, O_CLOEXEC | O_NONBLOCK) != 0)
        return lar_fail(error, LAR_ERROR_IO,
                        "no pipe to watch the other processors with: %s; close files, or raise the "
                        "limit (ulimit -n)",
                        strerror(errno));
    int cause = lar_thread_start(&w->thread, run_heartbeat, w);
    if (cause) return lar_fail_thread(error, cause, "watching the other processors");
    w->runs = true;
    return LAR_OK;
}

static void wake_up(lar_comm_heartbeat *w) {
    /* A full pipe wakes as well. */
    if (write(w->wake[1], "", 1) < 0) return;
}

void lar_heartbeat_report(lar_comm *comm, int32_t processor, lar_comm_loss loss, uint64_t step) {
    lar_comm_heartbeat *w = comm->heartbeat;
    __atomic_store_n(&w->reported_step, step, __ATOMIC_RELAXED);
    __atomic_store_n(&w->reported, lar_comm_verdict(processor, loss), __ATOMIC_RELEASE);
    wake_up(w);
    double deadline = lar_comm_now() + VERDICT_TIME;
    while (!__atomic_load_n(comm->verdict, __ATOMIC_ACQUIRE) && lar_comm_now() < deadline)
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
}

void lar_heartbeat_stop(lar_comm *comm) {
    lar_comm_heartbeat *w = comm->heartbeat;
    if (!w) return;
    if (w->runs && lar_thread_is_here(&w->thread)) {
        __atomic_store_n(&w->leaving, 1, __ATOMIC_RELEASE);
        wake_up(w);
        lar_thread_join(&w->thread);
    }
    for (int i = 0; i < 2; i++)
        if (w->wake[i] >= 0) close(w->wake[i]);
    free(w->links);
    free(w->polled);
    free(w);
    comm->heartbeat = NULL;
}
