#include "divide/cut.h"

#include <stdlib.h>

void lar_logical_positions(const lar_mesh *mesh, double (*logical)[3]) {
    double low[3] = {0}, high[3] = {0};
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int i = 0; i < 3; i++) {
            double sum = 0;
            for (int a = 0; a < 8; a++) sum += mesh->position[mesh->element[e][a]][i];
            double centre = logical[e][i] = sum / 8;
            if (e == 0 || centre < low[i]) low[i] = centre;
            if (e == 0 || centre > high[i]) high[i] = centre;
        }
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int i = 0; i < 3; i++) {
            double size = high[i] - low[i];
            logical[e][i] = size > 0 ? (logical[e][i] - low[i]) / size : 0.5;
        }
}

static bool before(lar_cut_item a, lar_cut_item b) {
    return a.key < b.key || (a.key == b.key && a.element < b.element);
}

static lar_cut_item middle_of(lar_cut_item a, lar_cut_item b, lar_cut_item c) {
    if (before(b, a)) {
        lar_cut_item swap = a;
        a = b;
        b = swap;
    }
    return before(b, c) ? b : before(a, c) ? c : a;
}

/* Puts the `at` smallest items first. */
static void separate(lar_cut_item *item, int32_t count, int32_t at) {
    while (count > 1 && at > 0 && at < count) {
        lar_cut_item pivot = middle_of(item[0], item[count / 2], item[count - 1]);
        int32_t low = 0, high = count - 1;
        for (;;) {
            while (before(item[low], pivot)) low++;
            while (before(pivot, item[high])) high--;
            if (low >= high) break;
            lar_cut_item swap = item[low];
            item[low++] = item[high];
            item[high--] = swap;
        }
        /* item[0..low) are not after the pivot, the others not before it. */
        if (low == 0) low = 1;
        if (at < low) {
            count = low;
        } else {
            item += low;
            count -= low;
            at -= low;
        }
    }
}

typedef struct cutter {
    const lar_grid *grid;
    const double (*logical)[3];
    const float *weight; /* NULL: all are alike */
    int32_t *processor;
} cutter;

static void cut_axis(const cutter *c, int axis, lar_cut_item *item, int32_t count,
                     int32_t processor);

/* Processors of a place of this axis. */
static int32_t stride_of(const lar_grid *grid, int axis) {
    return axis == 0 ? 1 : axis == 1 ? grid->edge[0] : grid->edge[0] * grid->edge[1];
}

static int compare_items(const void *a, const void *b) {
    const lar_cut_item *x = a, *y = b;
    return before(*x, *y) ? -1 : before(*y, *x);
}

/* Sorted items: how many of them weigh `share` of all, the nearest number of at least `min` for the
 * places before the cut, and as many as `left` for those behind. */
static int32_t weigh(const cutter *c, const lar_cut_item *item, int32_t count, double share,
                     int32_t min, int32_t left) {
    double all = 0, sum = 0;
    int32_t at = 0;
    for (int32_t i = 0; i < count; i++) all += (double)c->weight[item[i].element];
    while (at < count && sum + 0.5 * (double)c->weight[item[at].element] < share * all)
        sum += (double)c->weight[item[at++].element];
    if (at > count - left) at = count - left;
    return at < min ? min : at;
}

/* Divides a block among places from..to-1 of an axis, the middle cut first. Cut i of n comes
 * after i count / n elements. */
static void cut_places(const cutter *c, int axis, lar_cut_item *item, int32_t whole, int32_t from,
                       int32_t to, int32_t processor) {
    int32_t n = c->grid->edge[axis], stride = stride_of(c->grid, axis);
    int32_t start = (int32_t)((int64_t)whole * from / n);
    int32_t end = (int32_t)((int64_t)whole * to / n);
    if (to - from == 1) {
        cut_axis(c, axis - 1, item, end - start, processor + from * stride);
        return;
    }
    int32_t half = from + (to - from) / 2;
    int32_t at = (int32_t)((int64_t)whole * half / n) - start;
    separate(item, end - start, at);
    cut_places(c, axis, item, whole, from, half, processor);
    /* Cutting along lower axes has overwritten the keys of the first part only. */
    cut_places(c, axis, item + at, whole, half, to, processor);
}

/* The same by weight, of so many items. */
static void weigh_places(const cutter *c, int axis, lar_cut_item *item, int32_t count, int32_t from,
                         int32_t to, int32_t processor) {
    int32_t stride = stride_of(c->grid, axis), half = from + (to - from) / 2;
    if (to - from == 1) {
        cut_axis(c, axis - 1, item, count, processor + from * stride);
        return;
    }
    qsort(item, (size_t)count, sizeof *item, compare_items);
    int32_t at = weigh(c, item, count, (double)(half - from) / (to - from), (half - from) * stride,
                       (to - half) * stride);
    weigh_places(c, axis, item, at, from, half, processor);
    weigh_places(c, axis, item + at, count - at, half, to, processor);
}

static void cut_axis(const cutter *c, int axis, lar_cut_item *item, int32_t count,
                     int32_t processor) {
    if (axis < 0) {
        for (int32_t i = 0; i < count; i++) c->processor[item[i].element] = processor;
        return;
    }
    for (int32_t i = 0; i < count; i++) item[i].key = c->logical[item[i].element][axis];
    int32_t places = c->grid->edge[axis];
    if (c->weight)
        weigh_places(c, axis, item, count, 0, places, processor);
    else
        cut_places(c, axis, item, count, 0, places, processor);
}

void lar_cut_by_weight(const lar_grid *grid, int32_t count, const double (*logical)[3],
                       const float *weight, lar_cut_item *item, int32_t *processor) {
    const cutter c = {grid, logical, weight, processor};
    for (int32_t e = 0; e < count; e++) item[e].element = e;
    cut_axis(&c, 2, item, count, 0);
}

void lar_cut(const lar_grid *grid, int32_t count, const double (*logical)[3], lar_cut_item *item,
             int32_t *processor) {
    lar_cut_by_weight(grid, count, logical, NULL, item, processor);
}
