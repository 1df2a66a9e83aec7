#include "meshing/grid/voxel_grid_lines.h"

#include <math.h>
#include <stdlib.h>

#include "base/vector.h"

enum { COUNTERS = LAR_REGIONS_MAX + 1 };

/* What making the lines needs. */
typedef struct work {
    lar_lines *lines;
    double (*place)[3]; /* vertices, in cells */
    int64_t (*grid)[2]; /* the same across the lines, in whole even numbers */
    int64_t pitch;      /* between lines, in these numbers: a power of two */
    lar_crossing *found;
    size_t count, capacity;
} work;

void lar_lines_clear(lar_lines *lines) {
    free(lines->start);
    free(lines->crossing);
    *lines = (lar_lines){0};
}

/* ---- triangles onto lines ------------------------------------------------------------------- */

static lar_status place_vertices(work *w, const lar_voxel_grid *voxel_grid, lar_error *error) {
    const lar_triangles *triangles = &w->lines->boundary->triangles;
    size_t vertices = (size_t)triangles->vertex_count;
    w->place = lar_calloc(vertices, sizeof *w->place);
    w->grid = lar_calloc(vertices, sizeof *w->grid);
    if (!w->place || !w->grid) return lar_fail_memory(error, 40 * vertices, "the lines' vertices");
    int32_t widest = 1;
    for (int b = 0; b < 2; b++) {
        w->lines->count[b] = LAR_LINES_PER_CELL * voxel_grid->cells[b + 1];
        if (w->lines->count[b] > widest) widest = w->lines->count[b];
    }
    /* Numbers below 2^30, so that products of two differences stay below 2^62. */
    for (w->pitch = 16; w->pitch * 2 * widest <= 1 << 30;) w->pitch *= 2;
    double origin[3];
    for (int a = 0; a < 3; a++) origin[a] = lar_dot(voxel_grid->axis[a], voxel_grid->origin);
    for (size_t v = 0; v < vertices; v++) {
        for (int a = 0; a < 3; a++)
            w->place[v][a] =
                (lar_dot(voxel_grid->axis[a], triangles->vertex[v]) - origin[a]) / voxel_grid->size;
        for (int b = 0; b < 2; b++) {
            double unit = (double)w->pitch * LAR_LINES_PER_CELL / 2;
            w->grid[v][b] = 2 * (int64_t)llround(w->place[v][b + 1] * unit);
        }
    }
    return LAR_OK;
}

/* Line J lies at this odd number. Lines of a row are shifted by 1/16 of a cell against those of the
 * next row, in both directions: so a flat side is met at 16 places in a cell and not at 4. */
static int64_t line_at(const work *w, int64_t line, int64_t other) {
    return line * w->pitch + w->pitch / 8 * (2 * (other % LAR_LINES_PER_CELL) + 1) + 1;
}

/* The first line that is not below a number, in a row with that shift. */
static int32_t line_from(const work *w, int64_t number, int64_t other) {
    int64_t line = number / w->pitch - 1;
    if (line < 0) line = 0;
    while (line_at(w, line, other) < number) line++;
    return (int32_t)line;
}

/* +1 when p lies left of the way from a to b, else -1; on it p counts as moved by (e, e^2). */
static int side_of(const int64_t a[2], const int64_t b[2], int64_t value) {
    if (value != 0) return value > 0 ? 1 : -1;
    if (b[1] != a[1]) return b[1] < a[1] ? 1 : -1;
    return b[0] > a[0] ? 1 : -1;
}

static int64_t turn(const int64_t a[2], const int64_t b[2], const int64_t p[2]) {
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
}

static bool add_crossing(work *w, int32_t triangle, const int64_t line[2], int32_t number,
                         int orientation, int64_t whole) {
    const int32_t *corner = w->lines->boundary->triangles.corner[triangle];
    double at = 0, min = INFINITY, max = -INFINITY;
    for (int c = 0; c < 3; c++) {
        const int64_t *a = w->grid[corner[(c + 1) % 3]], *b = w->grid[corner[(c + 2) % 3]];
        int64_t value = turn(a, b, line);
        if (side_of(a, b, value) != orientation) return true;
        double x = w->place[corner[c]][0];
        at += (double)value / (double)whole * x;
        min = fmin(min, x);
        max = fmax(max, x);
    }
    if (!LAR_GROW(w->found, w->capacity, w->count)) return false;
    w->found[w->count++] = (lar_crossing){.at = fmin(fmax(at, min), max),
                                          .line = number,
                                          .triangle = orientation > 0 ? triangle : ~triangle};
    return true;
}

