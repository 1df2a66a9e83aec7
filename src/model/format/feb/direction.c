/* FEBio decks: along what fibres run, and what contracts. See feb.h.
 *
 *     <material type="solid mixture">  <mat_axis/>      Q, or that of the element in <MeshData>
 *         <solid type="fiber-exp-pow"> <mat_axis/>      q
 *                                      <fiber/>         a, x without one: the direction is Q q a
 *
 * A direction belongs to the part that it stands in, and is one in the axes of that part, which are
 * axes in those of what is around it. Axes turn a direction where they are two vectors; of others
 * the first axis is one. An element of Lariat has one direction: where fibres and a contraction
 * have one each, both are found, and must be the same.
 */
#include "model/format/feb/feb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "model/mesh/id_map.h"

/* ---- parts that have one --------------------------------------------------------------------- */

/* Whether a type is one of fibres, or of what contracts along or across them. */
static bool has_direction(const char *type, bool active) {
    if (active) return lar_feb_is_active(type) && !strstr(type, "isotropic");
    return lar_feb_is_fibre(type) || lar_feb_is_hgo(type) || strncmp(type, "trans iso ", 10) == 0;
}

/* That part of a material of any depth, NULL: there is none. */
static const xmlNode *find_part(lar_feb *feb, const xmlNode *node, bool active) {
    const char *type = lar_feb_attribute(feb, node, "type");
    const xmlNode *found = type && has_direction(type, active) ? node : NULL;
    for (const xmlNode *inner = lar_feb_first(node); inner && !found; inner = lar_feb_next(inner))
        if (lar_feb_is_any(inner, "solid elastic")) found = find_part(feb, inner, active);
    return found;
}

/* What says the direction of a part: <fiber> of it or of what is around it, in the material
 * `whole`, or two angles; NULL: none does, it is the first axis. *holder is where that stands. */
static const xmlNode *find_rule(const xmlNode *part, const xmlNode *whole, const xmlNode **holder) {
    *holder = part;
    if (lar_feb_child(part, "theta") || lar_feb_child(part, "phi")) return part;
    for (const xmlNode *at = part;; at = at->parent) {
        const xmlNode *rule = lar_feb_child(at, "fiber");
        if (rule) *holder = at;
        if (rule || at == whole) return rule;
    }
}

/* A part that has no direction need not say one. */
static lar_status refuse_strays(lar_feb *feb, const xmlNode *node) {
    lar_status status = LAR_OK;
    for (const xmlNode *in = lar_feb_first(node); in && !status; in = lar_feb_next(in)) {
        if (!lar_feb_is_any(in, "solid elastic")) continue;
        const char *type = lar_feb_attribute(feb, in, "type");
        const xmlNode *rule = lar_feb_child(in, "fiber");
        if (!rule) rule = lar_feb_child(in, "mat_axis");
        if (rule && type && !lar_feb_child(in, "solid") && !lar_feb_child(in, "elastic") &&
            !has_direction(type, false) && !lar_feb_is_active(type))
            return lar_feb_fail(
                feb, rule, LAR_ERROR_UNSUPPORTED,
                "a second direction within one material, of a part that is the same "
                "along all; remove it");
        status = refuse_strays(feb, in);
    }
    return status;
}

/* ---- rules ----------------------------------------------------------------------------------- */

static bool is_rule(const xmlNode *node) {
    return lar_feb_is_any(node, "fiber mat_axis");
}

/* One direction for all: a vector, two angles, or the first of two vectors. */
static lar_status read_constant(lar_feb *feb, const xmlNode *rule, const char *type, double a[3]) {
    double theta = 0, phi = 90; /* FEBio's defaults */
    const xmlNode *of = lar_feb_child(rule, strcmp(type, "vector") == 0 ? "vector" : "theta");
    if (strcmp(type, "vector") == 0) {
        if (!of) of = lar_feb_child(rule, "a");
        return lar_feb_doubles(feb, of ? of : rule, a, 3);
    }
    lar_status status = lar_feb_parameter(feb, rule, "theta", false, &theta);
    if (!status) status = lar_feb_parameter(feb, rule, "phi", false, &phi);
    if (!status && is_rule(rule)) status = lar_feb_notice_others(feb, rule, "theta phi");
    if (status) return status;
    const double degree = 3.14159265358979323846 / 180;
    a[0] = cos(theta * degree) * sin(phi * degree);
    a[1] = sin(theta * degree) * sin(phi * degree);
    a[2] = cos(phi * degree);
    return LAR_OK;
}

