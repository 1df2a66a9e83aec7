#include "cli/report/predict.h"

#include <inttypes.h>
#include <string.h>

/* The unit in which people read it: us, and MB/s for the bandwidth. */
static double in_units(const lar_cluster *m, int i) {
    return m->number[i] * (i == LAR_CLUSTER_BANDWIDTH ? 1e-6 : 1e6);
}

static const char *unit_of(int i) {
    return i == LAR_CLUSTER_BANDWIDTH ? "MB/s" : "us";
}

static const char *source_of(const lar_cluster *m, int i) {
    return m->source[i] ? m->source[i] : "given";
}

/* ---- machines ------------------------------------------------------------------------------- */

static void write_machine(lar_json *json, const char *name, const lar_cluster *m) {
    lar_json_open(json, name, '{');
    lar_json_text(json, "name", m->name);
    lar_json_text(json, "title", m->title);
    for (int i = 0; i < LAR_CLUSTER_NUMBERS; i++) {
        lar_json_open(json, lar_cluster_number_name[i], '{');
        lar_json_number(json, "value", in_units(m, i));
        lar_json_text(json, "unit", unit_of(i));
        lar_json_text(json, "source", source_of(m, i));
        lar_json_close(json);
    }
    lar_json_close(json);
}

static void print_machine(const lar_cluster *m) {
    printf("%s: %s\n", m->name, m->title);
    for (int i = 0; i < LAR_CLUSTER_NUMBERS; i++)
        printf("  %-10s%10.4g %-5s %s\n", lar_cluster_number_name[i], in_units(m, i), unit_of(i),
               source_of(m, i));
}

void predict_machines_json(void) {
    lar_json json = lar_json_to(stdout);
    lar_json_open(&json, "machines", '[');
    for (int i = 0; lar_cluster_at(i); i++) write_machine(&json, NULL, lar_cluster_at(i));
    lar_json_end(&json);
}

void predict_machines_print(void) {
    for (int i = 0; lar_cluster_at(i); i++) {
        if (i > 0) printf("\n");
        print_machine(lar_cluster_at(i));
    }
}

/* ---- how long the simulation went on -------------------------------------------------------- */

static void write_settled(lar_json *json, int32_t steps, bool settled, double fastest,
                          double slowest) {
    lar_json_integer(json, "steps", steps);
    lar_json_boolean(json, "settled", settled);
    lar_json_number(json, "fastest_us", 1e6 * fastest);
    lar_json_number(json, "slowest_us", 1e6 * slowest);
}

static void print_unsettled(const char *what, double fastest, double slowest) {
    printf("%s: not settled. After so many steps processors still go at %.4g to %.4g us a step; "
           "with more (--steps) the step may change.\n",
           what, 1e6 * fastest, 1e6 * slowest);
}

/* ---- a model -------------------------------------------------------------------------------- */

static void write_processor(lar_json *json, const lar_network_processor *p) {
    lar_json_open(json, NULL, '{');
    lar_json_number(json, "compute_us", 1e6 * p->compute);
    lar_json_number(json, "exchange_us", 1e6 * p->exchange);
    lar_json_number(json, "wait_us", 1e6 * p->wait);
    lar_json_integer(json, "packets", p->packets);
    lar_json_integer(json, "bytes_sent", p->bytes_sent);
    lar_json_integer(json, "bytes_received", p->bytes_received);
    lar_json_close(json);
}

static void write_check(lar_json *json, const lar_predict_check *c) {
    lar_json_open(json, "check", '[');
    for (int i = 0; i < LAR_PREDICT_CHECKS; i++) {
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "grid", c->grid[i]);
        lar_json_text(json, "comm", c->comm);
        lar_json_number(json, "predicted_us", 1e6 * c->predicted[i]);
        lar_json_number(json, "measured_us", 1e6 * c->measured[i].min);
        lar_json_number(json, "predicted_over_measured", c->predicted[i] / c->measured[i].min);
        lar_json_close(json);
    }
    lar_json_close(json);
}

void predict_report_json(const predict_report *report) {
    const lar_prediction *p = report->prediction;
    const lar_network_result *r = &p->network;
    lar_json json = lar_json_to(stdout);
    lar_json_integers(&json, "grid", r->grid, 3);
    lar_json_integer(&json, "processors", r->processors);
    lar_json_integer(&json, "threads", r->threads);
    lar_json_text(&json, "scheme", report->scheme);
    lar_json_text(&json, "channels", report->channels);
    lar_json_integer(&json, "elements", p->elements);
    lar_json_integer(&json, "nodes", p->nodes);
    write_machine(&json, "machine", report->machine);
    lar_json_number(&json, "step_us", 1e6 * r->step);
    write_settled(&json, r->steps, r->settled, r->fastest, r->slowest);
    lar_json_number(&json, "alone_us", 1e6 * p->alone);
    lar_json_number(&json, "time_step", p->time_step);
    lar_json_number(&json, "real_time_factor", p->real_time_factor);
    lar_json_number(&json, "speed_up", p->speed_up);
    lar_json_number(&json, "efficiency", p->efficiency);
    lar_json_number(&json, "occupation", r->occupation);
    lar_json_open(&json, "occupation_over_step", '[');
    for (int i = 0; i < LAR_NETWORK_SLICES; i++) lar_json_number(&json, NULL, r->slice[i]);
    lar_json_close(&json);
    lar_json_number(&json, "start_step_us", 1e6 * r->start_step);
    lar_json_open(&json, "occupation_from_start", '[');
    for (int i = 0; i < LAR_NETWORK_START_SLICES; i++)
        lar_json_number(&json, NULL, r->start_slice[i]);
    lar_json_close(&json);
    lar_json_open(&json, "by_processor", '[');
    for (int32_t i = 0; i < r->processors; i++) write_processor(&json, &r->of[i]);
    lar_json_close(&json);
    if (report->check) write_check(&json, report->check);
    lar_json_end(&json);
}

