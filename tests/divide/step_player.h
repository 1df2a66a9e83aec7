/* Plays some steps of all processors and threads in a random order of events, with memory as the
 * engine has it: sums per thread, two halves of a receive buffer, tails.
 *
 * A force is a random number of 64 bits for element, node and step; so a sum that is right is right
 * for the right reason. What can happen to go wrong does so in some order: the witness against
 * which the proof is held.
 */
#ifndef LAR_TESTS_STEP_PLAYER_H
#define LAR_TESTS_STEP_PLAYER_H

#include "testing.h"

#include "divide/random.h"
#include "divide/schedule/schedule.h"

enum { PLAYED_STEPS = 4 };

/* What a thread does next: item `item` of part `part` of its batch. */
typedef struct play_thread {
    int32_t processor, thread, step, batch, part, item;
} play_thread;

typedef struct player {
    const lar_mesh *mesh;
    const lar_schedule_set *set;
    int32_t threads; /* of a processor */
    play_thread *at; /* [processors][threads] */
    uint64_t *sum;   /* [processors][threads][nodes] */
    int32_t *moved;  /* [processors][nodes] steps that a node has made */
    uint8_t **half;  /* [processors][2] receive buffers */
    const char *wrong;
} player;

static uint64_t played_force(int32_t step, int32_t e, int32_t node) {
    uint64_t x = (uint64_t)step << 58 ^ (uint64_t)e << 29 ^ (uint64_t)node;
    for (int i = 0; i < 3; i++) {
        x = (x ^ x >> 31) * 0x9e3779b97f4a7c15u;
        x ^= x >> 29;
    }
    return x;
}

static uint64_t *played_sum(player *p, int32_t processor, int32_t thread, int32_t node) {
    size_t row = (size_t)processor * (size_t)p->threads + (size_t)thread;
    return &p->sum[row * (size_t)p->mesh->node_count + (size_t)node];
}

static uint64_t played_total(player *p, int32_t processor, int32_t node, bool clear) {
    uint64_t total = 0;
    for (int32_t t = 0; t < p->threads; t++) {
        total += *played_sum(p, processor, t, node);
        if (clear) *played_sum(p, processor, t, node) = 0;
    }
    return total;
}

static void play_element(player *p, play_thread *at, int32_t e) {
    for (int a = 0; a < 8; a++) {
        int32_t k = p->mesh->element[e][a];
        *played_sum(p, at->processor, at->thread, k) += played_force(at->step, e, k);
        if (p->moved[(size_t)at->processor * (size_t)p->mesh->node_count + (size_t)k] != at->step)
            p->wrong = "an element is recovered from nodes of another step";
    }
}

static void play_position(player *p, play_thread *at, int32_t k) {
    uint64_t total = played_total(p, at->processor, k, true);
    for (int32_t e = 0; e < p->mesh->element_count; e++)
        for (int a = 0; a < 8; a++)
            if (p->mesh->element[e][a] == k) total -= played_force(at->step, e, k);
    if (total) p->wrong = "a node moves with a wrong sum";
    int32_t *moved = &p->moved[(size_t)at->processor * (size_t)p->mesh->node_count + (size_t)k];
    if (*moved != at->step) p->wrong = "a node moves twice";
    *moved = at->step + 1;
}

static void play_send(player *p, play_thread *at, const lar_transfer *t) {
    const lar_schedule *s = &p->set->of[at->processor];
    uint8_t *place = p->half[2 * t->peer + at->step % 2] + t->offset;
    uint64_t tail = (uint64_t)at->step + 1;
    for (int32_t i = 0; i < t->vectors.count; i++) {
        uint64_t total = played_total(p, at->processor, s->vector[t->vectors.first + i], false);
        memcpy(place + lar_packet_payload(i), &total, sizeof total);
    }
    memcpy(place + lar_packet_payload(t->vectors.count), &tail, sizeof tail);
}

static bool play_receive(player *p, play_thread *at, const lar_transfer *t) {
    const lar_schedule *s = &p->set->of[at->processor];
    const uint8_t *place = p->half[2 * at->processor + at->step % 2] + t->offset;
    uint64_t tail;
    memcpy(&tail, place + lar_packet_payload(t->vectors.count), sizeof tail);
    if (tail != (uint64_t)at->step + 1) return false;
    for (int32_t i = 0; i < t->vectors.count; i++) {
        int32_t k = s->vector[t->vectors.first + i];
        uint64_t value;
        memcpy(&value, place + lar_packet_payload(i), sizeof value);
        if (i >= t->vectors.count - t->whole) played_total(p, at->processor, k, true);
        *played_sum(p, at->processor, at->thread, k) += value;
    }
    return true;
}

