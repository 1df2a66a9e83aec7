/* Processors that are threads of one process: the peer's memory is one's own. */
#include <sched.h>
#include <stdlib.h>

#include "base/memory.h"
#include "comm/backend.h"

struct lar_comm_team {
    int32_t count;
    int32_t arrived;         /* atomic */
    uint64_t verdict;        /* atomic; one word for all */
    unsigned char **receive; /* [count]; stay until the team goes: a peer may still write */
    size_t *half;            /* [count] */
    uint64_t *identity;      /* [count] */
    int32_t *taken;          /* [count], atomic */
    int32_t *waiting;        /* [count], atomic */
};

lar_status lar_comm_team_create(int32_t count, lar_comm_team **out, lar_error *error) {
    if (count < 1 || count > LAR_COMM_PROCESSORS_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%d processors; take 1 to %d", (int)count,
                        LAR_COMM_PROCESSORS_MAX);
    size_t n = (size_t)count;
    lar_comm_team *team = lar_calloc(1, sizeof *team);
    if (team) {
        team->count = count;
        team->receive = lar_calloc(n, sizeof *team->receive);
        team->half = lar_calloc(n, sizeof *team->half);
        team->identity = lar_calloc(n, sizeof *team->identity);
        team->taken = lar_calloc(n, sizeof *team->taken);
        team->waiting = lar_calloc(n, sizeof *team->waiting);
    }
    if (!team || !team->receive || !team->half || !team->identity || !team->taken ||
        !team->waiting) {
        lar_comm_team_destroy(team);
        return lar_fail_memory(error, n * 32, "a team of processors");
    }
    *out = team;
    return LAR_OK;
}

void lar_comm_team_destroy(lar_comm_team *team) {
    if (!team) return;
    for (int32_t p = 0; team->receive && p < team->count; p++) free(team->receive[p]);
    free(team->receive);
    free(team->half);
    free(team->identity);
    free(team->taken);
    free(team->waiting);
    free(team);
}

void lar_comm_team_give_up(lar_comm_team *team, int32_t processor) {
    uint64_t nobody = 0;
    __atomic_compare_exchange_n(&team->verdict, &nobody,
                                lar_comm_verdict(processor, LAR_LOSS_FAILED), false,
                                __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE);
}

static lar_status threads_open(lar_comm *comm, lar_error *error) {
    lar_comm_team *team = comm->options.team;
    int32_t self = comm->options.self;
    if (team->count != comm->options.count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "processor %d wants %d processors, its team has %d; create the team for "
                        "as many as there are",
                        (int)self, (int)comm->options.count, (int)team->count);
    if (__atomic_exchange_n(&team->taken[self], 1, __ATOMIC_ACQ_REL))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there are two processors %d in one team; give each its own number",
                        (int)self);
    size_t bytes = 2 * comm->options.receive_bytes;
    comm->verdict = &team->verdict;
    comm->waiting = team->waiting;
    comm->receive = team->receive[self] = lar_calloc_aligned(bytes ? bytes : 8, 1);
    if (!comm->receive) return lar_fail_memory(error, bytes, "a receive buffer");
    team->half[self] = comm->options.receive_bytes;
    team->identity[self] = comm->options.identity;
    __atomic_fetch_add(&team->arrived, 1, __ATOMIC_ACQ_REL);
    return LAR_OK;
}

static lar_status wait_for_all(lar_comm *comm, lar_error *error) {
    lar_comm_team *team = comm->options.team;
    double deadline = lar_comm_now() + comm->options.start_timeout;
    while (__atomic_load_n(&team->arrived, __ATOMIC_ACQUIRE) < team->count) {
        lar_status status = lar_comm_check(comm, 0, error);
        if (status) return status;
        if (lar_comm_now() > deadline) {
            int32_t absent = 0;
            while (absent < team->count - 1 &&
                   __atomic_load_n(&team->taken[absent], __ATOMIC_ACQUIRE))
                absent++;
            return lar_fail(error, LAR_ERROR_PEER,
                            "processor %d did not start within %g s; look for what it says itself",
                            (int)absent, comm->options.start_timeout);
        }
        sched_yield();
    }
    return LAR_OK;
}

static lar_status threads_connect(lar_comm *comm, lar_error *error) {
    lar_status status = wait_for_all(comm, error);
    if (status) return status;
    lar_comm_team *team = comm->options.team;
    for (int32_t p = 0; p < team->count; p++) {
        if (team->identity[p] != team->identity[0])
            return lar_fail(error, LAR_ERROR_PEER,
                            "processor %d has another model or schedule than processor 0; give "
                            "all the same",
                            (int)p);
        comm->peers[p] = (lar_comm_peer){team->receive[p], team->half[p]};
    }
    return LAR_OK;
}

const lar_comm_backend lar_comm_threads = {.name = "threads",
                                           .summary = "processors are threads of one process",
                                           .start = LAR_COMM_BY_TEAM,
                                           .meets = true,
                                           .polls = 50,
                                           .open = threads_open,
                                           .connect = threads_connect};
