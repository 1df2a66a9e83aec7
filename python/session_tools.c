/* class Session: tools, devices, forces. */
#include "module.h"

static lar_session *look(PyObject *me, PyObject *tool, int32_t *index, const char *call) {
    return python_session_tool((python_session *)me, call, tool, index);
}
/* The same for calls that wait for the engine. */
static lar_session *take(PyObject *me, PyObject *tool, int32_t *index, const char *call) {
    lar_session *session = look(me, tool, index, call);
    return session ? python_session_take((python_session *)me, call) : NULL;
}

static PyObject *get_tools(PyObject *me, void *unused) {
    (void)unused;
    lar_tool_info info;
    lar_session *session = python_session_look((python_session *)me, "tools");
    PyObject *list = session ? PyList_New(0) : NULL;
    for (int32_t i = 0; list && !lar_session_tool_info(session, i, &info, NULL); i++) {
        PyObject *dict = python_tool_dict(&info);
        if (!dict || PyList_Append(list, dict)) Py_CLEAR(list);
        Py_XDECREF(dict);
    }
    return list;
}

static PyObject *tool_move(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"tool", "position", "orientation", "opening", NULL};
    PyObject *tool, *position, *orientation = NULL, *opening = NULL;
    int32_t index;
    lar_tool_pose now, pose;
    lar_error error;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "OO|$OO:tool_move", names, &tool, &position,
                                     &orientation, &opening))
        return NULL;
    lar_session *session = look(me, tool, &index, "tool_move");
    if (!session) return NULL;
    if (lar_session_tool_force(session, index, &now, NULL, &error)) return python_raise(&error);
    python_session *self = (python_session *)me;
    python_asked *asked = &self->asked[index];
    const bool turns = lar_model_tool_free(self->simulation->model->model, index) != 0;
    if (!python_pose(position, orientation, opening, asked, turns, &now, &pose)) return NULL;
    /* Reading numbers may have run any code. */
    if (!python_session_look_sound((python_session *)me, "tool_move")) return NULL;
    if (!(session = look(me, tool, &index, "tool_move"))) return NULL;
    if (lar_session_tool_move(session, index, &pose, &error)) return python_raise(&error);
    python_asked_set(asked, &pose);
    Py_RETURN_NONE;
}

static PyObject *grasp(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"tool", "point", NULL};
    PyObject *tool, *point = Py_None;
    int32_t index, held = 0;
    double place[3] = {0};
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O|O:grasp", names, &tool, &point) ||
        (point != Py_None && !python_vector(point, "point", 3, place)))
        return NULL;
    lar_session *session = take(me, tool, &index, "grasp");
    if (!session) return NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(
        status = lar_session_grasp(session, index, point == Py_None ? NULL : place, &held, &error));
    python_session_give((python_session *)me);
    if (status) return python_raise(&error);
    bool got = point == Py_None || held > 0; /* else a hand stays open */
    ((python_session *)me)->asked[index].opening = got ? 0 : 1;
    return PyLong_FromLong(held);
}

static PyObject *release(PyObject *me, PyObject *tool) {
    int32_t index;
    lar_session *session = take(me, tool, &index, "release");
    if (!session) return NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = lar_session_release(session, index, &error));
    python_session_give((python_session *)me);
    if (!status) ((python_session *)me)->asked[index].opening = 1;
    return python_answer(status, &error);
}

static bool force_of(PyObject *me, PyObject *tool, const char *call, lar_tool_pose *pose,
                     lar_tool_force *force) {
    int32_t index;
    lar_error error;
    lar_session *session = look(me, tool, &index, call);
    if (!session) return false;
    if (!lar_session_tool_force(session, index, pose, force, &error)) return true;
    python_raise(&error);
    return false;
}

static PyObject *tool_pose(PyObject *me, PyObject *tool) {
    lar_tool_pose pose;
    return force_of(me, tool, "tool_pose", &pose, NULL) ? python_pose_dict(&pose) : NULL;
}
static PyObject *tool_force(PyObject *me, PyObject *tool) {
    lar_tool_force force;
    return force_of(me, tool, "tool_force", NULL, &force) ? python_force_dict(&force) : NULL;
}
static PyObject *wrench(PyObject *me, PyObject *tool) {
    lar_tool_force force;
    return force_of(me, tool, "wrench", NULL, &force) ? python_wrench(&force) : NULL;
}

