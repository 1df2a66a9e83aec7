/* Which region has how much of every cell: lines along the cells' first axis, 4 x 4 through each
 * row of cells, and where they cross the boundary.
 *
 *      ______ ______ ______        A line goes in at a triangle that looks against it and out at
 *     |    __|______|__    |       one that looks along it: counting both per region says where it
 *     |---/--|------|--\---|       is, in any order, even where two triangles are crossed at one
 *     |__|___|______|___|__|       place. Lengths along the line are exact.
 *
 * Triangles are scan-converted onto the lines. Across the lines all is in whole numbers: vertices
 * on even ones, lines on odd ones, sides of edges are exact, and a line through an edge counts as
 * beside it (Edelsbrunner and Muecke 1990, Simulation of Simplicity). So a line crosses a closed
 * surface as often inwards as outwards without exception. A line that does not, because the surface
 * is not closed, takes no part: the others of its row stand for it.
 */
#include "meshing/lattice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LINES = 4, COUNTERS = LAR_REGIONS_MOST + 1 };

typedef struct crossing {
    double at; /* in cells */
    int32_t line;
    int32_t triangle; /* ~triangle when it looks against the line */
} crossing;

typedef struct work {
    const lar_boundary *boundary;
    lar_lattice *lattice;
    double (*place)[3]; /* vertices, in cells */
    int64_t (*grid)[2]; /* the same across the lines, in whole even numbers */
    int64_t pitch;      /* between lines, in these numbers: a power of two */
    int32_t lines[2];   /* across the lattice */
    crossing *crossing;
    size_t count, capacity;
    size_t *start; /* [lines + 1] into `sorted` */
    crossing *sorted;
    double *length; /* [COUNTERS][cells along] parts of the cells of one row */
    bool met[COUNTERS];
    uint8_t *row_lines; /* [rows] lines that count */
} work;

static void free_work(work *w) {
    free(w->place);
    free(w->grid);
    free(w->crossing);
    free(w->start);
    free(w->sorted);
    free(w->length);
    free(w->row_lines);
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- where the lattice lies ----------------------------------------------------------------- */

/* Planes of flat cuts across an axis. */
typedef struct ends {
    bool cut[2]; /* low, high */
    double area[2];
} ends;

static double cut_area(const lar_boundary *boundary, int cut) {
    double area = 0;
    for (int32_t t = 0; t < boundary->triangles.triangle_count; t++) {
        if (boundary->side[t][0] != LAR_REGION_CUT + cut) continue;
        const int32_t *c = boundary->triangles.corner[t];
        double(*x)[3] = boundary->triangles.vertex, u[3], v[3], n[3];
        for (int a = 0; a < 3; a++) u[a] = x[c[1]][a] - x[c[0]][a], v[a] = x[c[2]][a] - x[c[0]][a];
        for (int a = 0; a < 3; a++)
            n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
        area += sqrt(dot(n, n)) / 2;
    }
    return area;
}

static void find_ends(const lar_boundary *boundary, ends end[3]) {
    memset(end, 0, 3 * sizeof *end);
    for (int s = 0; s < LAR_CUTS; s++) {
        const lar_cut *cut = &boundary->cut[s];
        if (boundary->cut_count == 0 || !cut->name[0]) continue;
        for (int a = 0; a < 3; a++) {
            double along = dot(cut->normal, boundary->axis[a]);
            if (fabs(along) < 1 - 1e-9) continue;
            end[a].cut[along > 0] = true;
            end[a].area[along > 0] = cut_area(boundary, s);
        }
    }
}

static void find_extent(const lar_boundary *boundary, double low[3], double high[3]) {
    for (int a = 0; a < 3; a++) low[a] = INFINITY, high[a] = -INFINITY;
    for (int32_t v = 0; v < boundary->triangles.vertex_count; v++)
        for (int a = 0; a < 3; a++) {
            double x = dot(boundary->axis[a], boundary->triangles.vertex[v]);
            low[a] = fmin(low[a], x);
            high[a] = fmax(high[a], x);
        }
}

/* Cut at both ends: a size that divides the body between them, when one is near. */
static double fitting_size(double size, const ends end[3], const double low[3],
                           const double high[3]) {
    const double most = 0.01;
    double best = size, change = most;
    for (int a = 0; a < 3; a++) {
        if (!end[a].cut[0] || !end[a].cut[1]) continue;
        double divided = (high[a] - low[a]) / fmax(1, round((high[a] - low[a]) / size));
        if (fabs(divided / size - 1) < change) {
            change = fabs(divided / size - 1);
            best = divided;
        }
    }
    return best;
}

static lar_status place_lattice(const lar_boundary *boundary, double size, lar_lattice *lattice,
                                lar_error *error) {
    ends end[3];
    double low[3], high[3], all = 1;
    find_ends(boundary, end);
    find_extent(boundary, low, high);
    lattice->size = fitting_size(size, end, low, high);
    memcpy(lattice->axis, boundary->axis, sizeof lattice->axis);
    double corner[3];
    for (int a = 0; a < 3; a++) {
        double extent = (high[a] - low[a]) / lattice->size;
        if (!isfinite(extent))
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: the body has no finite extent; look at its coordinates",
                            boundary->triangles.source ? boundary->triangles.source : "surface");
        double cells = fmax(1, ceil(extent - 1e-6));
        bool at_low = end[a].cut[0] && (!end[a].cut[1] || end[a].area[0] >= end[a].area[1]);
        if (at_low)
            corner[a] = low[a];
        else if (end[a].cut[1])
            corner[a] = high[a] - cells * lattice->size;
        else
            corner[a] = (low[a] + high[a] - cells * lattice->size) / 2;
        corner[a] -= lattice->size;
        all *= cells + 2;
        if (!(all <= LAR_LATTICE_CELLS_MOST))
            return lar_fail(
                error, LAR_ERROR_ARGUMENT,
                "cells of %.4g mm would be more than %d for a body of %.4g x %.4g x %.4g "
                "mm; choose a larger size, or look at the surface's unit (--scale)",
                1e3 * size, (int)LAR_LATTICE_CELLS_MOST, 1e3 * (high[0] - low[0]),
                1e3 * (high[1] - low[1]), 1e3 * (high[2] - low[2]));
        lattice->cells[a] = (int32_t)cells + 2;
    }
    for (int b = 0; b < 3; b++)
        lattice->origin[b] = corner[0] * lattice->axis[0][b] + corner[1] * lattice->axis[1][b] +
                             corner[2] * lattice->axis[2][b];
    return LAR_OK;
}

