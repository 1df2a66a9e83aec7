#include "cli/report/view.h"

#include <inttypes.h>

#include "cli/parallel.h"
#include "cli/report/mass_scaling.h"
#include "cli/report/run.h"
#include "base/json/write.h"

static const char *const state_names[] = {"idle", "playing", "paused", "stopped"};
static const char *const cause_names[] = {"", "step", "division", "machine"};

static void write_times(lar_json *json, const char *name, double p50, double p99, double p999,
                        double max) {
    lar_json_open(json, name, '{');
    lar_json_number(json, "p50", 1e6 * p50);
    lar_json_number(json, "p99", 1e6 * p99);
    lar_json_number(json, "p999", 1e6 * p999);
    lar_json_number(json, "max", 1e6 * max);
    lar_json_close(json);
}

static int32_t max_parts(const view_report *report) {
    int32_t max;
    lar_simulation_divided_steps(report->simulation, &max);
    return max;
}

static void write_tools(lar_json *json, const view_report *report) {
    lar_json_open(json, "tools", '[');
    for (int32_t i = 0; i < report->tools; i++) {
        const lar_tool_load *load = &report->tool[i].load;
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "tool", report->tool[i].name);
        lar_json_number(json, "largest_force", load->force);
        lar_json_number(json, "limit", load->limit);
        lar_json_boolean(json, "limit_reached", load->reached != 0);
        lar_json_number(json, "largest_grasp", load->grasp_force);
        lar_json_close(json);
    }
    lar_json_close(json);
}

static void print_tools(const view_report *report, FILE *out) {
    for (int32_t i = 0; i < report->tools; i++) {
        const lar_tool_load *load = &report->tool[i].load;
        fprintf(out, "%-17s%s: largest force %.3g N", "tool", report->tool[i].name, load->force);
        if (load->limit > 0)
            fprintf(out, ", limit %.3g N%s", load->limit,
                    load->reached ? "; the limit was reached" : "");
        if (load->grasp_force > 0)
            fprintf(out, "; jaws grasped with up to %.3g N", load->grasp_force);
        fputc('\n', out);
    }
}

/* VIEW_DEVICES at most. Packets are counted for devices on the network only. */
static void write_devices(lar_json *json, const view_report *report) {
    lar_json_open(json, "devices", '[');
    for (int32_t i = 0; i < report->devices; i++) {
        const lar_device_status *d = &report->device[i].status;
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "tool", report->device[i].tool);
        lar_json_text(json, "device", report->device[i].name);
        lar_json_integer(json, "port", d->port);
        lar_json_boolean(json, "connected", d->connected != 0);
        lar_json_integer(json, "received", (int64_t)d->received);
        lar_json_integer(json, "answered", (int64_t)d->answered);
        lar_json_integer(json, "refused", (int64_t)d->refused);
        lar_json_integer(json, "late", (int64_t)d->late);
        lar_json_integer(json, "lost", (int64_t)d->lost);
        lar_json_integer(json, "timeouts", (int64_t)d->timeouts);
        write_times(json, "answer_us", d->answer_p50, d->answer_p99, d->answer_p999, d->answer_max);
        lar_json_close(json);
    }
    lar_json_close(json);
}

static void print_devices(const view_report *report, FILE *out) {
    for (int32_t i = 0; i < report->devices; i++) {
        const lar_device_status *d = &report->device[i].status;
        fprintf(out, "%-17s%s: %s\n", "device", report->device[i].tool, report->device[i].name);
        if (d->port == 0) continue;
        fprintf(out,
                "%-17s%" PRIu64 " positions, %" PRIu64 " forces; %" PRIu64 " lost, %" PRIu64
                " late, %" PRIu64 " refused, silent %" PRIu64 " times\n",
                "", d->received, d->answered, d->lost, d->late, d->refused, d->timeouts);
        if (d->answered)
            fprintf(out,
                    "%-17sanswered within %.4g us (median), 99 %% below %.4g, 99.9 %% below %.4g, "
                    "longest %.4g\n",
                    "", 1e6 * d->answer_p50, 1e6 * d->answer_p99, 1e6 * d->answer_p999,
                    1e6 * d->answer_max);
    }
}

