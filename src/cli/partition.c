/* lariat partition: who computes what. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "cli/commands.h"
#include "base/json/write.h"
#include "cli/parallel.h"
#include "study/partition.h"

static const double DEFAULT_SECONDS = 25;

/* ---- for machines ----------------------------------------------------------------------- */

static void write_cost(lar_json *json, const char *name, const lar_partition_cost *cost) {
    if (!cost->known) return;
    lar_json_open(json, name, '{');
    lar_json_integer(json, "worst", cost->worst);
    lar_json_integer(json, "total", cost->total);
    lar_json_close(json);
}

static void write_scheme(lar_json *json, const lar_partition_scheme *s) {
    lar_json_open(json, NULL, '{');
    lar_json_text(json, "scheme", s->name);
    lar_json_number(json, "vectors_mean", s->vectors_mean);
    lar_json_integer(json, "vectors_max", s->vectors_max);
    lar_json_number(json, "local_vectors_mean", s->local_mean);
    lar_json_integer(json, "local_vectors_max", s->local_max);
    lar_json_number(json, "global_vectors_mean", s->global_mean);
    lar_json_integer(json, "global_vectors_max", s->global_max);
    lar_json_number(json, "bytes_mean", s->bytes_mean);
    lar_json_integer(json, "bytes_max", s->bytes_max);
    lar_json_number(json, "packets_mean", s->packets_mean);
    lar_json_integer(json, "packets_max", s->packets_max);
    lar_json_number(json, "packet_bytes_mean", s->packet_bytes_mean);
    lar_json_integer(json, "packet_bytes_max", s->packet_bytes_max);
    lar_json_close(json);
}

static void write_json(const lar_partition_report *r) {
    lar_json json = lar_json_to(stdout);
    lar_json_integers(&json, "grid", r->grid, 3);
    lar_json_integer(&json, "processors", r->processors);
    lar_json_integer(&json, "diameter", r->diameter);
    lar_json_integer(&json, "elements", r->elements);
    lar_json_integer(&json, "nodes", r->nodes);
    lar_json_text(&json, "method", lar_partition_method_name[r->method]);
    lar_json_integer(&json, "elements_min", r->load_min);
    lar_json_integer(&json, "elements_max", r->load_max);
    lar_json_boolean(&json, "balanced", r->balanced);
    lar_json_number(&json, "n_pav", r->mean_processors);
    lar_json_integer(&json, "shared_nodes", r->shared);
    lar_json_integer(&json, "irregular_nodes", r->irregular);
    lar_json_integer(&json, "scattered_nodes", r->scattered);
    lar_json_integer(&json, "cost_before", r->cost[LAR_PARTITION_CUT].worst);
    lar_json_integer(&json, "cost_after", r->cost[r->method].worst);
    lar_json_number(&json, "cost_reduction", r->reduction);
    lar_json_open(&json, "costs", '{');
    for (int m = 0; m < LAR_PARTITION_METHODS; m++)
        write_cost(&json, lar_partition_method_name[m], &r->cost[m]);
    lar_json_close(&json);
    lar_json_integer(&json, "generations", r->generations);
    lar_json_number(&json, "seconds", r->seconds);
    lar_json_integer(&json, "threads", r->schedules.threads);
    lar_json_text(&json, "channels", r->schedules.channels);
    lar_json_open(&json, "schedules", '{');
    lar_json_text(&json, "scheme", r->schedules.scheme);
    lar_json_number(&json, "batches_mean", r->schedules.batches_mean);
    lar_json_integer(&json, "batches_max", r->schedules.batches_max);
    lar_json_number(&json, "waits_mean", r->schedules.waits_mean);
    lar_json_integer(&json, "waits_max", r->schedules.waits_max);
    lar_json_integer(&json, "buffer_bytes_max", r->schedules.buffer_bytes_max);
    lar_json_close(&json);
    lar_json_open(&json, "schemes", '[');
    for (int s = 0; s < LAR_PARTITION_SCHEMES; s++) write_scheme(&json, &r->scheme[s]);
    lar_json_close(&json);
    lar_json_end(&json);
}

/* ---- for people ------------------------------------------------------------------------- */

