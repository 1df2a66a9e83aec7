/* Collects what id-based formats (Gmsh, Abaqus, FEBio) say, in any order, and turns ids into
 * indices at the end.
 *
 * A reader adds nodes, hexahedra and sets as it meets them; sets may name ids that come later in
 * the file. lar_mesh_builder_finish resolves ids, refuses duplicates and unknown ids by name, and
 * drops nodes that no element uses (their number is reported, formats such as Gmsh list them), so
 * that every node has mass.
 */
#ifndef LAR_MODEL_MESH_BUILDER_H
#define LAR_MODEL_MESH_BUILDER_H

#include "model/mesh/mesh.h"

typedef struct lar_mesh_builder lar_mesh_builder;

lar_mesh_builder *lar_mesh_builder_create(const char *source); /* NULL: no memory */
void lar_mesh_builder_destroy(lar_mesh_builder *builder);

/* `line` is where the entry stands in the file, for messages; 0 when it has no line. Duplicate
 * ids are found at the end. */
lar_status lar_mesh_builder_node(lar_mesh_builder *builder, int64_t id, const double position[3],
                                 int line, lar_error *error);
lar_status lar_mesh_builder_hexahedron(lar_mesh_builder *builder, int64_t id, int32_t tag,
                                       const int64_t node_ids[8], int line, lar_error *error);

/* Another solid, by its first corners (lar_solid_corners); `name` says what it is, and is static.
 */
lar_status lar_mesh_builder_solid(lar_mesh_builder *builder, int64_t id, int32_t tag,
                                  const char *name, int corners, const int64_t *node_ids, int line,
                                  lar_error *error);
bool lar_mesh_builder_has_solids(const lar_mesh_builder *builder);

/* Opens the set of that name and kind (made when new, extended when there) for the adds below. */
lar_status lar_mesh_builder_set(lar_mesh_builder *builder, const char *name, lar_set_kind kind,
                                lar_error *error);
/* Adds to the open set: a node or element by id, */
lar_status lar_mesh_builder_set_id(lar_mesh_builder *builder, int64_t id, int line,
                                   lar_error *error);
/* all nodes of an element, in a set of nodes, */
lar_status lar_mesh_builder_set_corners(lar_mesh_builder *builder, int64_t element_id, int line,
                                        lar_error *error);
/* a face by element id and local face 0..5, */
lar_status lar_mesh_builder_set_face(lar_mesh_builder *builder, int64_t element_id, int face,
                                     int line, lar_error *error);
/* or a face by its four corner node ids in any order (it must be a face of an element). */
lar_status lar_mesh_builder_set_quad(lar_mesh_builder *builder, const int64_t node_ids[4], int line,
                                     lar_error *error);

/* Moves everything into *mesh (zeroed before). A set of nodes of which some were dropped keeps
 * the others; among other solids a set of faces keeps those that it finds. */
lar_status lar_mesh_builder_finish(lar_mesh_builder *builder, lar_mesh *mesh, lar_error *error);

#endif
