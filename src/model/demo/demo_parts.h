/* How the demonstration organ is made. Internal to demo*.c.
 *
 *   demo_grid.c     which cells there are. The organ is laid out as bricks on an integer grid
 *                   (i to the patient's left, j to the back, k up), so that the mesh conforms by
 *                   construction and the numbers of cells and nodes are exact bookkeeping.
 *   demo_nodes.inc  where the nodes are. They were found once: simple bodies (ellipsoids, swept
 *                   tubes, sheets) blended into one smooth surface, onto which the outer nodes were
 *                   drawn while an energy of the elements' corners was minimised.
 *   demo_mesh.c     mirrors the half, numbers and names.
 *
 *          fundus
 *       .-'""""""'-.  ____ tube (2 x 2 cells)         front view of the left half; the grid
 *      |            |'____'---.                       holds i >= 0 only and is mirrored at i = 0,
 *      |   corpus   |  meso- / '|  free end           so that the organ is symmetric to the bit
 *       \          /|salpinx/  _|
 *        \        /  |ov-ary|
 *         |cervix|    '----'       round ligament: from the front, forward and down
 */
#ifndef LAR_MODEL_DEMO_DEMO_PARTS_H
#define LAR_MODEL_DEMO_DEMO_PARTS_H

#include <stdint.h>

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

/* Cells and nodes with i >= 0. */
typedef struct lar_demo_half {
    int node_count;
    int (*grid)[3];               /* I, J, K of every node */
    const int16_t (*position)[3]; /* in 256ths of a millimetre; constants */
    int cell_count;
    int (*cell)[3]; /* i, j, k of every cell */
    int *part;      /* LAR_DEMO_UTERUS, ... */
} lar_demo_half;

/* Fills a zeroed half. The caller clears it, also on failure. */
lar_status lar_demo_grid(lar_demo_half *half, lar_error *error);
void lar_demo_half_clear(lar_demo_half *half);

#endif
