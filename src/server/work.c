#include "server/work.h"

#include <string.h>
#include <sys/resource.h>

#include "base/pin.h"
#include "base/thread.h"

/* A tick that takes longer than this is no real time at all [s]. */
static const double SNAPSHOT_SECONDS = 2;

/* With the painter's snapshot: both are this thread's. */
static void inspect(lar_work *work, lar_job_end *end) {
    lar_snapshot *snapshot = work->painter.snapshot;
    if (!lar_session_snapshot(work->session, snapshot, SNAPSHOT_SECONDS, &end->error))
        lar_reading_take(work->painter.simulation, &end->job.question, snapshot, &end->reading,
                         &end->error);
}

/* The command is told which tool that is. */
static void add_tool(lar_work *work, lar_command *command, lar_error *error) {
    const lar_tool_info wanted = {
        .shape = command->shape, .radius = command->radius, .length = command->length};
    lar_session_add_tool(work->session, &wanted, &command->tool, error);
}

static void set(lar_work *work, const lar_command *command, lar_error *error) {
    lar_session *session = work->session;
    double damping = lar_model_damping(work->model);
    if (command->kind == LAR_COMMAND_GRAVITY)
        lar_session_set_gravity(session, command->valued ? command->point : NULL, error);
    else if (command->kind == LAR_COMMAND_DAMPING)
        lar_session_set_damping(session, command->valued ? command->value : damping, error);
    else
        (command->kind == LAR_COMMAND_ACTIVATE ? lar_session_activate : lar_session_set_stiffness)(
            session, command->material, command->valued ? command->value : 1, error);
}

static bool is_recorded(const lar_work *work) {
    lar_session_status now;
    lar_session_status_get(work->session, &now);
    return now.recording;
}

/* What is being recorded though no viewer has begun it: the program has, and it alone ends that. */
static bool is_programs(const lar_work *work, lar_error *error) {
    return !work->records && is_recorded(work) &&
           lar_fail(error, LAR_ERROR_ARGUMENT,
                    "the program itself records this session (--record); until that ends nothing "
                    "else is recorded or played");
}

static void record(lar_work *work, const char *path, lar_error *error) {
    if (is_programs(work, error)) return;
    __atomic_store_n(&work->records, true, __ATOMIC_RELAXED); /* no status may think otherwise */
    lar_session_record(work->session, path, error);
    __atomic_store_n(&work->records, is_recorded(work), __ATOMIC_RELAXED);
}

static void replay(const lar_work *work, const char *path, lar_error *error) {
    if (!path || !is_programs(work, error)) lar_session_replay(work->session, path, error);
}

static void do_job(lar_work *work, lar_job_end *end) {
    lar_job *job = &end->job;
    lar_error *error = &end->error;
    error->status = LAR_OK;
    switch (job->kind) {
    case LAR_COMMAND_RESET:
        lar_session_reset(work->session, error);
        break;
    case LAR_COMMAND_SAVE:
        lar_session_save(work->session, job->path, error);
        break;
    case LAR_COMMAND_LOAD:
        lar_session_load(work->session, job->path, error);
        break;
    case LAR_COMMAND_RECORD:
        record(work, job->on ? job->path : NULL, error);
        break;
    case LAR_COMMAND_REPLAY:
        replay(work, job->name[0] ? job->path : NULL, error);
        break;
    case LAR_COMMAND_INSPECT:
        inspect(work, end);
        break;
    case LAR_COMMAND_GRAVITY:
    case LAR_COMMAND_DAMPING:
    case LAR_COMMAND_STIFFNESS:
    case LAR_COMMAND_ACTIVATE:
        set(work, &job->setting, error);
        break;
    case LAR_COMMAND_ADD_TOOL:
        add_tool(work, &job->setting, error);
        break;
    case LAR_COMMAND_REMOVE_TOOL:
        lar_session_remove_tool(work->session, job->setting.tool, error);
        break;
    default:
        break;
    }
}

/* With the lock; lets go of it meanwhile. */
static void next_job(lar_work *work) {
    lar_job_end end = {.job = work->job[0]};
    work->jobs--;
    memmove(work->job, work->job + 1, (size_t)work->jobs * sizeof *work->job);
    pthread_mutex_unlock(&work->lock);
    do_job(work, &end);
    pthread_mutex_lock(&work->lock);
    if (work->ends == LAR_JOBS_MAX) { /* nobody collects them: the oldest goes */
        work->ends--;
        memmove(work->end, work->end + 1, (size_t)work->ends * sizeof *work->end);
    }
    work->end[work->ends++] = end;
}

