#include "study/frames/edge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { UNKNOWN = 9, PIXELS = 1024 };
enum { Y0, SLOPE, BEND, BLUR, A0, A1, B, C0, C1 };
static const double WIDEST_STRIP = 4.5, NARROWEST = 1.5,
                    HIGHEST = 40; /* of strips, half [pixels] */

typedef struct strip {
    int count, columns;                         /* columns of the block of pixels that it lies in */
    int clipped;                                /* pixels that are black or white in full */
    double centre, half;                        /* of its heights */
    double wide;                                /* half of its width */
    double x[PIXELS], y[PIXELS], light[PIXELS]; /* x of half a width, y of half a height */
    double weight[PIXELS], left[PIXELS];
    int place[PIXELS]; /* in the block, row by row */
    double p[UNKNOWN]; /* lengths in pixels, but slope and bend per half a width */
    double matrix[UNKNOWN][UNKNOWN], side[UNKNOWN], squares;
} strip;

/* ---- pixels ---------------------------------------------------------------------------------- */

/* All pixels of a strip around (x, centre). Returns which part of it lies in the picture. */
static double take_pixels(const lar_view *v, const lar_grey *image, double x, strip *s) {
    double column, row;
    lar_view_to_picture(v, x, s->centre, &column, &row);
    const double reach = s->wide * fabs(sin(v->turn)) + s->half * fabs(cos(v->turn)),
                 beside = s->wide * fabs(cos(v->turn)) + s->half * fabs(sin(v->turn));
    const int first = (int)ceil(fmax(column - beside, 0)),
              last = (int)floor(fmin(column + beside, image->width - 1)),
              top = (int)ceil(fmax(row - reach, 0)),
              bottom = (int)floor(fmin(row + reach, image->height - 1));
    s->count = s->clipped = 0;
    s->columns = last - first + 1;
    for (int j = top; j <= bottom; j++)
        for (int i = first; i <= last; i++) {
            double dx = i - column, dy = j - row;
            double across = dx * cos(v->turn) + dy * sin(v->turn),
                   up = dx * sin(v->turn) - dy * cos(v->turn);
            if (fabs(across) > s->wide || fabs(up) > s->half || s->count == PIXELS) continue;
            s->x[s->count] = across / s->wide;
            s->y[s->count] = up / s->half;
            const float light = image->value[(size_t)j * (size_t)image->width + (size_t)i];
            s->light[s->count] = (double)light;
            s->clipped += light <= 0 || light >= 1;
            s->place[s->count++] = (j - top) * s->columns + i - first;
        }
    return s->count / (4 * s->wide * s->half);
}

/* ---- least squares --------------------------------------------------------------------------- */

/* The normal curve's integral up to t, with exp(-t^2 / 2) at hand: to 1.5e-7, a tenth of a grey
 * level of 16 bits (Abramowitz and Stegun, 7.1.26). */
static double step_at(double t, double peak) {
    const double k = 1 / (1 + 0.3275911 * 0.70710678118654752 * fabs(t));
    const double tail =
        0.5 * peak * k *
        (0.254829592 +
         k * (-0.284496736 + k * (1.421413741 + k * (-1.453152027 + k * 1.061405429))));
    return t > 0 ? 1 - tail : tail;
}

/* What is left at p, the normal equations, and the sum of squares. */
static double evaluate(strip *s, const double p[UNKNOWN]) {
    static const double FAR = 6; /* from here on the step is done */
    const double sharp = exp(-p[BLUR]);
    double squares = 0;
    memset(s->matrix, 0, sizeof s->matrix);
    memset(s->side, 0, sizeof s->side);
    for (int i = 0; i < s->count; i++) {
        const double x = s->x[i], y = s->y[i];
        const double t = sharp * (y * s->half - p[Y0] - x * (p[SLOPE] + x * p[BEND]));
        const double curve = fabs(t) < FAR ? exp(-0.5 * t * t) : 0;
        const double step = step_at(t, curve), contrast = p[C0] + p[C1] * y;
        const double left = p[A0] + p[A1] * y + p[B] * x + contrast * step - s->light[i];
        s->left[i] = left;
        squares += s->weight[i] * left * left;
        if (s->weight[i] == 0) continue;
        const double peak = contrast * 0.39894228040143268 * curve;
        const double g = -peak * sharp;
        const double d[UNKNOWN] = {g, g * x, g * x * x, -peak * t, 1, y, x, step, step * y};
        for (int a = 0; a < UNKNOWN; a++) {
            const double w = s->weight[i] * d[a];
            s->side[a] += w * left;
            for (int b = 0; b <= a; b++) s->matrix[a][b] += w * d[b];
        }
    }
    return squares;
}

