/* lariat predict: how fast a step would be on a machine that is not here. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/parallel.h"
#include "cli/report/predict.h"
#include "study/bench/kernel.h"
#include "study/predict/network_trace.h"

enum { ROWS_MAX = 16, MACHINES_MAX = 16, CRITICAL_EDGE = 40 };

typedef struct predict_settings {
    const char *scene;
    cli_parallel parallel;
    const char *machine, *speed, *csv, *svg, *scale;
    double latency, bandwidth, overhead; /* below 0: not given */
    int64_t elements, steps, repeat;     /* 0: not given */
    bool list, measure, check, critical, json;
} predict_settings;

/* ---- the machine ---------------------------------------------------------------------------- */

/* "8.7", "8.7ns": nanoseconds per element; "500MFLOPS": 816 operations per element. */
static bool read_speed(const char *text, double *seconds) {
    char *end;
    double x = strtod(text, &end);
    bool megaflops = strcmp(end, "MFLOPS") == 0;
    if (end == text || !(x > 0) || !isfinite(x)) return false;
    if (!megaflops && *end && strcmp(end, "ns") != 0) return false;
    *seconds = megaflops ? LAR_BENCH_OPERATIONS / (1e6 * x) : 1e-9 * x;
    return *seconds < 1;
}

static void set_number(lar_cluster *m, int i, double value) {
    m->number[i] = value;
    m->source[i] = NULL;
}

/* What the command line says goes before the table. A processor that is slower in elements is so in
 * nodes and vectors too. */
static int adapt_machine(const predict_settings *s, lar_cluster *m) {
    double element = 0;
    lar_error error;
    if (s->speed && !read_speed(s->speed, &element))
        return cli_complain(&cli_predict, CLI_USAGE,
                            "--processor-speed %s is no speed; give nanoseconds per element as "
                            "8.7 or 8.7ns, or 500MFLOPS",
                            s->speed);
    if (s->speed) {
        double factor = element / m->number[LAR_CLUSTER_ELEMENT];
        m->number[LAR_CLUSTER_NODE] *= factor;
        m->number[LAR_CLUSTER_VECTOR] *= factor;
        set_number(m, LAR_CLUSTER_ELEMENT, element);
    }
    if (s->latency >= 0) set_number(m, LAR_CLUSTER_LATENCY, 1e-6 * s->latency);
    if (s->overhead >= 0) set_number(m, LAR_CLUSTER_OVERHEAD, 1e-6 * s->overhead);
    if (s->bandwidth >= 0) set_number(m, LAR_CLUSTER_BANDWIDTH, 1e6 * s->bandwidth);
    if (lar_cluster_check(m, &error))
        return cli_complain(&cli_predict, CLI_USAGE, "%s", error.message);
    return CLI_DONE;
}

static int find_machine(const predict_settings *s, lar_cluster *m) {
    lar_error error;
    if (lar_cluster_find(s->machine ? s->machine : "thesis", m, &error))
        return cli_refuse(&cli_predict, &error);
    return adapt_machine(s, m);
}

/* ---- a scene -------------------------------------------------------------------------------- */

static const char *comm_of(const predict_settings *s) {
    return s->parallel.comm < 0 ? "threads" : cli_comm_names[s->parallel.comm];
}

static int get_machine(const predict_settings *s, const lar_model *model, lar_cluster *m,
                       lar_predict_check *check) {
    lar_error error;
    if (!s->measure) return find_machine(s, m);
    if (lar_cluster_measure(model, comm_of(s), m, &error) ||
        (s->check &&
         lar_predict_check_here(model, s->scene, comm_of(s), (int)s->repeat, m, check, &error)))
        return cli_refuse(&cli_predict, &error);
    return adapt_machine(s, m);
}

static int write_traces(const predict_settings *s, const lar_cluster *m, const lar_prediction *p) {
    char title[256], grid[LAR_GRID_TEXT];
    lar_error error;
    const lar_network_result *r = &p->network;
    snprintf(grid, sizeof grid, "%dx%dx%d", (int)r->grid[0], (int)r->grid[1], (int)r->grid[2]);
    snprintf(title, sizeof title, "%s on %s: grid %s with %d thread%s, a step of %.4g us", s->scene,
             m->name, grid, (int)r->threads, r->threads > 1 ? "s" : "", 1e6 * r->step);
    if ((s->csv && lar_network_write_csv(s->csv, r, &error)) ||
        (s->svg && lar_network_write_svg(s->svg, r, title, &error)))
        return cli_refuse(&cli_predict, &error);
    return CLI_DONE;
}

