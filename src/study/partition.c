#include "study/partition.h"

#include <stdlib.h>
#include <string.h>

#include "divide/distribution.h"
#include "divide/genetic.h"
#include "divide/schedule/file.h"
#include "model/format/mesh_io.h"
#include "model/model.h"

const char *const lar_partition_method_name[LAR_PARTITION_METHODS + 1] = {
    "best", "cut", "genetic", "metis", "random", "file", NULL};

bool lar_partition_has_metis(void) {
    return lar_distribution_has_metis();
}

typedef struct partition {
    const lar_mesh *mesh;
    const lar_partition_options *options;
    lar_partition_report *report;
    lar_error *error;
    lar_grid grid;
    lar_incidence incidence;
    lar_sharing sharing;
    lar_distribution kept;
    lar_cost kept_cost;
} partition;

static void partition_clear(partition *p) {
    lar_incidence_clear(&p->incidence);
    lar_sharing_clear(&p->sharing);
    lar_distribution_clear(&p->kept);
}

/* ---- making distributions --------------------------------------------------------------- */

static bool genetic_progress(void *context, const lar_genetic_progress *progress) {
    const partition *p = context;
    const lar_partition_options *o = p->options;
    double done = o->generations ? (double)progress->generation / (double)o->generations : 0;
    if (o->seconds > 0 && progress->seconds / o->seconds > done)
        done = progress->seconds / o->seconds;
    o->progress(o->context, done < 1 ? done : 1, progress->start.worst, progress->best.worst);
    return true;
}

static lar_status make_genetic(partition *p, lar_distribution *out) {
    lar_distribution d = {0};
    lar_status status = lar_distribution_create(p->mesh, &p->grid, &d, p->error);
    if (status) return status;
    lar_genetic_options options = lar_genetic_options_default();
    lar_genetic_result result = {0};
    options.seed = p->options->seed;
    options.seconds = p->options->seconds;
    options.generations = p->options->generations;
    options.callback = p->options->progress ? genetic_progress : NULL;
    options.context = p;
    status = lar_genetic_search(p->mesh, &p->incidence, &p->grid, &options, d.processor, &result,
                                p->error);
    p->report->generations = result.generations;
    p->report->seconds = result.seconds;
    if (status)
        lar_distribution_clear(&d);
    else
        *out = d;
    return status;
}

static lar_status make(partition *p, lar_partition_method method, lar_distribution *out) {
    uint64_t seed = p->options->seed;
    switch (method) {
    case LAR_PARTITION_CUT:
        return lar_distribution_cut(p->mesh, &p->grid, out, p->error);
    case LAR_PARTITION_GENETIC:
        return make_genetic(p, out);
    case LAR_PARTITION_METIS:
        return lar_distribution_metis(p->mesh, &p->incidence, &p->grid, seed, out, p->error);
    case LAR_PARTITION_RANDOM:
        return lar_distribution_random(p->mesh, &p->grid, seed, out, p->error);
    default:
        return lar_distribution_read(p->options->read, p->mesh, out, p->error);
    }
}

static lar_status measure(partition *p, const lar_distribution *d, lar_cost *cost) {
    int32_t *set = lar_calloc((size_t)p->incidence.max, sizeof *set);
    int64_t *pays = lar_calloc((size_t)p->grid.count, sizeof *pays);
    bool good = set && pays;
    if (good) *cost = lar_cost_measure(&p->incidence, d->processor, p->grid.count, set, pays);
    free(set);
    free(pays);
    return good ? LAR_OK : lar_fail_memory(p->error, 8 * (size_t)p->grid.count, "costs");
}

/* Makes one distribution; keeps it when it was asked for, or is better than the one kept. */
static lar_status try_method(partition *p, lar_partition_method method) {
    lar_distribution d = {0};
    lar_cost cost = {0};
    lar_status status = make(p, method, &d);
    if (!status) status = measure(p, &d, &cost);
    if (!status) {
        p->report->cost[method] = (lar_partition_cost){true, cost.worst, cost.total};
        bool asked = p->options->method == method;
        if (asked || !p->kept.processor ||
            (p->options->method == LAR_PARTITION_BEST && lar_cost_less(cost, p->kept_cost))) {
            lar_distribution swap = p->kept;
            p->kept = d;
            d = swap;
            p->kept_cost = cost;
            p->report->method = method;
        }
    }
    lar_distribution_clear(&d);
    return status;
}