/* Cholesky of the matrix with a longer diagonal. False where it has no inverse. */
static bool factor(const strip *s, double damping, double l[UNKNOWN][UNKNOWN]) {
    for (int i = 0; i < UNKNOWN; i++)
        for (int j = 0; j <= i; j++) {
            double sum = s->matrix[i][j] * (i == j ? 1 + damping : 1);
            for (int k = 0; k < j; k++) sum -= l[i][k] * l[j][k];
            if (i > j) {
                l[i][j] = sum / l[j][j];
                continue;
            }
            if (!(sum > 1e-14 * s->matrix[i][i]) || !(sum > 0)) return false;
            l[i][i] = sqrt(sum);
        }
    return true;
}

static void solve(double l[UNKNOWN][UNKNOWN], const double *side, double *x) {
    for (int i = 0; i < UNKNOWN; i++) {
        x[i] = side[i];
        for (int k = 0; k < i; k++) x[i] -= l[i][k] * x[k];
        x[i] /= l[i][i];
    }
    for (int i = UNKNOWN - 1; i >= 0; i--) {
        for (int k = i + 1; k < UNKNOWN; k++) x[i] -= l[k][i] * x[k];
        x[i] /= l[i][i];
    }
}

/* One step to fewer squares, shorter and shorter until there are. Returns how far the edge and its
 * blur have moved; less than 0: nothing is better, and all is as it was. */
static double step_down(strip *s, double *damping) {
    enum { TRIES = 6 };
    double l[UNKNOWN][UNKNOWN], change[UNKNOWN], next[UNKNOWN];
    for (int tries = 0; tries < TRIES; tries++, *damping *= 10) {
        if (!factor(s, *damping, l)) continue;
        solve(l, s->side, change);
        for (int i = 0; i < UNKNOWN; i++) next[i] = s->p[i] - change[i];
        next[BLUR] = fmin(fmax(next[BLUR], log(0.3)), log(s->half));
        if (!(fabs(next[Y0]) < s->half)) continue;
        double squares = evaluate(s, next);
        if (squares <= s->squares) {
            double moved = fabs(next[Y0] - s->p[Y0]) + fabs(next[BLUR] - s->p[BLUR]);
            memcpy(s->p, next, sizeof next);
            s->squares = squares;
            return moved;
        }
        evaluate(s, s->p);
    }
    return -1;
}

/* With the weights as they are. False where nothing can be told. */
static bool minimise(strip *s, int rounds) {
    static const double SETTLED = 1e-3;
    double damping = 1e-3, moved = 1;
    s->squares = evaluate(s, s->p);
    for (int n = 0; n < rounds && moved > SETTLED; n++, damping *= 1e-2)
        moved = step_down(s, &damping);
    return isfinite(s->squares);
}

/* ---- noise ----------------------------------------------------------------------------------- */

/* The middle one of a list that is put out of order (Hoare's selection). */
static double median(double *value, int count) {
    int low = 0, high = count - 1, wanted = count / 2;
    while (low < high) {
        const double pivot = value[(low + high) / 2];
        int i = low, j = high;
        while (i <= j) {
            while (value[i] < pivot) i++;
            while (value[j] > pivot) j--;
            if (i > j) break;
            const double other = value[i];
            value[i++] = value[j];
            value[j--] = other;
        }
        if (wanted <= j)
            high = j;
        else if (wanted >= i)
            low = i;
        else
            break;
    }
    return value[wanted];
}

