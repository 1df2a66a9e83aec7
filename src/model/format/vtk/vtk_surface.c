/* Reader for surfaces in legacy VTK files: DATASET POLYDATA with VERTICES, LINES, POLYGONS and
 * TRIANGLE_STRIPS. The format is in vtk_legacy.c; the cells become triangles in vtk_polydata.c. */
#include "model/format/vtk/vtk_legacy.h"
#include "model/format/vtk/vtk_polydata.h"

static lar_status read_dataset(lar_vtk_legacy *file) {
    lar_span kind;
    if (!lar_text_word(&file->text, &kind))
        return lar_vtk_legacy_bad(file, "DATASET names no type");
    if (lar_span_equal_nocase(kind, "POLYDATA")) return LAR_OK;
    if (lar_span_equal_nocase(kind, "UNSTRUCTURED_GRID"))
        return lar_fail(file->error, LAR_ERROR_UNSUPPORTED,
                        "%s:%d: DATASET UNSTRUCTURED_GRID is a mesh already, not a surface; use it "
                        "as it is, or save its surface as PolyData (ParaView: Extract Surface)",
                        file->path, file->text.line);
    return lar_fail(file->error, LAR_ERROR_UNSUPPORTED,
                    "%s:%d: DATASET %.*s is no surface that Lariat reads; save it as PolyData "
                    "(ParaView: Extract Surface)",
                    file->path, file->text.line, kind.length < 40 ? (int)kind.length : 40, kind.at);
}

static lar_status read_section(lar_vtk_legacy *file, lar_span keyword, lar_vtk_cells *list) {
    static const char *const names[LAR_VTK_LISTS] = {[LAR_VTK_VERTS] = "VERTICES",
                                                     [LAR_VTK_LINES] = "LINES",
                                                     [LAR_VTK_POLYS] = "POLYGONS",
                                                     [LAR_VTK_STRIPS] = "TRIANGLE_STRIPS"};
    if (lar_span_equal_nocase(keyword, "DATASET")) return read_dataset(file);
    for (int k = 0; k < LAR_VTK_LISTS; k++)
        if (lar_span_equal_nocase(keyword, names[k]))
            return lar_vtk_legacy_cells(file, names[k], &list[k]);
    return lar_vtk_legacy_section(file, keyword);
}

lar_status lar_vtk_surface_parse(const char *path, const lar_bytes *bytes, lar_triangles *triangles,
                                 lar_error *error) {
    lar_vtk_legacy file = {.path = path, .error = error, .text = lar_text_from(bytes)};
    lar_vtk_cells list[LAR_VTK_LISTS] = {0};
    lar_status status = lar_vtk_legacy_begin(&file);
    lar_span keyword;
    while (!status && lar_text_word(&file.text, &keyword))
        status = read_section(&file, keyword, list);
    if (!status) status = lar_vtk_polydata_to_triangles(path, &file.grid, list, triangles, error);
    for (int k = 0; k < LAR_VTK_LISTS; k++) lar_vtk_cells_clear(&list[k]);
    lar_vtk_grid_clear(&file.grid);
    return status;
}
