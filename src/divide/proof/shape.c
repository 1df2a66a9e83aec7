/* Schedules as such: numbers inside their bounds, elements and nodes each once. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "divide/proof/proof.h"

const char *lar_proof_place(const lar_schedule *s, int32_t batch, char text[LAR_PLACE_TEXT]) {
    snprintf(text, LAR_PLACE_TEXT, "processor %d, thread %d, batch %d", s->processor,
             lar_batch_thread(s, batch), batch);
    return text;
}

/* ---- shape ------------------------------------------------------------------------------ */

static lar_status check_head(const lar_schedule_set *set, int32_t p, uint64_t mesh,
                             lar_error *error) {
    const lar_schedule *s = &set->of[p], *first = &set->of[0];
    if (s->processor != p || s->grid.count != set->count)
        return LAR_DISPROVE(error,
                            "schedule %d of %d is for processor %d of %d; the schedules of all "
                            "processors of one division are needed",
                            p, set->count, s->processor, s->grid.count);
    if (s->mesh != mesh)
        return LAR_DISPROVE(error, "processor %d: the schedule was made for another mesh", p);
    if (s->division != first->division || s->threads != first->threads ||
        s->scheme != first->scheme || s->channels != first->channels ||
        memcmp(s->grid.edge, first->grid.edge, sizeof s->grid.edge) != 0)
        return LAR_DISPROVE(error,
                            "processor %d: the schedule belongs to another division, or to other "
                            "options, than that of processor 0",
                            p);
    if (s->threads < 1 || s->threads > LAR_THREADS_MAX)
        return LAR_DISPROVE(error, "processor %d: %d threads; 1 to %d are possible", p, s->threads,
                            LAR_THREADS_MAX);
    bool good = s->batch_count >= 0 && s->thread_first[0] == 0 &&
                s->thread_first[s->threads] == s->batch_count;
    for (int32_t t = 0; t < s->threads; t++) good &= s->thread_first[t] <= s->thread_first[t + 1];
    if (!good)
        return LAR_DISPROVE(error, "processor %d: the batches of its threads do not add up", p);
    return LAR_OK;
}

static bool inside(int32_t first, int32_t count, int32_t length) {
    return first >= 0 && count >= 0 && first <= length && count <= length - first;
}

static lar_status check_spans(const lar_schedule *s, lar_error *error) {
    int64_t elements = 0, nodes = 0, transfers = 0;
    char at[LAR_PLACE_TEXT];
    for (int32_t b = 0; b < s->batch_count; b++) {
        const lar_batch *batch = &s->batch[b];
        if (!inside(batch->elements.first, batch->elements.count, s->element_count) ||
            !inside(batch->waits.first, batch->waits.count, s->wait_count) ||
            !inside(batch->receives.first, batch->receives.count, s->transfer_count) ||
            !inside(batch->positions.first, batch->positions.count, s->node_count) ||
            !inside(batch->sends.first, batch->sends.count, s->transfer_count))
            return LAR_DISPROVE(error, "%s points outside of its schedule",
                                lar_proof_place(s, b, at));
        elements += batch->elements.count;
        nodes += batch->positions.count;
        transfers += (int64_t)batch->receives.count + batch->sends.count;
    }
    if (elements != s->element_count || nodes != s->node_count || transfers != s->transfer_count)
        return LAR_DISPROVE(error,
                            "processor %d: its batches have %lld elements, %lld nodes and %lld "
                            "packets, its schedule %d, %d and %d",
                            s->processor, (long long)elements, (long long)nodes,
                            (long long)transfers, s->element_count, s->node_count,
                            s->transfer_count);
    return LAR_OK;
}

static bool all_below(const int32_t *number, int32_t count, int32_t bound) {
    for (int32_t i = 0; i < count; i++)
        if (number[i] < 0 || number[i] >= bound) return false;
    return true;
}

static lar_status check_waits(const lar_schedule *s, lar_error *error) {
    char at[LAR_PLACE_TEXT];
    for (int32_t b = 0; b < s->batch_count; b++)
        for (int32_t i = 0; i < s->batch[b].waits.count; i++) {
            int32_t other = s->wait[s->batch[b].waits.first + i];
            if (lar_batch_thread(s, b) == lar_batch_thread(s, other))
                return LAR_DISPROVE(error, "%s waits for batch %d of its own thread",
                                    lar_proof_place(s, b, at), other);
        }
    return LAR_OK;
}

static lar_status check_transfers(const lar_schedule *s, lar_error *error) {
    for (int32_t i = 0; i < s->transfer_count; i++) {
        const lar_transfer *t = &s->transfer[i];
        if (t->peer < 0 || t->peer >= s->grid.count || t->peer == s->processor || t->stage < 0 ||
            t->stage >= LAR_STAGES || t->whole < 0 || t->whole > t->vectors.count ||
            !inside(t->vectors.first, t->vectors.count, s->vector_count))
            return LAR_DISPROVE(error,
                                "processor %d: packet %d of its schedule (with processor %d, stage "
                                "%d, %d vectors, %d of them whole) is none that can be",
                                s->processor, i, t->peer, t->stage, t->vectors.count, t->whole);
    }
    return LAR_OK;
}

