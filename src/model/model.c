#include "model/contact_check.h"
#include "model/rest.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

/* ---- life ------------------------------------------------------------------------------- */

lar_model *lar_model_create(void) {
    lar_model *model = lar_calloc(1, sizeof *model);
    if (!model) return NULL;
    for (int axis = 0; axis < 3; axis++) model->gravity_curve[axis] = -1;
    model->mass_share = 0.05;
    model->output.fields = LAR_FIELD_DISPLACEMENT | LAR_FIELD_VON_MISES;
    return model;
}

void lar_model_destroy(lar_model *model) {
    if (!model) return;
    lar_mesh_clear(&model->mesh);
    lar_surface_clear(&model->surface);
    lar_embedded_surface_clear(&model->embedded);
    for (int i = 0; i < model->mesh_file_count; i++) free(model->mesh_file[i]);
    for (int i = 0; i < model->material_count; i++) free(model->material[i].name);
    for (int i = 0; i < model->curve_count; i++) free(model->curve[i].point);
    for (int i = 0; i < model->fix_count; i++) free(model->fix[i].nodes.node);
    for (int i = 0; i < model->move_count; i++) {
        free(model->move[i].nodes.node);
        free(model->move[i].screw);
    }
    for (int i = 0; i < model->spring_count; i++) {
        free(model->spring[i].nodes.node);
        free(model->spring[i].stiffness);
    }
    for (int i = 0; i < model->load_count; i++) free(model->load[i].nodes.node);
    for (int i = 0; i < model->pressure_count; i++) free(model->pressure[i].face);
    for (int i = 0; i < model->initial_count; i++) free(model->initial[i].nodes.node);
    for (int i = 0; i < model->contact_count; i++) {
        free(model->contact[i].face);
        free(model->contact[i].against);
    }
    for (int i = 0; i < model->tool_count; i++) {
        free(model->tool[i].name);
        lar_tool_script_destroy(&model->tool[i].path);
    }
    for (int i = 0; i < model->output.probe_count; i++) {
        free(model->output.probe[i].name);
        free(model->output.probe[i].nodes.node);
    }
    for (int i = 0; i < model->notice_count; i++) free(model->notice[i]);
    free(model->mesh_file);
    free(model->material);
    free(model->element_material);
    free(model->curve);
    free(model->fix);
    free(model->move);
    free(model->spring);
    free(model->load);
    free(model->pressure);
    free(model->initial);
    free(model->contact);
    free(model->tool);
    free(model->output.probe);
    free(model->notice);
    free(model->title);
    free(model->source);
    free(model);
}

void *lar_model_append(void **array, int *count, size_t size) {
    /* The caller's pointer has its own type: read and written by memcpy, not through void *. */
    char *entries;
    memcpy(&entries, array, sizeof entries);
    size_t used = (size_t)*count;
    /* Room doubles whenever the count reaches a power of two, so no capacity needs storing. */
    if ((used & (used - 1)) == 0) {
        size_t room = used ? 2 * used : 1;
        if (room > INT32_MAX || room > SIZE_MAX / size) return NULL;
        entries = realloc(entries, room * size);
        if (!entries) return NULL;
        memcpy(array, &entries, sizeof entries);
    }
    *count += 1;
    return memset(entries + used * size, 0, size);
}

lar_status lar_model_notice(lar_model *model, lar_error *error, const char *format, ...) {
    char text[sizeof error->message];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    char *copy = lar_strdup(text);
    char **notice = copy ? LAR_MODEL_APPEND(model, notice) : NULL;
    if (!notice) {
        free(copy);
        return lar_fail_memory(error, strlen(text) + 1, "a notice about the model");
    }
    *notice = copy;
    return LAR_OK;
}

/* ---- fields of elements ------------------------------------------------------------------ */

