/* Reader for surfaces in VTK XML files (.vtp). vtk_xml.c has the format; the cells become triangles
 * in vtk_polydata.c. */
#include "model/format/vtk/vtk_polydata.h"
#include "model/format/vtk/vtk_xml.h"

static const struct {
    const char *element, *count;
} lists[LAR_VTK_LISTS] = {[LAR_VTK_VERTS] = {"Verts", "NumberOfVerts"},
                          [LAR_VTK_LINES] = {"Lines", "NumberOfLines"},
                          [LAR_VTK_POLYS] = {"Polys", "NumberOfPolys"},
                          [LAR_VTK_STRIPS] = {"Strips", "NumberOfStrips"}};

static lar_status read_piece(const lar_vtk_xml *file, xmlNode *piece, lar_vtk_grid *grid,
                             lar_vtk_cells list[LAR_VTK_LISTS]) {
    int64_t cells = 0;
    lar_status status = lar_vtk_xml_count(file, piece, "NumberOfPoints", -1, &grid->point_count);
    if (!status) status = lar_vtk_xml_points(file, piece, grid);
    for (int k = 0; k < LAR_VTK_LISTS && !status; k++) {
        status = lar_vtk_xml_count(file, piece, lists[k].count, 0, &list[k].count);
        if (!status && k >= LAR_VTK_POLYS && list[k].count > 0)
            status = lar_vtk_xml_cells(file, lar_vtk_xml_child(piece, lists[k].element), &list[k]);
        if (!status) cells += list[k].count;
    }
    if (!status)
        status = lar_vtk_xml_data(file, lar_vtk_xml_child(piece, "CellData"), LAR_VTK_CELL_DATA,
                                  cells, grid);
    return status;
}

lar_status lar_vtp_parse(const char *path, const lar_bytes *bytes, lar_triangles *triangles,
                         lar_error *error) {
    lar_vtk_xml file = {.path = path, .error = error};
    lar_vtk_grid grid = {0};
    lar_vtk_cells list[LAR_VTK_LISTS] = {0};
    xmlNode *dataset = NULL, *piece = NULL;
    lar_status status = lar_vtk_xml_open(&file, bytes, "PolyData",
                                         "a surface is PolyData; save it as .vtp (ParaView: "
                                         "Extract Surface)",
                                         &dataset, &piece);
    if (!status) status = read_piece(&file, piece, &grid, list);
    if (!status) status = lar_vtk_polydata_to_triangles(path, &grid, list, triangles, error);
    for (int k = 0; k < LAR_VTK_LISTS; k++) lar_vtk_cells_clear(&list[k]);
    lar_vtk_grid_clear(&grid);
    lar_vtk_xml_close(&file);
    return status;
}
