/* Processors that mpirun or srun has started: who am I, and where is processor zero?
 *
 *     lar_comm_job_find      the launcher's environment; MPI is joined when there are several
 *     lar_comm_job_meet      zero listens, MPI tells everyone where   --+   for every
 *     lar_comm_open          the ordinary rendezvous, any backend        --+   lar_comm
 *     lar_comm_close
 *     lar_comm_job_end       before the process ends
 *
 * Only the address travels through MPI (T 7.5.7); everything after that, the heartbeat
 * included, is the same as without a launcher, for every backend.
 *
 * A processor that fails ends with a status other than 0 and without leaving MPI: launchers then
 * end all others. They also do when a process is killed, and say so; MPICH's is so quick that the
 * others get no time for a message of their own.
 *
 * Open MPI binds each of two processes to one core, with all its threads: processors of several
 * threads need mpirun --bind-to none.
 *
 *     launcher            tells by                                       MPI
 *     mpirun of Open MPI  OMPI_COMM_WORLD_RANK, OMPI_COMM_WORLD_SIZE     openmpi
 *     mpirun of MPICH     PMI_RANK, PMI_SIZE                             mpich
 *     srun                SLURM_PROCID, SLURM_STEP_NUM_TASKS             what is there
 *     prun, others        PMIX_RANK (MPI knows how many)                 what is there
 */
#ifndef LAR_COMM_JOB_H
#define LAR_COMM_JOB_H

#include "comm/comm.h"

typedef struct lar_comm_job {
    int32_t self, count; /* count 1: no job, this process is alone; nothing need be done */
    char master[LAR_COMM_ADDRESS_TEXT];
} lar_comm_job;

/* Whether a launcher started this process as one of several; looks at the environment alone. */
bool lar_comm_job_launched(void);

/* Fails when the processes cannot be brought together: no module for this MPI, or a launcher and
 * a module that do not belong together. */
lar_status lar_comm_job_find(lar_comm_job *job, lar_error *error);

/* All processors of the job together, before each lar_comm_open: sets self, count, master (kept in
 * `job`) and listener of the options. The listener is the caller's until lar_comm_open takes it. A
 * lar_comm of fewer processors (those below some count) is possible. */
lar_status lar_comm_job_meet(lar_comm_job *job, lar_comm_options *options, lar_error *error);

/* Leaves MPI together with the others, or when this processor has failed (and has said so) after
 * 0.1 s, in which they can say it too. */
lar_status lar_comm_job_end(lar_comm_job *job, bool failed, lar_error *error);

#endif
