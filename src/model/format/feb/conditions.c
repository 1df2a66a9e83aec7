/* FEBio decks: <Boundary>, <Initial>, and what conditions of all kinds have. See feb.h.
 *
 * Each axis of a node has one holder. Conditions that say the same twice are one; others are
 * refused here, where their lines are known.
 */
#include "model/format/feb/feb.h"

#include <stdlib.h>
#include <string.h>

#include "model/rest.h"

lar_status lar_feb_need_child(lar_feb *feb, const xmlNode *parent, const char *name,
                              const xmlNode **child) {
    *child = lar_feb_child(parent, name);
    if (*child) return LAR_OK;
    return lar_feb_fail(feb, parent, LAR_ERROR_FORMAT, "<%s> has no <%s>; add it",
                        lar_feb_name(parent), name);
}

lar_status lar_feb_nodes_of(lar_feb *feb, const xmlNode *at, lar_node_list *list) {
    const char *reference;
    lar_status status = lar_feb_need_attribute(feb, at, "node_set", &reference);
    return status ? status : lar_feb_node_list(feb, at, reference, list);
}

lar_status lar_feb_axis_of(lar_feb *feb, const xmlNode *at, lar_span word, int *axis) {
    static const char *const names[] = {"x", "y", "z", "sx", "sy", "sz", "u", "v", "w"};
    word = lar_span_trim(word);
    for (*axis = 0; *axis < 9; ++*axis)
        if (lar_span_equal(word, names[*axis]))
            return *axis < 3 ? LAR_OK
                             : lar_feb_notice(feb, at,
                                              "%s is a degree of freedom of shells, which solids "
                                              "do not have; it was left out",
                                              names[*axis]);
    return lar_feb_fail(feb, at, LAR_ERROR_UNSUPPORTED,
                        "the degree of freedom '%.*s' is not one of x, y, z, all that a solid has; "
                        "remove it",
                        (int)(word.length < 40 ? word.length : 40), word.at);
}

lar_status lar_feb_refuse_type(lar_feb *feb, const xmlNode *at, const char *known) {
    const char *type = lar_feb_attribute(feb, at, "type");
    return lar_feb_fail(feb, at, LAR_ERROR_UNSUPPORTED,
                        "<%s> of type '%.60s' is not read and would change the answer; Lariat "
                        "reads %s",
                        lar_feb_name(at), type ? type : "", known);
}

static lar_status refuse_flag(lar_feb *feb, const xmlNode *at, const char *name) {
    bool set;
    lar_status status = lar_feb_flag(feb, at, name, false, &set);
    if (status || !set) return status;
    return lar_feb_fail(feb, lar_feb_child(at, name), LAR_ERROR_UNSUPPORTED,
                        "<%s> other than 0 is not read; set it to 0", name);
}

/* A run begins at rest and has one step, so that what is relative to the step before is not. */
lar_status lar_feb_check_flags(lar_feb *feb, const xmlNode *at) {
    bool ignored;
    lar_status status = lar_feb_flag(feb, at, "relative", false, &ignored);
    return status ? status : refuse_flag(feb, at, "shell_bottom");
}

lar_status lar_feb_scaled(lar_feb *feb, const xmlNode *at, const char *name, double *value,
                          int count, int *curve) {
    const xmlNode *size = lar_feb_child(at, name), *scale = lar_feb_child(at, "scale");
    if (!size && count == 1) size = scale;
    if (!size) return lar_feb_need_child(feb, at, name, &size);
    if (size == scale) scale = NULL;
    const bool scale_follows = scale && lar_feb_attribute(feb, scale, "lc");
    double factor = 1;
    lar_status status = LAR_OK;
    if (scale_follows && lar_feb_attribute(feb, size, "lc"))
        return lar_feb_fail(feb, scale, LAR_ERROR_UNSUPPORTED,
                            "<scale> and <%s> follow a load curve each; Lariat's conditions have "
                            "one, join the two",
                            name);
    status = lar_feb_curve_of(feb, size, scale_follows ? NULL : curve);
    if (!status && scale) status = lar_feb_curve_of(feb, scale, scale_follows ? curve : NULL);
    if (!status && scale) status = lar_feb_doubles(feb, scale, &factor, 1);
    if (!status) status = lar_feb_doubles(feb, size, value, count);
    for (int i = 0; i < count && !status; i++) value[i] *= factor;
    return status;
}

/* ---- holders --------------------------------------------------------------------------------- */

