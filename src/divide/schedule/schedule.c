#include "divide/schedule/schedule.h"

#include <inttypes.h>
#include <stdlib.h>

#include "base/hash.h"
#include "base/memory.h"
#include "divide/schedule/plan.h"

lar_schedule_options lar_schedule_options_default(void) {
    return (lar_schedule_options){LAR_SCHEME_ALL, LAR_CHANNELS_SEQUENTIAL, 1, 4000};
}

void lar_schedule_clear(lar_schedule *schedule) {
    free(schedule->batch);
    free(schedule->element);
    free(schedule->wait);
    free(schedule->transfer);
    free(schedule->node);
    free(schedule->vector);
    *schedule = (lar_schedule){0};
}

void lar_schedule_set_clear(lar_schedule_set *set) {
    for (int32_t p = 0; p < set->count; p++) lar_schedule_clear(&set->of[p]);
    free(set->of);
    *set = (lar_schedule_set){0};
}

void lar_schedule_traffic(const lar_schedule *schedule, lar_traffic *traffic) {
    *traffic = (lar_traffic){0};
    for (int32_t b = 0; b < schedule->batch_count; b++) {
        lar_range sends = schedule->batch[b].sends;
        for (int32_t i = sends.first; i < sends.first + sends.count; i++) {
            const lar_transfer *t = &schedule->transfer[i];
            if (t->vectors.count == 0) continue;
            bool local = lar_grid_neighbours(&schedule->grid, schedule->processor, t->peer);
            *(local ? &traffic->local : &traffic->global) += t->vectors.count;
            *(local ? &traffic->local_packets : &traffic->global_packets) += 1;
            if (t->vectors.count > traffic->largest_packet)
                traffic->largest_packet = t->vectors.count;
        }
    }
}

/* ---- what belongs together -------------------------------------------------------------- */

static uint64_t hash_numbers(uint64_t hash, const int32_t *number, int32_t count) {
    hash = lar_hash_word(hash, (uint64_t)count);
    for (int32_t i = 0; i < count; i++) hash = lar_hash_word(hash, (uint64_t)number[i]);
    return hash;
}

static uint64_t hash_span(uint64_t hash, lar_range span) {
    return lar_hash_word(hash, (uint64_t)span.first << 32 | (uint64_t)span.count);
}

static uint64_t hash_schedule(uint64_t hash, const lar_schedule *s) {
    const int32_t head[] = {s->grid.edge[0], s->grid.edge[1],    s->grid.edge[2],     s->processor,
                            s->threads,      (int32_t)s->scheme, (int32_t)s->channels};
    hash = hash_numbers(hash, head, sizeof head / sizeof *head);
    hash = lar_hash_word(hash, s->mesh);
    hash = lar_hash_word(hash, (uint64_t)s->receive_bytes);
    hash = hash_numbers(hash, s->thread_first, s->threads + 1);
    for (int32_t i = 0; i < s->batch_count; i++) {
        const lar_batch *b = &s->batch[i];
        hash = hash_span(hash, b->elements);
        hash = hash_span(hash, b->waits);
        hash = hash_span(hash, b->receives);
        hash = hash_span(hash, b->positions);
        hash = hash_span(hash, b->sends);
    }
    for (int32_t i = 0; i < s->transfer_count; i++) {
        const lar_transfer *t = &s->transfer[i];
        const int32_t numbers[] = {t->peer, t->stage, t->whole};
        hash = hash_numbers(hash, numbers, 3);
        hash = hash_span(hash, t->vectors);
        hash = lar_hash_word(hash, (uint64_t)t->offset);
    }
    hash = hash_numbers(hash, s->element, s->element_count);
    hash = hash_numbers(hash, s->wait, s->wait_count);
    hash = hash_numbers(hash, s->node, s->node_count);
    return hash_numbers(hash, s->vector, s->vector_count);
}

/* ---- building --------------------------------------------------------------------------- */

static lar_status check_options(const lar_schedule_options *o, const lar_mesh *mesh,
                                const lar_distribution *distribution, lar_error *error) {
    if ((unsigned)o->scheme >= LAR_SCHEMES || (unsigned)o->channels >= LAR_CHANNEL_USES)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no communication scheme %d with use %d of channels",
                        (int)o->scheme, (int)o->channels);
    if (o->threads < 1 || o->threads > LAR_THREADS_MAX)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%d threads for each processor are not possible; give 1 to %d",
                        (int)o->threads, LAR_THREADS_MAX);
    if (o->search < 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a search of %" PRId64 " assignments is not possible; give 0 or more",
                        o->search);
    if (distribution->element_count != mesh->element_count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "the distribution is of %d elements, the mesh has %d; make one for it",
                        (int)distribution->element_count, (int)mesh->element_count);
    return LAR_OK;
}

