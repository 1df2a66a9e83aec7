/* FEBio decks: <LoadData>. See feb.h.
 *
 * Load curves become tables. What FEBio calls interpolation, as FEBio computes it:
 *   LINEAR       straight                                -> LAR_CURVE_LINEAR
 *   STEP         the value of the next point             -> LAR_CURVE_STEP
 *   SMOOTH       two points: straight; more: parabolas through three neighbours, blended over
 *                each interval                           -> sampled finely, LAR_CURVE_LINEAR
 *   SMOOTH STEP  6 w^5 - 15 w^4 + 10 w^3 per interval    -> sampled finely, LAR_CURVE_LINEAR
 * What goes on beyond its points gets more of them, up to the end of the run.
 */
#include "model/format/feb/feb.h"

#include <stdlib.h>
#include <string.h>

typedef double point[2]; /* time, value */

typedef struct points {
    int count;
    size_t room;
    point *at;
} points;

typedef enum interpolation { LINEAR, STEP, SMOOTH, SMOOTH_STEP } interpolation;

/* Parabola through three points. */
static double parabola(double t, const point *p) {
    double a =
        p[0][1] * ((p[1][0] - t) * (p[2][0] - t)) / ((p[1][0] - p[0][0]) * (p[2][0] - p[0][0]));
    double b =
        p[1][1] * ((t - p[0][0]) * (p[2][0] - t)) / ((p[1][0] - p[0][0]) * (p[2][0] - p[1][0]));
    double c =
        p[2][1] * ((t - p[0][0]) * (t - p[1][0])) / ((p[2][0] - p[0][0]) * (p[2][0] - p[1][0]));
    return a + b + c;
}

/* Value within interval i (between points i and i + 1) at the fraction w of it. */
static double smooth_value(const points *list, interpolation how, int i, double w) {
    const point *p = list->at;
    if (how == SMOOTH_STEP)
        return p[i][1] + (p[i + 1][1] - p[i][1]) * (w * w * w * (10.0 - 15.0 * w + 6.0 * w * w));
    double t = p[i][0] + w * (p[i + 1][0] - p[i][0]);
    if (i == 0) return parabola(t, p);
    if (i == list->count - 2) return parabola(t, p + i - 1);
    return (1.0 - w) * parabola(t, p + i - 1) + w * parabola(t, p + i);
}

/* Replaces the points by many on the smooth curve. False without memory. */
static bool sample(points *list, interpolation how) {
    /* The error of chords falls with the square of the pieces: 64 give 1e-4 of the height. Long
     * tables are fine already and must not grow without bound. */
    const int pieces = list->count < 1000 ? 64 : 4;
    const size_t count = (size_t)(list->count - 1) * (size_t)pieces + 1;
    point *at = lar_calloc(count, sizeof *at);
    if (!at) return false;
    size_t used = 0;
    for (int i = 0; i + 1 < list->count; i++)
        for (int k = 0; k < pieces; k++, used++) {
            double w = (double)k / pieces;
            at[used][0] = list->at[i][0] + w * (list->at[i + 1][0] - list->at[i][0]);
            at[used][1] = k ? smooth_value(list, how, i, w) : list->at[i][1];
        }
    memcpy(at[used], list->at[list->count - 1], sizeof *at);
    free(list->at);
    *list = (points){(int)count, count, at};
    return true;
}

static bool append(points *list, double time, double value) {
    if (!LAR_GROW(list->at, list->room, list->count)) return false;
    list->at[list->count][0] = time;
    list->at[list->count++][1] = value;
    return true;
}

/* The points once more from the last one's time on, until `end`; `rise` more in each round. */
static bool repeat(points *list, interpolation how, double end, double rise) {
    const int count = list->count;
    const double period = list->at[count - 1][0] - list->at[0][0];
    const bool joined = how == STEP || list->at[count - 1][1] == list->at[0][1] + rise;
    for (int round = 1; list->at[list->count - 1][0] < end; round++)
        for (int i = joined ? 1 : 0; i < count; i++)
            if (!append(list, list->at[i][0] + round * period, list->at[i][1] + round * rise))
                return false;
    return true;
}

/* Straight on from the last two points until `end`. */
static bool extrapolate(points *list, double end) {
    const double *last = list->at[list->count - 1], *before = list->at[list->count - 2];
    double slope = (last[1] - before[1]) / (last[0] - before[0]);
    return append(list, end, last[1] + slope * (end - last[0]));
}

