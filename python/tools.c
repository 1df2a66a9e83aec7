/* Tools of a simulation: poses, grasps, forces, points of contact. */

#include "module.h"

static lar_simulation *look(PyObject *me, PyObject *tool, int32_t *index, const char *call) {
    return python_simulation_tool((python_simulation *)me, call, tool, index);
}

/* For calls that do something to it, in a run that goes on. */
static lar_simulation *look_sound(PyObject *me, PyObject *tool, int32_t *index, const char *call) {
    lar_simulation *simulation = look(me, tool, index, call);
    return simulation && python_simulation_sound((python_simulation *)me, call) ? simulation : NULL;
}

static PyObject *get_tools(PyObject *me, void *unused) {
    (void)unused;
    lar_simulation *simulation = python_simulation_look((python_simulation *)me, "tools");
    if (!simulation) return NULL;
    int32_t count = lar_simulation_tool_count(simulation);
    PyObject *list = PyList_New(count);
    for (int32_t i = 0; list && i < count; i++) {
        lar_tool_info info;
        PyObject *dict =
            lar_simulation_tool(simulation, i, &info, NULL) ? NULL : python_tool_dict(&info);
        if (!dict || PyList_SetItem(list, i, dict)) Py_CLEAR(list);
    }
    return list;
}

static PyObject *tool_move(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"tool", "position", "steps", "orientation", "opening", NULL};
    PyObject *tool, *position, *steps = NULL, *orientation = NULL, *opening = NULL;
    unsigned long long count = 1;
    int32_t index;
    lar_tool_pose now, pose;
    lar_error error;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "OO|O$OO:tool_move", names, &tool, &position,
                                     &steps, &orientation, &opening) ||
        (steps && !python_steps(steps, "steps", &count)))
        return NULL;
    lar_simulation *simulation = look_sound(me, tool, &index, "tool_move");
    if (!simulation) return NULL;
    if (lar_simulation_tool_pose(simulation, index, &now, &error)) return python_raise(&error);
    python_simulation *self = (python_simulation *)me;
    python_asked *asked = &self->asked[index];
    const bool turns = lar_model_tool_free(self->model->model, index) != 0;
    if (!python_pose(position, orientation, opening, asked, turns, &now, &pose)) return NULL;
    /* Reading numbers may have run any code. */
    if (!(simulation = look_sound(me, tool, &index, "tool_move"))) return NULL;
    if (lar_simulation_tool_move(simulation, index, &pose, count, &error))
        return python_raise(&error);
    python_asked_set(asked, &pose);
    Py_RETURN_NONE;
}

static PyObject *grasp(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"tool", "point", "steps", NULL};
    PyObject *tool, *point = Py_None, *steps = NULL;
    unsigned long long count = 0;
    int32_t index, held = 0;
    double place[3] = {0};
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O|OO:grasp", names, &tool, &point, &steps) ||
        (point != Py_None && !python_vector(point, "point", 3, place)) ||
        (steps && !python_steps(steps, "steps", &count)))
        return NULL;
    lar_error error;
    lar_status status;
    lar_simulation *simulation = look_sound(me, tool, &index, "grasp");
    if (!simulation) return NULL;
    status = lar_simulation_grasp(simulation, index, point == Py_None ? NULL : place, count, &held,
                                  &error);
    if (status) return python_raise(&error);
    ((python_simulation *)me)->asked[index].opening = NAN;
    if (point == Py_None) ((python_simulation *)me)->asked[index].opening = 0;
    return PyLong_FromLong(held);
}

static PyObject *release(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"tool", "steps", NULL};
    PyObject *tool, *steps = NULL;
    unsigned long long count = 0;
    int32_t index;
    lar_error error;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O|O:release", names, &tool, &steps) ||
        (steps && !python_steps(steps, "steps", &count)))
        return NULL;
    lar_simulation *simulation = look_sound(me, tool, &index, "release");
    if (!simulation) return NULL;
    ((python_simulation *)me)->asked[index].opening = 1;
    return python_answer(lar_simulation_release(simulation, index, count, &error), &error);
}

static PyObject *tool_pose(PyObject *me, PyObject *tool) {
    int32_t index;
    lar_tool_pose pose;
    lar_error error;
    lar_simulation *simulation = look(me, tool, &index, "tool_pose");
    if (!simulation) return NULL;
    if (lar_simulation_tool_pose(simulation, index, &pose, &error)) return python_raise(&error);
    return python_pose_dict(&pose);
}

static bool force_of(PyObject *me, PyObject *tool, const char *call, lar_tool_force *force) {
    int32_t index;
    lar_error error;
    lar_simulation *simulation = look(me, tool, &index, call);
    if (!simulation) return false;
    if (!lar_simulation_tool_force(simulation, index, force, &error)) return true;
    python_raise(&error);
    return false;
}

static PyObject *tool_force(PyObject *me, PyObject *tool) {
    lar_tool_force force;
    return force_of(me, tool, "tool_force", &force) ? python_force_dict(&force) : NULL;
}