static lar_status cross_lines(work *w, lar_error *error) {
    const lar_triangles *triangles = &w->lines->boundary->triangles;
    for (int32_t t = 0; t < triangles->triangle_count; t++) {
        const int64_t *x[3];
        for (int c = 0; c < 3; c++) x[c] = w->grid[triangles->corner[t][c]];
        int64_t whole = turn(x[0], x[1], x[2]);
        if (whole == 0) continue;
        int32_t low[2], high[2];
        for (int b = 0; b < 2; b++) {
            int64_t min = x[0][b], max = x[0][b];
            for (int c = 1; c < 3; c++) {
                if (x[c][b] < min) min = x[c][b];
                if (x[c][b] > max) max = x[c][b];
            }
            low[b] = line_from(w, min, LAR_LINES_PER_CELL - 1);
            high[b] = line_from(w, max, 0);
        }
        for (int32_t k = low[1]; k < high[1]; k++)
            for (int32_t j = low[0]; j < high[0]; j++) {
                int64_t line[2] = {line_at(w, j, k), line_at(w, k, j)};
                if (!add_crossing(w, t, line, k * w->lines->count[0] + j, whole > 0 ? 1 : -1,
                                  whole))
                    return lar_fail_memory(error, 2 * w->capacity * sizeof *w->found,
                                           "crossings of the surface");
            }
    }
    return LAR_OK;
}

static int compare_crossings(const void *a, const void *b) {
    const lar_crossing *p = a, *q = b;
    if (p->at != q->at) return p->at < q->at ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

static lar_status sort_crossings(work *w, lar_error *error) {
    lar_lines *lines = w->lines;
    size_t count = (size_t)lines->count[0] * (size_t)lines->count[1];
    lines->start = lar_calloc(count + 2, sizeof *lines->start);
    lines->crossing = lar_calloc(w->count, sizeof *lines->crossing);
    if (!lines->start || !lines->crossing)
        return lar_fail_memory(error, 8 * count + 16 * w->count, "crossings of the surface");
    for (size_t c = 0; c < w->count; c++) lines->start[w->found[c].line + 2]++;
    for (size_t l = 2; l <= count + 1; l++) lines->start[l] += lines->start[l - 1];
    for (size_t c = 0; c < w->count; c++)
        lines->crossing[lines->start[w->found[c].line + 1]++] = w->found[c];
    for (size_t l = 0; l < count; l++)
        qsort(&lines->crossing[lines->start[l]], lines->start[l + 1] - lines->start[l],
              sizeof *lines->crossing, compare_crossings);
    return LAR_OK;
}

lar_status lar_lines_create(const lar_boundary *boundary, const lar_voxel_grid *voxel_grid,
                            lar_lines *lines, lar_error *error) {
    *lines = (lar_lines){.boundary = boundary};
    work w = {.lines = lines};
    lar_status status = place_vertices(&w, voxel_grid, error);
    if (!status) status = cross_lines(&w, error);
    if (!status) status = sort_crossings(&w, error);
    free(w.place);
    free(w.grid);
    free(w.found);
    if (status) lar_lines_clear(lines);
    return status;
}

/* ---- along the lines ------------------------------------------------------------------------ */

/* The region that has a place: of all that are entered the last one. */
static int region_here(const int32_t entered[COUNTERS], int max) {
    for (int r = max; r > 0; r--)
        if (entered[r] > 0) return r;
    return 0;
}

static void step_over(const lar_lines *lines, const lar_crossing *c, int32_t entered[COUNTERS]) {
    bool against = c->triangle < 0;
    const uint16_t *side = lines->boundary->side[against ? ~c->triangle : c->triangle];
    entered[lar_boundary_region(side[against])]++;
    entered[lar_boundary_region(side[!against])]--;
}

bool lar_lines_follow(const lar_lines *lines, size_t line, lar_stretch *add, void *context) {
    const lar_crossing *first = &lines->crossing[lines->start[line]];
    const lar_crossing *end = &lines->crossing[lines->start[line + 1]];
    int32_t entered[COUNTERS] = {0};
    int max = 0;
    for (const lar_crossing *c = first; c < end; c++) {
        step_over(lines, c, entered);
        const uint16_t *side = lines->boundary->side[c->triangle < 0 ? ~c->triangle : c->triangle];
        for (int s = 0; s < 2; s++)
            if (lar_boundary_region(side[s]) > max) max = lar_boundary_region(side[s]);
    }
    for (int r = 0; r <= max; r++)
        if (entered[r] != 0) return false;
    for (const lar_crossing *c = first; c + 1 < end; c++) {
        step_over(lines, c, entered);
        int region = region_here(entered, max);
        if (region) add(context, region, c[0].at, c[1].at);
    }
    return true;
}
