/* Abaqus and CalculiX decks: amplitudes, supports, initial velocities. See deck.h. */
#include <stdlib.h>
#include <string.h>

#include "model/format/inp/deck.h"
#include "model/rest.h"

/* ---- *AMPLITUDE ---------------------------------------------------------------------------- */

typedef struct points {
    size_t count, room;
    double (*at)[2];
} points;

/* Pairs of time and value, up to four on a line. */
static lar_status read_pairs(inp_deck *deck, points *list) {
    enum { PER_LINE = 8 };
    lar_span line, field[PER_LINE];
    lar_status status = LAR_OK;
    while (!status && inp_data_line(&deck->reader, &line)) {
        int count;
        status = inp_fields(deck, line, field, PER_LINE, &count);
        for (int i = 0; i < count && !status; i += 2) {
            if (!LAR_GROW(list->at, list->room, list->count))
                return inp_no_memory(deck, "an amplitude");
            double *pair = list->at[list->count];
            status = inp_number(deck, field, count, i, "a time", &pair[0]);
            if (!status) status = inp_number(deck, field, count, i + 1, "a value", &pair[1]);
            if (!status && list->count > 0 && !(pair[0] > list->at[list->count - 1][0]))
                status = inp_fail(deck, deck->reader.line, LAR_ERROR_FORMAT,
                                  "the time %g does not lie behind the one before it; sort the "
                                  "points by time",
                                  pair[0]);
            list->count++;
        }
    }
    return status;
}

/* 6 w^5 - 15 w^4 + 10 w^3 between two points, by chords: 64 of them are off by 1e-4 of the height,
 * and long tables are fine already. */
static bool sample_smooth_step(points *list) {
    const size_t pieces = list->count < 1000 ? 64 : 4;
    const size_t count = (list->count - 1) * pieces + 1;
    double(*at)[2] = lar_calloc(count, sizeof *at);
    if (!at) return false;
    for (size_t i = 0; i + 1 < count; i++) {
        const double *from = list->at[i / pieces], *to = list->at[i / pieces + 1];
        double w = (double)(i % pieces) / (double)pieces;
        at[i][0] = from[0] + w * (to[0] - from[0]);
        at[i][1] = from[1] + (to[1] - from[1]) * (w * w * w * (10.0 - 15.0 * w + 6.0 * w * w));
    }
    memcpy(at[count - 1], list->at[list->count - 1], sizeof *at);
    free(list->at);
    *list = (points){count, count, at};
    return true;
}

static lar_status check_amplitude(const inp_deck *deck, const inp_card *card, bool *smooth) {
    static const char known[] = "NAME,DEFINITION,TIME,VALUE";
    lar_span value;
    *smooth = false;
    lar_status status = inp_only(deck, card, known);
    if (status) return status;
    if (inp_parameter(card, "DEFINITION", &value)) {
        *smooth = lar_span_equal_nocase(value, "SMOOTH STEP");
        if (!*smooth && !lar_span_equal_nocase(value, "TABULAR"))
            return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                            "DEFINITION=%.*s is not read; TABULAR and SMOOTH STEP are",
                            inp_shown(value), value.at);
    }
    if (inp_parameter(card, "VALUE", &value) && !lar_span_equal_nocase(value, "RELATIVE"))
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "VALUE=%.*s is not read; give factors (VALUE=RELATIVE)", inp_shown(value),
                        value.at);
    return LAR_OK;
}

static lar_status keep_points(inp_deck *deck, points *list) {
    int index = deck->model->curve_count;
    lar_curve *curve = LAR_MODEL_APPEND(deck->model, curve);
    if (!curve) return inp_no_memory(deck, "an amplitude");
    *curve = (lar_curve){.kind = LAR_CURVE_TABLE, .count = (int)list->count, .point = list->at};
    list->at = NULL;
    deck->amplitude[deck->amplitude_count - 1].curve = index;
    return LAR_OK;
}

