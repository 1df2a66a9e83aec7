/* lariat bench jitter: timer jitter and scheduling latency of this machine. */
#include <inttypes.h>
#include <stdio.h>

#include "cli/bench/frame.h"
#include "cli/commands.h"
#include "study/bench/jitter.h"

static void write_percentiles(lar_json *json, const char *name, const lar_percentiles *p) {
    lar_json_open(json, name, '{');
    lar_json_number(json, "p50", p->p50);
    lar_json_number(json, "p99", p->p99);
    lar_json_number(json, "p999", p->p999);
    lar_json_number(json, "max", p->max);
    lar_json_close(json);
}

static void write_json(const bench_frame *frame, const lar_bench_jitter_options *o,
                       const lar_bench_jitter_result *r) {
    lar_json json = bench_open_json(frame);
    lar_json_number(&json, "period_us", r->period);
    lar_json_number(&json, "load_us", o->load);
    lar_json_integer(&json, "priority", o->priority);
    lar_json_integer(&json, "samples", r->repeat);
    lar_json_number(&json, "seconds_per_sample", o->seconds);
    lar_json_integer(&json, "ticks", (int64_t)r->ticks);
    lar_json_integer(&json, "misses", (int64_t)r->misses);
    lar_json_number(&json, "missed", r->missed);
    lar_json_number(&json, "skipped", r->skipped);
    write_percentiles(&json, "late_us", &r->late);
    write_percentiles(&json, "done_us", &r->done);
    bench_write_spread(&json, "late_p50_us_spread", &r->late_p50);
    bench_write_spread(&json, "late_p99_us_spread", &r->late_p99);
    bench_write_spread(&json, "missed_spread", &r->missed_of);
    bench_close_json(frame, &json);
}

static void print_percentiles(const char *name, const lar_percentiles *p) {
    printf("%-17shalf below %.2f us, 99 %% below %.2f, 99.9 %% below %.2f, the most %.1f\n", name,
           p->p50, p->p99, p->p999, p->max);
}

static void print_table(const lar_bench_jitter_options *o, const lar_bench_jitter_result *r) {
    printf("%" PRIu64 " ticks of %.0f us, %d turns of %g s, %.4g us of computation in each, ",
           r->ticks, r->period, r->repeat, o->seconds, o->load);
    if (o->priority > 0)
        printf("priority %d\n", o->priority);
    else
        printf("ordinary priority\n");
    print_percentiles("due to awake", &r->late);
    if (o->load > 0) print_percentiles("due to done", &r->done);
    printf("%-17s%" PRIu64 ", %.3g %% (%.3g to %.3g %% of a turn)\n", "misses", r->misses,
           100 * r->missed, 100 * r->missed_of.min, 100 * r->missed_of.max);
    if (r->skipped > 0) printf("%-17s%.3g s\n", "given up", r->skipped);
}

static int report(bench_frame *frame, const lar_bench_jitter_options *o,
                  const lar_bench_jitter_result *r) {
    lar_bench_report *report = &frame->report;
    lar_bench_add(report, "us", r->late.p50, false, "late_us.p50");
    lar_bench_add(report, "us", r->late.p99, true, "late_us.p99");
    lar_bench_add(report, "us", r->late.p999, false, "late_us.p999");
    lar_bench_add(report, "us", r->late.max, false, "late_us.max");
    lar_bench_add(report, "us", r->done.p50, o->load > 0, "done_us.p50");
    lar_bench_add(report, "us", r->done.p99, false, "done_us.p99");
    lar_bench_add(report, "", r->missed, false, "missed");
    if (frame->json)
        write_json(frame, o, r);
    else
        print_table(o, r);
    return bench_end(frame);
}

static int measure(bench_frame *frame, const lar_bench_jitter_options *wanted) {
    lar_bench_jitter_result result;
    lar_error error;
    lar_bench_set_number(&frame->report, "load", wanted->load);
    lar_bench_set_number(&frame->report, "priority", wanted->priority);
    int status = bench_begin(frame);
    if (status) return status;
    if (!lar_bench_jitter(wanted, &result, &error)) return report(frame, wanted, &result);
    return bench_abandon(frame, cli_complain(&cli_bench_jitter, CLI_FAILED, "%s", error.message));
}

static int jitter_main(int argc, char **argv) {
    lar_bench_jitter_options wanted = {.seconds = 2};
    int64_t repeat = 5, priority = 0;
    bench_frame frame = bench_frame_of(&cli_bench_jitter, "jitter");
    const cli_option options[] = {
        CLI_REAL("--seconds", "S", "of a turn (2)", &wanted.seconds, 0.01, 3600),
        CLI_COUNT("--repeat", "N", "turns (5)", &repeat, 1, LAR_BENCH_REPEAT_MAX),
        CLI_REAL("--load", "US", "microseconds of computation in every tick (0)", &wanted.load, 0,
                 LAR_BENCH_JITTER_LOAD_MAX),
        CLI_COUNT("--priority", "N",
                  "before all ordinary threads of the machine (SCHED_FIFO);\nneeds the right to "
                  "(ulimit -r, root)",
                  &priority, 1, 99),
        BENCH_OPTIONS(frame),
        CLI_END};
    int status = cli_parse(&cli_bench_jitter, options, argc, argv, NULL, 0);
    if (status >= 0) return status;
    wanted.repeat = (int)repeat;
    wanted.priority = (int)priority;
    return measure(&frame, &wanted);
}

const cli_command cli_bench_jitter = {
    .name = "bench jitter",
    .summary = "timer jitter and scheduling latency, a thousand times a second",
    .arguments = "",
    .description =
        "A thread wakes every millisecond as a session's does, and computes nothing, or for as\n"
        "long as --load says. How late it wakes, and how many ticks it misses, no simulation on\n"
        "this machine can do better.",
    .examples = "  lariat bench jitter\n"
                "  lariat bench jitter --load 210 --priority 10 --seconds 12\n"
                "  lariat bench jitter --json\n",
    .main = jitter_main};
