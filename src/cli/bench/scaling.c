/* lariat bench scaling: what several processors are worth on this machine. */
#include <inttypes.h>
#include <stdio.h>
#include <unistd.h>

#include "cli/bench/frame.h"
#include "cli/parallel.h"
#include "study/bench/scaling.h"

typedef struct scaling_settings {
    const char *scene; /* NULL: the block */
    int64_t elements;  /* of it, 0: not given */
    int64_t repeat, processor;
    const char *master;
    int scheme;
    bool no_pin;
    bench_frame frame;
    lar_bench_scaling_options wanted;
} scaling_settings;

/* ---- for machines ----------------------------------------------------------------------- */

static void write_row(lar_json *json, const lar_bench_scaling_row *row) {
    lar_json_open(json, NULL, '{');
    lar_json_text(json, "grid", row->grid);
    lar_json_integer(json, "processors", row->processors);
    lar_json_integer(json, "threads", row->threads);
    lar_json_text(json, "comm", row->comm);
    if (row->missing) {
        lar_json_text(json, "missing", row->missing);
    } else {
        lar_json_number(json, "us_per_step", row->microseconds.median);
        bench_write_spread(json, "us_per_step_spread", &row->microseconds);
        lar_json_number(json, "over_plain", row->over_plain);
        lar_json_number(json, "speed_up", row->speed_up);
        lar_json_number(json, "efficiency", row->efficiency);
    }
    lar_json_close(json);
}

static void write_json(const scaling_settings *s, const lar_bench_scaling_result *r) {
    lar_json json = bench_open_json(&s->frame);
    lar_json_text(&json, "title", r->info.title);
    lar_json_integer(&json, "elements", r->info.elements);
    lar_json_integer(&json, "nodes", r->info.nodes);
    lar_json_text(&json, "isa", r->isa);
    lar_json_text(&json, "scheme", s->wanted.scheme ? s->wanted.scheme : cli_scheme_names[0]);
    lar_json_integer(&json, "cores", r->cores);
    lar_json_boolean(&json, "pinned", r->pinned);
    lar_json_integer(&json, "samples", r->repeat);
    lar_json_integer(&json, "warm_up_steps", (int64_t)r->warm_up);
    lar_json_integer(&json, "steps_per_sample", (int64_t)r->steps);
    if (r->core_to_core.median > 0) bench_write_spread(&json, "core_to_core_ns", &r->core_to_core);
    lar_json_hash(&json, "state_hash", r->hash);
    lar_json_open(&json, "rows", '[');
    for (int i = 0; i < r->rows; i++) write_row(&json, &r->row[i]);
    lar_json_close(&json);
    bench_close_json(&s->frame, &json);
}

/* ---- for people ------------------------------------------------------------------------- */

enum { ROW_NAME = LAR_GRID_TEXT + 40 };

static const char *name_row(const lar_bench_scaling_row *row, bool plain, char name[ROW_NAME]) {
    if (plain)
        snprintf(name, ROW_NAME, "plain loop");
    else if (row->processors == 1)
        snprintf(name, ROW_NAME, "%s, %d thread%s", row->grid, (int)row->threads,
                 row->threads == 1 ? "" : "s");
    else
        snprintf(name, ROW_NAME, "%s by %s", row->grid, row->comm);
    return name;
}

static void print_row(const lar_bench_scaling_row *row, bool plain) {
    char name[ROW_NAME];
    name_row(row, plain, name);
    if (row->missing) {
        printf("%-20s missing: %s\n", name, row->missing);
        return;
    }
    printf("%-20s %9.2f (%.2f to %.2f)", name, row->microseconds.median, row->microseconds.min,
           row->microseconds.max);
    if (!plain)
        printf("%8.1f %% %8.2f %8.0f %%", 100 * row->over_plain, row->speed_up,
               100 * row->efficiency);
    printf("\n");
}