lar_status inp_read_amplitude(inp_deck *deck, const inp_card *card) {
    bool smooth;
    points list = {0};
    lar_status status = check_amplitude(deck, card, &smooth);
    if (!status) status = INP_ADD(deck, card, amplitude);
    if (!status) status = read_pairs(deck, &list);
    if (!status && list.count == 0)
        status = inp_fail(deck, card->line, LAR_ERROR_FORMAT,
                          "the amplitude has no points; add lines of time, value");
    if (!status && list.count > INT32_MAX / 64)
        status = inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                          "the amplitude has more points than a curve can have; thin it out");
    if (!status && smooth && list.count > 1 && !sample_smooth_step(&list))
        status = inp_no_memory(deck, "an amplitude");
    if (!status) status = keep_points(deck, &list);
    free(list.at);
    return status;
}

/* ---- *BOUNDARY ----------------------------------------------------------------------------- */

/* Names of supports: which of the displacements 1, 2, 3 they hold; rotations do not exist here. */
static bool named_support(lar_span word, unsigned *axes) {
    static const struct {
        const char *name;
        unsigned axes;
    } known[] = {
        {"ENCASTRE", LAR_AXIS_ALL},
        {"PINNED", LAR_AXIS_ALL},
        {"XSYMM", LAR_AXIS_X},
        {"YSYMM", LAR_AXIS_Y},
        {"ZSYMM", LAR_AXIS_Z},
        {"XASYMM", LAR_AXIS_Y | LAR_AXIS_Z},
        {"YASYMM", LAR_AXIS_X | LAR_AXIS_Z},
        {"ZASYMM", LAR_AXIS_X | LAR_AXIS_Y},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (lar_span_equal_nocase(word, known[i].name)) {
            *axes = known[i].axes;
            return true;
        }
    return false;
}

/* First and last degree of freedom as axes. 4 to 6 are rotations, which nodes of solids lack. */
static lar_status read_axes(inp_deck *deck, const lar_span *field, int count, unsigned *axes) {
    int64_t first, last;
    if (count > 1 && named_support(field[1], axes)) return LAR_OK;
    if (count < 2 || !lar_span_int64(field[1], &first))
        return inp_expected(&deck->reader, deck->reader.line,
                            "a degree of freedom 1 to 6, or a word such as ENCASTRE",
                            count < 2 ? (lar_span){"", 0} : field[1]);
    last = first;
    if (count > 2 && field[2].length > 0 && !lar_span_int64(field[2], &last))
        return inp_expected(&deck->reader, deck->reader.line, "the last degree of freedom",
                            field[2]);
    if (first < 1 || last > 6 || last < first)
        return inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                        "the degrees of freedom %lld to %lld are none of a solid, which has 1, 2, "
                        "3 (and rotations 4, 5, 6 that do nothing); remove the line",
                        (long long)first, (long long)last);
    *axes = 0;
    for (int64_t i = first; i <= last && i <= 3; i++) *axes |= 1u << (i - 1);
    return LAR_OK;
}

/* What the value of a line means for hold: fixed, or one more prescribed displacement. */
static lar_status hold_of(inp_deck *deck, double value, int curve, int32_t *hold) {
    *hold = 1;
    if (value == 0.0) return LAR_OK;
    size_t last = deck->prescribed_count;
    bool same = last > 0 && deck->prescribed[last - 1].by == value &&
                deck->prescribed[last - 1].curve == curve;
    if (!same) {
        if (last > INT32_MAX - 8 ||
            !LAR_GROW(deck->prescribed, deck->prescribed_room, deck->prescribed_count))
            return inp_no_memory(deck, "the supports");
        deck->prescribed[deck->prescribed_count++] = (inp_prescribed){value, curve};
    }
    *hold = 1 + (int32_t)deck->prescribed_count;
    return LAR_OK;
}

