/* Planes of symmetry: half of a body that is held across the plane where the model ends is the
 * whole one. What lies in that plane is no surface, and its rim no edge: with these faces nodes in
 * the plane would be on the surface of what they are deep in, and springs of the others would be
 * softer for sharing their corners with them. */
#ifndef LAR_CONTACT_SEARCH_SYMMETRY_H
#define LAR_CONTACT_SEARCH_SYMMETRY_H

#include <stdbool.h>

#include "model/model.h"

typedef struct lar_symmetry {
    double end[6]; /* of all faces: least along each axis, then most [m] */
    bool cut[6];   /* the model goes on beyond as its mirror image */
} lar_symmetry;

/* A face in such a plane is held across it, and not glued there, held along all axes. Fails only
 * for want of memory. */
lar_status lar_symmetry_find(const lar_model *model, lar_symmetry *symmetry, lar_error *error);

/* Whether a face of the model's surface lies in one of these planes, whatever holds it. */
bool lar_symmetry_cuts(const lar_symmetry *symmetry, const lar_model *model, int32_t face);

/* The same; then moves the ends of its body there. */
bool lar_symmetry_ends(const lar_symmetry *symmetry, const lar_model *model, int32_t face,
                       double from[3], double to[3]);

#endif