static bool play_wait(player *p, play_thread *at, int32_t other) {
    const lar_schedule *s = &p->set->of[at->processor];
    for (int32_t u = 0; u < s->threads; u++) {
        const play_thread *them = &p->at[at->processor * p->threads + u];
        if (other < s->thread_first[u] || other >= s->thread_first[u + 1]) continue;
        return them->step > at->step || (them->step == at->step && them->batch > other);
    }
    return false;
}

/* One event of a thread. False when it cannot go on. */
static bool play_event(player *p, play_thread *at) {
    const lar_schedule *s = &p->set->of[at->processor];
    if (at->step == PLAYED_STEPS) return false;
    if (at->batch == s->thread_first[at->thread + 1]) {
        at->step++;
        at->batch = s->thread_first[at->thread];
        return true;
    }
    const lar_batch *b = &s->batch[at->batch];
    const lar_range span[5] = {b->elements, b->waits, b->receives, b->positions, b->sends};
    if (at->item == span[at->part].count) {
        at->item = 0;
        at->part = (at->part + 1) % 5;
        at->batch += at->part == 0;
        return true;
    }
    int32_t i = span[at->part].first + at->item;
    bool done = true;
    if (at->part == 0) play_element(p, at, s->element[i]);
    if (at->part == 1) done = play_wait(p, at, s->wait[i]);
    if (at->part == 2) done = play_receive(p, at, &s->transfer[i]);
    if (at->part == 3) play_position(p, at, s->node[i]);
    if (at->part == 4) play_send(p, at, &s->transfer[i]);
    at->item += done;
    return done;
}

/* Lets one thread after the other run for a while, so that some run far ahead. */
static void play_all(player *p, lar_random *random) {
    int32_t all = p->set->count * p->threads, stuck = 0;
    int32_t patience = 1 + lar_random_below(random, 60);
    while (!p->wrong && stuck < 40 * all) {
        play_thread *at = &p->at[lar_random_below(random, all)];
        int32_t events = 1 + lar_random_below(random, patience), i = 0;
        while (i < events && play_event(p, at)) i++;
        stuck = i ? 0 : stuck + 1;
    }
    /* By chance nobody who could go on was asked. */
    for (bool any = true; any && !p->wrong;) {
        any = false;
        for (int32_t i = 0; i < all; i++)
            while (!p->wrong && play_event(p, &p->at[i])) any = true;
    }
    for (int32_t i = 0; i < all && !p->wrong; i++)
        if (p->at[i].step < PLAYED_STEPS) p->wrong = "nobody can go on";
}

/* NULL, or what went wrong. The schedules must have passed the proof: nothing is checked here. */
static TEST_UNUSED const char *play_steps(const lar_mesh *mesh, const lar_schedule_set *set,
                                          uint64_t seed) {
    size_t processors = (size_t)set->count, threads = (size_t)set->of[0].threads;
    size_t nodes = (size_t)mesh->node_count;
    player p = {.mesh = mesh,
                .set = set,
                .threads = set->of[0].threads,
                .at = calloc(processors * threads, sizeof *p.at),
                .sum = calloc(processors * threads * nodes, sizeof *p.sum),
                .moved = calloc(processors * nodes, sizeof *p.moved),
                .half = calloc(2 * processors, sizeof *p.half)};
    for (size_t i = 0; i < 2 * processors; i++)
        p.half[i] = calloc((size_t)set->of[i / 2].receive_bytes + 1, 1);
    for (size_t i = 0; i < processors * threads; i++)
        p.at[i] = (play_thread){.processor = (int32_t)(i / threads),
                                .thread = (int32_t)(i % threads),
                                .batch = set->of[i / threads].thread_first[i % threads]};
    lar_random random = {seed};
    play_all(&p, &random);
    for (size_t i = 0; i < 2 * processors; i++) free(p.half[i]);
    free(p.at);
    free(p.sum);
    free(p.moved);
    free(p.half);
    return p.wrong;
}

#endif