/* Abaqus/Explicit takes such a displacement for 0, CalculiX does not. */
static lar_status refuse_explicit(const inp_deck *deck, const inp_card *card) {
    lar_span name;
    if (!deck->step.explicit || deck->step.amplitude || inp_parameter(card, "AMPLITUDE", &name))
        return LAR_OK;
    return inp_fail(deck, deck->reader.line, LAR_ERROR_UNSUPPORTED,
                    "a displacement without AMPLITUDE in *DYNAMIC, EXPLICIT is 0 in Abaqus and "
                    "there at once in CalculiX; name the one that is meant (AMPLITUDE=)");
}

/* The curve of a displacement. Abaqus/Standard ramps those that name none in steps of all kinds;
 * CalculiX lets them jump in *DYNAMIC. */
static lar_status read_curve(inp_deck *deck, const inp_card *card, int *curve) {
    const bool dynamic = deck->step.procedure == INP_DYNAMIC;
    lar_span name;
    lar_status status = inp_in_step(deck, card);
    if (!status) status = refuse_explicit(deck, card);
    if (!status) status = inp_curve_of(deck, card, true, curve);
    if (status || deck->step.told || deck->step.procedure == INP_STATIC) return status;
    if (lar_curve_value(&deck->model->curve[*curve], 0.0) != 0.0) {
        deck->step.told = true;
        return inp_notice(deck, deck->reader.line, LAR_DISPLACED_AT_ONCE, "an *AMPLITUDE",
                          "AMPLITUDE");
    }
    if (!dynamic || deck->step.amplitude || inp_parameter(card, "AMPLITUDE", &name)) return LAR_OK;
    deck->step.told = true;
    return inp_notice(
        deck, deck->reader.line,
        "this displacement grows linearly over the step, as in Abaqus without "
        "AMPLITUDE; with AMPLITUDE=STEP of *STEP it is there at once, as in CalculiX");
}

static lar_status read_support(inp_deck *deck, const inp_card *card, lar_span line) {
    lar_span field[4];
    const int32_t *index;
    int32_t own, nodes = 0, hold = 1;
    int count, curve = 0;
    unsigned axes = 0;
    double value = 0.0;
    lar_status status = inp_fields(deck, line, field, 4, &count);
    if (!status) status = read_axes(deck, field, count, &axes);
    if (!status) status = inp_optional(deck, field, count, 3, "a displacement", 0.0, &value);
    if (status) return status;
    if (value != 0.0 && axes != 0) status = read_curve(deck, card, &curve);
    if (!status) status = inp_nodes(deck, field[0], &own, &index, &nodes);
    if (!status) status = hold_of(deck, value, curve, &hold);
    for (int32_t n = 0; n < nodes && !status; n++)
        for (int axis = 0; axis < 3; axis++)
            if (axes >> axis & 1) deck->hold[3 * (size_t)index[n] + (size_t)axis] = hold;
    return status;
}

/* OP of a card; *anew: what stood there before this step is removed. */
static lar_status read_op(const inp_deck *deck, const inp_card *card, bool *anew) {
    lar_span value;
    *anew = false;
    if (!inp_parameter(card, "OP", &value) || lar_span_equal_nocase(value, "MOD")) return LAR_OK;
    *anew = lar_span_equal_nocase(value, "NEW");
    if (*anew) return LAR_OK;
    return inp_fail(deck, card->line, LAR_ERROR_FORMAT, "OP=%.*s is neither NEW nor MOD",
                    inp_shown(value), value.at);
}

lar_status inp_read_boundary(inp_deck *deck, const inp_card *card) {
    static const char known[] = "OP,AMPLITUDE,TYPE";
    lar_span value, line;
    bool anew;
    lar_status status = inp_only(deck, card, known);
    if (!status) status = read_op(deck, card, &anew);
    if (!status && inp_parameter(card, "TYPE", &value) &&
        !lar_span_equal_nocase(value, "DISPLACEMENT"))
        status = inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                          "*BOUNDARY of type '%.*s' is not read; give displacements",
                          inp_shown(value), value.at);
    if (status) return status;
    if (anew && deck->step.open && !deck->step.supports)
        memset(deck->hold, 0, 3 * (size_t)deck->mesh->node_count * sizeof *deck->hold);
    deck->step.supports = deck->step.open;
    while (!status && inp_data_line(&deck->reader, &line)) status = read_support(deck, card, line);
    return status;
}