const lar_cell_field_row lar_cell_field_table[LAR_CELL_FIELDS] = {
    [LAR_CELL_VON_MISES] = {LAR_FIELD_VON_MISES, "von_mises", "Pa", 1},
    [LAR_CELL_PRESSURE] = {LAR_FIELD_PRESSURE, "pressure", "Pa", 1},
    [LAR_CELL_ENERGY] = {LAR_FIELD_ENERGY, "energy", "J/m^3", 1},
    [LAR_CELL_STRESS] = {LAR_OUTPUT_STRESS, "stress", "Pa", 6},
    [LAR_CELL_STRAIN] = {LAR_OUTPUT_STRAIN, "strain", "1", 6},
    [LAR_CELL_VOLUME] = {LAR_OUTPUT_VOLUME, "volume_ratio", "1", 1}};

/* ---- small questions -------------------------------------------------------------------- */

const double (*lar_model_positions(const lar_model *model))[3] {
    return model ? (const double(*)[3])model->mesh.position : NULL;
}

double lar_model_output_interval(const lar_model *model) {
    return model ? model->output.every : 0;
}

double lar_model_duration(const lar_model *model) {
    if (!model) return 0;
    if (model->duration > 0.0) return model->duration;
    return lar_model_loads_end(model);
}

double lar_model_damping(const lar_model *model) {
    return model ? model->damping : 0;
}

int lar_model_until_rest(const lar_model *model) {
    return model ? model->until_rest : 0;
}

/* ---- the check -------------------------------------------------------------------------- */

static bool finite3(const double v[3]) {
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static lar_status check_materials(const lar_model *model, lar_error *error) {
    const lar_mesh *mesh = &model->mesh;
    for (int i = 0; i < model->material_count; i++) {
        char where[256];
        const char *name = model->material[i].name;
        snprintf(where, sizeof where, "%s: material %d%s%s", lar_model_source(model), i + 1,
                 name ? " " : "", name ? name : "");
        lar_status status = lar_material_check(&model->material[i], where, error);
        if (status) return status;
    }
    for (int32_t e = 0; e < mesh->element_count; e++)
        if (!model->element_material || model->element_material[e] < 0 ||
            model->element_material[e] >= model->material_count)
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: element %lld (tag %d) has no material; give one to every element",
                            lar_model_source(model), (long long)mesh->element_id[e],
                            (int)mesh->element_tag[e]);
    return LAR_OK;
}

/* To length one, by operations that have the same bits everywhere; what has been brought there
 * keeps its bits. False where there is no direction. */
static bool make_unit(double a[3]) {
    static const double ROUNDED = 1e-15;
    double most = fmax(fmax(fabs(a[0]), fabs(a[1])), fabs(a[2]));
    if (!(most > 0) || !finite3(a)) return false;
    if (fabs(a[0] * a[0] + a[1] * a[1] + a[2] * a[2] - 1) < ROUNDED) return true;
    for (int i = 0; i < 3; i++) a[i] /= most;
    double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    for (int i = 0; i < 3; i++) a[i] /= length;
    return true;
}

/* One of the directions of an element, `a` NULL: nobody said. */
static lar_status check_direction(const lar_model *model, lar_gid e, double *a, bool second,
                                  lar_error *error) {
    const char *own = model->fibre_remedy;
    if (a && make_unit(a)) return LAR_OK;
    return lar_fail(
        error, LAR_ERROR_MODEL, "%s:%d: element %lld has %s and %s; give it a direction, %s%s",
        lar_model_source(model), lar_model_material_of(model, e)->fibre.line,
        (long long)model->mesh.element_id[e], second ? "a second family of fibres" : "fibres",
        !a           ? "nothing says along what"
        : finite3(a) ? "their direction is 0, 0, 0"
                     : "their direction is not finite",
        own      ? own
        : second ? "in the mesh as a cell array \"fibre2"
                 : "in the mesh as a cell array \"fibre",
        own ? "" : "\" of three components, or by a rule");
}