static bool is_same(const lar_model *model, const lar_feb_holder *other, const lar_move *move) {
    if (!move || other->move < 0) return !move && other->move < 0;
    const lar_move *first = &model->move[other->move];
    return first->by == move->by && first->curve == move->curve && first->screw_count == 0 &&
           move->screw_count == 0;
}

static lar_status refuse_holder(lar_feb *feb, const xmlNode *at, const lar_feb_holder *other,
                                int32_t node, int axis, bool moves) {
    const char *name = lar_feb_attribute(feb, other->at, "name");
    return lar_feb_fail(feb, at, LAR_ERROR_MODEL,
                        "<%s> %s node %lld along %c, which <%s>%s%.60s%s in line %d %s; leave one "
                        "of the two",
                        lar_feb_name(at), moves ? "moves" : "fixes",
                        (long long)feb->mesh->node_id[node], "xyz"[axis], lar_feb_name(other->at),
                        name ? " '" : "", name ? name : "", name ? "'" : "",
                        lar_feb_line(other->at), other->move < 0 ? "fixes" : "moves");
}

lar_status lar_feb_hold(lar_feb *feb, const xmlNode *at, unsigned axes, lar_node_list *nodes,
                        const lar_move *move) {
    if (!feb->held) feb->held = lar_calloc(3 * (size_t)feb->mesh->node_count, sizeof *feb->held);
    if (!feb->held || !LAR_GROW(feb->holder, feb->holder_room, feb->holder_count))
        return lar_feb_no_memory(feb, "the supports");
    feb->holder[feb->holder_count++] = (lar_feb_holder){at, move ? feb->model->move_count : -1};
    int32_t count = nodes->count;
    nodes->count = 0;
    for (int32_t n = 0; n < count; n++) {
        const int32_t node = nodes->node[n];
        bool once = true;
        for (int axis = 0; axis < 3; axis++) {
            if (!(axes >> axis & 1)) continue;
            int32_t *holder = &feb->held[3 * (size_t)node + (size_t)axis];
            const lar_feb_holder *other = *holder ? &feb->holder[*holder - 1] : NULL;
            if (other && !is_same(feb->model, other, move))
                return refuse_holder(feb, at, other, node, axis, move != NULL);
            if (other && move) once = false;
            if (!other) *holder = feb->holder_count;
        }
        if (once) nodes->node[nodes->count++] = node;
    }
    return LAR_OK;
}

/* ---- boundary -------------------------------------------------------------------------------- */

/* x_dof, y_dof, z_dof: 0 or 1 each (version 4). */
static lar_status read_axis_flags(lar_feb *feb, const xmlNode *at, unsigned *axes) {
    static const char *const names[] = {"x_dof", "y_dof", "z_dof"};
    lar_status status = LAR_OK;
    *axes = 0;
    for (int i = 0; i < 3 && !status; i++) {
        bool set;
        status = lar_feb_flag(feb, at, names[i], false, &set);
        if (!status && set) *axes |= 1u << i;
    }
    return status;
}

/* "x,y,z" in <dofs> (version 3). */
static lar_status read_axis_list(lar_feb *feb, const xmlNode *dofs, unsigned *axes) {
    lar_feb_list list = lar_feb_list_of(feb, dofs);
    lar_span word;
    lar_status status = LAR_OK;
    *axes = 0;
    while (!status && lar_feb_list_next(&list, &word)) {
        int axis;
        status = lar_feb_axis_of(feb, dofs, word, &axis);
        if (!status && axis < 3) *axes |= 1u << axis;
    }
    return status;
}

static lar_status read_fix(lar_feb *feb, const xmlNode *at) {
    static const char known[] = "x_dof y_dof z_dof";
    const xmlNode *dofs = lar_feb_child(at, "dofs");
    unsigned axes;
    lar_status status = dofs ? read_axis_list(feb, dofs, &axes) : read_axis_flags(feb, at, &axes);
    lar_node_list nodes = {0};
    if (!status && !dofs && !lar_feb_child(at, "x_dof") && !lar_feb_child(at, "y_dof") &&
        !lar_feb_child(at, "z_dof"))
        return lar_feb_fail(feb, at, LAR_ERROR_FORMAT,
                            "<%s> does not say which axes it holds; add <x_dof>, <y_dof> or "
                            "<z_dof> with 1",
                            lar_feb_name(at));
    if (!status) status = lar_feb_notice_others(feb, at, dofs ? "dofs" : known);
    if (!status) status = lar_feb_nodes_of(feb, at, &nodes);
    if (!status && (axes == 0 || nodes.count == 0)) {
        free(nodes.node);
        return lar_feb_notice(feb, at, "<%s> holds no %s and was left out", lar_feb_name(at),
                              axes ? "node" : "axis");
    }
    if (!status) status = lar_feb_hold(feb, at, axes, &nodes, NULL);
    lar_fix *fix = status ? NULL : LAR_MODEL_APPEND(feb->model, fix);
    if (!status && !fix) status = lar_feb_no_memory(feb, "the supports");
    if (status) {
        free(nodes.node);
        return status;
    }
    *fix = (lar_fix){nodes, axes};
    return LAR_OK;
}