static int predict_scene(const predict_settings *s, const lar_model *model) {
    lar_cluster machine;
    lar_predict_check check;
    lar_prediction prediction = {0};
    lar_parallel found;
    lar_error error;
    lar_options options = lar_options_default();
    cli_parallel_set(&s->parallel, &options);
    options.comm = NULL;
    lar_status failed = lar_parallel_find(model, &options, &found, &error);
    if (failed) return cli_refuse(&cli_predict, &error);
    int status = get_machine(s, model, &machine, &check);
    if (status) return status;
    if (lar_predict_model(model, &options, &machine, (int32_t)s->steps, &prediction, &error))
        return cli_refuse(&cli_predict, &error);
    const predict_report report = {.machine = &machine,
                                   .scheme = found.scheme,
                                   .channels = found.channels,
                                   .prediction = &prediction,
                                   .check = s->check ? &check : NULL};
    status = write_traces(s, &machine, &prediction);
    if (!status && s->json) predict_report_json(&report);
    if (!status && !s->json) predict_report_print(&report);
    lar_prediction_clear(&prediction);
    return status;
}

/* ---- growing bodies ------------------------------------------------------------------------- */

static bool read_list(const char *text, int32_t *number, int32_t *count) {
    for (*count = 0; *count < ROWS_MAX; text++) {
        char *end;
        long x = strtol(text, &end, 10);
        if (end == text || x < 1 || x > LAR_NETWORK_PROCESSORS_MAX) return false;
        number[(*count)++] = (int32_t)x;
        text = end;
        if (!*text) return true;
        if (*text != ',') return false;
    }
    return false;
}

/* All five ways, or the one that was asked for. */
static void choose_schemes(const predict_settings *s, predict_scaling *scaling) {
    static const int first[] = {0, 1, 3, 4};
    const cli_parallel *p = &s->parallel;
    scaling->scheme_count = LAR_PREDICT_SCHEMES;
    for (int i = 0; i < LAR_PREDICT_SCHEMES; i++) scaling->schemes[i] = i;
    if (p->scheme < 0) return;
    scaling->scheme_count = 1;
    scaling->schemes[0] = first[p->scheme] + (p->channels > 0);
}

static int predict_growth(const predict_settings *s) {
    lar_cluster machine;
    lar_block_prediction row[ROWS_MAX * LAR_PREDICT_SCHEMES];
    int32_t processors[ROWS_MAX];
    lar_error error;
    predict_scaling scaling = {.machine = &machine, .processors = processors, .row = row};
    scaling.threads = s->parallel.threads > 0 ? (int32_t)s->parallel.threads : 1;
    if (!read_list(s->scale, processors, &scaling.rows))
        return cli_complain(&cli_predict, CLI_USAGE,
                            "--scale-to %s is no list of up to %d numbers of processors from 1 to "
                            "%d, as in 100,1000,10000",
                            s->scale, ROWS_MAX, LAR_NETWORK_PROCESSORS_MAX);
    int status = find_machine(s, &machine);
    if (status) return status;
    choose_schemes(s, &scaling);
    for (int32_t i = 0; i < scaling.rows * scaling.scheme_count; i++) {
        const lar_block_options options = {.elements = (int32_t)(s->elements ? s->elements : 150),
                                           .processors = processors[i / scaling.scheme_count],
                                           .threads = scaling.threads,
                                           .scheme = scaling.schemes[i % scaling.scheme_count],
                                           .steps = (int32_t)s->steps};
        if (lar_predict_block(&options, &machine, &row[i], &error))
            return cli_refuse(&cli_predict, &error);
    }
    if (s->json)
        predict_scaling_json(&scaling);
    else
        predict_scaling_print(&scaling);
    return CLI_DONE;
}

static void tell_edge(void *context, int scheme, int32_t edge) {
    (void)context;
    if (!isatty(STDERR_FILENO)) return;
    fprintf(stderr, "\r%s, %d elements an edge \033[K", lar_predict_scheme_name[scheme], (int)edge);
    fflush(stderr);
}