/* ---- triangles onto lines ------------------------------------------------------------------- */

static lar_status place_vertices(work *w, lar_error *error) {
    const lar_triangles *triangles = &w->boundary->triangles;
    const lar_lattice *lattice = w->lattice;
    size_t vertices = (size_t)triangles->vertex_count;
    w->place = lar_calloc(vertices, sizeof *w->place);
    w->grid = lar_calloc(vertices, sizeof *w->grid);
    if (!w->place || !w->grid) return lar_fail_memory(error, 40 * vertices, "the lines' vertices");
    int32_t widest = 1;
    for (int b = 0; b < 2; b++) {
        w->lines[b] = LINES * lattice->cells[b + 1];
        if (w->lines[b] > widest) widest = w->lines[b];
    }
    /* Numbers below 2^30, so that products of two differences stay below 2^62. */
    for (w->pitch = 2; w->pitch * 2 * widest <= 1 << 30;) w->pitch *= 2;
    double origin[3];
    for (int a = 0; a < 3; a++) origin[a] = dot(lattice->axis[a], lattice->origin);
    for (size_t v = 0; v < vertices; v++) {
        for (int a = 0; a < 3; a++)
            w->place[v][a] =
                (dot(lattice->axis[a], triangles->vertex[v]) - origin[a]) / lattice->size;
        for (int b = 0; b < 2; b++) {
            double unit = (double)w->pitch * LINES / 2;
            w->grid[v][b] = 2 * (int64_t)llround(w->place[v][b + 1] * unit);
        }
    }
    return LAR_OK;
}

/* Line J lies at this odd number, half a pitch from the cells' sides and a whiff beside. */
static int64_t line_at(const work *w, int64_t line) {
    return line * w->pitch + w->pitch / 2 + 1;
}

/* The first line not below a number. */
static int32_t line_from(const work *w, int64_t number) {
    int64_t line = number / w->pitch - 1;
    if (line < 0) line = 0;
    while (line_at(w, line) < number) line++;
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
    const int32_t *corner = w->boundary->triangles.corner[triangle];
    double at = 0, least = INFINITY, most = -INFINITY;
    for (int c = 0; c < 3; c++) {
        const int64_t *a = w->grid[corner[(c + 1) % 3]], *b = w->grid[corner[(c + 2) % 3]];
        int64_t value = turn(a, b, line);
        if (side_of(a, b, value) != orientation) return true;
        double x = w->place[corner[c]][0];
        at += (double)value / (double)whole * x;
        least = fmin(least, x);
        most = fmax(most, x);
    }
    if (!LAR_GROW(w->crossing, w->capacity, w->count)) return false;
    w->crossing[w->count++] = (crossing){.at = fmin(fmax(at, least), most),
                                         .line = number,
                                         .triangle = orientation > 0 ? triangle : ~triangle};
    return true;
}

