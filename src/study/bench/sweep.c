#include "study/bench/sweep.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/file/part_file.h"
#include "study/bench/fma_peak.h"
#include "study/machine.h"

/* ---- memory --------------------------------------------------------------------------------- */

/* More than the caches of most machines hold. */
static const size_t BYTES = (size_t)256 << 20;

/* What was read goes here, so that no compiler leaves reading out. */
static volatile uint64_t read_result;

static double read_once(const uint64_t *word, size_t words) {
    double begin = lar_clock_seconds();
    uint64_t sum[8] = {0};
    for (size_t i = 0; i < words; i += 8)
        for (size_t j = 0; j < 8; j++) sum[j] += word[i + j];
    for (size_t j = 1; j < 8; j++) sum[0] += sum[j];
    read_result = sum[0];
    return lar_clock_seconds() - begin;
}

static lar_status measure_bandwidth(double *gigabytes, lar_error *error) {
    enum { TIMES = 9 };
    double sample[TIMES];
    uint64_t *word = malloc(BYTES);
    if (!word) return lar_fail_memory(error, BYTES, "memory to be read");
    for (size_t i = 0; i < BYTES / sizeof *word; i++) word[i] = i;
    for (int i = 0; i < TIMES; i++)
        sample[i] = 1e-9 * (double)BYTES / read_once(word, BYTES / sizeof *word);
    *gigabytes = lar_spread_of(sample, TIMES).median;
    free(word);
    return LAR_OK;
}

/* Half of what is free; infinite where the system does not say. */
static double room(void) {
    double memory = lar_machine_memory("MemAvailable");
    return memory > 0 ? 0.5 * memory : INFINITY;
}

/* ---- rows ----------------------------------------------------------------------------------- */

static const struct {
    lar_isa isa;
    const char *name;
    int32_t max; /* elements: slower ones take too long */
} sets[] = {{LAR_ISA_AVX512, "avx512", INT32_MAX},
            {LAR_ISA_AVX2, "avx2", INT32_MAX},
            {LAR_ISA_NEON, "neon", INT32_MAX},
            {LAR_ISA_C, "c", 20000}};

const char *const lar_sweep_shape_name[LAR_SWEEP_SHAPES] = {"general", "lean", "box"};

static lar_status add_row(const lar_sweep_options *o, int32_t elements, lar_isa isa,
                          lar_sweep_shape shape, lar_sweep_result *result, lar_error *error) {
    const lar_bench_kernel_options wanted = {.elements = elements,
                                             .general = shape != LAR_SWEEP_BOX,
                                             .isa = isa,
                                             .blocks = shape == LAR_SWEEP_LEAN ? "lean" : "whole",
                                             .repeat = o->repeat};
    lar_sweep_row row = {.shape = shape};
    lar_status status = lar_bench_kernel(&wanted, &row.kernel, error);
    if (status == LAR_ERROR_UNSUPPORTED) return LAR_OK;
    if (status) return status;
    row.gflops = LAR_BENCH_OPERATIONS / row.kernel.nanoseconds.median;
    row.intensity = LAR_BENCH_OPERATIONS / row.kernel.bytes_per_element;
    row.roof = fmin(row.kernel.peak_gflops.median, row.intensity * result->bandwidth);
    result->row[result->rows++] = row;
    return LAR_OK;
}

static bool goes_on(const lar_sweep_options *o, int32_t elements, const char *isa,
                    lar_sweep_shape shape) {
    static const char *const plural[] = {"general elements", "lean general elements", "boxes"};
    char what[80];
    snprintf(what, sizeof what, "%d %s, %s", (int)elements, plural[shape], isa);
    return !o->callback || o->callback(o->context, what);
}

lar_status lar_bench_sweep(const lar_sweep_options *o, lar_sweep_result *result, lar_error *error) {
    static const double OF_AN_ELEMENT = 1500; /* bytes while a block is made and measured */
    const int32_t size[LAR_SWEEP_SIZES] = {500, 1840, 20000, 200000, o->elements};
    lar_sweep_result made = {0};
    lar_status status = measure_bandwidth(&made.bandwidth, error);
    for (int s = 0; s < LAR_SWEEP_SIZES && !status; s++) {
        if (size[s] > o->elements || (s > 0 && size[s] == size[s - 1])) continue;
        if (s == LAR_SWEEP_SIZES - 1 && size[s] <= size[s - 1]) continue; /* had before */
        if (OF_AN_ELEMENT * size[s] > room()) {
            made.left_out = size[s];
            break;
        }
        for (size_t k = 0; k < sizeof sets / sizeof *sets && !status; k++)
            for (lar_sweep_shape shape = 0; shape < LAR_SWEEP_SHAPES && !status; shape++) {
                if (size[s] > sets[k].max || !lar_fma_peak_find(sets[k].name)) continue;
                if (!goes_on(o, size[s], sets[k].name, shape)) goto end;
                status = add_row(o, size[s], sets[k].isa, shape, &made, error);
            }
    }
end:
    if (!status) *result = made;
    return status;
}

/* ---- the picture ---------------------------------------------------------------------------- */

/* Both axes are logarithmic. */
typedef struct axes {
    FILE *out;
    double x0, x1, y0, y1; /* operations per byte, Gflop/s */
} axes;

enum { LEFT = 70, TOP = 40, WIDTH = 560, HEIGHT = 360 };

static double x_of(const axes *a, double intensity) {
    return LEFT + WIDTH * log(intensity / a->x0) / log(a->x1 / a->x0);
}

static double y_of(const axes *a, double gflops) {
    return TOP + HEIGHT * (1 - log(gflops / a->y0) / log(a->y1 / a->y0));
}

