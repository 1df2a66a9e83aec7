#include "study/inverse/output.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/file/folder.h"
#include "base/file/part_file.h"
#include "study/inverse/json.h"
#include "study/inverse/parameters.h"

bool lar_inverse_first_of_material(const lar_inverse_problem *p, int j) {
    for (int i = 0; i < j; i++)
        if (strcmp(p->parameter[i].material, p->parameter[j].material) == 0) return false;
    return true;
}

/* ---- tissue ---------------------------------------------------------------------------------- */

/* A name as YAML and XML take it: what would mean something else there is left out. */
static void plain(const char *text, char *to, size_t size) {
    size_t n = 0;
    for (; *text && n + 1 < size; text++)
        if ((unsigned char)*text >= ' ' && !strchr("\"\\<>&", *text)) to[n++] = *text;
    to[n] = '\0';
}

static void write_how_well(FILE *out, const char *name, const lar_inverse_estimate *e,
                           const lar_inverse_result *r) {
    if (e->told && isfinite(e->low))
        fprintf(out, "# %s: fitted, 95 %% between %.4g and %.4g%s.\n", name, e->low, e->high,
                e->given_bound ? ", given what stands at its bound" : "");
    else if (e->at_bound)
        fprintf(out,
                "# %s: STANDS AT A BOUND of the fit; the data ask for a value beyond, so rely on "
                "none of these.\n",
                name);
    else if (r->interrupted)
        fprintf(out, "# %s: the best so far, without an interval.\n", name);
    else if (isnan(r->deviation))
        fprintf(out, "# %s: as many parameters as measured numbers, so HOW WELL IS NOT KNOWN.\n",
                name);
    else
        fprintf(out, "# %s: CANNOT BE TOLD from these data; the value is one of many.\n", name);
}

static void write_provenance(FILE *out, const lar_inverse_problem *p, const lar_inverse_result *r,
                             const char *material) {
    char text[256], date[32] = "";
    time_t now = time(NULL);
    struct tm utc;
    if (gmtime_r(&now, &utc)) strftime(date, sizeof date, "%Y-%m-%d", &utc);
    plain(p->path, text, sizeof text);
    fprintf(out, "# Fitted by lariat %s on %s from %s%s.\n", lar_version(), date, text,
            r->interrupted ? ", interrupted: the best so far" : "");
    for (int k = 0; k < p->experiments; k++) {
        plain(p->experiment[k].data, text, sizeof text);
        fprintf(out, "# %s: %s, %d values, residual %.2g %% of %s.\n",
                lar_inverse_kind_name[p->experiment[k].kind], text, (int)p->experiment[k].values,
                100 * r->residuals[k].relative, lar_inverse_whole(&p->experiment[k]));
    }
    for (int j = 0; j < p->parameters; j++)
        if (strcmp(p->parameter[j].material, material) == 0)
            write_how_well(out, p->parameter[j].name, &r->estimate[j], r);
    fprintf(out, "# All else is as the scenes of the fit have it.\n");
}

/* Along what they run is the scene's to say. */
static void write_fibres(FILE *out, const lar_fibre *fibre) {
    if (!lar_fibre_here(fibre)) return;
    fprintf(out, "fibres:\n");
    if (fibre->law != LAR_FIBRE_NONE)
        fprintf(out, "  law: %s\n  part: %s\n", lar_fibre_law_name[fibre->law],
                fibre->isochoric ? "isochoric" : "whole");
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++) {
        const char *name = lar_fibre_parameter_name[fibre->law][k];
        if (name) fprintf(out, "  %s: %.9g\n", name, fibre->parameter[k]);
    }
    if (lar_fibre_active(fibre))
        fprintf(out, "  active: { along: %.9g, across: %.9g }\n", fibre->along, fibre->across);
}

static void write_material(FILE *out, const lar_material *m) {
    const lar_law_row *law = &lar_law_table[m->law];
    fprintf(out, "law: %s\ndensity: %.9g\n", law->name, m->density);
    for (int i = 0; i < law->count; i++)
        if (m->parameter[i] != 0 || !lar_law_may_miss(law->parameter, i))
            fprintf(out, "%s: %.9g\n", law->parameter[i].name, m->parameter[i]);
    write_fibres(out, &m->fibre);
    if (m->viscosity.terms == 0) return;
    fprintf(out, "viscous:\n  part: %s\n  g0: %.9g\n  terms:\n",
            m->viscosity.isochoric ? "isochoric" : "whole", m->viscosity.rest);
    for (int i = 0; i < m->viscosity.terms; i++)
        fprintf(out, "    - { g: %.9g, time: %.9g }\n", m->viscosity.share[i],
                m->viscosity.time[i]);
}

