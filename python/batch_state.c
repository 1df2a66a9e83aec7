/* class Batch: arrays over all members, their tools, states to go back to. */
#include <math.h>

#include "module.h"

/* ---- arrays out ----------------------------------------------------------------------------- */

/* How long a look at a node and at a tool takes, about [s]. */
static const double NODE = 5e-9, TOOL = 0.5e-6;

/* An array of which every member fills a part. */
typedef struct out_array {
    void *data;
    int nodes, tools;
    void (*nodes_of)(const lar_simulation *, double (*)[3]);
} out_array;

/* `call` (out=None): [members] and behind that `dimensions` - 1 of `shape`. */
static PyObject *fill(PyObject *me, PyObject *args, PyObject *keywords, python_member_call *call,
                      char format, int dimensions, Py_ssize_t shape[3]) {
    static char *names[] = {"out", NULL};
    PyObject *out = NULL;
    char words[32];
    snprintf(words, sizeof words, "|O:%s", call->name);
    if (!PyArg_ParseTupleAndKeywords(args, keywords, words, names, &out)) return NULL;
    python_batch *self = python_batch_look(me, call->name);
    python_target target;
    shape[0] = self ? self->count : 0;
    if (!self || !python_target_of_shape(out, format, dimensions, shape, &target)) return NULL;
    out_array *array = call->context;
    array->data = target.data;
    array->nodes = self->nodes;
    array->tools = self->tools;
    python_members_parse(self, NULL, &call->members);
    bool ok = python_batch_run(self, call);
    return python_target_close(&target, !ok);
}

static lar_status copy_nodes(python_member_call *call, python_member *member, int place,
                             bool caller, lar_error *error) {
    const out_array *a = call->context;
    (void)caller, (void)error;
    a->nodes_of(member->taken, (double(*)[3])a->data + (size_t)place * (size_t)a->nodes);
    return LAR_OK;
}

static PyObject *nodes(PyObject *me, PyObject *args, PyObject *keywords, const char *name,
                       void nodes_of(const lar_simulation *, double (*)[3])) {
    out_array array = {.nodes_of = nodes_of};
    python_batch *self = (python_batch *)me;
    python_member_call call = {
        .name = name, .work = copy_nodes, .cost = NODE * self->nodes, .context = &array};
    Py_ssize_t shape[3] = {0, self->nodes, 3};
    return fill(me, args, keywords, &call, 'd', 3, shape);
}

static PyObject *positions(PyObject *me, PyObject *args, PyObject *keywords) {
    return nodes(me, args, keywords, "positions", python_positions);
}
static PyObject *displacements(PyObject *me, PyObject *args, PyObject *keywords) {
    return nodes(me, args, keywords, "displacements", lar_simulation_displacements);
}
static PyObject *velocities(PyObject *me, PyObject *args, PyObject *keywords) {
    return nodes(me, args, keywords, "velocities", lar_simulation_velocities);
}

static lar_status copy_wrenches(python_member_call *call, python_member *member, int place,
                                bool caller, lar_error *error) {
    const out_array *a = call->context;
    double(*out)[6] = (double(*)[6])a->data + (size_t)place * (size_t)a->tools;
    lar_status status = LAR_OK;
    (void)caller;
    for (int t = 0; t < a->tools && !status; t++) {
        lar_tool_force f;
        status = lar_simulation_tool_force(member->taken, t, &f, error);
        for (int k = 0; k < 3 && !status; k++) {
            out[t][k] = f.force[k];
            out[t][3 + k] = f.torque[k];
        }
    }
    return status;
}

static lar_status copy_held(python_member_call *call, python_member *member, int place, bool caller,
                            lar_error *error) {
    const out_array *a = call->context;
    int32_t *out = (int32_t *)a->data + (size_t)place * (size_t)a->tools;
    lar_status status = LAR_OK;
    (void)caller;
    for (int t = 0; t < a->tools && !status; t++) {
        lar_tool_force f;
        status = lar_simulation_tool_force(member->taken, t, &f, error);
        if (!status) out[t] = f.held;
    }
    return status;
}

