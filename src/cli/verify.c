/* lariat verify: whether a division can be trusted. */
#include <inttypes.h>
#include <stdio.h>

#include "cli/commands.h"
#include "base/json/write.h"
#include "cli/parallel.h"
#include "study/verify.h"

typedef struct verify_settings {
    const char *scene;
    int64_t steps;
    int element, isa;
    bool json;
    cli_parallel parallel;
    int argc;
    char **argv;
} verify_settings;

/* One verification under way. */
typedef struct verify {
    const verify_settings *settings;
    lar_model *model;
    lar_model_info info;
    lar_parallel parallel;
    lar_verify_setting setting;
    lar_verify_report report;
    lar_status failure;
} verify;

/* ---- for machines ----------------------------------------------------------------------- */

static void write_json(const verify *v) {
    const lar_schedule_proof *proof = &v->report.proof;
    lar_json json = lar_json_to(stdout);
    lar_json_text(&json, "title", v->info.title);
    lar_json_integer(&json, "elements", v->info.elements);
    lar_json_integer(&json, "nodes", v->info.nodes);
    lar_json_text(&json, "grid", v->parallel.grid);
    lar_json_integer(&json, "processors", v->parallel.processors);
    lar_json_integer(&json, "threads", v->parallel.threads);
    lar_json_text(&json, "scheme", v->parallel.scheme);
    lar_json_text(&json, "comm", v->parallel.comm);
    lar_json_open(&json, "schedules", '{');
    lar_json_integer(&json, "batches", proof->batches);
    lar_json_integer(&json, "waits", proof->waits);
    lar_json_integer(&json, "packets", proof->packets);
    lar_json_integer(&json, "empty_packets", proof->empty_packets);
    lar_json_integer(&json, "vectors", proof->vectors);
    lar_json_integer(&json, "sums", proof->sums);
    lar_json_boolean(&json, "balanced", proof->balanced);
    lar_json_integer(&json, "spread", proof->spread);
    lar_json_close(&json);
    lar_json_integer(&json, "passes", v->report.passes);
    lar_json_integer(&json, "verified_steps", (int64_t)v->report.listed);
    lar_json_integer(&json, "delays", (int64_t)v->report.seed);
    lar_json_integer(&json, "steps", (int64_t)v->setting.steps);
    lar_json_hash(&json, "state_hash", v->report.hash);
    lar_json_boolean(&json, "verified", true);
    lar_json_end(&json);
}

/* ---- for people ------------------------------------------------------------------------- */

static void print_division(const verify *v) {
    const lar_parallel *p = &v->parallel;
    printf("%s: %d elements, %d nodes\n", *v->info.title ? v->info.title : v->settings->scene,
           (int)v->info.elements, (int)v->info.nodes);
    printf("%-12s%s, %d processor%s of %d thread%s, scheme %s, by %s\n", "grid", p->grid,
           (int)p->processors, p->processors == 1 ? "" : "s", (int)p->threads,
           p->threads == 1 ? "" : "s", p->scheme, p->comm);
}

static void print_proof(const verify *v) {
    const lar_schedule_proof *proof = &v->report.proof;
    printf("%-12s%" PRId64 " batches, %" PRId64 " waits between threads; in every step %" PRId64
           " packets with %" PRId64 "\n%-12svectors, and %" PRId64 " empty ones\n",
           "schedules", proof->batches, proof->waits, proof->packets, proof->vectors, "",
           proof->empty_packets);
    printf("%-12severy element recovered once, %" PRId64 " sums of nodes complete, no races, no\n"
           "%-12scycle of batches, waits and packets, every place in a buffer has one writer,\n"
           "%-12severy exchange in both directions; processors at most %d step%s apart\n",
           "proved", proof->sums, "", "", (int)proof->spread, proof->spread == 1 ? "" : "s");
    if (!proof->balanced)
        printf("%-12snot balanced: some processor has more elements than others\n", "note");
}

static void print_lists(const verify *v) {
    printf("%-12s%" PRIu64 " steps with random delays (seed %" PRIu64
           "): every force arrives at every node\n%-12sonce",
           "verified", v->report.listed, v->report.seed, "");
    if (v->report.passes > 1) printf(" (elements in %d passes)", (int)v->report.passes);
    printf("\n");
}

static void print_forces(const verify *v) {
    printf("%-12s%" PRIu64 " steps with forces: state hash %016" PRIx64
           ", the same as with one\n%-12sprocessor\n",
           "compared", v->setting.steps, v->report.hash, "");
}

/* ---- the command ------------------------------------------------------------------------ */

