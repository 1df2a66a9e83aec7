/* Tissue in a tube: where the tube is, and what profile the tissue has in it (T 1.3.1).
 *
 *           |      |        axis, out of the tissue
 *           | .--. |
 *     ------|/ z  \|------  z(r): height over the plane of the origin, which is the tube's rim
 *              r->          r: distance from the axis
 *
 * The tissue in the tube are the faces of one pressure of the scene. What the tube's rim holds the
 * scene says with `fix`, for the vacuum keeps tissue and rim together (T 1.3.1).
 *
 * A profile is read from the nodes of these faces: a parabola by least squares through the heights
 * of those within a window around r, the nearer ones counting more (moving least squares: Lancaster
 * and Salkauskas, Mathematics of Computation 37:141, 1981). Nodes count on both sides of the axis,
 * so that profiles are even there. Chords between nodes would be too low by an eighth of curvature
 * times edge squared: 1 % with eight elements across the tube.
 */
#ifndef LAR_STUDY_INVERSE_ASPIRATION_H
#define LAR_STUDY_INVERSE_ASPIRATION_H

#include "model/scene/scene.h"
#include "study/inverse/problem.h"

/* Keys load, origin and axis of the experiment `node`, into e->aspiration; its model stands. */
lar_status lar_inverse_tube_read(const lar_scene *scene, const lar_yaml *node,
                                 lar_inverse_experiment *e);

/* The farthest of the loaded nodes from the axis at rest [m]. */
double lar_inverse_tube_reach(const lar_inverse_experiment *e);

/* Height of the profile at distance r from the axis [m]; u[node_count] are displacements [m]. */
double lar_inverse_tube_height(const lar_inverse_experiment *e, const double (*u)[3], double r);

#endif