/* "local": from one corner of an element to another, counted from 1 as in the deck. */
static lar_status read_corners(lar_feb *feb, const xmlNode *rule, int corner[2]) {
    int64_t id[3];
    const xmlNode *of = lar_feb_child(rule, "local");
    int count = lar_feb_is(rule, "mat_axis") ? 3 : 2;
    lar_status status = lar_feb_ids(feb, of ? of : rule, id, count);
    if (status) return status;
    if (id[0] == 0 && id[1] == 0) id[0] = 1, id[1] = 2; /* FEBio's default, of axes 1, 2, 4 */
    for (int i = 0; i < 2; i++) {
        if (id[i] < 1 || id[i] > 8 || id[0] == id[1])
            return lar_feb_fail(feb, rule, LAR_ERROR_FORMAT,
                                "a local direction runs from one corner to another, of 1 to 8");
        corner[i] = (int)id[i] - 1;
        if (feb->mesh->turned) corner[i] = (corner[i] + 4) % 8; /* lar_mesh_turn */
    }
    return LAR_OK;
}

/* "spherical" and "cylindrical": `vector`, turned as the x axis is to the ray from the centre, or
 * from the axis, to an element. */
typedef struct round_rule {
    double center[3], axis[3], vector[3]; /* axis 0: spherical */
} round_rule;

static lar_status read_round(lar_feb *feb, const xmlNode *rule, bool cylindrical, round_rule *to) {
    *to = (round_rule){.axis = {0, 0, cylindrical}, .vector = {1, 0, 0}};
    const xmlNode *center = lar_feb_child(rule, "center"), *axis = lar_feb_child(rule, "axis"),
                  *vector = lar_feb_child(rule, "vector");
    if (!center && lar_feb_text(feb, rule).length) center = rule; /* version 2.5 */
    lar_status status = center ? lar_feb_doubles(feb, center, to->center, 3) : LAR_OK;
    if (!status && axis && cylindrical) status = lar_feb_doubles(feb, axis, to->axis, 3);
    if (!status && vector) status = lar_feb_doubles(feb, vector, to->vector, 3);
    double length = lar_length(to->axis);
    if (!status && cylindrical && !(length > 0))
        return lar_feb_fail(feb, rule, LAR_ERROR_FORMAT,
                            "the axis of a cylindrical direction has no length; correct it");
    for (int i = 0; i < 3 && cylindrical; i++) to->axis[i] /= length;
    return status;
}

/* What the shortest turn from the x axis to `ray` makes of the vector; 0 without a ray. */
static void lay_round(const round_rule *rule, const double at[3], double out[3]) {
    double ray[3], turn[3], across[3];
    lar_minus(at, rule->center, ray);
    double along = lar_dot(ray, rule->axis);
    for (int i = 0; i < 3; i++) ray[i] -= along * rule->axis[i];
    double length = lar_length(ray);
    if (!(length > 0)) return;
    for (int i = 0; i < 3; i++) ray[i] /= length;
    lar_cross((const double[]){1, 0, 0}, ray, turn);
    lar_cross(turn, rule->vector, across);
    double bend = 1 + ray[0], share = bend > 0 ? lar_dot(turn, rule->vector) / bend : 0;
    for (int i = 0; i < 3; i++) out[i] = ray[0] * rule->vector[i] + across[i] + share * turn[i];
}

static void centre_of(const lar_mesh *mesh, int32_t e, double centre[3]) {
    for (int i = 0; i < 3; i++) {
        centre[i] = 0;
        for (int a = 0; a < 8; a++) centre[i] += 0.125 * mesh->position[mesh->element[e][a]][i];
    }
}