static lar_status cross_lines(work *w, lar_error *error) {
    const lar_triangles *triangles = &w->boundary->triangles;
    for (int32_t t = 0; t < triangles->triangle_count; t++) {
        const int64_t *x[3];
        for (int c = 0; c < 3; c++) x[c] = w->grid[triangles->corner[t][c]];
        int64_t whole = turn(x[0], x[1], x[2]);
        if (whole == 0) continue;
        int32_t low[2], high[2];
        for (int b = 0; b < 2; b++) {
            int64_t least = x[0][b], most = x[0][b];
            for (int c = 1; c < 3; c++) {
                if (x[c][b] < least) least = x[c][b];
                if (x[c][b] > most) most = x[c][b];
            }
            low[b] = line_from(w, least);
            high[b] = line_from(w, most);
        }
        for (int32_t k = low[1]; k < high[1]; k++)
            for (int32_t j = low[0]; j < high[0]; j++) {
                int64_t line[2] = {line_at(w, j), line_at(w, k)};
                if (!add_crossing(w, t, line, k * w->lines[0] + j, whole > 0 ? 1 : -1, whole))
                    return lar_fail_memory(error, 2 * w->capacity * sizeof *w->crossing,
                                           "crossings of the surface");
            }
    }
    return LAR_OK;
}

