/* The order in which a domain recovers its elements.
 *
 * Neighbours in space should be neighbours in memory, so that the nodes of one block are still in
 * the cache for the next. Elements of one law stand together (a block has one law); within a law
 * they follow a Z curve (Morton 1966) through their centres.
 */
#ifndef LAR_LAYOUT_ORDER_H
#define LAR_LAYOUT_ORDER_H

#include "model/model.h"

/* Sorts the elements order[0..count) of a model, law by law. */
lar_status lar_order_elements(const lar_model *model, lar_gid *order, int32_t count,
                              lar_error *error);

#endif
