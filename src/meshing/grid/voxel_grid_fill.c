/* Which region has how much of every cell. A line that does not come out of the body again takes no
 * part: the others of its row stand for it. */
#include "meshing/grid/voxel_grid_lines.h"
#include "meshing/grid/voxel_grid_thin.h"
#include "meshing/grid/voxel_grid_votes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"

enum { LINES = LAR_LINES_PER_CELL, COUNTERS = LAR_REGIONS_MAX + 1 };

typedef struct work {
    const lar_boundary *boundary;
    lar_voxel_grid *voxel_grid;
    lar_lines lines;
    double *length; /* [regions + 1][cells along] parts of the cells of one row */
    bool met[COUNTERS];
    uint8_t *row_lines; /* [rows] lines that count */
    lar_thin_changes changes;
    lar_votes votes; /* of several regions */
} work;

/* ---- where the grid lies ----------------------------------------------------------------- */

/* Planes of flat cuts across an axis. */
typedef struct ends {
    bool cut[2]; /* low, high */
    double area[2];
} ends;

static double cut_area(const lar_boundary *boundary, int cut) {
    double area = 0;
    for (int32_t t = 0; t < boundary->triangles.triangle_count; t++) {
        if (boundary->side[t][0] != LAR_REGION_CUT + cut) continue;
        double normal[3];
        lar_triangles_normal(&boundary->triangles, t, normal);
        area += lar_length(normal) / 2;
    }
    return area;
}