lar_status lar_inverse_write_tissue(const char *path, const lar_inverse_problem *p,
                                    const lar_inverse_result *r, const char *material,
                                    lar_error *error) {
    char text[256];
    double value[LAR_INVERSE_PARAMETERS_MAX];
    lar_material fitted = *lar_inverse_material(p, material);
    for (int j = 0; j < p->parameters; j++) value[j] = r->estimate[j].value;
    lar_inverse_set_all(p, value, &fitted, 1);
    lar_part_file out;
    lar_status status = lar_part_open(&out, path, error);
    if (status) return lar_part_close(&out, status);
    write_provenance(out.file, p, r, material);
    plain(material, text, sizeof text);
    fprintf(out.file, "lariat-tissue: 1\nname: \"%s\"\n", text);
    write_material(out.file, &fitted);
    return lar_part_close(&out, LAR_OK);
}

/* ---- pictures -------------------------------------------------------------------------------- */

enum { LEFT = 80, TOP = 40, WIDTH = 560, HEIGHT = 340 };

typedef struct axes {
    FILE *out;
    double x0, x1, y0, y1;
} axes;

static double x_of(const axes *a, double x) {
    return LEFT + WIDTH * (x - a->x0) / (a->x1 - a->x0);
}

static double y_of(const axes *a, double y) {
    return TOP + HEIGHT * (1 - (y - a->y0) / (a->y1 - a->y0));
}

/* 1, 2 or 5 times a power of ten: some five of them in a range. */
static double tick_of(double range) {
    double power = pow(10, floor(log10(range / 5))), part = range / 5 / power;
    return power * (part < 2 ? 1 : part < 5 ? 2 : 5);
}

static void draw_axes(const axes *a, const char *title, const char *x, const char *y) {
    fprintf(a->out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n"
            "<text x=\"%d\" y=\"22\">%s</text>\n"
            "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#888\"/>\n",
            LEFT + WIDTH + 30, TOP + HEIGHT + 50, LEFT, title, LEFT, TOP, WIDTH, HEIGHT);
    double tick = tick_of(a->x1 - a->x0);
    for (double v = tick * ceil(a->x0 / tick); v <= a->x1; v += tick)
        fprintf(a->out,
                "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\" fill=\"#555\">%.4g</text>\n",
                x_of(a, v), TOP + HEIGHT + 16, fabs(v) < 1e-9 * tick ? 0 : v);
    tick = tick_of(a->y1 - a->y0);
    for (double v = tick * ceil(a->y0 / tick); v <= a->y1; v += tick)
        fprintf(a->out, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\" fill=\"#555\">%.4g</text>\n",
                LEFT - 6, y_of(a, v) + 4, fabs(v) < 1e-9 * tick ? 0 : v);
    fprintf(a->out,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>\n"
            "<text x=\"16\" y=\"%d\" transform=\"rotate(-90 16 %d)\" "
            "text-anchor=\"middle\">%s</text>\n"
            "<text x=\"%d\" y=\"22\" text-anchor=\"end\" fill=\"#555\">dots: measured, line: "
            "model</text>\n",
            LEFT + WIDTH / 2, TOP + HEIGHT + 38, x, TOP + HEIGHT / 2, TOP + HEIGHT / 2, y,
            LEFT + WIDTH);
}

/* Over the way, the time where there is none or it stands still, or the number of the value. */
static double abscissa(const lar_inverse_experiment *e, int32_t i) {
    if (e->kind == LAR_INVERSE_MARKERS || e->kind == LAR_INVERSE_SURFACE) return i;
    if (e->kind == LAR_INVERSE_ASPIRATION) return e->along[i];
    return e->in_time ? e->time[i] : e->along[i];
}

/* What stands on the axes. */
static const char *x_title(const lar_inverse_experiment *e) {
    if (e->kind == LAR_INVERSE_MARKERS || e->kind == LAR_INVERSE_SURFACE) return "value";
    if (e->kind == LAR_INVERSE_ASPIRATION) return "distance from the axis [m]";
    if (e->in_time) return "time [s]";
    return e->kind == LAR_INVERSE_INDENTATION ? "depth [m]" : "displacement [m]";
}

static const char *y_title(const lar_inverse_experiment *e) {
    if (e->kind == LAR_INVERSE_MARKERS) return "displacement [m]";
    if (e->kind == LAR_INVERSE_SURFACE) return "distance [m]";
    return e->kind == LAR_INVERSE_ASPIRATION ? "height [m]" : "force [N]";
}