static void print_costs(const lar_partition_report *r) {
    printf("%-17s%" PRId64 " before (plain cut), %" PRId64 " after (%s), %.1f %% %s\n", "cost",
           r->cost[LAR_PARTITION_CUT].worst, r->cost[r->method].worst,
           lar_partition_method_name[r->method], 100 * fabs(r->reduction),
           r->reduction < 0 ? "more" : "less");
    for (int m = 0; m < LAR_PARTITION_METHODS; m++)
        if (r->cost[m].known)
            printf("%-17s%-8s %6" PRId64 " at the worst processor, %" PRId64 " in all\n", "",
                   lar_partition_method_name[m], r->cost[m].worst, r->cost[m].total);
    if (r->generations > 0)
        printf("%-17s%" PRId64 " generations in %.1f s\n", "genetic search", r->generations,
               r->seconds);
}

static void print_schemes(const lar_partition_report *r) {
    printf("\nsent per step and processor, mean (most)\n%-8s%19s%17s%17s%19s%14s%19s\n", "scheme",
           "vectors", "of these local", "global", "bytes", "packets", "bytes per packet");
    for (int i = 0; i < LAR_PARTITION_SCHEMES; i++) {
        const lar_partition_scheme *s = &r->scheme[i];
        printf("%-8s%10.1f (%6" PRId64 ")%8.1f (%6" PRId64 ")%8.1f (%6" PRId64 ")%9.0f (%7" PRId64
               ")%7.1f (%4" PRId64 ")%10.0f (%6" PRId64 ")\n",
               s->name, s->vectors_mean, s->vectors_max, s->local_mean, s->local_max,
               s->global_mean, s->global_max, s->bytes_mean, s->bytes_max, s->packets_mean,
               s->packets_max, s->packet_bytes_mean, s->packet_bytes_max);
    }
}

static void print_schedules(const lar_partition_report *r) {
    const lar_partition_schedules *s = &r->schedules;
    printf("\nschedules of scheme %s, per processor, mean (most)\n%-17s%.1f (%" PRId64 ")",
           s->scheme, "batches", s->batches_mean, s->batches_max);
    if (s->threads > 1)
        printf(", on %d threads that wait for each other %.1f (%" PRId64 ") times", (int)s->threads,
               s->waits_mean, s->waits_max);
    printf("\n%-17s%" PRId64 " bytes at most\n", "receive buffer", s->buffer_bytes_max);
}

static void print_table(const lar_partition_report *r) {
    printf("%-17s%d elements, %d nodes\n", "model", (int)r->elements, (int)r->nodes);
    printf("%-17s%d x %d x %d, %d processors, diameter %d\n", "grid", (int)r->grid[0],
           (int)r->grid[1], (int)r->grid[2], (int)r->processors, (int)r->diameter);
    printf("%-17s%d to %d per processor%s\n", "elements", (int)r->load_min, (int)r->load_max,
           r->balanced ? "" : "; NOT balanced: the fullest one sets the pace");
    printf("%-17s%.4f processors per node (n_pav); %d nodes shared, of these %d over more than\n"
           "%-17sone channel, %d that partial sums cannot serve\n",
           "nodes", r->mean_processors, (int)r->shared, (int)r->irregular, "", (int)r->scattered);
    print_costs(r);
    print_schemes(r);
    print_schedules(r);
}

/* ---- progress --------------------------------------------------------------------------- */

static void show_progress(void *context, double done, int64_t start, int64_t best) {
    int *shown = context;
    int percent = (int)(100 * done);
    if (percent == *shown) return;
    *shown = percent;
    fprintf(stderr, "\rgenetic search %3d %%, cost %" PRId64 " -> %" PRId64 " ", percent, start,
            best);
    if (done >= 1) fprintf(stderr, "\r%60s\r", "");
    fflush(stderr);
}

/* ---- the command ------------------------------------------------------------------------ */

static int check_usage(const lar_partition_options *wanted, bool method_given) {
    if (wanted->read && method_given)
        return cli_complain(&cli_partition, CLI_USAGE,
                            "--distribution reads what --method would make; give one of them");
    if (!wanted->read && !wanted->grid)
        return cli_complain(&cli_partition, CLI_USAGE,
                            "--grid is missing; say how many processors, e.g. --grid 2x2x3");
    return -1;
}