static PyObject *wrench(PyObject *me, PyObject *tool) {
    lar_tool_force force;
    return force_of(me, tool, "wrench", &force) ? python_wrench(&force) : NULL;
}

static PyObject *tool_touches(PyObject *me, PyObject *tool) {
    enum { ROOM = 64 }; /* most tools touch fewer points: one look then does */
    int32_t index, count = 0, room = ROOM;
    lar_error error = {.status = LAR_ERROR_MEMORY, .message = "no memory for points of contact"};
    lar_status status = LAR_OK;
    if (!look(me, tool, &index, "tool_touches")) return NULL;
    python_simulation *self = (python_simulation *)me;
    lar_simulation *simulation = python_simulation_take(self, "tool_touches");
    if (!simulation) return NULL;
    lar_touch *touch = NULL;
    do {
        if (count > room) room = count;
        lar_touch *more = realloc(touch, (size_t)room * sizeof *touch);
        if (!more) status = LAR_ERROR_MEMORY;
        if (more) touch = more;
        if (!status)
            PYTHON_UNLOCKED(status = lar_simulation_tool_touches(simulation, index, room, touch,
                                                                 &count, &error));
    } while (!status && count > room);
    python_simulation_give(self);
    PyObject *list = status ? python_raise(&error) : python_touch_list(touch, count);
    free(touch);
    return list;
}

static PyObject *add_tool(PyObject *me, PyObject *args, PyObject *keywords) {
    lar_tool_info wanted;
    lar_error error;
    int32_t index;
    if (!python_tool_wanted(args, keywords, &wanted)) return NULL;
    lar_simulation *simulation = python_simulation_look_sound((python_simulation *)me, "add_tool");
    if (!simulation) return NULL;
    if (lar_simulation_add_tool(simulation, &wanted, &index, &error)) return python_raise(&error);
    return PyLong_FromLong(index);
}

static PyObject *remove_tool(PyObject *me, PyObject *tool) {
    int32_t index;
    lar_error error;
    lar_simulation *simulation = look_sound(me, tool, &index, "remove_tool");
    if (!simulation) return NULL;
    return python_answer(lar_simulation_remove_tool(simulation, index, &error), &error);
}

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
PyMethodDef python_tool_methods[] = {
    {"tool_move", FUNCTION(tool_move), METH_VARARGS | METH_KEYWORDS,
     "tool_move($self, tool, position, steps=1, *, orientation=None, opening=None)\n--\n\nFrom "
     "now on the tool moves evenly to a pose, within so many steps, and rests there. position: of "
     "the tip [m]; orientation: unit quaternion w, x, y, z; opening: 0 closed to 1 open. No "
     "faster than half its radius in a step; up to a quarter tissue keeps it out."},
    {"grasp", FUNCTION(grasp), METH_VARARGS | METH_KEYWORDS,
     "grasp($self, tool, point=None, steps=0)\n--\n\nTakes hold: a hand at `point` [m], at once, "
     "and returns how many surface points it has; a grasper closes its jaws within `steps`; 0: at "
     "1 m/s."},
    {"release", FUNCTION(release), METH_VARARGS | METH_KEYWORDS,
     "release($self, tool, steps=0)\n--\n\nLets go: a hand at once, a grasper within `steps`; 0: "
     "at 1 m/s."},
    {"tool_pose", tool_pose, METH_O,
     "tool_pose($self, tool)\n--\n\ndict: position [m], orientation (w, x, y, z), opening; now."},
    {"tool_force", tool_force, METH_O,
     "tool_force($self, tool)\n--\n\ndict: what tissue does to the tool. force [N] and torque "
     "about the tip [N m], means over the last advance; touching and held, surface points; limit "
     "[N]; depth and apart [m]; limited; grasp_force [N]."},
    {"wrench", wrench, METH_O,
     "wrench($self, tool)\n--\n\nForce [N] and torque about the tip [N m], six floats."},
    {"tool_touches", tool_touches, METH_O,
     "tool_touches($self, tool)\n--\n\nlist of dicts, where the tool and the surface touch in the "
     "present state: place [m], normal, force on the tool [N], depth [m], kind (pressed, held, "
     "rubbed), jaw, face, nodes, weights. Their forces sum up to what the next step begins with."},
    {"add_tool", FUNCTION(add_tool), METH_VARARGS | METH_KEYWORDS,
     "add_tool($self, shape, radius, length=0.0, spread=0.0)\n--\n\nAdds a sphere, capsule or "
     "grasper in the first spare place (Simulation's spares=), above the body, and returns its "
     "place. radius and length in metres; spread, the angle between a grasper's open jaws, in "
     "radians (scenes have degrees), 0: 60 degrees."},
    {"remove_tool", remove_tool, METH_O,
     "remove_tool($self, tool)\n--\n\nTakes one that was added away."},
    {NULL, NULL, 0, NULL}};
PyGetSetDef python_tool_properties[] = {
    {"tools", get_tools, NULL,
     "list of dicts: those of the model, then hands, then places for tools that can be added "
     "(shape \"none\"). Calls name a tool by its place in this list or by its name.",
     NULL},
    {NULL, NULL, NULL, NULL, NULL}};
