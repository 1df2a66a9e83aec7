/* Reader for meshes in VTK XML files (.vtu). vtk_xml.c has the format, vtk_grid.c says what the
 * numbers mean. */
#include "model/format/mesh_io.h"

#include "model/format/vtk/vtk_grid.h"
#include "model/format/vtk/vtk_xml.h"

static lar_status read_cells(const lar_vtk_xml *file, xmlNode *piece, lar_vtk_grid *grid) {
    xmlNode *cells = lar_vtk_xml_child(piece, "Cells");
    lar_vtk_cells list = {.count = grid->cell_count};
    lar_status status = lar_vtk_xml_cells(file, cells, &list);
    lar_vtk_grid_set_cells(grid, &list);
    return status ? status
                  : lar_vtk_xml_integers(file, cells, "types", grid->cell_count, &grid->cell_type);
}

static lar_status read_piece(const lar_vtk_xml *file, xmlNode *dataset, xmlNode *piece,
                             lar_vtk_grid *grid) {
    lar_status status = lar_vtk_xml_count(file, piece, "NumberOfPoints", -1, &grid->point_count);
    if (!status) status = lar_vtk_xml_count(file, piece, "NumberOfCells", -1, &grid->cell_count);
    if (!status) status = lar_vtk_xml_points(file, piece, grid);
    if (!status) status = read_cells(file, piece, grid);
    if (!status)
        status = lar_vtk_xml_data(file, lar_vtk_xml_child(piece, "PointData"), LAR_VTK_POINT_DATA,
                                  grid->point_count, grid);
    if (!status)
        status = lar_vtk_xml_data(file, lar_vtk_xml_child(piece, "CellData"), LAR_VTK_CELL_DATA,
                                  grid->cell_count, grid);
    if (!status)
        status = lar_vtk_xml_data(file, lar_vtk_xml_child(dataset, "FieldData"), LAR_VTK_FIELD_DATA,
                                  -1, grid);
    return status;
}

lar_status lar_vtu_parse(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                         lar_error *error) {
    lar_vtk_xml file = {.path = path, .error = error};
    lar_vtk_grid grid = {0};
    xmlNode *dataset = NULL, *piece = NULL;
    lar_status status = lar_vtk_xml_open(&file, bytes, "UnstructuredGrid",
                                         "Lariat reads UnstructuredGrid; save the mesh as an "
                                         "unstructured grid (.vtu)",
                                         &dataset, &piece);
    if (!status) status = read_piece(&file, dataset, piece, &grid);
    if (!status) status = lar_vtk_grid_to_mesh(path, &grid, mesh, error);
    lar_vtk_grid_clear(&grid);
    lar_vtk_xml_close(&file);
    return status;
}
