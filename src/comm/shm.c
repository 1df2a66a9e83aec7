/* Processors that are processes of one machine: POSIX shared memory, mapped by every peer.
 *
 * Names live only from open to begin: as soon as all have mapped all, each unlinks its own, and
 * the memory goes with the last process, however that ends. What a crash during start-up leaves
 * is removed by the others when they give up, or by the next start: a living owner holds a lock on
 * its object, so an object whose lock can be had belongs to nobody. Process numbers would not do:
 * they return, and differ between containers that share /dev/shm.
 */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "comm/backend.h"

enum { NAME_BYTES = 64 };
static const char PREFIX[] = "lariat-comm-";

typedef struct shm_state {
    char name[NAME_BYTES]; /* "" after begin */
    int object;            /* locked while the name stands */
    size_t *mapped;        /* [count] bytes */
    unsigned char **maps;  /* [count] */
} shm_state;

/* Removes objects without a living owner. A folder that is not there (other systems) is no
 * matter. */
static void remove_leftovers(void) {
    DIR *folder = opendir("/dev/shm");
    if (!folder) return;
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (strncmp(entry->d_name, PREFIX, sizeof PREFIX - 1) != 0) continue;
        char name[300];
        snprintf(name, sizeof name, "/%s", entry->d_name);
        int object = shm_open(name, O_RDWR, 0);
        if (object < 0) continue;
        if (flock(object, LOCK_EX | LOCK_NB) == 0) shm_unlink(name);
        close(object);
    }
    closedir(folder);
}

/* Makes and locks an object. Between the two another start may take it for a leftover: then its
 * link count is 0, and the next name is tried. */
static int make_object(shm_state *state, int32_t self) {
    for (int attempt = 0; attempt < 100; attempt++) {
        uint64_t nonce = 0;
        if (getrandom(&nonce, sizeof nonce, 0) != sizeof nonce) return -1;
        snprintf(state->name, sizeof state->name, "/%s%d-%016llx", PREFIX, (int)self,
                 (unsigned long long)nonce);
        int object = shm_open(state->name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
        if (object < 0) {
            if (errno == EEXIST) continue;
            break;
        }
        struct stat status;
        if (flock(object, LOCK_EX | LOCK_NB) == 0 && fstat(object, &status) == 0 &&
            status.st_nlink > 0)
            return object;
        close(object);
        shm_unlink(state->name);
    }
    state->name[0] = '\0';
    return -1;
}

static lar_status shm_start(lar_comm *comm, lar_error *error) {
    shm_state *state = comm->state = lar_calloc(1, sizeof *state);
    size_t count = (size_t)comm->options.count, bytes = 2 * comm->options.receive_bytes;
    if (bytes == 0) bytes = 8;
    if (!state) return lar_fail_memory(error, sizeof *state, "shared memory");
    state->object = -1;
    state->mapped = lar_calloc(count, sizeof *state->mapped);
    state->maps = lar_calloc(count, sizeof *state->maps);
    if (!state->mapped || !state->maps)
        return lar_fail_memory(error, count * 16, "shared memory of processors");
    remove_leftovers();
    state->object = make_object(state, comm->options.self);
    /* Room is taken now: what is only promised would end the process at its first use. */
    int refused = state->object < 0 ? errno : posix_fallocate(state->object, 0, (off_t)bytes);
    void *map = MAP_FAILED;
    if (!refused) {
        map = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, state->object, 0);
        if (map == MAP_FAILED) refused = errno;
    }
    if (refused)
        return lar_fail(error, LAR_ERROR_IO,
                        "%zu bytes of shared memory for processor %d could not be had: %s; %s or "
                        "use the backend tcp",
                        bytes, (int)comm->options.self, strerror(refused),
                        lar_remedy(refused, "make room in /dev/shm"));
    comm->receive = state->maps[comm->options.self] = map;
    state->mapped[comm->options.self] = bytes;
    lar_comm_address *own = &comm->addresses[comm->options.self];
    own->bytes = NAME_BYTES;
    memcpy(own->data, state->name, NAME_BYTES);
    return LAR_OK;
}

static lar_status map_peer(lar_comm *comm, int32_t p, lar_error *error) {
    shm_state *state = comm->state;
    lar_comm_address *address = &comm->addresses[p];
    size_t bytes = 2 * (size_t)address->receive_bytes;
    if (bytes == 0) bytes = 8;
    address->data[NAME_BYTES - 1] = '\0';
    int object = shm_open((const char *)address->data, O_RDWR | O_CLOEXEC, 0);
    struct stat status;
    void *map = MAP_FAILED;
    if (object >= 0 && fstat(object, &status) == 0 && (uint64_t)status.st_size >= bytes)
        map = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, object, 0);
    int reason = errno;
    if (object >= 0) close(object);
    if (map == MAP_FAILED)
        return lar_fail(error, LAR_ERROR_IO,
                        "processor %d cannot map the shared memory of processor %d: %s; %s, or use "
                        "the backend tcp",
                        (int)comm->options.self, (int)p, strerror(reason),
                        lar_remedy(reason, "start all on one machine"));
    comm->peers[p].direct = state->maps[p] = map;
    state->mapped[p] = bytes;
    return LAR_OK;
}

static lar_status shm_connect(lar_comm *comm, lar_error *error) {
    lar_status status = LAR_OK;
    for (int32_t p = 0; p < comm->options.count && !status; p++)
        if (p != comm->options.self) status = map_peer(comm, p, error);
    return status;
}

static void shm_begin(lar_comm *comm) {
    shm_state *state = comm->state;
    if (state->name[0]) shm_unlink(state->name);
    if (state->object >= 0) close(state->object);
    state->name[0] = '\0';
    state->object = -1;
}

/* A start that failed, or somebody who died just after it: names of the dead go as well. */
static void remove_names(lar_comm *comm) {
    for (int32_t p = 0; p < comm->options.count; p++) {
        lar_comm_address *address = &comm->addresses[p];
        address->data[NAME_BYTES - 1] = '\0';
        const char *name = (const char *)address->data;
        if (name[0] == '/' && strncmp(name + 1, PREFIX, sizeof PREFIX - 1) == 0) shm_unlink(name);
    }
    remove_leftovers();
}

static void shm_close(lar_comm *comm) {
    shm_state *state = comm->state;
    if (!state) return;
    if (comm->forked) state->name[0] = '\0'; /* not ours to remove */
    bool lost = __atomic_load_n(comm->verdict, __ATOMIC_ACQUIRE) && !comm->forked;
    if (state->name[0] || lost) remove_names(comm);
    shm_begin(comm);
    for (int32_t p = 0; state->maps && state->mapped && p < comm->options.count; p++)
        if (state->maps[p]) munmap(state->maps[p], state->mapped[p]);
    free(state->maps);
    free(state->mapped);
    free(state);
}

const lar_comm_backend lar_comm_shm = {.name = "shm",
                                       .summary = "processes on one machine, shared memory",
                                       .polls = 50,
                                       .open = shm_start,
                                       .connect = shm_connect,
                                       .begin = shm_begin,
                                       .close = shm_close};
