#include "study/inverse/measured.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "study/inverse/aspiration.h"
#include "study/inverse/table.h"

/* ---- columns --------------------------------------------------------------------------------- */

static const char *const column_name[] = {
    "time", "displacement", "stretch", "depth", "force",    "x",     "y", "z",
    "to_x", "to_y",         "to_z",    "r",     "pressure", "error", NULL};
enum {
    TIME,
    DISPLACEMENT,
    STRETCH,
    DEPTH,
    FORCE,
    X,
    Y,
    Z,
    TO_X,
    TO_Y,
    TO_Z,
    R,
    PRESSURE,
    ERROR,
    COLUMNS
};

typedef struct source {
    const lar_scene *scene;
    const lar_yaml *node;
    lar_inverse_experiment *e;
    lar_inverse_table table;
    int column[COLUMNS]; /* of the table; -1: not there */
    double scale[COLUMNS];
} source;

static lar_status find_columns(source *s) {
    const lar_yaml *names = lar_yaml_get(s->node, "columns"),
                   *scales = lar_yaml_get(s->node, "scale");
    lar_status status = LAR_OK;
    if (names) status = lar_scene_keys(s->scene, names, "columns", column_name);
    if (!status && scales) status = lar_scene_keys(s->scene, scales, "scale", column_name);
    for (int c = 0; c < COLUMNS && !status; c++) {
        const lar_yaml *name = lar_yaml_get(names, column_name[c]),
                       *scale = lar_yaml_get(scales, column_name[c]);
        const char *text = column_name[c];
        s->scale[c] = 1;
        if (name) status = lar_scene_text(s->scene, name, "the name of a column", &text);
        if (!status && scale)
            status = lar_scene_number(s->scene, scale, "a number, for example 0.001", &s->scale[c]);
        if (status) break;
        s->column[c] = lar_inverse_table_find(&s->table, text);
        /* The pressure's own table may have names that this one has not. */
        bool elsewhere = s->e->pressure && (c == PRESSURE || c == TIME);
        if (s->column[c] < 0 && elsewhere)
            s->column[c] = lar_inverse_table_find(&s->table, column_name[c]);
        if (name && s->column[c] < 0 && !elsewhere)
            return lar_scene_fail(s->scene, name, LAR_ERROR_FORMAT, "%s:%d has no column %s",
                                  s->table.path, s->table.header_line, text);
    }
    return status;
}

static lar_status need(const source *s, int c) {
    if (s->column[c] >= 0) return LAR_OK;
    return lar_fail(s->scene->error, LAR_ERROR_FORMAT,
                    "%s:%d: the column %s is missing, which %s needs; name it so, or say columns: "
                    "{%s: NAME} in %s:%d",
                    s->table.path, s->table.header_line, column_name[c],
                    lar_inverse_kind_name[s->e->kind], column_name[c], s->scene->path,
                    s->node->line);
}

/* A new array of a column's numbers. */
static lar_status take(const source *s, int c, double **to) {
    *to = lar_calloc((size_t)s->table.rows, sizeof **to);
    if (!*to) return lar_scene_no_memory(s->scene, (size_t)s->table.rows);
    return lar_inverse_table_take(&s->table, s->column[c], s->scale[c], *to, s->scene->error);
}

static lar_status take_vectors(const source *s, int first, double (**to)[3]) {
    size_t rows = (size_t)s->table.rows;
    double *one = NULL;
    *to = lar_calloc(rows, sizeof **to);
    lar_status status = *to ? LAR_OK : lar_scene_no_memory(s->scene, rows);
    for (int k = 0; k < 3 && !status; k++) {
        status = need(s, first + k);
        if (!status) status = take(s, first + k, &one);
        for (size_t i = 0; i < rows && !status; i++) (*to)[i][k] = one[i];
        free(one);
        one = NULL;
    }
    return status;
}

/* ---- does it fit the body -------------------------------------------------------------------- */

static double body_size(const lar_model *m, int only_axis) {
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (int32_t i = 0; i < m->mesh.node_count; i++) {
            low = fmin(low, m->mesh.position[i][k]);
            high = fmax(high, m->mesh.position[i][k]);
        }
        if (only_axis < 0 || only_axis == k) longest = fmax(longest, high - low);
    }
    return longest;
}

