#include "study/predict/network_trace.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/file/part_file.h"

enum { BARS_MAX = 256 };

lar_status lar_network_write_csv(const char *path, const lar_network_result *r, lar_error *error) {
    lar_part_file o;
    lar_status status = lar_part_open(&o, path, error);
    if (status) return lar_part_close(&o, status);
    fprintf(o.file, "kind,processor,thread,peer,begin_us,end_us\n");
    for (size_t i = 0; i < r->span_count; i++) {
        const lar_network_span *s = &r->span[i];
        fprintf(o.file, "%s,%d,%d,%d,%.6g,%.6g\n", lar_span_kind_name[s->kind], (int)s->processor,
                (int)s->thread, (int)s->peer, 1e6 * s->begin, 1e6 * s->end);
    }
    return lar_part_close(&o, LAR_OK);
}

/* ---- pictures ------------------------------------------------------------------------------- */

typedef struct picture {
    FILE *out;
    const lar_network_result *result;
    double left, width; /* of both diagrams */
    double top, height; /* of the occupation */
    double bars, bar;   /* top of the threads' bars, height of one */
    double span;        /* time from left to right [us], of the longer diagram */
    int32_t rows;
} picture;

static double x_of(const picture *p, double seconds) {
    return p->left + p->width * 1e6 * seconds / p->span;
}

static void line(const picture *p, double x1, double y1, double x2, double y2, double width) {
    fprintf(p->out,
            "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" stroke=\"#000\" "
            "stroke-width=\"%g\"/>\n",
            x1, y1, x2, y2, width);
}

static void text(const picture *p, double x, double y, const char *anchor, const char *words) {
    fprintf(p->out, "<text x=\"%.2f\" y=\"%.2f\" text-anchor=\"%s\">", x, y, anchor);
    for (; *words; words++) {
        if (*words == '<')
            fputs("&lt;", p->out);
        else if (*words == '&')
            fputs("&amp;", p->out);
        else
            fputc(*words, p->out);
    }
    fputs("</text>\n", p->out);
}

/* 1, 2 or 5 times a power of ten, for about so many steps. */
static double nice_step(double range, int steps) {
    double raw = range / steps, power = pow(10, floor(log10(raw))), part = raw / power;
    return power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
}

static void time_axis(const picture *p, double y, const char *name) {
    char label[32];
    double step = nice_step(p->span, 8);
    line(p, p->left, y, p->left + p->width, y, 1);
    for (double t = 0; t <= p->span * 1.0001; t += step) {
        double x = p->left + p->width * t / p->span;
        line(p, x, y, x, y + 4, 1);
        snprintf(label, sizeof label, "%g", t);
        text(p, x, y + 16, "middle", label);
    }
    text(p, p->left + p->width / 2, y + 32, "middle", name);
}

static void occupation(const picture *p) {
    const lar_network_result *r = p->result;
    double bin = r->start_step / LAR_NETWORK_START_SLICES, bottom = p->top + p->height;
    fprintf(p->out, "<path fill=\"#888\" stroke=\"#000\" d=\"M%.2f %.2f", p->left, bottom);
    for (int k = 0; k < LAR_NETWORK_START_SLICES; k++)
        fprintf(p->out, "L%.2f %.2fL%.2f %.2f", x_of(p, k * bin),
                bottom - r->start_slice[k] * p->height, x_of(p, (k + 1) * bin),
                bottom - r->start_slice[k] * p->height);
    fprintf(p->out, "L%.2f %.2fz\"/>\n", x_of(p, r->start_step), bottom);
    for (int tenth = 0; tenth <= 10; tenth += 2) {
        char label[16];
        double y = bottom - p->height * tenth / 10;
        snprintf(label, sizeof label, "%d %%", 10 * tenth);
        line(p, p->left - 4, y, p->left, y, 1);
        text(p, p->left - 8, y + 4, "end", label);
    }
    line(p, p->left, p->top, p->left, bottom, 1);
    text(p, p->left, p->top - 8, "start",
         "links that send, of all, in a step that all begin together");
    time_axis(p, bottom, "time from the common start [us]");
}

static void bars(const picture *p) {
    static const char *const fill[LAR_SPAN_KINDS] = {"#aaa", "#000", "#fff", "none"};
    const lar_network_result *r = p->result;
    double bottom = p->bars + p->rows * p->bar;
    text(p, p->left, p->bars - 8, "start",
         "threads of processors in a later step: grey computes, black exchanges, white waits");
    for (size_t i = 0; i < r->span_count; i++) {
        const lar_network_span *s = &r->span[i];
        int32_t row = s->processor * r->threads + s->thread;
        if (s->kind == LAR_SPAN_LINK || s->kind == LAR_SPAN_WAIT || row >= p->rows) continue;
        fprintf(p->out,
                "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"%s\"/>\n",
                x_of(p, s->begin), p->bars + row * p->bar + 1, x_of(p, s->end) - x_of(p, s->begin),
                p->bar - 2, fill[s->kind]);
    }
    for (int32_t row = 0; row < p->rows; row++) {
        char label[32];
        double y = p->bars + row * p->bar;
        line(p, p->left, y, p->left + p->width, y, 0.2);
        if (row % r->threads) continue;
        snprintf(label, sizeof label, "%d", (int)(row / r->threads));
        text(p, p->left - 8, y + p->bar * 0.75, "end", label);
    }
    line(p, p->left, p->bars, p->left, bottom, 1);
    time_axis(p, bottom,
              "time in a later step, from when the last thread ended the one before [us]");
}

lar_status lar_network_write_svg(const char *path, const lar_network_result *r, const char *title,
                                 lar_error *error) {
    lar_part_file o;
    if (!(r->step > 0) || !isfinite(r->step))
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s: the step takes no time", path);
    lar_status status = lar_part_open(&o, path, error);
    if (status) return lar_part_close(&o, status);
    picture p = {.out = o.file,
                 .result = r,
                 .left = 60,
                 .width = 800,
                 .top = 50,
                 .height = 180,
                 .bar = r->threads > 1 ? 10 : 14,
                 .span = 1e6 * fmax(r->step, r->start_step),
                 .rows = r->processors * r->threads};
    if (p.rows > BARS_MAX) p.rows = BARS_MAX;
    p.bars = p.top + p.height + 70;
    fprintf(o.file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"900\" height=\"%.0f\" "
            "font-family=\"sans-serif\" font-size=\"11\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            p.bars + p.rows * p.bar + 50);
    text(&p, p.left, 22, "start", title);
    occupation(&p);
    bars(&p);
    fprintf(o.file, "</svg>\n");
    return lar_part_close(&o, LAR_OK);
}