static PyObject *felt(PyObject *me, PyObject *tool) {
    int32_t index;
    double f[3], t[3];
    lar_error error;
    lar_session *session = look(me, tool, &index, "felt");
    if (!session) return NULL;
    if (lar_session_tool_felt(session, index, f, t, &error)) return python_raise(&error);
    return Py_BuildValue("(dddddd)", f[0], f[1], f[2], t[0], t[1], t[2]);
}

static PyObject *tool_touches(PyObject *me, PyObject *tool) {
    enum { ROOM = 1024 }; /* between two looks the tick has moved on: one look has to do */
    int32_t index, count = 0;
    lar_session *session = take(me, tool, &index, "tool_touches");
    if (!session) return NULL;
    lar_error error = {.status = LAR_ERROR_MEMORY, .message = "no memory for points of contact"};
    lar_status status = LAR_ERROR_MEMORY;
    lar_touch *touch = malloc(ROOM * sizeof *touch);
    if (touch)
        PYTHON_UNLOCKED(status =
                            lar_session_tool_touches(session, index, ROOM, touch, &count, &error));
    python_session_give((python_session *)me);
    PyObject *list =
        status ? python_raise(&error) : python_touch_list(touch, count < ROOM ? count : ROOM);
    free(touch);
    return list;
}

static PyObject *tool_load(PyObject *me, PyObject *tool) {
    int32_t index;
    lar_tool_load l;
    lar_error error;
    lar_session *session = look(me, tool, &index, "tool_load");
    if (!session) return NULL;
    if (lar_session_tool_load(session, index, &l, &error)) return python_raise(&error);
    return Py_BuildValue("{s:d,s:d,s:N,s:d}", "force", l.force, "limit", l.limit, "reached",
                         PyBool_FromLong(l.reached), "grasp_force", l.grasp_force);
}

static PyObject *force_history(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"tool", "after", NULL};
    PyObject *tool;
    PyObject *number = NULL;
    unsigned long long after = 0;
    uint64_t last = 0;
    int32_t index;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O|O:force_history", names, &tool, &number) ||
        (number && !python_steps(number, "after", &after)))
        return NULL;
    lar_session *session = look(me, tool, &index, "force_history");
    if (!session) return NULL;
    float(*force)[3] = malloc(LAR_HISTORY_TICKS * sizeof *force);
    if (!force) return PyErr_NoMemory();
    int32_t count =
        lar_session_force_history(session, index, after, LAR_HISTORY_TICKS, force, &last);
    void *data;
    PyObject *array = python_array_new('f', count, 3, &data);
    if (array) memcpy(data, force, (size_t)count * sizeof *force);
    free(force);
    return array ? Py_BuildValue("(NK)", array, (unsigned long long)last) : NULL;
}

static PyObject *add_tool(PyObject *me, PyObject *args, PyObject *keywords) {
    lar_tool_info wanted;
    lar_error error;
    lar_status status;
    int32_t index = 0;
    if (!python_tool_wanted(args, keywords, &wanted)) return NULL;
    lar_session *session = python_session_take((python_session *)me, "add_tool");
    if (!session) return NULL;
    PYTHON_UNLOCKED(status = lar_session_add_tool(session, &wanted, &index, &error));
    python_session_give((python_session *)me);
    return status ? python_raise(&error) : PyLong_FromLong(index);
}

static PyObject *remove_tool(PyObject *me, PyObject *tool) {
    int32_t index;
    lar_error error;
    lar_status status;
    lar_session *session = take(me, tool, &index, "remove_tool");
    if (!session) return NULL;
    PYTHON_UNLOCKED(status = lar_session_remove_tool(session, index, &error));
    python_session_give((python_session *)me);
    return python_answer(status, &error);
}

/* ---- devices -------------------------------------------------------------------------------- */

static PyObject *attach(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"tool", "device", NULL};
    PyObject *tool, *word;
    const char *device;
    int32_t index;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "OO:attach", names, &tool, &word) ||
        !(device = python_text(word, "device")))
        return NULL;
    if (!*device) {
        python_refuse("device: expected one such as \"udp:127.0.0.1:9000\", got %R", word);
        return NULL;
    }
    lar_session *session = take(me, tool, &index, "attach");
    if (!session) return NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = lar_session_attach(session, index, device, &error));
    python_session_give((python_session *)me);
    return python_answer(status, &error);
}

