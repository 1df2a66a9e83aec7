/* From positions to processors by cutting (T 6.8.2, algorithm 3).
 *
 *     all elements --z--> nz blocks --y--> ny blocks each --x--> nx blocks each = processors
 *
 * A block of N elements is cut into n of floor(N/n) or ceil(N/n). Done three times over this gives
 * every processor floor or ceil of elements / processors, whatever the positions: the load balance
 * of eq. 6.7 holds by construction. That is why a search may change positions freely.
 *
 * Elements that do not cost the same are cut by their weights instead of their number, and every
 * processor still gets one at least.
 *
 * The thesis sorts; cutting needs less: each cut only separates smaller from larger (Hoare's
 * selection). Equal coordinates are ordered by element, so the result has no choice.
 */
#ifndef LAR_DIVIDE_CUT_H
#define LAR_DIVIDE_CUT_H

#include "divide/grid.h"
#include "model/mesh/mesh.h"

/* Scratch of lar_cut, one per element. */
typedef struct lar_cut_item {
    double key;
    int32_t element;
} lar_cut_item;

/* Logical positions: centres of the elements (eq. 6.9), each axis scaled to 0..1. */
void lar_logical_positions(const lar_mesh *mesh, double (*logical)[3]);

/* Cuts `count` elements by logical[count][3] into processor[count]. item[count] is scratch. */
void lar_cut(const lar_grid *grid, int32_t count, const double (*logical)[3], lar_cut_item *item,
             int32_t *processor);
/* The same by positive weight[count]. The grid has no more processors than there are elements. */
void lar_cut_by_weight(const lar_grid *grid, int32_t count, const double (*logical)[3],
                       const float *weight, lar_cut_item *item, int32_t *processor);

#endif