static lar_status need_directions(lar_feb *feb) {
    lar_mesh *mesh = feb->mesh;
    bool paired = false;
    for (int i = 0; i < feb->model->material_count; i++)
        paired = paired || feb->model->material[i].fibre.paired;
    if (!mesh->fibre) mesh->fibre = lar_calloc((size_t)mesh->element_count, sizeof *mesh->fibre);
    if (!mesh->second && paired)
        mesh->second = lar_calloc((size_t)mesh->element_count, sizeof *mesh->second);
    return mesh->fibre && (mesh->second || !paired)
               ? LAR_OK
               : lar_feb_no_memory(feb, "the directions of fibres");
}

lar_status lar_feb_turn(lar_feb *feb, const xmlNode *at, int32_t e, const double a[3],
                        const double d[3], double direction[3]) {
    double e2[3], e3[3];
    lar_cross(a, d, e3);
    lar_cross(e3, a, e2);
    const double length[3] = {lar_length(a), lar_length(e2), lar_length(e3)};
    double share[3];
    for (int i = 0; i < 3; i++) {
        if (!(length[i] > 0) || !isfinite(length[i]))
            return lar_feb_fail(feb, at, LAR_ERROR_MODEL,
                                "the two vectors of <mat_axis> of element %lld span no plane; give "
                                "two that are not parallel",
                                (long long)feb->mesh->element_id[e]);
        share[i] = direction[i] / length[i];
    }
    for (int i = 0; i < 3; i++)
        direction[i] = share[0] * a[i] + share[1] * e2[i] + share[2] * e3[i];
    return LAR_OK;
}

/* A map is read where <MeshData> says of it that it is one of directions. */
static lar_status check_map(lar_feb *feb, const xmlNode *rule) {
    const xmlNode *section = lar_feb_child(feb->root, "MeshData");
    const xmlNode *data = section ? lar_feb_first(section) : NULL;
    while (data && !lar_feb_is_direction(feb, data)) data = lar_feb_next(data);
    if (data) return LAR_OK;
    lar_span name = lar_feb_text(feb, rule);
    return lar_feb_fail(feb, rule, LAR_ERROR_UNSUPPORTED,
                        "the map '%.*s' of directions is not read; give them as <ElementData "
                        "type=\"%s\">",
                        (int)(name.length < 60 ? name.length : 60), name.at,
                        (const char *)rule->name);
}

/* The directions of one material's elements, but for those that are `done`. A direction that an
 * element has already is one in the axes. */
static lar_status lay(lar_feb *feb, const xmlNode *rule, int material, const bool *done) {
    lar_mesh *mesh = feb->mesh;
    const char *type = is_rule(rule) ? lar_feb_attribute(feb, rule, "type") : "angles";
    if (!type && lar_feb_is(rule, "fiber")) type = "vector";
    double a[3] = {0}, d[3], way[3] = {0};
    int corner[2];
    round_rule around;
    bool local = type && strcmp(type, "local") == 0;
    bool cylindrical = type && strcmp(type, "cylindrical") == 0;
    bool round = cylindrical || (type && strcmp(type, "spherical") == 0);
    if (type && strcmp(type, "map") == 0) return check_map(feb, rule);
    if (type && strcmp(type, "user") == 0) return LAR_OK;
    if (!type || (!local && !round && strcmp(type, "vector") != 0 && strcmp(type, "angles") != 0))
        return lar_feb_fail(feb, rule, LAR_ERROR_UNSUPPORTED,
                            "a direction of type '%.40s' is not read; vector, local, angles, "
                            "spherical, cylindrical and user are",
                            type ? type : "");
    lar_status status = need_directions(feb);
    if (!status)
        status = local   ? read_corners(feb, rule, corner)
                 : round ? read_round(feb, rule, cylindrical, &around)
                         : read_constant(feb, rule, type, a);
    const xmlNode *second = lar_feb_child(rule, "d");
    if (!status && second) status = lar_feb_doubles(feb, second, d, 3);
    for (int32_t e = 0; e < mesh->element_count && !status; e++) {
        if (feb->model->element_material[e] != material || done[e]) continue;
        if (lar_length(mesh->fibre[e]) > 0) {
            if (!second)
                return lar_feb_fail(feb, rule, LAR_ERROR_UNSUPPORTED,
                                    "a <mat_axis> of type '%.40s' around a <fiber> is not read; "
                                    "give it the type vector, with <a> and <d>",
                                    type);
            status = lar_feb_turn(feb, rule, e, a, d, mesh->fibre[e]);
            continue;
        }
        if (round) {
            centre_of(mesh, e, a);
            lay_round(&around, a, way);
        } else if (local)
            lar_minus(mesh->position[mesh->element[e][corner[1]]],
                      mesh->position[mesh->element[e][corner[0]]], way);
        memcpy(mesh->fibre[e], round || local ? way : a, sizeof a);
    }
    return status;
}

