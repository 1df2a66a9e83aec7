#include "comm/mpi_world.h"

#include <dlfcn.h>
#include <limits.h>
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "comm/backend.h"

static pthread_mutex_t joining = PTHREAD_MUTEX_INITIALIZER;
static lar_mpi_world only;
static enum { OUTSIDE, INSIDE, LEFT } where; /* guarded by `joining` */

/* ---- the lock ------------------------------------------------------------------------------- */

static bool take(lar_mpi_world *world) {
    return !__atomic_exchange_n(&world->busy, 1, __ATOMIC_ACQUIRE);
}

bool lar_mpi_try(lar_mpi_world *world) {
    if (__atomic_load_n(&world->senders, __ATOMIC_RELAXED)) return false;
    return !__atomic_load_n(&world->busy, __ATOMIC_RELAXED) && take(world);
}

void lar_mpi_lock(lar_mpi_world *world) {
    if (take(world)) return;
    __atomic_fetch_add(&world->senders, 1, __ATOMIC_RELAXED);
    while (!take(world)) sched_yield();
    __atomic_fetch_sub(&world->senders, 1, __ATOMIC_RELAXED);
}

void lar_mpi_unlock(lar_mpi_world *world) {
    __atomic_store_n(&world->busy, 0, __ATOMIC_RELEASE);
}

/* ---- finding the module --------------------------------------------------------------------- */

enum { PATH_BYTES = PATH_MAX };

/* "folder of `file`/inner/liblariat-mpi-NAME.so" when such a file can be read. */
static bool beside(const char *file, const char *inner, const char *name, char path[PATH_BYTES]) {
    const char *slash = strrchr(file, '/');
    if (!slash) return false;
    int length = snprintf(path, PATH_BYTES, "%.*s/%sliblariat-mpi-%s.so", (int)(slash - file), file,
                          inner, name);
    return length < PATH_BYTES && access(path, R_OK) == 0;
}

static bool find_module(const char *name, char path[PATH_BYTES]) {
    char command[PATH_BYTES] = "";
    ssize_t length = readlink("/proc/self/exe", command, sizeof command - 1);
    command[length > 0 ? length : 0] = '\0';
    Dl_info here;
    bool known = dladdr(&only, &here) != 0 && here.dli_fname;
    return (known && beside(here.dli_fname, "", name, path)) || beside(command, "", name, path) ||
           beside(command, LAR_MPI_FROM_BIN "/", name, path);
}

bool lar_mpi_module(const char *name) {
    char path[PATH_BYTES];
    return find_module(name, path);
}

static lar_status no_module(const char *name, lar_error *error) {
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "several processes were started together by %s, and the module "
                    "liblariat-mpi-%s.so, which brings them together, is not there; install "
                    "lib%s-dev and build Lariat again, or set LARIAT_MPI to the module's path",
                    name ? name : "a launcher", name ? name : "(openmpi or mpich)",
                    name ? name : "openmpi-dev or libmpich");
}

static lar_status choose_module(const char *wanted, char path[PATH_BYTES], lar_error *error) {
    static const char *const names[] = {"openmpi", "mpich"};
    const char *said = getenv("LARIAT_MPI");
    if (said && strchr(said, '/')) {
        if (snprintf(path, PATH_BYTES, "%s", said) < PATH_BYTES && access(path, R_OK) == 0)
            return LAR_OK;
        return lar_fail(error, LAR_ERROR_IO,
                        "LARIAT_MPI names the module %s, which cannot be read; correct the path",
                        said);
    }
    if (said && *said) wanted = said;
    if (wanted) return find_module(wanted, path) ? LAR_OK : no_module(wanted, error);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (find_module(names[i], path)) return LAR_OK;
    return no_module(NULL, error);
}

/* Symbols global: plugins of Open MPI look for those of its library. Never unloaded: threads and
 * handlers of MPI may outlive its end. */
static lar_status load_module(const char *path, const lar_mpi **mpi, lar_error *error) {
    void *module = dlopen(path, RTLD_NOW | RTLD_GLOBAL);
    if (!module)
        return lar_fail(
            error, LAR_ERROR_IO,
            "the module for MPI cannot be loaded: %s; install that MPI, or build Lariat "
            "again with the one that is there",
            dlerror());
    const lar_mpi *table = dlsym(module, LAR_MPI_SYMBOL);
    if (!table || table->version != LAR_MPI_VERSION)
        return lar_fail(error, LAR_ERROR_IO,
                        "%s belongs to another version of Lariat; build and install both together",
                        path);
    *mpi = table;
    return LAR_OK;
}