static lar_status copy_poses(python_member_call *call, python_member *member, int place,
                             bool caller, lar_error *error) {
    const out_array *a = call->context;
    double(*out)[7] = (double(*)[7])a->data + (size_t)place * (size_t)a->tools;
    lar_status status = LAR_OK;
    (void)caller;
    for (int t = 0; t < a->tools && !status; t++) {
        lar_tool_pose pose;
        status = lar_simulation_tool_pose(member->taken, t, &pose, error);
        if (status) break;
        memcpy(out[t], pose.position, sizeof pose.position);
        memcpy(out[t] + 3, pose.orientation, sizeof pose.orientation);
    }
    return status;
}

static lar_status copy_openings(python_member_call *call, python_member *member, int place,
                                bool caller, lar_error *error) {
    const out_array *a = call->context;
    double *out = (double *)a->data + (size_t)place * (size_t)a->tools;
    lar_status status = LAR_OK;
    (void)caller;
    for (int t = 0; t < a->tools && !status; t++) {
        lar_tool_pose pose;
        status = lar_simulation_tool_pose(member->taken, t, &pose, error);
        if (!status) out[t] = pose.opening;
    }
    return status;
}

static PyObject *of_tools(PyObject *me, PyObject *args, PyObject *keywords, const char *name,
                          python_member_work *work, char format, int columns) {
    out_array array = {.data = NULL};
    python_batch *self = (python_batch *)me;
    python_member_call call = {
        .name = name, .work = work, .cost = TOOL * self->tools, .context = &array};
    Py_ssize_t shape[3] = {0, self->tools, columns};
    return fill(me, args, keywords, &call, format, columns > 1 ? 3 : 2, shape);
}

static PyObject *wrenches(PyObject *me, PyObject *args, PyObject *keywords) {
    return of_tools(me, args, keywords, "wrenches", copy_wrenches, 'd', 6);
}
static PyObject *held(PyObject *me, PyObject *args, PyObject *keywords) {
    return of_tools(me, args, keywords, "held", copy_held, 'i', 1);
}
static PyObject *tool_poses(PyObject *me, PyObject *args, PyObject *keywords) {
    return of_tools(me, args, keywords, "tool_poses", copy_poses, 'd', 7);
}
static PyObject *tool_openings(PyObject *me, PyObject *args, PyObject *keywords) {
    return of_tools(me, args, keywords, "tool_openings", copy_openings, 'd', 1);
}

/* ---- what a learner sees -------------------------------------------------------------------- */

/* Of the first tool: tip, opening, wrench, points held. */
enum { OF_TOOL = 3 + 1 + 6 + 1 };

typedef struct observe_call {
    double *out; /* [members][OF_TOOL + 3 watched] */
    const int32_t *node;
    size_t watched, nodes;
} observe_call;

static lar_status observe_member(python_member_call *call, python_member *member, int place,
                                 bool caller, lar_error *error) {
    const observe_call *o = call->context;
    double *row = o->out + (size_t)place * (OF_TOOL + 3 * o->watched);
    lar_tool_pose pose;
    lar_tool_force force;
    (void)caller;
    lar_status status = lar_simulation_tool_pose(member->taken, 0, &pose, error);
    if (!status) status = lar_simulation_tool_force(member->taken, 0, &force, error);
    if (status) return status;
    double(*all)[3] = malloc(o->nodes * sizeof *all);
    if (!all) {
        *error = (lar_error){LAR_ERROR_MEMORY, "no memory for the places of nodes"};
        return LAR_ERROR_MEMORY;
    }
    python_positions(member->taken, all);
    memcpy(row, pose.position, sizeof pose.position);
    row[3] = pose.opening;
    memcpy(row + 4, force.force, sizeof force.force);
    memcpy(row + 7, force.torque, sizeof force.torque);
    row[10] = force.held;
    for (size_t i = 0; i < o->watched; i++)
        memcpy(row + OF_TOOL + 3 * i, all[o->node[i]], sizeof all[0]);
    free(all);
    return LAR_OK;
}

static bool check_watched(const python_batch *self, const python_rows *nodes) {
    if (self->tools == 0) return python_refuse("observe: the members have no tool");
    for (Py_ssize_t i = 0; i < nodes->rows; i++) {
        int32_t node = ((const int32_t *)nodes->data)[i];
        if (node < 0 || node >= self->nodes)
            return python_refuse("nodes: there is no node %d; there are %d, counted from 0",
                                 (int)node, self->nodes);
    }
    return true;
}