/* ---- supports as the model has them -------------------------------------------------------- */

/* The axes along which a node is fixed. */
static unsigned fixed_axes(const inp_deck *deck, int32_t node) {
    unsigned axes = 0;
    for (int axis = 0; axis < 3; axis++)
        if (deck->hold[3 * (size_t)node + (size_t)axis] == 1) axes |= 1u << axis;
    return axes;
}

/* All nodes that are fixed along exactly these axes. */
static lar_status finish_fixed(inp_deck *deck, unsigned axes) {
    int32_t nodes = deck->mesh->node_count, count = 0;
    for (int32_t n = 0; n < nodes; n++) count += fixed_axes(deck, n) == axes;
    if (count == 0) return LAR_OK;
    int32_t *list = lar_calloc((size_t)count, sizeof *list);
    lar_fix *fix = list ? LAR_MODEL_APPEND(deck->model, fix) : NULL;
    if (!fix) {
        free(list);
        return inp_no_memory(deck, "the supports");
    }
    *fix = (lar_fix){{0, list}, axes};
    for (int32_t n = 0; n < nodes; n++)
        if (fixed_axes(deck, n) == axes) list[fix->nodes.count++] = n;
    return LAR_OK;
}

static lar_status add_move(inp_deck *deck, int axis, const inp_prescribed *value, int32_t count) {
    int32_t *list = lar_calloc((size_t)count, sizeof *list);
    lar_move *move = list ? LAR_MODEL_APPEND(deck->model, move) : NULL;
    if (!move) {
        free(list);
        return inp_no_memory(deck, "the supports");
    }
    *move =
        (lar_move){.nodes = {0, list}, .axes = 1u << axis, .by = value->by, .curve = value->curve};
    return LAR_OK;
}

/* Moved nodes of one axis, an entry for each prescribed value that is left. `entry` has room for an
 * int32_t of each. */
static lar_status finish_moved(inp_deck *deck, int axis, int32_t *entry) {
    size_t kinds = deck->prescribed_count;
    int32_t nodes = deck->mesh->node_count;
    const int32_t *hold = deck->hold + axis;
    lar_status status = LAR_OK;
    memset(entry, 0, kinds * sizeof *entry);
    for (int32_t n = 0; n < nodes; n++)
        if (hold[3 * (size_t)n] > 1) entry[hold[3 * (size_t)n] - 2]++;
    for (size_t k = 0; k < kinds && !status; k++) {
        if (entry[k] == 0) continue;
        status = add_move(deck, axis, &deck->prescribed[k], entry[k]);
        entry[k] = deck->model->move_count - 1;
    }
    for (int32_t n = 0; n < nodes && !status; n++) {
        if (hold[3 * (size_t)n] <= 1) continue;
        lar_node_list *list = &deck->model->move[entry[hold[3 * (size_t)n] - 2]].nodes;
        list->node[list->count++] = n;
    }
    return status;
}

static lar_status finish_velocities(inp_deck *deck) {
    inp_vector *vector = NULL;
    int32_t count = 0;
    if (deck->velocity && inp_is_static(deck))
        return inp_notice(deck, deck->velocity_line,
                          "initial velocities were left out: they do not count in a static step");
    lar_status status =
        deck->velocity ? inp_sort_vectors(deck, (const double(*)[3])deck->velocity, &vector, &count)
                       : LAR_OK;
    for (int32_t i = 0, end = 0; i < count && !status; i = end) {
        lar_initial_velocity *initial = LAR_MODEL_APPEND(deck->model, initial);
        if (!initial) status = inp_no_memory(deck, "the initial velocities");
        if (status) break;
        memcpy(initial->velocity, vector[i].value, sizeof initial->velocity);
        status = inp_take_run(deck, vector, count, i, &initial->nodes, &end);
    }
    free(vector);
    return status;
}

