#include "engine/layout.h"

#include <stdlib.h>
#include <string.h>

#include "base/simd.h"
#include "engine/order.h"
#include "engine/rows.h"

enum { LONGEST_RUN = 1024, ROW = LAR_BLOCK, HALF_ROW = LAR_BLOCK / 2 };

/* The nodes of a turned element on the four lines along xi, at its left and right end. */
static const int line_left[4] = {0, 3, 4, 7}, line_right[4] = {1, 2, 5, 6};

/* A layout in the making. */
typedef struct planner {
    const lar_model *model;
    lar_layout *layout;
    size_t block_room;
    int32_t *neighbour;
    bool *open; /* [elements] not yet in a row or a block */
    bool *usable;
    int32_t *run;             /* [LONGEST_RUN] */
    int32_t (*run_corner)[8]; /* [LONGEST_RUN] */
    int32_t node_room;
    int32_t *stamp; /* [nodes] the last check that met the node */
    int32_t stamp_now;
    int32_t waiting[LAR_LAW_COUNT * 4]; /* by kind: block with one row of four, -1: none */
} planner;

static lar_law law_of(const lar_model *model, lar_gid e) {
    return model->material[model->element_material[e]].law;
}

/* The turn of a box whose edges follow the axes to the bit, -1 for any other element. */
static int box_turn(const lar_mesh *mesh, const lar_gid corner[8]) {
    for (int turn = 0; turn < 3; turn++) {
        bool box = true;
        for (int a = 0; box && a < 8; a++)
            for (int i = 0; i < 3; i++) {
                int axis = (i + turn) % 3, representative = lar_node_sign[a][i] < 0 ? 0 : 6;
                box = box && mesh->position[corner[a]][axis] ==
                                 mesh->position[corner[representative]][axis];
            }
        for (int i = 0; i < 3; i++)
            box = box && mesh->position[corner[0]][i] < mesh->position[corner[6]][i];
        if (box) return turn;
    }
    return -1;
}

/* What a block is made of: the same for all its elements. */
typedef struct kind {
    lar_law law;
    lar_block_shape shape;
    int turn;
} kind;

enum { KINDS = LAR_LAW_COUNT * 4 };

static int kind_index(kind k) {
    return (int)k.law * 4 + (k.shape == LAR_SHAPE_BOX ? 1 + k.turn : 0);
}

/* The kind of `count` elements that will share a row. */
static kind common_kind(const lar_model *model, const lar_gid *element, const int32_t (*corner)[8],
                        int count) {
    kind common = {law_of(model, element[0]), LAR_SHAPE_BOX, 0};
    for (int k = 0; k < count; k++) {
        int turn = box_turn(&model->mesh, corner[k]);
        if (turn < 0 || (k > 0 && turn != common.turn))
            return (kind){common.law, LAR_SHAPE_GENERAL, 0};
        common.turn = turn;
    }
    return common;
}

static lar_lanes *new_block(planner *plan, kind k, lar_block_rows rows) {
    lar_layout *layout = plan->layout;
    if (!LAR_GROW(layout->block, plan->block_room, layout->block_count)) return NULL;
    lar_lanes *block = &layout->block[layout->block_count++];
    *block = (lar_lanes){.law = k.law, .shape = k.shape, .turn = k.turn, .rows = rows};
    for (int i = 0; i < LAR_BLOCK; i++) block->element[i] = -1;
    return block;
}

/* The node at place k of a line: the left end of element k, or the right end of the last. */
static lar_gid line_node(const int32_t (*corner)[8], int length, int line, int k) {
    return k < length ? corner[k][line_left[line]] : corner[length - 1][line_right[line]];
}

typedef enum line_state { LINE_FRESH, LINE_NUMBERED, LINE_BROKEN } line_state;

