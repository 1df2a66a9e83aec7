/* Mesh files in and out.
 *
 * One row per format: extension, a check of the first bytes, the reader. A reader gets the whole
 * file in memory (bounded by its real size) and never trusts a count before lar_claim_fits.
 * Tetrahedra, prisms and pyramids it takes as collapsed hexahedra (lar_mesh), other cells it
 * refuses with a sentence that says what to do. It fills
 * a zeroed lar_mesh; on failure the caller clears it.
 */
#ifndef LAR_MODEL_FORMAT_MESH_IO_H
#define LAR_MODEL_FORMAT_MESH_IO_H

#include "model/mesh/mesh.h"

/* Reads a mesh by the extension of `path` (.vtu .vtk .msh .inp .feb), turns it where it is
 * left-handed throughout, checks it with lar_mesh_check. Positions as in the file (no unit is known
 * there); `scale` multiplies them. */
lar_status lar_mesh_read(const char *path, double scale, lar_mesh *mesh, lar_error *error);

/* The same for a mesh of any solids, whose faces are wanted: lar_mesh_check_solids. */
lar_status lar_mesh_read_solids(const char *path, double scale, lar_mesh *mesh, lar_error *error);

/* True when the path's extension is one of a mesh; a .vtk, which may be a surface as well, must
 * hold an unstructured grid. */
bool lar_mesh_named(const char *path);

/* The readers, also entry points for fuzzing. `path` is for messages only. */
lar_status lar_vtu_parse(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                         lar_error *error);
lar_status lar_vtk_parse(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                         lar_error *error);
lar_status lar_msh_parse(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                         lar_error *error);
lar_status lar_inp_parse(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                         lar_error *error);
lar_status lar_feb_parse_mesh(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                              lar_error *error);

/* One array of results for lar_vtu_write: values[count][components]. */
typedef struct lar_vtu_array {
    const char *name;
    int components;
    const double *values;
} lar_vtu_array;

typedef struct lar_vtu_frame {
    const lar_mesh *mesh;
    const double (*position)[3]; /* points to write; NULL: the mesh's own */
    const lar_vtu_array *point_array;
    int point_array_count;
    const lar_vtu_array *cell_array;
    int cell_array_count;
    double time; /* written as TimeValue field data */
} lar_vtu_frame;

/* Writes a .vtu (appended raw, zlib): to PATH.part first, then renamed, so that a full disk or a
 * kill leaves no half file under the final name. The mesh's element tags go along as the integer
 * cell array "tag", what its fibres run along as "fibre", its named sets as field arrays that
 * lar_vtu_parse reads back. */
lar_status lar_vtu_write(const char *path, const lar_vtu_frame *frame, lar_error *error);

/* Writes a .pvd collection of `count` frames: file names relative to it, and times. */
lar_status lar_pvd_write(const char *path, const char *const *files, const double *times, int count,
                         lar_error *error);

#endif
