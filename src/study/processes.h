/* The processes of a command whose processors are processes: who this one is, who starts the
 * others, and how they end (T 5.3.1: the controller starts the others).
 *
 *     started by          this process is         the others
 *     a user, alone       processor zero          are started here, on this machine
 *     processor zero      --processor K           it waits for them, and says who ended badly
 *     a user, by hand     --processor K           are started by hand, on whatever machine
 *     mpirun, srun        what the launcher says  were started by it, too
 *
 *     lar_processes_begin    who am I?
 *     lar_processes_start    the others, once their number is known
 *     lar_processes_create   for lar_simulation_create, in all of them as often
 *     lar_processes_end
 *
 * Processes that were started here read and write nothing but messages, and never get SIGINT,
 * SIGTERM and SIGHUP: these often go to all of a group, and processor zero ends the run for all.
 * When processor zero ends
 * without a word, they learn it from their connection and can say so; should one of them not get
 * there within two seconds, the system ends it.
 */
#ifndef LAR_STUDY_PROCESSES_H
#define LAR_STUDY_PROCESSES_H

#include <stdbool.h>

#include "lariat.h"

typedef struct lar_processes lar_processes;

typedef struct lar_processes_setting {
    const char *comm;      /* as in lar_options; NULL: processors are threads */
    int32_t processor;     /* -1: not given */
    const char *master;    /* NULL: not given */
    const char *command;   /* "run": its words, and "--processor K --master ADDRESS" behind them */
    int argument_count;    /* what follows them */
    char *const *argument; /* outlives lar_processes_start, as all of these do */
} lar_processes_setting;

/* Into *options: where the processes of a launcher's job meet. */
struct lar_comm_job;
lar_status lar_processes_meet_in_job(struct lar_comm_job *job, lar_options *options,
                                     lar_error *error);

/* For handlers of signals that ask a command to end: true while processors wait for each other in
 * this process. Then lar_processes_create ends soon, with nothing left behind, and an error of
 * which lar_processes_interrupted is true. It is also where another processor was asked. */
bool lar_processes_interrupt(void);
bool lar_processes_interrupted(const lar_error *error);

/* LAR_ERROR_ARGUMENT when launcher and options do not belong together. */
lar_status lar_processes_begin(const lar_processes_setting *setting, lar_processes **processes,
                               lar_error *error);

/* The number of this process's first processor. */
int32_t lar_processes_self(const lar_processes *processes);
/* Whether processor zero has started this one. */
bool lar_processes_has_parent(const lar_processes *processes);
/* Whether somebody started this one by itself, and not processor zero or a launcher. */
bool lar_processes_by_hand(const lar_processes *processes);

/* Processor zero starts processors 1 .. count - 1 when nobody else does. */
lar_status lar_processes_start(lar_processes *processes, int32_t count, lar_error *error);

/* lar_simulation_create, with processor, master and listener of the options set. When a process
 * that was started here ends before it has come, fails at once and names it. `processes` may be
 * NULL: the options as they are. `error` is not. */
lar_status lar_processes_create(lar_processes *processes, const lar_model *model,
                                const lar_options *options, lar_simulation **simulation,
                                lar_error *error);

/* Before a process other than zero, which could not even begin, says why: processor zero, if it has
 * started this one, has most likely said the same, and ends it here. */
void lar_processes_hesitate(const lar_processes *processes);

/* Waits for the processes that were started and frees; ends those that do not end themselves within
 * a moment. `failure` is this process's own, LAR_OK: none; after LAR_ERROR_PEER the others have
 * something to say. LAR_ERROR_PEER when one of them ended badly and may not have said so itself.
 * Accepts NULL. */
lar_status lar_processes_end(lar_processes *processes, lar_status failure, lar_error *error);

#endif