static void print_table(const scaling_settings *s, const lar_bench_scaling_result *r) {
    printf("%s: %d elements, %d nodes, %s, scheme %s\n", *r->info.title ? r->info.title : s->scene,
           (int)r->info.elements, (int)r->info.nodes, r->isa,
           s->wanted.scheme ? s->wanted.scheme : cli_scheme_names[0]);
    printf("median of %d samples of %" PRIu64 " steps after %" PRIu64 ", state hash %016" PRIx64
           " in all\n",
           r->repeat, r->steps, r->warm_up, r->hash);
    if (r->core_to_core.median > 0)
        printf("core to core %.3f us (%.3f to %.3f)", 1e-3 * r->core_to_core.median,
               1e-3 * r->core_to_core.min, 1e-3 * r->core_to_core.max);
    const char *comma = r->core_to_core.median > 0 ? ", " : "";
    if (r->cores > 0)
        printf("%s%d cores%s\n\n", comma, (int)r->cores,
               r->pinned ? ", every thread bound to one where there are enough" : "");
    else
        printf("%sno thread can be bound to a core (lariat doctor)\n\n", comma);
    printf("%-20s %27s %11s %8s %10s\n", "", "step [us] (least to most)", "of plain", "speed-up",
           "efficiency");
    for (int i = 0; i < r->rows; i++) print_row(&r->row[i], i == 0);
}

/* ---- the command ------------------------------------------------------------------------ */

static void show_turn(void *context, int turn) {
    const scaling_settings *s = context;
    if (!isatty(STDERR_FILENO)) return;
    fprintf(stderr, "\rturn %d of %d \033[K", turn + 1, (int)s->repeat);
    fflush(stderr);
}

static void add_figures(const lar_bench_scaling_result *r, lar_bench_report *report) {
    char name[ROW_NAME];
    for (int i = 0; i < r->rows; i++)
        if (!r->row[i].missing)
            lar_bench_add(report, "us", r->row[i].microseconds.median, true, "%s: us_per_step",
                          name_row(&r->row[i], i == 0, name));
}

static int report(scaling_settings *s) {
    lar_bench_scaling_result result;
    lar_error error;
    lar_status status = lar_bench_scaling(&s->wanted, &result, &error);
    if (isatty(STDERR_FILENO)) fputs("\r\033[K", stderr);
    if (status) return cli_refuse(&cli_bench_scaling, &error);
    if (result.rows == 0) return CLI_DONE; /* the first process tells */
    add_figures(&result, &s->frame.report);
    if (s->frame.json)
        write_json(s, &result);
    else
        print_table(s, &result);
    return bench_end(&s->frame);
}

static int serve(const scaling_settings *s) {
    lar_error error;
    cli_speak_as((int32_t)s->processor);
    if (!lar_bench_scaling_serve(&s->wanted, (int32_t)s->processor, s->master, &error))
        return CLI_DONE;
    return cli_complain(&cli_bench_scaling, CLI_FAILED, "%s", error.message);
}

static int open_model(scaling_settings *s, lar_model **model) {
    lar_error error;
    if (s->scene) return cli_open_model(&cli_bench_scaling, s->scene, model);
    if (lar_bench_scaling_block((int32_t)s->elements, model, &error))
        return cli_complain(&cli_bench_scaling, CLI_FAILED, "%s", error.message);
    return CLI_DONE;
}

static int check_settings(const scaling_settings *s) {
    if (s->scene && s->elements)
        return cli_complain(&cli_bench_scaling, CLI_USAGE,
                            "%s has its own elements; leave --elements out, or the scene",
                            s->scene);
    if ((s->processor >= 0) != (s->master != NULL))
        return cli_complain(&cli_bench_scaling, CLI_USAGE,
                            "--processor and --master belong together; the benchmark gives them to "
                            "the processes that it starts");
    return CLI_DONE;
}

/* What the figures depend on; a scene is known by what is in it. */
static int begin(scaling_settings *s) {
    lar_bench_report *r = &s->frame.report;
    lar_model_info info;
    lar_error error;
    if (lar_model_inspect(s->wanted.model, &info, &error))
        return cli_complain(&cli_bench_scaling, CLI_FAILED, "%s", error.message);
    lar_bench_set_text(r, "title", info.title);
    lar_bench_set_number(r, "elements", info.elements);
    lar_bench_set_number(r, "nodes", info.nodes);
    lar_bench_set_text(r, "processors", s->wanted.grids ? s->wanted.grids : s->wanted.processors);
    lar_bench_set_text(r, "threads", s->wanted.threads);
    lar_bench_set_text(r, "comm", s->wanted.comm ? s->wanted.comm : "");
    lar_bench_set_text(r, "scheme", s->wanted.scheme ? s->wanted.scheme : cli_scheme_names[0]);
    lar_bench_set_text(r, "distribution", s->wanted.distribution ? s->wanted.distribution : "cut");
    lar_bench_set_text(r, "pin", s->wanted.pin ? "yes" : "no");
    lar_bench_set_text(r, "quick", s->wanted.quick ? "yes" : "no");
    return bench_begin(&s->frame);
}

