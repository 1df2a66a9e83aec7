/* The tail never overtakes its payload: packets of 200 bytes and more, every word checked, with
 * every backend. The argument is the number of packets (a million). */
#include "fleet.h"

enum { SLOTS = 8, WORDS_MIN = 25, WORDS_MAX = 64, SLOT_BYTES = 8 * WORDS_MAX + 64 };

static uint64_t packets = 1000000;

static size_t words_in(uint64_t slot) {
    return WORDS_MIN + slot * 39 / (SLOTS - 1);
}

static bool differs(const uint64_t *words, size_t count, uint64_t expected) {
    uint64_t wrong = 0;
    for (size_t i = 0; i < count; i++) wrong |= words[i] ^ (expected + i);
    return wrong != 0;
}

/* Two processors, eight packets in each direction of a step. */
static const char *exchange(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    lar_error error;
    uint64_t steps = *(const uint64_t *)context / (2 * SLOTS);
    int32_t peer = 1 - lar_comm_self(comm);
    for (uint64_t step = 1; step <= steps; step++) {
        for (uint64_t slot = 0; slot < SLOTS; slot++) {
            uint64_t words[WORDS_MAX];
            for (size_t i = 0; i < WORDS_MAX; i++) words[i] = (step << 16) + (slot << 8) + i;
            if (lar_comm_put(comm, peer, slot * SLOT_BYTES, words, 8 * words_in(slot), step,
                             &error))
                return fleet_say(text, "%s", error.message);
        }
        /* Last first: the tail that is polled is the one being written. */
        for (uint64_t slot = SLOTS; slot-- > 0;) {
            const void *payload;
            if (lar_comm_wait(comm, peer, slot * SLOT_BYTES, 8 * words_in(slot), step, &payload,
                              &error))
                return fleet_say(text, "%s", error.message);
            if (differs(payload, words_in(slot), (step << 16) + (slot << 8)))
                return fleet_say(text, "a torn packet in step %llu", (unsigned long long)step);
        }
    }
    return NULL;
}

static void no_packet_is_torn(void **state) {
    (void)state;
    fleet_everywhere(
        "torn packets",
        (fleet){.count = 2, .bytes = SLOTS * SLOT_BYTES, .body = exchange, .context = &packets});
}

int main(int argc, char **argv) {
    if (argc > 1) packets = strtoull(argv[1], NULL, 10);
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_packet_is_torn)};
    return fleet_end(cmocka_run_group_tests(tests, NULL, NULL));
}
