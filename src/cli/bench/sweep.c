#include "cli/bench/sweep.h"

#include <stdio.h>
#include <unistd.h>

#include "cli/commands.h"
#include "cli/stop.h"
#include "study/bench/sweep.h"

static bool tell(void *context, const char *what) {
    (void)context;
    if (isatty(STDERR_FILENO)) {
        fprintf(stderr, "\r%s \033[K", what);
        fflush(stderr);
    }
    return !cli_stop_asked;
}

static void print_table(const lar_sweep_result *r) {
    printf("%-8s%-9s%10s%10s%10s%10s%12s%10s\n", "isa", "shape", "elements", "ns", "Gflop/s",
           "of peak", "bytes each", "of roof");
    for (int i = 0; i < r->rows; i++) {
        const lar_sweep_row *row = &r->row[i];
        printf("%-8s%-9s%10d%10.2f%10.1f%8.1f %%%12.0f%8.1f %%\n", row->kernel.isa,
               lar_sweep_shape_name[row->shape], (int)row->kernel.elements,
               row->kernel.nanoseconds.median, row->gflops, 100 * row->kernel.fraction_of_peak,
               row->kernel.bytes_per_element, 100 * row->gflops / row->roof);
    }
    printf("memory: %.1f GB/s read by one core; the roof is what memory and peak allow, caches do "
           "better\n",
           r->bandwidth);
    if (r->left_out > 0)
        printf("%d elements and more are left out: half of the free memory does not hold them\n",
               (int)r->left_out);
}

static void write_json(const bench_frame *frame, const lar_sweep_result *r) {
    lar_json json = bench_open_json(frame);
    lar_json_number(&json, "bandwidth", r->bandwidth);
    lar_json_integer(&json, "left_out", r->left_out);
    lar_json_open(&json, "sweep", '[');
    for (int i = 0; i < r->rows; i++) {
        const lar_sweep_row *row = &r->row[i];
        lar_json_open(&json, NULL, '{');
        lar_json_text(&json, "isa", row->kernel.isa);
        lar_json_text(&json, "shape", lar_sweep_shape_name[row->shape]);
        lar_json_integer(&json, "elements", row->kernel.elements);
        lar_json_number(&json, "ns_per_element", row->kernel.nanoseconds.median);
        lar_json_number(&json, "gflops", row->gflops);
        lar_json_number(&json, "peak_gflops", row->kernel.peak_gflops.median);
        lar_json_number(&json, "fraction_of_peak", row->kernel.fraction_of_peak);
        lar_json_number(&json, "bytes_per_element", row->kernel.bytes_per_element);
        lar_json_number(&json, "roof_gflops", row->roof);
        lar_json_close(&json);
    }
    lar_json_close(&json);
    bench_close_json(frame, &json);
}

int bench_sweep(bench_frame *frame, int32_t elements, int repeat, const char *svg) {
    lar_sweep_result result;
    lar_error error;
    lar_bench_set_number(&frame->report, "elements", (double)elements);
    lar_bench_set_text(&frame->report, "shape", "sweep");
    int status = bench_begin(frame);
    if (status) return status;
    cli_catch_stop();
    const lar_sweep_options options = {.elements = elements, .repeat = repeat, .callback = tell};
    lar_status failed = lar_bench_sweep(&options, &result, &error);
    if (isatty(STDERR_FILENO)) fputs("\r\033[K", stderr);
    if (!failed && svg) failed = lar_sweep_write_svg(svg, &result, frame->machine.cpu, &error);
    if (failed)
        return bench_abandon(frame,
                             cli_complain(&cli_bench_kernel, CLI_FAILED, "%s", error.message));
    for (int i = 0; i < result.rows; i++) {
        const lar_sweep_row *row = &result.row[i];
        char name[64];
        snprintf(name, sizeof name, "%s_%s_%d", row->kernel.isa, lar_sweep_shape_name[row->shape],
                 (int)row->kernel.elements);
        lar_bench_add(&frame->report, "ns", row->kernel.nanoseconds.median, true, "%s", name);
    }
    if (frame->json)
        write_json(frame, &result);
    else
        print_table(&result);
    if (!cli_stop_asked) return bench_end(frame);
    return bench_abandon(frame, CLI_INTERRUPTED);
}
