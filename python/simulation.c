/* class Simulation: its life, and its advance.
 *
 * An advance is one call of the library, however long it takes, because what tools feel is the mean
 * over an advance. Where the interpreter wants to be asked for Ctrl-C, the library's own callback
 * after each step takes the lock for a moment, ten times a second and on the main thread only. */
#include <math.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "module.h"

PyTypeObject *python_simulation_type;

/* ---- who may use it ------------------------------------------------------------------------- */

static bool is_threaded(const python_simulation *self) {
    return self->session || lar_simulation_processors(self->simulation) > 1 ||
           lar_simulation_threads(self->simulation) > 1;
}

lar_simulation *python_simulation_look(python_simulation *self, const char *call) {
    const char *why = NULL;
    if (!self->simulation)
        why = "the simulation is closed";
    else if (self->generation != python_generation && is_threaded(self))
        why =
            "the simulation belongs to the process that this one was forked from, its threads did "
            "not come along; make one here, after the fork";
    else if (self->busy)
        why = "another call computes on this simulation, and two at once would spoil it; give each "
              "thread a simulation of its own";
    else if (self->session)
        why = "a session has taken the simulation over; ask the session, or close it first";
    if (!why) return self->simulation;
    PyErr_Format(python_error_state, "%s: %s", call, why);
    return NULL;
}

lar_simulation *python_simulation_take(python_simulation *self, const char *call) {
    lar_simulation *simulation = python_simulation_look(self, call);
    if (simulation) self->busy = true;
    return simulation;
}

void python_simulation_give(python_simulation *self) {
    self->busy = false;
}

bool python_simulation_sound(python_simulation *self, const char *call) {
    lar_error why, error = {.status = LAR_ERROR_UNSTABLE};
    if (!self->broken) return true;
    /* No steps change nothing, and what has broken off says why. */
    self->broken = lar_simulation_advance(self->simulation, 0, &why) == LAR_ERROR_UNSTABLE;
    if (!self->broken) return true;
    snprintf(error.message, sizeof error.message,
             "%s: the run has broken off; reset() or load() takes it up again: %.800s", call,
             why.message);
    return python_raise(&error) != NULL;
}

lar_simulation *python_simulation_look_sound(python_simulation *self, const char *call) {
    lar_simulation *simulation = python_simulation_look(self, call);
    return simulation && python_simulation_sound(self, call) ? simulation : NULL;
}

lar_simulation *python_simulation_take_sound(python_simulation *self, const char *call) {
    lar_simulation *simulation = python_simulation_look_sound(self, call);
    if (simulation) self->busy = true;
    return simulation;
}

lar_simulation *python_simulation_tool(python_simulation *self, const char *call, PyObject *source,
                                       int32_t *index) {
    unsigned long long number = 0;
    const bool named = PyUnicode_Check(source);
    const char *wanted = named ? python_text(source, "tool") : NULL;
    if (named ? !wanted : !python_steps(source, "tool", &number)) return NULL;
    lar_simulation *simulation = python_simulation_look(self, call);
    if (!simulation) return NULL;
    const int32_t count = lar_simulation_tool_count(simulation);
    lar_tool_info info;
    for (int32_t i = 0; i < count; i++) {
        *index = i;
        if (named ? !lar_simulation_tool(simulation, i, &info, NULL) && !strcmp(info.name, wanted)
                  : number == (unsigned long long)i)
            return simulation;
    }
    if (named)
        python_refuse("tool: there is none called %R; Simulation.tools lists them", source);
    else
        python_refuse("tool: there is no tool %R; the simulation has %d, counted from 0", source,
                      (int)count);
    return NULL;
}

/* ---- life ----------------------------------------------------------------------------------- */

/* The index of a word; -1 with an exception. */
static int word_of(const char *word, const char *name, const char *const *words, int count) {
    for (int i = 0; i < count; i++)
        if (strcmp(word, words[i]) == 0) return i;
    char all[80] = "";
    for (int i = 0; i < count; i++) {
        size_t at = strlen(all);
        snprintf(all + at, sizeof all - at, "%s%s", i ? ", " : "", words[i]);
    }
    python_refuse("%s: \"%s\" is none; there are %s", name, word, all);
    return -1;
}