/* A material with fibres needs directions in all of its elements. */
static lar_status check_fibres(lar_model *model, lar_error *error) {
    lar_mesh *mesh = &model->mesh;
    lar_status status = LAR_OK;
    for (int32_t e = 0; e < mesh->element_count && !status; e++) {
        const lar_fibre *fibre = &lar_model_material_of(model, e)->fibre;
        if (!lar_fibre_directed(fibre)) continue;
        status = check_direction(model, e, mesh->fibre ? mesh->fibre[e] : NULL, false, error);
        if (!status && lar_fibre_families(fibre) == 2)
            status = check_direction(model, e, mesh->second ? mesh->second[e] : NULL, true, error);
    }
    return status;
}

static lar_status check_curves(const lar_model *model, lar_error *error) {
    for (int i = 0; i < model->curve_count; i++) {
        const lar_curve *curve = &model->curve[i];
        bool good = curve->kind == LAR_CURVE_RAMP ? isfinite(curve->over) && curve->over >= 0.0
                                                  : curve->count > 0;
        for (int p = 0; good && curve->kind == LAR_CURVE_TABLE && p < curve->count; p++)
            good = isfinite(curve->point[p][0]) && isfinite(curve->point[p][1]) &&
                   (p == 0 || curve->point[p][0] >= curve->point[p - 1][0]);
        if (good && curve->repeats) good = curve->point[curve->count - 1][0] > curve->point[0][0];
        if (!good)
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: curve %d is no function of time; its times must be finite and "
                            "ascending and its values finite",
                            lar_model_source(model), i + 1);
    }
    for (int i = 0; model->until_rest && i < model->curve_count; i++)
        if (model->curve[i].repeats)
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: a curve repeats, so the body never rests; leave out repeat, or "
                            "give the duration in seconds",
                            lar_model_source(model));
    return LAR_OK;
}

/* ---- activation ----------------------------------------------------------------------------- */

/* Where the elements of material m are on the way of its wave. */
static void place_wave(lar_model *model, int m) {
    lar_wave *wave = &model->material[m].activation.wave;
    double first = INFINITY, last = -INFINITY;
    for (int32_t e = 0; e < model->mesh.element_count; e++) {
        double corner[8][3];
        if (model->element_material[e] != m) continue;
        lar_mesh_corners(&model->mesh, e, corner);
        double place = lar_wave_place(wave, (const double(*)[3])corner);
        first = fmin(first, place);
        last = fmax(last, place);
    }
    wave->start = first <= last ? first : 0;
    wave->span = first <= last ? last - first : 0;
}

/* From 0 to 1: the stable step counts all of the active stress. */
static bool is_share(const lar_curve *curve) {
    bool good = true;
    for (int p = 0; p < curve->count; p++)
        good = good && curve->point[p][1] >= 0 && curve->point[p][1] <= 1;
    return good;
}

static lar_status check_activation(lar_model *model, lar_error *error) {
    for (int m = 0; m < model->material_count; m++) {
        const lar_material *material = &model->material[m];
        const lar_activation *a = &material->activation;
        const char *wrong = NULL;
        if (a->curve < 0 || a->curve > model->curve_count)
            wrong = "names a curve that does not exist";
        else if (a->curve > 0 && !is_share(&model->curve[a->curve - 1]))
            wrong = "follows a curve with values below 0 or above 1; give the largest stress as "
                    "along and across, and the curve as parts of it";
        else if (model->until_rest && a->wave.every > 0)
            wrong = "has waves again and again, so the body never rests; leave out every, or give "
                    "the duration in seconds";
        if (wrong)
            return lar_fail(error, LAR_ERROR_MODEL, "%s:%d: the active stress %s",
                            lar_model_source(model), material->fibre.line, wrong);
        if (a->wave.speed > 0) place_wave(model, m);
    }
    return LAR_OK;
}