static lar_status find_grid(partition *p) {
    const lar_partition_options *o = p->options;
    lar_status status = LAR_OK;
    if (o->grid) status = lar_grid_parse(o->grid, &p->grid, p->error);
    if (status || o->method != LAR_PARTITION_FILE) return status;
    lar_distribution d = {0};
    status = lar_distribution_read(o->read, p->mesh, &d, p->error);
    if (!status && o->grid && memcmp(&d.grid, &p->grid, sizeof d.grid) != 0) {
        char has[LAR_GRID_TEXT];
        lar_grid_format(&d.grid, has);
        status = lar_fail(p->error, LAR_ERROR_ARGUMENT,
                          "%s: the file is for the grid %s, not for %s; leave --grid out or give "
                          "another file",
                          o->read, has, o->grid);
    }
    p->grid = d.grid;
    lar_distribution_clear(&d);
    return status;
}

static lar_status divide(partition *p) {
    lar_partition_method method = p->options->method;
    bool all = method == LAR_PARTITION_BEST;
    lar_status status = find_grid(p);
    if (!status) status = lar_incidence_build(p->mesh, &p->incidence, p->error);
    if (!status) status = try_method(p, LAR_PARTITION_CUT); /* "before", whatever follows */
    if (!status && !all && method != LAR_PARTITION_CUT) status = try_method(p, method);
    if (!status && all) status = try_method(p, LAR_PARTITION_GENETIC);
    if (!status && all && lar_partition_has_metis()) status = try_method(p, LAR_PARTITION_METIS);
    return status;
}

/* ---- figures ---------------------------------------------------------------------------- */

static lar_status report_load(partition *p) {
    lar_partition_report *r = p->report;
    int32_t *count = lar_calloc((size_t)p->grid.count, sizeof *count);
    if (!count) return lar_fail_memory(p->error, 4 * (size_t)p->grid.count, "loads");
    r->balanced = lar_distribution_load(&p->kept, count);
    r->load_min = r->load_max = count[0];
    for (int32_t i = 1; i < p->grid.count; i++) {
        if (count[i] < r->load_min) r->load_min = count[i];
        if (count[i] > r->load_max) r->load_max = count[i];
    }
    free(count);
    return LAR_OK;
}

static void report_nodes(partition *p) {
    lar_partition_report *r = p->report;
    r->mean_processors = lar_sharing_mean(&p->sharing);
    for (int32_t k = 0; k < p->sharing.node_count; k++) {
        const int32_t *set;
        int32_t count = lar_sharing_of(&p->sharing, k, &set);
        r->shared += count > 1;
        r->irregular += lar_node_direction(&p->grid, set, count) == LAR_DIRECTION_IRREGULAR;
        r->scattered += lar_node_scattered(&p->grid, set, count);
    }
}

static int64_t larger(int64_t a, int64_t b) {
    return a > b ? a : b;
}

static void report_traffic(const lar_schedule_set *set, lar_partition_scheme *r) {
    int64_t local = 0, global = 0, packets = 0, largest = 0;
    for (int32_t i = 0; i < set->count; i++) {
        lar_traffic t;
        lar_schedule_traffic(&set->of[i], &t);
        int64_t of_this = t.local_packets + t.global_packets;
        local += t.local;
        global += t.global;
        packets += of_this;
        largest = larger(largest, t.largest_packet);
        r->local_max = larger(r->local_max, t.local);
        r->global_max = larger(r->global_max, t.global);
        r->vectors_max = larger(r->vectors_max, t.local + t.global);
        r->packets_max = larger(r->packets_max, of_this);
    }
    double n = set->count, vectors = (double)(local + global);
    r->local_mean = (double)local / n;
    r->global_mean = (double)global / n;
    r->vectors_mean = vectors / n;
    r->bytes_max = LAR_VECTOR_BYTES * r->vectors_max;
    r->bytes_mean = LAR_VECTOR_BYTES * r->vectors_mean;
    r->packets_mean = (double)packets / n;
    r->packet_bytes_max = LAR_VECTOR_BYTES * largest;
    r->packet_bytes_mean = packets > 0 ? LAR_VECTOR_BYTES * vectors / (double)packets : 0;
}