/* Has no node of the line a number yet, or are they numbered one after the other? */
static line_state examine_line(const planner *plan, const int32_t (*corner)[8], int length,
                               int line) {
    const lar_lid *local = plan->layout->local;
    lar_lid first = local[line_node(corner, length, line, 0)];
    for (int k = 1; k <= length; k++) {
        lar_lid number = local[line_node(corner, length, line, k)];
        if (number != (first < 0 ? -1 : first + k)) return LINE_BROKEN;
    }
    return first < 0 ? LINE_FRESH : LINE_NUMBERED;
}

static bool number_node(planner *plan, lar_gid node) {
    lar_layout *layout = plan->layout;
    size_t room = (size_t)plan->node_room;
    if (!LAR_GROW(layout->global, room, layout->node_count)) return false;
    plan->node_room = (int32_t)room;
    if (node >= 0) layout->local[node] = layout->node_count;
    layout->global[layout->node_count++] = node;
    return true;
}

static bool number_line(planner *plan, const int32_t (*corner)[8], int length, int line) {
    if (plan->layout->node_count % 2 && !number_node(plan, -1)) return false;
    for (int k = 0; k <= length; k++)
        if (!number_node(plan, line_node(corner, length, line, k))) return false;
    return true;
}

/* A row that bites its own tail would give a node two numbers. */
static bool meets_itself(planner *plan, const int32_t (*corner)[8], int length) {
    plan->stamp_now++;
    for (int line = 0; line < 4; line++)
        for (int k = 0; k <= length; k++) {
            lar_gid node = line_node(corner, length, line, k);
            if (plan->stamp[node] == plan->stamp_now) return true;
            plan->stamp[node] = plan->stamp_now;
        }
    return false;
}

/* Longest part of the run from `from`, a multiple of four, whose lines can be consecutive. */
static int feasible_length(planner *plan, int from, int length) {
    const int32_t(*corner)[8] = (const int32_t(*)[8])plan->run_corner + from;
    for (int wanted = (length - from) / HALF_ROW * HALF_ROW; wanted > 0; wanted -= HALF_ROW) {
        bool fits = !meets_itself(plan, corner, wanted);
        for (int line = 0; fits && line < 4; line++)
            fits = examine_line(plan, corner, wanted, line) != LINE_BROKEN;
        if (fits) return wanted;
    }
    return 0;
}

/* Puts run[from..from+count) into a block: eight into a new one, four beside four others. */
static bool place_row(planner *plan, int from, int count) {
    kind own = common_kind(plan->model, plan->run + from,
                           (const int32_t(*)[8])plan->run_corner + from, count);
    int32_t *waiting = &plan->waiting[kind_index(own)];
    lar_lanes *block;
    int offset = 0;
    if (count == ROW) {
        block = new_block(plan, own, LAR_ROWS_EIGHT);
    } else if (*waiting >= 0) {
        block = &plan->layout->block[*waiting];
        *waiting = -1;
        offset = HALF_ROW;
    } else {
        block = new_block(plan, own, LAR_ROWS_FOUR);
        *waiting = plan->layout->block_count - 1;
    }
    if (!block) return false;
    for (int k = 0; k < count; k++) {
        lar_gid e = plan->run[from + k];
        block->element[LAR_ROW_LANES[offset + k]] = e;
        memcpy(plan->layout->corner[e], plan->run_corner[from + k], sizeof plan->run_corner[0]);
        plan->open[e] = false;
        plan->usable[e] = false;
    }
    return true;
}

/* Cuts the traced run into rows and numbers their lines. */
static bool place_run(planner *plan, int length) {
    for (int from = 0; from + HALF_ROW <= length;) {
        int part = feasible_length(plan, from, length);
        if (part == 0) {
            from++;
            continue;
        }
        const int32_t(*corner)[8] = (const int32_t(*)[8])plan->run_corner + from;
        for (int line = 0; line < 4; line++)
            if (examine_line(plan, corner, part, line) == LINE_FRESH &&
                !number_line(plan, corner, part, line))
                return false;
        for (int done = 0; done < part;) {
            int count = part - done >= ROW ? ROW : HALF_ROW;
            if (!place_row(plan, from + done, count)) return false;
            done += count;
        }
        from += part;
    }
    return true;
}

