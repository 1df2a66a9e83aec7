/* Compiled once for every MPI that the build finds (cmake/LariatMpi.cmake). */
#include "comm/mpi_shim.h"

#include <mpi.h>
#include <stdio.h>
#include <string.h>

_Static_assert(sizeof(MPI_Request) <= sizeof(lar_mpi_request), "a request does not fit");

static MPI_Comm world = MPI_COMM_NULL;
static bool started_here;

static MPI_Request load(const lar_mpi_request *r) {
    MPI_Request request;
    memcpy(&request, r, sizeof request);
    return request;
}

static int keep(lar_mpi_request *r, MPI_Request request, int failed) {
    memcpy(r, &request, sizeof request);
    return failed;
}

static int start(int *rank, int *size, int *tag_max) {
    int there = 0, level = MPI_THREAD_SINGLE, *max = NULL, found = 0;
    int failed = MPI_Initialized(&there);
    if (!failed && !there) failed = MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &level);
    if (failed) return failed;
    started_here = !there;
    /* Messages of the program that embeds us stay apart; a failure comes back as a number. */
    failed = MPI_Query_thread(&level);
    if (!failed && level < MPI_THREAD_SERIALIZED) failed = MPI_ERR_UNSUPPORTED_OPERATION;
    if (!failed) failed = MPI_Comm_dup(MPI_COMM_WORLD, &world);
    if (!failed) failed = MPI_Comm_set_errhandler(world, MPI_ERRORS_RETURN);
    if (!failed) failed = MPI_Comm_rank(world, rank);
    if (!failed) failed = MPI_Comm_size(world, size);
    if (!failed) failed = MPI_Comm_get_attr(MPI_COMM_WORLD, MPI_TAG_UB, (void *)&max, &found);
    *tag_max = !failed && found ? *max : 32767; /* what the standard promises */
    return failed;
}

static int send(const void *data, int bytes, int to, int tag, lar_mpi_request *r) {
    MPI_Request request = MPI_REQUEST_NULL;
    int failed = MPI_Isend(data, bytes, MPI_BYTE, to, tag, world, &request);
    return keep(r, request, failed);
}

static int receive(void *data, int bytes, int tag, lar_mpi_request *r) {
    MPI_Request request = MPI_REQUEST_NULL;
    int failed = MPI_Irecv(data, bytes, MPI_BYTE, MPI_ANY_SOURCE, tag, world, &request);
    return keep(r, request, failed);
}

static int test(lar_mpi_request *r, bool *done) {
    MPI_Request request = load(r);
    int flag = 0;
    int failed = MPI_Test(&request, &flag, MPI_STATUS_IGNORE);
    *done = flag != 0;
    return keep(r, request, failed);
}

static void cancel(lar_mpi_request *r) {
    MPI_Request request = load(r);
    if (request == MPI_REQUEST_NULL) return;
    MPI_Cancel(&request);
    MPI_Wait(&request, MPI_STATUS_IGNORE); /* of a cancelled receive: depends on nobody */
    keep(r, request, 0);
}

static int gather(const void *own, int bytes, void *all, lar_mpi_request *r) {
    MPI_Request request = MPI_REQUEST_NULL;
    int failed = MPI_Iallgather(own, bytes, MPI_BYTE, all, bytes, MPI_BYTE, world, &request);
    return keep(r, request, failed);
}

static int barrier(lar_mpi_request *r) {
    MPI_Request request = MPI_REQUEST_NULL;
    int failed = MPI_Ibarrier(world, &request);
    return keep(r, request, failed);
}

static int end(void) {
    int failed = MPI_Comm_free(&world);
    if (!failed && started_here) failed = MPI_Finalize();
    return failed;
}

static void describe(int code, char *text, size_t bytes) {
    char words[MPI_MAX_ERROR_STRING] = "";
    int length = 0;
    if (MPI_Error_string(code, words, &length)) words[0] = '\0';
    words[strcspn(words, "\n")] = '\0';
    snprintf(text, bytes, "%s", words[0] ? words : "an unknown error");
}

#if defined(OPEN_MPI)
#define TEXT_OF(x)    #x
#define VALUE_TEXT(x) TEXT_OF(x)
#define NAME                                                                                       \
    "Open MPI " VALUE_TEXT(OMPI_MAJOR_VERSION) "." VALUE_TEXT(OMPI_MINOR_VERSION) "." VALUE_TEXT(  \
        OMPI_RELEASE_VERSION)
#elif defined(MPICH_VERSION)
#define NAME "MPICH " MPICH_VERSION
#else
#define NAME "MPI"
#endif

extern const lar_mpi lar_mpi_table;
__attribute__((visibility("default"))) const lar_mpi lar_mpi_table = {.version = LAR_MPI_VERSION,
                                                                      .name = NAME,
                                                                      .start = start,
                                                                      .send = send,
                                                                      .receive = receive,
                                                                      .test = test,
                                                                      .cancel = cancel,
                                                                      .gather = gather,
                                                                      .barrier = barrier,
                                                                      .end = end,
                                                                      .describe = describe};
