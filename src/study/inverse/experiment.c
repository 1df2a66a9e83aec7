#include "study/inverse/experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "model/scene/scene.h"
#include "study/inverse/aspiration.h"
#include "study/inverse/measured.h"
#include "study/inverse/parameters.h"

typedef struct reader {
    lar_scene scene; /* the file, for the scene reader's helpers and their sentences */
    lar_inverse_problem *problem;
} reader;

static lar_status copy_text(const reader *r, const char *text, char **to) {
    *to = lar_strdup(text);
    return *to ? LAR_OK : lar_scene_no_memory(&r->scene, strlen(text) + 1);
}

/* A file beside this one. */
static lar_status read_path(const reader *r, const lar_yaml *node, const char *expected,
                            char **path) {
    const char *name;
    lar_status status = lar_scene_text(&r->scene, node, expected, &name);
    if (status) return status;
    *path = lar_path_beside(r->scene.path, name);
    return *path ? LAR_OK : lar_scene_no_memory(&r->scene, strlen(name) + 1);
}

/* ---- parameters ------------------------------------------------------------------------------ */

static lar_status check_bounds(const reader *r, const lar_yaml *bounds, const lar_yaml *guess,
                               lar_inverse_parameter *p) {
    if (!(p->low < p->high))
        return lar_scene_fail(&r->scene, bounds, LAR_ERROR_MODEL,
                              "bounds: %g is not below %g; give the lower one first", p->low,
                              p->high);
    if (p->guess < p->low || p->guess > p->high)
        return lar_scene_fail(&r->scene, guess, LAR_ERROR_MODEL,
                              "guess: %g lies outside of the bounds %g to %g; give a guess within, "
                              "or wider bounds",
                              p->guess, p->low, p->high);
    p->log = p->low > 0;
    return LAR_OK;
}

static lar_status read_parameter(reader *r, const lar_yaml *node) {
    static const char *const keys[] = {"material", "parameter", "guess", "bounds", NULL};
    static const char what[] = "a parameter";
    lar_inverse_problem *problem = r->problem;
    const lar_yaml *material, *name, *guess, *bounds;
    const char *text = NULL;
    if (problem->parameters == LAR_INVERSE_PARAMETERS_MAX)
        return lar_scene_fail(&r->scene, node, LAR_ERROR_UNSUPPORTED,
                              "more than %d parameters; no experiment tells so many apart",
                              LAR_INVERSE_PARAMETERS_MAX);
    lar_inverse_parameter *p = &problem->parameter[problem->parameters++];
    *p = (lar_inverse_parameter){.line = node->line};
    const lar_scene *s = &r->scene;
    lar_status status = lar_scene_keys(s, node, what, keys);
    if (!status) status = lar_scene_need(s, node, what, "material", "material: liver", &material);
    if (!status)
        status = lar_scene_need(s, node, what, "parameter", "parameter: shear_modulus", &name);
    if (!status) status = lar_scene_need(s, node, what, "guess", "guess: 2.0e3", &guess);
    if (!status)
        status = lar_scene_need(s, node, what, "bounds", "bounds: [2.0e2, 2.0e4]", &bounds);
    if (!status) status = lar_scene_text(s, material, "the name of a material", &text);
    if (!status) status = copy_text(r, text, &p->material);
    if (!status) status = lar_scene_text(s, name, "the name of a parameter", &text);
    if (!status) status = copy_text(r, text, &p->name);
    if (!status) status = lar_scene_number(s, guess, "a number in SI units", &p->guess);
    if (!status && (bounds->kind != LAR_YAML_LIST || bounds->count != 2))
        status = lar_scene_fail(s, bounds, LAR_ERROR_FORMAT,
                                "bounds: expected two numbers, for example [2.0e2, 2.0e4]");
    if (!status) status = lar_scene_number(s, bounds->first, "a number in SI units", &p->low);
    if (!status)
        status = lar_scene_number(s, bounds->first->next, "a number in SI units", &p->high);
    if (status) return status;
    for (int j = 0; j < problem->parameters - 1; j++)
        if (strcmp(problem->parameter[j].material, p->material) == 0 &&
            strcmp(problem->parameter[j].name, p->name) == 0)
            return lar_scene_fail(s, node, LAR_ERROR_FORMAT, "%s of %s stands twice", p->name,
                                  p->material);
    return check_bounds(r, bounds, guess, p);
}

