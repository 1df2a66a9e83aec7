/* Simulation.rest: on until the body is at rest, which is what a static answer is.
 *
 * The library says when to look (lar_rest): here are the advances between, Ctrl-C and the callback.
 */
#include <math.h>

#include "module.h"

static PyObject *rest_dict(const lar_rest *rest, unsigned long long steps) {
    PyObject *left = rest->looked ? PyFloat_FromDouble(rest->left) : Py_None;
    if (!rest->looked) Py_INCREF(Py_None);
    return Py_BuildValue("{s:N,s:K,s:N,s:d,s:d,s:d,s:d}", "reached", PyBool_FromLong(rest->reached),
                         "steps", steps, "left", left, "share", rest->share, "kinetic",
                         rest->kinetic, "strain", rest->strain, "since", rest->since);
}

/* Looking goes through all nodes and elements. */
static bool look(python_simulation *self, lar_rest *rest) {
    lar_simulation *simulation = python_simulation_take(self, "rest");
    if (!simulation) return false;
    PYTHON_UNLOCKED(lar_rest_look(rest, simulation));
    python_simulation_give(self);
    return true;
}

/* Up to `last`, or until it is at rest, or the callback says so: then *ended. */
static bool run(python_simulation *self, lar_rest *rest, unsigned long long last,
                PyObject *callback, bool *ended) {
    unsigned long long step = lar_simulation_steps(self->simulation);
    while (!rest->reached && step < last && !*ended) {
        const unsigned long long next = rest->next < last ? rest->next : last;
        /* A callback may have advanced it further. */
        const unsigned long long steps = next > step ? next - step : 0;
        if (!python_simulation_advance(self, steps) || !look(self, rest)) return false;
        PyObject *answer = callback == Py_None
                               ? Py_NewRef(Py_None)
                               : PyObject_CallFunctionObjArgs(callback, (PyObject *)self, NULL);
        if (!answer) return false;
        *ended = python_is_no(answer);
        Py_DECREF(answer);
        lar_simulation *simulation = python_simulation_look(self, "rest");
        if (!simulation) return false;
        step = lar_simulation_steps(simulation);
    }
    return true;
}

/* A body that swings on has no static answer: that is an error and not a number. */
static PyObject *restless(const lar_rest *rest, double time) {
    char left[64] = "nothing is known yet of its motion";
    if (rest->looked && rest->kinetic > 1e6 * fabs(rest->strain))
        snprintf(left, sizeof left, "it moves, and next to nothing strains it");
    else if (rest->looked)
        snprintf(left, sizeof left, "its motion is still %.1e of the strain energy", rest->left);
    const char *remedy =
        "give the scene more `damping` where it swings, less where it creeps, a smaller time step "
        "where it goes to and fro from step to step, or a time to end after (seconds=)";
    if (rest->looked == 2)
        remedy =
            "viscous terms still relax, for a dozen of their times and more; the scene without "
            "`viscous` (moduli times g0) comes to the same rest sooner";
    lar_error error = {.status = LAR_ERROR_MODEL};
    snprintf(error.message, sizeof error.message,
             "rest: not at rest after %.4g s: %s, and at rest that is %.0e; %s", time, left,
             rest->share, remedy);
    return python_raise(&error);
}

static PyObject *simulation_rest(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"seconds", "callback", NULL};
    python_simulation *self = (python_simulation *)me;
    PyObject *seconds = Py_None, *callback = Py_None;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|O$O:rest", names, &seconds, &callback))
        return NULL;
    if (callback != Py_None && !PyCallable_Check(callback)) {
        python_refuse_type("callback: expected something to call, got %R",
                           (PyObject *)Py_TYPE(callback));
        return NULL;
    }
    unsigned long long steps = 0;
    if (seconds != Py_None && !python_seconds(seconds, self, "rest", &steps)) return NULL;
    lar_simulation *simulation = python_simulation_look(self, "rest");
    if (!simulation) return NULL;
    lar_rest rest;
    lar_rest_begin(&rest, simulation);
    if (isinf(rest.since)) {
        lar_error error = {.status = LAR_ERROR_MODEL,
                           .message = "rest: a wave or a curve comes again and again, so the "
                                      "body never rests; advance() goes on for a time"};
        return python_raise(&error);
    }
    const unsigned long long first = lar_simulation_steps(simulation);
    /* As --time of the command. */
    if (seconds != Py_None) rest.limit = steps < UINT64_MAX - first ? first + steps : UINT64_MAX;
    const unsigned long long last = rest.limit;
    bool ended = false;
    if (!run(self, &rest, last, callback, &ended)) return NULL;
    const unsigned long long now = lar_simulation_steps(self->simulation);
    if (!rest.reached && !ended && seconds == Py_None)
        return restless(&rest, lar_simulation_time(self->simulation));
    return rest_dict(&rest, now - first);
}

static PyObject *rest_damp(PyObject *me, PyObject *nothing) {
    (void)nothing;
    lar_simulation *simulation = python_simulation_look((python_simulation *)me, "rest_damp");
    double damping;
    lar_error error;
    lar_status status;
    if (!simulation) return NULL;
    PYTHON_UNLOCKED(status = lar_rest_damp(simulation, &damping, &error));
    return status ? python_raise(&error) : PyFloat_FromDouble(damping);
}

PyMethodDef python_rest_methods[] = {
    {"rest_damp", rest_damp, METH_NOARGS,
     "rest_damp($self)\n--\n\nGives a body that nothing damps the damping with which it comes to "
     "rest soonest, and returns it [1/s];\n0.0: it is damped already, or the model says that it "
     "is not."},
    {"rest", (PyCFunction)(void (*)(void))simulation_rest, METH_VARARGS | METH_KEYWORDS,
     "rest($self, seconds=None, *, callback=None)\n--\n\nAdvances until loads are constant and the "
     "body is at rest: a static answer, in the same step on\nevery grid. A dict: reached, steps "
     "that were done, left (motion that is left, as a share of the\nstrain energy; None: not "
     "looked yet), share (at rest it is at most that), kinetic and strain\nenergy when last "
     "looked [J], since (no load changes after that time [s]).\n\n"
     "seconds   of simulated time at most; not reached then is no error\n"
     "callback  called with the simulation some times in a period of a slow wave; False ends it\n\n"
     "Without seconds, ModelError after a thousand periods of a slow wave, or up to ten thousand\n"
     "where damping needs them: a body without damping swings for good, and one whose viscous "
     "terms are slow relaxes for longer; give it seconds."},
    {NULL, NULL, 0, NULL}};