lar_status inp_finish_supports(inp_deck *deck) {
    int32_t *entry = lar_calloc(deck->prescribed_count, sizeof *entry);
    if (!entry) return inp_no_memory(deck, "the supports");
    lar_status status = LAR_OK;
    for (unsigned axes = 1; axes <= LAR_AXIS_ALL && !status; axes++)
        status = finish_fixed(deck, axes);
    for (int axis = 0; axis < 3 && !status; axis++) status = finish_moved(deck, axis, entry);
    free(entry);
    return status ? status : finish_velocities(deck);
}

/* ---- vectors of nodes ---------------------------------------------------------------------- */

static int compare_vectors(const void *a, const void *b) {
    const inp_vector *x = a, *y = b;
    for (int i = 0; i < 3; i++)
        if (x->value[i] != y->value[i]) return x->value[i] < y->value[i] ? -1 : 1;
    return (x->node > y->node) - (x->node < y->node);
}

lar_status inp_sort_vectors(const inp_deck *deck, const double (*value)[3], inp_vector **vector,
                            int32_t *count) {
    int32_t nodes = deck->mesh->node_count;
    *count = 0;
    *vector = lar_calloc((size_t)nodes, sizeof **vector);
    if (!*vector) return inp_no_memory(deck, "the loads");
    for (int32_t n = 0; n < nodes; n++) {
        if (value[n][0] == 0.0 && value[n][1] == 0.0 && value[n][2] == 0.0) continue;
        inp_vector *made = &(*vector)[(*count)++];
        memcpy(made->value, value[n], sizeof made->value);
        made->node = n;
    }
    qsort(*vector, (size_t)*count, sizeof **vector, compare_vectors);
    return LAR_OK;
}

lar_status inp_take_run(const inp_deck *deck, const inp_vector *vector, int32_t count,
                        int32_t first, lar_node_list *nodes, int32_t *end) {
    int32_t last = first;
    while (last < count &&
           memcmp(vector[last].value, vector[first].value, sizeof vector->value) == 0)
        last++;
    nodes->node = lar_calloc((size_t)(last - first), sizeof *nodes->node);
    if (!nodes->node) return inp_no_memory(deck, "the loads");
    for (int32_t i = first; i < last; i++) nodes->node[nodes->count++] = vector[i].node;
    *end = last;
    return LAR_OK;
}

/* ---- *INITIAL CONDITIONS ------------------------------------------------------------------- */

lar_status inp_read_initial(inp_deck *deck, const inp_card *card) {
    static const char known[] = "TYPE";
    lar_span type, line, field[3];
    lar_status status = inp_only(deck, card, known);
    if (!status) status = inp_need(deck, card, "TYPE", &type);
    if (status) return status;
    if (!lar_span_equal_nocase(type, "VELOCITY"))
        return inp_fail(deck, card->line, LAR_ERROR_UNSUPPORTED,
                        "*INITIAL CONDITIONS of type '%.*s' is not read and would change the "
                        "answer; Lariat reads TYPE=VELOCITY",
                        inp_shown(type), type.at);
    if (!deck->velocity)
        deck->velocity = lar_calloc((size_t)deck->mesh->node_count, sizeof *deck->velocity);
    if (!deck->velocity) return inp_no_memory(deck, "the initial velocities");
    deck->velocity_line = card->line;
    while (!status && inp_data_line(&deck->reader, &line)) {
        const int32_t *index;
        int32_t own, nodes = 0;
        int count;
        int64_t axis = 0;
        double value;
        status = inp_fields(deck, line, field, 3, &count);
        if (!status && (count < 2 || !lar_span_int64(field[1], &axis) || axis < 1 || axis > 3))
            status = inp_expected(&deck->reader, deck->reader.line, "a direction 1, 2 or 3",
                                  count < 2 ? (lar_span){"", 0} : field[1]);
        if (!status) status = inp_number(deck, field, count, 2, "a velocity", &value);
        if (!status) status = inp_nodes(deck, field[0], &own, &index, &nodes);
        for (int32_t n = 0; n < nodes && !status; n++) deck->velocity[index[n]][axis - 1] = value;
    }
    return status;
}
