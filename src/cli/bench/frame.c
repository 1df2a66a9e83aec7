#include "cli/bench/frame.h"

#include <stdio.h>
#include <string.h>

#include "cli/build_info.h"
#include "lariat.h"

bench_frame bench_frame_of(const cli_command *command, const char *bench) {
    return (bench_frame){.command = command, .tolerance = -1, .report = {.bench = bench}};
}

/* ---- before --------------------------------------------------------------------------------- */

/* Another processor is worth a word, no refusal: that may be the question. */
static void note_other_machine(const bench_frame *frame) {
    char cpu[sizeof frame->machine.cpu];
    if (lar_baseline_text(frame->baseline, "machine.cpu", cpu, sizeof cpu) &&
        strcmp(cpu, frame->machine.cpu) != 0)
        cli_complain(frame->command, CLI_DONE, "note: %s was measured on another processor: %s",
                     frame->against, cpu);
}

int bench_begin(bench_frame *frame) {
    lar_error error;
    lar_machine_look(&frame->machine);
    if (frame->tolerance >= 0 && !frame->against)
        return cli_complain(frame->command, CLI_USAGE,
                            "--tolerance is for a comparison; say with what: --against FILE");
    if (frame->tolerance < 0) frame->tolerance = 10;
    if (!frame->against) return CLI_DONE;
    if (lar_baseline_open(frame->against, &frame->baseline, &error) ||
        lar_baseline_match(frame->baseline, &frame->report, &error))
        return bench_abandon(frame, cli_complain(frame->command, CLI_FAILED, "%s", error.message));
    note_other_machine(frame);
    return CLI_DONE;
}

/* ---- for machines ----------------------------------------------------------------------- */

static void write_options(const lar_bench_report *report, lar_json *json) {
    lar_json_open(json, "options", '{');
    for (int i = 0; i < report->settings; i++) {
        const lar_bench_setting *setting = &report->setting[i];
        double value;
        if (setting->number && sscanf(setting->text, "%lf", &value) == 1)
            lar_json_number(json, setting->name, value);
        else
            lar_json_text(json, setting->name, setting->text);
    }
    lar_json_close(json);
}

lar_json bench_open_json(const bench_frame *frame) {
    const lar_machine *machine = &frame->machine;
    lar_json json = lar_json_to(stdout);
    lar_json_text(&json, "bench", frame->report.bench);
    write_options(&frame->report, &json);
    lar_json_open(&json, "build", '{');
    lar_json_text(&json, "version", lar_version());
    lar_json_text(&json, "commit", cli_build_commit);
    lar_json_text(&json, "compiler", cli_build_compiler);
    lar_json_text(&json, "flags", cli_build_flags);
    lar_json_close(&json);
    lar_json_open(&json, "machine", '{');
    lar_json_text(&json, "cpu", machine->cpu);
    lar_json_integer(&json, "cores", machine->cores);
    lar_json_text(&json, "isa", machine->isa);
    lar_json_vector(&json, "load_average", machine->load, 3);
    lar_json_close(&json);
    lar_json_text(&json, "date", machine->date);
    return json;
}

static void write_comparison(const bench_frame *frame, lar_json *json) {
    const lar_bench_report *report = &frame->report;
    lar_json_open(json, "against", '{');
    lar_json_text(json, "file", frame->against);
    lar_json_number(json, "tolerance", frame->tolerance);
    lar_json_open(json, "compared", '[');
    for (int i = 0; i < report->figures; i++) {
        lar_comparison c =
            lar_baseline_compare(frame->baseline, &report->figure[i], frame->tolerance);
        if (!c.known) continue;
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "name", report->figure[i].name);
        lar_json_number(json, "earlier", c.earlier);
        lar_json_number(json, "ratio", c.ratio);
        lar_json_number(json, "worse", c.worse);
        lar_json_boolean(json, "failed", c.failed);
        lar_json_close(json);
    }
    lar_json_close(json);
    lar_json_close(json);
}

