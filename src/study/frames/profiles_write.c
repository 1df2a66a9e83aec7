/* What becomes of profiles: the table, and the picture. */
#include <math.h>
#include <string.h>

#include "base/file/part_file.h"
#include "study/frames/profiles.h"

/* A name in a comment, in XML or in a table: what would end one is left out. */
static void plain(const char *text, char *to, size_t size) {
    size_t n = 0;
    for (; *text && n + 1 < size; text++)
        if ((unsigned char)*text >= ' ' && !strchr("\"\\<>&", *text)) to[n++] = *text;
    to[n] = '\0';
}

lar_status lar_profiles_write(const lar_profiles *p, const char *path, lar_error *error) {
    char film[256], view[256];
    lar_part_file out;
    plain(p->film, film, sizeof film);
    plain(p->view_path, view, sizeof view);
    lar_status status = lar_part_open(&out, path, error);
    if (status) return lar_part_close(&out, status);
    lar_part_print(&out,
                   "# Profiles of tissue in a tube, read by lariat %s from %s as %s has it.\n"
                   "# Seconds and metres; error is the standard deviation of z.\n"
                   "time,r,z,error\n",
                   lar_version(), film, view);
    const lar_profile_point *point = p->point;
    for (int32_t i = 0; i < p->frames.count; i++)
        for (int k = 0; k < p->view.points; k++, point++) {
            double time = lar_profiles_time(p, i);
            if (time < 0 || !(point->error > 0)) continue;
            lar_part_print(&out, "%.9g,%.6g,%.6g,%.3g\n", time, lar_profiles_radius(p, k), point->z,
                           point->error);
        }
    return lar_part_close(&out, LAR_OK);
}

/* ---- picture --------------------------------------------------------------------------------- */

enum { LEFT = 80, TOP = 40, WIDTH = 560, HEIGHT = 340, CURVES = 8 };

typedef struct axes {
    double low, high, radius; /* heights, and the longest distance [m] */
} axes;

static double x_of(const axes *a, double r) {
    return LEFT + WIDTH * r / a->radius;
}

static double y_of(const axes *a, double z) {
    return TOP + HEIGHT * (a->high - z) / (a->high - a->low);
}

static axes axes_of(const lar_profiles *p) {
    axes a = {0, 0, p->view.radius};
    for (int32_t i = 0; i < p->frames.count * p->view.points; i++) {
        if (!(p->point[i].error > 0)) continue;
        a.low = fmin(a.low, p->point[i].z);
        a.high = fmax(a.high, p->point[i].z);
    }
    double more = 0.05 * fmax(a.high - a.low, 1e-6);
    a.low -= more;
    a.high += more;
    return a;
}

/* 1, 2 or 5 times a power of ten: some five of them in a range. */
static double tick_of(double range) {
    const double power = pow(10, floor(log10(range / 5))), part = range / 5 / power;
    return power * (part < 2 ? 1 : part < 5 ? 2 : 5);
}

static void draw_frame(FILE *out, const lar_profiles *p, const axes *a) {
    char title[256];
    plain(p->film, title, sizeof title);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n"
            "<text x=\"%d\" y=\"22\">%s, some of %d frames</text>\n"
            "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#888\"/>\n"
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">distance from the axis [mm]</text>\n"
            "<text x=\"16\" y=\"%d\" transform=\"rotate(-90 16 %d)\" "
            "text-anchor=\"middle\">height [mm]</text>\n",
            LEFT + WIDTH + 30, TOP + HEIGHT + 50, LEFT, title, (int)p->frames.count, LEFT, TOP,
            WIDTH, HEIGHT, LEFT + WIDTH / 2, TOP + HEIGHT + 38, TOP + HEIGHT / 2, TOP + HEIGHT / 2);
    double tick = 1e-3 * tick_of(1e3 * a->radius);
    for (double r = 0; r <= a->radius * (1 + 1e-9); r += tick)
        fprintf(out, "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\" fill=\"#555\">%.4g</text>\n",
                x_of(a, r), TOP + HEIGHT + 16, 1e3 * r);
    tick = 1e-3 * tick_of(1e3 * (a->high - a->low));
    for (double z = tick * ceil(a->low / tick); z <= a->high; z += tick)
        fprintf(out, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\" fill=\"#555\">%.4g</text>\n",
                LEFT - 6, y_of(a, z) + 4, fabs(z) < 1e-6 * tick ? 0 : 1e3 * z);
}

/* Dots with bars of 95 %, and the time at the axis where there is room below `*label`. */
static void draw_profile(FILE *out, const lar_profiles *p, const axes *a, int32_t frame,
                         double *label) {
    static const double ROOM = 11;
    const lar_profile_point *point = &p->point[(size_t)frame * (size_t)p->view.points];
    int last = -1;
    for (int k = 0; k < p->view.points; k++) {
        if (!(point[k].error > 0)) continue;
        double x = x_of(a, lar_profiles_radius(p, k)), bar = 1.96 * point[k].error;
        fprintf(out,
                "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#b5342b\"/>\n"
                "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2\" fill=\"#b5342b\"/>\n",
                x, y_of(a, point[k].z - bar), x, y_of(a, point[k].z + bar), x, y_of(a, point[k].z));
        if (last >= 0)
            fprintf(out,
                    "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#b5342b\" "
                    "stroke-width=\"0.6\"/>\n",
                    x_of(a, lar_profiles_radius(p, last)), y_of(a, point[last].z), x,
                    y_of(a, point[k].z));
        last = k;
    }
    const double y = y_of(a, point[0].z) - 5;
    if (!(point[0].error > 0) || fabs(y - *label) < ROOM) return;
    *label = y;
    fprintf(out, "<text x=\"%d\" y=\"%.1f\" fill=\"#555\" font-size=\"10\">%.3g s</text>\n",
            LEFT + 6, y, lar_profiles_time(p, frame));
}

lar_status lar_profiles_draw(const lar_profiles *p, const char *path, lar_error *error) {
    const axes a = axes_of(p);
    lar_part_file out;
    lar_status status = lar_part_open(&out, path, error);
    if (status) return lar_part_close(&out, status);
    draw_frame(out.file, p, &a);
    const int32_t curves = p->frames.count < CURVES ? p->frames.count : CURVES;
    double label = INFINITY;
    for (int32_t i = 0; i < curves; i++)
        draw_profile(out.file, p, &a, curves > 1 ? (p->frames.count - 1) * i / (curves - 1) : 0,
                     &label);
    fprintf(out.file, "</svg>\n");
    return lar_part_close(&out, LAR_OK);
}
