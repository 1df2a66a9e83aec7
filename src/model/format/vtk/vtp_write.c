/* Writer of surfaces as VTK XML files (.vtp). vtk_xml_write.c has the format. */
#include "model/triangles/triangles.h"

#include <inttypes.h>
#include <stdlib.h>

#include "model/format/vtk/vtk_xml_write.h"

static const char points[] = "Points", polys[] = "Polys", cell_data[] = "CellData";

static lar_status add_points(lar_vtk_writer *w, const lar_triangles *surface) {
    const size_t count = (size_t)surface->vertex_count;
    if (!w->small)
        return lar_vtk_writer_add(
            w, lar_strdup("Points"),
            lar_vtk_array(points, "Float64", 3, count, sizeof(double), surface->vertex));
    float *single = lar_calloc(3 * count, sizeof *single);
    if (!single) return lar_fail_memory(w->error, 3 * count * sizeof *single, w->out.path);
    for (size_t v = 0; v < 3 * count; v++) single[v] = (float)surface->vertex[v / 3][v % 3];
    lar_vtk_out_array array = lar_vtk_array(points, "Float32", 3, count, sizeof *single, single);
    array.owned = single;
    return lar_vtk_writer_add(w, lar_strdup("Points"), array);
}

static lar_status collect(lar_vtk_writer *w, const lar_triangles *surface) {
    size_t triangles = (size_t)surface->triangle_count;
    lar_status status = LAR_OK;
    if (surface->tag)
        status = lar_vtk_writer_add(
            w, lar_strdup("tag"),
            lar_vtk_array(cell_data, "Int32", 1, triangles, sizeof *surface->tag, surface->tag));
    if (!status) status = add_points(w, surface);
    if (!status)
        status = lar_vtk_writer_add(
            w, lar_strdup("connectivity"),
            lar_vtk_array(polys, "Int32", 1, triangles * 3, sizeof(int32_t), surface->corner));
    return status ? status : lar_vtk_writer_add_ends(w, polys, triangles, 3);
}

static lar_status write_file(const char *path, const lar_triangles *triangles, bool small,
                             lar_error *error) {
    static const char *const elements[] = {cell_data, points, polys, NULL};
    char attributes[160];
    snprintf(attributes, sizeof attributes,
             " NumberOfPoints=\"%" PRId32 "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
             "NumberOfStrips=\"0\" NumberOfPolys=\"%" PRId32 "\"",
             triangles->vertex_count, triangles->triangle_count);
    lar_vtk_writer w;
    lar_status status = lar_vtk_writer_open(&w, path, error);
    w.small = small;
    if (!status) status = collect(&w, triangles);
    if (!status) status = lar_vtk_writer_print(&w, "PolyData", attributes, elements);
    return lar_vtk_writer_close(&w, status);
}

lar_status lar_vtp_write(const char *path, const lar_triangles *triangles, lar_error *error) {
    return write_file(path, triangles, false, error);
}

lar_status lar_vtp_write_small(const char *path, const lar_triangles *triangles, lar_error *error) {
    return write_file(path, triangles, true, error);
}
