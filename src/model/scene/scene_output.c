#include "model/scene/scene.h"

#include <stdio.h>
#include <string.h>

/* ---- fields ------------------------------------------------------------------------------- */

static lar_status read_fields(lar_scene *scene, const lar_yaml *node) {
    enum { FIELDS = 11 };
    static const char *const names[FIELDS] = {
        "displacement", "velocity", "von_mises",    "pressure",      "energy", "stress",
        "strain",       "fibres",   "volume_ratio", "fibre_stretch", "contact"};
    static const unsigned bits[FIELDS] = {
        LAR_FIELD_DISPLACEMENT, LAR_FIELD_VELOCITY, LAR_FIELD_VON_MISES, LAR_FIELD_PRESSURE,
        LAR_FIELD_ENERGY,       LAR_OUTPUT_STRESS,  LAR_OUTPUT_STRAIN,   LAR_OUTPUT_FIBRES,
        LAR_OUTPUT_VOLUME,      LAR_OUTPUT_STRETCH, LAR_OUTPUT_CONTACT};
    lar_status status = lar_scene_list(scene, node, "fields");
    if (status) return status;
    unsigned fields = 0;
    for (const lar_yaml *entry = node->first; entry; entry = entry->next) {
        int i = 0;
        while (i < FIELDS && !lar_scene_is_word(entry, names[i])) i++;
        if (i == FIELDS)
            return lar_scene_unknown(scene, entry, LAR_ERROR_FORMAT, "the field", "the fields are",
                                     names, FIELDS);
        fields |= bits[i];
    }
    scene->model->output.fields = fields;
    return LAR_OK;
}

/* A probe of elements: what it is the mean of. */
static lar_status read_mean(lar_scene *scene, const lar_yaml *node, lar_probe *probe) {
    const char *names[LAR_CELL_FIELDS];
    for (int i = 0; i < LAR_CELL_FIELDS; i++) {
        names[i] = lar_cell_field_table[i].name;
        if (!lar_scene_is_word(node, names[i])) continue;
        probe->what = LAR_PROBE_MEAN;
        probe->field = (lar_cell_field)i;
        return LAR_OK;
    }
    return lar_scene_unknown(scene, node, LAR_ERROR_FORMAT, "the mean of", "there are means of",
                             names, LAR_CELL_FIELDS);
}

/* ---- probes ------------------------------------------------------------------------------- */

/* The column's name: the one given, else from what is probed. */
static lar_status name_probe(lar_scene *scene, const lar_yaml *entry, const lar_yaml *what,
                             lar_probe *probe) {
    const lar_yaml *given = lar_yaml_get(entry, "name");
    const lar_probe *all = scene->model->output.probe;
    int count = scene->model->output.probe_count;
    const char *name, *behind = probe->what == LAR_PROBE_REACTION  ? "reaction"
                                : probe->what == LAR_PROBE_CONTACT ? "contact"
                                : probe->what == LAR_PROBE_MEAN
                                    ? lar_cell_field_table[probe->field].name
                                    : "";
    char text[128];
    lar_status status = given ? lar_scene_text(scene, given, "a name", &name) : LAR_OK;
    if (status) return status;
    if (given)
        snprintf(text, sizeof text, "%s", name);
    else if (probe->what == LAR_PROBE_ENERGY)
        snprintf(text, sizeof text, "energy");
    else if (what->kind == LAR_YAML_SCALAR)
        snprintf(text, sizeof text, "%s%.90s%s%s",
                 strcmp(what->key->text, "node") == 0 ? "node " : "", what->text,
                 *behind ? " " : "", behind);
    else
        snprintf(text, sizeof text, "probe %d", count);
    for (int i = 0; i < count - 1; i++)
        if (strcmp(all[i].name, text) == 0)
            return lar_scene_fail(scene, given ? given : entry, LAR_ERROR_MODEL,
                                  "two probes would be called \"%.60s\"; give this one another "
                                  "name, for example name: tip",
                                  text);
    probe->name = lar_strdup(text);
    return probe->name ? LAR_OK : lar_scene_no_memory(scene, sizeof text);
}

/* Of two lists of nodes, both ascending. */
static bool share_a_node(const lar_node_list *a, const lar_node_list *b) {
    for (int32_t i = 0, k = 0; i < a->count && k < b->count;) {
        const int32_t first = a->node[i], second = b->node[k];
        if (first == second) return true;
        i += first < second;
        k += second < first;
    }
    return false;
}

