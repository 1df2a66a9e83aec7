#include "layout/row_plan.h"

#include <stdlib.h>
#include <string.h>

#include "layout/rows.h"

enum { LONGEST_RUN = 1024, BEYOND = LONGEST_RUN, ROW = LAR_BLOCK, HALF_ROW = LAR_BLOCK / 2 };
enum { PASSES = 4 };

typedef struct planner {
    lar_draft *draft;
    const lar_row_ways *ways;
    int32_t *run;             /* [LONGEST_RUN] */
    int32_t (*run_corner)[8]; /* [LONGEST_RUN] */
    lar_gid *beyond[2];       /* [BEYOND] nodes before and behind a line, going outwards */
    int32_t *stamp;           /* [nodes] the last check that met the node */
    int32_t stamp_now;
    uint8_t *hopeless; /* [elements] a bit per face by which no row can leave any more */
} planner;

typedef const int32_t (*corners)[8];

/* ---- ways through a mesh --------------------------------------------------------------------- */

static int trace_faces(const lar_row_ways *ways, const lar_draft *draft, lar_gid e, int front,
                       int max, int32_t *run, int32_t (*corner)[8]) {
    return lar_rows_trace(&draft->model->mesh, ways->map, draft->open, e, front, max, run, corner);
}

static lar_gid beyond_faces(const lar_row_ways *ways, const lar_draft *draft, lar_gid *e,
                            lar_gid from, lar_gid to) {
    return lar_rows_beyond(&draft->model->mesh, ways->map, e, from, to);
}

lar_row_ways lar_row_ways_all(const int32_t *neighbour) {
    return (lar_row_ways){.map = neighbour, .trace = trace_faces, .beyond = beyond_faces};
}

/* ---- lines of nodes ------------------------------------------------------------------------- */

/* The node at place k of a line: the left end of element k, or the right end of the last. */
static lar_gid line_node(corners corner, int length, int line, int k) {
    return k < length ? corner[k][lar_line_left[line]] : corner[length - 1][lar_line_right[line]];
}

static bool line_is_numbered(const planner *plan, corners corner, int line) {
    return plan->draft->layout->local[corner[0][lar_line_left[line]]] >= 0;
}

/* From here on no node has been met. Checks are counted, billions of them for a large model: before
 * the count ends it begins anew. */
static void begin_check(planner *plan) {
    if (plan->stamp_now == INT32_MAX) {
        size_t nodes = (size_t)plan->draft->model->mesh.node_count;
        memset(plan->stamp, 0, nodes * sizeof *plan->stamp);
        plan->stamp_now = 0;
    }
    plan->stamp_now++;
}

/* How many of a run's elements rows take: fours, and three more. The lane that then stays without
 * an element reads the number behind each line, and adds nothing to it: that must be nobody's but
 * the thread's own, for others may just be moving theirs. */
static int held_by_rows(const planner *plan, const int32_t *run, corners corner, int length) {
    bool alone = length % HALF_ROW == HALF_ROW - 1;
    for (int line = 0; alone && line < 4; line++)
        alone = lar_draft_owner(plan->draft, corner[0][lar_line_left[line]]) ==
                lar_draft_thread(plan->draft, run[0]);
    return alone ? length : length / HALF_ROW * HALF_ROW;
}

/* Longest part of the run from `from` that rows take and whose lines can be consecutive: no node
 * has a number yet, or they are numbered one after the other, by one owner. A run that closes on
 * itself or crosses itself must not give a node two numbers or an element two lanes. */
static int feasible_length(planner *plan, int from, int length) {
    corners corner = (corners)plan->run_corner + from;
    const lar_lid *local = plan->draft->layout->local;
    int fits = 0, max = length - from;
    begin_check(plan);
    for (int k = 0; k <= max; k++) {
        if (k < max && !plan->draft->open[plan->run[from + k]]) max = k;
        for (int line = 0; line < 4; line++) {
            lar_gid node = line_node(corner, length - from, line, k);
            lar_gid begin = corner[0][lar_line_left[line]];
            if (local[node] != (local[begin] < 0 ? -1 : local[begin] + k) ||
                lar_draft_owner(plan->draft, node) != lar_draft_owner(plan->draft, begin) ||
                plan->stamp[node] == plan->stamp_now)
                return held_by_rows(plan, plan->run + from, corner, fits);
            plan->stamp[node] = plan->stamp_now;
        }
        fits = k;
    }
    return held_by_rows(plan, plan->run + from, corner, fits);
}