static lar_status check_length(const source *s, int32_t row, int c, double value) {
    double size = body_size(s->e->model, -1);
    if (fabs(value) <= size) return LAR_OK;
    return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                    "%s:%d: %s is %g m, and the body of %s is only %g m long; were millimetres "
                    "measured? Then say scale: {%s: 0.001} in %s:%d",
                    s->table.path, s->table.line[row], column_name[c], value, s->e->scene, size,
                    column_name[c], s->scene->path, s->node->line);
}

/* ---- curves ---------------------------------------------------------------------------------- */

/* Growing times; several rows of one moment where a moment `may_repeat`. */
static lar_status read_time(const source *s, bool may_repeat, double **to) {
    const char *path = s->table.path;
    lar_status status = take(s, TIME, to);
    const double *time = *to;
    for (int32_t i = 0; i < s->table.rows && !status; i++) {
        if (time[i] < 0)
            status =
                lar_fail(s->scene->error, LAR_ERROR_FORMAT, "%s:%d: time %g is before the start, 0",
                         path, s->table.line[i], time[i]);
        else if (i > 0 && !(time[i] > time[i - 1]) && !(may_repeat && time[i] == time[i - 1]))
            status = lar_fail(s->scene->error, LAR_ERROR_FORMAT,
                              "%s:%d: time %g does not come after %g; times must grow from row to "
                              "row: sort them, or leave the repeated row out",
                              path, s->table.line[i], time[i], time[i - 1]);
    }
    return status;
}

/* The length at rest: said, or the body's along that axis. */
static lar_status read_length(const source *s, int axis, double *length) {
    const lar_yaml *own = lar_yaml_get(s->node, "length");
    const double size = body_size(s->e->model, -1);
    *length = body_size(s->e->model, axis);
    lar_status status = own ? lar_scene_positive(s->scene, own, LAR_IN_METRES, length) : LAR_OK;
    if (status || *length <= 2 * size) return status;
    return lar_scene_fail(s->scene, own, LAR_ERROR_MODEL,
                          "length: %g m, and the body of %s is only %g m long; were millimetres "
                          "measured? Then say length: %g",
                          *length, s->e->scene, size, 0.001 * *length);
}

/* Every one is in a range that tissue and elements bear, and one at least is of the kind. */
static lar_status check_stretches(const source *s) {
    static const double LEAST = 0.1, MOST = 20;
    const lar_inverse_experiment *e = s->e;
    const bool pressed = e->kind == LAR_INVERSE_COMPRESSION;
    bool fits = false, other = false;
    for (int32_t i = 0; i < e->rows; i++) {
        const double stretch = e->along[i];
        if (!(stretch >= LEAST && stretch < MOST))
            return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                            "%s:%d: the stretch is %g; it is a length over the length at rest, 1 "
                            "at rest: was a strain or a displacement measured?",
                            s->table.path, s->table.line[i], stretch);
        fits = fits || (pressed ? stretch < 1 : stretch > 1);
        other = other || stretch != 1;
    }
    if (fits || !other) return LAR_OK;
    return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                    "%s:%d: no stretch is %s 1, and %s:%d says kind: %s; say kind: %s, or was a "
                    "strain measured? A stretch is a length over the length at rest, 1 at rest",
                    s->table.path, s->table.line[0], pressed ? "below" : "above", s->scene->path,
                    s->node->line, lar_inverse_kind_name[e->kind],
                    lar_inverse_kind_name[pressed ? LAR_INVERSE_TENSION : LAR_INVERSE_COMPRESSION]);
}

/* Which way along its axis the support makes the body longer, 1 or -1; 0: it sits in the middle. */
static double longer(const lar_model *m, const lar_node_list *support, int axis) {
    static const double MIDDLE = 0.1;
    double low = INFINITY, high = -INFINITY, mean = 0;
    for (int32_t i = 0; i < m->mesh.node_count; i++) {
        low = fmin(low, m->mesh.position[i][axis]);
        high = fmax(high, m->mesh.position[i][axis]);
    }
    for (int32_t i = 0; i < support->count; i++)
        mean += m->mesh.position[support->node[i]][axis] / support->count;
    const double off = mean - 0.5 * (low + high);
    return fabs(off) <= MIDDLE * (high - low) ? 0 : off < 0 ? -1 : 1;
}