static int measure(scaling_settings *s) {
    char elements[32];
    lar_model *model = NULL;
    if (!s->scene && !s->elements) s->elements = 1840;
    snprintf(elements, sizeof elements, "%d", (int)s->elements);
    int status = open_model(s, &model);
    if (status) return status;
    s->wanted.model = model;
    s->wanted.scheme = s->scheme < 0 ? NULL : cli_scheme_names[s->scheme];
    s->wanted.pin = !s->no_pin;
    s->wanted.repeat = (int)s->repeat;
    s->wanted.command = cli_bench_scaling.name;
    s->wanted.argument[0] = s->scene ? "--" : "--elements";
    s->wanted.argument[1] = s->scene ? s->scene : elements;
    s->wanted.turn = show_turn;
    s->wanted.context = s;
    if (s->processor >= 0)
        status = serve(s);
    else {
        status = begin(s);
        if (!status) status = report(s);
    }
    lar_model_destroy(model);
    return bench_abandon(&s->frame, status);
}

static int scaling_main(int argc, char **argv) {
    scaling_settings s = {.repeat = 9,
                          .processor = -1,
                          .scheme = -1,
                          .frame = bench_frame_of(&cli_bench_scaling, "scaling"),
                          .wanted = {.processors = "1,2", .threads = "2"}};
    const cli_option options[] = {
        CLI_COUNT("--elements", "N", "without a scene: a block of about so many (1840)",
                  &s.elements, 1, 2e6),
        CLI_TEXT("--processors", "LIST", "how many; 1: through a schedule (1,2)",
                 &s.wanted.processors),
        CLI_TEXT("--grid", "LIST", "these grids instead, as in 2x1x1,1x2x1", &s.wanted.grids),
        CLI_TEXT("--threads", "LIST", "of one processor (2)", &s.wanted.threads),
        CLI_TEXT("--comm", "LIST",
                 "between processors (threads,shm; under mpirun mpi);\nalso ucx, mpi, tcp",
                 &s.wanted.comm),
        CLI_CHOICE("--scheme", "NAME", "who sends to whom: all (default), local, one, two",
                   &s.scheme, cli_scheme_names),
        CLI_TEXT("--distribution", "FILE",
                 "for two processors and more: a file of lariat\npartition, or cut (default), "
                 "genetic, metis, random",
                 &s.wanted.distribution),
        CLI_FLAG("--no-pin", "leave it to the system which thread runs where", &s.no_pin),
        CLI_COUNT("--repeat", "N", "samples (9)", &s.repeat, 1, LAR_BENCH_REPEAT_MAX),
        CLI_FLAG("--quick", "does it work? few steps", &s.wanted.quick),
        BENCH_OPTIONS(s.frame),
        CLI_COUNT("--processor", "K",
                  "given, with --master, to the processes that the\nbenchmark starts itself",
                  &s.processor, 0, LAR_GRID_MAX - 1),
        CLI_TEXT("--master", "HOST:PORT", "where processor 0 listens", &s.master),
        CLI_END};
    int status = cli_parse(&cli_bench_scaling, options, argc, argv, &s.scene, 1);
    if (status >= 0) return status;
    status = check_settings(&s);
    return status ? status : measure(&s);
}

const cli_command cli_bench_scaling = {
    .name = "bench scaling",
    .summary = "time of a step with several processors, against the plain loop of one",
    .arguments = "[SCENE]",
    .description =
        "Times steps of a scene, or of a block of elements, with one processor and no schedule,\n"
        "with a schedule, with several processors and with several threads. Every sample makes\n"
        "its simulation anew, all take turns, and all end with the same state hash. For quiet\n"
        "figures run nothing else on the machine.",
    .examples = "  lariat bench scaling demo/uterus.yaml\n"
                "  lariat bench scaling --elements 20000 --comm threads,shm,tcp --repeat 31\n"
                "  mpirun -n 2 --bind-to none lariat bench scaling demo/uterus.yaml\n",
    .main = scaling_main};
