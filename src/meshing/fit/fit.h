/* From cubes on a grid to hexahedra on the true boundary.
 *
 * The unfitted mesh is valid as it stands: every cell a cube. Fitting never leaves validity: a node
 * moves only where the elements around it stay good, so there is nothing to untangle.
 */
#ifndef LAR_MESHING_FIT_FIT_H
#define LAR_MESHING_FIT_FIT_H

#include "meshing/grid/voxel_grid.h"
#include "model/mesh/mesh.h"

/* A mesh on the grid, and what meets at each of its nodes. */
typedef struct lar_unfitted_mesh {
    lar_mesh mesh;       /* element_tag = region number until lar_unfitted_finish */
    double size;         /* edge of a cell [m] */
    int32_t (*point)[3]; /* per node: its point of the grid. Nodes are numbered in the grid's order,
                            first along the first axis */
    int32_t *meet_start; /* [nodes + 1] into meet */
    uint16_t (*meet)[2]; /* pairs (a, b), a < b, of regions (0 outside, cuts by number) between
                            which a face of the mesh lies that has this node; none: the node is
                            inside a region */
    int32_t (*slot)[4];  /* corners of cells outside of which an edge goes over to another side of
                            the body: the ends of three edges, right-handed, and the corner */
    int32_t slot_count;
} lar_unfitted_mesh;

lar_status lar_unfitted_create(const lar_voxel_grid *voxel_grid, const lar_boundary *boundary,
                               lar_unfitted_mesh *unfitted, lar_error *error);
void lar_unfitted_clear(lar_unfitted_mesh *unfitted);

/* Told now and then how far it is, 0..1; false asks to stop (LAR_ERROR_ARGUMENT, "stopped"). */
typedef bool lar_fit_progress(void *context, double part);

typedef struct lar_fit_options {
    double floor;          /* no element's scaled Jacobian falls below; 0: 0.25 */
    double aim;            /* nine of ten elements shall be above; 0: 0.55 */
    const double *dropped; /* [regions + 1; m3] of a region's volume what the mesh has nothing of,
                              below zero for hollows that it fills: outer faces would make up for
                              it otherwise. May be NULL */
    lar_fit_progress *progress; /* may be NULL */
    void *context;
} lar_fit_options;

/* Moves the unfitted mesh's nodes: those where regions meet to the true boundary, all others so
 * that the elements are good and each region keeps its volume. `options` may be NULL. The same
 * input gives the same bits. On failure the unfitted mesh is as it was. */
lar_status lar_fit(const lar_boundary *boundary, lar_unfitted_mesh *unfitted,
                   const lar_fit_options *options, lar_error *error);

/* Cell tags become those of the regions; named sets are added: faces "surface" (all outer faces),
 * "NAME_surface" per region when there are several (its outer faces), "A_B" per interface as faces
 * of A, "cut_left" ... per flat cut; elements "NAME" per region. Names are made of letters, digits
 * and "_". With `added` (not NULL) regions become bodies of their own (grid/part_regions.h). Moves
 * the mesh out. */
lar_status lar_unfitted_finish(lar_unfitted_mesh *unfitted, const lar_boundary *boundary,
                               int32_t *added, lar_mesh *mesh, lar_error *error);

#endif