/* Displacement from stretch. Its positive way is where the kind goes, whatever the scene's. */
static lar_status read_stretch(const source *s) {
    lar_inverse_experiment *e = s->e;
    const lar_move *move = &e->model->move[e->move];
    const int axis = move->axes == LAR_AXIS_X ? 0 : move->axes == LAR_AXIS_Y ? 1 : 2;
    const double sign = e->kind == LAR_INVERSE_COMPRESSION ? -1 : 1;
    double length;
    lar_status status = read_length(s, axis, &length);
    if (!status) status = take(s, STRETCH, &e->along);
    if (!status) status = check_stretches(s);
    e->way = sign * longer(e->model, &move->nodes, axis);
    if (!status && e->way == 0)
        return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                        "%s:%d: the support of %s is moved along %c and sits in the middle of the "
                        "body there, so that no stretch says where it goes; give displacement",
                        s->table.path, s->table.header_line, e->scene, "xyz"[axis]);
    for (int32_t i = 0; i < e->rows && !status; i++)
        e->along[i] = sign * (e->along[i] - 1) * length;
    return status;
}

static lar_status read_along(const source *s) {
    lar_inverse_experiment *e = s->e;
    int c = e->kind == LAR_INVERSE_INDENTATION ? DEPTH : DISPLACEMENT;
    if (c == DISPLACEMENT && s->column[DISPLACEMENT] >= 0 && s->column[STRETCH] >= 0)
        return lar_scene_fail(s->scene, s->node, LAR_ERROR_FORMAT,
                              "%s has displacement and stretch; leave one out", s->table.path);
    if (c == DISPLACEMENT && s->column[STRETCH] >= 0) return read_stretch(s);
    /* In time the scene may move the support itself. */
    if (c == DISPLACEMENT && s->column[c] < 0 && e->time) {
        e->in_time = true;
        return LAR_OK;
    }
    lar_status status = need(s, c);
    if (!status) status = take(s, c, &e->along);
    for (int32_t i = 0; i < e->rows && !status; i++) status = check_length(s, i, c, e->along[i]);
    return status;
}

static lar_status check_curve(const source *s) {
    const lar_inverse_experiment *e = s->e;
    const lar_inverse_table *t = &s->table;
    if (e->in_time && !e->time)
        return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                        "%s:%d: the column time is missing, and a material of %s is viscous: its "
                        "force depends on how fast it is strained",
                        t->path, t->header_line, e->scene);
    if (e->in_time && e->along && e->time[0] == 0 && e->along[0] != 0)
        return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                        "%s:%d: at time 0 it is moved already, and nothing moves in no time; begin "
                        "with 0, and give the way there the time that it took",
                        t->path, t->line[0]);
    bool moved = !e->along;
    for (int32_t i = 0; i < e->rows; i++) moved = moved || e->along[i] != 0;
    if (!moved)
        return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                        "%s:%d: nothing is moved in any row, so nothing is strained", t->path,
                        t->line[0]);
    return LAR_OK;
}

static lar_status read_curve(source *s) {
    lar_inverse_experiment *e = s->e;
    e->values = e->rows;
    lar_status status = s->column[TIME] >= 0 ? read_time(s, false, &e->time) : LAR_OK;
    if (!status) status = read_along(s);
    if (!status) status = need(s, FORCE);
    if (!status) status = take(s, FORCE, &e->measured);
    return status ? status : check_curve(s);
}

/* ---- profiles
 * ------------------------------------------------------------------------------------
 */

static lar_status check_suction(const source *s, const lar_inverse_table *table, int32_t row,
                                double pressure) {
    if (pressure >= 0) return LAR_OK;
    return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                    "%s:%d: the pressure is %g Pa; it is measured by how far it is below the one "
                    "outside, positive when it sucks: say scale: {pressure: -1} in %s:%d",
                    table->path, table->line[row], pressure, s->scene->path, s->node->line);
}