static lar_status check_list(const lar_model *model, const char *what, int entry,
                             const int32_t *index, int32_t count, int64_t limit, lar_error *error) {
    if (count < 0 || (count > 0 && !index))
        return lar_fail(error, LAR_ERROR_MODEL, "%s: %s entry %d has no list",
                        lar_model_source(model), what, entry + 1);
    for (int32_t i = 0; i < count; i++)
        if (index[i] < 0 || index[i] >= limit)
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: %s entry %d names index %d, but the mesh ends before %lld",
                            lar_model_source(model), what, entry + 1, (int)index[i],
                            (long long)limit);
    return LAR_OK;
}

static lar_status check_entry(const lar_model *model, const char *what, int entry, bool good,
                              lar_error *error) {
    return good ? LAR_OK
                : lar_fail(error, LAR_ERROR_MODEL,
                           "%s: %s entry %d is not valid; axes must name x, y or z, values must "
                           "be finite and its curve must exist",
                           lar_model_source(model), what, entry + 1);
}

static bool curve_exists(const lar_model *model, int curve) {
    return curve >= 0 && curve < model->curve_count;
}

static bool screws_hold(const lar_model *model, const lar_move *move) {
    bool hold = move->screw_count >= 0 && move->screw_count <= LAR_SCREWS_MAX;
    if (hold && move->screw_count > 0) hold = move->axes == LAR_AXIS_ALL;
    for (int k = 0; hold && k < move->screw_count; k++) {
        const lar_screw *s = &move->screw[k];
        double square = s->axis[0] * s->axis[0] + s->axis[1] * s->axis[1] + s->axis[2] * s->axis[2];
        hold = isfinite(s->angle) && isfinite(s->slide) && finite3(s->point) &&
               fabs(square - 1) < 1e-9 && curve_exists(model, s->curve);
    }
    return hold;
}

static bool tool_moves(const lar_model *model, const lar_move *move) {
    return move->tool >= 1 && move->tool <= model->tool_count && move->axes == LAR_AXIS_ALL &&
           move->screw_count == 0 && model->tool[move->tool - 1].shape == LAR_TOOL_RIGID;
}

static lar_status check_supports(const lar_model *model, lar_error *error) {
    const int64_t nodes = model->mesh.node_count;
    lar_status status = LAR_OK;
    for (int i = 0; !status && i < model->fix_count; i++) {
        const lar_fix *fix = &model->fix[i];
        status = check_entry(model, "fix", i, fix->axes >= 1 && fix->axes <= LAR_AXIS_ALL, error);
        if (!status)
            status = check_list(model, "fix", i, fix->nodes.node, fix->nodes.count, nodes, error);
    }
    for (int i = 0; !status && i < model->move_count; i++) {
        const lar_move *move = &model->move[i];
        const bool course = move->tool ? tool_moves(model, move)
                                       : curve_exists(model, move->curve) && isfinite(move->by) &&
                                             screws_hold(model, move);
        status = check_entry(model, "move", i,
                             move->axes >= 1 && move->axes <= LAR_AXIS_ALL && course, error);
        if (!status)
            status =
                check_list(model, "move", i, move->nodes.node, move->nodes.count, nodes, error);
    }
    for (int i = 0; !status && i < model->spring_count; i++) {
        const lar_spring_bed *bed = &model->spring[i];
        status = check_list(model, "springs", i, bed->nodes.node, bed->nodes.count, nodes, error);
        for (int32_t k = 0; !status && k < bed->nodes.count; k++)
            status = check_entry(model, "springs", i,
                                 bed->stiffness[k] >= 0 && isfinite(bed->stiffness[k]), error);
    }
    return status;
}