static PyObject *observe(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"nodes", "out", NULL};
    PyObject *source, *out = NULL;
    python_rows nodes = {.data = NULL};
    python_target target;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O|O:observe", names, &source, &out) ||
        !python_integers(source, "nodes", 0, &nodes))
        return NULL;
    python_batch *self = python_batch_look(me, "observe");
    const Py_ssize_t shape[3] = {self ? self->count : 0, OF_TOOL + 3 * nodes.rows, 1};
    bool ok =
        self && check_watched(self, &nodes) && python_target_of_shape(out, 'd', 2, shape, &target);
    if (!ok) {
        python_rows_free(&nodes);
        return NULL;
    }
    observe_call o = {target.data, nodes.data, (size_t)nodes.rows, (size_t)self->nodes};
    python_member_call call = {
        .name = "observe", .work = observe_member, .cost = NODE * self->nodes, .context = &o};
    python_members_parse(self, NULL, &call.members);
    ok = python_batch_run(self, &call);
    python_rows_free(&nodes);
    return python_target_close(&target, !ok);
}

/* ---- numbers -------------------------------------------------------------------------------- */

static lar_status copy_hash(python_member_call *call, python_member *member, int place, bool caller,
                            lar_error *error) {
    (void)caller, (void)error;
    ((uint64_t *)call->context)[place] = lar_simulation_hash(member->taken);
    return LAR_OK;
}
static lar_status copy_step(python_member_call *call, python_member *member, int place, bool caller,
                            lar_error *error) {
    (void)caller, (void)error;
    ((uint64_t *)call->context)[place] = lar_simulation_steps(member->taken);
    return LAR_OK;
}

/* A tuple of ints, one for each member. */
static PyObject *integers(PyObject *me, const char *name, python_member_work *work, double cost) {
    python_batch *self = python_batch_look(me, name);
    uint64_t *value = self ? PyMem_Calloc((size_t)self->count, sizeof *value) : NULL;
    if (!value) return self ? PyErr_NoMemory() : NULL;
    python_member_call call = {.name = name, .work = work, .cost = cost, .context = value};
    python_members_parse(self, NULL, &call.members);
    int count = self->count;
    PyObject *tuple = python_batch_run(self, &call) ? PyTuple_New(count) : NULL;
    for (int i = 0; tuple && i < count; i++) {
        PyObject *number = PyLong_FromUnsignedLongLong(value[i]);
        if (!number || PyTuple_SetItem(tuple, i, number)) Py_CLEAR(tuple);
    }
    PyMem_Free(value);
    return tuple;
}

static PyObject *hashes(PyObject *me, PyObject *nothing) {
    (void)nothing;
    return integers(me, "hashes", copy_hash, 4 * NODE * ((python_batch *)me)->nodes);
}
static PyObject *steps(PyObject *me, PyObject *nothing) {
    (void)nothing;
    return integers(me, "steps", copy_step, 0);
}

/* ---- tools ---------------------------------------------------------------------------------- */

typedef struct move_call {
    const double (*pose)[7]; /* [members][columns] */
    const double *opening;   /* [members][columns]; NULL: as they were asked for */
    int columns;
    int32_t tool[LAR_TOOLS_MAX]; /* [columns] */
    unsigned long long steps;
} move_call;

static lar_status move_tool(const move_call *m, python_member *member, size_t at, int32_t tool,
                            lar_error *error) {
    python_asked *asked = &member->simulation->asked[tool];
    lar_tool_pose pose;
    lar_status status = lar_simulation_tool_pose(member->taken, tool, &pose, error);
    if (status) return status;
    memcpy(pose.position, m->pose[at], sizeof pose.position);
    memcpy(pose.orientation, m->pose[at] + 3, sizeof pose.orientation);
    if (m->opening)
        pose.opening = m->opening[at];
    else if (!isnan(asked->opening))
        pose.opening = asked->opening;
    status = lar_simulation_tool_move(member->taken, tool, &pose, m->steps, error);
    if (!status) python_asked_set(asked, &pose);
    return status;
}

