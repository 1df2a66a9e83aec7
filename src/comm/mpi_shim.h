/* What Lariat needs of MPI, as a table that a loadable module fills.
 *
 *     liblariat, lariat  --dlopen-->  liblariat-mpi-openmpi.so  --linked-->  libmpi of Open MPI
 *      (no MPI inside)          or    liblariat-mpi-mpich.so    --linked-->  libmpi of MPICH
 *
 * The implementations of MPI do not agree on a binary interface, and which one is right is known
 * only when a launcher has started the program. So mpi_shim.c is compiled once for each that the
 * build finds, and mpi_world.h loads the one of the launcher.
 *
 * Functions return 0 or an error of MPI, which `describe` puts into words. They never wait, but
 * for start and end. One thread at a time (mpi_world.h has the lock).
 */
#ifndef LAR_COMM_MPI_SHIM_H
#define LAR_COMM_MPI_SHIM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Changes with every change of the table. */
enum { LAR_MPI_VERSION = 2 };

/* An MPI_Request: an int in MPICH, a pointer in Open MPI. */
typedef struct lar_mpi_request {
    uint64_t word;
} lar_mpi_request;

typedef struct lar_mpi {
    int version;
    const char *name; /* "Open MPI 4.1.4" */
    /* Starts MPI unless the program has done so. *tag_max: tags are 0..*tag_max. */
    int (*start)(int *rank, int *size, int *tag_max);
    int (*send)(const void *data, int bytes, int to, int tag, lar_mpi_request *r);
    int (*receive)(void *data, int bytes, int tag, lar_mpi_request *r); /* from anyone */
    int (*test)(lar_mpi_request *r, bool *done);
    void (*cancel)(lar_mpi_request *r); /* of a receive */
    int (*gather)(const void *own, int bytes, void *all, lar_mpi_request *r);
    int (*barrier)(lar_mpi_request *r);
    int (*end)(void); /* after a barrier; ends MPI where start started it */
    void (*describe)(int code, char *text, size_t bytes);
} lar_mpi;

/* The symbol that a module exports. */
#define LAR_MPI_SYMBOL "lar_mpi_table"

#endif