static lar_status check_loads(const lar_model *model, lar_error *error) {
    const int64_t nodes = model->mesh.node_count;
    const int64_t faces = 6 * (int64_t)model->mesh.element_count;
    lar_status status = LAR_OK;
    for (int i = 0; !status && i < model->load_count; i++) {
        const lar_nodal_load *load = &model->load[i];
        status = check_entry(model, "nodal load", i,
                             finite3(load->force) && curve_exists(model, load->curve), error);
        if (!status)
            status = check_list(model, "nodal load", i, load->nodes.node, load->nodes.count, nodes,
                                error);
    }
    for (int i = 0; !status && i < model->pressure_count; i++) {
        const lar_pressure_load *load = &model->pressure[i];
        status = check_entry(model, "pressure", i,
                             isfinite(load->pressure) && curve_exists(model, load->curve), error);
        if (!status)
            status = check_list(model, "pressure", i, load->face, load->count, faces, error);
    }
    for (int i = 0; !status && i < model->initial_count; i++) {
        const lar_initial_velocity *initial = &model->initial[i];
        status = check_entry(model, "initial velocity", i, finite3(initial->velocity), error);
        if (!status)
            status = check_list(model, "initial velocity", i, initial->nodes.node,
                                initial->nodes.count, nodes, error);
    }
    for (int i = 0; !status && i < model->output.probe_count; i++) {
        const lar_probe *probe = &model->output.probe[i];
        const lar_gid places = probe->what == LAR_PROBE_MEAN ? model->mesh.element_count : nodes;
        if (probe->what == LAR_PROBE_TOOL)
            status = check_entry(model, "probe", i,
                                 probe->tool >= 0 && probe->tool < model->tool_count, error);
        else if (probe->what != LAR_PROBE_ENERGY)
            status =
                check_list(model, "probe", i, probe->nodes.node, probe->nodes.count, places, error);
    }
    return status;
}

enum { MOVER = LAR_TOOL_NAME_MAX + 32 };
static const char *mover_of(const lar_model *model, int entry, char text[MOVER]) {
    const int tool = model->move[entry].tool;
    if (tool)
        snprintf(text, MOVER, "the tool \"%s\"", model->tool[tool - 1].name);
    else
        snprintf(text, MOVER, "move entry %d", entry + 1);
    return text;
}

/* A node's axis is free, fixed, or moved by one entry. `held` notes per node which axes are
 * taken: bits 0..2 fixed, bits 3..5 moved. */
static lar_status check_conflicts(const lar_model *model, lar_error *error) {
    const lar_mesh *mesh = &model->mesh;
    uint8_t *held = lar_calloc((size_t)mesh->node_count, 1);
    if (!held) return lar_fail_memory(error, (size_t)mesh->node_count, "the check of supports");
    char mover[MOVER];
    lar_status status = LAR_OK;
    for (int i = 0; i < model->fix_count; i++) {
        const lar_node_list *nodes = &model->fix[i].nodes;
        for (int32_t n = 0; n < nodes->count; n++)
            held[nodes->node[n]] |= (uint8_t)model->fix[i].axes;
    }
    for (int i = 0; !status && i < model->move_count; i++) {
        const lar_node_list *nodes = &model->move[i].nodes;
        unsigned axes = model->move[i].axes;
        for (int32_t n = 0; !status && n < nodes->count; n++) {
            uint8_t *node = &held[nodes->node[n]];
            if ((*node | *node >> 3) & axes)
                status = lar_fail(error, LAR_ERROR_MODEL,
                                  "%s: node %lld is moved by %s and %s on the same axis; leave one "
                                  "of the two",
                                  lar_model_source(model), (long long)mesh->node_id[nodes->node[n]],
                                  mover_of(model, i, mover),
                                  *node & axes ? "fixed" : "moved by another entry or tool");
            *node |= (uint8_t)(axes << 3);
        }
    }
    free(held);
    return status;
}

const char *lar_line_text(int line, char text[LAR_LINE_TEXT]) {
    text[0] = 0;
    if (line > 0) snprintf(text, LAR_LINE_TEXT, ":%d", line);
    return text;
}

