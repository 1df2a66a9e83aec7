#include "model/format/vtk/vtk_polydata.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "model/format/triangle_builder.h"

typedef struct converter {
    const char *path;
    const lar_vtk_grid *grid;
    const lar_vtk_integers *tag;
    lar_error *error;
    lar_triangle_builder builder;
    size_t corner_capacity;
    int32_t *corner; /* of the cell in hand */
} converter;

static lar_status copy_points(converter *c) {
    for (int64_t p = 0; p < c->grid->point_count; p++) {
        const double *at = c->grid->point[p];
        if (!isfinite(at[0]) || !isfinite(at[1]) || !isfinite(at[2]))
            return lar_fail(c->error, LAR_ERROR_FORMAT,
                            "%s: a coordinate of point %" PRId64
                            " (from 0) is no finite number; write the file again",
                            c->path, p);
        lar_status status = lar_triangle_builder_vertex(&c->builder, at);
        if (status) return status;
    }
    return LAR_OK;
}

static lar_status bad_cell(const converter *c, int64_t cell, const char *cause) {
    return lar_fail(c->error, LAR_ERROR_FORMAT,
                    "%s: cell %" PRId64 " (from 0) %s; write the file again", c->path, cell, cause);
}

/* Every second triangle of a strip is turned. */
static lar_status add_strip(converter *c, size_t count) {
    lar_status status = LAR_OK;
    for (size_t k = 2; k < count && !status; k++) {
        bool odd = k % 2 == 1;
        const int32_t corner[3] = {c->corner[odd ? k - 1 : k - 2], c->corner[odd ? k - 2 : k - 1],
                                   c->corner[k]};
        status = lar_triangle_builder_polygon(&c->builder, corner, 3);
    }
    return status;
}

static lar_status add_cell(converter *c, const lar_vtk_cells *list, int64_t index, int64_t cell,
                           bool strip) {
    int64_t from = index > 0 ? list->end[index - 1] : 0, to = list->end[index];
    if (from < 0 || to < from || to > list->corner_count)
        return bad_cell(c, cell, "ends beyond the list of corners or before it begins");
    size_t count = (size_t)(to - from);
    while (c->corner_capacity < count)
        if (!LAR_GROW(c->corner, c->corner_capacity, c->corner_capacity))
            return lar_fail_memory(c->error, count * sizeof *c->corner, c->path);
    for (size_t k = 0; k < count; k++) {
        int64_t point = list->corner[from + (int64_t)k];
        if (point < 0 || point >= c->grid->point_count)
            return bad_cell(c, cell, "names a point that the file does not have");
        c->corner[k] = (int32_t)point;
    }
    if (c->tag) {
        int64_t tag = c->tag->value[cell];
        if (tag < INT32_MIN || tag > INT32_MAX)
            return bad_cell(c, cell, "has a tag that does not fit 32 bits");
        c->builder.tag = (int32_t)tag;
    }
    return strip ? add_strip(c, count)
                 : lar_triangle_builder_polygon(&c->builder, c->corner, count);
}

static lar_status add_cells(converter *c, const lar_vtk_cells list[LAR_VTK_LISTS]) {
    int64_t cells = 0;
    for (int k = 0; k < LAR_VTK_LISTS; k++) cells += list[k].count;
    if (c->tag && c->tag->count != cells)
        return lar_fail(c->error, LAR_ERROR_FORMAT,
                        "%s: the array \"%s\" has %" PRId64 " values for %" PRId64
                        " cells; write the file again",
                        c->path, c->tag->name, c->tag->count, cells);
    int64_t cell = list[LAR_VTK_VERTS].count + list[LAR_VTK_LINES].count;
    for (int k = LAR_VTK_POLYS; k < LAR_VTK_LISTS; k++)
        for (int64_t i = 0; i < list[k].count; i++) {
            lar_status status = add_cell(c, &list[k], i, cell++, k == LAR_VTK_STRIPS);
            if (status) return status;
        }
    return LAR_OK;
}

lar_status lar_vtk_polydata_to_triangles(const char *path, const lar_vtk_grid *grid,
                                         const lar_vtk_cells list[LAR_VTK_LISTS],
                                         lar_triangles *triangles, lar_error *error) {
    converter c = {.path = path,
                   .grid = grid,
                   .tag = lar_vtk_grid_tags(grid),
                   .error = error,
                   .builder = {.path = path, .error = error, .triangles = triangles}};
    c.builder.tagged = c.tag != NULL;
    lar_status status = copy_points(&c);
    if (!status) status = add_cells(&c, list);
    free(c.corner);
    if (!status && triangles->triangle_count == 0)
        status =
            lar_fail(error, LAR_ERROR_FORMAT,
                     "%s: has no polygon and no strip of triangles, so it is no surface; check "
                     "the file",
                     path);
    return status;
}