/* Times that a simulation is made with [s]. */
static bool parse_times(PyObject *time_step, PyObject *tick, lar_options *o) {
    if (!python_real(time_step, "time_step", &o->time_step) || !python_real(tick, "tick", &o->tick))
        return false;
    if (o->time_step < 0)
        return python_refuse("time_step: expected seconds, or 0 for the model's, got %R",
                             time_step);
    return (o->tick >= 0 && o->tick <= 1e6) ||
           python_refuse("tick: expected seconds up to 1e6, or 0 for none, got %R", tick);
}

static bool parse_options(PyObject *args, PyObject *keywords, PyObject **model, lar_options *o) {
    static char *names[] = {"model",        "grid",          "threads", "element",
                            "isa",          "time_step",     "scheme",  "channels",
                            "distribution", "schedules",     "hands",   "spares",
                            "pin",          "search_always", "tick",    NULL};
    static const char *const elements[] = {"hex8", "hex8-full", "hex8-matrix"};
    static const char *const isas[] = {"auto", "c", "neon", "avx2", "avx512"};
    const char *element = "hex8", *isa = "auto";
    PyObject *grid = NULL, *threads = NULL, *kind_word = NULL, *isa_word = NULL, *time_step = NULL;
    PyObject *scheme = NULL, *channels = NULL, *distribution = NULL, *schedules = NULL;
    PyObject *hands = NULL, *spares = NULL, *pin = NULL, *tick = NULL;
    *o = lar_options_default();
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O!|$OOOOOOOOOOOOpO:Simulation", names,
                                     python_model_type, model, &grid, &threads, &kind_word,
                                     &isa_word, &time_step, &scheme, &channels, &distribution,
                                     &schedules, &hands, &spares, &pin, &o->search_always, &tick) ||
        !python_word(grid, "grid", &o->grid) || !python_word(scheme, "scheme", &o->scheme) ||
        !python_word(channels, "channels", &o->channels) ||
        !python_word(distribution, "distribution", &o->distribution) ||
        !python_word(schedules, "schedules", &o->schedules) ||
        !python_int(threads, "threads", &o->threads) || !python_int(hands, "hands", &o->hands) ||
        !python_int(spares, "spares", &o->spares) || !python_int(pin, "pin", &o->pin) ||
        !parse_times(time_step, tick, o) ||
        (kind_word && !(element = python_text(kind_word, "element"))) ||
        (isa_word && !(isa = python_text(isa_word, "isa"))))
        return false;
    int kind = word_of(element, "element", elements, 3);
    int lanes = kind < 0 ? -1 : word_of(isa, "isa", isas, 5);
    if (lanes < 0) return false;
    o->element = (lar_element_kind)kind;
    o->isa = (lar_isa)lanes;
    return true;
}

/* Closed, with the model and a copy of the options. */
static python_simulation *fresh(PyObject *model, PyObject *options) {
    python_simulation *self = PyObject_New(python_simulation, python_simulation_type);
    if (!self) return NULL;
    *self = (python_simulation){.ob_base = self->ob_base, .generation = python_generation};
    python_asked_forget(self->asked);
    Py_INCREF(model);
    self->model = (python_model *)model;
    self->options = options ? PyDict_Copy(options) : PyDict_New();
    if (!self->options) Py_CLEAR(self);
    return self;
}

static PyObject *simulation_clone(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_simulation *from = (python_simulation *)me;
    lar_simulation *simulation = python_simulation_take(from, "clone");
    if (!simulation) return NULL;
    python_simulation *self = fresh((PyObject *)from->model, from->options);
    lar_simulation *made = NULL;
    lar_error error;
    lar_status status = LAR_OK;
    if (self) PYTHON_UNLOCKED(status = lar_simulation_clone(simulation, &made, &error));
    python_simulation_give(from);
    if (!self) return NULL;
    self->simulation = made;
    memcpy(self->asked, from->asked, sizeof self->asked);
    if (!status) return (PyObject *)self;
    Py_DECREF(self);
    return python_raise(&error);
}