void bench_close_json(const bench_frame *frame, lar_json *json) {
    lar_json_open(json, "figures", '[');
    for (int i = 0; i < frame->report.figures; i++) {
        const lar_bench_figure *figure = &frame->report.figure[i];
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "name", figure->name);
        lar_json_text(json, "unit", figure->unit);
        lar_json_number(json, "value", figure->value);
        lar_json_text(json, "better", figure->more ? "more" : "less");
        lar_json_boolean(json, "judged", figure->judged);
        lar_json_close(json);
    }
    lar_json_close(json);
    if (frame->baseline) write_comparison(frame, json);
    lar_json_end(json);
}

void bench_write_spread(lar_json *json, const char *name, const lar_spread *spread) {
    lar_json_open(json, name, '{');
    lar_json_number(json, "min", spread->min);
    lar_json_number(json, "p25", spread->p25);
    lar_json_number(json, "median", spread->median);
    lar_json_number(json, "p75", spread->p75);
    lar_json_number(json, "p95", spread->p95);
    lar_json_number(json, "max", spread->max);
    lar_json_close(json);
}

/* ---- for people ------------------------------------------------------------------------- */

static void print_comparison(const bench_frame *frame) {
    const lar_bench_report *report = &frame->report;
    char date[LAR_BENCH_TEXT] = "one day", commit[LAR_BENCH_TEXT] = "unknown";
    lar_baseline_text(frame->baseline, "date", date, sizeof date);
    lar_baseline_text(frame->baseline, "build.commit", commit, sizeof commit);
    printf("\nagainst %s, measured %s, commit %.12s\n", frame->against, date, commit);
    printf("%-32s %12s %12s %8s\n", "", "now", "then", "ratio");
    for (int i = 0; i < report->figures; i++) {
        const lar_bench_figure *figure = &report->figure[i];
        lar_comparison c = lar_baseline_compare(frame->baseline, figure, frame->tolerance);
        printf("%-32s %12.5g", figure->name, figure->value);
        if (c.known) printf(" %12.5g", c.earlier);
        if (c.known && c.ratio > 0) printf(" %8.3f", c.ratio);
        printf(" %s%s\n", figure->unit, c.failed ? "   worse" : c.known ? "" : "   new");
    }
}

/* ---- after ---------------------------------------------------------------------------------- */

static int complain_of_worst(const bench_frame *frame, const lar_bench_figure *worst, int failed) {
    lar_comparison c = lar_baseline_compare(frame->baseline, worst, frame->tolerance);
    char others[48] = "", by[48] = "worse";
    if (failed > 1)
        snprintf(others, sizeof others, ", and %d other%s", failed - 1, failed > 2 ? "s" : "");
    if (c.worse > 0) snprintf(by, sizeof by, "%.3g %% worse", c.worse);
    return cli_complain(frame->command, CLI_FAILED,
                        "%s is %s than in %s (%.5g %s, then %.5g)%s; %g %% are allowed. Measure "
                        "again on a quiet machine, or look for what has changed",
                        worst->name, by, frame->against, worst->value, worst->unit, c.earlier,
                        others, frame->tolerance);
}

static int judge(const bench_frame *frame) {
    const lar_bench_report *report = &frame->report;
    const lar_bench_figure *worst = NULL;
    double max = 0;
    int failed = 0;
    for (int i = 0; i < report->figures; i++) {
        lar_comparison c =
            lar_baseline_compare(frame->baseline, &report->figure[i], frame->tolerance);
        if (!c.failed) continue;
        if (!worst || c.worse > max) worst = &report->figure[i], max = c.worse;
        failed++;
    }
    if (worst) return complain_of_worst(frame, worst, failed);
    char missing[LAR_BENCH_TEXT];
    if (lar_baseline_missing(frame->baseline, report, missing))
        return cli_complain(frame->command, CLI_FAILED,
                            "%s stands in %s and was not measured now; see above why, or write "
                            "the file anew with --json",
                            missing, frame->against);
    return CLI_DONE;
}

int bench_end(bench_frame *frame) {
    if (!frame->baseline) return CLI_DONE;
    if (!frame->json) print_comparison(frame);
    return bench_abandon(frame, judge(frame));
}

int bench_abandon(bench_frame *frame, int status) {
    lar_baseline_close(frame->baseline);
    frame->baseline = NULL;
    return status;
}