/* Reads the points of a load curve; times may repeat (a jump) but not go back. */
static lar_status read_points(lar_feb *feb, const xmlNode *controller, points *list) {
    const xmlNode *holder = lar_feb_child(controller, "points");
    xmlNode *node = holder ? lar_feb_first(holder) : NULL;
    for (; node; node = lar_feb_next(node)) {
        if (!lar_feb_is(node, "pt") && !lar_feb_is(node, "point"))
            return lar_feb_fail(feb, node, LAR_ERROR_FORMAT,
                                "<%s> stands among the points of a load curve; only "
                                "<pt>time,value</pt> belongs there",
                                (const char *)node->name);
        if (!LAR_GROW(list->at, list->room, list->count))
            return lar_feb_no_memory(feb, "a load curve");
        double *pair = list->at[list->count];
        lar_status status = lar_feb_doubles(feb, node, pair, 2);
        if (status) return status;
        if (list->count > 0 && pair[0] < list->at[list->count - 1][0])
            return lar_feb_fail(feb, node, LAR_ERROR_FORMAT,
                                "the time %g of this point lies before that of the point above; "
                                "sort the points by time",
                                pair[0]);
        list->count++;
    }
    if (list->count > 0) return LAR_OK;
    return lar_feb_fail(feb, controller, LAR_ERROR_FORMAT,
                        "the load curve has no points; add <points><pt>time,value</pt></points>");
}

/* Which interpolation; false for one that Lariat does not have. */
static bool find_interpolation(lar_feb *feb, const xmlNode *controller, interpolation *how) {
    static const struct {
        const char *name;
        interpolation how;
    } known[] = {{"LINEAR", LINEAR},
                 {"STEP", STEP},
                 {"SMOOTH", SMOOTH},
                 {"SMOOTH STEP", SMOOTH_STEP},
                 {"SMOOTH_STEP", SMOOTH_STEP}};
    *how = LINEAR;
    const xmlNode *node = lar_feb_child(controller, "interpolate");
    if (!node) return true;
    lar_span text = lar_feb_text(feb, node);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (lar_span_equal_nocase(text, known[i].name)) {
            *how = known[i].how;
            return true;
        }
    return false;
}

/* How a curve goes on beyond its points: CONSTANT where the run never goes there. */
static lar_span extension(lar_feb *feb, const xmlNode *controller, const points *list) {
    const xmlNode *node = lar_feb_child(controller, "extend");
    const lar_span held = {"CONSTANT", 8};
    if (!node || (feb->model->duration > 0.0 && list->at[0][0] <= 0.0 &&
                  list->at[list->count - 1][0] >= feb->model->duration))
        return held;
    return lar_feb_text(feb, node);
}

/* False for what is not read: what begins behind time 0, and more points than anybody means. */
static bool extend(lar_feb *feb, lar_span how, interpolation between, points *list, bool *enough) {
    const double end = feb->model->duration, from = list->at[0][0];
    const double period = list->at[list->count - 1][0] - from;
    const bool offset = lar_span_equal_nocase(how, "REPEAT OFFSET");
    if (lar_span_equal_nocase(how, "CONSTANT")) return true;
    if (!(end > 0) || from > 0 || !(end / period * list->count < 1e6)) return false;
    if (offset || lar_span_equal_nocase(how, "REPEAT"))
        *enough =
            repeat(list, between, end, offset ? list->at[list->count - 1][1] - list->at[0][1] : 0);
    else if (lar_span_equal_nocase(how, "EXTRAPOLATE") && between == LINEAR &&
             list->at[list->count - 2][0] < list->at[list->count - 1][0])
        *enough = extrapolate(list, end);
    else
        return false;
    return true;
}

/* Jumps have no parabola through them. */
static bool has_jump(const points *list) {
    for (int i = 1; i < list->count; i++)
        if (list->at[i][0] == list->at[i - 1][0]) return true;
    return false;
}

/* Makes the model's curve of the points, or says in entry->problem why it cannot be. */
static lar_status make_curve(lar_feb *feb, lar_feb_controller *entry, points *list) {
    interpolation how;
    if (!find_interpolation(feb, entry->node, &how)) {
        entry->problem = "has an interpolation that is not read (LINEAR, STEP, SMOOTH and SMOOTH "
                         "STEP are)";
        return LAR_OK;
    }
    if (how != LINEAR && has_jump(list)) {
        entry->problem = "has two points at the same time, which only LINEAR allows";
        return LAR_OK;
    }
    const lar_span beyond = extension(feb, entry->node, list);
    bool enough = true;
    if ((how == SMOOTH && list->count > 2) || (how == SMOOTH_STEP && list->count > 1))
        enough = sample(list, how);
    if (enough && !extend(feb, beyond, how, list, &enough)) {
        entry->problem =
            !(feb->model->duration > 0)
                ? "goes on beyond its points, and the deck has no duration up to which; give it "
                  "<time_steps> and <step_size>"
                : "is extended beyond its points in a way that is not read (CONSTANT is; "
                  "from time 0 on REPEAT and REPEAT OFFSET, and EXTRAPOLATE of LINEAR); add "
                  "points up to the end of the run";
        return LAR_OK;
    }
    if (!enough) return lar_feb_no_memory(feb, "a load curve");
    int index = feb->model->curve_count;
    lar_curve *curve = LAR_MODEL_APPEND(feb->model, curve);
    if (!curve) return lar_feb_no_memory(feb, "a load curve");
    *curve = (lar_curve){.kind = LAR_CURVE_TABLE,
                         .shape = how == STEP ? LAR_CURVE_STEP : LAR_CURVE_LINEAR,
                         .count = list->count,
                         .point = list->at};
    *list = (points){0};
    entry->curve = index;
    return LAR_OK;
}

