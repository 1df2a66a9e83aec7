/* The order of elements and nodes in memory: what decides how fast a step can be.
 *
 * Elements are threaded into ROWS through opposite faces, as in a brick of cells:
 *
 *       n0---n1---n2---n3---n4---n5---n6---n7---n8      one of the four lines of nodes
 *       |  0 |  1 |  2 |  3 |  4 |  5 |  6 |  7 |       eight elements, xi to the right
 *       +----+----+----+----+----+----+----+----+
 *
 * and the nodes of a row's four lines get consecutive numbers, beginning with an even one. A block
 * of such a row then reads and writes 36 nodes as a few whole vectors where loose elements touch
 * 64 nodes one by one (mechanics/hex8_block.h). The last lane may be without an element: a row of
 * seven. Rows are looked for along all three directions of every element (row_plan.h), starting
 * along a Z curve (Morton 1966) so that neighbours in space stay neighbours in memory; what is left
 * over goes into loose blocks. Several ways of looking are tried and the one whose blocks cost
 * least is kept. Any hexahedral mesh has such rows; meshes swept or voxelised from organs consist
 * of little else.
 *
 * An element in a row is turned so that its xi runs along the row. The turn is decided from the
 * whole model, not from one domain, because the last bits of an element's forces depend on it.
 */
#ifndef LAR_LAYOUT_LAYOUT_H
#define LAR_LAYOUT_LAYOUT_H

#include "mechanics/hex8_block.h"
#include "model/model.h"

typedef int32_t lar_lid; /* node of one domain */

enum { LAR_LAYOUT_THREADS = 16 }; /* that may share a layout */

/* Eight lanes that one block will hold. */
typedef struct lar_lanes {
    lar_law law;
    lar_block_shape shape;
    lar_block_rows rows;
    int turn;                   /* of boxes (mechanics/hex8_block.h) */
    int viscous;                /* lar_viscosity_kind; 0: elastic */
    int fibrous;                /* lar_fibre_kind; 0: no fibres */
    int32_t thread, batch;      /* who recovers it, and with which batch; 0 in a whole layout */
    lar_gid element[LAR_BLOCK]; /* by lane; -1: none */
} lar_lanes;

typedef struct lar_layout {
    lar_gid (*corner)[8]; /* [elements of the model] nodes, turned along the row */
    bool corner_lent;     /* `corner` belongs to the whole layout (part_layout.h) */
    int32_t block_count;
    lar_lanes *block;   /* sorted by thread and batch; then equal law, viscosity, fibres,
                           shape, turn, rows */
    int32_t node_count; /* local nodes, spare ones among them, without the padding at the end */
    int32_t
        node_padded;    /* a multiple of LAR_NODES_TOGETHER, with a spare node at the end or more */
    size_t axis_stride; /* of vectors of all nodes (mechanics/axes.h) */
    lar_gid *global;    /* [node_padded] node of the model, -1: spare */
    lar_lid *local;     /* [nodes of the model], -1: not in this layout */
    int32_t thread_count;
    /* Nodes first_node[t] .. first_node[t + 1] - 1 are moved by thread t, the last one or more of
     * them spare; all multiples of LAR_NODES_TOGETHER; node_padded from thread_count on. */
    lar_lid first_node[LAR_LAYOUT_THREADS + 1];
} lar_layout;

typedef enum lar_layout_style {
    LAR_LAYOUT_ROWS,
    LAR_LAYOUT_LOOSE /* the same turned elements, but in loose general blocks: for comparison */
} lar_layout_style;

/* Lays out a whole model; the caller destroys the layout. Fails for want of memory, and for models
 * whose nodes or elements 32-bit offsets cannot number. The mesh must have passed lar_mesh_check.
 * The second takes rows apart again on request. */
lar_status lar_layout_create(const lar_model *model, lar_layout *layout, lar_error *error);
lar_status lar_layout_create_styled(const lar_model *model, lar_layout_style style,
                                    lar_layout *layout, lar_error *error);
void lar_layout_destroy(lar_layout *layout); /* idempotent */

/* Which corner of the mesh's element e each of its corners here is: four bits each, the first one
 * lowest. */
uint32_t lar_layout_turn(const lar_layout *layout, const lar_mesh *mesh, lar_gid e);

#endif