static void find_ends(const lar_boundary *boundary, ends end[3]) {
    memset(end, 0, 3 * sizeof *end);
    for (int s = 0; s < LAR_CUTS; s++) {
        const lar_cut *cut = &boundary->cut[s];
        if (boundary->cut_count == 0 || !cut->name[0]) continue;
        for (int a = 0; a < 3; a++) {
            double along = lar_dot(cut->normal, boundary->axis[a]);
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
            double x = lar_dot(boundary->axis[a], boundary->triangles.vertex[v]);
            low[a] = fmin(low[a], x);
            high[a] = fmax(high[a], x);
        }
}

/* Cut at both ends: a size that divides the body between them, when one is near. */
static double fitting_size(double size, const ends end[3], const double low[3],
                           const double high[3]) {
    const double max = 0.01;
    double best = size, change = max;
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

/* Whether the body ends in flat sides across an axis, as a box does: by at least a quarter of what
 * goes around it there. */
static bool has_flat_ends(const lar_boundary *boundary, double size, int axis, const double low[3],
                          const double high[3]) {
    const double FLAT = 0.99, NEAR = 0.1, PART = 0.25;
    const lar_triangles *triangles = &boundary->triangles;
    double area = 0;
    for (int32_t t = 0; t < triangles->triangle_count; t++) {
        double normal[3];
        lar_triangles_normal(triangles, t, normal);
        const double across = fabs(lar_dot(normal, boundary->axis[axis]));
        const double at = lar_dot(triangles->vertex[triangles->corner[t][0]], boundary->axis[axis]);
        if (!(across >= FLAT * lar_length(normal))) continue;
        if (fmin(at - low[axis], high[axis] - at) < NEAR * size) area += across / 2;
    }
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    return area > 2 * PART * (high[u] - low[u]) * (high[v] - low[v]);
}

/* Cells along an axis with the body in their middle. At flat ends the outermost ones are filled by
 * less than a third of their length, and left out, or nearly: where sides that cut cells in half
 * met, those along the edge, and at the corner, would be left out alone, and no fitting draws an
 * edge from there. */
static double cells_along(double extent, bool flat) {
    const double FULL = 0.82; /* cubed, at a corner, it is half and something for counting lines */
    const double cells = fmax(1, ceil(extent - 1e-6)), filled = (extent - cells) / 2 + 1;
    return !flat || filled >= FULL || cells < 3 ? cells : cells + 1;
}

static lar_status place_voxel_grid(const lar_boundary *boundary, double size,
                                   lar_voxel_grid *voxel_grid, lar_error *error) {
    ends end[3];
    double low[3], high[3], all = 1;
    find_ends(boundary, end);
    find_extent(boundary, low, high);
    voxel_grid->size = fitting_size(size, end, low, high);
    memcpy(voxel_grid->axis, boundary->axis, sizeof voxel_grid->axis);
    double corner[3];
    for (int a = 0; a < 3; a++) {
        double extent = (high[a] - low[a]) / voxel_grid->size;
        if (!isfinite(extent))
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: the body has no finite extent; look at its coordinates",
                            boundary->triangles.source ? boundary->triangles.source : "surface");
        bool cut = end[a].cut[0] || end[a].cut[1];
        double cells =
            cells_along(extent, !cut && has_flat_ends(boundary, voxel_grid->size, a, low, high));
        bool at_low = end[a].cut[0] && (!end[a].cut[1] || end[a].area[0] >= end[a].area[1]);
        if (at_low)
            corner[a] = low[a];
        else if (end[a].cut[1])
            corner[a] = high[a] - cells * voxel_grid->size;
        else
            corner[a] = (low[a] + high[a] - cells * voxel_grid->size) / 2;
        corner[a] -= voxel_grid->size;
        all *= cells + 2;
        if (!(all <= LAR_VOXEL_GRID_CELLS_MAX))
            return lar_fail(
                error, LAR_ERROR_ARGUMENT,
                "cells of %.4g mm would be more than %d for a body of %.4g x %.4g x %.4g "
                "mm; choose a larger size, or look at the surface's unit (--scale)",
                1e3 * size, (int)LAR_VOXEL_GRID_CELLS_MAX, 1e3 * (high[0] - low[0]),
                1e3 * (high[1] - low[1]), 1e3 * (high[2] - low[2]));
        voxel_grid->cells[a] = (int32_t)cells + 2;
    }
    for (int b = 0; b < 3; b++)
        voxel_grid->origin[b] = corner[0] * voxel_grid->axis[0][b] +
                                corner[1] * voxel_grid->axis[1][b] +
                                corner[2] * voxel_grid->axis[2][b];
    return LAR_OK;
}

/* ---- rows of cells -------------------------------------------------------------------------- */

static void add_length(void *context, int region, double from, double to) {
    work *w = context;
    int32_t cells = w->voxel_grid->cells[0];
    double *length = &w->length[(size_t)region * (size_t)cells];
    w->met[region] = true;
    int32_t first = (int32_t)fmax(0, floor(from));
    for (int32_t i = first; i < cells && i < to; i++) length[i] += fmin(to, i + 1) - fmax(from, i);
}

/* Widens slots and thin parts: of what is emptied all regions lose the same part. */
static void change_cell(work *w, size_t cell, int32_t i, int lines) {
    const int32_t index = w->changes.of ? w->changes.of[cell] : -1;
    if (index < 0) return;
    const lar_thin_change *change = &w->changes.one[index];
    const size_t cells = (size_t)w->voxel_grid->cells[0];
    double inside = 0;
    for (int r = 1; r <= w->boundary->region_count; r++)
        inside += w->length[(size_t)r * cells + (size_t)i];
    const double then = fmin(fmax(inside + change->part * lines, 0), fmax(inside, lines));
    if (change->part > 0) {
        w->length[change->region * cells + (size_t)i] += then - inside;
        w->met[change->region] = true;
    }
    for (int r = 1; change->part < 0 && inside > 0 && r <= w->boundary->region_count; r++)
        w->length[(size_t)r * cells + (size_t)i] *= then / inside;
}

static bool write_row(work *w, int32_t j, int32_t k, int lines) {
    lar_voxel_grid *voxel_grid = w->voxel_grid;
    int32_t cells = voxel_grid->cells[0];
    size_t row = lar_voxel_grid_cell(voxel_grid, 0, j, k);
    bool kept = true;
    for (int32_t i = 0; i < cells && lines > 0; i++) {
        double inside = 0, largest = 0;
        int inner = 0;
        change_cell(w, row + (size_t)i, i, lines);
        for (int r = 1; r <= w->boundary->region_count; r++) {
            if (!w->met[r]) continue;
            double part = w->length[(size_t)r * (size_t)cells + (size_t)i];
            inside += part;
            if (w->boundary->region_count > 1 && part > 0)
                kept = kept && lar_votes_add(&w->votes, row + (size_t)i, r, part / lines);
            if (part > largest) largest = part, inner = r;
        }
        inside = fmin(1, inside / lines);
        voxel_grid->inner[row + (size_t)i] = (uint8_t)inner;
        /* A body's flat side may lie in the middle of cells: rounding must not decide. */
        voxel_grid->region[row + (size_t)i] = inside >= 0.5 - 1e-6 ? (uint8_t)inner : 0;
        voxel_grid->share[row + (size_t)i] = (uint8_t)lround(255 * inside);
    }
    for (int r = 1; r <= w->boundary->region_count; r++)
        if (w->met[r])
            memset(&w->length[(size_t)r * (size_t)cells], 0, (size_t)cells * sizeof *w->length);
    memset(w->met, 0, sizeof w->met);
    return kept;
}

/* A row of which no line counts becomes like the nearest one before it, or else after it. */
static void copy_rows(work *w) {
    lar_voxel_grid *voxel_grid = w->voxel_grid;
    size_t cells = (size_t)voxel_grid->cells[0];
    size_t rows = (size_t)voxel_grid->cells[1] * (size_t)voxel_grid->cells[2];
    for (size_t r = 0; r < rows; r++) {
        if (w->row_lines[r]) continue;
        size_t from = r;
        while (from > 0 && !w->row_lines[from]) from--;
        for (; from < rows && !w->row_lines[from];) from++;
        if (from == rows) return;
        memcpy(&voxel_grid->region[r * cells], &voxel_grid->region[from * cells], cells);
        memcpy(&voxel_grid->inner[r * cells], &voxel_grid->inner[from * cells], cells);
        memcpy(&voxel_grid->share[r * cells], &voxel_grid->share[from * cells], cells);
    }
}

/* A region shall have the cells that it has when it is widened, but not many more or less than its
 * volume fills: fitting can stretch them only so far. */
static void limit_votes(work *w) {
    const double MAX_OFF = 0.15;
    for (int r = 1; r <= w->boundary->region_count; r++) {
        const double volume = w->boundary->region[r].volume / pow(w->voxel_grid->size, 3);
        w->votes.volume[r] =
            fmin(fmax(w->votes.volume[r], (1 - MAX_OFF) * volume), (1 + MAX_OFF) * volume);
    }
}

static lar_status follow_lines(work *w, lar_error *error) {
    lar_voxel_grid *voxel_grid = w->voxel_grid;
    size_t lengths = (size_t)(w->boundary->region_count + 1) * (size_t)voxel_grid->cells[0];
    size_t rows = (size_t)voxel_grid->cells[1] * (size_t)voxel_grid->cells[2];
    w->length = lar_calloc(lengths, sizeof *w->length);
    w->row_lines = lar_calloc(rows, 1);
    if (!w->length || !w->row_lines)
        return lar_fail_memory(error, 8 * lengths + rows, "the rows of the grid");
    for (int32_t k = 0; k < voxel_grid->cells[2]; k++)
        for (int32_t j = 0; j < voxel_grid->cells[1]; j++) {
            int good = 0;
            for (int line = 0; line < LINES * LINES; line++) {
                size_t across = (size_t)(LINES * j + line % LINES);
                size_t up = (size_t)(LINES * k + line / LINES);
                good += lar_lines_follow(&w->lines, up * (size_t)w->lines.count[0] + across,
                                         add_length, w);
            }
            voxel_grid->repaired += LINES * LINES - good;
            w->row_lines[(size_t)k * (size_t)voxel_grid->cells[1] + (size_t)j] = (uint8_t)good;
            if (!write_row(w, j, k, good))
                return lar_fail_memory(error, 2 * w->votes.capacity * sizeof *w->votes.vote,
                                       "the regions' parts of cells");
        }
    if (w->boundary->region_count > 1) {
        limit_votes(w);
        lar_votes_count(&w->votes, w->boundary->region_count, voxel_grid);
    }
    if (voxel_grid->repaired) copy_rows(w);
    return LAR_OK;
}

/* ---- all of it ------------------------------------------------------------------------------ */

static lar_status fill(work *w, const lar_thin *thin, lar_error *error) {
    lar_voxel_grid *voxel_grid = w->voxel_grid;
    size_t cells =
        (size_t)voxel_grid->cells[0] * (size_t)voxel_grid->cells[1] * (size_t)voxel_grid->cells[2];
    voxel_grid->region = lar_calloc(cells, 1);
    voxel_grid->inner = lar_calloc(cells, 1);
    voxel_grid->share = lar_calloc(cells, 1);
    if (!voxel_grid->region || !voxel_grid->inner || !voxel_grid->share)
        return lar_fail_memory(error, 3 * cells, "the grid of cells");
    lar_status status = lar_lines_create(w->boundary, voxel_grid, &w->lines, error);
    if (!status) status = lar_thin_widen(thin, w->boundary, voxel_grid, &w->changes, error);
    if (!status) status = follow_lines(w, error);
    if (status) return status;
    for (size_t c = 0; c < cells; c++)
        if (voxel_grid->region[c]) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "no cell of %.4g mm is half full: the body is smaller or thinner than that; "
                    "choose a smaller size or more elements",
                    1e3 * voxel_grid->size);
}

