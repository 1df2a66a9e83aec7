/* Where one tool touches, point by point (lar_touch): noted by who looks at a state
 * (step/measure.h), never in a step.
 *
 * What acts on a face is rounded to whole force units corner by corner, and the tool gets exactly
 * the opposite. So the points of a face become whole units too, and the largest of them takes what
 * rounding has left: their sum is what the tool gets.
 */
#ifndef LAR_CONTACT_TOUCH_LIST_H
#define LAR_CONTACT_TOUCH_LIST_H

#include <stdint.h>

#include "lariat.h"

/* Of one face and tool: all points of the grid and the wall, for both jaws. */
enum { LAR_TOUCHES_OF_FACE = 74 };

typedef struct lar_touch_list {
    int32_t tool;
    int64_t *on_nodes;  /* [3][stride] what each local node gets from the tool [force units]; NULL:
                           not asked for */
    size_t stride;      /* of that (mechanics/axes.h) */
    int32_t max, count; /* room; how many there are */
    lar_touch *touch;   /* [max]. What rubs has its local node in node[0]; others have no nodes */
    int32_t pending;
    lar_touch noted[LAR_TOUCHES_OF_FACE]; /* of the face under way */
} lar_touch_list;

/* A point of the face under way; its force on the tool is still exact. */
void lar_touch_note(lar_touch_list *list, const lar_touch *touch);
/* The local node gets a force from the tool. */
static inline void lar_touch_push(lar_touch_list *list, int32_t node, const int64_t force[3]) {
    for (int i = 0; i < 3 && list->on_nodes; i++)
        list->on_nodes[(size_t)node + (size_t)i * list->stride] += force[i];
}
/* The face is done: the tissue gets `total` from the tool [force units, `scale` in a newton]. */
void lar_touch_settle(lar_touch_list *list, const int64_t total[3], double scale);

#endif
