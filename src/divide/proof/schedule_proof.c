#include "divide/proof/schedule_proof.h"

#include <stdlib.h>

#include "divide/proof/proof.h"

/* ---- how far apart ----------------------------------------------------------------------- */

/* Who exchanges with whom: both directions, since only they hold two processors together. */
static int32_t list_peers(const lar_schedule_set *set, uint8_t *sends, int32_t *first,
                          int32_t *peer) {
    size_t n = (size_t)set->count;
    for (int32_t p = 0; p < set->count; p++)
        for (int32_t b = 0; b < set->of[p].batch_count; b++) {
            const lar_batch *batch = &set->of[p].batch[b];
            for (int32_t i = 0; i < batch->sends.count; i++) {
                int32_t q = set->of[p].transfer[batch->sends.first + i].peer;
                if (q >= 0 && q < set->count && q != p) sends[(size_t)p * n + (size_t)q] = 1;
            }
        }
    int32_t count = 0;
    for (size_t p = 0; p < n; p++) {
        for (size_t q = 0; q < n; q++)
            if (sends[p * n + q] && sends[q * n + p]) peer[count++] = (int32_t)q;
        first[p + 1] = count;
    }
    return count;
}

/* Breadth first from one processor. */
static void measure_from(int32_t start, int32_t count, const int32_t *first, const int32_t *peer,
                         int32_t *queue, int32_t *distance) {
    for (int32_t p = 0; p < count; p++) distance[p] = -1;
    int32_t reached = 0;
    distance[start] = 0;
    queue[reached++] = start;
    for (int32_t i = 0; i < reached && reached < count; i++)
        for (int32_t j = first[queue[i]]; j < first[queue[i] + 1]; j++)
            if (distance[peer[j]] < 0) {
                distance[peer[j]] = distance[queue[i]] + 1;
                queue[reached++] = peer[j];
            }
}

int32_t *lar_schedule_distances(const lar_schedule_set *set) {
    size_t n = (size_t)set->count;
    uint8_t *sends = lar_calloc(n * n, sizeof *sends);
    int32_t *first = lar_calloc(n + 1, sizeof *first), *peer = lar_calloc(n * n, sizeof *peer);
    int32_t *queue = lar_calloc(n, sizeof *queue), *distance = lar_calloc(n * n, sizeof *distance);
    bool good = sends && first && peer && queue && distance;
    if (good) {
        list_peers(set, sends, first, peer);
        for (int32_t p = 0; p < set->count; p++)
            measure_from(p, set->count, first, peer, queue, distance + (size_t)p * n);
    } else {
        free(distance);
        distance = NULL;
    }
    free(sends);
    free(first);
    free(peer);
    free(queue);
    return distance;
}

static lar_status measure_spread(const lar_schedule_set *set, int32_t *spread, lar_error *error) {
    size_t pairs = (size_t)set->count * (size_t)set->count;
    int32_t *distance = lar_schedule_distances(set);
    if (!distance) return lar_fail_memory(error, 4 * pairs, "distances of processors");
    *spread = 0;
    for (size_t i = 0; i < pairs && *spread >= 0; i++)
        *spread = distance[i] < 0 ? -1 : distance[i] > *spread ? distance[i] : *spread;
    free(distance);
    return LAR_OK;
}

/* ---- the proof --------------------------------------------------------------------------- */

static void count_all(const lar_schedule_set *set, const lar_mesh *mesh, lar_schedule_proof *out) {
    int64_t max = (mesh->element_count + (int64_t)set->count - 1) / set->count; /* eq. 6.7 */
    out->balanced = true;
    for (int32_t p = 0; p < set->count; p++) {
        const lar_schedule *s = &set->of[p];
        out->balanced &= s->element_count <= max;
        out->batches += s->batch_count;
        for (int32_t b = 0; b < s->batch_count; b++) {
            const lar_batch *batch = &s->batch[b];
            out->waits += batch->waits.count;
            for (int32_t i = 0; i < batch->sends.count; i++) {
                int32_t vectors = s->transfer[batch->sends.first + i].vectors.count;
                *(vectors ? &out->packets : &out->empty_packets) += 1;
                out->vectors += vectors;
            }
        }
    }
}

lar_status lar_schedule_prove(const lar_mesh *mesh, const lar_incidence *incidence,
                              const lar_schedule_set *set, lar_schedule_proof *proof,
                              lar_error *error) {
    lar_proof work = {.mesh = mesh, .incidence = incidence, .set = set};
    lar_schedule_proof result = {0};
    lar_status status = lar_proof_shape(&work, error);
    if (!status) status = lar_proof_fit(&work, error);
    if (!status) status = lar_proof_packets(&work, error);
    if (!status) status = lar_proof_order(&work, error);
    if (!status) status = lar_proof_races(&work, error);
    if (!status) status = lar_proof_sums(&work, &result.sums, error);
    if (!status) status = measure_spread(set, &result.spread, error);
    if (!status) count_all(set, mesh, &result);
    free(work.owner);
    free(work.packet);
    free(work.first);
    free(work.order);
    if (!status && proof) *proof = result;
    return status;
}
