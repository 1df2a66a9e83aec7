#include "study/frames/outline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Pixels above and below, columns beside, most rows of one column to the next; a picture is thinned
 * out until it has no more than so many of either. */
enum { DEEP = 4, BESIDE = 2, CLIMB = 4, COLUMNS_MOST = 400, ROWS_MOST = 500 };
static const double PRICE = 0.08; /* of a row up or down, of the best change */

typedef struct raster {
    int columns, rows;
    double x, y, step; /* of column 0, row 0 */
    float *light;      /* [columns][rows], upwards; NAN: out of the picture */
    float *change;     /* [columns][rows] */
} raster;

/* ---- the raster ------------------------------------------------------------------------------ */

static void lay(const lar_view *v, const lar_grey *image, raster *r) {
    static const double MARGIN = 6;
    const double reach = ceil(v->radius / v->scale) + MARGIN;
    const double left = v->sides == LAR_VIEW_RIGHT ? -MARGIN : -reach,
                 right = v->sides == LAR_VIEW_LEFT ? MARGIN : reach;
    double low = INFINITY, high = -INFINITY; /* of the picture's corners */
    for (int c = 0; c < 4; c++) {
        double column = (c & 1 ? image->width - 1 : 0) - v->axis,
               row = (c & 2 ? image->height - 1 : 0) - v->rim;
        double y = column * sin(v->turn) - row * cos(v->turn);
        low = fmin(low, y);
        high = fmax(high, y);
    }
    low = fmax(low, v->low / v->scale);
    high = fmin(high, v->high / v->scale);
    double columns = right - left + 1, rows = fmax(high - low + 1, 0);
    r->step = ceil(fmax(fmax(columns / COLUMNS_MOST, rows / ROWS_MOST), 1));
    r->columns = (int)(columns / r->step);
    r->rows = (int)(rows / r->step);
    r->x = left;
    r->y = low;
}

static void take_light(const lar_view *v, const lar_grey *image, raster *r) {
    double from[2], right[2], up[2]; /* column and row of the picture; one step across, and up */
    lar_view_to_picture(v, r->x, r->y, &from[0], &from[1]);
    lar_view_to_picture(v, r->x + r->step, r->y, &right[0], &right[1]);
    lar_view_to_picture(v, r->x, r->y + r->step, &up[0], &up[1]);
    for (int c = 0; c < r->columns; c++)
        for (int k = 0; k < r->rows; k++) {
            const double column = from[0] + c * (right[0] - from[0]) + k * (up[0] - from[0]),
                         row = from[1] + c * (right[1] - from[1]) + k * (up[1] - from[1]);
            const bool in = column >= -0.5 && column < image->width - 0.5 && row >= -0.5 &&
                            row < image->height - 0.5;
            r->light[(size_t)c * (size_t)r->rows + (size_t)k] =
                in ? image->value[(size_t)(row + 0.5) * (size_t)image->width +
                                  (size_t)(column + 0.5)]
                   : NAN;
        }
}

/* Tissue less background, of one column. Where a pixel is missing there is no change. */
static void take_change(const float *light, int rows, int tissue, float *change) {
    for (int k = 0; k < rows; k++) {
        float sum = 0;
        bool in = k >= DEEP && k + DEEP <= rows;
        for (int i = 1; i <= DEEP && in; i++) sum += light[k - i] - light[k + i - 1];
        change[k] = in && isfinite(sum) ? sum * (float)tissue / DEEP : 0;
    }
}

/* Means over some columns, into `light`, which is not needed any more. */
static void smooth(raster *r) {
    const size_t rows = (size_t)r->rows;
    for (int c = 0; c < r->columns; c++) {
        float *to = &r->light[(size_t)c * rows];
        memset(to, 0, rows * sizeof *to);
        for (int b = c - BESIDE; b <= c + BESIDE; b++) {
            const float *from = &r->change[(size_t)(b < 0             ? 0
                                                    : b >= r->columns ? r->columns - 1
                                                                      : b) *
                                           rows];
            for (size_t k = 0; k < rows; k++) to[k] += from[k] / (2 * BESIDE + 1);
        }
    }
}

