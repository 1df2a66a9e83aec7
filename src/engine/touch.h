/* Tools and fixed planes against the surface: what one thread has of them.
 *
 * Like a pressure, all of it is local: a face's corners are on the processor that has its element,
 * so whoever recovers the element finds the face's contact with tools and applies it to the four
 * corners; a plane acts on single nodes, by whoever applies their loads (engine/conditions.h,
 * share). Nothing needs to be exchanged, and force sums make it the same bits on any grid.
 */
#ifndef LAR_ENGINE_TOUCH_H
#define LAR_ENGINE_TOUCH_H

#include "engine/conditions.h"
#include "engine/tools.h"

/* Sum of what a tool felt, in force units (and those times metres), of all steps of an advance. */
typedef struct lar_tool_sum {
    int64_t force[3], torque[3]; /* of the tissue on the tool; about the tip */
    int32_t touching, held;      /* in the last step */
} lar_tool_sum;

typedef struct lar_touch {
    const lar_tool_list *list; /* NULL: no tools */
    const lar_tools *tools;
    lar_tool_sum sum[LAR_TOOLS_MOST];
} lar_touch;

/* Of the whole model, or with a share (NULL: all) of one thread. `list` and `tools` outlive it and
 * may be NULL. */
lar_status lar_touch_create(const lar_model *model, const int32_t *local,
                            const lar_condition_share *share, const lar_tool_list *list,
                            const lar_tools *tools, lar_touch *touch, lar_error *error);
void lar_touch_destroy(lar_touch *touch); /* idempotent */

/* Adds the forces at the state's step to state->force. Asks for no memory. */
void lar_touch_apply(lar_touch *touch, const lar_condition_context *context, lar_state *state);

/* Half the work of these forces in this step, once before and once after the nodes move: of tools
 * to state->external, of planes to state->contact. */
void lar_touch_half_work(const lar_touch *touch, const lar_condition_context *context,
                         lar_state *state);

#endif