/* ---- <MeshData> ------------------------------------------------------------------------------ */

/* The ids of a set or part in the order of the deck; lid counts in it from 1. */
typedef struct id_list {
    int64_t *id;
    size_t count, room;
} id_list;

static lar_status list_ids(lar_feb *feb, const xmlNode *set, id_list *list) {
    lar_status status = LAR_OK;
    xmlNode *child = lar_feb_first(set);
    for (; child && !status; child = lar_feb_next(child)) {
        if (!LAR_GROW(list->id, list->room, list->count)) return lar_feb_no_memory(feb, "a set");
        status = lar_feb_id_attribute(feb, child, "id", &list->id[list->count++]);
    }
    if (list->count > 0 || status) return status;
    lar_feb_id_list text = lar_feb_id_list_of(feb, set);
    for (bool found = true; !status;) {
        int64_t id;
        status = lar_feb_next_id(feb, &text, &id, &found);
        if (status || !found) return status;
        if (!LAR_GROW(list->id, list->room, list->count)) return lar_feb_no_memory(feb, "a set");
        list->id[list->count++] = id;
    }
    return status;
}

/* The element set of that name, or the part; NULL: there is none. */
static const xmlNode *find_elements(lar_feb *feb, const char *name) {
    const xmlNode *section = lar_feb_child(feb->root, "Mesh"), *part = NULL;
    xmlNode *block = section ? lar_feb_first(section) : NULL;
    for (; block; block = lar_feb_next(block)) {
        const char *found = lar_feb_attribute(feb, block, "name");
        if (!found || strcmp(found, name) != 0) continue;
        if (lar_feb_is(block, "ElementSet")) return block;
        if (lar_feb_is(block, "Elements")) part = block;
    }
    return part;
}

/* Axes mark their elements as `done`. */
static lar_status read_entries(lar_feb *feb, const xmlNode *data, const id_list *list,
                               const lar_id_map *map, bool axes, bool *done) {
    lar_status status = LAR_OK;
    for (xmlNode *entry = lar_feb_first(data); entry && !status; entry = lar_feb_next(entry)) {
        int64_t lid;
        double a[3], d[3];
        const xmlNode *first = lar_feb_child(entry, "a"), *second = lar_feb_child(entry, "d");
        status = lar_feb_id_attribute(feb, entry, "lid", &lid);
        if (!status) status = lar_feb_doubles(feb, first ? first : entry, a, 3);
        if (status) return status;
        int32_t e =
            lid >= 1 && (uint64_t)lid <= list->count ? lar_id_map_find(map, list->id[lid - 1]) : -1;
        if (e < 0)
            return lar_feb_fail(feb, entry, LAR_ERROR_FORMAT,
                                "lid %lld is no element of its set, which has %zu", (long long)lid,
                                list->count);
        if (axes && done[e])
            return lar_feb_fail(feb, entry, LAR_ERROR_FORMAT,
                                "a second <mat_axis> for element %lld; keep one",
                                (long long)feb->mesh->element_id[e]);
        done[e] = axes;
        const bool paired = lar_model_material_of(feb->model, e)->fibre.paired;
        double *fibre = feb->mesh->fibre[e];
        if (!paired && (!axes || !(lar_length(fibre) > 0))) {
            memcpy(fibre, a, sizeof a);
            continue;
        }
        if (!second)
            return lar_feb_fail(feb, entry, LAR_ERROR_FORMAT,
                                "element %lld has two families of fibres, or one along a direction "
                                "in its axes; give it <a> and <d>",
                                (long long)feb->mesh->element_id[e]);
        status = lar_feb_doubles(feb, second, d, 3);
        if (!status)
            status = paired ? lar_feb_lay_pair(feb, entry, e, a, d)
                            : lar_feb_turn(feb, entry, e, a, d, fibre);
    }
    return status;
}