static int predict_critical(const predict_settings *s) {
    lar_cluster machine[MACHINES_MAX];
    lar_critical critical[MACHINES_MAX];
    lar_error error;
    lar_critical_options options = {.machine = machine,
                                    .processors = 125,
                                    .threads =
                                        s->parallel.threads ? (int32_t)s->parallel.threads : 1,
                                    .edge_max = CRITICAL_EDGE,
                                    .steps = (int32_t)s->steps,
                                    .efficiency = 0.9,
                                    .tell = tell_edge};
    while (s->elements && options.edge_max > 1 &&
           (int64_t)options.edge_max * options.edge_max * options.edge_max > s->elements)
        options.edge_max--;
    bool one = s->machine != NULL;
    for (int i = 0; i < MACHINES_MAX && (one ? i == 0 : lar_cluster_at(i) != NULL); i++) {
        predict_settings each = *s;
        if (!one) each.machine = lar_cluster_at(i)->name;
        int status = find_machine(&each, &machine[options.machines++]);
        if (status) return status;
    }
    lar_status status = lar_predict_critical(&options, critical, &error);
    if (isatty(STDERR_FILENO)) fputs("\r\033[K", stderr);
    if (status) return cli_refuse(&cli_predict, &error);
    if (s->json)
        predict_critical_json(&options, critical);
    else
        predict_critical_print(&options, critical);
    return CLI_DONE;
}

/* ---- the command ---------------------------------------------------------------------------- */

static int check_mode(const predict_settings *s) {
    int without = s->list + s->critical + (s->scale != NULL);
    if (without > 1)
        return cli_complain(&cli_predict, CLI_USAGE,
                            "--list-machines, --scale-to and --critical are different questions; "
                            "ask one of them");
    if (without && s->scene)
        return cli_complain(&cli_predict, CLI_USAGE, "--%s is not about a scene; leave %s out",
                            s->list       ? "list-machines"
                            : s->critical ? "critical"
                                          : "scale-to",
                            s->scene);
    if (!without && !s->scene)
        return cli_complain(&cli_predict, CLI_USAGE,
                            "SCENE is missing; give one, or --scale-to, --critical or "
                            "--list-machines");
    if (without && (s->measure || s->csv || s->svg || s->parallel.grid || s->parallel.schedules ||
                    s->parallel.distribution))
        return cli_complain(&cli_predict, CLI_USAGE,
                            "--measure, --trace, --svg, --grid, --distribution and --schedules "
                            "need a scene");
    if (s->list && s->steps)
        return cli_complain(&cli_predict, CLI_USAGE,
                            "--steps belongs to a scene, --scale-to or --critical");
    if (!s->scene && !s->scale && s->parallel.scheme >= 0)
        return cli_complain(&cli_predict, CLI_USAGE,
                            "--scheme belongs to a scene or to --scale-to; --critical tries all");
    if (s->parallel.channels >= 0 &&
        (s->parallel.scheme < 0 || strcmp(cli_scheme_names[s->parallel.scheme], "local") != 0))
        return cli_complain(&cli_predict, CLI_USAGE, "--channels belongs to --scheme local");
    if (s->elements && !s->scale && !s->critical)
        return cli_complain(&cli_predict, CLI_USAGE,
                            "--elements-per-processor belongs to --scale-to and --critical");
    return CLI_DONE;
}

static int check_settings(const predict_settings *s) {
    int status = check_mode(s);
    if (status) return status;
    if (s->check && !s->measure)
        return cli_complain(&cli_predict, CLI_USAGE,
                            "--check compares with what --measure finds; "
                            "give both");
    if (s->measure && s->machine)
        return cli_complain(&cli_predict, CLI_USAGE,
                            "--measure makes the machine that --machine names; give one of them");
    if (s->parallel.comm >= 0 && !s->measure)
        return cli_complain(&cli_predict, CLI_USAGE,
                            "--comm says what --measure measures; give both");
    if (!s->scene) return CLI_DONE;
    cli_parallel only = s->parallel;
    only.comm = -1;
    return cli_parallel_check(&cli_predict, &only);
}

static int run_scene(const predict_settings *s) {
    lar_model *model = NULL;
    int status = cli_open_model(&cli_predict, s->scene, &model);
    if (status) return status;
    status = predict_scene(s, model);
    lar_model_destroy(model);
    return status;
}

