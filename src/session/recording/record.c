#include "session/recording/record.h"

#include <inttypes.h>
#include <stdlib.h>
#include <time.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/pin.h"
#include "base/thread.h"

enum { RING = 16384 };                /* records: a second of sixteen tools, many of one */
static const int64_t LOOK = 50000000; /* [ns] */

typedef struct place {
    lar_record record;
    lar_bytes state; /* of a state: the writer frees it */
} place;

struct lar_recorder {
    char *path;
    lar_recording_writer writer; /* the thread's; of whoever holds the lock */
    uint64_t put, written;       /* atomic: records */
    int cause;                   /* atomic: errno of what could not be written; 0: all was */
    lar_error over;              /* the engine's: why it breaks off; LAR_OK: it goes on */
    uint64_t step;               /* the engine's: of the latest record */
    bool finish;                 /* under the lock */
    pthread_mutex_t lock;
    pthread_cond_t wake;
    lar_thread thread;
    place *ring; /* [RING] */
};

static void write_place(lar_recorder *recorder, place *p) {
    if (p->record.kind == LAR_RECORD_STATE)
        lar_recording_put_state(&recorder->writer, p->record.step, &p->state);
    else
        lar_recording_put(&recorder->writer, &p->record);
    /* Out of the ring before it is freed: a child that is forked in between would free it again. */
    void *data = p->state.data;
    __atomic_store_n(&p->state.data, NULL, __ATOMIC_SEQ_CST);
    free(data);
}

/* Under the lock. */
static void drain(lar_recorder *recorder) {
    uint64_t put = __atomic_load_n(&recorder->put, __ATOMIC_ACQUIRE);
    for (uint64_t at = recorder->written; at < put; at++) {
        write_place(recorder, &recorder->ring[at % RING]);
        __atomic_store_n(&recorder->written, at + 1, __ATOMIC_RELEASE);
    }
    lar_recording_flush(&recorder->writer);
    __atomic_store_n(&recorder->cause, recorder->writer.cause, __ATOMIC_RELEASE);
}

static void *write_records(void *argument) {
    lar_recorder *recorder = argument;
    lar_pin_nowhere(); /* not where a processor computes, which may have started it */
    pthread_mutex_lock(&recorder->lock);
    while (!recorder->finish) {
        int64_t until = lar_clock_ns() + LOOK;
        struct timespec at = {until / 1000000000, until % 1000000000};
        pthread_cond_timedwait(&recorder->wake, &recorder->lock, &at);
        drain(recorder);
    }
    pthread_mutex_unlock(&recorder->lock);
    return NULL;
}

static void free_memory(lar_recorder *recorder) {
    free(recorder->ring);
    free(recorder->path);
    free(recorder);
}

static void destroy(lar_recorder *recorder) {
    pthread_cond_destroy(&recorder->wake);
    pthread_mutex_destroy(&recorder->lock);
    free_memory(recorder);
}

static lar_recorder *make(const char *path) {
    lar_recorder *recorder = lar_calloc(1, sizeof *recorder);
    if (!recorder) return NULL;
    pthread_condattr_t steady;
    pthread_condattr_init(&steady);
    pthread_condattr_setclock(&steady, CLOCK_MONOTONIC);
    pthread_mutex_init(&recorder->lock, NULL);
    pthread_cond_init(&recorder->wake, &steady);
    pthread_condattr_destroy(&steady);
    recorder->path = lar_strdup(path);
    recorder->ring = lar_calloc(RING, sizeof *recorder->ring);
    if (recorder->path && recorder->ring) return recorder;
    destroy(recorder);
    return NULL;
}

static lar_status start_thread(lar_recorder *recorder, lar_error *error) {
    int cause = lar_thread_start(&recorder->thread, write_records, recorder);
    return cause ? lar_fail_thread(error, cause, "a recording") : LAR_OK;
}

lar_status lar_recorder_create(const char *path, const lar_recording_header *header,
                               lar_recorder **out, lar_error *error) {
    lar_recorder *recorder = make(path);
    if (!recorder) return lar_fail_memory(error, RING * sizeof(place), "a recording");
    lar_status status = lar_recording_create(recorder->path, header, &recorder->writer, error);
    if (!status) status = start_thread(recorder, error);
    if (status) {
        lar_recording_finish(&recorder->writer, NULL);
        destroy(recorder);
        return status;
    }
    *out = recorder;
    return LAR_OK;
}

/* In a forked child: the file is its parent's to write, also what waits here. */
static lar_status forget(lar_recorder *recorder) {
    for (uint64_t at = recorder->written; at < recorder->put; at++)
        lar_bytes_free(&recorder->ring[at % RING].state);
    lar_recording_forget(&recorder->writer);
    free_memory(recorder);
    return LAR_OK;
}

lar_status lar_recorder_close(lar_recorder *recorder, lar_error *error) {
    if (!recorder) return LAR_OK;
    if (!lar_thread_is_here(&recorder->thread)) return forget(recorder);
    pthread_mutex_lock(&recorder->lock);
    recorder->finish = true;
    pthread_cond_signal(&recorder->wake);
    pthread_mutex_unlock(&recorder->lock);
    lar_thread_join(&recorder->thread);
    drain(recorder);
    lar_status status = lar_recording_finish(&recorder->writer, error);
    if (!status && recorder->over.status)
        status = lar_fail(error, recorder->over.status, "%s", recorder->over.message);
    destroy(recorder);
    return status;
}

void lar_recorder_why(const lar_recorder *recorder, lar_error *error) {
    *error = recorder->over;
}

static bool put(lar_recorder *recorder, const place *p) {
    int cause = __atomic_load_n(&recorder->cause, __ATOMIC_ACQUIRE);
    if (!recorder->over.status && cause)
        lar_recording_incomplete(recorder->path, cause, &recorder->over);
    uint64_t written = __atomic_load_n(&recorder->written, __ATOMIC_ACQUIRE);
    if (!recorder->over.status && recorder->put - written == RING)
        lar_fail(&recorder->over, LAR_ERROR_IO,
                 "%s: the disk was too slow for the recording, which breaks off at step %" PRIu64
                 "; record to another one",
                 recorder->path, recorder->step);
    if (recorder->over.status) return false;
    recorder->ring[recorder->put % RING] = *p;
    recorder->step = p->record.step;
    __atomic_store_n(&recorder->put, recorder->put + 1, __ATOMIC_RELEASE);
    return true;
}

bool lar_recorder_put(lar_recorder *recorder, const lar_record *record) {
    return put(recorder, &(place){.record = *record});
}

lar_status lar_recorder_put_state(lar_recorder *recorder, const lar_simulation *simulation,
                                  lar_error *error) {
    place p = {.record = {.kind = LAR_RECORD_STATE, .step = lar_simulation_steps(simulation)}};
    lar_error cause;
    lar_status status = lar_simulation_pack(simulation, recorder->path, &p.state, &cause);
    /* What follows would be played from another state. */
    if (status && !recorder->over.status)
        lar_fail(&recorder->over, status,
                 "%s: the recording breaks off at step %" PRIu64
                 ", where the simulation went to another state that could not be recorded: %s",
                 recorder->path, recorder->step, cause.message);
    if (status) return lar_fail(error, status, "%s", cause.message);
    if (put(recorder, &p)) return LAR_OK;
    lar_bytes_free(&p.state);
    return lar_fail(error, recorder->over.status, "%s", recorder->over.message);
}