static int run_partition(const char *path, lar_partition_options *wanted, bool json) {
    lar_model *model = NULL;
    int status = cli_open_model(&cli_partition, path, &model);
    if (status) return status;
    int shown = -1;
    if (isatty(STDERR_FILENO)) {
        wanted->progress = show_progress;
        wanted->context = &shown;
    }
    lar_partition_report report;
    lar_error error;
    if (lar_partition(model, wanted, &report, &error))
        status = cli_refuse(&cli_partition, &error);
    else if (json)
        write_json(&report);
    else
        print_table(&report);
    if (!status && wanted->method == LAR_PARTITION_BEST && !lar_partition_has_metis())
        cli_complain(&cli_partition, CLI_DONE,
                     "note: built without METIS, which could not compete; it comes with "
                     "libmetis-dev and a new build");
    lar_model_destroy(model);
    return status;
}

static int partition_main(int argc, char **argv) {
    static const char *const methods[] = {"best", "cut", "genetic", "metis", "random", NULL};
    lar_partition_options wanted = {0};
    int method = -1;
    int64_t seed = 1, threads = 1;
    bool json = false;
    wanted.seconds = -1;
    const cli_option options[] = {
        CLI_TEXT("--grid", "AxBxC", "processors along x, y and z, e.g. 2x2x3", &wanted.grid),
        CLI_CHOICE("--method", "NAME", "best (default), cut, genetic, metis, random", &method,
                   methods),
        CLI_TEXT("--distribution", "FILE", "judge this distribution instead of making one",
                 &wanted.read),
        CLI_COUNT("--seed", "N", "of genetic, metis and random (1)", &seed, 0, 9e15),
        CLI_REAL("--seconds", "S", "time for the genetic search (25)", &wanted.seconds, 0.01, 1e6),
        CLI_COUNT("--generations", "N", "end it after so many: the same result everywhere",
                  &wanted.generations, 1, 1e12),
        CLI_COUNT("--threads", "N", "of each processor (1)", &threads, 1, 16),
        CLI_CHOICE("--scheme", "NAME", "of the schedules: all (default), local, one, two",
                   &wanted.scheme, cli_scheme_names),
        CLI_CHOICE("--channels", "NAME", "of scheme local: sequential (default), concurrent",
                   &wanted.channels, cli_channel_names),
        CLI_TEXT("--out", "FILE", "write the distribution", &wanted.out),
        CLI_TEXT("--schedules", "DIR", "write the schedules, a file per processor",
                 &wanted.schedules),
        CLI_TEXT("--vtu", "FILE", "write the mesh with its processors as a cell field",
                 &wanted.vtu),
        CLI_FLAG("--json", "one JSON object on standard output", &json),
        CLI_END};
    const char *path;
    int status = cli_parse(&cli_partition, options, argc, argv, &path, 1);
    if (status < 0) status = check_usage(&wanted, method >= 0);
    if (status >= 0) return status;
    /* The choices are the methods in their order, without "file". */
    wanted.method =
        wanted.read ? LAR_PARTITION_FILE : (lar_partition_method)(method < 0 ? 0 : method);
    wanted.seed = (uint64_t)seed;
    wanted.threads = (int32_t)threads;
    if (wanted.seconds < 0) wanted.seconds = wanted.generations > 0 ? 0 : DEFAULT_SECONDS;
    return run_partition(path, &wanted, json);
}

const cli_command cli_partition = {
    .name = "partition",
    .summary = "divide a model among a grid of processors",
    .arguments = "SCENE",
    .description =
        "Gives every element of a scene or mesh a processor of a grid: by cutting, by genetic\n"
        "adaptation of the cuts, or with METIS; the best is kept. Prints the load, the cost of\n"
        "communication (the fitness of the thesis, its eq. 6.8), and what each communication\n"
        "scheme sends in a step. Writes what run and verify read: the distribution, and the\n"
        "schedules, which say what every thread of every processor does in a step.",
    .examples = "  lariat partition demo/uterus.yaml --grid 2x2x3\n"
                "  lariat partition demo/uterus.yaml --grid 2x2x3 --method genetic --seconds 5 \\\n"
                "      --out uterus.dist --vtu uterus-processors.vtu\n"
                "  lariat partition demo/uterus.yaml --distribution uterus.dist --json\n"
                "  lariat partition demo/uterus.yaml --grid 2x1x1 --threads 2 --schedules plan\n"
                "  lariat run demo/uterus.yaml --schedules plan\n",
    .main = partition_main};
