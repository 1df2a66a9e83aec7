/* lariat doctor: what this build can do, what is missing, and what this machine is good for. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "cli/build_info.h"
#include "cli/commands.h"
#include "base/json/write.h"
#include "study/doctor.h"

typedef struct findings {
    lar_feature feature[LAR_FEATURES];
    lar_doctor_machine here;
    lar_doctor_measured measured;
    bool is_measured;
} findings;

/* ---- for machines ----------------------------------------------------------------------- */

static void write_measured(lar_json *json, const findings *f) {
    const lar_doctor_measured *m = &f->measured;
    lar_json_open(json, "wakes_late_us", '{');
    lar_json_number(json, "p50", m->late.p50);
    lar_json_number(json, "p99", m->late.p99);
    lar_json_number(json, "p999", m->late.p999);
    lar_json_number(json, "max", m->late.max);
    lar_json_close(json);
    lar_json_number(json, "missed", m->missed);
    lar_json_number(json, "wall_per_step_us", 1e6 * m->step);
    lar_json_number(json, "time_step", m->time_step);
    lar_json_integer(json, "elements", m->elements);
    lar_json_number(json, "bytes_per_element", m->bytes);
    lar_json_number(json, "real_time_elements", floor(m->holds));
    lar_json_number(json, "memory_elements", m->fits > 0 ? floor(m->fits) : NAN);
}

static void write_json(const findings *f) {
    const lar_doctor_machine *here = &f->here;
    lar_json json = lar_json_to(stdout);
    lar_json_text(&json, "version", lar_version());
    lar_json_text(&json, "commit", cli_build_commit);
    lar_json_text(&json, "compiler", cli_build_compiler);
    lar_json_text(&json, "flags", cli_build_flags);
    lar_json_open(&json, "features", '[');
    for (int i = 0; i < LAR_FEATURES; i++) {
        lar_json_open(&json, NULL, '{');
        lar_json_text(&json, "name", f->feature[i].name);
        lar_json_text(&json, "gives", f->feature[i].gives);
        lar_json_boolean(&json, "there", f->feature[i].there);
        lar_json_text(&json, "get", f->feature[i].there ? "" : f->feature[i].get);
        lar_json_close(&json);
    }
    lar_json_close(&json);
    lar_json_text(&json, "cpu", here->machine.cpu);
    lar_json_integer(&json, "cores", here->machine.cores);
    lar_json_integer(&json, "usable_cores", here->usable_cores);
    lar_json_text(&json, "isa", here->machine.isa);
    lar_json_number(&json, "load", here->machine.load[0] < 0 ? NAN : here->machine.load[0]);
    lar_json_number(&json, "memory", here->memory > 0 ? here->memory : NAN);
    lar_json_number(&json, "free_memory", here->free > 0 ? here->free : NAN);
    lar_json_boolean(&json, "real_time_priority", here->priority);
    lar_json_number(&json, "clock_tick", here->clock_tick);
    if (f->is_measured) write_measured(&json, f);
    lar_json_end(&json);
}

/* ---- for people ------------------------------------------------------------------------- */

static void print_features(const findings *f) {
    printf("\nWhat this build can do\n");
    for (int i = 0; i < LAR_FEATURES; i++) {
        const lar_feature *feature = &f->feature[i];
        printf("  %-5s%s\n", feature->there ? "yes" : "no", feature->gives);
        if (!feature->there) printf("       to get it: %s\n", feature->get);
    }
}

static void print_machine(const lar_doctor_machine *here) {
    static const double GB = 1e9;
    printf("\nThis machine\n");
    printf("  %-17s%s\n", "processor", here->machine.cpu);
    printf("  %-17s%d, of which this process may use %d\n", "cores", (int)here->machine.cores,
           (int)here->usable_cores);
    printf("  %-17s%s\n", "instruction set",
           strcmp(here->machine.isa, "unknown") != 0
               ? here->machine.isa
               : "none: the variable LARIAT_ISA asks for one that this machine lacks; unset it");
    if (here->free > 0)
        printf("  %-17s%.3g GB, %.3g GB of them free\n", "memory", here->memory / GB,
               here->free / GB);
    printf("  %-17s%s\n", "priority",
           here->priority
               ? "threads may go before all others: lariat view --priority 10"
               : "threads may not go before others, ticks come late when the machine is busy;\n"
                 "                   to allow it: a line \"@users - rtprio 10\" in "
                 "/etc/security/limits.d/lariat.conf,\n"
                 "                   the user in that group, and a new login");
    printf("  %-17sits clock counts steps of %.3g ns\n", "timer", 1e9 * here->clock_tick);
}

