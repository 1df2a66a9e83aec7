/* Writer of surfaces as VTK XML files (.vtp). vtk_xml_write.c has the format. */
#include "model/triangles/triangles.h"

#include <inttypes.h>
#include <stdlib.h>

#include "model/format/vtk/vtk_xml_write.h"

static const char points[] = "Points", polys[] = "Polys", cell_data[] = "CellData";

static lar_status add_points(lar_vtk_writer *w, const lar_triangles *surface) {
    const size_t values = (size_t)surface->vertex_count * 3;
    lar_vtk_out_array array = {.where = points,
                               .type = "Float64",
                               .components = 3,
                               .values = values,
                               .value_size = sizeof(double),
                               .data = surface->vertex};
    if (w->small) {
        float *single = lar_calloc(values, sizeof *single);
        if (!single) return lar_fail_memory(w->error, values * sizeof *single, w->out.path);
        for (size_t v = 0; v < values; v++) single[v] = (float)surface->vertex[v / 3][v % 3];
        array.type = "Float32";
        array.value_size = sizeof *single;
        array.data = array.owned = single;
    }
    return lar_vtk_writer_add(w, lar_strdup("Points"), array);
}

static lar_status collect(lar_vtk_writer *w, const lar_triangles *surface) {
    size_t triangles = (size_t)surface->triangle_count;
    lar_status status = LAR_OK;
    if (surface->tag)
        status = lar_vtk_writer_add(w, lar_strdup("tag"),
                                    (lar_vtk_out_array){.where = cell_data,
                                                        .type = "Int32",
                                                        .components = 1,
                                                        .values = triangles,
                                                        .value_size = sizeof *surface->tag,
                                                        .data = surface->tag});
    if (!status) status = add_points(w, surface);
    if (!status)
        status = lar_vtk_writer_add(w, lar_strdup("connectivity"),
                                    (lar_vtk_out_array){.where = polys,
                                                        .type = "Int32",
                                                        .components = 1,
                                                        .values = triangles * 3,
                                                        .value_size = sizeof(int32_t),
                                                        .data = surface->corner});
    if (status) return status;
    int64_t *ends = lar_calloc(triangles, sizeof *ends);
    if (!ends) return lar_fail_memory(w->error, triangles * sizeof *ends, w->out.path);
    for (size_t t = 0; t < triangles; t++) ends[t] = 3 * ((int64_t)t + 1);
    return lar_vtk_writer_add(w, lar_strdup("offsets"),
                              (lar_vtk_out_array){.where = polys,
                                                  .type = "Int64",
                                                  .components = 1,
                                                  .values = triangles,
                                                  .value_size = sizeof *ends,
                                                  .data = ends,
                                                  .owned = ends});
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
