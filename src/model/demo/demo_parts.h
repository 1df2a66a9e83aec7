/* How the demonstration organ is made. Internal to demo*.c.
 *
 * Three steps, each in its own file:
 *
 *   demo_grid.c  which cells there are. The organ is laid out as bricks on an integer grid
 *                   (i to the patient's left, j to the back, k up), so that the mesh conforms by
 *                   construction and the numbers of cells and nodes are exact bookkeeping.
 *   demo_shape.c    where the surface is. Simple bodies (ellipsoids, swept tubes, sheets) are
 *                   blended into one smooth implicit surface, in millimetres.
 *   demo_fit.c      where the nodes are. Surface nodes are drawn onto the surface and every node
 *                   is moved so that the elements become as box-like and even as they can.
 *
 *          fundus
 *       .-'""""""'-.  ____ tube (2 x 2 cells)         front view of the left half; the grid
 *      |            |'____'---.                       holds i >= 0 only and is mirrored at i = 0,
 *      |   corpus   |  meso- / '|  free end           so that the organ is symmetric to the bit
 *       \          /|salpinx/  _|
 *        \        /  |ov-ary|
 *         |cervix|    '----'       round ligament: from the front, forward and down
 *
 * Only + - * / and sqrt are used: the mesh has the same bits on every machine.
 */
#ifndef LAR_MODEL_DEMO_DEMO_PARTS_H
#define LAR_MODEL_DEMO_DEMO_PARTS_H

#include <stdbool.h>

#include "base/error.h"

enum { LAR_DEMO_UTERUS = 1, LAR_DEMO_TUBES, LAR_DEMO_OVARIES, LAR_DEMO_LIGAMENTS };

/* Grid sizes: node coordinates 0 <= I <= I_END and so on; corpus and cervix stand on K = 0,
 * the round ligament ends at J = J_FIRST. */
enum {
    LAR_DEMO_I_END = 15,
    LAR_DEMO_J_FIRST = -4,
    LAR_DEMO_J_END = 8,
    LAR_DEMO_K_END = 18,
    LAR_DEMO_J_NODES = LAR_DEMO_J_END - LAR_DEMO_J_FIRST + 1
};

/* Cells and nodes with i >= 0; positions in millimetres. */
typedef struct lar_demo_half {
    int node_count;
    int (*grid)[3]; /* I, J, K of every node */
    double (*position)[3];
    int cell_count;
    int (*corner)[8]; /* node indices in the order of mesh.h */
    int (*cell)[3];   /* i, j, k of every cell */
    int *part;        /* LAR_DEMO_UTERUS, ... */
} lar_demo_half;

/* Fills a zeroed half with cells, nodes and a first guess of the positions, close enough to the
 * surface to be drawn onto it. The caller clears it, also on failure. */
lar_status lar_demo_grid(lar_demo_half *half, lar_error *error);
void lar_demo_half_clear(lar_demo_half *half);

enum { LAR_DEMO_TUBE_POINTS = 17, LAR_DEMO_TUBE_BEND = 11, LAR_DEMO_LIGAMENT_POINTS = 9 };

/* Centre lines with radii; the other bodies are constants of demo_shape.c. */
typedef struct lar_demo_shape {
    double tube[LAR_DEMO_TUBE_POINTS][4]; /* x, y, z, radius */
    double ligament[LAR_DEMO_LIGAMENT_POINTS][4];
} lar_demo_shape;

lar_demo_shape lar_demo_shape_create(void);

/* Roughly the signed distance to the surface of the organ (negative inside), |x| mirrored. The
 * free end of the tube is there only for nodes of the `tube`, so that it does not catch those of
 * the mesosalpinx and the ovary close by. */
double lar_demo_shape_distance(const lar_demo_shape *shape, bool tube, const double point[3]);

/* Centre lines, t from 0 (at the corpus) to 1 (free end): position, derivative, radius. */
void lar_demo_tube_axis(double t, double point[3], double tangent[3], double *radius);
void lar_demo_ligament_axis(double t, double point[3], double tangent[3], double *radius);

/* How far the adnexa lie behind the corpus' middle plane. */
double lar_demo_sweep(double x);

/* Draws the surface nodes onto the shape and moves all nodes until the elements are good. */
lar_status lar_demo_fit(lar_demo_half *half, const lar_demo_shape *shape, lar_error *error);

#endif
