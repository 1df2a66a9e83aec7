#include "contact/touch_list.h"

#include <math.h>

void lar_touch_note(lar_touch_list *list, const lar_touch *touch) {
    if (list->pending < LAR_TOUCHES_OF_FACE) list->noted[list->pending++] = *touch;
}

static double square_of(const double force[3]) {
    return force[0] * force[0] + force[1] * force[1] + force[2] * force[2];
}

void lar_touch_settle(lar_touch_list *list, const int64_t total[3], double scale) {
    int32_t largest = 0;
    int64_t left[3] = {-total[0], -total[1], -total[2]};
    for (int32_t k = 1; k < list->pending; k++)
        if (square_of(list->noted[k].force) > square_of(list->noted[largest].force)) largest = k;
    for (int32_t k = 0; k < list->pending; k++)
        for (int i = 0; i < 3 && k != largest; i++) {
            int64_t units = llrint(list->noted[k].force[i] * scale);
            left[i] -= units;
            list->noted[k].force[i] = (double)units / scale;
        }
    for (int i = 0; i < 3 && list->pending > 0; i++)
        list->noted[largest].force[i] = (double)left[i] / scale;
    for (int32_t k = 0; k < list->pending; k++, list->count++)
        if (list->count < list->max) list->touch[list->count] = list->noted[k];
    list->pending = 0;
}