static lar_status read_data(lar_feb *feb, const xmlNode *data, bool axes, bool *done) {
    const lar_mesh *mesh = feb->mesh;
    const char *name;
    lar_status status = lar_feb_need_attribute(feb, data, "elem_set", &name);
    if (status) return status;
    if (lar_feb_attribute(feb, data, "generator"))
        return lar_feb_fail(feb, data, LAR_ERROR_UNSUPPORTED,
                            "directions that a generator makes are not read; list them");
    const xmlNode *set = find_elements(feb, name);
    if (!set)
        return lar_feb_fail(feb, data, LAR_ERROR_FORMAT,
                            "<ElementData> names the element set '%.100s', which the mesh does not "
                            "define; define it or correct the name",
                            name);
    id_list list = {0};
    lar_id_map map = {0};
    lar_id_clash clash;
    status = need_directions(feb);
    if (!status && !lar_id_map_build(&map, mesh->element_id, mesh->element_count,
                                     sizeof *mesh->element_id, &clash))
        status = lar_feb_no_memory(feb, "the directions of fibres");
    if (!status) status = list_ids(feb, set, &list);
    if (!status) status = read_entries(feb, data, &list, &map, axes, done);
    lar_id_map_clear(&map);
    free(list.id);
    return status;
}

static bool has_type(lar_feb *feb, const xmlNode *data, const char *wanted) {
    const char *type = lar_feb_attribute(feb, data, "type");
    if (!type) type = lar_feb_attribute(feb, data, "var"); /* version 3.0 */
    return lar_feb_is(data, "ElementData") && type && strcmp(type, wanted) == 0;
}

bool lar_feb_is_direction(lar_feb *feb, const xmlNode *data) {
    return has_type(feb, data, "fiber") || has_type(feb, data, "mat_axis");
}

