/* The true boundary of what is to be meshed: triangles that know what lies on both sides.
 *
 *     label image --image.c---------.
 *     closed surfaces --boundary.c--+--> lar_boundary --> grid, fit, deviation, embedded surface
 *     mesh of solids --mesh.c-------'
 *
 * Regions are numbered from 1, in the order they were asked for; 0 is outside. Where the image ends
 * in the middle of an organ the organ is cut off flat: what lies beyond counts as outside, but has
 * a number of its own per side of the image, LAR_REGION_CUT + 0..5, so that the edge of the cut
 * stays sharp and the cut can be named.
 *
 * Image: multi-label surface nets (Gibson 1998; Frisken 2022): one quadrilateral for each pair of
 * neighbouring voxels with different regions, corners first at the corners of voxels, then smoothed
 * within 0.7 voxel around their start (0.25 where a part is one voxel thick), then moved along the
 * normals until each region has again the volume of its voxels. Corners on a flat cut stay in its
 * plane, those on a line where three regions meet on a line. nets.h.
 */
#ifndef LAR_MESHING_BOUNDARY_BOUNDARY_H
#define LAR_MESHING_BOUNDARY_BOUNDARY_H

#include "meshing/image/image.h"
#include "model/triangles/triangles.h"

enum {
    LAR_REGIONS_MAX = 255,
    LAR_REGION_CUT = 256, /* .. LAR_REGION_CUT + 5: low i, high i, low j, high j, low k, high k */
    LAR_CUTS = 6
};

typedef struct lar_region {
    char *name;
    int32_t tag;   /* cell tag: the image's label, or 1, 2, ... for surfaces */
    double volume; /* of its voxels, or inside its surface and no later one [m^3]; exact, but where
                      surfaces overlap sampled on 1,024 x 1,024 lines */
} lar_region;

typedef struct lar_cut {
    double through[3], normal[3]; /* the plane, normal out of the image */
    char name[16];                /* "left", "right", "back", "front", "bottom", "top": the world's
                                     side that the normal points to most */
} lar_cut;

typedef struct lar_boundary {
    lar_triangles triangles;
    uint16_t (*side)[2]; /* [triangle_count] region where the normal points, region behind it */
    int32_t region_count;
    lar_region *region; /* [region_count + 1]; 0: outside, unused */
    bool nested;        /* surfaces, that may lie in each other: where several hold a place the last
                           one has it. A surface's triangles have side {0, its region} whatever is
                           around. False for images: every place has one region. */
    uint8_t *region_of_label; /* [LAR_IMAGE_LABEL_MAX + 1] of an image, 0: not asked for; NULL for
                                 surfaces */
    int32_t cut_count; /* flat cuts that exist; cut[] is indexed by side 0..5, name "" where none */
    lar_cut cut[LAR_CUTS];
    double axis[3][3]; /* rows: directions of the image's axes, made orthogonal, right-handed; the
                          world's axes for surfaces */
} lar_boundary;

void lar_boundary_clear(lar_boundary *boundary);

/* The region on a side: beyond a cut it is the outside. */
static inline int lar_boundary_region(uint16_t side) {
    return side >= LAR_REGION_CUT ? 0 : side;
}

/* What is asked for of an image: labels (NULL: all that there are), each a region; or all in one.
 */
typedef struct lar_label_choice {
    int32_t count;
    const char *const *word; /* numbers or names */
    bool fuse;               /* all chosen labels become one region */
} lar_label_choice;

/* LAR_ERROR_MODEL when a label that is asked for is unknown, has no voxel or less than eight, when
 * none is left, or there are more than LAR_REGIONS_MAX. Labels of a few voxels among all stay:
 * they get the elements that they fill, which may be none. */
lar_status lar_boundary_from_image(const lar_image *image, const lar_label_choice *choice,
                                   lar_boundary *boundary, lar_error *error);

/* `count` surfaces (each taken over, also on failure), closed and free of crossings, names[i] its
 * region's name. */
lar_status lar_boundary_from_surfaces(lar_triangles *surfaces, const char *const *names,
                                      int32_t count, lar_boundary *boundary, lar_error *error);

/* The mesh (.msh .vtu .vtk .inp .feb) of any solids: each tag a region, called as the set that
 * holds just its elements, or `title` when there is one region only; `fuse`: one region in all.
 * Nodes at one place become one, *joined counts them. `scale`: metres per unit of the file. */
lar_status lar_boundary_from_mesh(const char *path, double scale, bool fuse, const char *title,
                                  lar_boundary *boundary, int32_t *joined, lar_error *error);

/* The principal axes of the enclosed body (largest extent first), into boundary->axis. */
lar_status lar_boundary_principal_axes(lar_boundary *boundary, lar_error *error);

/* What is seen from outside: triangles whose front is outside or a cut, tag = tag of the region
 * behind; for the embedded surface. Of nested surfaces those that no other one
 * holds. */
lar_status lar_boundary_outer(const lar_boundary *boundary, lar_triangles *outer, lar_error *error);

/* True when triangle t belongs to the interface between regions a and b (a cut's number counts as a
 * region): the surface that mesh faces between elements of a and b shall lie on. */
bool lar_boundary_between(const lar_boundary *boundary, int32_t t, int a, int b);

#endif