/* When all models are there: every parameter must be one of a material of its scenes. */
static lar_status check_parameter(const reader *r, const lar_yaml *node,
                                  const lar_inverse_parameter *p) {
    enum { MAX = 20 };
    const char *name[MAX];
    lar_inverse_name own[MAX];
    double value;
    const lar_yaml *where = lar_yaml_get(node, "material");
    const lar_material *material = lar_inverse_material(r->problem, p->material);
    if (!material) {
        int count = 0;
        for (int k = 0; k < r->problem->experiments; k++) {
            const lar_model *m = r->problem->experiment[k].model;
            for (int i = 0; i < m->material_count && count < MAX; i++)
                if (m->material[i].name) name[count++] = m->material[i].name;
        }
        return lar_scene_unknown(&r->scene, where, LAR_ERROR_MODEL, "the material",
                                 "those with a name in the scenes are", name, count);
    }
    if (lar_inverse_get(material, p->name, &value)) return LAR_OK;
    int count = lar_inverse_names(material, own, MAX);
    for (int i = 0; i < count; i++) name[i] = own[i];
    return lar_scene_unknown(&r->scene, lar_yaml_get(node, "parameter"), LAR_ERROR_MODEL,
                             "the parameter", "this material has", name, count);
}

/* ---- experiments ----------------------------------------------------------------------------- */

static lar_status read_kind(const reader *r, const lar_yaml *node, lar_inverse_kind *kind) {
    for (int i = 0; i < LAR_INVERSE_KINDS; i++)
        if (lar_scene_is_word(node, lar_inverse_kind_name[i])) {
            *kind = (lar_inverse_kind)i;
            return LAR_OK;
        }
    return lar_scene_unknown(&r->scene, node, LAR_ERROR_FORMAT, "the kind", "the kinds are",
                             lar_inverse_kind_name, LAR_INVERSE_KINDS);
}

/* Which entry of the scene's `move` is driven: the only one, or `move: N`, from 1. */
static lar_status choose_move(const reader *r, const lar_yaml *node, lar_inverse_experiment *e) {
    const lar_yaml *own = lar_yaml_get(node, "move"), *at = own ? own : node;
    const lar_model *m = e->model;
    int64_t number = 1;
    if (own) {
        lar_status status = lar_scene_integer(&r->scene, own, "an integer, for example 1", &number);
        if (status) return status;
    }
    if (m->move_count == 0 || number < 1 || number > m->move_count || (!own && m->move_count > 1))
        return lar_scene_fail(&r->scene, at, LAR_ERROR_MODEL,
                              "the scene %s has %d entries of move; %s", e->scene, m->move_count,
                              m->move_count == 0
                                  ? "give it the one that moves the support"
                                  : "say which one moves the support, for example move: 1");
    e->move = (int)number - 1;
    unsigned axes = m->move[e->move].axes;
    if (axes != LAR_AXIS_X && axes != LAR_AXIS_Y && axes != LAR_AXIS_Z)
        return lar_scene_fail(&r->scene, at, LAR_ERROR_MODEL,
                              "the support of %s is moved along several axes; force over "
                              "displacement needs one, hold the others with fix",
                              e->scene);
    e->way = m->move[e->move].by < 0 ? -1 : 1;
    return LAR_OK;
}

static lar_status choose_tool(const reader *r, const lar_yaml *node, lar_inverse_experiment *e) {
    enum { MAX = LAR_MODEL_TOOLS_MAX };
    const lar_yaml *own = lar_yaml_get(node, "tool"), *way = lar_yaml_get(node, "direction");
    const lar_model *m = e->model;
    const char *name[MAX];
    e->direction[2] = -1;
    lar_status status = way ? lar_scene_direction(&r->scene, way, e->direction) : LAR_OK;
    if (status) return status;
    for (int i = 0; i < m->tool_count; i++) {
        name[i] = m->tool[i].name;
        if (own ? lar_scene_is_word(own, name[i]) : m->tool_count == 1) e->tool = i;
    }
    if (e->tool >= 0 && m->tool[e->tool].shape != LAR_TOOL_SPHERE)
        return lar_scene_fail(
            &r->scene, own ? own : node, LAR_ERROR_UNSUPPORTED,
            "the tool %s is no sphere; indentation is with a sphere, or with a flat "
            "punch: the tissue's nodes under it in move, and no tool",
            name[e->tool]);
    if (e->tool >= 0 && m->tool[e->tool].path.count > 0)
        return lar_scene_fail(&r->scene, own ? own : node, LAR_ERROR_MODEL,
                              "the tool %s has a path in the scene %s, and a fit moves it as the "
                              "table says; leave the path out",
                              name[e->tool], e->scene);
    if (e->tool >= 0) return LAR_OK;
    if (own)
        return lar_scene_unknown(&r->scene, own, LAR_ERROR_MODEL, "the tool", "the tools are", name,
                                 m->tool_count);
    return lar_scene_fail(
        &r->scene, node, LAR_ERROR_MODEL, "the scene %s has %d tools; %s", e->scene, m->tool_count,
        m->tool_count ? "say which one presses, for example tool: probe"
                      : "give it the sphere that presses, just above the tissue, or for a "
                        "flat punch a move of the nodes under it");
}