static lar_status read_mesh_data(lar_feb *feb, bool axes, bool *done) {
    const xmlNode *section = lar_feb_child(feb->root, "MeshData");
    xmlNode *data = section ? lar_feb_first(section) : NULL;
    lar_status status = LAR_OK;
    for (; data && !status && lar_model_fibrous(feb->model); data = lar_feb_next(data))
        if (has_type(feb, data, axes ? "mat_axis" : "fiber"))
            status = read_data(feb, data, axes, done);
    return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

/* The first axis is that of the mesh where nothing says another one. */
static lar_status lay_default(lar_feb *feb, const xmlNode *part, int material) {
    bool any = false;
    lar_status status = need_directions(feb);
    for (int32_t e = 0; e < feb->mesh->element_count && !status; e++) {
        double *way = feb->mesh->fibre[e];
        if (feb->model->element_material[e] != material || lar_length(way) > 0) continue;
        way[0] = any = true;
    }
    return status || !any ? status
                          : lar_feb_notice(feb, part,
                                           "nothing says along what '%.60s' acts; it is x, as in "
                                           "FEBio",
                                           lar_feb_attribute(feb, part, "type"));
}

/* What a material says of a part: `outermost`, the axes of the whole, of elements that have none
 * of their own; else all that is within them. */
static lar_status read_part(lar_feb *feb, const lar_feb_material *entry, const xmlNode *part,
                            bool outermost, const bool *done) {
    const xmlNode *whole = entry->node, *at, *rule = find_rule(part, whole, &at);
    const xmlNode *axes = lar_feb_child(whole, "mat_axis");
    lar_status status = LAR_OK;
    if (feb->model->material[entry->index].fibre.paired) {
        if (!outermost) status = need_directions(feb);
        return status || outermost
                   ? status
                   : lar_feb_lay_pairs(feb, whole, rule ? rule : axes, entry->index);
    }
    if (outermost) {
        if (axes) return lay(feb, axes, entry->index, done);
        const bool said = rule || lar_feb_child(part, "mat_axis");
        /* fibres alone are always given a direction */
        const bool may_miss = part != whole && !said;
        return may_miss ? lay_default(feb, part, entry->index) : LAR_OK;
    }
    if (rule) status = lay(feb, rule, entry->index, done);
    for (; at != whole && !status; at = at->parent) {
        axes = lar_feb_child(at, "mat_axis");
        if (axes) status = lay(feb, axes, entry->index, done);
    }
    return status;
}

/* Those of materials that have both fibres and a contraction along one; else of whichever. */
static bool has_two(const lar_fibre *fibre) {
    return fibre->law != LAR_FIBRE_NONE && fibre->along != fibre->across;
}

static lar_status read_parts(lar_feb *feb, bool second, bool outermost, const bool *done) {
    lar_status status = LAR_OK;
    for (int i = 0; i < feb->material_count && !status; i++) {
        const lar_feb_material *entry = &feb->material[i];
        if (entry->index < 0) continue;
        const lar_fibre *fibre = &feb->model->material[entry->index].fibre;
        if (!lar_fibre_directed(fibre) || (second && !has_two(fibre))) continue;
        const bool active = second || fibre->law == LAR_FIBRE_NONE;
        if (!second && !outermost) status = refuse_strays(feb, entry->node);
        if (!status)
            status = read_part(feb, entry, find_part(feb, entry->node, active), outermost, done);
    }
    return status;
}

/* As in FEBio a direction is one in the axes of the material, and both may be said for a material
 * or for each of its elements, which counts before. So first directions, then axes, which turn
 * them; without a direction fibres run along the first axis. */
static lar_status lay_all(lar_feb *feb, bool second) {
    bool *done = lar_calloc((size_t)feb->mesh->element_count, sizeof *done);
    lar_status status = done ? read_parts(feb, second, false, done)
                             : lar_feb_no_memory(feb, "the directions of fibres");
    if (!status) status = read_mesh_data(feb, false, done);
    if (!status) status = read_mesh_data(feb, true, done);
    if (!status) status = read_parts(feb, second, true, done);
    free(done);
    return status;
}

/* Whether two directions are one, forwards or backwards. */
static bool same_way(const double a[3], const double b[3]) {
    double across[3];
    lar_cross(a, b, across);
    return lar_length(across) <= 1e-6 * fabs(lar_dot(a, b)) && lar_dot(a, b) != 0;
}

static lar_status compare(lar_feb *feb, double (*fibre)[3]) {
    for (int32_t e = 0; e < feb->mesh->element_count; e++) {
        const int index = feb->model->element_material[e];
        if (!has_two(&feb->model->material[index].fibre) || same_way(fibre[e], feb->mesh->fibre[e]))
            continue;
        int i = 0;
        while (feb->material[i].index != index) i++;
        const xmlNode *part[2];
        for (int k = 0; k < 2; k++) part[k] = find_part(feb, feb->material[i].node, k);
        return lar_feb_fail(feb, part[1], LAR_ERROR_UNSUPPORTED,
                            "'%.60s' acts along another direction than '%.60s' (line %d); Lariat's "
                            "elements have one, give both the same (a part that says none acts "
                            "along the first axis)",
                            lar_feb_attribute(feb, part[1], "type"),
                            lar_feb_attribute(feb, part[0], "type"), lar_feb_line(part[0]));
    }
    return LAR_OK;
}

lar_status lar_feb_lay_fibres(lar_feb *feb) {
    bool two = false;
    feb->model->fibre_remedy = "as <fiber> of its material or in <ElementData> of type fiber";
    for (int i = 0; i < feb->model->material_count; i++)
        two = two || has_two(&feb->model->material[i].fibre);
    lar_status status = lay_all(feb, false);
    if (status || !two) return status;
    double(*fibre)[3] = feb->mesh->fibre;
    feb->mesh->fibre = NULL;
    status = lay_all(feb, true);
    if (!status) status = compare(feb, fibre);
    free(feb->mesh->fibre);
    feb->mesh->fibre = fibre;
    return status;
}