/* The nodes that continue an edge of element e, from node to node, as long as they have no number
 * and one owner. Returns how many were put into out[]. */
static int nodes_beyond(planner *plan, lar_gid e, lar_gid from, lar_gid to, lar_gid *out) {
    const lar_draft *draft = plan->draft;
    int count = 0;
    while (count < BEYOND) {
        lar_gid next = plan->ways->beyond(plan->ways, draft, &e, from, to);
        if (next < 0 || plan->stamp[next] == plan->stamp_now || draft->layout->local[next] >= 0 ||
            lar_draft_owner(draft, next) != lar_draft_owner(draft, to))
            break;
        plan->stamp[next] = plan->stamp_now;
        out[count++] = next;
        from = to;
        to = next;
    }
    return count;
}

/* Numbers a line of run[from..from+length) and what lies beyond its ends, but for the run's other
 * lines: around the core of a disc one line goes on in another. The row's own beginning gets an
 * even number. */
static bool number_line(planner *plan, int from, int length, int line) {
    corners corner = (corners)plan->run_corner + from;
    const int32_t *run = plan->run + from;
    lar_gid *before = plan->beyond[0], *behind = plan->beyond[1];
    begin_check(plan);
    for (int k = 0; k <= length; k++)
        for (int any = 0; any < 4; any++)
            plan->stamp[line_node(corner, length, any, k)] = plan->stamp_now;
    int ahead = nodes_beyond(plan, run[length - 1], corner[length - 1][lar_line_left[line]],
                             corner[length - 1][lar_line_right[line]], behind);
    int back = nodes_beyond(plan, run[0], corner[0][lar_line_right[line]],
                            corner[0][lar_line_left[line]], before);
    lar_draft *draft = plan->draft;
    int32_t owner = lar_draft_owner(draft, corner[0][lar_line_left[line]]);
    bool good = (draft->range[owner].count + back) % 2 == 0 || lar_draft_number(draft, owner, -1);
    while (good && back > 0) good = lar_draft_number(draft, owner, before[--back]);
    for (int k = 0; good && k <= length; k++)
        good = lar_draft_number(draft, owner, line_node(corner, length, line, k));
    for (int k = 0; good && k < ahead; k++) good = lar_draft_number(draft, owner, behind[k]);
    return good;
}

/* ---- runs of elements ----------------------------------------------------------------------- */

/* Puts run[from..from+count) into a block of its own. */
static bool place_row(planner *plan, int from, int count) {
    lar_draft *draft = plan->draft;
    const int32_t *run = plan->run + from;
    lar_kind own = lar_draft_kind(draft, run, (corners)plan->run_corner + from, count);
    lar_lanes *block =
        lar_draft_block(draft, own, count > HALF_ROW ? LAR_ROWS_EIGHT : LAR_ROWS_FOUR);
    if (!block) return false;
    for (int k = 0; k < count; k++) {
        lar_draft_put(draft, block, k, run[k]);
        if (!plan->ways->turned)
            memcpy(draft->layout->corner[run[k]], plan->run_corner[from + k],
                   sizeof plan->run_corner[0]);
    }
    return true;
}

/* Cuts the traced run into rows and numbers their lines. */
static bool place_run(planner *plan, int length) {
    for (int from = 0; from + HALF_ROW - 1 <= length;) {
        int part = feasible_length(plan, from, length);
        if (part == 0) {
            from++;
            continue;
        }
        for (int line = 0; line < 4; line++)
            if (!line_is_numbered(plan, (corners)plan->run_corner + from, line) &&
                !number_line(plan, from, part, line))
                return false;
        for (int done = 0; done < part;) {
            int left = part - done, most = left >= ROW - 1 ? ROW : HALF_ROW;
            int count = left < most ? left : most;
            if (!place_row(plan, from + done, count)) return false;
            done += count;
        }
        from += part;
    }
    return true;
}

/* The run that leaves e by a face, as far as its elements join. Returns the length. */
static int trace(planner *plan, lar_gid e, int front) {
    const lar_draft *draft = plan->draft;
    int length =
        plan->ways->trace(plan->ways, draft, e, front, LONGEST_RUN, plan->run, plan->run_corner);
    int at = 0;
    while (at < length - 1 && plan->run[at] != e) at++;
    int begin = at, end = at + 1;
    while (begin > 0 && lar_draft_joins(draft, e, plan->run[begin - 1])) begin--;
    while (end < length && lar_draft_joins(draft, e, plan->run[end])) end++;
    memmove(plan->run, plan->run + begin, (size_t)(end - begin) * sizeof *plan->run);
    memmove(plan->run_corner, plan->run_corner + begin,
            (size_t)(end - begin) * sizeof *plan->run_corner);
    return end - begin;
}