static void find_centres(const lar_mesh *mesh, double (*centre)[3]) {
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int i = 0; i < 3; i++) {
            double sum = 0;
            for (int a = 0; a < 8; a++) sum += mesh->position[mesh->element[e][a]][i];
            centre[e][i] = sum / 8;
        }
}

static void list_by_processor(lar_plan_site *site) {
    const lar_sharing *s = &site->sharing;
    int32_t n = s->grid.count;
    for (int32_t e = 0; e < site->mesh->element_count; e++)
        site->element_first[site->distribution->processor[e] + 1]++;
    for (int64_t i = 0; i < s->first[s->node_count]; i++) site->node_first[s->processor[i] + 1]++;
    for (int32_t p = 0; p < n; p++) {
        site->element_first[p + 1] += site->element_first[p];
        site->node_first[p + 1] += site->node_first[p];
    }
    /* The firsts move on to the ends while the lists fill: put back afterwards. */
    for (int32_t e = 0; e < site->mesh->element_count; e++)
        site->element[site->element_first[site->distribution->processor[e]]++] = e;
    for (int32_t k = 0; k < s->node_count; k++)
        for (int64_t i = s->first[k]; i < s->first[k + 1]; i++)
            site->node[site->node_first[s->processor[i]]++] = k;
    for (int32_t p = n; p > 0; p--) {
        site->element_first[p] = site->element_first[p - 1];
        site->node_first[p] = site->node_first[p - 1];
    }
    site->element_first[0] = 0;
    site->node_first[0] = 0;
}

static void clear_site(lar_plan_site *site) {
    lar_sharing_clear(&site->sharing);
    lar_packets_clear(&site->packets);
    free(site->centre);
    free(site->element);
    free(site->element_first);
    free(site->node);
    free(site->node_first);
    free(site->batch);
    free(site->kind);
    free(site->place);
}

static lar_status make_site(lar_plan_site *site, lar_error *error) {
    lar_status status =
        lar_sharing_build(site->incidence, site->distribution, &site->sharing, error);
    if (status != LAR_OK) return status;
    size_t elements = (size_t)site->mesh->element_count;
    size_t nodes = (size_t)site->mesh->node_count;
    size_t processors = (size_t)site->distribution->grid.count;
    size_t shared = (size_t)site->sharing.first[nodes];
    site->centre = lar_calloc(elements, sizeof *site->centre);
    site->element = lar_calloc(elements, sizeof *site->element);
    site->element_first = lar_calloc(processors + 1, sizeof *site->element_first);
    site->node = lar_calloc(shared, sizeof *site->node);
    site->node_first = lar_calloc(processors + 1, sizeof *site->node_first);
    site->batch = lar_calloc(elements, sizeof *site->batch);
    site->kind = lar_calloc(elements, sizeof *site->kind);
    site->place = lar_calloc(nodes, sizeof *site->place);
    if (!site->centre || !site->element || !site->element_first || !site->node ||
        !site->node_first || !site->batch || !site->kind || !site->place)
        return lar_fail_memory(error, elements * sizeof *site->centre, "elements of processors");
    find_centres(site->mesh, site->centre);
    list_by_processor(site);
    return lar_packets_build(&site->sharing, site->options, &site->packets, error);
}

static lar_status make_schedules(lar_plan_site *site, lar_schedule_set *set, lar_error *error) {
    lar_status status = LAR_OK;
    uint64_t mesh = lar_mesh_fingerprint(site->mesh), division = 0;
    for (int32_t p = 0; p < set->count && status == LAR_OK; p++) {
        lar_plan plan;
        status = lar_plan_build(site, p, &plan, error);
        if (status == LAR_OK) status = lar_plan_emit(&plan, &set->of[p], error);
        lar_plan_clear(&plan);
        set->of[p].mesh = mesh;
        division = hash_schedule(division, &set->of[p]);
    }
    for (int32_t p = 0; p < set->count; p++) set->of[p].division = division;
    return status;
}

lar_status lar_schedule_build(const lar_mesh *mesh, const lar_incidence *incidence,
                              const lar_distribution *distribution,
                              const lar_schedule_options *options, lar_schedule_set *out,
                              lar_error *error) {
    lar_plan_site site = {
        .mesh = mesh, .incidence = incidence, .distribution = distribution, .options = options};
    lar_status status = check_options(options, mesh, distribution, error);
    if (status != LAR_OK) return status;
    lar_schedule_set set = {.count = distribution->grid.count};
    set.of = lar_calloc((size_t)set.count, sizeof *set.of);
    if (!set.of) return lar_fail_memory(error, (size_t)set.count * sizeof *set.of, "schedules");
    status = make_site(&site, error);
    if (status == LAR_OK) status = make_schedules(&site, &set, error);
    clear_site(&site);
    if (status == LAR_OK)
        *out = set;
    else
        lar_schedule_set_clear(&set);
    return status;
}