static lar_status read_controller(lar_feb *feb, xmlNode *node) {
    int64_t id;
    const char *type;
    lar_status status = lar_feb_id_attribute(feb, node, "id", &id);
    if (!status) status = lar_feb_need_attribute(feb, node, "type", &type);
    if (status) return status;
    for (int i = 0; i < feb->controller_count; i++)
        if (feb->controller[i].id == id)
            return lar_feb_fail(feb, node, LAR_ERROR_FORMAT,
                                "a second load controller has the id %lld; renumber one of them",
                                (long long)id);
    enum { MAX = 10000 }; /* the search above is linear */
    if (feb->controller_count >= MAX)
        return lar_feb_fail(feb, node, LAR_ERROR_UNSUPPORTED,
                            "more than %d load controllers; remove those that nothing uses", MAX);
    if (!LAR_GROW(feb->controller, feb->controller_room, feb->controller_count))
        return lar_feb_no_memory(feb, "the load curves");
    lar_feb_controller *entry = &feb->controller[feb->controller_count++];
    *entry = (lar_feb_controller){id, node, -1, NULL};
    if (strcmp(type, "loadcurve") != 0) {
        entry->problem = "is not of type loadcurve, the only one that is read";
        return LAR_OK;
    }
    points list = {0};
    status = lar_feb_notice_others(feb, node, "interpolate extend points");
    if (!status) status = read_points(feb, node, &list);
    if (!status) status = make_curve(feb, entry, &list);
    free(list.at);
    return status;
}

lar_status lar_feb_read_curves(lar_feb *feb) {
    const xmlNode *section = lar_feb_child(feb->root, "LoadData");
    xmlNode *node = section ? lar_feb_first(section) : NULL;
    lar_status status = LAR_OK;
    for (; node && !status; node = lar_feb_next(node)) {
        if (lar_feb_is(node, "load_controller"))
            status = read_controller(feb, node);
        else
            status = lar_feb_notice(feb, node, "<%s> in <LoadData> is not known and was left out",
                                    (const char *)node->name);
    }
    return status;
}

/* The curve of a value without lc: 1 from the start. */
static lar_status constant_curve(lar_feb *feb, int *curve) {
    if (feb->constant_curve < 0) {
        int index = feb->model->curve_count;
        lar_curve *entry = LAR_MODEL_APPEND(feb->model, curve);
        if (!entry) return lar_feb_no_memory(feb, "a curve");
        entry->kind = LAR_CURVE_RAMP;
        feb->constant_curve = index;
    }
    *curve = feb->constant_curve;
    return LAR_OK;
}

lar_status lar_feb_curve_of(lar_feb *feb, const xmlNode *value, int *curve) {
    const char *type = lar_feb_attribute(feb, value, "type");
    if (type && strcmp(type, "const") != 0)
        return lar_feb_fail(feb, value, LAR_ERROR_UNSUPPORTED,
                            "<%s> is a %.40s, which is not read; give it a number",
                            (const char *)value->name, type);
    if (lar_feb_attribute(feb, value, "node_data") || lar_feb_attribute(feb, value, "surface_data"))
        return lar_feb_fail(feb, value, LAR_ERROR_UNSUPPORTED,
                            "<%s> is a map on %s, which is not read; give it a number",
                            (const char *)value->name,
                            lar_feb_attribute(feb, value, "node_data") ? "nodes" : "a surface");
    if (!curve) return LAR_OK;
    if (!lar_feb_attribute(feb, value, "lc")) return constant_curve(feb, curve);
    int64_t id;
    lar_status status = lar_feb_id_attribute(feb, value, "lc", &id);
    if (status) return status;
    const lar_feb_controller *entry = NULL;
    for (int i = 0; i < feb->controller_count && !entry; i++)
        if (feb->controller[i].id == id) entry = &feb->controller[i];
    if (!entry)
        return lar_feb_fail(feb, value, LAR_ERROR_FORMAT,
                            "<%s> names the load controller %lld, which <LoadData> does not "
                            "define; define it or correct lc",
                            (const char *)value->name, (long long)id);
    if (entry->curve < 0)
        return lar_feb_fail(feb, entry->node, LAR_ERROR_UNSUPPORTED,
                            "load controller %lld, used in line %d, %s", (long long)id,
                            lar_feb_line(value), entry->problem);
    *curve = entry->curve;
    return LAR_OK;
}