/* The pressure's own table, as the curve of a run. */
static lar_status read_suction(source *s) {
    lar_inverse_aspiration *a = &s->e->aspiration;
    source own = {.scene = s->scene, .node = s->node, .e = s->e};
    double *time = NULL, *pressure = NULL;
    const lar_yaml *names = lar_yaml_get(s->node, "columns");
    lar_status status = lar_inverse_table_read(s->e->pressure, &own.table, s->scene->error);
    for (int c = 0; c < COLUMNS && !status; c++) {
        const lar_yaml *name = lar_yaml_get(names, column_name[c]);
        own.scale[c] = s->scale[c];
        own.column[c] = lar_inverse_table_find(&own.table, name ? name->text : column_name[c]);
        if (own.column[c] < 0) own.column[c] = lar_inverse_table_find(&own.table, column_name[c]);
    }
    if (!status) status = need(&own, TIME);
    if (!status) status = need(&own, PRESSURE);
    if (!status) status = read_time(&own, false, &time);
    if (!status) status = take(&own, PRESSURE, &pressure);
    a->suction = status ? NULL : lar_calloc((size_t)own.table.rows, sizeof *a->suction);
    if (!status && !a->suction) status = lar_scene_no_memory(s->scene, (size_t)own.table.rows);
    for (a->points = 0; a->points < own.table.rows && !status; a->points++) {
        status = check_suction(s, &own.table, a->points, pressure[a->points]);
        a->suction[a->points][0] = time[a->points];
        a->suction[a->points][1] = pressure[a->points];
    }
    free(time);
    free(pressure);
    lar_inverse_table_clear(&own.table);
    return status;
}

static lar_status take_suction_of_rows(source *s) {
    lar_inverse_experiment *e = s->e;
    lar_inverse_aspiration *a = &e->aspiration;
    double *pressure = NULL;
    lar_status status = take(s, PRESSURE, &pressure);
    a->suction = status ? NULL : lar_calloc((size_t)e->rows, sizeof *a->suction);
    if (!status && !a->suction) status = lar_scene_no_memory(s->scene, (size_t)e->rows);
    for (int32_t i = 0; i < e->rows && !status; i++) {
        status = check_suction(s, &s->table, i, pressure[i]);
        bool again = e->in_time && i > 0 && e->time[i] == e->time[i - 1];
        if (!again) a->points++;
        a->suction[a->points - 1][0] = e->time ? e->time[i] : 0;
        a->suction[a->points - 1][1] = pressure[i];
    }
    free(pressure);
    return status;
}

/* At rest every row has its pressure, in between those that were measured. */
static lar_status settle_suction(source *s) {
    lar_inverse_experiment *e = s->e;
    lar_inverse_aspiration *a = &e->aspiration;
    double(*of_row)[2] = lar_calloc((size_t)e->rows, sizeof *of_row);
    if (!of_row) return lar_scene_no_memory(s->scene, (size_t)e->rows);
    for (int32_t i = 0, k = 0; i < e->rows; i++) {
        while (k + 2 < a->points && a->suction[k + 1][0] < e->time[i]) k++;
        const double *from = a->suction[k], *to = a->suction[k + 1];
        double part = fmin(fmax((e->time[i] - from[0]) / (to[0] - from[0]), 0), 1);
        of_row[i][0] = e->time[i];
        of_row[i][1] = from[1] + part * (to[1] - from[1]);
    }
    free(a->suction);
    a->suction = of_row;
    a->points = e->rows;
    return LAR_OK;
}

