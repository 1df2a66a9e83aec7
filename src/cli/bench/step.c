/* lariat bench step: how long the steps of a scene take on this machine. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "cli/bench/frame.h"
#include "cli/commands.h"
#include "study/bench/step.h"

typedef struct step_settings {
    const char *scene;              /* NULL: the demonstration organ */
    int64_t repeat, steps, warm_up; /* steps 0, warm_up -1: not given */
    int isa;
    bench_frame frame;
} step_settings;

static double real_time_factor(const lar_bench_step_result *r) {
    return 1e6 * r->time_step / r->microseconds.median;
}

static void write_json(const bench_frame *frame, const lar_bench_step_result *r) {
    lar_json json = bench_open_json(frame);
    lar_json_text(&json, "title", r->info.title);
    lar_json_integer(&json, "elements", r->info.elements);
    lar_json_integer(&json, "nodes", r->info.nodes);
    lar_json_text(&json, "isa", r->isa);
    lar_json_number(&json, "time_step", r->time_step);
    lar_json_integer(&json, "samples", r->repeat);
    lar_json_integer(&json, "warm_up_steps", (int64_t)r->warm_up);
    lar_json_integer(&json, "steps_per_sample", (int64_t)r->steps);
    lar_json_number(&json, "us_per_step", r->microseconds.median);
    bench_write_spread(&json, "us_per_step_spread", &r->microseconds);
    lar_json_open(&json, "single_steps_us", '{');
    lar_json_number(&json, "mean", r->mean);
    lar_json_number(&json, "p50", r->p50);
    lar_json_number(&json, "p99", r->p99);
    lar_json_number(&json, "p999", r->p999);
    lar_json_number(&json, "max", r->longest);
    lar_json_close(&json);
    lar_json_open(&json, "saved_us", '{');
    lar_json_number(&json, "save", r->save);
    lar_json_number(&json, "load", r->load);
    lar_json_number(&json, "step_after", r->step_after);
    lar_json_close(&json);
    lar_json_number(&json, "ns_per_element", 1e3 * r->microseconds.median / r->info.elements);
    lar_json_number(&json, "real_time_factor", real_time_factor(r));
    lar_json_integer(&json, "touching", r->contact.touching);
    lar_json_hash(&json, "state_hash", r->hash);
    bench_close_json(frame, &json);
}

static void print_table(const step_settings *s, const lar_bench_step_result *r) {
    const lar_spread *time = &r->microseconds;
    printf("%s: %d elements, %d nodes, %s\n", *r->info.title ? r->info.title : s->scene,
           (int)r->info.elements, (int)r->info.nodes, r->isa);
    printf("%-17s%.2f us (%.2f to %.2f), median of %d samples of %" PRIu64 " steps after %" PRIu64
           "\n",
           "a step", time->median, time->min, time->max, r->repeat, r->steps, r->warm_up);
    printf("%-17shalf below %.2f us, 99 %% below %.2f, 99.9 %% below %.2f, the longest %.2f, "
           "mean %.2f\n",
           "single steps", r->p50, r->p99, r->p999, r->longest, r->mean);
    printf("%-17s%.2f ns\n", "per element", 1e3 * time->median / r->info.elements);
    printf("%-17s%.3g times as fast as the clock (a step is %.4g s)\n", "real time",
           real_time_factor(r), r->time_step);
    if (r->contact.touching > 0)
        printf("%-17s%d nodes touch at the end\n", "contact", (int)r->contact.touching);
    printf("%-17ssaving it in memory %.2f us, going back to it %.2f, the step after that %.2f\n",
           "state", r->save, r->load, r->step_after);
    printf("%-17s%016" PRIx64 ", the same in all samples\n", "state hash", r->hash);
}

static int report(step_settings *s, const lar_bench_step_result *r) {
    lar_bench_report *report = &s->frame.report;
    lar_bench_add(report, "us", r->microseconds.median, true, "us_per_step");
    lar_bench_add(report, "us", r->mean, false, "single_steps_us.mean");
    lar_bench_add(report, "us", r->p99, false, "single_steps_us.p99");
    lar_bench_add(report, "us", r->p999, false, "single_steps_us.p999");
    lar_bench_add(report, "us", r->longest, false, "single_steps_us.max");
    if (s->frame.json)
        write_json(&s->frame, r);
    else
        print_table(s, r);
    return bench_end(&s->frame);
}

