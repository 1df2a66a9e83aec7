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
    const char *cpu = lar_baseline_text(frame->baseline, "machine.cpu");
    if (cpu && strcmp(cpu, frame->machine.cpu) != 0)
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

static void write_options(const lar_bench_report *report, json_writer *json) {
    json_open(json, "options", '{');
    for (int i = 0; i < report->settings; i++) {
        const lar_bench_setting *setting = &report->setting[i];
        double value;
        if (setting->number && sscanf(setting->text, "%lf", &value) == 1)
            json_number(json, setting->name, value);
        else
            json_text(json, setting->name, setting->text);
    }
    json_close(json);
}

json_writer bench_open_json(const bench_frame *frame) {
    const lar_machine *machine = &frame->machine;
    json_writer json = json_begin(stdout);
    json_text(&json, "bench", frame->report.bench);
    write_options(&frame->report, &json);
    json_open(&json, "build", '{');
    json_text(&json, "version", lar_version());
    json_text(&json, "commit", cli_build_commit);
    json_text(&json, "compiler", cli_build_compiler);
    json_text(&json, "flags", cli_build_flags);
    json_close(&json);
    json_open(&json, "machine", '{');
    json_text(&json, "cpu", machine->cpu);
    json_integer(&json, "cores", machine->cores);
    json_text(&json, "isa", machine->isa);
    json_vector(&json, "load_average", machine->load);
    json_close(&json);
    json_text(&json, "date", machine->date);
    return json;
}

static void write_comparison(const bench_frame *frame, json_writer *json) {
    const lar_bench_report *report = &frame->report;
    json_open(json, "against", '{');
    json_text(json, "file", frame->against);
    json_number(json, "tolerance", frame->tolerance);
    json_open(json, "compared", '[');
    for (int i = 0; i < report->figures; i++) {
        lar_comparison c =
            lar_baseline_compare(frame->baseline, &report->figure[i], frame->tolerance);
        if (!c.known) continue;
        json_open(json, NULL, '{');
        json_text(json, "name", report->figure[i].name);
        json_number(json, "earlier", c.earlier);
        json_number(json, "ratio", c.ratio);
        json_number(json, "worse", c.worse);
        json_boolean(json, "failed", c.failed);
        json_close(json);
    }
    json_close(json);
    json_close(json);
}

void bench_close_json(const bench_frame *frame, json_writer *json) {
    json_open(json, "figures", '[');
    for (int i = 0; i < frame->report.figures; i++) {
        const lar_bench_figure *figure = &frame->report.figure[i];
        json_open(json, NULL, '{');
        json_text(json, "name", figure->name);
        json_text(json, "unit", figure->unit);
        json_number(json, "value", figure->value);
        json_text(json, "better", figure->more ? "more" : "less");
        json_boolean(json, "judged", figure->judged);
        json_close(json);
    }
    json_close(json);
    if (frame->baseline) write_comparison(frame, json);
    json_end(json);
}

void bench_write_spread(json_writer *json, const char *name, const lar_spread *spread) {
    json_open(json, name, '{');
    json_number(json, "min", spread->min);
    json_number(json, "p25", spread->p25);
    json_number(json, "median", spread->median);
    json_number(json, "p75", spread->p75);
    json_number(json, "p95", spread->p95);
    json_number(json, "max", spread->max);
    json_close(json);
}

/* ---- for people ------------------------------------------------------------------------- */

static void print_comparison(const bench_frame *frame) {
    const lar_bench_report *report = &frame->report;
    const char *date = lar_baseline_text(frame->baseline, "date");
    const char *commit = lar_baseline_text(frame->baseline, "build.commit");
    printf("\nagainst %s, measured %s, commit %.12s\n", frame->against, date ? date : "one day",
           commit ? commit : "unknown");
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
    const char *missing = lar_baseline_missing(frame->baseline, report);
    if (missing)
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