/* Without a load curve a displacement is there at once. Of a static deck only the end matters. */
lar_status lar_feb_notice_at_once(lar_feb *feb, const xmlNode *value, double by, int curve) {
    const lar_model *model = feb->model;
    if (by * lar_curve_value(&model->curve[curve], 0.0) == 0.0 || feb->is_static) return LAR_OK;
    return lar_feb_notice(feb, value, LAR_DISPLACED_AT_ONCE, "a load curve", "lc");
}

/* Its size stands in <value> in version 4, in <scale> in version 3. */
static lar_status read_move(lar_feb *feb, const xmlNode *at) {
    static const char known[] = "dof value scale relative shell_bottom";
    const xmlNode *dof, *value = lar_feb_child(at, "value");
    int axis = 0;
    lar_move move = {0};
    lar_status status = lar_feb_need_child(feb, at, "dof", &dof);
    if (!status) status = lar_feb_axis_of(feb, dof, lar_feb_text(feb, dof), &axis);
    if (!status && axis > 2) return LAR_OK;
    move.axes = 1u << axis;
    if (!status) status = lar_feb_scaled(feb, at, "value", &move.by, 1, &move.curve);
    if (!status)
        status = lar_feb_notice_at_once(feb, value ? value : lar_feb_child(at, "scale"), move.by,
                                        move.curve);
    if (!status) status = lar_feb_check_flags(feb, at);
    if (!status) status = lar_feb_notice_others(feb, at, known);
    if (!status) status = lar_feb_nodes_of(feb, at, &move.nodes);
    const bool none = move.nodes.count == 0;
    if (!status && none)
        status = lar_feb_notice(feb, at, "<%s> holds no node and was left out", lar_feb_name(at));
    if (!status && !none) status = lar_feb_hold(feb, at, move.axes, &move.nodes, &move);
    lar_move *to = status || move.nodes.count == 0 ? NULL : LAR_MODEL_APPEND(feb->model, move);
    if (to) {
        *to = move;
        return LAR_OK;
    }
    free(move.nodes.node);
    return status || move.nodes.count == 0 ? status : lar_feb_no_memory(feb, "the supports");
}

static lar_status read_bc(lar_feb *feb, const xmlNode *bc) {
    static const char known[] =
        "zero displacement, fixed displacement, fix, prescribed displacement, prescribe and rigid";
    if (lar_feb_is(bc, "rigid_body")) return lar_feb_read_rigid_body(feb, bc);
    if (!lar_feb_is(bc, "bc"))
        return lar_feb_fail(feb, bc, LAR_ERROR_UNSUPPORTED,
                            "<%s> in <Boundary> is not read and would change the answer; Lariat "
                            "reads <bc>",
                            lar_feb_name(bc));
    const char *type;
    lar_status status = lar_feb_need_attribute(feb, bc, "type", &type);
    if (status) return status;
    if (strcmp(type, "zero displacement") == 0 || strcmp(type, "fixed displacement") == 0 ||
        strcmp(type, "fix") == 0)
        return read_fix(feb, bc);
    if (strcmp(type, "zero shell displacement") == 0 || strcmp(type, "zero rotation") == 0)
        return lar_feb_notice(feb, bc,
                              "a %s holds shells, of which there are none; it was left out", type);
    if (strcmp(type, "prescribed displacement") == 0 || strcmp(type, "prescribe") == 0)
        return read_move(feb, bc);
    if (strcmp(type, "rigid") == 0) return lar_feb_tie_to_rigid(feb, bc);
    return lar_feb_refuse_type(feb, bc, known);
}