/* The steps of a scene do not all cost the same: without --steps as many as the earlier run did. */
static void take_over(const bench_frame *frame, int64_t *value, const char *key) {
    char text[LAR_BENCH_TEXT];
    bool known = frame->baseline && lar_baseline_text(frame->baseline, key, text, sizeof text);
    long long earlier = known ? strtoll(text, NULL, 10) : -1;
    if (earlier >= 0 && earlier <= LAR_BENCH_STEP_STEPS_MAX) *value = earlier;
}

static void set_count(lar_bench_report *report, const char *name, bool given, int64_t count) {
    if (given)
        lar_bench_set_number(report, name, (double)count);
    else
        lar_bench_set_text(report, name, "auto");
}

/* What the figures depend on; a scene is known by what is in it. */
static int begin(step_settings *s, const lar_model *model) {
    lar_bench_report *r = &s->frame.report;
    lar_model_info info;
    lar_error error;
    if (lar_model_inspect(model, &info, &error))
        return cli_complain(&cli_bench_step, CLI_FAILED, "%s", error.message);
    lar_bench_set_text(r, "title", info.title);
    lar_bench_set_number(r, "elements", info.elements);
    lar_bench_set_number(r, "nodes", info.nodes);
    lar_bench_set_number(r, "time_step", info.time_step);
    lar_bench_set_text(r, "isa", cli_isa_names[s->isa]);
    set_count(r, "steps", s->steps > 0, s->steps);
    set_count(r, "warm_up", s->warm_up >= 0, s->warm_up);
    int status = bench_begin(&s->frame);
    if (status) return status;
    if (s->steps == 0) take_over(&s->frame, &s->steps, "steps_per_sample");
    if (s->warm_up < 0) take_over(&s->frame, &s->warm_up, "warm_up_steps");
    return CLI_DONE;
}

static int measure(step_settings *s, const lar_model *model) {
    lar_bench_step_result result;
    lar_error error;
    int failure = begin(s, model);
    if (failure) return failure;
    const lar_bench_step_options wanted = {.model = model,
                                           .isa = (lar_isa)s->isa,
                                           .steps = (uint64_t)s->steps,
                                           .warm_up =
                                               s->warm_up < 0 ? UINT64_MAX : (uint64_t)s->warm_up,
                                           .repeat = (int)s->repeat};
    lar_status status = lar_bench_step(&wanted, &result, &error);
    if (!status) return report(s, &result);
    return bench_abandon(&s->frame, cli_refuse(&cli_bench_step, &error));
}

static int open_model(const char *scene, lar_model **model) {
    lar_error error;
    if (scene) return cli_open_model(&cli_bench_step, scene, model);
    if (lar_bench_step_organ(model, &error))
        return cli_complain(&cli_bench_step, CLI_FAILED, "%s", error.message);
    return CLI_DONE;
}

static int step_main(int argc, char **argv) {
    step_settings s = {
        .repeat = 9, .warm_up = -1, .frame = bench_frame_of(&cli_bench_step, "step")};
    const cli_option options[] = {
        CLI_COUNT("--steps", "N",
                  "of a sample (1, 2 or 5 times a power of ten that last\nsome tenths of a second; "
                  "with --against as many as then)",
                  &s.steps, 1, LAR_BENCH_STEP_STEPS_MAX),
        CLI_COUNT("--warm-up", "N", "steps before them that do not count (a fifth as many)",
                  &s.warm_up, 0, LAR_BENCH_STEP_STEPS_MAX),
        CLI_CHOICE("--isa", "NAME", "instruction set: auto (default), c, neon, avx2, avx512",
                   &s.isa, cli_isa_names),
        CLI_COUNT("--repeat", "N", "samples (9)", &s.repeat, 1, LAR_BENCH_REPEAT_MAX),
        BENCH_OPTIONS(s.frame),
        CLI_END};
    lar_model *model = NULL;
    int status = cli_parse(&cli_bench_step, options, argc, argv, &s.scene, 1);
    if (status >= 0) return status;
    status = open_model(s.scene, &model);
    if (!status) status = measure(&s, model);
    lar_model_destroy(model);
    return status;
}

const cli_command cli_bench_step = {
    .name = "bench step",
    .summary = "time of whole steps of a scene",
    .arguments = "[SCENE]",
    .description =
        "Times steps of a scene, with its contact and tools, as lariat run does them on one\n"
        "processor; nothing is written. Without a scene it is the demonstration organ's. Every\n"
        "sample makes its simulation anew and does the same steps. For quiet figures run nothing\n"
        "else on the machine.",
    .examples = "  lariat bench step\n"
                "  lariat bench step demo/uterus_live.yaml --repeat 31\n"
                "  lariat bench step --json > before.json\n"
                "  lariat bench step --against before.json --tolerance 5\n",
    .main = step_main};