static lar_status move_tools(python_member_call *call, python_member *member, int place,
                             bool caller, lar_error *error) {
    const move_call *m = call->context;
    (void)caller;
    /* No step: what has broken off says so, as a tool of a simulation does. */
    lar_status status = lar_simulation_advance(member->taken, 0, error);
    for (int c = 0; c < m->columns && !status; c++)
        status =
            move_tool(m, member, (size_t)place * (size_t)m->columns + (size_t)c, m->tool[c], error);
    return status;
}

/* Whether the last of these tools is not there before; of two poses for one only one would count.
 */
static bool once(const int32_t *tool, int last) {
    for (int c = 0; c < last; c++)
        if (tool[c] == tool[last])
            return python_refuse("tools: tool %d is there twice", (int)tool[last]);
    return true;
}

/* The tools that the columns are for; None: all. */
static bool parse_tools(python_batch *self, PyObject *source, move_call *m) {
    python_simulation *first = self->member[0].simulation; /* kept: reading may close the batch */
    m->columns = self->tools;
    for (int c = 0; c < m->columns; c++) m->tool[c] = c;
    if (!source || source == Py_None) return true;
    PyObject *list =
        PySequence_Check(source) && !PyUnicode_Check(source) ? PySequence_Tuple(source) : NULL;
    if (!list) {
        PyErr_Clear();
        return python_refuse_type("tools: expected a sequence of tools, numbers or names, got %R",
                                  (PyObject *)Py_TYPE(source));
    }
    Py_ssize_t count = PyTuple_Size(list);
    bool ok = count <= LAR_TOOLS_MAX || python_refuse("tools: %zd are too many", count);
    m->columns = ok ? (int)count : 0;
    Py_INCREF((PyObject *)first);
    for (int c = 0; c < m->columns && ok; c++)
        ok = python_simulation_tool(first, "set_tool_poses", PyTuple_GetItem(list, c),
                                    &m->tool[c]) &&
             once(m->tool, c);
    Py_DECREF((PyObject *)first);
    Py_DECREF(list);
    return ok;
}

/* The arrays of poses and openings for so many members. */
static bool take_poses(PyObject *poses, PyObject *openings, int count, move_call *m,
                       python_rows *pose, python_rows *opening) {
    const Py_ssize_t shape[3] = {count, m->columns, 7};
    if (!python_block(poses, "poses", shape, pose)) return false;
    m->pose = pose->data;
    if (openings && openings != Py_None) {
        if (!python_doubles(openings, "openings", m->columns, opening)) return false;
        if (opening->rows != count)
            return python_refuse("openings: expected shape [%d, %d], got %zd rows", count,
                                 m->columns, opening->rows);
        m->opening = opening->data;
    }
    return true;
}

static PyObject *set_tool_poses(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"poses", "steps", "openings", "tools", "members", NULL};
    PyObject *poses, *count = NULL, *openings = NULL, *tools = NULL, *members = NULL;
    move_call m = {.steps = 1};
    python_rows pose = {.data = NULL}, opening = {.data = NULL};
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O|O$OOO:set_tool_poses", names, &poses,
                                     &count, &openings, &tools, &members) ||
        (count && !python_steps(count, "steps", &m.steps)))
        return NULL;
    python_batch *self = python_batch_look(me, "set_tool_poses");
    if (!self || !parse_tools(self, tools, &m) || !python_batch_look(me, "set_tool_poses"))
        return NULL;
    python_member_call call = {
        .name = "set_tool_poses", .work = move_tools, .cost = 2 * TOOL * m.columns, .context = &m};
    if (!python_members_parse(self, members, &call.members)) return NULL;
    bool ok = take_poses(poses, openings, call.members.count, &m, &pose, &opening);
    /* Reading numbers may have run any code. */
    if (ok && !python_batch_look(me, "set_tool_poses")) ok = false;
    if (ok)
        ok = python_batch_run(self, &call);
    else
        python_rows_free(&call.members.rows);
    python_rows_free(&pose);
    python_rows_free(&opening);
    if (!ok) return NULL;
    Py_RETURN_NONE;
}

/* ---- states --------------------------------------------------------------------------------- */

static PyObject *save(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_batch *self = python_batch_look(me, "save");
    if (!self || !python_batch_sound(self, "save")) return NULL;
    PyObject *list = PyList_New(0);
    for (int i = 0; list && self->member && i < self->count; i++) {
        PyObject *saved = PyObject_CallMethod((PyObject *)self->member[i].simulation, "save", NULL);
        if (!saved || PyList_Append(list, saved)) Py_CLEAR(list);
        Py_XDECREF(saved);
    }
    return list;
}