static void report_schedules(const lar_schedule_set *set, lar_partition_schedules *r) {
    int64_t batches = 0, waits = 0;
    for (int32_t i = 0; i < set->count; i++) {
        const lar_schedule *s = &set->of[i];
        batches += s->batch_count;
        waits += s->wait_count;
        r->batches_max = larger(r->batches_max, s->batch_count);
        r->waits_max = larger(r->waits_max, s->wait_count);
        r->buffer_bytes_max = larger(r->buffer_bytes_max, 2 * s->receive_bytes);
    }
    r->threads = set->of[0].threads;
    r->scheme = lar_scheme_name[set->of[0].scheme];
    r->channels = lar_channel_use_name[set->of[0].channels];
    r->batches_mean = (double)batches / set->count;
    r->waits_mean = (double)waits / set->count;
}

/* Threads make no difference to what is sent: they are searched for where they are asked for. */
static lar_status report_scheme(partition *p, lar_scheme scheme) {
    const lar_partition_options *o = p->options;
    lar_schedule_options options = lar_schedule_options_default();
    lar_schedule_set set = {0};
    bool chosen = (int)scheme == o->scheme;
    options.scheme = scheme;
    options.channels = (lar_channel_use)o->channels;
    if (chosen && o->threads > 1) options.threads = o->threads;
    lar_status status =
        lar_schedule_build(p->mesh, &p->incidence, &p->kept, &options, &set, p->error);
    if (status) return status;
    p->report->scheme[scheme].name = lar_scheme_name[scheme];
    report_traffic(&set, &p->report->scheme[scheme]);
    if (chosen) report_schedules(&set, &p->report->schedules);
    if (chosen && o->schedules) status = lar_schedule_write(o->schedules, &set, p->error);
    lar_schedule_set_clear(&set);
    return status;
}

static lar_status report_all(partition *p) {
    lar_partition_report *r = p->report;
    memcpy(r->grid, p->grid.edge, sizeof r->grid);
    r->processors = p->grid.count;
    r->diameter = lar_grid_diameter(&p->grid);
    r->elements = p->mesh->element_count;
    r->nodes = p->mesh->node_count;
    int64_t before = r->cost[LAR_PARTITION_CUT].worst;
    r->reduction = before > 0 ? 1 - (double)p->kept_cost.worst / (double)before : 0;
    lar_status status = report_load(p);
    if (!status) status = lar_sharing_build(&p->incidence, &p->kept, &p->sharing, p->error);
    if (status) return status;
    report_nodes(p);
    for (int s = 0; s < LAR_SCHEMES && !status; s++) status = report_scheme(p, (lar_scheme)s);
    return status;
}

/* ---- files ------------------------------------------------------------------------------ */

static lar_status write_vtu(partition *p, const char *path) {
    static const char *const names[4] = {"processor", "processor_x", "processor_y", "processor_z"};
    size_t elements = (size_t)p->mesh->element_count;
    double *value = lar_calloc(4 * elements, sizeof *value);
    if (!value) return lar_fail_memory(p->error, 4 * elements * sizeof *value, path);
    lar_vtu_array array[4];
    for (int i = 0; i < 4; i++)
        array[i] = (lar_vtu_array){names[i], 1, value + (size_t)i * elements};
    for (size_t e = 0; e < elements; e++) {
        int32_t place[3];
        lar_grid_place(&p->grid, p->kept.processor[e], place);
        value[e] = p->kept.processor[e];
        for (size_t i = 0; i < 3; i++) value[(i + 1) * elements + e] = place[i];
    }
    lar_vtu_frame frame = {.mesh = p->mesh, .cell_array = array, .cell_array_count = 4};
    lar_status status = lar_vtu_write(path, &frame, p->error);
    free(value);
    return status;
}

lar_status lar_partition(const lar_model *model, const lar_partition_options *options,
                         lar_partition_report *report, lar_error *error) {
    lar_partition_report made = {0};
    partition p = {.mesh = &model->mesh, .options = options, .report = &made, .error = error};
    lar_status status = divide(&p);
    if (!status) status = report_all(&p);
    if (!status && options->out)
        status = lar_distribution_write(options->out, p.mesh, &p.kept, error);
    if (!status && options->vtu) status = write_vtu(&p, options->vtu);
    partition_clear(&p);
    if (!status) *report = made;
    return status;
}
