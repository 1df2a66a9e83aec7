/* Supports that are set and released while a simulation runs.
 *
 *     the model's entries    fix, move                      as long as nothing here names the axis
 *     a later entry          node or set, axes, held        wins over all before it, axis by axis
 *
 * A held axis stays where it was when it was set: what the state has there is not stored again.
 * Plain numbers, as forces that are set (model/forces.h): they travel with the tools and are in
 * checkpoints, where an entry is 8 bytes.
 */
#ifndef LAR_MODEL_SUPPORTS_H
#define LAR_MODEL_SUPPORTS_H

#include <stdbool.h>

#include "model/forces.h"

typedef struct lar_support_entry {
    int32_t of;     /* node of the model, or index of a set of nodes */
    uint8_t on_set; /* 0 or 1 */
    uint8_t axes;   /* LAR_AXIS bits, not 0 */
    uint8_t held;   /* 1: held where they were; 0: released */
    uint8_t padding;
} lar_support_entry;

typedef struct lar_supports {
    int32_t count, padding;
    lar_support_entry entry[LAR_SUPPORTS_MAX];
} lar_supports;

/* Of a mark: the axes that are held, and LAR_SUPPORT_SET times those that an entry here names. */
enum { LAR_SUPPORT_SET = LAR_AXIS_ALL + 1 };

/* What holds every node of the model, into mark [nodes]. NULL: nothing was set. */
void lar_supports_mark(const lar_supports *supports, const lar_model *model, uint8_t *mark);

/* Behind all others; what these say of the same axes of the same node or set is dropped. `mark` is
 * scratch [nodes]. What only releases what nothing holds is left out. False: no place is left. */
bool lar_supports_put(lar_supports *supports, const lar_model *model,
                      const lar_support_entry *entry, uint8_t *mark);

/* Whether it is for something of the model. */
bool lar_support_good(const lar_support_entry *entry, const lar_model *model);
/* The same of all, for what comes from files and from other processes. */
bool lar_supports_good(const lar_supports *supports, const lar_model *model);

/* The axes that hold a node. */
unsigned lar_supports_at(const lar_supports *supports, const lar_model *model, int32_t node);

#endif
