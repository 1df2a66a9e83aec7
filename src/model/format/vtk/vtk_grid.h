/* An unstructured grid as VTK files say it, and the one place where it becomes a lar_mesh.
 *
 *     .vtu (vtu.c, vtu_array.c) ---+
 *                                  +--> lar_vtk_grid --> lar_vtk_grid_to_mesh --> lar_mesh
 *     .vtk (vtk.c) ----------------+
 *
 * The readers only bring numbers into memory, in the file's own order. What the cells mean is
 * decided here, once for both formats:
 *   - VTK_HEXAHEDRON (12) and VTK_VOXEL (11, its corners put into hexahedron order) become
 *     elements, tetrahedra, wedges and pyramids of any order collapsed ones (lar_mesh); points,
 *     lines and surface cells beside them are passed over; any other solid cell is refused by name;
 *   - ids are the 0-based indices in the file, as ParaView shows them (cells that are passed over
 *     count too);
 *   - points that no element uses are dropped, so that every node has mass;
 *   - the first of the well-known integer cell arrays (lar_vtk_wants) is the element tag;
 *   - the cell array "fibre" of three components says along what fibres run, "fibre2" those of a
 *     second family;
 *   - named sets: field arrays "set:nodes:NAME", "set:elements:NAME" and "set:faces:NAME" hold
 *     0-based point indices, cell indices and cell * 6 + face (lar_mesh's face order); integer
 *     point and cell arrays "set_NAME" of zeros and ones are sets as well.
 */
#ifndef LAR_MODEL_FORMAT_VTK_VTK_GRID_H
#define LAR_MODEL_FORMAT_VTK_VTK_GRID_H

#include "model/mesh/mesh.h"

typedef enum lar_vtk_place {
    LAR_VTK_POINT_DATA,
    LAR_VTK_CELL_DATA,
    LAR_VTK_FIELD_DATA
} lar_vtk_place;

/* An integer array that may be a tag or a set; one component. */
typedef struct lar_vtk_integers {
    char *name;
    lar_vtk_place place;
    int64_t count;
    int64_t *value;
} lar_vtk_integers;

/* A list of cells; everything owned, a zeroed one is fine. */
typedef struct lar_vtk_cells {
    int64_t count;
    int64_t *end; /* [count]: where the corners of a cell end in `corner`; NULL: no list */
    int64_t corner_count;
    int64_t *corner; /* point indices */
} lar_vtk_cells;

void lar_vtk_cells_clear(lar_vtk_cells *cells);

/* Everything owned; a zeroed grid is fine. */
typedef struct lar_vtk_grid {
    int64_t point_count;
    double (*point)[3];
    int64_t cell_count;
    int64_t *cell_end; /* [cell_count]: where the corners of a cell end in `corner` */
    int64_t *cell_type;
    int64_t corner_count;
    int64_t *corner;  /* point indices */
    double *fibre[2]; /* [cell_count][3] along fibres of both families, NULL: nobody says */
    size_t array_count, array_capacity;
    lar_vtk_integers *array;
} lar_vtk_grid;

void lar_vtk_grid_clear(lar_vtk_grid *grid);

/* Moves the list into the grid, which had none. */
void lar_vtk_grid_set_cells(lar_vtk_grid *grid, lar_vtk_cells *cells);

/* Whether an integer array of that name in that place says something about the mesh. */
bool lar_vtk_wants(lar_vtk_place place, const char *name);

/* Of which family of fibres a cell array of three components is; -1: of none. */
int lar_vtk_family(lar_vtk_place place, const char *name);

/* The array of cell tags, or NULL when there is none. */
const lar_vtk_integers *lar_vtk_grid_tags(const lar_vtk_grid *grid);

/* Appends an array; copies `name`, takes ownership of `value` (also on failure). */
lar_status lar_vtk_grid_add(lar_vtk_grid *grid, lar_vtk_place place, const char *name,
                            int64_t *value, int64_t count, lar_error *error);

/* Fills the zeroed *mesh; takes the points out of the grid. Checks every number of the grid. */
lar_status lar_vtk_grid_to_mesh(const char *path, lar_vtk_grid *grid, lar_mesh *mesh,
                                lar_error *error);

/* Set names in array names: bytes that XML or legacy headers cannot carry are written %XX. Both
 * return a new string, NULL without memory. Decoding leaves a % that begins no %XX alone. */
char *lar_vtk_encode_name(const char *prefix, const char *name);
char *lar_vtk_decode_name(const char *name, size_t length);

/* Prefixes of the field arrays above, by lar_set_kind. */
extern const char *const lar_vtk_set_prefix[3];

#endif