/* Nodes that nothing holds have no reaction: most likely the wrong set. */
static lar_status notice_free_reaction(lar_scene *scene, const lar_yaml *entry,
                                       const lar_probe *probe) {
    for (int32_t n = 0; scene->axis_line && n < probe->nodes.count; n++)
        for (int axis = 0; axis < 3; axis++)
            if (scene->axis_line[3 * (size_t)probe->nodes.node[n] + (size_t)axis]) return LAR_OK;
    for (int i = 0; i < scene->model->spring_count; i++)
        if (share_a_node(&scene->model->spring[i].nodes, &probe->nodes)) return LAR_OK;
    return lar_model_notice(scene->model, scene->error,
                            "%s:%d:%d: the probe \"%.60s\" sums reactions, but none of its nodes "
                            "is fixed, moved or on a spring: it will be zero",
                            scene->path, entry->line, entry->column, probe->name);
}

/* A probe of one of the scene's tools, which has its name. */
static lar_status read_tool(lar_scene *scene, const lar_yaml *node, lar_probe *probe) {
    const lar_model *model = scene->model;
    const char *name;
    lar_status status = lar_scene_text(scene, node, "a tool's name", &name);
    if (status) return status;
    probe->what = LAR_PROBE_TOOL;
    for (probe->tool = 0; probe->tool < model->tool_count; probe->tool++)
        if (strcmp(model->tool[probe->tool].name, name) == 0) return LAR_OK;
    probe->tool = 0;
    return lar_scene_fail(
        scene, node, LAR_ERROR_MODEL, "tool: \"%.60s\" is none of the scene's tools; %s%.60s%s",
        name,
        model->tool_count ? "take the name of one, for example \"" : "the key tools makes some",
        model->tool_count ? model->tool[0].name : "", model->tool_count ? "\"" : "");
}

/* What a probe of nodes sums up, or the mean displacement. */
static lar_status read_sum(lar_scene *scene, const lar_yaml *sum, const lar_yaml *about,
                           lar_probe *probe) {
    probe->moment = about != NULL;
    lar_status status =
        about ? lar_scene_vector(scene, about, LAR_IN_POSITION, probe->about) : LAR_OK;
    if (status) return status;
    const bool contact = sum && lar_scene_is_word(sum, "contact");
    probe->what = contact ? LAR_PROBE_CONTACT : sum ? LAR_PROBE_REACTION : LAR_PROBE_DISPLACEMENT;
    if (!sum || contact || lar_scene_is_word(sum, "reaction")) return LAR_OK;
    return lar_scene_fail(scene, sum, LAR_ERROR_FORMAT,
                          "sum: expected reaction, the sum of the forces of the supports, or "
                          "contact, that of bodies and planes; without sum a probe is the mean "
                          "displacement");
}

static lar_status read_energy(lar_scene *scene, const lar_yaml *node, lar_probe *probe) {
    probe->what = LAR_PROBE_ENERGY;
    if (lar_scene_is_word(node, "all")) return LAR_OK;
    return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                          "energy: expected all, the energies of the whole model; those of some "
                          "elements are {cells: ..., mean: energy}, per volume");
}

/* Which key says what is probed, and whether the others go with it. */
static lar_status find_place(lar_scene *scene, const lar_yaml *entry, const lar_yaml **where) {
    static const char *const keys[] = {"node", "nodes", "set",  "cells", "tool", "energy",
                                       "sum",  "mean",  "name", "about", NULL};
    enum { PLACES = 6 };
    lar_status status = lar_scene_keys(scene, entry, "a probe", keys);
    const lar_yaml *sum = lar_yaml_get(entry, "sum"), *mean = lar_yaml_get(entry, "mean");
    *where = NULL;
    for (int i = 0; !status && i < PLACES; i++) {
        const lar_yaml *found = lar_yaml_get(entry, keys[i]);
        if (found && *where)
            return lar_scene_fail(
                scene, found->key, LAR_ERROR_FORMAT,
                "a probe takes one of node, nodes, set, cells, tool and energy; make two probes");
        if (found) *where = found;
    }
    if (status) return status;
    if (!*where)
        return lar_scene_fail(
            scene, entry, LAR_ERROR_FORMAT,
            "a probe needs the key \"node\", \"nodes\", \"set\", \"cells\", \"tool\" or "
            "\"energy\"; add one, for example node: 12");
    const char *key = (*where)->key->text;
    if ((strcmp(key, "tool") == 0 || strcmp(key, "energy") == 0) && (sum || mean))
        return lar_scene_fail(scene, sum ? sum->key : mean->key, LAR_ERROR_FORMAT,
                              "a probe of a tool or of energies has neither sum nor mean: its "
                              "columns are all that there is");
    const bool cells = strcmp(key, "cells") == 0;
    if (cells != (mean != NULL) || (cells && sum))
        return lar_scene_fail(scene, mean ? mean->key : (*where)->key, LAR_ERROR_FORMAT,
                              "cells and mean belong together, for example {cells: all, mean: "
                              "von_mises}; a probe of nodes has neither");
    const lar_yaml *about = lar_yaml_get(entry, "about");
    if (about && !sum)
        return lar_scene_fail(scene, about->key, LAR_ERROR_FORMAT,
                              "about: moments are of forces that are summed; add sum: reaction or "
                              "sum: contact");
    int64_t ignored;
    if (strcmp(key, "node") == 0)
        status =
            lar_scene_integer(scene, *where, "the number of a node in the mesh file", &ignored);
    return status;
}