/* Standard deviation of what is left, by the median of its sizes. */
static double spread(const strip *s) {
    static const double MEDIAN = 0.6745; /* of a normal number's size */
    double size[PIXELS];
    for (int i = 0; i < s->count; i++) size[i] = fabs(s->left[i]);
    return median(size, s->count) / MEDIAN * sqrt(s->count / (double)(s->count - UNKNOWN));
}

/* Returns the part of pixels that have none. */
static double weigh(strip *s, double noise) {
    static const double TUKEY = 4.685; /* keeps 95 % of what normal noise tells */
    int out = 0;
    for (int i = 0; i < s->count; i++) {
        double part = s->left[i] / (TUKEY * noise), rest = 1 - part * part;
        s->weight[i] = rest > 0 ? rest * rest : 0;
        out += rest <= 0;
    }
    return out / (double)s->count;
}

/* How many times the variance is larger because neighbours, `stride` pixels on, have like noise: as
 * of a first order process. What is not of the model counts as noise here, too. */
static double alike(const strip *s, const int *at, int block, int stride) {
    double with = 0, all = 0;
    for (int i = 0; i < s->count; i++) {
        const int other = s->place[i] + stride;
        const bool edge = stride == 1 && other % s->columns == 0;
        if (edge || other >= block || at[other] < 0) continue;
        const double w = s->weight[i] * s->weight[at[other]];
        with += w * s->left[i] * s->left[at[other]];
        all += w * 0.5 * (s->left[i] * s->left[i] + s->left[at[other]] * s->left[at[other]]);
    }
    double r = all > 0 ? fmin(fmax(with / all, 0), 0.8) : 0;
    return (1 + r) / (1 - r);
}

static double correlation_factor(const strip *s) {
    enum { BLOCK = 8 * PIXELS };
    int at[BLOCK], block = 0;
    for (int i = 0; i < s->count; i++) block = s->place[i] + 1 > block ? s->place[i] + 1 : block;
    if (block > BLOCK) return 1;
    for (int i = 0; i < block; i++) at[i] = -1;
    for (int i = 0; i < s->count; i++) at[s->place[i]] = i;
    return alike(s, at, block, 1) * alike(s, at, block, s->columns);
}

/* ---- the edge -------------------------------------------------------------------------------- */

/* A first guess: the light that most of the pixels far below and far above have. What is far off
 * even from that, a speck or a glint, has no say in the first round. */
static void guess(strip *s, double slope, double blur) {
    static const double FAR = 0.4, LEAST = 0.1; /* of half a height, of the contrast */
    double light[2][PIXELS], middle[2] = {0};
    int count[2] = {0};
    for (int i = 0; i < s->count; i++)
        if (fabs(s->y[i]) >= FAR) {
            bool above = s->y[i] > 0;
            light[above][count[above]++] = s->light[i];
        }
    for (int k = 0; k < 2; k++)
        if (count[k] > 0) middle[k] = median(light[k], count[k]);
    const double contrast = middle[1] - middle[0];
    const double p[UNKNOWN] = {0, slope * s->wide, 0, log(blur), middle[0], 0, 0, contrast, 0};
    memcpy(s->p, p, sizeof p);
    for (int i = 0; i < s->count; i++) s->weight[i] = 1;
    evaluate(s, s->p);
    weigh(s, fmax(spread(s), LEAST * fabs(contrast)) + 1e-9);
}

/* Rounds of weights and squares. Returns the noise; *out is the part of pixels without weight. */
static double fit(strip *s, double least, double *out) {
    double noise = 0;
    *out = 0;
    for (int round = 0; round < 4; round++) {
        if (!minimise(s, round == 0 ? 12 : 5)) return INFINITY;
        noise = fmax(spread(s), least);
        if (round < 3) *out = weigh(s, noise);
    }
    return noise;
}

/* Variance of a sum of unknowns, of 1 for the noise. */
static double variance_of(double l[UNKNOWN][UNKNOWN], const double part[UNKNOWN]) {
    double column[UNKNOWN], sum = 0;
    solve(l, part, column);
    for (int i = 0; i < UNKNOWN; i++) sum += part[i] * column[i];
    return sum;
}