static lar_status check_numbers(const lar_model *model, lar_error *error) {
    const char *wrong = NULL;
    if (!finite3(model->gravity)) wrong = "gravity must be three finite numbers in m/s^2";
    for (int axis = 0; axis < 3; axis++)
        if (model->gravity_curve[axis] < -1 || model->gravity_curve[axis] >= model->curve_count)
            wrong = "the curve of gravity must exist";
    if (!isfinite(model->damping) || model->damping < 0.0)
        wrong = "damping must be finite and not negative, in 1/s";
    if (!isfinite(model->time_step) || model->time_step < 0.0)
        wrong = "the time step must be finite and not negative, in seconds";
    if (!(model->mass_step >= 0.0 && model->mass_step <= 1.0) ||
        !(model->mass_share > 0.0 && model->mass_share <= 1.0))
        wrong = "mass scaling needs a step up to a second and a share above 0 and up to 1";
    if (!(model->strained_share >= 0.0 && model->strained_share <= 0.2))
        wrong = "strained elements may have at most 0.2 of the model's mass more";
    if (!isfinite(model->duration) || model->duration < 0.0)
        wrong = "the duration must be finite and not negative, in seconds";
    if (!isfinite(model->output.every) || model->output.every < 0.0)
        wrong = "the output interval must be finite and not negative, in seconds";
    if (!wrong) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL, "%s: %s", lar_model_source(model), wrong);
}

static lar_status check_contacts(const lar_model *model, lar_error *error) {
    char problem[LAR_PROBLEM_SIZE];
    for (int i = 0; i < model->contact_count; i++)
        if (lar_contact_problem(model, &model->contact[i], problem))
            return lar_fail(error, LAR_ERROR_MODEL, "%s: contact entry %d: %s",
                            lar_model_source(model), i + 1, problem);
    if (lar_restitution_problem(model, problem))
        return lar_fail(error, LAR_ERROR_MODEL, "%s: %s", lar_model_source(model), problem);
    return LAR_OK;
}

static lar_status check_tools(const lar_model *model, lar_error *error) {
    char problem[LAR_PROBLEM_SIZE];
    if (model->tool_count > LAR_MODEL_TOOLS_MAX)
        return lar_fail(error, LAR_ERROR_MODEL, "%s: %d tools; there can be %d",
                        lar_model_source(model), model->tool_count, LAR_MODEL_TOOLS_MAX);
    for (int i = 0; i < model->tool_count; i++) {
        const lar_tool *tool = &model->tool[i];
        bool wrong = lar_tool_name_problem(tool->name ? tool->name : "", problem);
        for (int j = 0; !wrong && j < i; j++) {
            wrong = strcmp(model->tool[j].name, tool->name) == 0;
            if (wrong)
                snprintf(problem, sizeof problem, "tool entry %d is called \"%s\" too", j + 1,
                         tool->name);
        }
        if (wrong || lar_tool_problem(model, tool, problem))
            return lar_fail(error, LAR_ERROR_MODEL, "%s: tool entry %d: %s",
                            lar_model_source(model), i + 1, problem);
    }
    return LAR_OK;
}

/* What was done with the mesh, and what looks as if it were meant otherwise. Bodies that touch each
 * other by contact may well have nodes at one place. */
static lar_status notice_mesh(lar_model *model, lar_error *error) {
    const lar_mesh *mesh = &model->mesh;
    const char *source = mesh->source ? mesh->source : lar_model_source(model);
    lar_status status = LAR_OK;
    if (mesh->turned)
        status = lar_model_notice(model, error,
                                  "%.300s: all elements are left-handed, as in a mirrored body; "
                                  "their corners are taken in the other direction",
                                  source);
    if (!status && mesh->sparse_ranges > 0)
        status = lar_model_notice(model, error,
                                  "%.300s:%d: %d ranges of sets (GENERATE), the first here, have "
                                  "numbers that the file does not define; these were left out",
                                  source, mesh->sparse_line, (int)mesh->sparse_ranges);
    for (int i = 0; i < model->contact_count; i++)
        if (model->contact[i].kind != LAR_CONTACT_PLANE) return status;
    int32_t doubled = 0;
    if (!status) status = lar_mesh_doubled_nodes(mesh, &doubled, NULL, error);
    if (!status && doubled > 0)
        status = lar_model_notice(model, error,
                                  "%.300s: %d nodes stand at the place of another one, and nothing "
                                  "connects them: parts that meet there come apart; merge these "
                                  "nodes where the body is one",
                                  source, (int)doubled);
    return status;
}