/* A run keeps to one law; elements of others are closed while it is traced. */
static int trace(planner *plan, lar_gid e, int axis) {
    return lar_rows_trace(&plan->model->mesh, plan->neighbour, plan->usable, e, axis, LONGEST_RUN,
                          plan->run, plan->run_corner);
}

/* The part of a run that has the law of e, around it, moved to the front. */
static int keep_law(planner *plan, lar_gid e, int length) {
    lar_law law = law_of(plan->model, e);
    int at = 0;
    while (at < length - 1 && plan->run[at] != e) at++;
    int begin = at, end = at + 1;
    while (begin > 0 && law_of(plan->model, plan->run[begin - 1]) == law) begin--;
    while (end < length && law_of(plan->model, plan->run[end]) == law) end++;
    memmove(plan->run, plan->run + begin, (size_t)(end - begin) * sizeof *plan->run);
    memmove(plan->run_corner, plan->run_corner + begin,
            (size_t)(end - begin) * sizeof *plan->run_corner);
    return end - begin;
}

/* How good it is to cut the traced run into rows: the share of its elements that rows would hold,
 * rows of four counting a little less, and a bonus for lines that neighbouring rows have numbered
 * already, so that a region keeps to one direction; the longer of two equal runs. */
static double run_score(planner *plan, int length) {
    double held = 0;
    int shared = 0, lines = 0;
    for (int from = 0; from + HALF_ROW <= length;) {
        int part = feasible_length(plan, from, length);
        const int32_t(*corner)[8] = (const int32_t(*)[8])plan->run_corner + from;
        for (int line = 0; part > 0 && line < 4; line++, lines++)
            shared += examine_line(plan, corner, part, line) == LINE_NUMBERED;
        held += part / ROW * ROW + 0.9 * (part % ROW);
        from += part > 0 ? part : 1;
    }
    return held > 0 ? held / length + 0.2 * shared / lines + 1e-6 * length : 0;
}

static bool place_rows(planner *plan, const lar_gid *order) {
    int32_t count = plan->model->mesh.element_count;
    for (int32_t i = 0; i < count; i++) {
        lar_gid e = order[i];
        if (!plan->open[e]) continue;
        double best = 0;
        int best_axis = -1;
        for (int axis = 0; axis < 3; axis++) {
            double score = run_score(plan, keep_law(plan, e, trace(plan, e, axis)));
            if (score > best) {
                best = score;
                best_axis = axis;
            }
        }
        if (best_axis < 0) continue;
        if (!place_run(plan, keep_law(plan, e, trace(plan, e, best_axis)))) return false;
    }
    return true;
}

/* What no row took: elements of one kind, eight by eight. */
static bool place_loose(planner *plan, const lar_gid *order) {
    int32_t filling[KINDS], used[KINDS];
    memset(filling, -1, sizeof filling);
    memset(used, 0, sizeof used);
    for (int32_t i = 0; i < plan->model->mesh.element_count; i++) {
        lar_gid e = order[i];
        if (!plan->open[e]) continue;
        kind own = common_kind(plan->model, &e, (const int32_t(*)[8])plan->layout->corner + e, 1);
        int at = kind_index(own);
        if (filling[at] < 0 || used[at] == LAR_BLOCK) {
            if (!new_block(plan, own, LAR_ROWS_NONE)) return false;
            filling[at] = plan->layout->block_count - 1;
            used[at] = 0;
        }
        plan->layout->block[filling[at]].element[used[at]++] = e;
    }
    return true;
}

/* A row of four that stayed alone becomes a loose block. */
static void release_waiting(planner *plan) {
    for (int k = 0; k < KINDS; k++)
        if (plan->waiting[k] >= 0) plan->layout->block[plan->waiting[k]].rows = LAR_ROWS_NONE;
}

static int block_rank(const lar_lanes *block) {
    return kind_index((kind){block->law, block->shape, block->turn}) * LAR_ROWS_COUNT +
           (int)block->rows;
}