void view_report_json(const view_report *report, FILE *out) {
    const lar_session_status *s = &report->status;
    lar_json json = lar_json_to(out);
    lar_json_text(&json, "title", report->info.title);
    lar_json_text(&json, "url", report->url);
    lar_json_integer(&json, "elements", report->info.elements);
    lar_json_integer(&json, "nodes", report->info.nodes);
    cli_write_parallel(&json, report->parallel);
    lar_json_integer(&json, "redivisions", (int64_t)lar_simulation_redivisions(report->simulation));
    lar_json_text(&json, "isa", lar_simulation_isa(report->simulation));
    lar_json_text(&json, "state", state_names[s->state]);
    lar_json_text(&json, "message", s->message);
    lar_json_integer(&json, "steps", (int64_t)s->step);
    lar_json_number(&json, "time", s->time);
    lar_json_number(&json, "time_step", lar_simulation_time_step(report->simulation));
    lar_json_number(&json, "pace", report->pace);
    lar_json_number(&json, "wall_time", report->elapsed);
    lar_json_number(&json, "real_time_factor", s->real_time_factor);
    lar_json_integer(&json, "ticks", (int64_t)s->ticks);
    lar_json_integer(&json, "deadline_misses", (int64_t)s->misses);
    lar_json_integer(&json, "slow_ticks", (int64_t)s->slow_ticks);
    write_times(&json, "wall_per_step_us", s->step_p50, s->step_p99, s->step_p999, s->step_max);
    write_times(&json, "wall_per_tick_us", s->tick_p50, s->tick_p99, s->tick_p999, s->tick_max);
    lar_json_integer(&json, "slow_motion", report->slow_times);
    lar_json_text(&json, "slow_cause", cause_names[report->slow_cause]);
    lar_json_number(&json, "skipped", s->skipped);
    lar_json_integer(&json, "recoveries", (int64_t)s->recoveries);
    lar_json_text(&json, "recovery", s->recovery);
    lar_json_integer(&json, "divided_steps", (int64_t)s->divided_steps);
    lar_json_integer(&json, "most_parts", max_parts(report));
    cli_write_heavier(&json, report->simulation);
    lar_json_integer(&json, "viewers", report->viewers_max);
    write_tools(&json, report);
    write_devices(&json, report);
    lar_json_hash(&json, "state_hash", lar_simulation_hash(report->simulation));
    lar_json_end(&json);
}

static void print_pace(const view_report *report, FILE *out) {
    static const char *const why[] = {
        "", ", because steps take longer than the time they stand for",
        ", because strained tissue divided the steps", ", because the machine was busy"};
    const lar_session_status *s = &report->status;
    fprintf(out, "%-17s%.3f", "real-time factor", s->real_time_factor);
    if (report->slow_times > 0)
        fprintf(out, "; slow motion began %" PRId64 " time%s%s; %.3g s were given up",
                report->slow_times, report->slow_times == 1 ? "" : "s", why[report->slow_cause],
                s->skipped);
    fprintf(out, "\n");
}

void view_report_table(const view_report *report, FILE *out) {
    const lar_session_status *s = &report->status;
    bool titled = *report->info.title != '\0';
    fprintf(out, "%s: %d elements, %d nodes (%s)\n", titled ? report->info.title : report->scene,
            (int)report->info.elements, (int)report->info.nodes,
            lar_simulation_isa(report->simulation));
    if (report->parallel->divided)
        fprintf(out, "%-17s%s: %d processor%s, scheme %s, by %s\n", "grid", report->parallel->grid,
                (int)report->parallel->processors, report->parallel->processors == 1 ? "" : "s",
                report->parallel->scheme, report->parallel->comm);
    cli_print_reason(report->parallel, out);
    fprintf(out, "%-17s%.6g s in %" PRIu64 " steps of %.4g s\n", "simulated", s->time, s->step,
            lar_simulation_time_step(report->simulation));
    print_pace(report, out);
    if (s->ticks > 0) {
        fprintf(out, "%-17s%" PRIu64 ", %" PRIu64 " missed (%.3f %%)", "ticks", s->ticks, s->misses,
                100 * (double)s->misses / (double)s->ticks);
        if (s->slow_ticks > 0)
            fprintf(out, "; %" PRIu64 " more were late in slow motion", s->slow_ticks);
        fprintf(out,
                "\n%-17smedian %.3f ms, 99 %% below %.3f ms, 99.9 %% below %.3f ms, longest "
                "%.3f ms\n",
                "a tick's forces", 1e3 * s->tick_p50, 1e3 * s->tick_p99, 1e3 * s->tick_p999,
                1e3 * s->tick_max);
        run_report_steps(1e6 * s->step_p50, 1e6 * s->step_p99, 1e6 * s->step_p999,
                         1e6 * s->step_max, out);
    }
    if (s->recoveries > 0)
        fprintf(out, "%-17s%" PRIu64 "; the last time it %s\n", "recoveries", s->recoveries,
                s->recovery);
    if (s->divided_steps > 0)
        fprintf(out, "%-17s%" PRIu64 " steps, into %d parts at most\n", "divided", s->divided_steps,
                (int)max_parts(report));
    cli_print_heavier(report->simulation, out);
    cli_print_redivisions(report->simulation, out);
    print_tools(report, out);
    print_devices(report, out);
    fprintf(out, "%-17s%d at once at most\n", "viewers", (int)report->viewers_max);
    fprintf(out, "%-17s%016" PRIx64 "\n", "state hash", lar_simulation_hash(report->simulation));
}
