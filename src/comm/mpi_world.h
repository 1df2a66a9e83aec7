/* MPI in this process: the module of the launcher's MPI, joined once, left once.
 *
 * Where modules are looked for: LARIAT_MPI (a path, or a name: openmpi, mpich); beside the library
 * or the command; where they are installed, seen from the command's folder.
 *
 * One lock for all calls. MPI could be asked for MPI_THREAD_MULTIPLE instead; both libraries then
 * serialise inside, and it is no faster (measured). Who only polls does not insist (lar_mpi_try)
 * and lets those go first who send.
 */
#ifndef LAR_COMM_MPI_WORLD_H
#define LAR_COMM_MPI_WORLD_H

#include "base/error.h"
#include "comm/mpi_shim.h"

typedef struct lar_mpi_world {
    const lar_mpi *mpi;
    int rank, size, tag_max;
    int tags_used;
    int busy, senders; /* atomic: the lock, and who waits for it */
    void *abandoned;   /* memory that MPI may still touch after a loss */
} lar_mpi_world;

/* Whether the module of "openmpi" or "mpich" is there; it is not loaded. */
bool lar_mpi_module(const char *name);

/* Starts MPI in this process, as everyone else of the world must, and waits for them (MPI_Init).
 * `wanted` is the MPI of the launcher, or NULL when it does not matter. */
lar_status lar_mpi_join(const char *wanted, lar_mpi_world **world, lar_error *error);

/* NULL when this process has not joined or has left. */
lar_mpi_world *lar_mpi_joined(void);

/* Everyone gives `bytes` bytes, everyone gets all of them in the order of ranks. */
lar_status lar_mpi_gather(lar_mpi_world *world, const void *own, size_t bytes, void *all,
                          double timeout, lar_error *error);

/* Waits for everyone and ends MPI. After a failure (`failed`) it waits for nobody and leaves MPI as
 * it is: the launcher ends a world whose processes end without that. Does nothing when not joined.
 */
lar_status lar_mpi_leave(bool failed, double timeout, lar_error *error);

bool lar_mpi_try(lar_mpi_world *world);
void lar_mpi_lock(lar_mpi_world *world);
void lar_mpi_unlock(lar_mpi_world *world);

#endif