static void paint(lar_work *work) {
    unsigned wanted = work->wanted;
    lar_error error = {.status = LAR_OK};
    work->wanted = 0;
    work->painting = true;
    pthread_mutex_unlock(&work->lock);
    lar_painter_paint(&work->painter, wanted, SNAPSHOT_SECONDS, &work->canvas, &error);
    pthread_mutex_lock(&work->lock);
    lar_picture finished = work->canvas;
    work->canvas = work->picture;
    work->picture = finished;
    work->paint_error = error;
    work->painting = false;
    work->painted = true;
}

static void *run(void *argument) {
    lar_work *work = argument;
    lar_pin_nowhere();                             /* as the server's */
    setpriority(PRIO_PROCESS, 0, LAR_SERVER_NICE); /* of this thread only, on Linux */
    pthread_mutex_lock(&work->lock);
    while (!work->ending) {
        if (work->jobs > 0)
            next_job(work);
        else if (work->wanted && !work->painted)
            paint(work);
        else {
            pthread_cond_wait(&work->bell, &work->lock);
            continue;
        }
        pthread_mutex_unlock(&work->lock);
        work->wake(work->context);
        pthread_mutex_lock(&work->lock);
    }
    pthread_mutex_unlock(&work->lock);
    return NULL;
}

lar_status lar_work_start(lar_work *work, lar_session *session, const lar_model *model,
                          void (*wake)(void *context), void *context, lar_error *error) {
    *work = (lar_work){.session = session, .model = model, .wake = wake, .context = context};
    lar_status status = lar_painter_create(session, model, &work->painter, error);
    if (!status) status = lar_picture_create(&work->painter, &work->picture, error);
    if (!status) status = lar_picture_create(&work->painter, &work->canvas, error);
    if (!status) {
        pthread_mutex_init(&work->lock, NULL);
        pthread_cond_init(&work->bell, NULL);
        int cause = lar_thread_start(&work->thread, run, work);
        work->started = cause == 0;
        if (cause) status = lar_fail_thread(error, cause, "the viewers' server");
    }
    if (status) lar_work_stop(work);
    return status;
}

void lar_work_stop(lar_work *work) {
    if (work->started) {
        pthread_mutex_lock(&work->lock);
        work->ending = true;
        pthread_cond_signal(&work->bell);
        pthread_mutex_unlock(&work->lock);
        lar_thread_join(&work->thread);
        pthread_mutex_destroy(&work->lock);
        pthread_cond_destroy(&work->bell);
    }
    lar_picture_destroy(&work->picture);
    lar_picture_destroy(&work->canvas);
    lar_painter_destroy(&work->painter);
    *work = (lar_work){0};
}

bool lar_work_want(lar_work *work, unsigned fields) {
    pthread_mutex_lock(&work->lock);
    bool free = !work->painting && !work->painted && !work->wanted;
    if (free) {
        work->wanted = fields;
        pthread_cond_signal(&work->bell);
    }
    pthread_mutex_unlock(&work->lock);
    return free;
}

bool lar_work_ask(lar_work *work, const lar_job *job) {
    pthread_mutex_lock(&work->lock);
    bool room = work->jobs < LAR_JOBS_MAX;
    if (room) {
        work->job[work->jobs++] = *job;
        pthread_cond_signal(&work->bell);
    }
    pthread_mutex_unlock(&work->lock);
    return room;
}

bool lar_work_collect(lar_work *work, lar_picture *picture, lar_error *error) {
    pthread_mutex_lock(&work->lock);
    bool there = work->painted;
    if (there) {
        *error = work->paint_error;
        if (!error->status) {
            lar_picture older = *picture;
            *picture = work->picture;
            work->picture = older;
        }
        work->painted = false;
        pthread_cond_signal(&work->bell);
    }
    pthread_mutex_unlock(&work->lock);
    return there;
}

bool lar_work_next_end(lar_work *work, lar_job_end *end) {
    pthread_mutex_lock(&work->lock);
    bool there = work->ends > 0;
    if (there) {
        *end = work->end[0];
        work->ends--;
        memmove(work->end, work->end + 1, (size_t)work->ends * sizeof *work->end);
    }
    pthread_mutex_unlock(&work->lock);
    return there;
}
