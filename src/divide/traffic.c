#include "divide/traffic.h"

const char *const lar_scheme_name[LAR_SCHEMES] = {"all", "local", "one", "two"};
const char *const lar_channel_use_name[LAR_CHANNEL_USES] = {"sequential", "concurrent"};

/* ---- messages of one node --------------------------------------------------------------- */

typedef struct route {
    const lar_grid *grid;
    const int32_t *set;
    int32_t count;
    lar_message_visit *visit;
    void *context;
} route;

static void send(const route *r, int32_t from, int32_t to, int stage, int what, int onward) {
    const lar_message message = {from, to, stage, what, onward};
    r->visit(r->context, &message);
}

static void all_to_all(const route *r, int stage) {
    for (int32_t i = 0; i < r->count; i++)
        for (int32_t j = 0; j < r->count; j++)
            if (i != j) send(r, r->set[i], r->set[j], stage, LAR_CARRIES_OWN, 0);
}

/* Which stage is the first way of a node: the axis itself for all nodes, so that one packet per
 * neighbour carries everything; at once; or so late that the last way is the last stage. */
typedef enum departure { BY_AXIS, AT_ONCE, JUST_IN_TIME } departure;

/* Every processor exchanges with its partner across each axis that the box spans, one axis after
 * the other. */
static void along_axes(const route *r, int direction, departure when) {
    int ways = (direction & 1) + (direction >> 1 & 1) + (direction >> 2 & 1);
    int stage = when == JUST_IN_TIME ? LAR_STAGES - ways : 0;
    for (int axis = 0; axis < 3; axis++) {
        if (!(direction & 1 << axis)) continue;
        ways--;
        for (int32_t i = 0; i < r->count; i++)
            for (int32_t j = 0; j < r->count; j++)
                if (lar_grid_neighbours_along(r->grid, axis, r->set[i], r->set[j]))
                    send(r, r->set[i], r->set[j], when == BY_AXIS ? axis : stage, LAR_CARRIES_SUM,
                         ways);
        stage++;
    }
}

/* The lowest corner of a box has the smallest number, the highest the greatest. */
static void through_one(const route *r) {
    for (int32_t i = 1; i < r->count; i++) {
        send(r, r->set[i], r->set[0], 0, LAR_CARRIES_OWN, 1);
        send(r, r->set[0], r->set[i], 1, LAR_CARRIES_ALL, 0);
    }
}

static void through_two(const route *r) {
    int32_t low = r->set[0], high = r->set[r->count - 1];
    send(r, low, high, 0, LAR_CARRIES_OWN, 1);
    send(r, high, low, 0, LAR_CARRIES_OWN, 1);
    for (int32_t i = 1; i < r->count - 1; i++) {
        int32_t p = r->set[i];
        send(r, p, low, 0, LAR_CARRIES_OWN, 1);
        send(r, p, high, 0, LAR_CARRIES_OWN, 1);
        send(r, lar_grid_neighbours(r->grid, p, low) ? low : high, p, 1, LAR_CARRIES_ALL, 0);
    }
}

void lar_scheme_messages(lar_scheme scheme, lar_channel_use channels, const lar_grid *grid,
                         const int32_t *set, int32_t count, lar_message_visit *visit,
                         void *context) {
    const route r = {grid, set, count, visit, context};
    if (count < 2) return;
    int direction = lar_node_direction(grid, set, count);
    bool far_first = scheme == LAR_SCHEME_LOCAL && channels == LAR_CHANNELS_CONCURRENT;
    if (scheme == LAR_SCHEME_ALL || lar_node_scattered(grid, set, count))
        all_to_all(&r, far_first ? LAR_STAGES - 1 : 0);
    else if (scheme == LAR_SCHEME_LOCAL)
        along_axes(&r, direction, far_first ? JUST_IN_TIME : BY_AXIS);
    else if (count == 2)
        all_to_all(&r, 0);
    else if (scheme == LAR_SCHEME_ONE)
        through_one(&r);
    else if (direction == 7)
        through_two(&r);
    else
        along_axes(&r, direction, AT_ONCE);
}

/* ---- counts ----------------------------------------------------------------------------- */

void lar_traffic_formula(lar_scheme scheme, int64_t n, int64_t *local, int64_t *global) {
    static const int64_t form[LAR_SCHEMES][2][3] = {/* n^2, n, 1 */
                                                    {{6, 12, 6}, {0, 12, 20}},
                                                    {{6, 12, 6}, {0, 0, 0}},
                                                    {{6, 0, 0}, {0, 6, 2}},
                                                    {{6, 12, -6}, {0, 0, 8}}};
    const int64_t(*f)[3] = form[scheme];
    *local = f[0][0] * n * n + f[0][1] * n + f[0][2];
    *global = f[1][0] * n * n + f[1][1] * n + f[1][2];
}