static void judge(strip *s, double noise, double out, int tissue, lar_edge *edge) {
    static const double SURE = 6, WIDEST = 2, SPECKS = 0.3, FLOOR = 0.02, BENT = 0.25, MANY = 0.1;
    double l[UNKNOWN][UNKNOWN];
    if (!isfinite(noise) || !factor(s, 0, l)) return;
    const double more = correlation_factor(s), slope = s->p[SLOPE] / s->wide;
    const double tilt = 1 + slope * slope, blur = exp(s->p[BLUR]);
    /* Blur moves a bent edge inwards: by half its curvature times sigma^2, along the normal. */
    const double all = pow(blur / (s->wide * tilt), 2), part = fmin(all, BENT);
    const double height[UNKNOWN] = {[Y0] = 1, [BEND] = -part}, contrast[UNKNOWN] = {[C0] = 1};
    const double variance = noise * noise * more * variance_of(l, height);
    const double sure = noise * sqrt(more * variance_of(l, contrast));
    const double rest = (all - part) * s->p[BEND];
    edge->contrast = s->p[C0] + s->p[C1] * s->p[Y0] / s->half;
    edge->blur = blur;
    edge->clear = sure > 0 ? -tissue * edge->contrast / sure : 0;
    edge->y = s->centre + s->p[Y0] - part * s->p[BEND];
    edge->error = sqrt(variance + FLOOR * FLOOR * tilt + rest * rest);
    /* What was lighter than white had its edge elsewhere: by how much of the blur nobody knows. */
    edge->clipped = s->clipped > MANY * s->count;
    if (edge->clipped) edge->error = hypot(edge->error, blur);
    edge->found = edge->clear > SURE && (edge->error < WIDEST || edge->clipped) &&
                  fabs(s->p[Y0]) < 0.8 * s->half && blur < 0.5 * s->half && out < SPECKS;
}

/* How high a strip shall be that was looked at: what is more blurred than thought, or hardly stands
 * out of the noise, needs a higher one. */
static double wanted_height(const strip *s, const lar_edge *edge) {
    static const double BLURS = 4, MARGIN = 4, CLEAR = 12, MORE = 1.8;
    double wanted = BLURS * edge->blur + fabs(s->p[SLOPE]) + fabs(s->p[BEND]) + MARGIN;
    if (edge->clear < CLEAR) wanted = fmax(wanted, MORE * s->half);
    return fmin(wanted, HIGHEST);
}

/* No pixel has a say in two points, whose errors would be alike then. */
static double strip_width(const lar_view *v) {
    const double apart = v->radius / v->scale / (v->points - 1);
    return fmin(fmax(0.5 * apart, NARROWEST), WIDEST_STRIP);
}

void lar_edge_find(const lar_view *view, const lar_grey *image, const lar_outline *outline,
                   int tissue, double x, lar_edge *edge) {
    static const double NEAR = 10, WHOLE = 0.7, ROUNDED = 0.29;
    double y, slope, blur = 1.5, out;
    strip s;
    *edge = (lar_edge){0};
    if (!(outline->change > 0)) return;
    lar_outline_at(outline, x, &y, &slope);
    s.wide = strip_width(view);
    s.centre = y;
    s.half = fmin(NEAR + s.wide * fabs(slope) + 3 * (outline->step - 1), HIGHEST);
    for (int round = 0; round < 2; round++) {
        lar_edge look = {0};
        if (take_pixels(view, image, x, &s) < WHOLE) return;
        guess(&s, slope, blur);
        const double noise = fit(&s, ROUNDED * image->step, &out);
        judge(&s, noise, out, tissue, &look);
        if (round == 0 || look.found) *edge = look;
        const double wanted = wanted_height(&s, &look);
        if (wanted <= s.half || !isfinite(noise)) return;
        s.half = wanted;
        blur = look.blur;
        if (look.found) s.centre = look.y;
    }
}