static PyObject *simulation_new(PyTypeObject *type, PyObject *args, PyObject *keywords) {
    (void)type;
    PyObject *model;
    lar_options options;
    if (!parse_options(args, keywords, &model, &options)) return NULL;
    python_simulation *self = fresh(model, keywords);
    if (!self) return NULL;
    if (keywords && PyDict_GetItemString(self->options, "model"))
        PyDict_DelItemString(self->options, "model");
    lar_simulation *made = NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = lar_simulation_create(self->model->model, &options, &made, &error));
    self->simulation = made;
    if (!status) return (PyObject *)self;
    Py_DECREF(self);
    return python_raise_of(python_model_scene((python_model *)model), &error);
}

static void simulation_dealloc(PyObject *me) {
    python_simulation *self = (python_simulation *)me;
    /* In a child of a fork nobody is there to end: what threads had is left alone. */
    bool lost = self->simulation && self->generation != python_generation &&
                (self->busy || is_threaded(self));
    if (!lost) lar_simulation_destroy(self->simulation);
    if (lost) Py_INCREF((PyObject *)self->model);
    Py_XDECREF((PyObject *)self->model);
    Py_XDECREF(self->options);
    python_object_free(me);
}

static PyObject *simulation_close(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_simulation *self = (python_simulation *)me;
    if (!self->simulation) Py_RETURN_NONE;
    lar_simulation *simulation = python_simulation_take(self, "close");
    if (!simulation) return NULL;
    self->simulation = NULL;
    PYTHON_UNLOCKED(lar_simulation_destroy(simulation));
    python_simulation_give(self);
    Py_RETURN_NONE;
}

static PyObject *simulation_enter(PyObject *me, PyObject *nothing) {
    (void)nothing;
    Py_INCREF(me);
    return me;
}

static PyObject *simulation_exit(PyObject *me, PyObject *args) {
    (void)args;
    return simulation_close(me, NULL);
}

static PyObject *simulation_repr(PyObject *me) {
    python_simulation *self = (python_simulation *)me;
    const char *source = lar_model_source(self->model->model);
    if (!self->simulation) return PyUnicode_FromFormat("<lariat.Simulation of %s, closed>", source);
    if (self->busy || self->session)
        return PyUnicode_FromFormat("<lariat.Simulation of %s, %s>", source,
                                    self->session ? "in a session" : "computing");
    return PyUnicode_FromFormat("<lariat.Simulation of %s, step %llu>", source,
                                (unsigned long long)lar_simulation_steps(self->simulation));
}

static PyObject *simulation_reduce(PyObject *me, PyObject *nothing) {
    (void)nothing;
    PyObject *package = PyImport_ImportModule("lariat");
    PyObject *answer = package ? PyObject_CallMethod(package, "_reduce_simulation", "O", me) : NULL;
    Py_XDECREF(package);
    return answer;
}

/* ---- advance -------------------------------------------------------------------------------- */

static double since(const struct timespec *then, struct timespec *now) {
    clock_gettime(CLOCK_MONOTONIC, now);
    return (double)(now->tv_sec - then->tv_sec) + 1e-9 * (double)(now->tv_nsec - then->tv_nsec);
}

/* Python delivers signals on the main thread only. */
bool python_watch_begin(python_watch *watch) {
    *watch = (python_watch){.watching = syscall(SYS_gettid) == getpid()};
    if (watch->watching) clock_gettime(CLOCK_MONOTONIC, &watch->last);
    return watch->watching;
}

bool python_watch_look(python_watch *w) {
    struct timespec now;
    if (w->stopped) return false;
    if (!w->watching || since(&w->last, &now) < 0.1) return true;
    w->last = now;
    PyEval_RestoreThread(w->thread);
    w->stopped = PyErr_CheckSignals() != 0;
    w->thread = PyEval_SaveThread();
    return !w->stopped;
}

static int look_for_signals(void *context, uint64_t step) {
    python_watch *w = context;
    (void)step;
    /* Steps of large models are long, those of small ones shorter than asking the time. */
    return ++w->calls % 8 != 0 || python_watch_look(w);
}

