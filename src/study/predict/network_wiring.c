#include "study/predict/network_wiring.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Kind of a place along an axis: as it is, or lower end, between, upper end. */
static int32_t kind_of(int32_t place, int32_t edge, int32_t kinds) {
    if (edge == kinds) return place;
    return place == 0 ? 0 : place == edge - 1 ? 2 : 1;
}

static void place_of(const int32_t grid[3], int32_t p, int32_t place[3]) {
    place[0] = p % grid[0];
    place[1] = p / grid[0] % grid[1];
    place[2] = p / grid[0] / grid[1];
}

/* The processor as far from p as `peer` is from the processor with p's schedule; -1: outside. */
static int32_t find_peer(const lar_network_wiring *w, int32_t p, int32_t peer) {
    const lar_schedule *schedule = w->schedule[p];
    int32_t place[3], kind[3], other[3];
    place_of(w->grid, p, place);
    lar_grid_place(&schedule->grid, schedule->processor, kind);
    lar_grid_place(&schedule->grid, peer, other);
    for (int i = 0; i < 3; i++) {
        place[i] += other[i] - kind[i];
        if (place[i] < 0 || place[i] >= w->grid[i]) return -1;
    }
    return place[0] + w->grid[0] * (place[1] + w->grid[1] * place[2]);
}

/* The packet of that stage that q receives from p; -1: none. */
static int32_t find_receive(const lar_network_wiring *w, int32_t q, int32_t p,
                            const lar_transfer *sent) {
    const lar_schedule *schedule = w->schedule[q];
    for (int32_t b = 0; b < schedule->batch_count; b++) {
        lar_range span = schedule->batch[b].receives;
        for (int32_t i = span.first; i < span.first + span.count; i++) {
            const lar_transfer *t = &schedule->transfer[i];
            if (t->stage == sent->stage && t->vectors.count == sent->vectors.count &&
                find_peer(w, q, t->peer) == p)
                return i;
        }
    }
    return -1;
}

static lar_status join_packets(lar_network_wiring *w, int32_t p, lar_error *error) {
    const lar_schedule *schedule = w->schedule[p];
    for (int32_t b = 0; b < schedule->batch_count; b++) {
        lar_range span = schedule->batch[b].sends;
        for (int32_t i = span.first; i < span.first + span.count; i++) {
            const lar_transfer *t = &schedule->transfer[i];
            int32_t q = find_peer(w, p, t->peer);
            int32_t there = q < 0 ? -1 : find_receive(w, q, p, t);
            if (there < 0)
                return lar_fail(error, LAR_ERROR_FORMAT,
                                "nobody receives what processor %d sends to processor %d in stage "
                                "%d; make the schedules anew with lariat partition",
                                (int)p, (int)q, (int)t->stage);
            w->partner[w->transfer_first[p] + i] = w->transfer_first[q] + there;
            w->partner[w->transfer_first[q] + there] = w->transfer_first[p] + i;
        }
    }
    return LAR_OK;
}

/* What is received must be sent by somebody. */
static lar_status check_partners(const lar_network_wiring *w, lar_error *error) {
    for (int64_t i = 0; i < w->transfer_first[w->processors]; i++)
        if (w->partner[i] < 0)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "nobody sends what processor %d waits for; make the schedules anew "
                            "with lariat partition",
                            (int)w->owner[i]);
    return LAR_OK;
}

static lar_status choose_grid(const lar_network_options *o, lar_network_wiring *w,
                              lar_error *error) {
    const lar_grid *has = &o->schedules->of[0].grid;
    bool same = !o->grid[0] && !o->grid[1] && !o->grid[2];
    int64_t count = 1;
    for (int i = 0; i < 3; i++) {
        w->grid[i] = same ? has->edge[i] : o->grid[i];
        if (w->grid[i] != has->edge[i] && (has->edge[i] != 3 || w->grid[i] < 3))
            return lar_fail(error, LAR_ERROR_ARGUMENT,
                            "schedules for %d processors along an axis cannot stand for %d",
                            (int)has->edge[i], (int)w->grid[i]);
        count *= w->grid[i];
        if (count > LAR_NETWORK_PROCESSORS_MAX)
            return lar_fail(error, LAR_ERROR_ARGUMENT,
                            "more than %d processors; take a smaller grid",
                            LAR_NETWORK_PROCESSORS_MAX);
    }
    w->processors = (int32_t)count;
    return LAR_OK;
}

static lar_status number_through(const lar_network_options *o, lar_network_wiring *w,
                                 lar_error *error) {
    const lar_grid *has = &o->schedules->of[0].grid;
    size_t processors = (size_t)w->processors;
    w->schedule = lar_calloc(processors, sizeof *w->schedule);
    w->transfer_first = lar_calloc(processors + 1, sizeof *w->transfer_first);
    w->batch_first = lar_calloc(processors + 1, sizeof *w->batch_first);
    if (!w->schedule || !w->transfer_first || !w->batch_first)
        return lar_fail_memory(error, 24 * processors, "the processors of a prediction");
    for (int32_t p = 0; p < w->processors; p++) {
        int32_t place[3], kind[3];
        place_of(w->grid, p, place);
        for (int i = 0; i < 3; i++) kind[i] = kind_of(place[i], w->grid[i], has->edge[i]);
        w->schedule[p] = &o->schedules->of[lar_grid_processor(has, kind)];
        w->transfer_first[p + 1] = w->transfer_first[p] + w->schedule[p]->transfer_count;
        w->batch_first[p + 1] = w->batch_first[p] + w->schedule[p]->batch_count;
    }
    size_t transfers = (size_t)w->transfer_first[processors];
    w->partner = lar_calloc(transfers, sizeof *w->partner);
    w->owner = lar_calloc(transfers, sizeof *w->owner);
    if (!w->partner || !w->owner)
        return lar_fail_memory(error, 12 * transfers, "the packets of a prediction");
    memset(w->partner, -1, transfers * sizeof *w->partner);
    for (int32_t p = 0; p < w->processors; p++)
        for (int64_t i = w->transfer_first[p]; i < w->transfer_first[p + 1]; i++) w->owner[i] = p;
    return LAR_OK;
}

lar_status lar_wiring_make(const lar_network_options *options, lar_network_wiring *wiring,
                           lar_error *error) {
    lar_status status = choose_grid(options, wiring, error);
    if (!status) status = number_through(options, wiring, error);
    for (int32_t p = 0; p < wiring->processors && !status; p++)
        status = join_packets(wiring, p, error);
    return status ? status : check_partners(wiring, error);
}

void lar_wiring_clear(lar_network_wiring *wiring) {
    free(wiring->schedule);
    free(wiring->transfer_first);
    free(wiring->batch_first);
    free(wiring->partner);
    free(wiring->owner);
    *wiring = (lar_network_wiring){0};
}