typedef struct load_call {
    python_saved **saved; /* [members] */
} load_call;

static lar_status load_member(python_member_call *call, python_member *member, int place,
                              bool caller, lar_error *error) {
    const load_call *l = call->context;
    (void)caller;
    python_asked *asked = member->simulation->asked;
    const python_saved *saved = l->saved ? l->saved[place] : NULL;
    lar_status status = saved ? lar_simulation_load_from(member->taken, saved->saved, error)
                              : lar_simulation_reset(member->taken, error);
    python_asked_forget(asked);
    if (!status && saved) memcpy(asked, saved->asked, sizeof saved->asked);
    if (!status) member->simulation->broken = false;
    return status;
}

/* Before any member goes back. */
static bool saved_fit(python_batch *self, const python_members *members, python_saved **saved) {
    for (int i = 0; i < members->count; i++) {
        const int index = python_member_at(members, i);
        lar_simulation *simulation =
            python_simulation_look(self->member[index].simulation, "reset");
        char call[40];
        snprintf(call, sizeof call, "member %d: reset", index);
        if (!simulation || !python_saved_fits(saved[i], simulation, call)) return false;
    }
    return true;
}

/* One Saved for all, or one for each; the list keeps them. */
static bool list_saved(PyObject *source, int count, python_saved **saved, PyObject **keep) {
    bool one = Py_TYPE(source) == python_saved_type;
    *keep = one                                                    ? PyTuple_Pack(1, source)
            : PySequence_Check(source) && !PyUnicode_Check(source) ? PySequence_Tuple(source)
                                                                   : NULL;
    if (!*keep) {
        PyErr_Clear();
        return python_refuse_type("state: expected a Saved, or one for each member, got %R",
                                  (PyObject *)Py_TYPE(source));
    }
    if (!one && PyTuple_Size(*keep) != count)
        return python_refuse("state: %zd are given for %d members", PyTuple_Size(*keep), count);
    for (int i = 0; i < count; i++) {
        PyObject *item = PyTuple_GetItem(*keep, one ? 0 : i);
        if (Py_TYPE(item) != python_saved_type)
            return python_refuse_type("state: expected a Saved, item %d is %R", i,
                                      (PyObject *)Py_TYPE(item));
        saved[i] = (python_saved *)item;
    }
    return true;
}

static void give_saved(python_saved **saved, int count) {
    for (int i = 0; i < count; i++) python_saved_give(saved[i]);
}
static bool take_saved(python_saved **saved, int count) {
    for (int i = 0; i < count; i++) {
        if (python_saved_take(saved[i], false, "reset")) continue;
        give_saved(saved, i);
        return false;
    }
    return true;
}

static PyObject *reset(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"members", "state", NULL};
    PyObject *members = NULL, *state = Py_None, *keep = NULL;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|OO:reset", names, &members, &state))
        return NULL;
    python_batch *self = python_batch_look(me, "reset");
    if (!self) return NULL;
    load_call l = {.saved = NULL};
    python_member_call call = {
        .name = "reset", .work = load_member, .cost = 4 * NODE * self->nodes, .context = &l};
    if (!python_members_parse(self, members, &call.members)) return NULL;
    int count = call.members.count;
    bool ok = true;
    if (state != Py_None) {
        l.saved = PyMem_Calloc((size_t)count + 1, sizeof(python_saved *));
        ok = l.saved ? list_saved(state, count, l.saved, &keep) : PyErr_NoMemory() != NULL;
        ok = ok && python_batch_look(me, "reset") && saved_fit(self, &call.members, l.saved) &&
             take_saved(l.saved, count);
    }
    if (ok) {
        ok = python_batch_run(self, &call);
        if (l.saved) give_saved(l.saved, count);
    } else {
        python_rows_free(&call.members.rows);
    }
    PyMem_Free(l.saved);
    Py_XDECREF(keep);
    if (!ok) return NULL;
    Py_RETURN_NONE;
}

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
#define OUT_DOC                                                                                    \
    " Copied into `out` where given, a contiguous array of that shape, which asks for no memory, " \
    "else into a fresh memoryview; numpy.asarray takes that without another copy."