bool python_simulation_advance(python_simulation *self, unsigned long long steps) {
    lar_simulation *simulation = python_simulation_take(self, "advance");
    if (!simulation) return false;
    lar_error error;
    lar_status status;
    python_watch w = {.stopped = false};
    bool watched = steps > 8 && python_watch_begin(&w);
    w.thread = PyEval_SaveThread();
    status = watched ? lar_simulation_advance_with(simulation, steps, look_for_signals, &w, &error)
                     : lar_simulation_advance(simulation, steps, &error);
    PyEval_RestoreThread(w.thread);
    self->broken = status == LAR_ERROR_UNSTABLE;
    python_simulation_give(self);
    if (w.stopped) return false;
    if (status) python_raise(&error);
    return !status;
}

/* In pieces of `every` steps, with a call between: true while it shall go on. */
static bool call_back(PyObject *me, PyObject *callback, bool *goes_on) {
    PyObject *answer = PyObject_CallFunctionObjArgs(callback, me, NULL);
    *goes_on = !answer || !python_is_no(answer);
    Py_XDECREF(answer);
    return answer != NULL;
}

static bool advance_with(PyObject *me, unsigned long long steps, PyObject *callback,
                         unsigned long long every, unsigned long long *done) {
    bool goes_on = true;
    while (*done < steps && goes_on) {
        unsigned long long piece = steps - *done < every ? steps - *done : every;
        if (!python_simulation_advance((python_simulation *)me, piece)) return false;
        *done += piece;
        if (!call_back(me, callback, &goes_on)) return false;
    }
    return true;
}

typedef struct advance_call {
    PyObject *steps, *seconds, *callback, *every;
} advance_call;

/* METH_FASTCALL: parsing a tuple takes as long as all the rest. */
static bool parse_advance(PyObject *const *args, Py_ssize_t count, PyObject *names,
                          advance_call *call) {
    static const char *const known[] = {"steps", "seconds", "callback", "every"};
    PyObject **place[] = {&call->steps, &call->seconds, &call->callback, &call->every};
    if (count > 1)
        return python_refuse_type("advance: only the number of steps goes without a name");
    if (count == 1) call->steps = args[0];
    Py_ssize_t named = names ? PyTuple_Size(names) : 0;
    for (Py_ssize_t i = 0; i < named; i++) {
        PyObject *name = PyTuple_GetItem(names, i);
        int k = 0;
        while (k < 4 && PyUnicode_CompareWithASCIIString(name, known[k]) != 0) k++;
        if (k == 4) return python_refuse_type("advance: there is no argument %R", name);
        if (k == 0 && count == 1) return python_refuse_type("advance: steps are given twice");
        if (args[count + i] != Py_None) *place[k] = args[count + i];
    }
    if (call->steps == Py_None) call->steps = NULL;
    return (call->steps != NULL) != (call->seconds != NULL) ||
           python_refuse_type("advance: expected steps or seconds=, and not both");
}

bool python_seconds(PyObject *seconds, python_simulation *self, const char *call,
                    unsigned long long *steps) {
    double time;
    if (!python_number(seconds, "seconds", &time)) return false;
    const lar_simulation *simulation = python_simulation_look(self, call);
    if (!simulation) return false;
    const double time_step = lar_simulation_time_step(simulation);
    const double wanted = round(time / time_step);
    if (!(wanted >= 0)) return python_refuse("seconds: expected a time from 0 on, got %R", seconds);
    if (!(wanted < 9e15)) {
        char most[32];
        snprintf(most, sizeof most, "%.3g", 9e15 * time_step);
        return python_refuse("seconds: expected at most %s (9e15 steps), got %R", most, seconds);
    }
    *steps = (unsigned long long)wanted;
    return true;
}

static bool steps_of(python_simulation *self, const advance_call *call, unsigned long long *steps) {
    return call->steps ? python_steps(call->steps, "steps", steps)
                       : python_seconds(call->seconds, self, "advance", steps);
}

