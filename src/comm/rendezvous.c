#include "comm/rendezvous.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

#include "base/socket.h"

/* Changes with every change of what travels. Its bytes in another order are another number. */
static const uint64_t MAGIC = 0x4c61726961740002u;

typedef struct hello {
    uint64_t magic, identity;
    double time_step;
    int32_t self, count;
    char version[16], backend[16];
    lar_comm_address address;
} hello;

/* Welcome, ready, go; or a refusal. */
typedef struct note {
    uint64_t magic, token;
    uint32_t refused;
    lar_error why;
} note;

static note refusal(const lar_error *why) {
    note n = {.magic = MAGIC, .refused = 1, .why = *why};
    return n;
}

static lar_status lost(int32_t p, lar_error *error) {
    return lar_fail(error, LAR_ERROR_PEER,
                    "processor %d was lost during start-up; see what it says itself and start all "
                    "processors again",
                    (int)p);
}

/* How long a wait lasts before it looks whether all are still there [s]. */
static const double LOOK = 0.05;
static const double LATE = 1;      /* for guests after a refusal [s] */
static const double LEAVING = 0.5; /* for those who have met, after one [s] */

lar_status lar_rendezvous_check(const lar_comm *comm, lar_error *error) {
    if (lar_comm_check_interrupt(error)) return LAR_ERROR_PEER;
    for (int32_t p = 0; p < comm->options.count; p++)
        if (comm->links[p] >= 0 && lar_socket_ended(comm->links[p])) return lost(p, error);
    struct pollfd zero = {.fd = comm->links[0], .events = POLLIN};
    if (zero.fd >= 0 && poll(&zero, 1, 0) == 1)
        return lar_fail(error, LAR_ERROR_PEER, "processor 0 has called off the start");
    return LAR_OK;
}

static double next_look(double deadline) {
    double look = lar_comm_now() + LOOK;
    return look < deadline ? look : deadline;
}

const char lar_comm_called_off[] = "the start was called off: a processor has ended before it came";

/* Nobody can come any more. */
static lar_status deaf(const lar_comm *comm, int reason, lar_error *error) {
    if (reason == -EINVAL) return lar_fail(error, LAR_ERROR_PEER, "%s", lar_comm_called_off);
    if (reason == -EBADF || reason == -ENOTSOCK)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "the listener %d that processor 0 was given is no socket that listens; "
                        "give one that does, or -1",
                        comm->options.listener);
    return lar_fail(error, LAR_ERROR_IO,
                    "processor %d cannot accept connections: %s; raise the limit on open files "
                    "(ulimit -n)",
                    (int)comm->options.self, strerror(-reason));
}

lar_status lar_rendezvous_accept(const lar_comm *comm, int listener, double deadline, int *guest,
                                 lar_error *error) {
    *guest = -1;
    for (;;) {
        *guest = lar_socket_accept(listener, next_look(deadline));
        if (*guest < LAR_SOCKET_NOBODY) return deaf(comm, *guest, error);
        if (*guest >= 0 || lar_comm_now() > deadline) return LAR_OK;
        lar_status status = lar_rendezvous_check(comm, error);
        if (status) return status;
    }
}

static double start_deadline(const lar_comm *comm) {
    return lar_comm_now() + comm->options.start_timeout;
}

/* ---- processor zero ----------------------------------------------------------------------- */

