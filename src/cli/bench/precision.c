/* lariat bench precision: what single precision would lose and win. */
#include <inttypes.h>
#include <stdio.h>

#include "cli/bench/frame.h"
#include "cli/commands.h"
#include "study/precision/precision.h"

typedef struct settings {
    const char *scene; /* NULL: the blocks */
    int64_t elements, steps;
    int isa;
    bench_frame frame;
} settings;

typedef struct outcome {
    int count;
    lar_precision_case what[LAR_CASE_COUNT];
    lar_precision_result result[LAR_CASE_COUNT];
    bool stable_known;
    double stable[LAR_PRECISION_COUNT];
} outcome;

enum { STABLE_STEPS_MAX = 20000 };

/* The nodes of `single` are moved by plain C: its time would say nothing. */
static bool timed(const lar_precision_way *way, int which) {
    return way->went && which != LAR_PRECISION_SINGLE;
}

static void write_way(lar_json *json, const lar_precision_way *way, int which) {
    lar_json_open(json, lar_precision_names[which], '{');
    lar_json_boolean(json, "went", way->went);
    if (way->went) {
        lar_json_number(json, "difference", way->difference);
        lar_json_number(json, "difference_most", way->difference_max);
        lar_json_number(json, "left", way->left);
        lar_json_number(json, "speed", way->speed);
        lar_json_number(json, "strain_energy", way->strain);
        lar_json_number(json, "energy_drift", way->drift);
        lar_json_number(json, "bytes_per_element", way->bytes);
        if (timed(way, which)) bench_write_spread(json, "ns_per_element_spread", &way->nanoseconds);
    }
    lar_json_close(json);
}

static void write_json(const settings *s, const outcome *o) {
    const lar_precision_result *first = &o->result[0];
    lar_json json = bench_open_json(&s->frame);
    lar_json_integer(&json, "elements", first->elements);
    lar_json_integer(&json, "nodes", first->nodes);
    lar_json_text(&json, "isa", first->isa);
    lar_json_integer(&json, "steps", s->steps);
    lar_json_number(&json, "time_step", first->time_step);
    lar_json_open(&json, "ns_per_element", '{'); /* of the first case */
    for (int w = 0; w < LAR_PRECISION_COUNT; w++)
        if (timed(&first->way[w], w))
            lar_json_number(&json, lar_precision_names[w], first->way[w].nanoseconds.median);
    lar_json_close(&json);
    lar_json_open(&json, "cases", '[');
    for (int k = 0; k < o->count; k++) {
        lar_json_open(&json, NULL, '{');
        lar_json_text(&json, "case", lar_precision_case_names[o->what[k]]);
        lar_json_number(&json, "largest", o->result[k].largest);
        for (int w = 0; w < LAR_PRECISION_COUNT; w++) write_way(&json, &o->result[k].way[w], w);
        lar_json_close(&json);
    }
    lar_json_close(&json);
    if (o->stable_known) {
        lar_json_open(&json, "stable_step_ratio", '{');
        for (int w = 0; w < LAR_PRECISION_COUNT; w++)
            lar_json_number(&json, lar_precision_names[w], o->stable[w]);
        lar_json_close(&json);
    }
    bench_close_json(&s->frame, &json);
}

static void print_case(const char *name, const lar_precision_result *r) {
    printf("\n%s, the largest displacement %.3g m\n", name, r->largest);
    printf("%-8s%12s%12s%12s%12s%12s%12s%10s\n", "", "difference", "the worst", "displaced", "m/s",
           "strain", "drift", "ns");
    for (int w = 0; w < LAR_PRECISION_COUNT; w++) {
        const lar_precision_way *way = &r->way[w];
        if (way->went)
            printf("%-8s%12.2e%12.2e%12.5f%12.2e%12.7f%12.2e", lar_precision_names[w],
                   way->difference, way->difference_max, way->left, way->speed, way->strain,
                   way->drift);
        else
            printf("%-8sstopped", lar_precision_names[w]);
        if (timed(way, w)) printf("%10.2f", way->nanoseconds.median);
        printf("\n");
    }
}

