/* Surface nets: quadrilaterals between voxels of different region, and their relaxation.
 *
 *        a | b        One quadrilateral for each pair of neighbouring voxels that differ, its
 *        --+--        corners at corners of voxels, shared by all at that corner: conforming by
 *        a | c        construction, and the surface of each region is closed as that of each voxel.
 *
 * Edges at which three regions or more meet (also: two and a flat cut) form lines; corners on them
 * are smoothed along them only, so that lines stay lines. Where two voxels of one region meet in an
 * edge or a corner only, the quadrilaterals share its corners: there the surface touches itself.
 * It stays closed, for every edge is used as often in one direction as in the other.
 */
#ifndef LAR_MESHING_BOUNDARY_NETS_H
#define LAR_MESHING_BOUNDARY_NETS_H

#include "meshing/boundary/boundary.h"

/* Quadrilaterals of a segmentation are some millions at most; noise has hundreds. */
enum { LAR_NETS_QUADS_MAX = 1 << 24 };

typedef struct lar_nets {
    int32_t size[3];   /* corners of voxels along the axes: voxels + 1 */
    double spacing[3]; /* of the voxels, of any unit */
    int32_t vertex_count;
    int32_t (*start)[3];     /* which corner; half a voxel before the voxel of that index */
    double (*moved)[3];      /* way from there [voxels] */
    int32_t (*neighbour)[6]; /* -i, +i, -j, +j, -k, +k along edges of quadrilaterals; -1: none */
    uint8_t *line;           /* which of these edges are lines where regions meet, a bit each */
    uint8_t *thin; /* axes along which what it belongs to is one voxel thick, a bit each */
    int32_t quad_count;
    int32_t (*corner)[4];
    uint16_t (*side)[2]; /* the normal (in indices) points to side[0], the outside, a cut or the
                            smaller region */
    uint8_t *diagonal;   /* cut from corner 0 or 1 */
} lar_nets;

/* The nets of an image whose labels are those regions. */
lar_status lar_nets_create(const lar_image *image, const uint8_t *region_of_label, lar_nets *nets,
                           lar_error *error);
void lar_nets_clear(lar_nets *nets);

/* Smooths, chooses the diagonals, then moves surfaces along their normals until each region has the
 * volume [voxels, index by region] again, within 0.1 % where no corner has to leave 0.7 voxels
 * around its start for it, 0.25 where it is thin. */
lar_status lar_nets_relax(lar_nets *nets, int32_t region_count, const double *volume,
                          lar_error *error);

#endif