static lar_status judge(const lar_comm *comm, const hello *h, const hello *own, lar_error *error) {
    int p = (int)h->self;
    if (h->magic != MAGIC)
        return lar_fail(error, LAR_ERROR_PEER,
                        "a processor runs another version of Lariat than processor 0 (%.15s); "
                        "install the same on all machines",
                        own->version);
    if (memcmp(h->version, own->version, sizeof h->version) != 0)
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor %d runs another version of Lariat (%.15s) than processor 0 "
                        "(%.15s); install the same on all machines",
                        p, h->version, own->version);
    if (memcmp(h->backend, own->backend, sizeof h->backend) != 0)
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor %d communicates by %.15s, processor 0 by %.15s; give all the "
                        "same backend",
                        p, h->backend, own->backend);
    if (h->count != own->count || p < 1 || p >= own->count)
        return lar_fail(error, LAR_ERROR_PEER,
                        "a processor says that it is number %d of %d, processor 0 expects 1 to %d "
                        "of %d; give all the same number of processors",
                        p, (int)h->count, (int)own->count - 1, (int)own->count);
    if (h->time_step != own->time_step)
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor %d has a time step of %.9g s, processor 0 one of %.9g s; give "
                        "all the same --time-step and the same files",
                        p, h->time_step, own->time_step);
    if (h->identity != own->identity)
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor %d has another model or schedule than processor 0; give all "
                        "the same files",
                        p);
    if (comm->links[p] >= 0)
        return lar_fail(error, LAR_ERROR_PEER,
                        "two processors say that they are number %d; give each its own", p);
    return LAR_OK;
}

static lar_status not_all_came(const lar_comm *comm, lar_error *error) {
    char list[200] = "";
    size_t used = 0;
    for (int32_t p = 1; p < comm->options.count; p++) {
        if (comm->links[p] >= 0) continue;
        if (used > sizeof list - 20) {
            snprintf(list + used, sizeof list - used, " ...");
            break;
        }
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%d", used ? ", " : "", (int)p);
    }
    return lar_fail(error, LAR_ERROR_PEER,
                    "processor %s did not come to processor 0 within %g s; start it with the same "
                    "address of processor 0 and see what it says itself",
                    list, comm->options.start_timeout);
}

/* *missing: how many may still come. */
static lar_status receive_guests(lar_comm *comm, const hello *own, double deadline,
                                 int32_t *missing, lar_error *error) {
    for (*missing = comm->options.count - 1; *missing > 0;) {
        int guest;
        lar_status status =
            lar_rendezvous_accept(comm, comm->options.listener, deadline, &guest, error);
        if (status) return status;
        if (guest < 0) return not_all_came(comm, error);
        hello h = {.magic = 0};
        double patience = lar_comm_now() + 1;
        bool ours = lar_socket_receive(guest, &h, sizeof h.magic, patience) == LAR_SOCKET_DONE &&
                    (h.magic ^ MAGIC) >> 16 == 0 &&
                    (h.magic != MAGIC || /* another version's hello may be shorter */
                     lar_socket_receive(guest, (char *)&h + sizeof h.magic,
                                        sizeof h - sizeof h.magic, patience) == LAR_SOCKET_DONE);
        if (!ours) {
            close(guest);
            continue;
        }
        --*missing;
        status = judge(comm, &h, own, error);
        if (status) {
            if (error) {
                note n = refusal(error);
                lar_socket_send(guest, &n, sizeof n, lar_comm_now() + 1);
            }
            close(guest);
            return status;
        }
        comm->links[h.self] = guest;
        comm->addresses[h.self] = h.address;
        lar_socket_peer_host(guest, comm->addresses[h.self].host);
    }
    return LAR_OK;
}

static void refuse_all(lar_comm *comm, const lar_error *why) {
    note n = refusal(why);
    for (int32_t p = 1; p < comm->options.count; p++)
        if (comm->links[p] >= 0)
            lar_socket_send(comm->links[p], &n, sizeof n, lar_comm_now() + 0.2);
}

/* UCX 1.13 ends a process (wireup_ep.c) that connects to one that is gone: none is, as long as the
 * others have not heard that it is over. */
static void see_all_out(lar_comm *comm) {
    double until = lar_comm_now() + LEAVING;
    note n;
    for (int32_t p = 1; p < comm->options.count; p++)
        while (comm->links[p] >= 0 &&
               lar_socket_receive(comm->links[p], &n, sizeof n, until) == LAR_SOCKET_DONE) {
        }
}