static void draw_line(const axes *a, double x1, double y1, double x2, double y2,
                      const char *style) {
    fprintf(a->out, "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" %s/>\n", x_of(a, x1),
            y_of(a, y1), x_of(a, x2), y_of(a, y2), style);
}

static void draw_axes(const axes *a, const char *cpu) {
    char name[128];
    size_t n = 0; /* what XML or a terminal would take for something else is left out */
    for (const char *c = cpu; *c && n < sizeof name - 1; c++)
        if (*c >= ' ' && *c != '<' && *c != '&' && *c < 127) name[n++] = *c;
    name[n] = '\0';
    fprintf(a->out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n"
            "<text x=\"%d\" y=\"22\">A step of an element on one processor core: %s</text>\n"
            "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#888\"/>\n",
            LEFT + WIDTH + 190, TOP + HEIGHT + 50, LEFT, name, LEFT, TOP, WIDTH, HEIGHT);
    for (double tick = pow(2, ceil(log2(a->x0))); tick <= a->x1; tick *= 2)
        fprintf(a->out,
                "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\" fill=\"#555\">%g</text>\n",
                x_of(a, tick), TOP + HEIGHT + 16, tick);
    for (double tick = pow(2, ceil(log2(a->y0))); tick <= a->y1; tick *= 2)
        fprintf(a->out, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\" fill=\"#555\">%g</text>\n",
                LEFT - 6, y_of(a, tick) + 4, tick);
    fprintf(a->out,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">operations per byte</text>\n"
            "<text x=\"18\" y=\"%d\" transform=\"rotate(-90 18 %d)\" "
            "text-anchor=\"middle\">Gflop/s</text>\n",
            LEFT + WIDTH / 2, TOP + HEIGHT + 38, TOP + HEIGHT / 2, TOP + HEIGHT / 2);
}

static const char *color_of(const char *isa) {
    return strcmp(isa, "avx512") == 0 ? "#b5342b" : strcmp(isa, "c") == 0 ? "#666666" : "#2b5fb5";
}

/* Memory's slope up to the peak of the set, and the peak from there. */
static void draw_roof(const axes *a, const lar_sweep_result *r, const lar_sweep_row *row) {
    char style[80];
    double peak = row->kernel.peak_gflops.median;
    double begin = fmax(a->x0, a->y0 / r->bandwidth); /* where memory's slope comes into sight */
    double knee = fmax(a->x0, fmin(a->x1, peak / r->bandwidth));
    snprintf(style, sizeof style, "stroke=\"%s\"", color_of(row->kernel.isa));
    if (begin < knee)
        draw_line(a, begin, begin * r->bandwidth, knee, knee * r->bandwidth,
                  "stroke=\"#222\" stroke-dasharray=\"4 3\"");
    draw_line(a, knee, peak, a->x1, peak, style);
    draw_line(a, a->x0, peak, knee, peak, "stroke=\"#ccc\"");
    fprintf(a->out, "<text x=\"%.1f\" y=\"%.1f\" fill=\"%s\">%s, peak %.0f</text>\n",
            (double)(LEFT + WIDTH + 8), y_of(a, peak) + 4, color_of(row->kernel.isa),
            row->kernel.isa, peak);
}

static void draw_points(const axes *a, const lar_sweep_result *r) {
    for (int i = 0; i < r->rows; i++) {
        const lar_sweep_row *row = &r->row[i];
        double x = x_of(a, row->intensity), y = y_of(a, row->gflops);
        const char *color = color_of(row->kernel.isa);
        if (row->shape != LAR_SWEEP_BOX)
            fprintf(a->out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" fill=\"%s\" stroke=\"%s\"/>\n",
                    x, y, row->shape == LAR_SWEEP_LEAN ? "#fff" : color, color);
        else
            fprintf(a->out,
                    "<rect x=\"%.1f\" y=\"%.1f\" width=\"8\" height=\"8\" fill=\"none\" "
                    "stroke=\"%s\"/>\n",
                    x - 4, y - 4, color);
        fprintf(a->out, "<text x=\"%.1f\" y=\"%.1f\" font-size=\"9\" fill=\"#555\">%d</text>\n",
                x + 6, y + 3, (int)row->kernel.elements);
        bool first = true;
        for (int k = 0; k < i; k++) first = first && r->row[k].kernel.isa != row->kernel.isa;
        if (first) draw_roof(a, r, row);
    }
    fprintf(a->out,
            "<text x=\"%d\" y=\"%d\" fill=\"#555\">filled: general, open: lean, squares: boxes; memory %.1f GB/s "
            "(dashed)</text>\n</svg>\n",
            LEFT + 8, TOP + 16, r->bandwidth);
}

lar_status lar_sweep_write_svg(const char *path, const lar_sweep_result *r, const char *cpu,
                               lar_error *error) {
    axes a = {.x0 = 1, .x1 = 8, .y0 = 1, .y1 = 2};
    for (int i = 0; i < r->rows; i++) {
        const lar_sweep_row *row = &r->row[i];
        a.x0 = fmin(a.x0, 0.7 * row->intensity);
        a.x1 = fmax(a.x1, 1.5 * row->intensity);
        a.y0 = fmin(a.y0, 0.7 * row->gflops);
        a.y1 = fmax(a.y1, 1.4 * row->kernel.peak_gflops.median);
    }
    lar_part_file output;
    lar_status status = lar_part_open(&output, path, error);
    if (status) return lar_part_close(&output, status);
    a.out = output.file;
    draw_axes(&a, cpu);
    draw_points(&a, r);
    return lar_part_close(&output, LAR_OK);
}
