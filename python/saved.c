/* class Saved: a state in memory. Simulation.save and Session.save make and fill it. */
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
     "element and time step, on any grid."},
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