/* Who comes a moment later would call in vain until its own limit. */
static void refuse_late_guests(lar_comm *comm, int32_t missing, const lar_error *why) {
    note n = refusal(why);
    double deadline = lar_comm_now() + LATE;
    while (missing-- > 0) {
        int guest = lar_socket_accept(comm->options.listener, deadline);
        if (guest < 0) return;
        hello h; /* unread, it would take the refusal with it */
        lar_socket_receive(guest, &h, sizeof h, deadline);
        lar_socket_send(guest, &n, sizeof n, deadline);
        close(guest);
    }
}

/* Tells everyone; the first that cannot be told is the failure. */
static lar_status tell_all(lar_comm *comm, bool addresses, double deadline, lar_error *error) {
    note n = {.magic = MAGIC, .token = comm->token};
    size_t bytes = (size_t)comm->options.count * sizeof *comm->addresses;
    int32_t deaf = 0;
    for (int32_t p = 1; p < comm->options.count; p++) {
        if ((lar_socket_send(comm->links[p], &n, sizeof n, deadline) ||
             (addresses && lar_socket_send(comm->links[p], comm->addresses, bytes, deadline))) &&
            deaf == 0)
            deaf = p;
    }
    return deaf ? lost(deaf, error) : LAR_OK;
}

static lar_status host_rendezvous(lar_comm *comm, const hello *own, lar_error *error) {
    double deadline = start_deadline(comm);
    lar_error why = {.status = LAR_OK};
    if (getrandom(&comm->token, sizeof comm->token, 0) != sizeof comm->token)
        return lar_fail(error, LAR_ERROR_IO, "the system gives no random numbers; check getrandom");
    lar_status status = LAR_OK;
    int32_t missing = 0;
    if (comm->options.listener < 0) {
        /* Nobody would know which port is the free one. */
        status = lar_socket_check(comm->options.master, 1, &why);
        if (!status)
            status = lar_socket_listen(comm->options.master, &comm->options.listener, &why);
    }
    if (!status) status = receive_guests(comm, own, deadline, &missing, &why);
    if (!status) status = tell_all(comm, true, deadline, &why);
    if (status) {
        refuse_all(comm, &why);
        if (lar_comm_now() < deadline) refuse_late_guests(comm, missing, &why);
        if (error) *error = why;
    }
    if (comm->options.listener >= 0) close(comm->options.listener);
    comm->options.listener = -1;
    return status;
}

/* ---- the others --------------------------------------------------------------------------- */

static lar_status hear_zero(lar_comm *comm, note *n, double deadline, lar_error *error) {
    struct pollfd link = {.fd = comm->links[0], .events = POLLIN};
    while (poll(&link, 1, 0) != 1 && lar_comm_now() < deadline) {
        if (lar_comm_check_interrupt(error)) return LAR_ERROR_PEER;
        lar_socket_poll(link.fd, POLLIN, next_look(deadline));
    }
    lar_socket_end end = lar_socket_receive(comm->links[0], n, sizeof *n, deadline);
    if (end == LAR_SOCKET_LATE)
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor 0 gave no answer within %g s; see what it says itself",
                        comm->options.start_timeout);
    if (end || n->magic != MAGIC) return lost(0, error);
    n->why.message[sizeof n->why.message - 1] = '\0';
    if (n->refused) return lar_fail(error, LAR_ERROR_PEER, "%s", n->why.message);
    return LAR_OK;
}

static lar_status join_rendezvous(lar_comm *comm, const hello *own, lar_error *error) {
    /* Zero's own limit passes first, so that its sentence arrives. */
    double deadline = start_deadline(comm) + 1;
    lar_status status =
        lar_rendezvous_call(0, comm->options.master, deadline, &comm->links[0], error);
    if (status) return status;
    if (lar_socket_send(comm->links[0], own, sizeof *own, deadline)) return lost(0, error);
    note n;
    status = hear_zero(comm, &n, deadline, error);
    if (status) return status;
    comm->token = n.token;
    size_t bytes = (size_t)comm->options.count * sizeof *comm->addresses;
    if (lar_socket_receive(comm->links[0], comm->addresses, bytes, deadline)) return lost(0, error);
    lar_socket_peer_host(comm->links[0], comm->addresses[0].host);
    return LAR_OK;
}

/* ---- both ---------------------------------------------------------------------------------- */