lar_status lar_feb_read_boundary(lar_feb *feb, const xmlNode *section) {
    lar_status status = LAR_OK;
    for (xmlNode *bc = lar_feb_first(section); bc && !status; bc = lar_feb_next(bc))
        status = read_bc(feb, bc);
    return status;
}

/* ---- initial --------------------------------------------------------------------------------- */

/* How many nodes two lists, both ascending, share. */
static int32_t count_shared(const lar_node_list *a, const lar_node_list *b) {
    int32_t shared = 0;
    for (int32_t i = 0, k = 0; i < a->count && k < b->count;) {
        const int32_t first = a->node[i], second = b->node[k];
        shared += first == second;
        i += first <= second;
        k += second <= first;
    }
    return shared;
}

/* "init_dof" is a velocity along one axis. Of a node's entries the last one counts, so those of the
 * same nodes become one. */
static lar_status join_initial(lar_feb *feb, const xmlNode *ic, const lar_initial_velocity *entry,
                               int axis, bool *joined) {
    for (int i = feb->model->initial_count; i > 0 && !*joined; i--) {
        lar_initial_velocity *other = &feb->model->initial[i - 1];
        const int32_t shared = count_shared(&other->nodes, &entry->nodes);
        if (shared == 0) continue;
        if (shared != other->nodes.count || shared != entry->nodes.count)
            return lar_feb_fail(feb, ic, LAR_ERROR_UNSUPPORTED,
                                "some of these nodes have an initial velocity already, along "
                                "other axes; give all of them to the same nodes");
        other->velocity[axis] = entry->velocity[axis];
        *joined = true;
    }
    return LAR_OK;
}

/* "vx", "vy" or "vz" in <dof> as an axis number. */
static lar_status velocity_axis(lar_feb *feb, const xmlNode *ic, int *axis) {
    static const char names[] = "xyz";
    const xmlNode *dof;
    lar_status status = lar_feb_need_child(feb, ic, "dof", &dof);
    if (status) return status;
    lar_span word = lar_feb_text(feb, dof);
    const char *found = word.length == 2 && *word.at == 'v' ? strchr(names, word.at[1]) : NULL;
    if (!found)
        return lar_feb_fail(feb, ic, LAR_ERROR_UNSUPPORTED,
                            "'%.*s' is not one of vx, vy, vz, all that a run begins with",
                            (int)(word.length < 40 ? word.length : 40), word.at);
    *axis = (int)(found - names);
    return LAR_OK;
}

static lar_status read_ic(lar_feb *feb, const xmlNode *ic) {
    static const char known[] = "value dof";
    const char *type;
    lar_status status = lar_feb_need_attribute(feb, ic, "type", &type);
    if (status) return status;
    const bool one = strcmp(type, "init_dof") == 0;
    if (!lar_feb_is_any(ic, "ic init") ||
        (!one && strcmp(type, "velocity") != 0 && strcmp(type, "initial velocity") != 0))
        return lar_feb_refuse_type(feb, ic, "<ic> of type velocity");
    const xmlNode *value;
    lar_initial_velocity entry = {0};
    int axis = 0;
    bool joined = false;
    status = lar_feb_need_child(feb, ic, "value", &value);
    if (!status) status = lar_feb_curve_of(feb, value, NULL);
    if (!status && lar_feb_attribute(feb, value, "lc"))
        status = lar_feb_fail(feb, value, LAR_ERROR_UNSUPPORTED,
                              "an initial velocity with a curve is not read; give it numbers");
    if (!status && one) status = velocity_axis(feb, ic, &axis);
    if (!status) status = lar_feb_doubles(feb, value, &entry.velocity[axis], one ? 1 : 3);
    if (!status) status = lar_feb_notice_others(feb, ic, known);
    if (!status) status = lar_feb_nodes_of(feb, ic, &entry.nodes);
    if (!status && one) status = join_initial(feb, ic, &entry, axis, &joined);
    lar_initial_velocity *initial = status || joined ? NULL : LAR_MODEL_APPEND(feb->model, initial);
    if (!status && !joined && !initial) status = lar_feb_no_memory(feb, "the initial velocities");
    if (initial)
        *initial = entry;
    else
        free(entry.nodes.node);
    return status;
}

lar_status lar_feb_read_initial(lar_feb *feb, const xmlNode *section) {
    lar_status status = LAR_OK;
    for (xmlNode *ic = lar_feb_first(section); ic && !status; ic = lar_feb_next(ic))
        status = read_ic(feb, ic);
    return status;
}