lar_status lar_voxel_grid_fill_thin(const lar_boundary *boundary, lar_thin *thin, double size,
                                    lar_voxel_grid *voxel_grid, lar_error *error) {
    if (!(size > 0 && isfinite(size)))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a size of %g m is none; choose the edge of an element", size);
    lar_voxel_grid made = {0};
    lar_status status = place_voxel_grid(boundary, size, &made, error);
    if (!status) {
        work w = {.boundary = boundary, .voxel_grid = &made};
        const double room = 1.15; /* for other sizes that are tried */
        if (made.size > thin->size || made.size < LAR_THIN_SMALLEST * thin->size)
            status = lar_thin_find(boundary, room * made.size, thin, error);
        if (!status) status = fill(&w, thin, error);
        lar_lines_clear(&w.lines);
        lar_thin_changes_clear(&w.changes);
        free(w.length);
        free(w.row_lines);
        lar_votes_clear(&w.votes);
    }
    if (status)
        lar_voxel_grid_clear(&made);
    else
        *voxel_grid = made;
    return status;
}

static void add_stretch(void *context, int region, double from, double to) {
    ((double *)context)[region] += to - from;
}

lar_status lar_voxel_grid_measure(const lar_boundary *boundary, double size, double *volume,
                                  lar_error *error) {
    lar_voxel_grid voxel_grid = {0};
    lar_lines lines = {0};
    lar_status status = place_voxel_grid(boundary, size, &voxel_grid, error);
    if (!status) status = lar_lines_create(boundary, &voxel_grid, &lines, error);
    if (status) return status;
    for (int32_t r = 0; r <= boundary->region_count; r++) volume[r] = 0;
    size_t count = (size_t)lines.count[0] * (size_t)lines.count[1];
    for (size_t line = 0; line < count; line++) lar_lines_follow(&lines, line, add_stretch, volume);
    for (int32_t r = 0; r <= boundary->region_count; r++)
        volume[r] *= pow(voxel_grid.size, 3) / (LINES * LINES);
    lar_lines_clear(&lines);
    return LAR_OK;
}
