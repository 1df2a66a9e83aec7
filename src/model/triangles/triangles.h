/* A surface of triangles: what scans and modelling programs give, and what people see.
 *
 *     .stl .obj .vtk .vtp --> lar_triangles --> the true boundary that meshing fits
 * (meshing/boundary/boundary.h)
 *                                          '--> the embedded surface of a mesh
 * (model/triangles/embedded_surface.h)
 *
 * Positions are in metres after scaling. Corners stand counter-clockwise seen from outside.
 */
#ifndef LAR_MODEL_TRIANGLES_TRIANGLES_H
#define LAR_MODEL_TRIANGLES_TRIANGLES_H

#include <stdint.h>

#include "base/memory.h"

typedef struct lar_triangles {
    char *source; /* the file it came from, for messages */
    int32_t vertex_count;
    double (*vertex)[3]; /* [vertex_count] */
    int32_t triangle_count;
    int32_t (*corner)[3]; /* [triangle_count] vertex indices */
    int32_t *tag;         /* [triangle_count] an integer per triangle, or NULL: all 0 */
} lar_triangles;

/* Frees what it owns and zeroes it; a zeroed one is fine. */
void lar_triangles_clear(lar_triangles *triangles);

/* Reads a surface by the extension of `path`: .stl (ascii and binary), .obj, .vtk (legacy PolyData,
 * ascii and binary), .vtp. Polygons are cut into triangles; corners at exactly one place become one
 * vertex; triangles without area (a corner twice) are left out. `triangles` is zeroed before; on
 * failure it is cleared. Volume meshes (.vtk with cells) are refused by name. */
lar_status lar_triangles_read(const char *path, double scale, lar_triangles *triangles,
                              lar_error *error);

/* What makes a surface of vertices and triangles that come from anywhere: places in metres, equal
 * ones joined, a name for messages. LAR_ERROR_FORMAT where nothing with an area is left. */
lar_status lar_triangles_settle(lar_triangles *triangles, const char *name, double scale,
                                lar_error *error);

/* True when the path's extension is one of a surface. */
bool lar_triangles_named(const char *path);

/* The readers, also entry points for fuzzing; `path` is for messages only. On failure the caller
 * clears. Vertices are not yet joined (lar_triangles_join). */
lar_status lar_stl_parse(const char *path, const lar_bytes *bytes, lar_triangles *triangles,
                         lar_error *error);
lar_status lar_obj_parse(const char *path, const lar_bytes *bytes, lar_triangles *triangles,
                         lar_error *error);
lar_status lar_vtk_surface_parse(const char *path, const lar_bytes *bytes, lar_triangles *triangles,
                                 lar_error *error);
lar_status lar_vtp_parse(const char *path, const lar_bytes *bytes, lar_triangles *triangles,
                         lar_error *error);

/* Joins vertices at equal places, leaves out triangles without area and vertices without a
 * triangle. */
lar_status lar_triangles_join(lar_triangles *triangles, lar_error *error);

/* Writes a .vtp, whole or not at all (as lar_vtu_write); the tags go along as cell array "tag". */
lar_status lar_vtp_write(const char *path, const lar_triangles *triangles, lar_error *error);

/* The same for one frame of many: places in single precision, compressed more. */
lar_status lar_vtp_write_small(const char *path, const lar_triangles *triangles, lar_error *error);

/* Twice the area times the unit normal of a triangle. */
void lar_triangles_normal(const lar_triangles *triangles, int32_t triangle, double normal[3]);

/* The middle of one of the cuts * cuts equal parts, counted from 0, into which lines parallel to
 * its sides cut a triangle. */
void lar_triangles_part(const lar_triangles *triangles, int32_t triangle, int cuts, int part,
                        double middle[3]);

/* Enclosed volume, positive when the corners stand counter-clockwise seen from outside; area. */
double lar_triangles_volume(const lar_triangles *triangles);
double lar_triangles_area(const lar_triangles *triangles);

/* Closed: every edge is used as often in one direction as in the other, which is what counting
 * crossings along a line needs. LAR_ERROR_MODEL otherwise; the message names the number of open
 * edges and the place of one.
 *
 * Triangles that are turned against their neighbours are turned back. Then each shell that lies in
 * no other one is turned, with all within it, when its volume is negative; the shells within keep
 * their direction against it (a hollow stays a hollow). *turned counts the triangles that are
 * turned in the end (may be NULL). Inside is where the surface goes around at least once: a shell
 * in another one that looks the same way bounds nothing, and its triangles are left out. */
lar_status lar_triangles_close(lar_triangles *triangles, int32_t *turned, lar_error *error);

/* Triangles that go through each other. The depth of a pair is how far one of the two must be moved
 * to be free of the other; touching is no crossing, but lying on each other and looking the same
 * way is. Neighbours with a common edge are not looked
 * at. Shallow: up to LAR_CROSSING_HARMLESS of the mean edge, as rounding and smoothing leave them;
 * they tell neither an inside from an outside wrongly nor show on any element. */
#define LAR_CROSSING_HARMLESS 0.01
enum { LAR_CROSSINGS_MAX = 10000 }; /* deep ones; looking ends there */

typedef struct lar_crossings {
    int32_t shallow, deep; /* pairs */
    double deepest;        /* [m]; 0: there is none */
    int32_t pair[2];       /* the triangles of the deepest one */
} lar_crossings;

/* The depth of two triangles, given by their corners from an origin near them; 0: they do not go
 * through each other, or only as much as rounding makes of touching. With a `gap` above 0: how much
 * nearer they are than that; it may find them nearer than they are where they lie askew. */
double lar_triangle_overlap(const double a[3][3], const double b[3][3], double gap);

lar_status lar_triangles_find_crossings(const lar_triangles *triangles, lar_crossings *crossings,
                                        lar_error *error);

/* LAR_ERROR_MODEL when there are deep crossings. The message names their number and the place of
 * the deepest. */
lar_status lar_triangles_check_crossing(const lar_triangles *triangles, lar_error *error);

#endif