static int compare_crossings(const void *a, const void *b) {
    const crossing *p = a, *q = b;
    if (p->at != q->at) return p->at < q->at ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

static lar_status sort_crossings(work *w, lar_error *error) {
    size_t lines = (size_t)w->lines[0] * (size_t)w->lines[1];
    w->start = lar_calloc(lines + 2, sizeof *w->start);
    w->sorted = lar_calloc(w->count, sizeof *w->sorted);
    if (!w->start || !w->sorted)
        return lar_fail_memory(error, 8 * lines + 16 * w->count, "crossings of the surface");
    for (size_t c = 0; c < w->count; c++) w->start[w->crossing[c].line + 2]++;
    for (size_t l = 2; l <= lines + 1; l++) w->start[l] += w->start[l - 1];
    for (size_t c = 0; c < w->count; c++)
        w->sorted[w->start[w->crossing[c].line + 1]++] = w->crossing[c];
    for (size_t l = 0; l < lines; l++)
        qsort(&w->sorted[w->start[l]], w->start[l + 1] - w->start[l], sizeof *w->sorted,
              compare_crossings);
    return LAR_OK;
}

/* ---- along the lines ------------------------------------------------------------------------ */

static int region_number(uint16_t side) {
    return side >= LAR_REGION_CUT ? 0 : side;
}

/* The region that has a place: of all that are entered the last one. */
static int region_here(const int32_t entered[COUNTERS], int most) {
    for (int r = most; r > 0; r--)
        if (entered[r] > 0) return r;
    return 0;
}

static void step_over(const work *w, const crossing *c, int32_t entered[COUNTERS]) {
    bool against = c->triangle < 0;
    const uint16_t *side = w->boundary->side[against ? ~c->triangle : c->triangle];
    entered[region_number(side[against])]++;
    entered[region_number(side[!against])]--;
}

static void add_length(work *w, int region, double from, double to) {
    int32_t cells = w->lattice->cells[0];
    double *length = &w->length[(size_t)region * (size_t)cells];
    w->met[region] = true;
    int32_t first = (int32_t)fmax(0, floor(from));
    for (int32_t i = first; i < cells && i < to; i++) length[i] += fmin(to, i + 1) - fmax(from, i);
}

/* False when the line does not come out again. */
static bool follow_line(work *w, size_t line) {
    int32_t entered[COUNTERS] = {0};
    int most = 0;
    for (size_t c = w->start[line]; c < w->start[line + 1]; c++) {
        const uint16_t *side =
            w->boundary
                ->side[w->sorted[c].triangle < 0 ? ~w->sorted[c].triangle : w->sorted[c].triangle];
        for (int s = 0; s < 2; s++)
            if (region_number(side[s]) > most) most = region_number(side[s]);
        step_over(w, &w->sorted[c], entered);
    }
    for (int r = 0; r <= most; r++)
        if (entered[r] != 0) return false;
    for (size_t c = w->start[line]; c + 1 < w->start[line + 1]; c++) {
        step_over(w, &w->sorted[c], entered);
        int region = region_here(entered, most);
        if (region) add_length(w, region, w->sorted[c].at, w->sorted[c + 1].at);
    }
    return true;
}

static void write_row(work *w, int32_t j, int32_t k, int lines) {
    lar_lattice *lattice = w->lattice;
    int32_t cells = lattice->cells[0];
    size_t row = lar_lattice_cell(lattice, 0, j, k);
    for (int32_t i = 0; i < cells && lines > 0; i++) {
        double inside = 0, largest = 0;
        int inner = 0;
        for (int r = 1; r <= w->boundary->region_count; r++) {
            if (!w->met[r]) continue;
            double part = w->length[(size_t)r * (size_t)cells + (size_t)i];
            inside += part;
            if (part > largest) largest = part, inner = r;
        }
        inside = fmin(1, inside / lines);
        lattice->inner[row + (size_t)i] = (uint8_t)inner;
        /* A body's flat side may lie in the middle of cells: rounding must not decide. */
        lattice->region[row + (size_t)i] = inside >= 0.5 - 1e-6 ? (uint8_t)inner : 0;
        lattice->share[row + (size_t)i] = (uint8_t)lround(255 * inside);
    }
    for (int r = 1; r <= w->boundary->region_count; r++)
        if (w->met[r])
            memset(&w->length[(size_t)r * (size_t)cells], 0, (size_t)cells * sizeof *w->length);
    memset(w->met, 0, sizeof w->met);
}

/* A row of which no line counts becomes like the nearest one before it, or else after it. */
static void copy_rows(work *w) {
    lar_lattice *lattice = w->lattice;
    size_t cells = (size_t)lattice->cells[0];
    size_t rows = (size_t)lattice->cells[1] * (size_t)lattice->cells[2];
    for (size_t r = 0; r < rows; r++) {
        if (w->row_lines[r]) continue;
        size_t from = r;
        while (from > 0 && !w->row_lines[from]) from--;
        for (; from < rows && !w->row_lines[from];) from++;
        if (from == rows) return;
        memcpy(&lattice->region[r * cells], &lattice->region[from * cells], cells);
        memcpy(&lattice->inner[r * cells], &lattice->inner[from * cells], cells);
        memcpy(&lattice->share[r * cells], &lattice->share[from * cells], cells);
    }
}

static lar_status follow_lines(work *w, lar_error *error) {
    lar_lattice *lattice = w->lattice;
    size_t lengths = (size_t)(w->boundary->region_count + 1) * (size_t)lattice->cells[0];
    size_t rows = (size_t)lattice->cells[1] * (size_t)lattice->cells[2];
    w->length = lar_calloc(lengths, sizeof *w->length);
    w->row_lines = lar_calloc(rows, 1);
    if (!w->length || !w->row_lines)
        return lar_fail_memory(error, 8 * lengths + rows, "the rows of the grid");
    for (int32_t k = 0; k < lattice->cells[2]; k++)
        for (int32_t j = 0; j < lattice->cells[1]; j++) {
            int good = 0;
            for (int line = 0; line < LINES * LINES; line++) {
                size_t across = (size_t)(LINES * j + line % LINES);
                size_t up = (size_t)(LINES * k + line / LINES);
                good += follow_line(w, up * (size_t)w->lines[0] + across);
            }
            lattice->repaired += LINES * LINES - good;
            w->row_lines[(size_t)k * (size_t)lattice->cells[1] + (size_t)j] = (uint8_t)good;
            write_row(w, j, k, good);
        }
    if (lattice->repaired) copy_rows(w);
    return LAR_OK;
}

/* ---- all of it ------------------------------------------------------------------------------ */

static lar_status fill(work *w, lar_error *error) {
    lar_lattice *lattice = w->lattice;
    size_t cells =
        (size_t)lattice->cells[0] * (size_t)lattice->cells[1] * (size_t)lattice->cells[2];
    lattice->region = lar_calloc(cells, 1);
    lattice->inner = lar_calloc(cells, 1);
    lattice->share = lar_calloc(cells, 1);
    if (!lattice->region || !lattice->inner || !lattice->share)
        return lar_fail_memory(error, 3 * cells, "the grid of cells");
    lar_status status = place_vertices(w, error);
    if (!status) status = cross_lines(w, error);
    if (!status) status = sort_crossings(w, error);
    if (!status) status = follow_lines(w, error);
    if (status) return status;
    for (size_t c = 0; c < cells; c++)
        if (lattice->region[c]) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "no cell of %.4g mm is half full: the body is smaller or thinner than that; "
                    "choose a smaller size or more elements",
                    1e3 * lattice->size);
}

lar_status lar_lattice_fill(const lar_boundary *boundary, double size, lar_lattice *lattice,
                            lar_error *error) {
    if (!(size > 0 && isfinite(size)))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a size of %g m is none; choose the edge of an element", size);
    lar_lattice made = {0};
    lar_status status = place_lattice(boundary, size, &made, error);
    if (!status) {
        work w = {.boundary = boundary, .lattice = &made};
        status = fill(&w, error);
        free_work(&w);
    }
    if (status)
        lar_lattice_clear(&made);
    else
        *lattice = made;
    return status;
}