/* Equal kinds together, each in the order in which it was made. */
static bool sort_blocks(lar_layout *layout) {
    lar_lanes *sorted = lar_calloc((size_t)layout->block_count, sizeof *sorted);
    if (!sorted) return false;
    int32_t count = 0;
    for (int rank = 0; rank < KINDS * LAR_ROWS_COUNT; rank++)
        for (int32_t b = 0; b < layout->block_count; b++)
            if (block_rank(&layout->block[b]) == rank) sorted[count++] = layout->block[b];
    free(layout->block);
    layout->block = sorted;
    return true;
}

static bool number_rest(planner *plan) {
    lar_layout *layout = plan->layout;
    for (int32_t b = 0; b < layout->block_count; b++)
        for (int lane = 0; lane < LAR_BLOCK; lane++) {
            lar_gid e = layout->block[b].element[lane];
            for (int a = 0; e >= 0 && a < 8; a++)
                if (layout->local[layout->corner[e][a]] < 0 &&
                    !number_node(plan, layout->corner[e][a]))
                    return false;
        }
    layout->node_padded = (layout->node_count + 2) & ~1;
    int32_t real = layout->node_count;
    while (layout->node_count < layout->node_padded)
        if (!number_node(plan, -1)) return false;
    layout->node_count = real;
    return true;
}

static bool start(planner *plan, const lar_gid *order) {
    const lar_mesh *mesh = &plan->model->mesh;
    size_t elements = (size_t)mesh->element_count, nodes = (size_t)mesh->node_count;
    plan->open = lar_calloc(elements, sizeof *plan->open);
    plan->usable = lar_calloc(elements, sizeof *plan->usable);
    plan->run = lar_calloc(LONGEST_RUN, sizeof *plan->run);
    plan->run_corner = lar_calloc(LONGEST_RUN, sizeof *plan->run_corner);
    plan->layout->corner = lar_calloc(elements, sizeof *plan->layout->corner);
    plan->layout->local = lar_calloc(nodes, sizeof *plan->layout->local);
    plan->stamp = lar_calloc(nodes, sizeof *plan->stamp);
    if (!order || !plan->stamp || !plan->open || !plan->usable || !plan->run || !plan->run_corner ||
        !plan->layout->corner || !plan->layout->local)
        return false;
    memcpy(plan->layout->corner, mesh->element, elements * sizeof *mesh->element);
    for (size_t e = 0; e < elements; e++) plan->open[e] = plan->usable[e] = true;
    for (size_t n = 0; n < nodes; n++) plan->layout->local[n] = -1;
    memset(plan->waiting, -1, sizeof plan->waiting);
    return true;
}

lar_status lar_layout_create(const lar_model *model, lar_layout *layout, lar_error *error) {
    *layout = (lar_layout){0};
    planner plan = {.model = model, .layout = layout};
    size_t elements = (size_t)model->mesh.element_count;
    lar_gid *order = lar_calloc(elements, sizeof *order);
    bool built = start(&plan, order);
    lar_status status =
        built ? LAR_OK : lar_fail_memory(error, elements * 40, "the layout of the elements");
    if (!status) status = lar_order_elements(model, order, error);
    if (!status) status = lar_rows_neighbours(&model->mesh, &plan.neighbour, error);
    if (!status) {
        built = place_rows(&plan, order) && place_loose(&plan, order);
        if (built) release_waiting(&plan);
        if (!built || !sort_blocks(layout) || !number_rest(&plan))
            status = lar_fail_memory(error, elements * 40, "the layout of the elements");
    }
    free(order);
    free(plan.neighbour);
    free(plan.open);
    free(plan.usable);
    free(plan.run);
    free(plan.stamp);
    free(plan.run_corner);
    if (status) lar_layout_destroy(layout);
    return status;
}

void lar_layout_destroy(lar_layout *layout) {
    free(layout->corner);
    free(layout->block);
    free(layout->global);
    free(layout->local);
    *layout = (lar_layout){0};
}