/* Nodes never lose their numbers and elements never open again: where no row fits now, none ever
 * will. Noted for the whole run, so that a long one is not traced once per element. */
static void give_up(planner *plan, int length) {
    for (int k = 0; k < length; k++) {
        lar_gid e = plan->run[k];
        int front = lar_rows_face(plan->draft->model->mesh.element[e], plan->run_corner[k][0],
                                  plan->run_corner[k][1]);
        plan->hopeless[e] |= (uint8_t)(1u << front);
    }
}

/* How good it is to cut the traced run into rows: the share of its elements that rows would hold,
 * rows of four counting less, and a bonus for lines that neighbouring rows have numbered already,
 * so that a region keeps to one direction; the longer of two equal runs. 0: no row fits. */
static double run_score(planner *plan, int length) {
    double held = 0;
    int shared = 0, lines = 0;
    for (int from = 0; from + HALF_ROW - 1 <= length;) {
        int part = feasible_length(plan, from, length);
        for (int line = 0; part > 0 && line < 4; line++, lines++)
            shared += line_is_numbered(plan, (corners)plan->run_corner + from, line);
        held += part / ROW * ROW + 0.7 * (part % ROW);
        from += part > 0 ? part : 1;
    }
    return held > 0 ? held / length + 0.2 * shared / lines + 1e-6 * length : 0;
}

/* The face by which the run with the best score above `wanted` leaves e, or -1. Backwards counts
 * too: lines that are numbered already fit in one direction only. */
static int best_front(planner *plan, lar_gid e, int first_axis, double wanted) {
    int best = -1;
    for (int i = 0; i < 6; i++) {
        int front = 2 * ((first_axis + i) % 3) + (i < 3);
        if (plan->hopeless[e] >> front & 1) continue;
        int length = trace(plan, e, front);
        double score = run_score(plan, length);
        if (score == 0) give_up(plan, length);
        if (score > wanted) {
            wanted = score;
            best = front;
        }
    }
    return best;
}

/* Settled turns leave one way through an element. */
static void close_other_ways(planner *plan) {
    const lar_draft *draft = plan->draft;
    for (int32_t i = 0; i < draft->count; i++) {
        lar_gid e = draft->order[i];
        const lar_gid *node = draft->layout->corner[e];
        int front = lar_rows_face(draft->model->mesh.element[e], node[0], node[1]);
        plan->hopeless[e] = (uint8_t) ~(1u << front);
    }
}

static bool place_rows(planner *plan, lar_row_habit habit) {
    lar_draft *draft = plan->draft;
    if (plan->ways->turned) close_other_ways(plan);
    for (int pass = PASSES - 1; pass >= 0; pass--)
        for (int32_t i = 0; i < draft->count; i++) {
            lar_gid e = draft->order[i];
            if (!draft->open[e]) continue;
            int front = best_front(plan, e, habit.axis, habit.patience * pass);
            if (front >= 0 && !place_run(plan, trace(plan, e, front))) return false;
        }
    return true;
}

bool lar_row_plan(lar_draft *draft, const lar_row_ways *ways, lar_row_habit habit) {
    const lar_mesh *mesh = &draft->model->mesh;
    planner plan = {.draft = draft, .ways = ways};
    plan.run = lar_calloc(LONGEST_RUN, sizeof *plan.run);
    plan.run_corner = lar_calloc(LONGEST_RUN, sizeof *plan.run_corner);
    for (int end = 0; end < 2; end++) plan.beyond[end] = lar_calloc(BEYOND, sizeof(lar_gid));
    plan.stamp = lar_calloc((size_t)mesh->node_count, sizeof *plan.stamp);
    plan.hopeless = lar_calloc((size_t)mesh->element_count, sizeof *plan.hopeless);
    bool good = plan.run && plan.run_corner && plan.beyond[0] && plan.beyond[1] && plan.stamp &&
                plan.hopeless && place_rows(&plan, habit);
    free(plan.run);
    free(plan.run_corner);
    for (int end = 0; end < 2; end++) free(plan.beyond[end]);
    free(plan.stamp);
    free(plan.hopeless);
    return good;
}