/* What presses: a sphere, a tool of the scene; or a flat punch, which is a support that is moved,
 * since tissue under it lies at its face from the beginning on. */
static lar_status choose_indenter(const reader *r, const lar_yaml *node,
                                  lar_inverse_experiment *e) {
    const bool punch = e->model->tool_count == 0 && e->model->move_count > 0 &&
                       !lar_yaml_get(node, "tool") && !lar_yaml_get(node, "direction");
    return punch ? choose_move(r, node, e) : choose_tool(r, node, e);
}

/* Tissue that relaxes has its own time; everything else is followed to rest. */
static lar_status choose_time(const reader *r, const lar_yaml *node, lar_inverse_experiment *e) {
    const lar_material *viscous = lar_model_viscous(e->model);
    e->in_time = viscous != NULL;
    if (!viscous || e->kind < LAR_INVERSE_MARKERS) return LAR_OK;
    return lar_scene_fail(&r->scene, node, LAR_ERROR_UNSUPPORTED,
                          "the scene %s has a viscous material, and %s are compared at rest; leave "
                          "viscous out of it: at rest the stress is g0 times the law's",
                          e->scene, lar_inverse_kind_name[e->kind]);
}

static lar_status read_plain(reader *r, const lar_yaml *node, lar_inverse_experiment *e) {
    static const char what[] = "an experiment";
    const lar_scene *s = &r->scene;
    const lar_yaml *kind, *scene, *data, *name = lar_yaml_get(node, "name");
    const char *text = NULL;
    lar_status status = lar_scene_need(s, node, what, "kind", "kind: tension", &kind);
    if (!status) status = lar_scene_need(s, node, what, "scene", "scene: strip.yaml", &scene);
    if (!status) status = lar_scene_need(s, node, what, "data", "data: strip.csv", &data);
    if (!status) status = read_kind(r, kind, &e->kind);
    if (!status) status = read_path(r, scene, "the name of a scene (.yaml)", &e->scene);
    if (!status) status = read_path(r, data, "the name of a table (.csv)", &e->data);
    const lar_yaml *pressure = lar_yaml_get(node, "pressure");
    if (!status && pressure && e->kind == LAR_INVERSE_ASPIRATION)
        status = read_path(r, pressure, "the name of a table (.csv)", &e->pressure);
    text = lar_inverse_kind_name[e->kind];
    if (!status && name) status = lar_scene_text(s, name, "a name", &text);
    return status ? status : copy_text(r, text, &e->name);
}

static lar_status read_experiment(reader *r, const lar_yaml *node) {
    static const char *const keys[] = {"kind",  "name",   "scene", "data", "columns",   "scale",
                                       "noise", "length", "move",  "tool", "direction", "pressure",
                                       "load",  "origin", "axis",  NULL};
    lar_inverse_problem *problem = r->problem;
    const lar_scene *s = &r->scene;
    if (problem->experiments == LAR_INVERSE_EXPERIMENTS_MAX)
        return lar_scene_fail(s, node, LAR_ERROR_UNSUPPORTED, "more than %d experiments",
                              LAR_INVERSE_EXPERIMENTS_MAX);
    lar_inverse_experiment *e = &problem->experiment[problem->experiments++];
    *e = (lar_inverse_experiment){.line = node->line, .move = -1, .tool = -1};
    lar_status status = lar_scene_keys(s, node, "an experiment", keys);
    if (!status) status = read_plain(r, node, e);
    lar_error own = {0};
    if (!status && lar_model_open(e->scene, &e->model, &own))
        status = lar_scene_fail(s, lar_yaml_get(node, "scene"), own.status, "%s", own.message);
    if (!status) status = choose_time(r, node, e);
    if (!status && e->kind <= LAR_INVERSE_COMPRESSION) status = choose_move(r, node, e);
    if (!status && e->kind == LAR_INVERSE_INDENTATION) status = choose_indenter(r, node, e);
    if (!status && e->kind == LAR_INVERSE_ASPIRATION) status = lar_inverse_tube_read(s, node, e);
    return status ? status : lar_inverse_measured_read(s, node, e);
}

