/* Several threads of a processor put and wait at the same time, each on its own packets. */
#include "fleet.h"

enum { THREADS = 3, WORDS = 40, SLOT = 512, STEPS = 1000 };

typedef struct worker {
    lar_comm *comm;
    uint64_t number;
    pthread_t thread;
    const char *wrong;
    char text[FLEET_TEXT];
} worker;

static uint64_t word_of(uint64_t from, uint64_t number, uint64_t step, uint64_t i) {
    return from << 48 ^ number << 40 ^ step << 16 ^ i;
}

/* An exchange with every other processor; more words from higher numbers. */
static const char *exchange(worker *w) {
    lar_error error;
    int32_t count = lar_comm_count(w->comm), self = lar_comm_self(w->comm);
    size_t bytes = 8 * (WORDS + w->number);
    for (uint64_t step = 1; step <= STEPS; step++) {
        for (int32_t p = 0; p < count; p++) {
            uint64_t words[WORDS + THREADS];
            size_t offset = SLOT * (THREADS * (size_t)self + w->number);
            for (size_t i = 0; 8 * i < bytes; i++)
                words[i] = word_of((uint64_t)self, w->number, step, i);
            if (p != self && lar_comm_put(w->comm, p, offset, words, bytes, step, &error))
                return fleet_say(w->text, "%s", error.message);
        }
        for (int32_t p = 0; p < count; p++) {
            const void *payload;
            size_t offset = SLOT * (THREADS * (size_t)p + w->number);
            if (p == self) continue;
            if (lar_comm_wait(w->comm, p, offset, bytes, step, &payload, &error))
                return fleet_say(w->text, "%s", error.message);
            for (size_t i = 0; 8 * i < bytes; i++)
                if (((const uint64_t *)payload)[i] != word_of((uint64_t)p, w->number, step, i))
                    return fleet_say(w->text, "thread %d, step %d, word %zu of processor %d",
                                     (int)w->number, (int)step, i, (int)p);
        }
    }
    return NULL;
}

static void *work(void *context) {
    worker *w = context;
    w->wrong = exchange(w);
    return NULL;
}

static const char *threads(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context;
    worker workers[THREADS];
    const char *wrong = NULL;
    for (int i = 0; i < THREADS; i++) {
        workers[i] = (worker){.comm = comm, .number = (uint64_t)i};
        if (pthread_create(&workers[i].thread, NULL, work, &workers[i])) return "no thread";
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(workers[i].thread, NULL);
        if (workers[i].wrong) wrong = fleet_say(text, "%s", workers[i].wrong);
    }
    return wrong;
}

static void threads_do_not_disturb_each_other(void **state) {
    (void)state;
    fleet_everywhere("threads", (fleet){.count = 3, .bytes = 3 * THREADS * SLOT, .body = threads});
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(threads_do_not_disturb_each_other)};
    return fleet_end(cmocka_run_group_tests(tests, NULL, NULL));
}
