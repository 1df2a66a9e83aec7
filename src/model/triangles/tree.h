/* Finds the nearest of many triangles: a tree of boxes (a bounding volume hierarchy). */
#ifndef LAR_MODEL_TRIANGLES_TREE_H
#define LAR_MODEL_TRIANGLES_TREE_H

#include <stdbool.h>

#include "model/triangles/triangles.h"

typedef struct lar_triangle_tree lar_triangle_tree;

typedef struct lar_nearest {
    int32_t triangle; /* index into the whole surface's triangles */
    double point[3];  /* on it */
    double weight[3]; /* of its corners: point = sum of weight times vertex */
    double distance;  /* to the point that was asked for [m] */
} lar_nearest;

/* Over `count` triangles of a surface, by index, or all (index NULL). The surface must outlive the
 * tree; the indices are copied. */
lar_status lar_triangle_tree_create(const lar_triangles *triangles, const int32_t *index,
                                    int32_t count, lar_triangle_tree **tree, lar_error *error);
void lar_triangle_tree_destroy(lar_triangle_tree *tree); /* NULL is fine */

/* The nearest point within `reach` (INFINITY: anywhere). Of equally near triangles the one with the
 * smallest index. False when there is none. Any thread. */
bool lar_triangle_tree_nearest(const lar_triangle_tree *tree, const double point[3], double reach,
                               lar_nearest *nearest);

/* Whether there is one within `reach`: the same answer, sooner. */
bool lar_triangle_tree_is_near(const lar_triangle_tree *tree, const double point[3], double reach);

/* Calls `visit` for every triangle whose box, widened by `margin`, meets the box lower..upper;
 * false from `visit` ends it. */
typedef bool lar_triangle_visit(void *context, int32_t triangle);
void lar_triangle_tree_boxes(const lar_triangle_tree *tree, const double lower[3],
                             const double upper[3], double margin, lar_triangle_visit *visit,
                             void *context);

/* Calls `visit` for every triangle whose box a line from `origin` along `direction` meets within
 * `*reach` times that; `visit` may make it shorter. Nearer boxes first. */
void lar_triangle_tree_line(const lar_triangle_tree *tree, const double origin[3],
                            const double direction[3], const double *reach,
                            lar_triangle_visit *visit, void *context);

#endif
