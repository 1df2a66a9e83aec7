/* One processor of a ring, for scripts that put processors where a test program cannot.
 *     comm_peer SELF COUNT BACKEND MASTER STEPS        STEPS 0: until something happens
 * Ends with 0 when all packets were right, 1 with a message otherwise, 77 without the backend. The
 * last line says when, in nanoseconds of the clock that `date` shows. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "comm/comm.h"

enum { WORDS = 53, SLOT = 512 };

static uint64_t word_of(int32_t from, uint64_t step, int i) {
    return ((uint64_t)from << 48) ^ (step << 8) ^ (uint64_t)i;
}

static lar_status exchange(lar_comm *comm, uint64_t step, lar_error *error) {
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    const int32_t neighbours[2] = {(self + 1) % count, (self + count - 1) % count};
    uint64_t words[WORDS];
    for (int i = 0; i < WORDS; i++) words[i] = word_of(self, step, i);
    for (int side = 0; side < 2; side++) {
        lar_status status = lar_comm_put(comm, neighbours[side], (size_t)side * SLOT, words,
                                         sizeof words, step, error);
        if (status) return status;
    }
    for (int side = 0; side < 2; side++) {
        const uint64_t *payload;
        int32_t from = neighbours[1 - side];
        lar_status status = lar_comm_wait(comm, from, (size_t)side * SLOT, sizeof words, step,
                                          (const void **)&payload, error);
        if (status) return status;
        for (int i = 0; i < WORDS; i++)
            if (payload[i] != word_of(from, step, i))
                return lar_fail(error, LAR_ERROR_FORMAT, "word %d of step %llu is wrong", i,
                                (unsigned long long)step);
    }
    return LAR_OK;
}

static lar_status live(const lar_comm_options *options, uint64_t steps, lar_error *error) {
    lar_comm *comm = NULL;
    lar_status status = lar_comm_open(options, &comm, error);
    if (!status) printf("processor %d has begun\n", (int)options->self);
    fflush(stdout);
    for (uint64_t step = 1; !status && (steps == 0 || step <= steps); step++)
        status = exchange(comm, step, error);
    lar_comm_close(comm);
    return status;
}

int main(int argc, char **argv) {
    if (argc != 6) return 2;
    lar_comm_options options = lar_comm_options_default();
    options.self = atoi(argv[1]);
    options.count = atoi(argv[2]);
    options.backend = argv[3];
    options.master = argv[4];
    options.receive_bytes = 2 * SLOT;
    lar_error error;
    lar_status status = live(&options, strtoull(argv[5], NULL, 10), &error);
    struct timespec at;
    clock_gettime(CLOCK_REALTIME, &at);
    if (status) printf("%s\n", error.message);
    printf("ended %lld\n", 1000000000LL * (long long)at.tv_sec + at.tv_nsec);
    return status == LAR_ERROR_UNSUPPORTED ? 77 : status ? 1 : 0;
}