/* One line, of profiles one for each moment. */
static void draw_model(const axes *a, const lar_inverse_experiment *e, const double *model) {
    for (int32_t i = 0; i < e->values; i++) {
        if (i == 0 || (e->kind == LAR_INVERSE_ASPIRATION && lar_inverse_new_moment(e, i)))
            fprintf(a->out,
                    "%s<polyline fill=\"none\" stroke=\"#2b5fb5\" stroke-width=\"1.5\" "
                    "points=\"",
                    i > 0 ? "\"/>\n" : "");
        fprintf(a->out, "%.1f,%.1f ", x_of(a, abscissa(e, i)), y_of(a, model[i]));
    }
    fprintf(a->out, "\"/>\n");
}

static void widen(double *low, double *high) {
    double more = *high > *low ? 0.05 * (*high - *low) : fabs(*high) + 1e-12;
    *low -= more;
    *high += more;
}

lar_status lar_inverse_write_svg(const char *path, const lar_inverse_problem *p,
                                 const lar_inverse_result *r, int k, lar_error *error) {
    const lar_inverse_experiment *e = &p->experiment[k];
    const double *model = r->model;
    for (int i = 0; i < k; i++) model += p->experiment[i].values;
    char title[256];
    axes a = {.x0 = INFINITY, .x1 = -INFINITY, .y0 = INFINITY, .y1 = -INFINITY};
    for (int32_t i = 0; i < e->values; i++) {
        a.x0 = fmin(a.x0, abscissa(e, i));
        a.x1 = fmax(a.x1, abscissa(e, i));
        a.y0 = fmin(a.y0, fmin(model[i], e->measured[i]));
        a.y1 = fmax(a.y1, fmax(model[i], e->measured[i]));
    }
    widen(&a.x0, &a.x1);
    widen(&a.y0, &a.y1);
    lar_part_file out;
    lar_status status = lar_part_open(&out, path, error);
    if (status) return lar_part_close(&out, status);
    a.out = out.file;
    plain(e->name, title, sizeof title);
    draw_axes(&a, title, x_title(e), y_title(e));
    draw_model(&a, e, model);
    for (int32_t i = 0; i < e->values; i++)
        fprintf(a.out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"#b5342b\"/>\n",
                x_of(&a, abscissa(e, i)), y_of(&a, e->measured[i]));
    fprintf(a.out, "</svg>\n");
    return lar_part_close(&out, LAR_OK);
}

/* ---- all of it ------------------------------------------------------------------------------- */

enum { PATH_SIZE = 4096 };

/* Letters, digits, - and _ of a name; the others become _. */
static void file_name(const char *name, char *to, size_t size) {
    size_t n = 0;
    for (; *name && n + 1 < size; name++) {
        char c = *name;
        bool keep =
            (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
        to[n++] = keep ? c : '_';
    }
    to[n] = '\0';
}

static lar_status write_tissues(const char *folder, const lar_inverse_problem *p,
                                const lar_inverse_result *r, lar_error *error) {
    char path[PATH_SIZE], name[64];
    lar_status status = LAR_OK;
    for (int j = 0; j < p->parameters && !status; j++) {
        if (!lar_inverse_first_of_material(p, j)) continue;
        file_name(p->parameter[j].material, name, sizeof name);
        snprintf(path, sizeof path, "%.3900s/%s.tissue.yaml", folder, name);
        status = lar_inverse_write_tissue(path, p, r, p->parameter[j].material, error);
    }
    return status;
}

lar_status lar_inverse_write_json(const char *path, const lar_inverse_problem *p,
                                  const lar_inverse_result *r, lar_error *error) {
    lar_part_file out;
    lar_status status = lar_part_open(&out, path, error);
    if (!status) lar_inverse_json(p, r, out.file);
    return lar_part_close(&out, status);
}

lar_status lar_inverse_write_folder(const char *folder, const lar_inverse_problem *p,
                                    const lar_inverse_result *r, lar_error *error) {
    char path[PATH_SIZE], name[64];
    lar_status status = lar_folder_make(folder, error);
    if (!status) status = write_tissues(folder, p, r, error);
    for (int k = 0; k < p->experiments && !status; k++) {
        file_name(p->experiment[k].name, name, sizeof name);
        snprintf(path, sizeof path, "%.3900s/%d_%s.svg", folder, k + 1, name);
        status = lar_inverse_write_svg(path, p, r, k, error);
    }
    snprintf(path, sizeof path, "%.3900s/fit.json", folder);
    return status ? status : lar_inverse_write_json(path, p, r, error);
}
