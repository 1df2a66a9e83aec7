/* A mesh of eight-node hexahedra with named sets.
 *
 *            7--------6          local nodes 0..7 in VTK / Abaqus / Gmsh / FEBio order
 *           /|       /|          (all four agree), natural coordinates (xi, eta, zeta):
 *          4--------5 |
 *          | |      | |              0 (-,-,-)  1 (+,-,-)  2 (+,+,-)  3 (-,+,-)
 *   zeta   | 3------|-2              4 (-,-,+)  5 (+,-,+)  6 (+,+,+)  7 (-,+,+)
 *    | eta |/       |/
 *    |/    0--------1            local faces 0..5: xi-, xi+, eta-, eta+, zeta-, zeta+,
 *    +---xi                      corners counter-clockwise seen from outside (lar_face_node)
 *
 * Nodes and elements are addressed by index (0-based, file order, lar_gid); the file's own ids
 * are kept for messages and output.
 */
#ifndef LAR_MODEL_MESH_MESH_H
#define LAR_MODEL_MESH_MESH_H

#include <stdint.h>

#include "base/memory.h"

typedef int32_t lar_gid; /* node or element of the whole model */

/* Named sets that one mesh may have: they are looked up by walking the list. */
enum { LAR_MESH_SETS_MAX = 4096 };

typedef enum lar_set_kind { LAR_SET_NODES, LAR_SET_ELEMENTS, LAR_SET_FACES } lar_set_kind;

/* A named set. index[]: node indices, element indices, or faces as element * 6 + local face. No
 * index twice; ascending except for faces. */
typedef struct lar_set {
    char *name;
    lar_set_kind kind;
    int32_t count;
    int32_t *index;
} lar_set;

typedef struct lar_mesh {
    char *source; /* the file it came from, for messages */
    int32_t node_count;
    double (*position)[3]; /* metres after scaling */
    int64_t *node_id;      /* the file's ids */
    int32_t element_count;
    int32_t (*element)[8]; /* node indices */
    int64_t *element_id;   /* the file's ids */
    int *element_line;     /* where they stand, 0: nowhere; NULL: nobody knows (any more) */
    int32_t *element_tag;  /* the file's integer cell tag (physical group, label), 0 when none */
    double (*fibre)[3];  /* [element_count] along the fibres, of any length until the model has been
                            checked, then one; 0 where there are none. NULL: nobody said */
    double (*second)[3]; /* the same of a second family */
    int32_t set_count;
    lar_set *set;
    int32_t dropped_node_count; /* nodes of the file that no element uses and that were left out */

    /* Other solids of the file (tetrahedra, prisms, pyramids) stand among the elements as
     * hexahedra with a node more than once (lar_solid_corners). Only `lariat mesh` takes them, for
     * their faces; lar_mesh_check refuses them. */
    int32_t collapsed_count;
    const char *collapsed_name; /* what the first of them is, static */
    int64_t collapsed_id;
    int collapsed_line; /* 0: the format has none */

    int32_t sparse_ranges; /* ranges of numbers in sets of which some do not exist (Abaqus) */
    int sparse_line;       /* of the first */

    bool turned; /* all elements were left-handed in the file (lar_mesh_turn) */
} lar_mesh;

/* Which corner of a solid with so many corners (4 tetrahedron, 5 pyramid, 6 prism) is each node of
 * the hexahedron that stands for it; NULL: there is no such solid. A face of it has one corner
 * twice where it is a triangle, and two at most where it is none. */
const uint8_t *lar_solid_corners(int corners);

/* Corners of local face f, counter-clockwise seen from outside. */
extern const uint8_t lar_face_node[6][4];
/* Ends of the twelve edges. */
extern const uint8_t lar_edge_node[12][2];
/* Signs of the natural coordinates of local node a. */
extern const int8_t lar_node_sign[8][3];

/* Zeroed arrays of a mesh that is not there yet, and its source; counts stay as they are. Clear it
 * also after a failure. */
lar_status lar_mesh_allocate(lar_mesh *mesh, const char *source, size_t nodes, size_t elements,
                             lar_error *error);

/* Frees what the mesh owns and zeroes it; a zeroed mesh is fine. */
void lar_mesh_clear(lar_mesh *mesh);

/* The set of that name and kind, or NULL. */
const lar_set *lar_mesh_find_set(const lar_mesh *mesh, const char *name, lar_set_kind kind);

/* Appends a set; takes ownership of `index` (also on failure), copies `name`. Sorts node and
 * element sets and removes repeats. A set of the same name and kind is an error. */
lar_status lar_mesh_add_set(lar_mesh *mesh, const char *name, lar_set_kind kind, int32_t *index,
                            int32_t count, lar_error *error);

/* A mesh whose elements are all left-handed numbers them the other way round: nodes 1-4 and 5-8 of
 * every element, and its faces in sets, change places, and mesh->turned is set. Others stay. */
void lar_mesh_turn(lar_mesh *mesh);

/* Nodes at the place of another one, to a millionth of the mean edge, or half the shortest where
 * that is less: what meets there is not connected. *leader, when not NULL, becomes the first node
 * at each one's place, [node_count]; the caller frees it. */
lar_status lar_mesh_doubled_nodes(const lar_mesh *mesh, int32_t *doubled, int32_t **leader,
                                  lar_error *error);

/* Everything that must hold before a mesh can be simulated: finite coordinates; no node twice in
 * an element; every element right-handed with a positive Jacobian at its eight corners and a
 * volume that is not zero; no two elements with the same nodes. The message names file, element
 * id and remedy. Called by lar_mesh_read after every reader. */
lar_status lar_mesh_check(const lar_mesh *mesh, lar_error *error);

/* What must hold before the faces of a mesh of any solids can be taken: elements, and finite
 * coordinates. */
lar_status lar_mesh_check_solids(const lar_mesh *mesh, lar_error *error);

/* The boundary of the mesh: faces that belong to one element only, as element * 6 + face,
 * ascending. The caller frees *faces. */
lar_status lar_mesh_boundary(const lar_mesh *mesh, int32_t **faces, int32_t *count,
                             lar_error *error);

/* Scaled Jacobian: the smallest, over the corners, of the determinant of the three normalised
 * edges (Knupp 2000). 1 for a box, <= 0 for a bad element. corner[a] is the position of node a. */
double lar_scaled_jacobian(const double corner[8][3]);

/* Volume of the trilinear hexahedron, exact. */
double lar_hexahedron_volume(const double corner[8][3]);

/* Mean length of the elements' edges [m], each counted as often as elements have it. */
double lar_mesh_mean_edge(const lar_mesh *mesh);

/* Bodies, the parts of a mesh that hang together: body[n] becomes the least node of n's. */
void lar_mesh_bodies(const lar_mesh *mesh, int32_t *body);

/* Copies the corners of element e. */
void lar_mesh_corners(const lar_mesh *mesh, int32_t e, double corner[8][3]);

#endif