/* ---- the file -------------------------------------------------------------------------------- */

static lar_status read_root(reader *r) {
    static const char *const keys[] = {"lariat-fit", "title", "parameters", "experiments", NULL};
    const lar_scene *s = &r->scene;
    const lar_yaml *root = s->root, *version, *parameters, *experiments, *entry;
    const char *title = r->scene.path;
    int64_t number;
    if (lar_yaml_get(root, "lariat-view"))
        return lar_scene_fail(s, root, LAR_ERROR_UNSUPPORTED,
                              "this is the file of a view, not of an experiment; it goes with "
                              "frames: lariat fit --profile FRAMES %s",
                              r->scene.path);
    lar_status status = lar_scene_keys(s, root, "a fit", keys);
    if (!status) status = lar_scene_need(s, root, "a fit", "lariat-fit", "lariat-fit: 1", &version);
    if (status) return status;
    if (!lar_scene_is_integer(version, &number) || number != 1)
        return lar_scene_fail(s, version, LAR_ERROR_UNSUPPORTED,
                              "lariat-fit: expected 1, the version that this program reads");
    status = lar_scene_need(s, root, "a fit", "parameters",
                            "parameters: [{material: liver, parameter: shear_modulus, "
                            "guess: 2.0e3, bounds: [2.0e2, 2.0e4]}]",
                            &parameters);
    if (!status)
        status = lar_scene_need(
            s, root, "a fit", "experiments",
            "experiments: [{kind: tension, scene: strip.yaml, data: strip.csv}]", &experiments);
    if (!status) status = lar_scene_list(s, parameters, "parameters, {material: liver, ...}");
    if (!status) status = lar_scene_list(s, experiments, "experiments, {kind: tension, ...}");
    if (!status && lar_yaml_get(root, "title"))
        status = lar_scene_text(s, lar_yaml_get(root, "title"), "a text", &title);
    if (!status) status = copy_text(r, title, &r->problem->title);
    for (entry = status ? NULL : parameters->first; entry && !status; entry = entry->next)
        status = read_parameter(r, entry);
    for (entry = status ? NULL : experiments->first; entry && !status; entry = entry->next)
        status = read_experiment(r, entry);
    int j = 0;
    for (entry = status ? NULL : parameters->first; entry && !status; entry = entry->next)
        status = check_parameter(r, entry, &r->problem->parameter[j++]);
    return status;
}

static lar_status check_counts(const lar_inverse_problem *p, lar_error *error) {
    if (p->parameters == 0 || p->experiments == 0)
        return lar_fail(error, LAR_ERROR_FORMAT, "%s: no %s; give one at least", p->path,
                        p->parameters ? "experiment" : "parameter");
    if (lar_inverse_problem_values(p) < p->parameters)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: %d measured numbers for %d parameters; measure more, or free fewer",
                        p->path, (int)lar_inverse_problem_values(p), p->parameters);
    return LAR_OK;
}

lar_status lar_inverse_problem_parse(const char *path, const lar_bytes *text,
                                     lar_inverse_problem *problem, lar_error *error) {
    lar_error unused;
    lar_yaml_tree tree;
    if (!error) error = &unused;
    lar_status status = lar_yaml_parse(path, text, &tree, error);
    if (status) return status;
    reader r = {.scene = {.path = path, .root = tree.root, .error = error}, .problem = problem};
    problem->path = lar_strdup(path);
    status = problem->path ? read_root(&r) : lar_scene_no_memory(&r.scene, strlen(path));
    lar_yaml_clear(&tree);
    return status ? status : check_counts(problem, error);
}

lar_status lar_inverse_problem_read(const char *path, lar_inverse_problem *problem,
                                    lar_error *error) {
    lar_bytes bytes;
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (status) return status;
    status = lar_inverse_problem_parse(path, &bytes, problem, error);
    lar_bytes_free(&bytes);
    return status;
}