static lar_status read_probe(lar_scene *scene, const lar_yaml *entry) {
    enum { MAX = 1000 };
    const lar_yaml *where;
    lar_status status = find_place(scene, entry, &where);
    if (!status && scene->model->output.probe_count >= MAX)
        status = lar_scene_fail(scene, entry, LAR_ERROR_UNSUPPORTED,
                                "there are more than %d probes; write the field displacement "
                                "instead",
                                MAX);
    if (status) return status;
    lar_probe *probe = LAR_MODEL_APPEND(scene->model, output.probe);
    if (!probe) return lar_scene_no_memory(scene, sizeof *probe);
    const char *key = where->key->text;
    const bool cells = strcmp(key, "cells") == 0;
    const bool tool = strcmp(key, "tool") == 0, energy = strcmp(key, "energy") == 0;
    status = cells  ? read_mean(scene, lar_yaml_get(entry, "mean"), probe)
             : tool ? read_tool(scene, where, probe)
             : energy
                 ? read_energy(scene, where, probe)
                 : read_sum(scene, lar_yaml_get(entry, "sum"), lar_yaml_get(entry, "about"), probe);
    if (!status) status = name_probe(scene, entry, where, probe);
    if (!status && !tool && !energy)
        status = lar_scene_select(scene, where, cells ? LAR_SET_ELEMENTS : LAR_SET_NODES, cells,
                                  &probe->nodes.node, &probe->nodes.count);
    if (status || probe->what != LAR_PROBE_REACTION) return status;
    return notice_free_reaction(scene, entry, probe);
}

/* What is asked for and cannot be there is most likely missed somewhere else. */
static lar_status notice_lacking(lar_scene *scene, const lar_yaml *surface,
                                 const lar_yaml *fields) {
    const lar_model *model = scene->model;
    bool fibres = !(model->output.fields & (LAR_OUTPUT_FIBRES | LAR_OUTPUT_STRETCH));
    for (lar_gid e = 0; e < model->mesh.element_count && !fibres; e++)
        fibres = lar_model_element_fibres(model, e, NULL) > 0;
    lar_status status = LAR_OK;
    if (!fibres)
        status = lar_model_notice(scene->model, scene->error,
                                  "%s:%d:%d: frames hold no fibres, for no material has any; give "
                                  "one the key fibres",
                                  scene->path, fields->line, fields->column);
    if (!status && model->output.surface && !lar_model_embedded(model, NULL))
        status = lar_model_notice(scene->model, scene->error,
                                  "%s:%d:%d: frames hold no surface, for the scene has none; give "
                                  "it the key surface",
                                  scene->path, surface->line, surface->column);
    return status;
}

lar_status lar_scene_read_output(lar_scene *scene, const lar_yaml *node) {
    static const char *const keys[] = {"every", "fields", "probes", "surface", NULL};
    lar_output *output = &scene->model->output;
    lar_status status = lar_scene_keys(scene, node, "output", keys);
    const lar_yaml *every = lar_yaml_get(node, "every"), *fields = lar_yaml_get(node, "fields");
    const lar_yaml *probes = lar_yaml_get(node, "probes");
    if (!status && every)
        status = lar_scene_not_negative(scene, every, LAR_IN_SECONDS, &output->every);
    if (!status && fields) status = read_fields(scene, fields);
    const lar_yaml *surface = lar_yaml_get(node, "surface");
    if (!status && surface) {
        output->surface = lar_scene_is_word(surface, "true");
        if (!output->surface && !lar_scene_is_word(surface, "false"))
            status = lar_scene_fail(scene, surface, LAR_ERROR_FORMAT,
                                    "surface: expected true or false: whether frames hold the fine "
                                    "surface, too");
    }
    if (!status && probes) status = lar_scene_list(scene, probes, "probes, {node: 12}");
    for (const lar_yaml *entry = probes ? probes->first : NULL; !status && entry;
         entry = entry->next)
        status = read_probe(scene, entry);
    return status ? status : notice_lacking(scene, surface, fields);
}
