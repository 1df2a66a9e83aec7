/* lariat bench: how fast this machine is at what Lariat does. */
#include <stdio.h>
#include <string.h>

#include "cli/bench/frame.h"
#include "cli/bench/laws.h"
#include "cli/bench/sweep.h"
#include "cli/commands.h"
#include "study/bench/kernel.h"

/* ---- lariat bench kernel ---------------------------------------------------------------- */

static void write_json(const bench_frame *frame, const lar_bench_kernel_result *r, bool general) {
    lar_json json = bench_open_json(frame);
    lar_json_number(&json, "ns_per_element", r->nanoseconds.median);
    lar_json_integer(&json, "elements", r->elements);
    lar_json_text(&json, "shape", general ? "general" : "box");
    lar_json_text(&json, "precision", "double");
    lar_json_text(&json, "isa", r->isa);
    lar_json_text(&json, "blocks", r->lean ? "lean" : "whole");
    lar_json_number(&json, "peak_gflops", r->peak_gflops.median);
    lar_json_number(&json, "fraction_of_peak", r->fraction_of_peak);
    lar_json_number(&json, "bytes_per_element", r->bytes_per_element);
    lar_json_integer(&json, "operations_per_element", LAR_BENCH_OPERATIONS);
    lar_json_integer(&json, "nodes", r->nodes);
    lar_json_integers(&json, "edge", r->edge, 3);
    lar_json_number(&json, "scaled_jacobian_min", r->scaled_jacobian_min);
    lar_json_integer(&json, "samples", r->repeat);
    lar_json_integer(&json, "steps_per_sample", (int64_t)r->steps);
    bench_write_spread(&json, "ns_per_element_spread", &r->nanoseconds);
    bench_write_spread(&json, "peak_gflops_spread", &r->peak_gflops);
    bench_close_json(frame, &json);
}

static void print_table(const lar_bench_kernel_result *r, bool general) {
    printf("%d elements (%d x %d x %d, %s), %d nodes, double precision, %s\n", (int)r->elements,
           (int)r->edge[0], (int)r->edge[1], (int)r->edge[2],
           general ? "general hexahedra" : "boxes", (int)r->nodes, r->isa);
    printf("%-17s%.2f ns (%.2f to %.2f), median of %d samples of %llu steps\n", "per element",
           r->nanoseconds.median, r->nanoseconds.min, r->nanoseconds.max, r->repeat,
           (unsigned long long)r->steps);
    printf("%-17s%.2f us\n", "per step", 1e-3 * r->nanoseconds.median * r->elements);
    printf("%-17s%.1f Gflop/s (%.1f to %.1f), fused multiply-adds of this core in the same run\n",
           "peak", r->peak_gflops.median, r->peak_gflops.min, r->peak_gflops.max);
    printf("%-17s%.1f %% (%d operations per element)\n", "of the peak", 100 * r->fraction_of_peak,
           LAR_BENCH_OPERATIONS);
    printf("%-17s%.0f bytes per element%s\n", "memory", r->bytes_per_element,
           r->lean ? ", lean blocks" : "");
}