lar_status lar_rendezvous_call(int32_t p, const char *address, double deadline, int *socket,
                               lar_error *error) {
    lar_error why;
    lar_status status = LAR_ERROR_PEER;
    /* Again and again, ever longer: an answer may be far away. */
    for (double wait = LOOK; status == LAR_ERROR_PEER; wait = wait < 0.5 ? 2 * wait : 1) {
        if (lar_comm_check_interrupt(error)) return LAR_ERROR_PEER;
        double until = lar_comm_now() + wait;
        status = lar_socket_connect(address, until < deadline ? until : deadline, socket, &why);
        if (lar_comm_now() > deadline) break;
    }
    if (!status) return LAR_OK;
    return lar_fail(error, status, "processor %d is not reached: %s", (int)p, why.message);
}

lar_status lar_rendezvous_gather(lar_comm *comm, lar_error *error) {
    if (comm->options.count == 1) return LAR_OK;
    hello own = {.magic = MAGIC,
                 .identity = comm->options.identity,
                 .time_step = comm->options.time_step,
                 .self = comm->options.self,
                 .count = comm->options.count,
                 .address = comm->addresses[comm->options.self]};
    snprintf(own.version, sizeof own.version, "%s", lar_version());
    snprintf(own.backend, sizeof own.backend, "%s", comm->backend->name);
    return own.self == 0 ? host_rendezvous(comm, &own, error) : join_rendezvous(comm, &own, error);
}

/* Until there is something to read from p, or the deadline; fails when somebody has gone. */
static lar_status wait_to_read(const lar_comm *comm, int32_t p, double deadline, lar_error *error) {
    struct pollfd link = {.fd = comm->links[p], .events = POLLIN};
    for (;;) {
        lar_socket_poll(link.fd, POLLIN, next_look(deadline));
        if (poll(&link, 1, 0) == 1 || lar_comm_now() > deadline) return LAR_OK;
        lar_status status = lar_rendezvous_check(comm, error);
        if (status) return status;
    }
}

static lar_status gather_ready(lar_comm *comm, const lar_error *own, lar_error *error) {
    double deadline = start_deadline(comm);
    lar_error why = {.status = LAR_OK};
    if (own) why = *own;
    for (int32_t p = 1; p < comm->options.count && !why.status; p++) {
        note n;
        if (wait_to_read(comm, p, deadline, &why)) break;
        if (lar_socket_receive(comm->links[p], &n, sizeof n, deadline) || n.magic != MAGIC) {
            lost(p, &why);
        } else if (n.refused) {
            n.why.message[sizeof n.why.message - 1] = '\0';
            lar_fail(&why, LAR_ERROR_PEER, "%s", n.why.message);
        }
    }
    /* Who cannot be told has died since; some have begun already, and the heartbeat will find it.
     */
    if (!why.status) tell_all(comm, false, deadline, NULL);
    if (why.status) {
        refuse_all(comm, &why);
        see_all_out(comm);
        if (error) *error = why;
    }
    return why.status;
}

lar_status lar_rendezvous_ready(lar_comm *comm, const lar_error *own, lar_error *error) {
    if (comm->options.count == 1 || comm->options.self == 0) return gather_ready(comm, own, error);
    note n = {.magic = MAGIC};
    if (own) n = refusal(own);
    double deadline = start_deadline(comm) + 1;
    /* A zero that is gone may have left a refusal. */
    lar_socket_send(comm->links[0], &n, sizeof n, deadline);
    return hear_zero(comm, &n, deadline, error);
}

lar_status lar_comm_listen(const char *address, int *listener, char bound[LAR_COMM_ADDRESS_TEXT],
                           lar_error *error) {
    lar_status status = lar_socket_listen(address, listener, error);
    if (status) return status;
    const char *colon = strrchr(address, ':');
    int length = (int)(colon - address);
    snprintf(bound, LAR_COMM_ADDRESS_TEXT, "%.*s:%d", length < 70 ? length : 70, address,
             lar_socket_port(*listener));
    return LAR_OK;
}
