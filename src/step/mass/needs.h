/* The elements that ask most of a step, (omega dt / 2)^2 as they are strained: what threads and
 * processors find of them in an interval, joined. The outcome does not depend on who found what,
 * nor on the order in which it is joined: the first of a sorted list, and the need of the one that
 * just did not find room. */
#ifndef LAR_STEP_MASS_NEEDS_H
#define LAR_STEP_MASS_NEEDS_H

#include "contact/tools.h"
#include "layout/state.h"

typedef struct lar_need {
    int32_t element, padding;
    double need;
} lar_need;

/* Plain, travels as it is. */
struct lar_needs {
    int32_t count, padding;
    double beyond;                /* the largest need of those that did not find room */
    double fastest;               /* node when they were looked at, along an axis [m/s] */
    lar_need of[LAR_HEAVIER_MAX]; /* the largest first, equal ones by element */
};

static inline void lar_needs_add_beyond(lar_needs *needs, double need) {
    if (need > needs->beyond) needs->beyond = need;
}

/* Of an element that is not among them. */
static inline void lar_needs_add(lar_needs *needs, int32_t element, double need) {
    int32_t i = needs->count;
    if (i == LAR_HEAVIER_MAX) {
        const lar_need *last = &needs->of[--i];
        bool later = need < last->need || (need == last->need && element > last->element);
        lar_needs_add_beyond(needs, later ? need : last->need);
        if (later) return;
    } else {
        needs->count++;
    }
    for (; i > 0; i--) {
        const lar_need *before = &needs->of[i - 1];
        if (need < before->need || (need == before->need && element > before->element)) break;
        needs->of[i] = *before;
    }
    needs->of[i] = (lar_need){.element = element, .need = need};
}

static inline void lar_needs_join(lar_needs *sum, const lar_needs *other) {
    lar_needs_add_beyond(sum, other->beyond);
    if (!(other->fastest <= sum->fastest)) sum->fastest = other->fastest;
    for (int32_t i = 0; i < other->count; i++)
        lar_needs_add(sum, other->of[i].element, other->of[i].need);
}

static inline void lar_needs_clear(lar_needs *needs) {
    needs->count = 0;
    needs->beyond = 0;
    needs->fastest = 0;
}

#endif