static int predict_main(int argc, char **argv) {
    static const char *const comm_names[] = {"threads", "shm", NULL};
    predict_settings s = {
        .parallel = CLI_PARALLEL_NONE, .latency = -1, .bandwidth = -1, .overhead = -1, .repeat = 9};
    const cli_option options[] = {
        CLI_TEXT("--machine", "NAME", "of --list-machines (thesis), or a file", &s.machine),
        CLI_TEXT("--processor-speed", "SPEED",
                 "8.7ns per element, or 500MFLOPS with 816 "
                 "operations\nan element, instead of the machine's",
                 &s.speed),
        CLI_REAL("--latency", "US", "of a packet, instead of the machine's", &s.latency, 0, 1e6),
        CLI_REAL("--bandwidth", "MB/S", "of a link, instead of the machine's", &s.bandwidth, 1e-3,
                 1e9),
        CLI_REAL("--overhead", "US", "processor time to send a packet, the same", &s.overhead, 0,
                 1e6),
        CLI_TEXT("--grid", "AxBxC", "processors along x, y and z, e.g. 2x2x3", &s.parallel.grid),
        CLI_COUNT("--threads", "N", "of each processor (1)", &s.parallel.threads, 1, 16),
        CLI_CHOICE("--scheme", "NAME",
                   "who sends to whom: all (default), local, one, two;\nfor "
                   "--scale-to one instead of all of them",
                   &s.parallel.scheme, cli_scheme_names),
        CLI_CHOICE("--channels", "NAME", "of --scheme local: sequential (default), concurrent",
                   &s.parallel.channels, cli_channel_names),
        CLI_TEXT("--distribution", "FILE",
                 "of lariat partition, or cut (default), genetic, metis,\nrandom",
                 &s.parallel.distribution),
        CLI_TEXT("--schedules", "DIR", "the schedule files of lariat partition instead",
                 &s.parallel.schedules),
        CLI_COUNT("--steps", "N",
                  "that are simulated; the later half counts (as many as it\ntakes until all "
                  "processors go at the same pace)",
                  &s.steps, 2, LAR_NETWORK_STEPS_MAX),
        CLI_FLAG("--measure", "the machine is this one, measured now", &s.measure),
        CLI_CHOICE("--comm", "NAME", "that --measure measures: threads (default), shm",
                   &s.parallel.comm, comm_names),
        CLI_FLAG("--check", "with --measure: compare with steps on one and two\nprocessors",
                 &s.check),
        CLI_COUNT("--repeat", "N", "samples of --check (9)", &s.repeat, 1, 1000),
        CLI_TEXT("--scale-to", "LIST",
                 "without a scene: bodies of equal blocks on so many\n"
                 "processors, e.g. 100,1000,10000",
                 &s.scale),
        CLI_COUNT(
            "--elements-per-processor", "N",
            "of a block of --scale-to (150); of --critical the\nlargest that is tried (64000)",
            &s.elements, 1, LAR_PREDICT_BLOCK_MAX),
        CLI_FLAG("--critical",
                 "without a scene: the smallest block with an efficiency\nof 90 %, "
                 "for every machine and scheme",
                 &s.critical),
        CLI_FLAG("--list-machines", "with the source of every number", &s.list),
        CLI_TEXT("--trace", "FILE", "write the course of a step as CSV", &s.csv),
        CLI_TEXT("--svg", "FILE", "draw it: occupation of the network, who waits when", &s.svg),
        CLI_FLAG("--json", "one JSON object on standard output", &s.json),
        CLI_END};
    int status = cli_parse(&cli_predict, options, argc, argv, &s.scene, 1);
    if (status < 0 && (status = check_settings(&s)) == CLI_DONE) status = -1;
    if (status >= 0) return status;
    if (s.list) {
        if (s.json)
            predict_machines_json();
        else
            predict_machines_print();
        return CLI_DONE;
    }
    return s.critical ? predict_critical(&s) : s.scale ? predict_growth(&s) : run_scene(&s);
}

const cli_command cli_predict = {
    .name = "predict",
    .summary = "how fast a step would be on another machine",
    .arguments = "[SCENE]",
    .description =
        "Divides a scene or mesh among a grid of processors as run would, and simulates what\n"
        "every thread does in a step on a given machine: when elements are done, when packets\n"
        "leave, pass the network and are seen, who waits. Nothing is computed in the elements.\n"
        "Without a scene: bodies that grow with the machine, and how small a part of the body\n"
        "a processor may have before communication takes more than a tenth of its time.",
    .examples =
        "  lariat predict demo/uterus.yaml --grid 2x2x3 --threads 2 --machine thesis\n"
        "  lariat predict demo/uterus.yaml --grid 2x2x3 --machine infiniband --svg step.svg\n"
        "  lariat predict demo/uterus.yaml --grid 2x1x1 --measure --check\n"
        "  lariat predict --scale-to 100,1000,10000 --machine ethernet\n"
        "  lariat predict --critical --elements-per-processor 1000\n"
        "  lariat predict --list-machines\n",
    .main = predict_main};
