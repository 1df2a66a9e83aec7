/* class Saved: a state in memory. Simulation.save and Session.save make and fill it. */
#include <stdarg.h>

#include "module.h"

PyTypeObject *python_saved_type;

static void saved_dealloc(PyObject *me) {
    python_saved *self = (python_saved *)me;
    lar_saved_destroy(self->saved);
    Py_XDECREF((PyObject *)self->model);
    python_object_free(me);
}

static PyObject *saved_repr(PyObject *me) {
    python_saved *self = (python_saved *)me;
    return PyUnicode_FromFormat("<lariat.Saved of %s, step %llu>",
                                lar_model_source(self->model->model), self->step);
}

/* ---- who uses it ------------------------------------------------------------------------------
 */

bool python_saved_take(python_saved *saved, bool fills, const char *call) {
    if (fills ? saved->users != 0 : saved->users < 0) {
        PyErr_Format(python_error_state,
                     saved->users < 0 ? "%s: another thread fills this saved state"
                                      : "%s: another thread takes up this saved state",
                     call);
        return false;
    }
    saved->users = fills ? -1 : saved->users + 1;
    return true;
}

void python_saved_give(python_saved *saved) {
    saved->users = saved->users < 0 ? 0 : saved->users - 1;
}

/* ---- whom it serves -------------------------------------------------------------------------- */

/* "... 2 tools, and the simulation 3", behind what was said before. */
static void tell(char *text, size_t size, const char *format, ...) {
    va_list list;
    size_t at = strlen(text);
    if (at + 3 > size) return;
    if (at > 0) at += (size_t)snprintf(text + at, size - at, "; ");
    va_start(list, format);
    vsnprintf(text + at, size - at, format, list);
    va_end(list);
}

/* What differs; "": nothing. */
static void compare(const lar_simulation_info *was, const lar_simulation_info *is, char *text,
                    size_t size) {
    static const char *const element[] = {"hex8", "hex8-full", "hex8-matrix"};
    const int nodes[2] = {lar_model_node_count(was->model), lar_model_node_count(is->model)};
    const int elements[2] = {lar_model_element_count(was->model),
                             lar_model_element_count(is->model)};
    *text = 0;
    if (nodes[0] != nodes[1] || elements[0] != elements[1])
        tell(text, size, "it has %d nodes and %d elements, the simulation %d and %d", nodes[0],
             elements[0], nodes[1], elements[1]);
    if (was->element != is->element)
        tell(text, size, "its elements are %s, the simulation's %s", element[was->element],
             element[is->element]);
    if (was->tools != is->tools)
        tell(text, size, "it has %d tools (hands count, too), the simulation %d", (int)was->tools,
             (int)is->tools);
    if (was->spares != is->spares)
        tell(text, size, "it has %d spares, the simulation %d", (int)was->spares, (int)is->spares);
    if (was->time_step != is->time_step)
        tell(text, size, "its time step is %.9g s, the simulation's %.9g s", was->time_step,
             is->time_step);
    if (was->model != is->model && !*text)
        tell(text, size,
             "its Model is another object; states in memory serve simulations of one Model, those "
             "at a path (save(path), load(path)) all that are equal");
}

bool python_saved_fits(const python_saved *saved, const lar_simulation *simulation,
                       const char *call) {
    char text[600];
    lar_simulation_info is;
    lar_simulation_inspect(simulation, &is);
    compare(&saved->of, &is, text, sizeof text);
    return !*text || python_refuse("%s: the Saved is of another %s: %s", call,
                                   saved->of.model == is.model ? "simulation" : "model", text);
}

/* ---- the class ------------------------------------------------------------------------------ */

static PyObject *get_step(PyObject *me, void *unused) {
    (void)unused;
    return PyLong_FromUnsignedLongLong(((python_saved *)me)->step);
}
static PyObject *get_time(PyObject *me, void *unused) {
    (void)unused;
    return PyFloat_FromDouble(((python_saved *)me)->time);
}

static PyGetSetDef saved_properties[] = {
    {"step", get_step, NULL, "Step of the state, an int.", NULL},
    {"time", get_time, NULL, "Its simulated time [s].", NULL},
    {NULL, NULL, NULL, NULL, NULL}};
static PyType_Slot saved_slots[] = {
    {Py_tp_doc,
     "A state in memory, for whoever tries one thing after another from it. It serves all "
     "simulations of the\nmodel that have as many tools, hands and spares, the same kind of "
     "element and time step, on any grid.\nAny number of threads may take it up at once, each with "
     "a "
     "simulation of its own; who fills it does so alone."},
    {Py_tp_dealloc, saved_dealloc},
    {Py_tp_repr, saved_repr},
    {Py_tp_getset, saved_properties},
    {0, NULL}};
static PyType_Spec saved_spec = {.name = "lariat.Saved",
                                 .basicsize = sizeof(python_saved),
                                 .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                                 .slots = saved_slots};

bool python_saved_add(PyObject *module) {
    python_saved_type = python_type_add(module, &saved_spec, true);
    return python_saved_type != NULL;
}
