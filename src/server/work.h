/* What the server's thread must not wait for, done by a second one: snapshots and their colours,
 * and requests to the session that wait for an answer.
 *
 *     server's thread:  want(fields), ask(job)  -->  worker: snapshot, frames; reset, save, ...
 *                       collect(picture, news)  <--  then wakes the server's thread
 *
 * One picture is made for all who want one. Both threads run below the engine's priority, and
 * pictures are made no faster than server.c allows: the engine has the machine first.
 */
#ifndef LAR_SERVER_WORK_H
#define LAR_SERVER_WORK_H

#include <pthread.h>

#include "base/thread.h"
#include "server/picture.h"
#include "server/reading.h"

enum { LAR_JOBS_MAX = 16, LAR_PATH_MAX = 1024, LAR_SERVER_NICE = 5 };

typedef struct lar_job {
    lar_command_kind kind; /* reset, save, load, record, replay, inspect, gravity, ... */
    uint64_t viewer;
    bool on;                     /* record */
    lar_question question;       /* inspect */
    lar_command setting;         /* gravity, damping, stiffness, add_tool, remove_tool */
    char name[LAR_NAME_MAX + 1]; /* of the file, without its folder */
    char path[LAR_PATH_MAX];
} lar_job;

/* How a job ended. */
typedef struct lar_job_end {
    lar_job job;
    lar_error error; /* status LAR_OK: done */
    lar_reading reading;
} lar_job_end;

typedef struct lar_work {
    lar_session *session;
    const lar_model *model;
    lar_painter painter;
    void (*wake)(void *context); /* the server's thread; may be called from any */
    void *context;

    lar_thread thread;
    bool started;
    bool records; /* what is recorded a viewer has begun; the worker writes it, atomically */
    pthread_mutex_t lock; /* of what follows */
    pthread_cond_t bell;
    bool ending, painting;
    unsigned wanted;       /* fields, as bits */
    lar_picture picture;   /* finished; the other one is the collector's */
    lar_picture canvas;    /* the worker's own */
    bool painted;          /* `picture` is new, or `paint_error` is */
    lar_error paint_error; /* status LAR_OK: there is a picture */
    lar_job job[LAR_JOBS_MAX];
    int32_t jobs;
    lar_job_end end[LAR_JOBS_MAX];
    int32_t ends;
} lar_work;

lar_status lar_work_start(lar_work *work, lar_session *session, const lar_model *model,
                          void (*wake)(void *context), void *context, lar_error *error);
/* Waits for the job under way. Idempotent; a zeroed one is fine. */
void lar_work_stop(lar_work *work);

/* False while a picture is being made, or waits to be collected. */
bool lar_work_want(lar_work *work, unsigned fields);
/* False when there are too many already. */
bool lar_work_ask(lar_work *work, const lar_job *job);

/* The newest picture is exchanged with *picture (made by lar_picture_create). False: there is none.
 * error->status: LAR_OK, or there is an error instead of a picture. */
bool lar_work_collect(lar_work *work, lar_picture *picture, lar_error *error);
/* One job that has ended; false: none. */
bool lar_work_next_end(lar_work *work, lar_job_end *end);

#endif
