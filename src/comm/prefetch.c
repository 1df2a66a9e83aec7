/* Fetching cache lines before they are needed: a line that another core has written or read
 * last takes some 0.1 us to come, and packets have dozens of them. */
#include "comm/backend.h"

enum { LINE = 64 };

static inline void fetch_for_writing(const unsigned char *line) {
#if defined(__x86_64__)
    /* The compiler's builtin asks for a copy to read on processors it knows nothing about. */
    __asm__ volatile("prefetchw %0" : : "m"(*line));
#else
    __builtin_prefetch(line, 1);
#endif
}

void lar_comm_prepare(lar_comm *comm, int32_t peer, size_t offset, size_t bytes, uint64_t step) {
    const lar_comm_peer *to = &comm->peers[peer];
    if (!to->direct) return;
    const unsigned char *first = to->direct + (step & 1 ? to->half : 0) + offset;
    for (size_t at = 0; at < bytes; at += LINE) fetch_for_writing(first + at);
}

bool lar_comm_expect(lar_comm *comm, size_t offset, size_t bytes, uint64_t step) {
    size_t half = comm->options.receive_bytes;
    return __atomic_load_n(lar_comm_tail(comm->receive, half, offset, bytes, step),
                           __ATOMIC_ACQUIRE) == step;
}

void lar_comm_fetch(lar_comm *comm, size_t offset, size_t bytes, uint64_t step) {
    const unsigned char *first =
        comm->receive + (step & 1 ? comm->options.receive_bytes : 0) + offset;
    for (size_t at = 0; at < bytes; at += LINE) __builtin_prefetch(first + at);
}
