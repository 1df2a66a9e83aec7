#include "comm/job.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/socket.h"
#include "comm/backend.h"
#include "comm/mpi_world.h"

/* ---- the launcher --------------------------------------------------------------------------- */

typedef struct launcher {
    const char *name, *rank, *size; /* environment; size NULL: not told */
    const char *mpi;                /* which, or NULL */
} launcher;

/* The first that is there counts: inside an allocation of SLURM, mpirun is the nearer one. */
static const launcher launchers[] = {
    {"mpirun of Open MPI", "OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "openmpi"},
    {"mpirun of MPICH", "PMI_RANK", "PMI_SIZE", "mpich"},
    {"srun", "SLURM_PROCID", "SLURM_STEP_NUM_TASKS", NULL},
    {"a launcher with PMIx", "PMIX_RANK", NULL, NULL}};

/* -1: not there. */
static long number_in(const char *variable) {
    const char *text = variable ? getenv(variable) : NULL;
    if (!text || !*text) return -1;
    char *end;
    long value = strtol(text, &end, 10);
    return *end || value < 0 ? -1 : value;
}

/* Who started this process as one of several; *count -1: not told. */
static const launcher *find_launcher(long *self, long *count) {
    for (size_t i = 0; i < sizeof launchers / sizeof launchers[0]; i++) {
        const launcher *l = &launchers[i];
        *self = number_in(l->rank);
        *count = number_in(l->size);
        /* A batch script of SLURM has a number, too, but is not one of several. */
        if (*self < 0 || (l->size && *count < 0)) continue;
        return *count == 1 ? NULL : l;
    }
    return NULL;
}

bool lar_comm_job_launched(void) {
    long self, count;
    return find_launcher(&self, &count) != NULL;
}

lar_status lar_comm_job_find(lar_comm_job *job, lar_error *error) {
    long self, count;
    const launcher *by = find_launcher(&self, &count);
    if (!by) {
        *job = (lar_comm_job){.count = 1};
        return LAR_OK;
    }
    lar_mpi_world *world;
    lar_status status = lar_mpi_join(by->mpi, &world, error);
    if (status) return status;
    int rank = world->rank, size = world->size;
    if (size == 1) status = lar_mpi_leave(false, lar_comm_options_default().timeout, error);
    if (status) return status;
    if (count >= 0 && (rank != self || size != count))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s says that this is processor %ld of %ld, %s says %d of %d: they do not "
                        "belong together; start with the mpirun of that MPI, under SLURM with srun "
                        "--mpi=pmix or --mpi=pmi2, or choose another module by LARIAT_MPI=openmpi "
                        "or mpich",
                        by->name, self, count, world->mpi->name, rank, size);
    *job = (lar_comm_job){.self = (int32_t)rank, .count = (int32_t)size};
    return LAR_OK;
}

lar_status lar_comm_job_end(lar_comm_job *job, bool failed, lar_error *error) {
    bool alone = job->count <= 1;
    *job = (lar_comm_job){.count = 1};
    /* The others have the same verdict to tell; a launcher may end them as soon as one ends. */
    if (!alone && failed) nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    return alone ? LAR_OK : lar_mpi_leave(failed, lar_comm_options_default().timeout, error);
}

/* ---- rendezvous ------------------------------------------------------------------------------ */

static uint64_t hash_text(uint64_t hash, const char *text) {
    for (; *text; text++) hash = lar_hash_word(hash, (unsigned char)*text);
    return hash;
}

/* Equal for processes that share a loopback: the running kernel, the network namespace and the
 * name of the machine. */
static uint64_t own_network(void) {
    char text[256] = "";
    uint64_t hash = 0;
    FILE *boot = fopen("/proc/sys/kernel/random/boot_id", "re");
    if (boot && fgets(text, sizeof text, boot)) hash = hash_text(hash, text);
    if (boot) fclose(boot);
    struct stat space;
    if (stat("/proc/self/ns/net", &space) == 0) hash = lar_hash_word(hash, (uint64_t)space.st_ino);
    if (gethostname(text, sizeof text - 1) == 0) hash = hash_text(hash, text);
    return hash;
}

static lar_status on_one_network(lar_mpi_world *world, double timeout, bool *one,
                                 lar_error *error) {
    uint64_t own = own_network();
    uint64_t *all = lar_calloc((size_t)world->size, sizeof *all);
    if (!all) return lar_fail_memory(error, (size_t)world->size * 8, "the processors' machines");
    lar_status status = lar_mpi_gather(world, &own, sizeof own, all, timeout, error);
    *one = true;
    for (int p = 0; p < world->size && !status; p++) *one = *one && all[p] == own;
    free(all);
    return status;
}

/* What zero tells the others. */
typedef struct notice {
    char master[LAR_COMM_ADDRESS_TEXT];
    lar_error error; /* when it cannot listen */
} notice;

static lar_status listen_somewhere(bool loopback, int *listener, notice *n) {
    char host[LAR_SOCKET_HOST_BYTES] = "127.0.0.1", at[LAR_COMM_ADDRESS_TEXT];
    lar_status status = loopback ? LAR_OK : lar_socket_own_host(host, &n->error);
    snprintf(at, sizeof at, strchr(host, ':') ? "[%s]:0" : "%s:0", host);
    if (!status) status = lar_comm_listen(at, listener, n->master, &n->error);
    return status;
}

lar_status lar_comm_job_meet(lar_comm_job *job, lar_comm_options *options, lar_error *error) {
    lar_mpi_world *world = lar_mpi_joined();
    if (!world || job->count <= 1)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "this processor was not started together with others; start with mpirun or "
                        "srun");
    bool one = true;
    int listener = -1;
    lar_status status = on_one_network(world, options->start_timeout, &one, error);
    if (status) return status;
    notice own = {.error.status = LAR_OK};
    notice *all = lar_calloc((size_t)job->count, sizeof *all);
    if (!all) return lar_fail_memory(error, (size_t)job->count * sizeof *all, "addresses");
    if (job->self == 0) listen_somewhere(one, &listener, &own);
    status = lar_mpi_gather(world, &own, sizeof own, all, options->start_timeout, error);
    if (!status && all[0].error.status)
        status = lar_fail(error, all[0].error.status, "%s", all[0].error.message);
    if (!status) {
        memcpy(job->master, all[0].master, sizeof job->master);
        options->self = job->self;
        options->count = job->count;
        options->master = job->master;
        options->listener = listener;
    } else if (listener >= 0) {
        close(listener);
    }
    free(all);
    return status;
}