/* What theory.md says of laws: of one where it is nearly incompressible, of another where it is far
 * from that, for the energy of no volume is finite, of two where Lame's first constant is negative
 * and their energy with it. */
static lar_status notice_materials(lar_model *model, lar_error *error) {
    lar_status status = LAR_OK;
    bool told = false;
    for (int i = 0; i < model->material_count && !status; i++) {
        const lar_material *m = &model->material[i];
        const double shear = lar_material_shear(m), bulk = lar_material_bulk(m);
        const double most = 8 * shear / 3, foam = 2.16 * shear; /* Poisson's ratio 0.2995 */
        if (m->law == LAR_LAW_neo_hookean && bulk < foam && !told) {
            told = true;
            status = lar_model_notice(model, error,
                                      "%.300s: material %d: neo-hookean with a Poisson's ratio "
                                      "below 0.3 collapses when it is pressed to half its height; "
                                      "for foam take coupled-neo-hookean, ogden or holmes-mow",
                                      lar_model_source(model), i + 1);
        }
        const bool stretched = m->law == LAR_LAW_holmes_mow;
        if (!status && (stretched || m->law == LAR_LAW_coupled_neo_hookean) && bulk < 0.666 * shear)
            status =
                lar_model_notice(model, error,
                                 "%.300s: material %d: %s with a Poisson's ratio below 0 gives "
                                 "way when it is %s; take ogden or yeoh",
                                 lar_model_source(model), i + 1, lar_law_name[m->law],
                                 stretched ? "stretched" : "pressed");
        if (!status && m->law == LAR_LAW_holmes_mow && bulk > 1.001 * most)
            status = lar_model_notice(model, error,
                                      "%.300s: material %d: holmes-mow with a bulk modulus above "
                                      "%.4g Pa, 8/3 of the shear modulus, gives way when it is "
                                      "stretched; take less, or another law",
                                      lar_model_source(model), i + 1, most);
    }
    return status;
}

/* Names go to terminals, tables and pages, from whatever file they are. */
static void show_names(lar_model *model) {
    lar_text_show(model->title);
    for (int i = 0; i < model->material_count; i++) lar_text_show(model->material[i].name);
    for (int i = 0; i < model->tool_count; i++) lar_text_show(model->tool[i].name);
    for (int i = 0; i < model->output.probe_count; i++) lar_text_show(model->output.probe[i].name);
    for (int i = 0; i < model->mesh.set_count; i++) lar_text_show(model->mesh.set[i].name);
}

lar_status lar_model_check(lar_model *model, lar_error *error) {
    show_names(model);
    if (model->mesh.node_count <= 0 || model->mesh.element_count <= 0)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: the model has no elements; give it a mesh of hexahedra",
                        lar_model_source(model));
    lar_status status = check_materials(model, error);
    if (!status) status = check_fibres(model, error);
    if (!status) status = check_numbers(model, error);
    if (!status) status = check_curves(model, error);
    if (!status) status = check_activation(model, error);
    if (!status) status = check_supports(model, error);
    if (!status) status = check_loads(model, error);
    if (!status) status = check_conflicts(model, error);
    if (!status && !model->surface.face_count) /* a reader may have needed it */
        status = lar_surface_build(&model->mesh, &model->surface, error);
    if (!status) status = check_contacts(model, error);
    if (!status) status = check_tools(model, error);
    if (!status) status = notice_materials(model, error);
    return status ? status : notice_mesh(model, error);
}
