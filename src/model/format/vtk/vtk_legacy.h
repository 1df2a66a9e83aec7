/* Legacy VTK files (.vtk), versions 2.0 to 5.1, ASCII and BINARY (big-endian).
 *
 *     # vtk DataFile Version 4.2          POINTS n type          values
 *     title                               CELLS n size           [8 a b c d e f g h] ... (to 4.2)
 *     ASCII | BINARY                      CELLS n+1 size         OFFSETS type, CONNECTIVITY type
 * (5) DATASET kind                        CELL_DATA n, POINT_DATA n, FIELD, SCALARS, ...
 *
 * The file is a chain of keywords, each followed by numbers whose amount the keyword's line says.
 * Data that is of no interest must still be walked over exactly. Which keywords there are besides
 * points and data depends on the kind: vtk.c has those of meshes, vtk_surface.c those of surfaces.
 */
#ifndef LAR_MODEL_FORMAT_VTK_VTK_LEGACY_H
#define LAR_MODEL_FORMAT_VTK_VTK_LEGACY_H

#include "base/text.h"
#include "model/format/vtk/vtk_grid.h"
#include "model/format/vtk/vtk_scalar.h"

typedef struct lar_vtk_legacy {
    const char *path;
    lar_error *error;
    lar_text text;
    bool binary;
    int64_t major; /* version */
    bool has_points;
    bool in_data; /* behind CELL_DATA or POINT_DATA */
    lar_vtk_place place;
    int64_t tuples;
    lar_vtk_grid grid; /* points and arrays are read into it */
} lar_vtk_legacy;

/* Reads the first three lines. */
lar_status lar_vtk_legacy_begin(lar_vtk_legacy *file);

/* What stands behind a keyword that all kinds have (POINTS, data); other keywords are refused. */
lar_status lar_vtk_legacy_section(lar_vtk_legacy *file, lar_span keyword);

/* The list of cells behind `keyword`, in the layout of the file's version. */
lar_status lar_vtk_legacy_cells(lar_vtk_legacy *file, const char *keyword, lar_vtk_cells *cells);

/* A number of things. */
bool lar_vtk_legacy_count(lar_vtk_legacy *file, int64_t *count);

/* `count` integers that begin on the next line; the caller frees. */
lar_status lar_vtk_legacy_integers(lar_vtk_legacy *file, int64_t count, int64_t **values);

lar_status lar_vtk_legacy_bad(const lar_vtk_legacy *file, const char *cause);

#endif