static void print_occupation(const lar_network_result *r) {
    printf("\nlinks that send, of all, over the step: %.1f %% in the mean\n", 100 * r->occupation);
    for (int i = 0; i < LAR_NETWORK_SLICES; i++) {
        char bar[51] = "";
        int length = (int)(50 * r->slice[i] + 0.5);
        length = length < 0 ? 0 : length > 50 ? 50 : length;
        memset(bar, '#', (size_t)length);
        bar[length] = '\0';
        printf("%9.2f us %5.1f %% %s\n", 1e6 * r->step * i / LAR_NETWORK_SLICES, 100 * r->slice[i],
               bar);
    }
}

static void print_processors(const lar_network_result *r) {
    double all = r->step * r->threads;
    printf("\nper processor and step, of the time of its thread%s\n"
           "%-10s%10s%10s%10s%9s%12s%12s\n",
           r->threads > 1 ? "s" : "", "processor", "computes", "exchanges", "waits", "packets",
           "bytes sent", "received");
    for (int32_t i = 0; i < r->processors; i++) {
        const lar_network_processor *p = &r->of[i];
        printf("%-10d%8.1f %%%8.1f %%%8.1f %%%9" PRId64 "%12" PRId64 "%12" PRId64 "\n", (int)i,
               100 * p->compute / all, 100 * p->exchange / all, 100 * p->wait / all, p->packets,
               p->bytes_sent, p->bytes_received);
    }
}

static void print_check(const lar_predict_check *c) {
    printf("\n%-20s%15s%15s%17s%11s\n", "", "predicted [us]", "fastest [us]", "(median, most)",
           "quotient");
    for (int i = 0; i < LAR_PREDICT_CHECKS; i++)
        printf("%-6s by %-10s%15.2f%15.2f (%7.2f, %6.2f)%11.3f\n", c->grid[i], c->comm,
               1e6 * c->predicted[i], 1e6 * c->measured[i].min, 1e6 * c->measured[i].median,
               1e6 * c->measured[i].max, c->predicted[i] / c->measured[i].min);
}

void predict_report_print(const predict_report *report) {
    const lar_prediction *p = report->prediction;
    const lar_network_result *r = &p->network;
    print_machine(report->machine);
    printf("\n%-17s%d elements, %d nodes\n", "model", (int)p->elements, (int)p->nodes);
    printf("%-17s%d x %d x %d, %d processor%s with %d thread%s\n", "grid", (int)r->grid[0],
           (int)r->grid[1], (int)r->grid[2], (int)r->processors, r->processors > 1 ? "s" : "",
           (int)r->threads, r->threads > 1 ? "s" : "");
    printf("%-17s%s%s%s\n", "scheme", report->scheme, strcmp(report->scheme, "local") ? "" : " ",
           strcmp(report->scheme, "local") ? "" : report->channels);
    printf("%-17s%.2f us predicted; one processor with one thread %.2f us\n", "step", 1e6 * r->step,
           1e6 * p->alone);
    printf("%-17s%d simulated, the later half counts\n", "steps", (int)r->steps);
    if (!r->settled) print_unsettled("step", r->fastest, r->slowest);
    printf("%-17s%.2f, efficiency %.1f %%\n", "speed-up", p->speed_up, 100 * p->efficiency);
    if (p->time_step > 0)
        printf("%-17s%.3f (a step simulates %.4g us)\n", "real-time factor", p->real_time_factor,
               1e6 * p->time_step);
    print_occupation(r);
    print_processors(r);
    if (report->check) print_check(report->check);
}

/* ---- size scaling --------------------------------------------------------------------------- */