typedef struct stage {
    lar_status (*check)(const lar_verify_setting *, lar_verify_report *, lar_error *);
    void (*print)(const verify *v);
} stage;

static int check_all(verify *v) {
    static const stage stages[] = {{lar_verify_schedules, print_proof},
                                   {lar_verify_lists, print_lists},
                                   {lar_verify_forces, print_forces}};
    bool json = v->settings->json;
    if (!json) print_division(v);
    for (size_t i = 0; i < sizeof stages / sizeof stages[0]; i++) {
        lar_error error;
        v->failure = stages[i].check(&v->setting, &v->report, &error);
        if (v->failure && lar_processes_interrupted(&error)) return cli_refuse(&cli_verify, &error);
        if (v->failure)
            return cli_complain(&cli_verify,
                                v->failure == LAR_ERROR_UNSTABLE ? CLI_UNSTABLE : CLI_FAILED, "%s",
                                error.message);
        if (!json) stages[i].print(v);
        fflush(stdout);
    }
    if (json) write_json(v);
    return CLI_DONE;
}

static int serve(verify *v) {
    lar_error error;
    v->failure = lar_verify_serve(&v->setting, &error);
    return v->failure ? cli_complain_as_other(&cli_verify, v->setting.processes, &error) : CLI_DONE;
}

static int prepare(verify *v) {
    const verify_settings *s = v->settings;
    lar_options *options = &v->setting.options;
    lar_error error;
    *options = lar_options_default();
    options->element = (lar_element_kind)s->element;
    options->isa = (lar_isa)s->isa;
    cli_parallel_set(&s->parallel, options);
    if (!options->grid && !options->distribution && !options->schedules) options->grid = "1x1x1";
    int status =
        cli_processes_begin(&cli_verify, &s->parallel, s->argc, s->argv, &v->setting.processes);
    if (!status) status = cli_open_model(&cli_verify, s->scene, &v->model);
    if (!status)
        status =
            cli_processes_start(&cli_verify, v->setting.processes, v->model, options, &v->parallel);
    if (status) return status;
    v->setting.model = v->model;
    v->setting.steps = (uint64_t)s->steps;
    if (!lar_model_inspect(v->model, &v->info, &error)) return CLI_DONE;
    v->failure = error.status;
    return cli_complain_as_other(&cli_verify, v->setting.processes, &error);
}

static int verify_main(int argc, char **argv) {
    verify_settings s = {.steps = 100, .parallel = CLI_PARALLEL_NONE, .argc = argc, .argv = argv};
    const cli_option options[] = {
        CLI_PARALLEL(s.parallel),
        CLI_COUNT("--steps", "N", "with forces, to compare with one processor (100)", &s.steps, 1,
                  1e15),
        CLI_CHOICE("--element", "NAME", "hex8 (default), hex8-full, hex8-matrix", &s.element,
                   cli_element_names),
        CLI_CHOICE("--isa", "NAME", "instruction set: auto (default), c, neon, avx2, avx512",
                   &s.isa, cli_isa_names),
        CLI_FLAG("--json", "one JSON object on standard output", &s.json),
        CLI_END};
    int status = cli_parse(&cli_verify, options, argc, argv, &s.scene, 1);
    if (status < 0 && (status = cli_parallel_check(&cli_verify, &s.parallel)) == 0) status = -1;
    if (status >= 0) return status;
    verify v = {.settings = &s};
    status = prepare(&v);
    if (!status) status = lar_processes_self(v.setting.processes) > 0 ? serve(&v) : check_all(&v);
    lar_model_destroy(v.model);
    if (status && !v.failure) v.failure = LAR_ERROR_IO;
    return cli_processes_end(&cli_verify, v.setting.processes, v.failure, status);
}

const cli_command cli_verify = {
    .name = "verify",
    .summary = "prove that a division loses, doubles and mixes up nothing",
    .arguments = "SCENE",
    .description =
        "Checks a division of a model among processors: proves its schedules, lets the real\n"
        "program pass lists of elements instead of forces while random delays disturb it, and\n"
        "compares the state hash after some steps with one processor's. The exit status is 0 only\n"
        "when all of this holds. With --schedules it checks files, and names file and line of "
        "what\n"
        "is damaged.",
    .examples =
        "  lariat verify demo/uterus.yaml --grid 2x2x3\n"
        "  lariat verify demo/uterus.yaml --grid 2x2x1 --threads 2 --scheme local --comm shm\n"
        "  lariat verify demo/uterus.yaml --schedules schedules --json\n",
    .main = verify_main};