static PyObject *device(PyObject *me, PyObject *tool) {
    int32_t index;
    lar_device_status d;
    lar_error error;
    lar_session *session = look(me, tool, &index, "device");
    if (!session) return NULL;
    if (lar_session_device(session, index, &d, &error)) return python_raise(&error);
    if (!d.name) Py_RETURN_NONE;
    return Py_BuildValue("{s:s,s:i,s:N,s:K,s:K,s:K,s:K,s:K,s:K,s:d,s:d,s:d}", "name", d.name,
                         "port", d.port, "connected", PyBool_FromLong(d.connected), "received",
                         (unsigned long long)d.received, "answered", (unsigned long long)d.answered,
                         "refused", (unsigned long long)d.refused, "late",
                         (unsigned long long)d.late, "lost", (unsigned long long)d.lost, "timeouts",
                         (unsigned long long)d.timeouts, "answer_p50", d.answer_p50, "answer_p99",
                         d.answer_p99, "answer_max", d.answer_max);
}

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
PyMethodDef python_session_tool_methods[] = {
    {"tool_move", FUNCTION(tool_move), METH_VARARGS | METH_KEYWORDS,
     "tool_move($self, tool, position, *, orientation=None, opening=None)\n--\n\nWhere the tool's "
     "hand or device is now; the tool follows, no faster than tool_speed. position: of the tip "
     "[m]; orientation: unit quaternion w, x, y, z. UnstableError when the run has broken off."},
    {"grasp", FUNCTION(grasp), METH_VARARGS | METH_KEYWORDS,
     "grasp($self, tool, point=None)\n--\n\nTakes hold between two ticks; a hand at `point` [m]. "
     "Returns how many surface points a hand has got."},
    {"release", release, METH_O, "release($self, tool)\n--\n\nLets go between two ticks."},
    {"tool_pose", tool_pose, METH_O, "tool_pose($self, tool)\n--\n\ndict, as of the last tick."},
    {"tool_force", tool_force, METH_O,
     "tool_force($self, tool)\n--\n\ndict, as Simulation.tool_force, of the last tick."},
    {"felt", felt, METH_O,
     "felt($self, tool)\n--\n\nWhat the hand feels that leads the tool by tool_move: force [N] and "
     "torque [N m] of the coupling between both in the last tick, six floats. It is bounded and "
     "passive for a device that holds it until the next tick (docs/devices.md says what is "
     "counted): "
     "what a haptic device in this process is given."},
    {"wrench", wrench, METH_O,
     "wrench($self, tool)\n--\n\nForce [N] and torque [N m] of the last tick, six floats."},
    {"tool_touches", tool_touches, METH_O,
     "tool_touches($self, tool)\n--\n\nlist of dicts, as Simulation.tool_touches, between two "
     "ticks; 1024 at most."},
    {"tool_load", tool_load, METH_O,
     "tool_load($self, tool)\n--\n\ndict: what it had to bear since the session was opened. force "
     "[N], limit [N], reached, grasp_force [N]."},
    {"force_history", FUNCTION(force_history), METH_VARARGS | METH_KEYWORDS,
     "force_history($self, tool, after=0)\n--\n\nForces [N], one for each tick after tick `after`, "
     "oldest first: (memoryview float32 [k, 3], number of the last tick). 8192 ticks are kept."},
    {"add_tool", FUNCTION(add_tool), METH_VARARGS | METH_KEYWORDS,
     "add_tool($self, shape, radius, length=0.0, spread=0.0)\n--\n\nAs Simulation.add_tool: "
     "metres, and "
     "spread in radians."},
    {"remove_tool", remove_tool, METH_O, "remove_tool($self, tool)\n--\n\nAs Simulation's."},
    {"attach", FUNCTION(attach), METH_VARARGS | METH_KEYWORDS,
     "attach($self, tool, device)\n--\n\nConnects a tool with a device: \"script:FILE.csv\", "
     "\"udp:HOST:PORT\" or \"gamepad:N\" (docs/devices.md)."},
    {"device", device, METH_O,
     "device($self, tool)\n--\n\nNone, or a dict: name, port, connected, received, answered, "
     "refused, late, lost, timeouts, answer times [s]."},
    {NULL, NULL, 0, NULL}};
PyGetSetDef python_session_tool_properties[] = {
    {"tools", get_tools, NULL, "list of dicts, as Simulation.tools.", NULL},
    {NULL, NULL, NULL, NULL, NULL}};