static PyObject *simulation_advance(PyObject *me, PyObject *const *args, Py_ssize_t count,
                                    PyObject *names) {
    python_simulation *self = (python_simulation *)me;
    advance_call call = {.steps = NULL};
    unsigned long long steps, every = 1, done = 0;
    if (!parse_advance(args, count, names, &call) || !steps_of(self, &call, &steps)) return NULL;
    if (!call.callback) {
        if (call.every) {
            python_refuse_type("advance: every= goes with callback=");
            return NULL;
        }
        return python_simulation_advance(self, steps) ? PyLong_FromUnsignedLongLong(steps) : NULL;
    }
    if (!PyCallable_Check(call.callback)) {
        python_refuse_type("callback: expected something to call, got %R",
                           (PyObject *)Py_TYPE(call.callback));
        return NULL;
    }
    every = steps / 100 > 0 ? steps / 100 : 1;
    if (call.every && !python_steps(call.every, "every", &every)) return NULL;
    if (every == 0) {
        python_refuse("every: expected at least one step");
        return NULL;
    }
    return advance_with(me, steps, call.callback, every, &done) ? PyLong_FromUnsignedLongLong(done)
                                                                : NULL;
}

/* ---- what it is ----------------------------------------------------------------------------- */

static PyObject *get_model(PyObject *me, void *unused) {
    (void)unused;
    PyObject *model = (PyObject *)((python_simulation *)me)->model;
    Py_INCREF(model);
    return model;
}

static PyObject *get_step(PyObject *me, void *unused) {
    (void)unused;
    lar_simulation *simulation = python_simulation_look((python_simulation *)me, "step");
    return simulation ? PyLong_FromUnsignedLongLong(lar_simulation_steps(simulation)) : NULL;
}

static PyObject *get_time(PyObject *me, void *unused) {
    (void)unused;
    lar_simulation *simulation = python_simulation_look((python_simulation *)me, "time");
    return simulation ? PyFloat_FromDouble(lar_simulation_time(simulation)) : NULL;
}

/* What is constant may be asked for at any time, while it lives. */
static lar_simulation *constant(PyObject *me, const char *call) {
    python_simulation *self = (python_simulation *)me;
    if (!self->simulation) PyErr_Format(python_error_state, "%s: the simulation is closed", call);
    return self->simulation;
}

static PyObject *get_time_step(PyObject *me, void *unused) {
    (void)unused;
    lar_simulation *simulation = constant(me, "time_step");
    return simulation ? PyFloat_FromDouble(lar_simulation_time_step(simulation)) : NULL;
}

static PyObject *get_closed(PyObject *me, void *unused) {
    (void)unused;
    return PyBool_FromLong(!((python_simulation *)me)->simulation);
}

static PyObject *get_options(PyObject *me, void *unused) {
    (void)unused;
    return PyDict_Copy(((python_simulation *)me)->options);
}

static PyObject *get_info(PyObject *me, void *unused) {
    (void)unused;
    static const char *const elements[] = {"hex8", "hex8-full", "hex8-matrix"};
    lar_simulation_info i;
    lar_simulation *simulation = python_simulation_look((python_simulation *)me, "info");
    if (!simulation) return NULL;
    lar_simulation_inspect(simulation, &i);
    int32_t most = 0;
    unsigned long long divided = lar_simulation_divided_steps(simulation, &most);
    lar_heavier heavier;
    lar_simulation_heavier(simulation, &heavier);
    return Py_BuildValue(
        "{s:s,s:i,s:i,s:d,s:i,s:i,s:K,s:s,s:i,s:K,s:i,s:{s:i,s:d,s:d,s:d}}", "element",
        elements[i.element], "tools", (int)i.tools, "spares", (int)i.spares, "time_step",
        i.time_step, "processors", (int)lar_simulation_processors(simulation), "threads",
        (int)lar_simulation_threads(simulation), "redivisions",
        (unsigned long long)lar_simulation_redivisions(simulation), "isa",
        lar_simulation_isa(simulation), "step_parts", (int)lar_simulation_step_parts(simulation),
        "divided_steps", divided, "most_parts", (int)most, "heavier", "elements",
        (int)heavier.elements, "share", heavier.share, "mean_share", heavier.mean_share,
        "largest_share", heavier.largest_share);
}

