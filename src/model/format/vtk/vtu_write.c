/* Writer of meshes and results as VTK XML files: one .vtu per frame, one .pvd for the series.
 * vtk_xml_write.c has the format. */
#include "model/format/mesh_io.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "model/format/vtk/vtk_grid.h"
#include "model/format/vtk/vtk_xml_write.h"

enum { HEXAHEDRON = 12 };

static const char field_data[] = "FieldData", point_data[] = "PointData", cell_data[] = "CellData",
                  points[] = "Points", cells[] = "Cells";

static lar_status collect_sets(lar_vtk_writer *w, const lar_mesh *mesh) {
    lar_status status = LAR_OK;
    for (int32_t i = 0; i < mesh->set_count && !status; i++) {
        const lar_set *set = &mesh->set[i];
        status =
            lar_vtk_writer_add(w, lar_vtk_encode_name(lar_vtk_set_prefix[set->kind], set->name),
                               lar_vtk_array(field_data, "Int32", 1, (size_t)set->count,
                                             sizeof *set->index, set->index));
    }
    return status;
}

static lar_status collect_results(lar_vtk_writer *w, const char *where, const lar_vtu_array *arrays,
                                  int count, int32_t tuples) {
    lar_status status = LAR_OK;
    for (int i = 0; i < count && !status; i++)
        status =
            lar_vtk_writer_add(w, lar_strdup(arrays[i].name),
                               lar_vtk_array(where, "Float64", arrays[i].components, (size_t)tuples,
                                             sizeof(double), arrays[i].values));
    return status;
}

static lar_status collect_cells(lar_vtk_writer *w, const lar_mesh *mesh) {
    size_t elements = (size_t)mesh->element_count;
    lar_status status = lar_vtk_writer_add(
        w, lar_strdup("connectivity"),
        lar_vtk_array(cells, "Int32", 1, elements * 8, sizeof(int32_t), mesh->element));
    if (!status) status = lar_vtk_writer_add_ends(w, cells, elements, 8);
    if (status) return status;
    unsigned char *types = lar_calloc(elements, 1);
    if (!types) return lar_fail_memory(w->error, elements, w->out.path);
    memset(types, HEXAHEDRON, elements);
    lar_vtk_out_array kinds = lar_vtk_array(cells, "UInt8", 1, elements, 1, types);
    kinds.owned = types;
    return lar_vtk_writer_add(w, lar_strdup("types"), kinds);
}

static lar_status collect_frame(lar_vtk_writer *w, const lar_vtu_frame *frame) {
    const lar_mesh *mesh = frame->mesh;
    const void *position =
        frame->position ? (const void *)frame->position : (const void *)mesh->position;
    lar_status status = lar_vtk_writer_add(
        w, lar_strdup("TimeValue"),
        lar_vtk_array(field_data, "Float64", 1, 1, sizeof frame->time, &frame->time));
    if (!status) status = collect_sets(w, mesh);
    if (!status)
        status = collect_results(w, point_data, frame->point_array, frame->point_array_count,
                                 mesh->node_count);
    if (!status && mesh->element_tag)
        status =
            lar_vtk_writer_add(w, lar_strdup("tag"),
                               lar_vtk_array(cell_data, "Int32", 1, (size_t)mesh->element_count,
                                             sizeof *mesh->element_tag, mesh->element_tag));
    if (!status && mesh->fibre) {
        const lar_vtu_array fibre = {"fibre", 3, &mesh->fibre[0][0]};
        status = collect_results(w, cell_data, &fibre, 1, mesh->element_count);
    }
    if (!status && mesh->second) {
        const lar_vtu_array second = {"fibre2", 3, &mesh->second[0][0]};
        status = collect_results(w, cell_data, &second, 1, mesh->element_count);
    }
    if (!status)
        status = collect_results(w, cell_data, frame->cell_array, frame->cell_array_count,
                                 mesh->element_count);
    if (!status)
        status = lar_vtk_writer_add(w, lar_strdup("Points"),
                                    lar_vtk_array(points, "Float64", 3, (size_t)mesh->node_count,
                                                  sizeof(double), position));
    return status ? status : collect_cells(w, mesh);
}

lar_status lar_vtu_write(const char *path, const lar_vtu_frame *frame, lar_error *error) {
    static const char *const elements[] = {point_data, cell_data, points, cells, NULL};
    char attributes[80];
    snprintf(attributes, sizeof attributes,
             " NumberOfPoints=\"%" PRId32 "\" NumberOfCells=\"%" PRId32 "\"",
             frame->mesh->node_count, frame->mesh->element_count);
    lar_vtk_writer w;
    lar_status status = lar_vtk_writer_open(&w, path, error);
    if (!status) status = collect_frame(&w, frame);
    if (!status) status = lar_vtk_writer_print(&w, "UnstructuredGrid", attributes, elements);
    return lar_vtk_writer_close(&w, status);
}

lar_status lar_pvd_write(const char *path, const char *const *files, const double *times, int count,
                         lar_error *error) {
    locale_t before = uselocale(lar_text_locale());
    lar_part_file out;
    lar_status status = lar_part_open(&out, path, error);
    if (!status)
        status =
            lar_part_print(&out,
                           "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
                           "byte_order=\"%s\">\n<Collection>\n",
                           lar_vtk_byte_order());
    for (int i = 0; i < count && !status; i++) {
        status = lar_part_print(&out, "<DataSet timestep=\"%.17g\" part=\"0\" file=\"", times[i]);
        if (!status) status = lar_part_attribute(&out, files[i]);
        if (!status) status = lar_part_print(&out, "\"/>\n");
    }
    if (!status) status = lar_part_print(&out, "</Collection>\n</VTKFile>\n");
    status = lar_part_close(&out, status);
    uselocale(before);
    return status;
}
