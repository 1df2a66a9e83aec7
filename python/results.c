/* class Results: states of a simulation on disk, for ParaView and for tables. */
#include "module.h"

typedef struct python_results {
    PyObject_HEAD lar_results *results; /* NULL: closed */
    python_simulation *simulation;
    bool busy;           /* a thread writes without the interpreter's lock */
    unsigned generation; /* python_generation when it was made */
} python_results;

static PyTypeObject *python_results_type;

static PyObject *results_new(PyTypeObject *type, PyObject *args, PyObject *keywords) {
    static char *names[] = {"simulation", "folder", "surface", "resume", NULL};
    PyObject *simulation, *folder;
    int surface = 0, resume = 0;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O!O|$pp:Results", names,
                                     python_simulation_type, &simulation, &folder, &surface,
                                     &resume))
        return NULL;
    PyObject *path = python_path(folder, "folder");
    python_simulation *taken = (python_simulation *)simulation;
    lar_simulation *from = path ? python_simulation_take(taken, "Results") : NULL;
    if (!from) {
        Py_XDECREF(path);
        return NULL;
    }
    const char *bytes = PyBytes_AsString(path);
    lar_results *results = NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = resume    ? lar_results_resume(bytes, from, surface, &results, &error)
                             : surface ? lar_results_open_surface(bytes, from, &results, &error)
                                       : lar_results_open(bytes, from, &results, &error));
    python_simulation_give(taken);
    Py_DECREF(path);
    if (status) return python_raise(&error);
    allocfunc make = (allocfunc)PyType_GetSlot(type, Py_tp_alloc);
    python_results *self = (python_results *)make(type, 0);
    if (!self) {
        lar_results_close(results, NULL);
        return NULL;
    }
    self->results = results;
    self->simulation = taken;
    self->generation = python_generation;
    Py_INCREF(simulation);
    return (PyObject *)self;
}

/* Whether a call may use it. Files that a parent of this process has open are the parent's. */
static bool results_look(const python_results *self, const char *call) {
    const char *why = !self->results                          ? "they are closed"
                      : self->busy                            ? "another thread writes them"
                      : self->generation != python_generation ? "they belong to the process that "
                                                                "has made them, before a fork"
                                                              : NULL;
    if (why) PyErr_Format(python_error_state, "%s: no results can be written: %s", call, why);
    return !why;
}

static PyObject *results_add(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_results *self = (python_results *)me;
    if (!results_look(self, "add")) return NULL;
    lar_simulation *from = python_simulation_take(self->simulation, "add");
    if (!from) return NULL;
    lar_error error;
    lar_status status;
    self->busy = true;
    PYTHON_UNLOCKED(status = lar_results_add(self->results, from, &error));
    self->busy = false;
    python_simulation_give(self->simulation);
    return python_answer(status, &error);
}

static PyObject *results_close(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_results *self = (python_results *)me;
    if (!self->results) Py_RETURN_NONE;
    if (!results_look(self, "close")) return NULL;
    lar_results *results = self->results;
    lar_error error;
    lar_status status;
    self->results = NULL;
    PYTHON_UNLOCKED(status = lar_results_close(results, &error));
    return python_answer(status, &error);
}

static PyObject *results_enter(PyObject *me, PyObject *nothing) {
    (void)nothing;
    if (!results_look((python_results *)me, "with")) return NULL;
    return Py_NewRef(me);
}

static PyObject *results_exit(PyObject *me, PyObject *args) {
    (void)args;
    return results_close(me, NULL);
}

static PyObject *get_closed(PyObject *me, void *unused) {
    (void)unused;
    return PyBool_FromLong(!((python_results *)me)->results);
}

static void results_dealloc(PyObject *me) {
    python_results *self = (python_results *)me;
    if (self->results && self->generation == python_generation)
        lar_results_close(self->results, NULL);
    Py_XDECREF((PyObject *)self->simulation);
    python_object_free(me);
}

/* ---- the class ------------------------------------------------------------------------------ */

static PyGetSetDef results_properties[] = {
    {"closed", get_closed, NULL, "True after close().", NULL}, {NULL, NULL, NULL, NULL, NULL}};

static PyMethodDef results_methods[] = {
    {"add", results_add, METH_NOARGS,
     "add($self, /)\n--\n\nAdds the state as it is now as a frame. A state that is not finite is "
     "an "
     "UnstableError, and nothing is added."},
    {"close", results_close, METH_NOARGS,
     "close($self, /)\n--\n\nCompletes the series; closing twice is fine. `with` does it too."},
    {"__enter__", results_enter, METH_NOARGS, NULL},
    {"__exit__", results_exit, METH_VARARGS, NULL},
    {NULL, NULL, 0, NULL}};

static PyType_Slot results_slots[] = {
    {Py_tp_doc,
     "Results(simulation, folder, *, surface=False, resume=False)\n--\n\nResults on disk, as "
     "`lariat run --out` "
     "writes them: frames (.vtu) with a series (.pvd) for ParaView, and probes.csv, with the "
     "fields "
     "and probes that the scene's `output` asks for. The folder is made when it is missing; it can "
     "be opened after every frame. Frames are listed as they are added: after a reset, or without "
     "a "
     "step between, times go back or repeat, which is no series in time.\n\n"
     "surface  the embedded surface, if any, in every frame (.vtp)\n"
     "resume   of a simulation that goes on from a saved state: frames and lines of the folder up "
     "to its time stay, provided that one is of that time\n\n"
     "    with lariat.Results(sim, \"out\") as results:\n"
     "        sim.advance(seconds=1, callback=lambda sim: results.add(), every=100)"},
    {Py_tp_new, results_new},
    {Py_tp_dealloc, results_dealloc},
    {Py_tp_methods, results_methods},
    {Py_tp_getset, results_properties},
    {0, NULL}};
static PyType_Spec results_spec = {.name = "lariat.Results",
                                   .basicsize = sizeof(python_results),
                                   .flags = Py_TPFLAGS_DEFAULT,
                                   .slots = results_slots};

bool python_results_add(PyObject *module) {
    python_results_type = python_type_add(module, &results_spec, true);
    return python_results_type != NULL;
}