static PyGetSetDef simulation_properties[] = {
    {"model", get_model, NULL, "The Model.", NULL},
    {"step", get_step, NULL, "Steps done, an int.", NULL},
    {"time", get_time, NULL, "Simulated time [s].", NULL},
    {"time_step", get_time_step, NULL, "Length of a step [s].", NULL},
    {"closed", get_closed, NULL, "True after close().", NULL},
    {"options", get_options, NULL, "dict: the keyword arguments that it was made with.", NULL},
    {"info", get_info, NULL,
     "dict: element, tools, spares, time_step [s], processors, threads, redivisions (how often "
     "the grid was divided anew under way), isa, step_parts (parts of a step now), divided_steps, "
     "most_parts, heavier (a dict: strained elements that are, and "
     "what "
     "they have more, as a share of the model's mass).",
     NULL},
    {NULL, NULL, NULL, NULL, NULL}};

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
static PyMethodDef simulation_methods[] = {
    {"advance", FUNCTION(simulation_advance), METH_FASTCALL | METH_KEYWORDS,
     "advance($self, steps=None, *, seconds=None, callback=None, every=None)\n--\n\n"
     "Advances by so many steps, or by seconds of simulated time, rounded to whole steps, and "
     "returns\n"
     "how many were done. Other Python threads run meanwhile. Ctrl-C stops it between two "
     "steps.\n\n"
     "callback  called with the simulation after every `every` steps (a hundredth of all), between "
     "two\n"
     "          advances, so it may look at the simulation and change it; False ends the advance. "
     "What\n"
     "          tools feel is then the mean over the last `every` steps.\n\n"
     "UnstableError names element, place, time and cause; reset() or load() take it up again."},
    {"clone", simulation_clone, METH_NOARGS,
     "clone($self)\n--\n\nAnother Simulation in this one's state, some ten times as fast as a new "
     "one: what never changes\nis there once. Not for several processors or threads."},
    {"close", simulation_close, METH_NOARGS,
     "close($self)\n--\n\nFrees it. Nothing else may be asked of it then; closing twice is fine."},
    {"__enter__", simulation_enter, METH_NOARGS, NULL},
    {"__exit__", simulation_exit, METH_VARARGS, NULL},
    {"__reduce__", simulation_reduce, METH_NOARGS,
     "For pickle: the model, the options and a checkpoint of the state."},
    {NULL, NULL, 0, NULL}};

static const char simulation_doc[] =
    "Simulation(model, *, grid=None, threads=0, element='hex8', isa='auto', time_step=0.0,\n"
    "           scheme=None, channels=None, distribution=None, schedules=None, hands=0, spares=0,\n"
    "           pin=0, search_always=False, tick=0.0)\n--\n\n"
    "The state that moves. The same bits, and the same hash, with any grid, threads and isa.\n\n"
    "grid       processors along x, y and z, \"2x1x1\": threads of this process; \"auto\": the "
    "fastest\n"
    "threads    of every processor; 0: one\n"
    "element    \"hex8\", \"hex8-full\" (eight Gauss points) or \"hex8-matrix\"\n"
    "time_step  seconds; 0: the model's\n"
    "tick       seconds; a whole number of steps makes it, for which an automatic step is "
    "shortened\n"
    "hands      tools that take hold of the surface, besides the model's, behind them\n"
    "spares     places for tools that are added while it runs, 0 to 4\n\n"
    "One thread at a time: a second one gets a StateError. close() or `with` free it early.";

bool python_simulation_add(PyObject *module) {
    PyMethodDef *const methods[] = {simulation_methods,    python_state_methods,
                                    python_change_methods, python_tool_methods,
                                    python_look_methods,   python_rest_methods};
    PyGetSetDef *const properties[] = {simulation_properties, python_change_properties,
                                       python_tool_properties};
    PyMethodDef *all = python_join_methods(methods, 6);
    PyGetSetDef *shown = python_join_properties(properties, 3);
    if (!all || !shown) return false;
    PyType_Slot slots[] = {{Py_tp_doc, (void *)(uintptr_t)simulation_doc},
                           {Py_tp_new, simulation_new},
                           {Py_tp_dealloc, simulation_dealloc},
                           {Py_tp_repr, simulation_repr},
                           {Py_tp_methods, all},
                           {Py_tp_getset, shown},
                           {0, NULL}};
    PyType_Spec spec = {.name = "lariat.Simulation",
                        .basicsize = sizeof(python_simulation),
                        .flags = Py_TPFLAGS_DEFAULT,
                        .slots = slots};
    python_simulation_type = python_type_add(module, &spec, true);
    return python_simulation_type != NULL;
}