static int kernel_main(int argc, char **argv) {
    static const char *const shapes[] = {"general", "box", NULL};
    static const char *const precisions[] = {"double", NULL};
    static const char *const forms[] = {"auto", "whole", "lean", NULL};
    int64_t elements = 0, repeat = 9;
    int shape = 0, isa = 0, precision = 0, blocks = 0;
    bool sweep = false;
    const char *svg = NULL, *law = NULL;
    bench_frame frame = bench_frame_of(&cli_bench_kernel, "kernel");
    const cli_option options[] = {
        CLI_COUNT("--elements", "N",
                  "about so many elements (1840); with --sweep at most (1000000)", &elements, 1,
                  2e7),
        CLI_FLAG("--sweep",
                 "all shapes, instruction sets and sizes of 500 and more elements,\nbeside what "
                 "memory and core allow",
                 &sweep),
        CLI_TEXT("--svg", "FILE", "of --sweep: the picture", &svg),
        CLI_TEXT("--law", "NAME",
                 "what a law, fibres or viscosity cost beside neo-Hookean elements,\nin turn: all, "
                 "or for example ogden, hgo-pair, viscous-2, yeoh+hgo",
                 &law),
        CLI_CHOICE("--shape", "NAME", "general: each of its own shape (default); or box", &shape,
                   shapes),
        CLI_CHOICE("--precision", "NAME", "double, the only one there is", &precision, precisions),
        CLI_CHOICE("--isa", "NAME", "instruction set: auto (default), c, neon, avx2, avx512", &isa,
                   cli_isa_names),
        CLI_CHOICE("--blocks", "NAME",
                   "whole: all numbers of an element stand in memory; lean: most are made\nanew in "
                   "every step; auto (default) by size. The same bits",
                   &blocks, forms),
        CLI_COUNT("--repeat", "N", "samples (9)", &repeat, 1, LAR_BENCH_REPEAT_MAX),
        BENCH_OPTIONS(frame),
        CLI_END};
    int status = cli_parse(&cli_bench_kernel, options, argc, argv, NULL, 0);
    if (status >= 0) return status;
    if (sweep) {
        if (shape > 0 || isa > 0 || blocks > 0 || law)
            return cli_complain(&cli_bench_kernel, CLI_USAGE,
                                "--sweep measures all shapes, instruction sets and blocks of one "
                                "law; leave --%s out",
                                shape > 0 ? "shape"
                                : isa > 0 ? "isa"
                                : law     ? "law"
                                          : "blocks");
        return bench_sweep(&frame, elements > 0 ? (int32_t)elements : 1000000, (int)repeat, svg);
    }
    if (svg) return cli_complain(&cli_bench_kernel, CLI_USAGE, "--svg is the picture of --sweep");
    if (elements == 0) elements = 1840;
    lar_bench_set_number(&frame.report, "elements", (double)elements);
    lar_bench_set_text(&frame.report, "shape", shapes[shape]);
    lar_bench_set_text(&frame.report, "precision", precisions[precision]);
    lar_bench_set_text(&frame.report, "isa", cli_isa_names[isa]);
    if (blocks > 0) lar_bench_set_text(&frame.report, "blocks", forms[blocks]);
    lar_bench_kernel_options wanted = {.elements = (int32_t)elements,
                                       .general = shape == 0,
                                       .isa = (lar_isa)isa,
                                       .blocks = blocks > 0 ? forms[blocks] : NULL,
                                       .repeat = (int)repeat};
    if (law) return bench_laws(&frame, &wanted, law);
    status = bench_begin(&frame);
    if (status) return status;
    lar_bench_kernel_result result;
    lar_error error;
    if (lar_bench_kernel(&wanted, &result, &error))
        return bench_abandon(&frame,
                             cli_complain(&cli_bench_kernel, CLI_FAILED, "%s", error.message));
    lar_bench_add(&frame.report, "ns", result.nanoseconds.median, true, "ns_per_element");
    lar_bench_add(&frame.report, "Gflop/s", result.peak_gflops.median, true, "peak_gflops")->more =
        true;
    if (frame.json)
        write_json(&frame, &result, wanted.general);
    else
        print_table(&result, wanted.general);
    return bench_end(&frame);
}

const cli_command cli_bench_kernel = {
    .name = "bench kernel",
    .summary = "time of a step per element, and the share of the core's peak",
    .arguments = "",
    .description =
        "Times whole steps of a free block of neo-Hookean elements in memory, and in between the\n"
        "peak of the same core at fused multiply-adds. Medians count; the least and the greatest\n"
        "sample stand beside them. For quiet figures run nothing else on the machine.",
    .examples = "  lariat bench kernel\n"
                "  lariat bench kernel --elements 100000 --shape box --json\n"
                "  lariat bench kernel --isa avx2 --repeat 31\n"
                "  lariat bench kernel --law all\n"
                "  lariat bench kernel --sweep --svg roofline.svg\n",
    .main = kernel_main};

/* ---- lariat bench ----------------------------------------------------------------------- */

const cli_command *const cli_benchmarks[] = {
    &cli_bench_kernel, &cli_bench_step,      &cli_bench_comm,     &cli_bench_scaling,
    &cli_bench_jitter, &cli_bench_precision, &cli_bench_implicit, NULL};

static int bench_main(int argc, char **argv) {
    static const char *const names[] = {"kernel", "step",      "comm",     "scaling",
                                        "jitter", "precision", "implicit", NULL};
    static const cli_option none[] = {CLI_END};
    for (int i = 0; argc > 0 && names[i]; i++)
        if (strcmp(argv[0], names[i]) == 0) return cli_benchmarks[i]->main(argc - 1, argv + 1);
    if (argc == 0 || argv[0][0] == '-') {
        const char *what;
        return cli_parse(&cli_bench, none, argc, argv, &what, 1);
    }
    const char *meant = cli_nearest_name(argv[0], names);
    return cli_complain(&cli_bench, CLI_USAGE, "there is no benchmark %s; %s%s%s", argv[0],
                        meant ? "did you mean "
                              : "there are: kernel, step, comm, scaling, jitter, precision, "
                                "implicit",
                        meant ? meant : "", meant ? "?" : "");
}

const cli_command cli_bench = {
    .name = "bench",
    .summary = "measure this machine",
    .arguments = "WHAT",
    .description =
        "WHAT is\n"
        "  kernel    time of a step per element, and the share of the core's peak\n"
        "  step      time of whole steps of a scene, the demonstration organ's or yours\n"
        "  comm      latency and bandwidth between processors, for every backend\n"
        "  scaling   time of a step with several processors, against one\n"
        "  jitter    timer jitter and scheduling latency, a thousand times a second\n"
        "  precision what single precision would lose and win\n"
        "  implicit  the same slow loading, implicitly and explicitly\n"
        "and has options of its own: lariat bench kernel --help",
    .examples = "  lariat bench kernel\n"
                "  lariat bench step demo/uterus.yaml\n"
                "  lariat bench comm\n"
                "  lariat bench scaling\n"
                "  lariat bench jitter\n"
                "  lariat bench precision\n",
    .main = bench_main};