static lar_status read_pressures(source *s) {
    lar_inverse_experiment *e = s->e;
    lar_inverse_aspiration *a = &e->aspiration;
    if (e->pressure && s->column[PRESSURE] >= 0)
        return lar_scene_fail(s->scene, s->node, LAR_ERROR_FORMAT,
                              "%s has a column pressure, and %s is given too; leave one out",
                              s->table.path, e->pressure);
    if (!e->time && (e->in_time || s->column[PRESSURE] < 0)) return need(s, TIME);
    if (!e->pressure && s->column[PRESSURE] < 0) {
        e->in_time = true; /* as the scene has it */
        return LAR_OK;
    }
    if (s->column[PRESSURE] >= 0) return take_suction_of_rows(s);
    lar_status status = read_suction(s);
    if (!status && e->time[e->rows - 1] > a->suction[a->points - 1][0])
        return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                        "%s:%d: this profile is of %g s, and %s ends at %g s; the pressure must be "
                        "known as long as profiles are",
                        s->table.path, s->table.line[e->rows - 1], e->time[e->rows - 1],
                        e->pressure, a->suction[a->points - 1][0]);
    return status || e->in_time ? status : settle_suction(s);
}

static lar_status check_radius(const source *s, int32_t row, double reach) {
    double r = s->e->along[row];
    if (r >= 0 && r <= reach * (1 + 1e-6)) return LAR_OK;
    return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                    "%s:%d: r is %g m, and the faces under the pressure are between 0 and %.4g m "
                    "from the axis; were millimetres measured (scale: {r: 0.001}), or is the axis "
                    "elsewhere (origin: [x, y, z] in %s:%d)?",
                    s->table.path, s->table.line[row], r, reach, s->scene->path, s->node->line);
}

static lar_status read_profiles(source *s) {
    lar_inverse_experiment *e = s->e;
    const lar_inverse_aspiration *a = &e->aspiration;
    e->values = e->rows;
    lar_status status = s->column[TIME] >= 0 ? read_time(s, true, &e->time) : LAR_OK;
    if (!status) status = read_pressures(s);
    if (!status) status = need(s, R);
    if (!status) status = take(s, R, &e->along);
    if (!status) status = need(s, Z);
    if (!status) status = take(s, Z, &e->measured);
    double reach = lar_inverse_tube_reach(e);
    for (int32_t i = 0; i < e->rows && !status; i++) {
        status = check_radius(s, i, reach);
        if (!status) status = check_length(s, i, Z, e->measured[i]);
    }
    bool sucked = !a->suction;
    for (int32_t i = 0; i < a->points; i++) sucked = sucked || a->suction[i][1] > 0;
    if (!status && !sucked)
        status = lar_fail(s->scene->error, LAR_ERROR_MODEL,
                          "%s: the pressure is 0 all the time, so nothing is strained",
                          e->pressure ? e->pressure : s->table.path);
    return status;
}

/* ---- points ---------------------------------------------------------------------------------- */

static lar_status read_markers(source *s) {
    lar_inverse_experiment *e = s->e;
    double(*from)[3] = NULL, (*to)[3] = NULL;
    lar_error own = {0};
    lar_triangles at = {.source = lar_strdup(s->table.path), .vertex_count = e->rows};
    lar_status status = take_vectors(s, X, &from);
    if (!status) status = take_vectors(s, TO_X, &to);
    e->values = 3 * e->rows;
    e->measured = lar_calloc((size_t)e->values, sizeof *e->measured);
    if (!status && (!e->measured || !at.source)) status = lar_scene_no_memory(s->scene, 1);
    for (int32_t i = 0; i < e->rows && !status; i++)
        for (int k = 0; k < 3 && !status; k++) {
            e->measured[3 * i + k] = to[i][k] - from[i][k];
            status = check_length(s, i, TO_X + k, e->measured[3 * i + k]);
        }
    free(to);
    at.vertex = from;
    if (status) {
        lar_triangles_clear(&at);
        return status;
    }
    if (lar_embedded_surface_bind(&e->model->mesh, &at, &e->points, &own))
        return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                        "%s: the markers before do not lie in the body of %s; are they of another "
                        "place, or in another unit (scale: {x: 0.001, ...})? (%s)",
                        s->table.path, e->scene, own.message);
    return LAR_OK;
}