/* ---- joining and leaving -------------------------------------------------------------------- */

static lar_status complain(const lar_mpi *mpi, int code, const char *what, lar_error *error) {
    char words[256];
    mpi->describe(code, words, sizeof words);
    return lar_fail(error, LAR_ERROR_PEER, "%s could not %s: %s; see what mpirun or srun says",
                    mpi->name, what, words);
}

static lar_status join(const char *wanted, lar_error *error) {
    char path[PATH_BYTES];
    const lar_mpi *mpi = NULL;
    if (where == INSIDE || (where == LEFT && only.size == 1)) return LAR_OK;
    if (where == LEFT)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "this process has left MPI, which can be joined once only; start all "
                        "processors again");
    lar_status status = choose_module(wanted, path, error);
    if (!status) status = load_module(path, &mpi, error);
    if (status) return status;
    lar_mpi_world world = {.mpi = mpi};
    int failed = mpi->start(&world.rank, &world.size, &world.tag_max);
    if (failed) return complain(mpi, failed, "start", error);
    only = world;
    where = INSIDE;
    return LAR_OK;
}

lar_status lar_mpi_join(const char *wanted, lar_mpi_world **world, lar_error *error) {
    pthread_mutex_lock(&joining);
    lar_status status = join(wanted, error);
    pthread_mutex_unlock(&joining);
    if (!status) *world = &only;
    return status;
}

lar_mpi_world *lar_mpi_joined(void) {
    pthread_mutex_lock(&joining);
    bool inside = where == INSIDE;
    pthread_mutex_unlock(&joining);
    return inside ? &only : NULL;
}

/* For start and end; sleeps, so that processors that share a core get on. */
static lar_status finish(lar_mpi_world *world, lar_mpi_request *request, const char *what,
                         double timeout, lar_error *error) {
    double deadline = lar_comm_now() + timeout;
    for (int polls = 0;; polls++) {
        bool done = false;
        lar_mpi_lock(world);
        int failed = world->mpi->test(request, &done);
        lar_mpi_unlock(world);
        if (failed) return complain(world->mpi, failed, what, error);
        if (done) return LAR_OK;
        if (lar_comm_now() > deadline)
            return lar_fail(error, LAR_ERROR_PEER,
                            "the processors did not come together within %g s to %s; see what the "
                            "others say and start all again",
                            timeout, what);
        nanosleep(&(struct timespec){.tv_nsec = polls < 100 ? 0 : 200000}, NULL);
    }
}

lar_status lar_mpi_gather(lar_mpi_world *world, const void *own, size_t bytes, void *all,
                          double timeout, lar_error *error) {
    static const char what[] = "exchange their addresses";
    lar_mpi_request request;
    lar_mpi_lock(world);
    int failed = world->mpi->gather(own, (int)bytes, all, &request);
    lar_mpi_unlock(world);
    if (failed) return complain(world->mpi, failed, what, error);
    return finish(world, &request, what, timeout, error);
}

/* MPI_Finalize waits without limit; after a barrier it has nobody to wait for. */
static lar_status leave(double timeout, lar_error *error) {
    static const char what[] = "leave";
    lar_mpi_request request;
    lar_mpi_lock(&only);
    int failed = only.mpi->barrier(&request);
    lar_mpi_unlock(&only);
    if (failed) return complain(only.mpi, failed, what, error);
    lar_status status = finish(&only, &request, what, timeout, error);
    if (status) return status;
    failed = only.mpi->end();
    return failed ? complain(only.mpi, failed, what, error) : LAR_OK;
}

lar_status lar_mpi_leave(bool failed, double timeout, lar_error *error) {
    if (!lar_mpi_joined()) return LAR_OK;
    lar_status status = failed ? LAR_OK : leave(timeout, error);
    pthread_mutex_lock(&joining);
    where = LEFT;
    pthread_mutex_unlock(&joining);
    return status;
}