/* To two digits: the figure is no better. */
static double round_to_two(double value) {
    if (!(value > 0)) return 0;
    double unit = pow(10, floor(log10(value)) - 1);
    return floor(value / unit) * unit;
}

static void print_measured(const findings *f) {
    static const double BUSY = 0.5;
    const lar_doctor_measured *m = &f->measured;
    printf("  %-17sa thread that should wake every millisecond is late by %.*f us (median),\n"
           "  %-17s99 %% of the times by less than %.0f us, at most by %.0f us\n",
           "", m->late.p50 < 10 ? 1 : 0, m->late.p50, "", m->late.p99, m->late.max);
    if (f->here.machine.load[0] > BUSY)
        printf(
            "  %-17s%.1f threads wanted to run in the last minute: what is measured is less than\n"
            "  %-17sthis machine can do alone\n",
            "load", f->here.machine.load[0], "");
    printf("\nWhat it holds\n");
    printf("  %-17sabout %.0f elements on one core, for a body as large and as stiff as the\n"
           "  %-17sdemonstration organ, of which a step of %.3g us took %.3g us (%d elements)\n",
           "in real time", round_to_two(m->holds), "", 1e6 * m->time_step, 1e6 * m->step,
           (int)m->elements);
    if (f->here.usable_cores > 1)
        printf("  %-17smore on several, with --grid: lariat bench scaling measures how many\n", "");
    printf("  %-17slariat info SCENE says it for a model of yours\n", "");
    if (m->fits > 0)
        printf("  %-17sabout %.2g million elements, of %.0f bytes while they are computed, half "
               "as\n"
               "  %-17smany again on one processor, and more on several, while they are set up\n",
               "in memory", 1e-6 * round_to_two(m->fits), m->bytes, "");
}

static void print_report(const findings *f) {
    printf("Lariat %s, commit %s, %s\n", lar_version(), cli_build_commit, cli_build_compiler);
    print_features(f);
    print_machine(&f->here);
    if (f->is_measured) print_measured(f);
}

/* ---- the command ------------------------------------------------------------------------ */

static int doctor_main(int argc, char **argv) {
    bool json = false, no_speed = false;
    const cli_option options[] = {
        CLI_FLAG("--no-speed", "measure nothing, which takes two or three seconds", &no_speed),
        CLI_FLAG("--json", "one JSON object on standard output", &json), CLI_END};
    int status = cli_parse(&cli_doctor, options, argc, argv, NULL, 0);
    if (status >= 0) return status;
    findings f = {.is_measured = !no_speed};
    lar_error error;
    lar_features_look(f.feature);
    lar_doctor_look(&f.here);
    bool shown = f.is_measured && isatty(STDERR_FILENO);
    if (shown) fputs("measuring this machine", stderr);
    bool failed = f.is_measured && lar_doctor_measure(&f.here, &f.measured, &error);
    if (shown) fputs("\r\033[K", stderr);
    f.is_measured = f.is_measured && !failed;
    if (json)
        write_json(&f);
    else
        print_report(&f);
    fflush(stdout);
    return failed ? cli_complain(&cli_doctor, CLI_FAILED, "%s", error.message) : CLI_DONE;
}

const cli_command cli_doctor = {
    .name = "doctor",
    .summary = "what this build can do, and what this machine is good for",
    .arguments = "",
    .description =
        "Lists the optional parts of Lariat with what they give, whether they are there, and how\n"
        "to get them; then the machine's cores, instruction set, memory, timer and whether\n"
        "threads may have real-time priority; then, measured in two or three seconds, how large\n"
        "a model it holds in real time and in memory.",
    .examples = "  lariat doctor\n"
                "  lariat doctor --no-speed --json\n",
    .main = doctor_main};