/* ---- the way --------------------------------------------------------------------------------- */

static int ascending(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* What half of the columns have at most. */
static float half_of_best(const raster *r, float *best) {
    for (int c = 0; c < r->columns; c++) {
        best[c] = 0;
        for (int k = 0; k < r->rows; k++)
            best[c] = fmaxf(best[c], r->light[(size_t)c * (size_t)r->rows + (size_t)k]);
    }
    qsort(best, (size_t)r->columns, sizeof *best, ascending);
    return best[r->columns / 2];
}

/* What a way to here is worth at most; from[] says from which row it comes. */
static void advance(const float *change, const float *before, int rows, float *worth,
                    signed char *from) {
    for (int k = 0; k < rows; k++) {
        float best = -INFINITY;
        for (int d = -CLIMB; d <= CLIMB; d++) {
            if (k + d < 0 || k + d >= rows) continue;
            float way = before[k + d] - (float)PRICE * (float)abs(d);
            if (way > best) {
                best = way;
                from[k] = (signed char)d;
            }
        }
        worth[k] = best + change[k];
    }
}

static void walk(raster *r, float most, float *worth, signed char *from, lar_outline *o) {
    const size_t rows = (size_t)r->rows;
    for (size_t i = 0; i < (size_t)r->columns * rows; i++)
        r->light[i] = fminf(fmaxf(r->light[i], 0), most) / most;
    memcpy(worth, r->light, rows * sizeof *worth);
    for (int c = 1; c < r->columns; c++, worth += rows)
        advance(&r->light[(size_t)c * rows], worth, r->rows, worth + rows, &from[(size_t)c * rows]);
    int k = 0;
    for (int i = 1; i < r->rows; i++)
        if (worth[i] > worth[k]) k = i;
    double sum = 0;
    for (int c = r->columns - 1; c >= 0; c--) {
        o->y[c] = r->y + (k - 0.5) * r->step;
        sum += r->light[(size_t)c * rows + (size_t)k] * most;
        if (c > 0) k += from[(size_t)c * rows + (size_t)k];
    }
    o->change = sum / r->columns;
}

lar_status lar_outline_find(const lar_view *v, const lar_grey *image, int tissue, lar_outline *o,
                            lar_error *error) {
    raster r = {0};
    lay(v, image, &r);
    const size_t cells = (size_t)r.columns * (size_t)r.rows;
    o->columns = r.columns;
    o->x = r.x;
    o->step = r.step;
    o->y = lar_calloc((size_t)r.columns, sizeof *o->y);
    r.light = lar_calloc(cells, sizeof *r.light);
    r.change = lar_calloc(cells + (size_t)r.columns, sizeof *r.change);
    signed char *from = lar_calloc(cells, 1);
    lar_status status =
        o->y && r.light && r.change && from ? LAR_OK : lar_fail_memory(error, cells, "a frame");
    if (!status && r.rows > 2 * DEEP) {
        take_light(v, image, &r);
        for (int c = 0; c < r.columns; c++)
            take_change(&r.light[(size_t)c * (size_t)r.rows], r.rows, tissue,
                        &r.change[(size_t)c * (size_t)r.rows]);
        smooth(&r);
        float most = half_of_best(&r, &r.change[cells]);
        if (most > 0) walk(&r, most, r.change, from, o);
    }
    free(r.light);
    free(r.change);
    free(from);
    return status;
}

void lar_outline_clear(lar_outline *o) {
    free(o->y);
    *o = (lar_outline){0};
}

void lar_outline_at(const lar_outline *o, double x, double *y, double *slope) {
    enum { AROUND = 3 };
    int k = (int)floor((x - o->x) / o->step + 0.5);
    k = k < AROUND ? AROUND : k > o->columns - 1 - AROUND ? o->columns - 1 - AROUND : k;
    double sum = 0;
    for (int i = -AROUND; i <= AROUND; i++) sum += i * o->y[k + i];
    *slope = sum / (28 * o->step);
    *y = o->y[k] + *slope * (x - o->x - k * o->step);
}