static lar_status read_surface(source *s) {
    lar_inverse_experiment *e = s->e;
    double(*at)[3] = NULL;
    lar_status status = take_vectors(s, X, &at);
    e->points.surface = (lar_triangles){.vertex = at, .vertex_count = e->rows};
    e->values = e->rows;
    e->measured = lar_calloc((size_t)e->values, sizeof *e->measured);
    if (!status && !e->measured) status = lar_scene_no_memory(s->scene, 1);
    const lar_mesh *mesh = &e->model->mesh;
    double size = body_size(e->model, -1);
    for (int32_t i = 0; i < e->rows && !status; i++)
        for (int k = 0; k < 3 && !status; k++)
            if (fabs(at[i][k] - mesh->position[0][k]) > 3 * size)
                status = lar_fail(s->scene->error, LAR_ERROR_MODEL,
                                  "%s:%d: this point is farther from the body of %s than that is "
                                  "long; is it of another place, or in another unit (scale: {x: "
                                  "0.001, ...})?",
                                  s->table.path, s->table.line[i], e->scene);
    return status;
}

/* ---- errors ---------------------------------------------------------------------------------- */

/* The scale of what is measured: the largest number; of a surface, whose distances are to be zero,
 * a hundredth of the body. */
static lar_status set_noise(const source *s) {
    static const double SHARE = 0.01;
    lar_inverse_experiment *e = s->e;
    const lar_yaml *own = lar_yaml_get(s->node, "noise");
    for (int32_t i = 0; i < e->values; i++) e->largest = fmax(e->largest, fabs(e->measured[i]));
    e->whole = e->kind == LAR_INVERSE_SURFACE ? body_size(e->model, -1) : e->largest;
    if (e->kind == LAR_INVERSE_SURFACE) e->largest = SHARE * e->whole;
    if (!(e->largest > 0))
        return lar_fail(s->scene->error, LAR_ERROR_MODEL,
                        "%s: all that is measured is zero, which tells nothing", s->table.path);
    e->noise = SHARE * e->largest;
    return own ? lar_scene_positive(s->scene, own,
                                    "a number in newton, or in metres for profiles and points",
                                    &e->noise)
               : LAR_OK;
}

/* The column `error` says of each number how well it is known, where `noise` does not say it of all
 * and a row is one number. Its unit is that of what is measured. */
static lar_status read_errors(source *s) {
    lar_inverse_experiment *e = s->e;
    if (s->column[ERROR] < 0 || lar_yaml_get(s->node, "noise") || e->values != e->rows)
        return LAR_OK;
    if (!lar_yaml_get(lar_yaml_get(s->node, "scale"), "error"))
        s->scale[ERROR] = fabs(s->scale[e->kind == LAR_INVERSE_ASPIRATION ? Z
                                        : e->kind == LAR_INVERSE_SURFACE  ? X
                                                                          : FORCE]);
    double weights = 0;
    lar_status status = take(s, ERROR, &e->error);
    for (int32_t i = 0; i < e->rows && !status; i++) {
        if (!(e->error[i] > 0))
            return lar_fail(s->scene->error, LAR_ERROR_FORMAT,
                            "%s:%d: the error is %g; it is the standard deviation of what was "
                            "measured, and more than 0",
                            s->table.path, s->table.line[i], e->error[i]);
        weights += 1 / (e->error[i] * e->error[i]);
    }
    if (!status) e->noise = sqrt(e->rows / weights);
    return status;
}

lar_status lar_inverse_measured_read(const lar_scene *scene, const lar_yaml *node,
                                     lar_inverse_experiment *e) {
    source s = {.scene = scene, .node = node, .e = e};
    lar_status status = lar_inverse_table_read(e->data, &s.table, scene->error);
    e->rows = s.table.rows;
    if (!status) status = find_columns(&s);
    if (!status && e->kind == LAR_INVERSE_MARKERS)
        status = read_markers(&s);
    else if (!status && e->kind == LAR_INVERSE_SURFACE)
        status = read_surface(&s);
    else if (!status && e->kind == LAR_INVERSE_ASPIRATION)
        status = read_profiles(&s);
    else if (!status)
        status = read_curve(&s);
    if (!status) status = set_noise(&s);
    if (!status) status = read_errors(&s);
    e->row_line = s.table.line;
    s.table.line = NULL;
    lar_inverse_table_clear(&s.table);
    return status;
}
