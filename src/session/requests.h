/* Requests to the engine's thread, in the order of their arrival.
 *
 *     any thread: place ---> ring of requests ---> engine, between two ticks: takes the next one
 *                 waits  <--- answer, for requests that have one
 *
 * A lock guards the ring, but the engine only tries it while it is at work: whoever holds it makes
 * requests wait until the next tick, not the engine. Only while it is paused does the engine sleep
 * on it. The same lock and the same bell wake threads that wait for a snapshot.
 */
#ifndef LAR_SESSION_REQUESTS_H
#define LAR_SESSION_REQUESTS_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "session/device/device.h"
#include "session/recording/player.h"
#include "session/recording/record.h"

typedef enum lar_request_kind {
    LAR_REQUEST_PLAY = 0,
    LAR_REQUEST_PAUSE,
    LAR_REQUEST_STEP,
    LAR_REQUEST_PACE,
    LAR_REQUEST_RESET,
    LAR_REQUEST_SAVE,
    LAR_REQUEST_LOAD,
    LAR_REQUEST_RECORD,
    LAR_REQUEST_REPLAY,
    LAR_REQUEST_SEEK,
    LAR_REQUEST_ATTACH,
    LAR_REQUEST_SET,
    LAR_REQUEST_GRASP,
    LAR_REQUEST_RELEASE,
    LAR_REQUEST_TOUCHES,
    LAR_REQUEST_END
} lar_request_kind;

/* Of a request that somebody waits for; on that thread's stack. */
typedef struct lar_request_answer {
    bool done;
    lar_status status;
    lar_error error;
    lar_bytes state;        /* SAVE: the caller writes and frees it */
    lar_recorder *recorder; /* RECORD: what the engine has let go of; the caller closes it */
    lar_player *player;     /* REPLAY, RESET, LOAD: likewise */
    int32_t tool;           /* SET: that was added */
    int32_t held;           /* GRASP: points of the surface; TOUCHES: how many there are */
} lar_request_answer;

/* Files are opened, read and written by whoever asks: the engine only gets and gives what is in
 * them. */
typedef struct lar_request {
    lar_request_kind kind;
    int32_t tool;               /* ATTACH, GRASP, RELEASE, TOUCHES */
    uint64_t steps;             /* STEP */
    double pace;                /* PACE */
    const char *path;           /* SAVE, LOAD: for messages */
    const lar_bytes *state;     /* LOAD */
    lar_saved *save_to;         /* SAVE: in memory; NULL: into the answer */
    const lar_saved *load_from; /* LOAD: likewise; NULL: from `state` */
    lar_recorder *recorder;     /* RECORD; NULL: ends */
    lar_player *player;         /* REPLAY; NULL: ends */
    double seconds;             /* SEEK */
    double point[3];            /* GRASP: of a hand, where `pointed` */
    bool pointed;               /* GRASP */
    lar_touch *touch;           /* TOUCHES: [max], who waits has it */
    int32_t max;                /* TOUCHES */
    uint64_t ticket;            /* GRASP without an answer: lar_grasp_answer */
    lar_device *device;         /* ATTACH: the session's when it succeeds */
    lar_setting setting;        /* SET */
    lar_request_answer *answer; /* NULL: nobody waits */
} lar_request;

enum { LAR_REQUESTS_MAX = 256 };

typedef struct lar_requests {
    pthread_mutex_t lock;
    pthread_cond_t work; /* the engine sleeps on it */
    pthread_cond_t bell; /* the others do */
    lar_request ring[LAR_REQUESTS_MAX];
    uint64_t placed;    /* atomic; changed under the lock */
    uint64_t taken;     /* under the lock */
    bool ring_the_bell; /* the engine's: somebody is still to be told */
} lar_requests;

void lar_requests_create(lar_requests *requests);
void lar_requests_destroy(lar_requests *requests);

/* Any thread but the engine's, which holds the lock. Waits while the ring is full. */
static inline bool lar_requests_full(const lar_requests *requests) {
    return requests->placed - requests->taken == LAR_REQUESTS_MAX;
}
void lar_requests_place(lar_requests *requests, const lar_request *request);
/* Waits on the bell, at most until `deadline` (base/clock.h); false when that has passed. */
bool lar_requests_wait(lar_requests *requests, int64_t deadline);

/* Under the lock. False when there is none. */
bool lar_requests_take(lar_requests *requests, lar_request *request);
/* The engine's thread, without the lock. False when there is none, or the lock is taken. */
bool lar_requests_next(lar_requests *requests, lar_request *request);
/* An answer is complete: whoever waits for it is told. Takes the lock: for what took long anyway.
 */
void lar_requests_answer(lar_requests *requests, lar_request_answer *answer);
/* Wakes all who wait on the bell, now or, where the lock is taken, at a later call
 * (ring_the_bell). */
void lar_requests_ring(lar_requests *requests);
/* Sleeps until there is a request or something else is wanted, at most until `deadline`. Who wants
 * something else rings `work`, with the lock. */
void lar_requests_sleep(lar_requests *requests, bool (*wanted)(void *context), void *context,
                        int64_t deadline);

#endif