void predict_scaling_json(const predict_scaling *s) {
    lar_json json = lar_json_to(stdout);
    write_machine(&json, "machine", s->machine);
    lar_json_integer(&json, "threads", s->threads);
    lar_json_open(&json, "scaling", '[');
    for (int32_t i = 0; i < s->rows * s->scheme_count; i++) {
        const lar_block_prediction *b = &s->row[i];
        lar_json_open(&json, NULL, '{');
        lar_json_text(&json, "scheme", lar_predict_scheme_name[s->schemes[i % s->scheme_count]]);
        lar_json_integer(&json, "processors", s->processors[i / s->scheme_count]);
        lar_json_open(&json, "grid", '[');
        for (int k = 0; k < 3; k++) lar_json_integer(&json, NULL, b->grid[k]);
        lar_json_close(&json);
        lar_json_integer(&json, "elements_per_processor",
                         (int64_t)b->edge[0] * b->edge[1] * b->edge[2]);
        lar_json_number(&json, "step_us", 1e6 * b->step);
        write_settled(&json, b->steps, b->settled, b->fastest, b->slowest);
        lar_json_number(&json, "alone_us", 1e6 * b->alone);
        lar_json_number(&json, "efficiency", b->efficiency);
        lar_json_number(&json, "occupation", b->occupation);
        lar_json_integer(&json, "packets_max", b->packets_max);
        lar_json_integer(&json, "bytes_max", b->bytes_max);
        lar_json_close(&json);
    }
    lar_json_end(&json);
}

void predict_scaling_print(const predict_scaling *s) {
    const lar_block_prediction *first = s->row;
    print_machine(s->machine);
    printf("\nblocks of %d x %d x %d elements, %d thread%s per processor\n%-18s%11s%14s%12s%12s%12s"
           "%9s%11s\n",
           (int)first->edge[0], (int)first->edge[1], (int)first->edge[2], (int)s->threads,
           s->threads > 1 ? "s" : "", "scheme", "processors", "grid", "step [us]", "efficiency",
           "occupation", "packets", "bytes");
    for (int32_t i = 0; i < s->rows * s->scheme_count; i++) {
        const lar_block_prediction *b = &s->row[i];
        char grid[40];
        snprintf(grid, sizeof grid, "%dx%dx%d", (int)b->grid[0], (int)b->grid[1], (int)b->grid[2]);
        printf("%-18s%11d%14s%12.2f%10.1f %%%10.1f %%%9" PRId64 "%11" PRId64 "\n",
               lar_predict_scheme_name[s->schemes[i % s->scheme_count]],
               (int)s->processors[i / s->scheme_count], grid, 1e6 * b->step, 100 * b->efficiency,
               100 * b->occupation, b->packets_max, b->bytes_max);
    }
    for (int32_t i = 0; i < s->rows * s->scheme_count; i++) {
        const lar_block_prediction *b = &s->row[i];
        char what[64];
        if (b->settled) continue;
        snprintf(what, sizeof what, "%s, %d processors, %d steps",
                 lar_predict_scheme_name[s->schemes[i % s->scheme_count]],
                 (int)s->processors[i / s->scheme_count], (int)b->steps);
        print_unsettled(what, b->fastest, b->slowest);
    }
}

/* ---- critical sub-domain -------------------------------------------------------------------- */

void predict_critical_json(const lar_critical_options *o, const lar_critical *critical) {
    lar_json json = lar_json_to(stdout);
    lar_json_integer(&json, "processors", o->processors);
    lar_json_integer(&json, "threads", o->threads);
    lar_json_number(&json, "efficiency", o->efficiency);
    lar_json_integer(&json, "elements_most", (int64_t)o->edge_max * o->edge_max * o->edge_max);
    lar_json_open(&json, "critical", '[');
    for (int32_t m = 0; m < o->machines; m++)
        for (int s = 0; s < LAR_PREDICT_SCHEMES; s++) {
            lar_json_open(&json, NULL, '{');
            lar_json_text(&json, "name", o->machine[m].name);
            lar_json_text(&json, "scheme", lar_predict_scheme_name[s]);
            lar_json_integer(&json, "elements_per_processor", critical[m].elements[s]);
            lar_json_number(&json, "efficiency", critical[m].efficiency[s]);
            lar_json_boolean(&json, "settled", !critical[m].unsettled[s]);
            lar_json_close(&json);
        }
    lar_json_end(&json);
}

void predict_critical_print(const lar_critical_options *o, const lar_critical *critical) {
    printf("elements per processor for an efficiency of %g %%, %d processors with %d thread%s\n\n"
           "%-18s",
           100 * o->efficiency, (int)o->processors, (int)o->threads, o->threads > 1 ? "s" : "",
           "machine");
    for (int s = 0; s < LAR_PREDICT_SCHEMES; s++) printf("%18s", lar_predict_scheme_name[s]);
    printf("\n");
    for (int32_t m = 0; m < o->machines; m++) {
        printf("%-18s", o->machine[m].name);
        for (int s = 0; s < LAR_PREDICT_SCHEMES; s++) {
            char cell[32];
            if (critical[m].elements[s])
                snprintf(cell, sizeof cell, "%d", (int)critical[m].elements[s]);
            else
                snprintf(cell, sizeof cell, "more (%.0f %%)", 100 * critical[m].efficiency[s]);
            printf("%18s", cell);
        }
        printf("\n");
    }
    for (int32_t m = 0; m < o->machines; m++)
        for (int s = 0; s < LAR_PREDICT_SCHEMES; s++)
            if (critical[m].unsettled[s])
                printf("%s, %s: not settled. Some block is on both sides of %g %%; with more steps "
                       "(--steps) the answer may change.\n",
                       o->machine[m].name, lar_predict_scheme_name[s], 100 * o->efficiency);
}
