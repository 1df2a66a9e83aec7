/* This machine as a machine of the table. What the benchmarks tell, in the model's terms:
 *
 *     a plain step            elements x element + nodes x node; the two share it by the operations
 *                             that the kernel has for them (operations.h)
 *     send(n)                 overhead + n x byte
 *     latency(n)              send(n) + latency + n / bandwidth + receive
 */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "divide/traffic.h"
#include "mechanics/stress.h"
#include "study/bench/comm.h"
#include "study/bench/scaling.h"
#include "study/bench/comm_pair.h"
#include "study/predict/cluster.h"
#include "study/requirements/operations.h"

enum { SAMPLES = 9 };
static const double SAMPLE = 0.02; /* [s] */

/* ---- steps ---------------------------------------------------------------------------------- */

static lar_status measure_step(const lar_model *model, double *seconds, lar_error *error) {
    lar_simulation *simulation = NULL;
    lar_options options = lar_options_default();
    uint64_t steps = 1;
    double took = 0, sample[SAMPLES];
    lar_status status = lar_simulation_create(model, &options, &simulation, error);
    if (status) return status;
    while (!status && took < SAMPLE) {
        double begin = lar_pair_now();
        steps *= 2;
        status = lar_simulation_advance(simulation, steps, error);
        took = lar_pair_now() - begin;
    }
    for (int i = 0; i < SAMPLES && !status; i++) {
        double begin = lar_pair_now();
        status = lar_simulation_advance(simulation, steps, error);
        sample[i] = (lar_pair_now() - begin) / (double)steps;
    }
    lar_simulation_destroy(simulation);
    if (!status) *seconds = lar_spread_of(sample, SAMPLES).median;
    return status;
}

static lar_status measure_processor(const lar_model *model, lar_cluster *m, lar_error *error) {
    lar_model_info info;
    double step = 0;
    lar_status status = lar_model_inspect(model, &info, error);
    if (!status) status = measure_step(model, &step, error);
    if (status) return status;
    lar_operations element = lar_operations_of_element(LAR_KERNEL_HEX8, LAR_LAW_neo_hookean);
    lar_operations node = lar_operations_of_node();
    double share = (double)lar_operations_all(&node) / (double)lar_operations_all(&element);
    m->number[LAR_CLUSTER_ELEMENT] = step / (info.elements + share * info.nodes);
    m->number[LAR_CLUSTER_NODE] = share * m->number[LAR_CLUSTER_ELEMENT];
    m->source[LAR_CLUSTER_ELEMENT] = "measured: plain steps of the model on one core";
    m->source[LAR_CLUSTER_NODE] = "measured with the element, divided by counted operations";
    return LAR_OK;
}

/* ---- packets -------------------------------------------------------------------------------- */

static const lar_bench_comm_row *find_row(const lar_bench_comm_result *r, const char *backend) {
    for (int i = 0; i < r->rows; i++)
        if (r->row[i].moves_packets && strcmp(r->row[i].name, backend) == 0) return &r->row[i];
    return NULL;
}

/* From the smallest packet, one of 4096 bytes, and the largest: what a link adds to the time in put
 * shows in large packets only where both ends share memory. */
static void fill_network(const lar_bench_comm_result *r, const lar_bench_comm_row *row,
                         lar_cluster *m) {
    static const double FASTEST = 1e12; /* [bytes/s] */
    int last = r->sizes - 1, large = last;
    while (large > 0 && r->size[large] > 4096) large--;
    const lar_bench_comm_figures *a = &row->at[0], *b = &row->at[large], *c = &row->at[last];
    double bytes = r->size[large] - r->size[0], most = r->size[last] - r->size[0];
    double byte = fmax(0, 1e-9 * (b->send - a->send) / bytes);
    double slope = 1e-9 * ((c->latency - c->send) - (a->latency - a->send)) / most;
    bool measured = slope * FASTEST > 1;
    double *x = m->number;
    x[LAR_CLUSTER_BYTE] = byte;
    x[LAR_CLUSTER_OVERHEAD] = fmax(0, 1e-9 * a->send - byte * r->size[0]);
    x[LAR_CLUSTER_RECEIVE] = fmax(0, 1e-9 * a->receive);
    x[LAR_CLUSTER_BANDWIDTH] = measured ? 1 / slope : FASTEST;
    x[LAR_CLUSTER_LATENCY] = fmax(0, 1e-9 * (a->latency - a->send));
    x[LAR_CLUSTER_JOIN] = x[LAR_CLUSTER_LATENCY];
    m->source[LAR_CLUSTER_BYTE] = m->source[LAR_CLUSTER_OVERHEAD] =
        "measured: time in put, 8 and 4096 bytes";
    m->source[LAR_CLUSTER_RECEIVE] = "measured: time in wait for a packet that is there";
    m->source[LAR_CLUSTER_BANDWIDTH] =
        measured ? "measured: what large packets take longer beside the time in put"
                 : "not measurable here: packets take no longer than the time in put";
    m->source[LAR_CLUSTER_LATENCY] = "measured: latency of 8 bytes less the time in put";
    m->source[LAR_CLUSTER_JOIN] = "as latency";
}

static lar_status measure_network(const char *backend, lar_cluster *m, lar_error *error) {
    const lar_bench_comm_options options = {
        .bytes = 424, .repeat = 15, .backends = backend, .quick = false};
    lar_bench_comm_result *r = lar_calloc(1, sizeof *r);
    if (!r) return lar_fail_memory(error, sizeof *r, "the communication benchmark");
    lar_status status = lar_bench_comm(&options, r, error);
    const lar_bench_comm_row *row = status ? NULL : find_row(r, backend);
    if (row && row->missing)
        status = lar_fail(error, LAR_ERROR_UNSUPPORTED, "communication by %s: %s", backend,
                          row->missing);
    else if (row)
        fill_network(r, row, m);
    else if (!status)
        status =
            lar_fail(error, LAR_ERROR_UNSUPPORTED,
                     "communication by %s cannot be measured here; take threads or shm", backend);
    free(r);
    return status;
}

lar_status lar_cluster_measure(const lar_model *model, const char *backend, lar_cluster *out,
                               lar_error *error) {
    lar_cluster made = {.name = "here", .title = "this machine, measured now"};
    for (int i = 0; i < LAR_CLUSTER_NUMBERS; i++) made.source[i] = "not measured";
    lar_status status = measure_processor(model, &made, error);
    if (!status) status = measure_network(backend, &made, error);
    /* A vector is three values of eight bytes out of the sums: as much again as into a packet. */
    made.number[LAR_CLUSTER_VECTOR] =
        LAR_VECTOR_BYTES * made.number[LAR_CLUSTER_BYTE] + 0.5 * made.number[LAR_CLUSTER_NODE];
    made.source[LAR_CLUSTER_VECTOR] = "assumed: half a node and 24 bytes";
    if (!status) status = lar_cluster_check(&made, error);
    if (!status) *out = made;
    return status;
}