lar_status lar_proof_shape(lar_proof *proof, lar_error *error) {
    const lar_mesh *mesh = proof->mesh;
    uint64_t fingerprint = lar_mesh_fingerprint(mesh);
    if (proof->set->count < 1) return LAR_DISPROVE(error, "there are no schedules");
    for (int32_t p = 0; p < proof->set->count; p++) {
        const lar_schedule *s = &proof->set->of[p];
        lar_status status = check_head(proof->set, p, fingerprint, error);
        if (!status) status = check_spans(s, error);
        if (status) return status;
        if (!all_below(s->element, s->element_count, mesh->element_count) ||
            !all_below(s->node, s->node_count, mesh->node_count) ||
            !all_below(s->vector, s->vector_count, mesh->node_count) ||
            !all_below(s->wait, s->wait_count, s->batch_count))
            return LAR_DISPROVE(error,
                                "processor %d: its schedule has elements, nodes or batches that "
                                "do not exist",
                                p);
        status = check_waits(s, error);
        if (!status) status = check_transfers(s, error);
        if (status) return status;
    }
    return LAR_OK;
}

/* ---- fit -------------------------------------------------------------------------------- */

/* Batch of processor p that recovers e, the last one. */
static int32_t recovering_batch(const lar_schedule *s, int32_t e) {
    for (int32_t b = s->batch_count - 1; b >= 0; b--)
        for (int32_t i = 0; i < s->batch[b].elements.count; i++)
            if (s->element[s->batch[b].elements.first + i] == e) return b;
    return 0;
}

static lar_status give_elements(lar_proof *proof, lar_error *error) {
    const lar_schedule_set *set = proof->set;
    char here[LAR_PLACE_TEXT], there[LAR_PLACE_TEXT];
    for (int32_t e = 0; e < proof->mesh->element_count; e++) proof->owner[e] = -1;
    for (int32_t p = 0; p < set->count; p++) {
        const lar_schedule *s = &set->of[p];
        for (int32_t b = 0; b < s->batch_count; b++)
            for (int32_t i = 0; i < s->batch[b].elements.count; i++) {
                int32_t e = s->element[s->batch[b].elements.first + i], other = proof->owner[e];
                proof->owner[e] = p;
                if (other < 0) continue;
                const lar_schedule *before = &set->of[other];
                if (other == p)
                    return LAR_DISPROVE(error,
                                        "%s recovers element %d, which processor %d has twice",
                                        lar_proof_place(s, b, here), e, p);
                return LAR_DISPROVE(error, "%s recovers element %d, as %s does",
                                    lar_proof_place(s, b, here), e,
                                    lar_proof_place(before, recovering_batch(before, e), there));
            }
    }
    for (int32_t e = 0; e < proof->mesh->element_count; e++)
        if (proof->owner[e] < 0) return LAR_DISPROVE(error, "no processor recovers element %d", e);
    return LAR_OK;
}

/* Nodes of one processor, marked by 2p + 1 (has an element of p) and 2p + 2 (is moved by p). */
static lar_status move_nodes(const lar_proof *proof, const lar_schedule *s, int32_t *mark,
                             lar_error *error) {
    const int32_t has = 2 * s->processor + 1, moved = has + 1;
    char at[LAR_PLACE_TEXT];
    for (int32_t i = 0; i < s->element_count; i++)
        for (int a = 0; a < 8; a++) mark[proof->mesh->element[s->element[i]][a]] = has;
    for (int32_t b = 0; b < s->batch_count; b++)
        for (int32_t i = 0; i < s->batch[b].positions.count; i++) {
            int32_t k = s->node[s->batch[b].positions.first + i];
            if (mark[k] != has)
                return LAR_DISPROVE(error, "%s moves node %d, %s", lar_proof_place(s, b, at), k,
                                    mark[k] == moved ? "which this processor has moved already"
                                                     : "at which this processor has no element");
            mark[k] = moved;
        }
    for (int32_t i = 0; i < s->element_count; i++)
        for (int a = 0; a < 8; a++) {
            int32_t k = proof->mesh->element[s->element[i]][a];
            if (mark[k] != moved)
                return LAR_DISPROVE(error, "processor %d does not move node %d of its element %d",
                                    s->processor, k, s->element[i]);
        }
    for (int32_t i = 0; i < s->transfer_count; i++)
        for (int32_t j = 0; j < s->transfer[i].vectors.count; j++) {
            int32_t k = s->vector[s->transfer[i].vectors.first + j];
            if (mark[k] != moved)
                return LAR_DISPROVE(error,
                                    "processor %d exchanges node %d with processor %d (stage %d), "
                                    "but has no element at it",
                                    s->processor, k, s->transfer[i].peer, s->transfer[i].stage);
        }
    return LAR_OK;
}

lar_status lar_proof_fit(lar_proof *proof, lar_error *error) {
    size_t elements = (size_t)proof->mesh->element_count, nodes = (size_t)proof->mesh->node_count;
    proof->owner = lar_calloc(elements, sizeof *proof->owner);
    int32_t *mark = lar_calloc(nodes, sizeof *mark);
    lar_status status = proof->owner && mark
                            ? give_elements(proof, error)
                            : lar_fail_memory(error, 4 * (elements + nodes), "elements and nodes");
    for (int32_t p = 0; !status && p < proof->set->count; p++)
        status = move_nodes(proof, &proof->set->of[p], mark, error);
    free(mark);
    return status;
}
