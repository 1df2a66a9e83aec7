/* Inside comm: a backend is a table of at most seven functions. A new one is a file with such a
 * table and a row in comm.c.
 *
 *     lar_comm_open   open()       own receive buffer; what others need to reach it -> own address
 *                     (rendezvous) processor zero gathers and distributes all addresses (T 7.5.7)
 *                     connect()    reach every peer; where its memory can be written: peer.direct
 *                     (rendezvous) everyone is connected
 *                     begin()      names and listeners that nobody needs any more go
 *     lar_comm_put    put()        only to peers without `direct`: payload, then tail
 *     lar_comm_wait   progress()   when the hardware does not write the receive buffer by itself
 *     lar_comm_close  leave()      when what was put needs help to arrive; before the goodbyes
 *                     close()
 *
 * Peers with `direct` are served by comm.c: copy, then store-release of the tail. `threads` and
 * `shm` need no more than that. NULL functions do nothing.
 */
#ifndef LAR_COMM_BACKEND_H
#define LAR_COMM_BACKEND_H

#include <sys/types.h>

#include "base/socket.h"
#include "comm/comm.h"

enum { LAR_COMM_ADDRESS_BYTES = 2048 };

/* What a peer must know of a processor. Travels as it stands between equal builds. */
typedef struct lar_comm_address {
    uint64_t receive_bytes;
    char host[LAR_SOCKET_HOST_BYTES]; /* numeric, as seen from processor zero; "" for zero itself */
    uint32_t bytes;
    unsigned char data[LAR_COMM_ADDRESS_BYTES]; /* the backend's */
} lar_comm_address;

typedef struct lar_comm_backend {
    const char *name, *summary, *missing; /* as in lar_comm_backend_info */
    lar_comm_start start;
    bool meets; /* open and connect bring the processors together; otherwise rendezvous.h does */
    int polls;  /* before yielding */
    lar_status (*open)(lar_comm *comm, lar_error *error);
    lar_status (*connect)(lar_comm *comm, lar_error *error);
    void (*begin)(lar_comm *comm);
    lar_status (*put)(lar_comm *comm, int32_t peer, size_t offset, const void *data, size_t bytes,
                      uint64_t step, lar_error *error);
    /* Lets arrived bytes reach the receive buffer, first of all those from `peer`. An error says
     * that nothing more will come from it; what had come is stored. */
    lar_status (*progress)(lar_comm *comm, int32_t peer);
    void (*leave)(lar_comm *comm); /* not when comm->forked */
    void (*close)(lar_comm *comm);
} lar_comm_backend;

extern const lar_comm_backend lar_comm_threads, lar_comm_shm, lar_comm_ucx, lar_comm_mpi,
    lar_comm_tcp;

typedef struct lar_comm_peer {
    unsigned char *direct; /* its receive buffer when it can be written from here, else NULL */
    size_t half;           /* bytes of one half of it */
} lar_comm_peer;

struct lar_comm {
    const lar_comm_backend *backend;
    lar_comm_options options;
    unsigned char *receive;      /* the backend's; two halves of options.receive_bytes */
    lar_comm_peer *peers;        /* [count] */
    lar_comm_address *addresses; /* [count] */
    uint64_t completed;          /* steps, between two stretches of them */
    bool completed_known;        /* lar_comm_complete has been called */
    uint64_t ahead;              /* modulo 2^64: of steps' names in messages before their numbers */
    uint64_t token;              /* a number that only this computer's processors know */
    uint64_t *verdict;           /* who is lost; 0: nobody. Atomic, may be shared */
    uint64_t own_verdict;        /* where *verdict stands when it is not shared */
    int *links;                  /* [count] the rendezvous's connections, -1: none */
    int32_t *waiting; /* [count], atomic: whom each waits for, plus 1. Of the team; else NULL */
    struct lar_comm_heartbeat *heartbeat;
    bool times;    /* lar_comm_time_waits */
    double waited; /* [s] in lar_comm_wait, since then */
    pid_t process; /* that opened it */
    bool forked;   /* closed by a child of that: all but the own descriptors is the parent's */
    void *state;   /* the backend's */
};

/* Why a processor is lost. */
typedef enum lar_comm_loss {
    LAR_LOSS_ENDED = 1, /* its process or connection */
    LAR_LOSS_SILENT,    /* no sign of life */
    LAR_LOSS_STALLED,   /* it lives and sends nothing */
    LAR_LOSS_FAILED     /* it says so itself */
} lar_comm_loss;

static inline uint64_t lar_comm_verdict(int32_t processor, lar_comm_loss loss) {
    return (uint64_t)loss << 32 | (uint32_t)(processor + 1);
}

static inline uint64_t *lar_comm_tail(unsigned char *buffer, size_t half, size_t offset,
                                      size_t bytes, uint64_t step) {
    size_t at = (step & 1 ? half : 0) + offset + lar_comm_padded(bytes);
    return (uint64_t *)(void *)(buffer + at);
}

/* Whether a packet lies inside a half. */
static inline bool lar_comm_fits(size_t half, size_t offset, size_t bytes) {
    return offset % 8 == 0 && offset <= half && bytes <= half - offset &&
           lar_comm_packet_bytes(bytes) <= half - offset;
}

/* Whether all processors are on this machine because processor zero can be reached from nowhere
 * else. */
bool lar_comm_is_local(const lar_comm *comm);

/* Between two polls of memory: leaves the core to its other thread. */
static inline void lar_comm_relax(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

/* Monotonic clock [s]. */
double lar_comm_now(void);

/* How long somebody who lives has been waited for; zero at first. */
typedef struct lar_comm_waited {
    bool began;
    double until, looked;
} lar_comm_waited;

/* Each time that nothing has come: whether options.patience is over. It begins anew for who was
 * itself held up for half of that, as a whole job is that was suspended (Ctrl-Z, SIGSTOP). */
bool lar_comm_impatient(const lar_comm *comm, lar_comm_waited *waited);
/* The same by any clock [s], which may have begun a moment ago: a machine's does when it boots. */
bool lar_comm_waited_for(lar_comm_waited *waited, double now, double patience);

/* Gives a processor up for everyone; the first verdict stands. Returns LAR_ERROR_PEER with the
 * message of the verdict that stands. `step` is the one that cannot be completed; 0: none. */
lar_status lar_comm_give_up(lar_comm *comm, int32_t processor, lar_comm_loss loss, uint64_t step,
                            lar_error *error);

/* The message of a standing verdict, or LAR_OK. */
lar_status lar_comm_check(lar_comm *comm, uint64_t step, lar_error *error);

#endif