PyMethodDef python_batch_state_methods[] = {
    {"positions", FUNCTION(positions), METH_VARARGS | METH_KEYWORDS,
     "positions($self, out=None)\n--\n\nWhere the nodes are now [m], float64 [n, nodes, "
     "3]." OUT_DOC},
    {"displacements", FUNCTION(displacements), METH_VARARGS | METH_KEYWORDS,
     "displacements($self, out=None)\n--\n\nHow far the nodes are from their places at rest [m], "
     "float64 [n, nodes, 3]." OUT_DOC},
    {"velocities", FUNCTION(velocities), METH_VARARGS | METH_KEYWORDS,
     "velocities($self, out=None)\n--\n\nVelocities half a step back [m/s], float64 [n, nodes, "
     "3]." OUT_DOC},
    {"wrenches", FUNCTION(wrenches), METH_VARARGS | METH_KEYWORDS,
     "wrenches($self, out=None)\n--\n\nWhat tissue does to the tools: force [N] and torque about "
     "the tip [N m], means over the last advance of each member, float64 [n, tools, 6]." OUT_DOC},
    {"held", FUNCTION(held), METH_VARARGS | METH_KEYWORDS,
     "held($self, out=None)\n--\n\nHow many surface points each tool has hold of, int32 [n, "
     "tools]." OUT_DOC},
    {"tool_poses", FUNCTION(tool_poses), METH_VARARGS | METH_KEYWORDS,
     "tool_poses($self, out=None)\n--\n\nWhere the tools are now: position of the tip [m] and unit "
     "quaternion w, x, y, z, float64 [n, tools, 7]." OUT_DOC},
    {"tool_openings", FUNCTION(tool_openings), METH_VARARGS | METH_KEYWORDS,
     "tool_openings($self, out=None)\n--\n\nHow far jaws are open now, 0 closed to 1 open, float64 "
     "[n, tools]." OUT_DOC},
    {"set_tool_poses", FUNCTION(set_tool_poses), METH_VARARGS | METH_KEYWORDS,
     "set_tool_poses($self, poses, steps=1, *, openings=None, tools=None, members=None)\n--\n\n"
     "From now on tools move evenly to these poses, within so many steps, and rest there.\n\n"
     "poses     float64 [k, t, 7]: position of the tip [m], unit quaternion w, x, y, z\n"
     "openings  float64 [k, t], 0 closed to 1 open; None: as they were asked for last\n"
     "tools     the t tools, numbers or names of member 0; None: all, without spares\n"
     "members   int32 [k], which ones; None: all\n\n"
     "No faster than half the tool's radius in a step. What one member refuses is raised when the "
     "others\nhave moved; `members` of the exception is a dict of member: message."},
    {"observe", FUNCTION(observe), METH_VARARGS | METH_KEYWORDS,
     "observe($self, nodes, out=None)\n--\n\nWhat environments see, by one call, float64 [n, 11 + "
     "3 w]: of the first tool the tip (3, m), how far its jaws are open (1), the wrench (6, N and "
     "N m about the tip) and how many surface points it has hold of (1); and the places of "
     "`nodes`, "
     "int32 [w] (m)." OUT_DOC},
    {"hashes", hashes, METH_NOARGS,
     "hashes($self)\n--\n\nSimulation.hash() of every member, a tuple of ints."},
    {"steps", steps, METH_NOARGS,
     "steps($self)\n--\n\nSteps done by every member, a tuple of ints."},
    {"save", save, METH_NOARGS,
     "save($self)\n--\n\nThe states, a list of one Saved for each member. While members have "
     "broken off there is none: `members` of the UnstableError names them, `reset` takes them up."},
    {"reset", FUNCTION(reset), METH_VARARGS | METH_KEYWORDS,
     "reset($self, members=None, state=None)\n--\n\nPuts members (int32 [k]; None: all) back: to "
     "the state that they were made with, or to `state`, a Saved of the same model for all of "
     "them, or a sequence of one for each. Without `state` added tools stay, where they were "
     "added; with\nit members have the tools that it was saved with. An unstable member is sound "
     "again then."},
    {NULL, NULL, 0, NULL}};