static void print_table(const settings *s, const outcome *o) {
    const lar_precision_result *first = &o->result[0];
    printf("%d elements, %d nodes, %s, %" PRId64 " steps of %.4g s\n", (int)first->elements,
           (int)first->nodes, first->isa, s->steps, first->time_step);
    printf("difference: from double, at the end and in the worst of %d looks; displaced: at the "
           "end;\nall three of the largest displacement; strain energy of the largest in double; "
           "drift of all\nenergy, of the most there was; time of a step per element\n",
           LAR_PRECISION_LOOKS);
    for (int k = 0; k < o->count; k++)
        print_case(lar_precision_case_names[o->what[k]], &o->result[k]);
    if (o->stable_known)
        printf("\n%-17sdouble %.3f, mixed %.3f, single %.3f of the engine's bound\n",
               "largest step", o->stable[LAR_PRECISION_DOUBLE], o->stable[LAR_PRECISION_MIXED],
               o->stable[LAR_PRECISION_SINGLE]);
}

static lar_status measure(const settings *s, const lar_model *model, outcome *o, lar_error *error) {
    lar_precision_options options = {.model = model,
                                     .elements = (int32_t)s->elements,
                                     .steps = (uint64_t)s->steps,
                                     .isa = (lar_isa)s->isa};
    lar_status status = LAR_OK;
    for (int k = 0; k < LAR_CASE_COUNT && !status; k++) {
        if ((k == LAR_CASE_MODEL) != (model != NULL)) continue;
        options.what = (lar_precision_case)k;
        o->what[o->count] = options.what;
        status = lar_precision_compare(&options, &o->result[o->count++], error);
    }
    if (status || model) return status;
    if (options.steps > STABLE_STEPS_MAX) options.steps = STABLE_STEPS_MAX;
    options.what = LAR_CASE_VIBRATION;
    o->stable_known = true;
    return lar_precision_stable(&options, o->stable, error);
}

static int report(settings *s, const outcome *o) {
    static const char *const keys[] = {"ns_per_element.double", "ns_per_element.mixed"};
    for (int w = 0; w < 2; w++)
        lar_bench_add(&s->frame.report, "ns", o->result[0].way[w].nanoseconds.median,
                      o->result[0].way[w].went, "%s", keys[w]);
    if (s->frame.json)
        write_json(s, o);
    else
        print_table(s, o);
    return bench_end(&s->frame);
}

static int run(settings *s) {
    outcome o = {0};
    lar_error error;
    lar_model *model = NULL;
    int status = s->scene ? cli_open_model(&cli_bench_precision, s->scene, &model) : CLI_DONE;
    if (status) return status;
    lar_bench_report *r = &s->frame.report;
    lar_bench_set_text(r, "scene", s->scene ? s->scene : "blocks");
    if (!model) lar_bench_set_number(r, "elements", (double)s->elements);
    lar_bench_set_number(r, "steps", (double)s->steps);
    lar_bench_set_text(r, "isa", cli_isa_names[s->isa]);
    status = bench_begin(&s->frame);
    if (!status && measure(s, model, &o, &error))
        status = bench_abandon(&s->frame,
                               cli_complain(&cli_bench_precision, CLI_FAILED, "%s", error.message));
    else if (!status)
        status = report(s, &o);
    lar_model_destroy(model);
    return status;
}

static int precision_main(int argc, char **argv) {
    settings s = {.elements = 200, .steps = 10000};
    s.frame = bench_frame_of(&cli_bench_precision, "precision");
    const cli_option options[] = {
        CLI_COUNT("--elements", "N", "of the blocks, about so many (200)", &s.elements, 8, 1e6),
        CLI_COUNT("--steps", "N", "of every case (10000)", &s.steps, LAR_PRECISION_LOOKS, 1e9),
        CLI_CHOICE("--isa", "NAME", "instruction set: c or avx512; others have no single precision",
                   &s.isa, cli_isa_names),
        BENCH_OPTIONS(s.frame), CLI_END};
    int status = cli_parse(&cli_bench_precision, options, argc, argv, &s.scene, 1);
    return status >= 0 ? status : run(&s);
}

const cli_command cli_bench_precision = {
    .name = "bench precision",
    .summary = "what single precision would lose and win",
    .arguments = "[SCENE]",
    .description =
        "Computes the same three ways beside each other: in double, with elements in single\n"
        "precision and nodes in double (mixed), and all in single precision. Without a scene,\n"
        "blocks: swinging, hanging at rest, loaded and unloaded, turning freely, creeping, and\n"
        "creeping a metre away; then the largest step that each way bears.",
    .examples = "  lariat bench precision\n"
                "  lariat bench precision --steps 1000000\n"
                "  lariat bench precision demo/uterus.yaml --json\n",
    .main = precision_main};
