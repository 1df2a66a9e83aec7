/* Reader for meshes in legacy VTK files: DATASET UNSTRUCTURED_GRID with CELLS and CELL_TYPES. The
 * format is in vtk_legacy.c; what the numbers mean is decided in vtk_grid.c. */
#include "model/format/mesh_io.h"

#include <inttypes.h>

#include "model/format/vtk/vtk_grid.h"
#include "model/format/vtk/vtk_legacy.h"

typedef struct vtk_file {
    lar_vtk_legacy legacy;
    lar_vtk_cells cells;
    bool has_types;
    int64_t type_count;
} vtk_file;

static lar_status read_dataset(lar_vtk_legacy *file) {
    lar_span kind;
    if (!lar_text_word(&file->text, &kind))
        return lar_vtk_legacy_bad(file, "DATASET names no type");
    if (lar_span_equal_nocase(kind, "UNSTRUCTURED_GRID")) return LAR_OK;
    return lar_fail(file->error, LAR_ERROR_UNSUPPORTED,
                    "%s:%d: DATASET %.*s is no mesh of hexahedra that Lariat reads; save it as an "
                    "unstructured grid (ParaView: Append Datasets, then save as .vtu)",
                    file->path, file->text.line, kind.length < 40 ? (int)kind.length : 40, kind.at);
}

static lar_status read_cell_types(vtk_file *file) {
    if (file->has_types) return lar_vtk_legacy_bad(&file->legacy, "CELL_TYPES stands there twice");
    if (!lar_vtk_legacy_count(&file->legacy, &file->type_count))
        return lar_vtk_legacy_bad(&file->legacy, "CELL_TYPES has no count");
    file->has_types = true;
    return lar_vtk_legacy_integers(&file->legacy, file->type_count, &file->legacy.grid.cell_type);
}

static lar_status read_section(vtk_file *file, lar_span keyword) {
    if (lar_span_equal_nocase(keyword, "DATASET")) return read_dataset(&file->legacy);
    if (lar_span_equal_nocase(keyword, "CELLS"))
        return lar_vtk_legacy_cells(&file->legacy, "CELLS", &file->cells);
    if (lar_span_equal_nocase(keyword, "CELL_TYPES")) return read_cell_types(file);
    return lar_vtk_legacy_section(&file->legacy, keyword);
}

static lar_status check_complete(const vtk_file *file) {
    const lar_vtk_legacy *legacy = &file->legacy;
    const char *missing = !legacy->has_points ? "POINTS"
                          : !file->cells.end  ? "CELLS"
                          : !file->has_types  ? "CELL_TYPES"
                                              : NULL;
    if (missing)
        return lar_fail(legacy->error, LAR_ERROR_FORMAT,
                        "%s: the section %s is missing; the file is cut short, write it again",
                        legacy->path, missing);
    if (file->type_count != file->cells.count)
        return lar_fail(legacy->error, LAR_ERROR_FORMAT,
                        "%s: there are %" PRId64 " CELLS but %" PRId64
                        " CELL_TYPES; write the file again",
                        legacy->path, file->cells.count, file->type_count);
    return LAR_OK;
}

lar_status lar_vtk_parse(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                         lar_error *error) {
    vtk_file file = {.legacy = {.path = path, .error = error, .text = lar_text_from(bytes)}};
    lar_status status = lar_vtk_legacy_begin(&file.legacy);
    lar_span keyword;
    while (!status && lar_text_word(&file.legacy.text, &keyword))
        status = read_section(&file, keyword);
    if (!status) status = check_complete(&file);
    lar_vtk_grid_set_cells(&file.legacy.grid, &file.cells);
    if (!status) status = lar_vtk_grid_to_mesh(path, &file.legacy.grid, mesh, error);
    lar_vtk_grid_clear(&file.legacy.grid);
    return status;
}
