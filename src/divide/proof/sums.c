/* Every node moves with the forces of exactly its elements.
 *
 * Per node, the forces of one processor's elements go everywhere together: they are one part (all
 * of them are recovered before the first send, races.c). have[p][q] counts how often p has
 * the part of q; stage after stage, parts travel:
 *
 *     added    have[to] += have[from] before the stage
 *     whole    have[to]  = have[from] before the stage
 *
 * and in the end everybody must have every part once. A part is exactly the elements that q
 * recovers at the node, each once (shape.c), and that is E_k.
 */
#include <stdlib.h>
#include <string.h>

#include "divide/cost.h"
#include "divide/proof/proof.h"

typedef struct vector {
    int32_t from, to, stage;
    bool whole;
} vector;

typedef struct play {
    const lar_proof *proof;
    int64_t *first; /* [nodes + 2] of a node's vectors */
    vector *vector; /* of all packets, by node */
    int32_t *set;   /* [incidence->max] processors of a node */
    int32_t *place; /* [processors] place of a processor in the set */
    int32_t *have;  /* [|P_k|][|P_k|], and before the stage */
} play;

/* Counts beyond it are wrong anyway, and must not overflow. */
enum { MANY = 1 << 20 };

static lar_status list_vectors(play *p, lar_error *error) {
    const lar_proof *proof = p->proof;
    int64_t *start = p->first + 1;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t i = 0; i < proof->packet_count; i++) {
            const lar_proof_packet *packet = &proof->packet[i];
            const lar_schedule *from = &proof->set->of[packet->from];
            const lar_transfer *t = &from->transfer[packet->send];
            for (int32_t j = 0; j < t->vectors.count; j++) {
                int32_t k = from->vector[t->vectors.first + j];
                if (pass == 0)
                    start[k + 1]++;
                else
                    p->vector[start[k]++] = (vector){packet->from, packet->to, packet->stage,
                                                     j >= t->vectors.count - t->whole};
            }
        }
        if (pass) break;
        for (int32_t k = 0; k < proof->mesh->node_count; k++) start[k + 1] += start[k];
        size_t count = (size_t)start[proof->mesh->node_count];
        p->vector = lar_calloc(count, sizeof *p->vector);
        if (!p->vector) return lar_fail_memory(error, count * sizeof *p->vector, "vectors");
    }
    return LAR_OK;
}

static void play_stage(const play *p, int32_t k, int32_t count, int32_t stage) {
    size_t n = (size_t)count;
    int32_t *before = p->have + n * n;
    memcpy(before, p->have, n * n * sizeof *before);
    for (int64_t i = p->first[k]; i < p->first[k + 1]; i++) {
        const vector *v = &p->vector[i];
        if (v->stage != stage) continue;
        const int32_t *from = before + n * (size_t)p->place[v->from];
        int32_t *to = p->have + n * (size_t)p->place[v->to];
        for (size_t q = 0; q < n; q++) {
            to[q] = v->whole ? from[q] : to[q] + from[q];
            if (to[q] > MANY) to[q] = MANY;
        }
    }
}

static lar_status refuse(const play *p, int32_t k, int32_t at, int32_t part, int32_t times,
                         lar_error *error) {
    const lar_incidence *in = p->proof->incidence;
    int64_t i = in->first[k];
    while (p->proof->owner[in->element[i]] != part) i++;
    if (times == 0)
        return LAR_DISPROVE(error,
                            "processor %d moves node %d without the force of element %d, which "
                            "processor %d recovers",
                            at, k, in->element[i], part);
    return LAR_DISPROVE(error,
                        "processor %d moves node %d with %d times the force of element %d, which "
                        "processor %d recovers",
                        at, k, times, in->element[i], part);
}

static lar_status play_node(const play *p, int32_t k, int32_t count, lar_error *error) {
    size_t n = (size_t)count;
    memset(p->have, 0, n * n * sizeof *p->have);
    for (int32_t i = 0; i < count; i++) {
        p->place[p->set[i]] = i;
        p->have[n * (size_t)i + (size_t)i] = 1;
    }
    for (int32_t stage = 0; stage < LAR_STAGES; stage++) play_stage(p, k, count, stage);
    for (int32_t i = 0; i < count; i++)
        for (int32_t j = 0; j < count; j++) {
            int32_t times = p->have[n * (size_t)i + (size_t)j];
            if (times != 1) return refuse(p, k, p->set[i], p->set[j], times, error);
        }
    return LAR_OK;
}

lar_status lar_proof_sums(lar_proof *proof, int64_t *sums, lar_error *error) {
    const lar_incidence *in = proof->incidence;
    size_t nodes = (size_t)proof->mesh->node_count, processors = (size_t)proof->set->count;
    size_t max = (size_t)in->max < processors ? (size_t)in->max : processors;
    play p = {.proof = proof,
              .first = lar_calloc(nodes + 2, sizeof *p.first),
              .set = lar_calloc((size_t)in->max + 1, sizeof *p.set),
              .place = lar_calloc(processors, sizeof *p.place),
              .have = lar_calloc(2 * max * max, sizeof *p.have)};
    lar_status status = p.first && p.set && p.place && p.have
                            ? list_vectors(&p, error)
                            : lar_fail_memory(error, 8 * nodes, "sums of nodes");
    *sums = 0;
    for (int32_t k = 0; !status && k < proof->mesh->node_count; k++) {
        int32_t count = lar_node_processors(in, proof->owner, k, p.set);
        *sums += count;
        if (count > 1) status = play_node(&p, k, count, error);
    }
    free(p.first);
    free(p.vector);
    free(p.set);
    free(p.place);
    free(p.have);
    return status;
}
