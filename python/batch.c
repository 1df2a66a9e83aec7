/* class Batch: many simulations, advanced by one call on all cores.
 *
 *     Batch ---- member 0: Simulation ---- Model      a member is a Simulation like any other:
 *          |---- member 1: Simulation -----'          batch[1].set_stiffness(2), batch[1].hash()
 *          '---- pool: threads, asleep between calls
 *
 * A call takes all members that it is for (python_simulation.busy), lets go of the interpreter's
 * lock, and threads take one member after the other. Nothing that one does depends on the others,
 * on who computes it or when. What a member refuses is kept and raised when all are done. */
#include <math.h>

#include "module.h"

PyTypeObject *python_batch_type;

/* ---- members -------------------------------------------------------------------------------- */

python_batch *python_batch_look(PyObject *me, const char *call) {
    python_batch *self = (python_batch *)me;
    const char *why = NULL;
    if (!self->member)
        why = "the batch is closed";
    else if (self->busy)
        why = "another thread uses this batch; give each a batch of its own";
    if (!why) return self;
    PyErr_Format(python_error_state, "%s: %s", call, why);
    return NULL;
}

/* Whether an array or a list is made of True and False. */
static bool is_mask(PyObject *source) {
    PyObject *view = PyObject_CheckBuffer(source) ? PyMemoryView_FromObject(source) : NULL;
    PyObject *format = view ? PyObject_GetAttrString(view, "format") : NULL;
    bool mask = format && PyUnicode_CompareWithASCIIString(format, "?") == 0;
    Py_XDECREF(format);
    Py_XDECREF(view);
    PyObject *first = !view && PySequence_Check(source) ? PySequence_GetItem(source, 0) : NULL;
    mask = mask || (first && PyBool_Check(first));
    Py_XDECREF(first);
    PyErr_Clear();
    return mask;
}

bool python_members_parse(python_batch *self, PyObject *source, python_members *members) {
    *members = (python_members){.count = self->count};
    if (!source || source == Py_None) return true;
    if (is_mask(source)) /* [True, False] would be taken as members 1 and 0 */
        return python_refuse_type("members: expected numbers of members, got True or False; "
                                  "numpy.flatnonzero makes them of a mask");
    if (!python_integers(source, "members", 0, &members->rows)) return false;
    members->count = (int)members->rows.rows;
    const int32_t *index = members->rows.data;
    char *seen = PyMem_Calloc((size_t)self->count + 1, 1);
    bool ok = seen != NULL || PyErr_NoMemory() != NULL;
    for (int i = 0; i < members->count && ok; i++) {
        if (index[i] < 0 || index[i] >= self->count)
            ok = python_refuse("members: there is no member %d; the batch has %d, counted from 0",
                               (int)index[i], self->count);
        else if (seen[index[i]]++)
            ok = python_refuse("members: member %d is there twice", (int)index[i]);
    }
    PyMem_Free(seen);
    if (!ok) python_rows_free(&members->rows);
    return ok;
}

/* The exception that is set gets "member 3: " before its words. */
static void name_member(int index) {
    PyObject *class, *value, *trace;
    PyErr_Fetch(&class, &value, &trace);
    PyErr_Format(class, "member %d: %S", index, value);
    Py_XDECREF(class);
    Py_XDECREF(value);
    Py_XDECREF(trace);
}

static void give(python_batch *self, const python_members *members, int count) {
    for (int i = 0; i < count; i++) {
        python_member *m = &self->member[python_member_at(members, i)];
        m->taken = NULL;
        python_simulation_give(m->simulation);
    }
    self->busy = false;
}

static bool take(python_batch *self, const python_members *members, const char *call) {
    if (!python_batch_look((PyObject *)self, call)) return false;
    for (int i = 0; i < members->count; i++) {
        int index = python_member_at(members, i);
        python_member *m = &self->member[index];
        if (!(m->taken = python_simulation_take(m->simulation, call))) {
            name_member(index);
            give(self, members, i);
            return false;
        }
    }
    self->busy = true;
    return true;
}

/* ---- a call on members ---------------------------------------------------------------------- */

typedef struct run {
    python_batch *batch;
    python_member_call *call;
} run;

static void do_member(void *context, int place, bool caller) {
    run *r = context;
    if (__atomic_load_n(&r->call->stop, __ATOMIC_RELAXED)) return;
    python_member *m = &r->batch->member[python_member_at(&r->call->members, place)];
    lar_error error;
    m->status = r->call->work(r->call, m, place, caller, &error);
    if (m->status) m->message = strdup(error.message);
}

static void wait_for_members(void *context) {
    run *r = context;
    if (!python_watch_look(&r->call->watch)) __atomic_store_n(&r->call->stop, 1, __ATOMIC_RELAXED);
}

static bool prepare_pool(python_batch *self) {
    if (self->pool && self->generation == python_generation) return true;
    self->pool = python_pool_create(self->workers); /* that of the parent's process is lost */
    self->generation = python_generation;
    return self->pool != NULL || PyErr_NoMemory() != NULL;
}

/* {member: its words} becomes the exception's attribute `members`. */
static void add_members(PyObject *failed) {
    PyObject *class, *value, *trace;
    PyErr_Fetch(&class, &value, &trace);
    PyErr_NormalizeException(&class, &value, &trace);
    if (value && failed && PyObject_SetAttrString(value, "members", failed)) PyErr_Clear();
    PyErr_Restore(class, value, trace);
}

/* Raises what failed first, in the order of the members; frees all messages. */
static bool raise_failures(python_batch *self, const python_members *members) {
    PyObject *failed = PyDict_New();
    lar_error first = {.status = LAR_OK};
    int which = 0, count = 0;
    for (int i = 0; i < members->count; i++) {
        int index = python_member_at(members, i);
        python_member *m = &self->member[index];
        if (!m->status) continue;
        const char *words = m->message ? m->message : "no memory for the message";
        if (count++ == 0 || index < which) {
            which = index;
            first.status = m->status;
            snprintf(first.message, sizeof first.message, "member %d: %s", index, words);
        }
        PyObject *key = PyLong_FromLong(index);
        PyObject *text = python_sentence(words);
        if (!failed || !key || !text || PyDict_SetItem(failed, key, text)) PyErr_Clear();
        Py_XDECREF(key);
        Py_XDECREF(text);
        free(m->message);
        m->message = NULL;
        m->status = LAR_OK;
    }
    if (count > 1) {
        size_t at = strlen(first.message);
        snprintf(first.message + at, sizeof first.message - at, " (and %d more: error.members)",
                 count - 1);
    }
    if (count > 0) {
        python_raise(&first);
        add_members(failed);
    }
    Py_XDECREF(failed);
    return count == 0;
}

bool python_batch_run(python_batch *self, python_member_call *call) {
    static const double WORTH_WAKING = 100e-6; /* [s]: what waking a thread costs, about */
    bool ok = take(self, &call->members, call->name);
    if (ok && !prepare_pool(self)) {
        give(self, &call->members, call->members.count);
        ok = false;
    }
    if (!ok) {
        python_rows_free(&call->members.rows);
        return false;
    }
    run r = {self, call};
    python_watch_begin(&call->watch);
    call->watch.thread = PyEval_SaveThread();
    if (call->cost * call->members.count > WORTH_WAKING)
        python_pool_run(self->pool, call->members.count, do_member, wait_for_members, &r);
    else
        for (int i = 0; i < call->members.count; i++) do_member(&r, i, true);
    PyEval_RestoreThread(call->watch.thread);
    give(self, &call->members, call->members.count);
    if (call->watch.stopped) {
        PyObject *class, *value, *trace; /* Ctrl-C comes before what failed */
        PyErr_Fetch(&class, &value, &trace);
        raise_failures(self, &call->members);
        PyErr_Restore(class, value, trace);
        ok = false;
    } else {
        ok = raise_failures(self, &call->members);
    }
    python_rows_free(&call->members.rows);
    return ok;
}

/* ---- advance -------------------------------------------------------------------------------- */

typedef struct advance_call {
    unsigned long long steps;
    double seconds; /* where steps are not given */
    bool by_time;
} advance_call;

typedef struct step_watch {
    python_member_call *call;
    bool caller;
    unsigned calls;
} step_watch;

/* The caller looks for Ctrl-C, all others whether it has found it. */
static int after_step(void *context, uint64_t step) {
    step_watch *w = context;
    (void)step;
    if (w->caller && ++w->calls % 8 == 0 && !python_watch_look(&w->call->watch))
        __atomic_store_n(&w->call->stop, 1, __ATOMIC_RELAXED);
    return !__atomic_load_n(&w->call->stop, __ATOMIC_RELAXED);
}

static lar_status advance_member(python_member_call *call, python_member *member, int place,
                                 bool caller, lar_error *error) {
    (void)place;
    const advance_call *a = call->context;
    step_watch w = {call, caller, 0};
    const double time_step = lar_simulation_time_step(member->taken);
    uint64_t steps = a->by_time ? (uint64_t)round(a->seconds / time_step) : a->steps;
    lar_status status = lar_simulation_advance_with(member->taken, steps, after_step, &w, error);
    member->simulation->broken = status == LAR_ERROR_UNSTABLE;
    return status;
}

static PyObject *advance(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"steps", "seconds", "members", NULL};
    PyObject *steps = Py_None, *seconds = Py_None, *members = NULL;
    advance_call a = {.steps = 0};
    python_member_call call = {.name = "advance", .work = advance_member, .cost = 1, .context = &a};
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|O$OO:advance", names, &steps, &seconds,
                                     &members))
        return NULL;
    if ((steps == Py_None) == (seconds == Py_None)) {
        python_refuse_type("advance: expected steps or seconds=, and not both");
        return NULL;
    }
    a.by_time = seconds != Py_None;
    if (a.by_time ? !python_number(seconds, "seconds", &a.seconds)
                  : !python_steps(steps, "steps", &a.steps))
        return NULL;
    if (a.by_time && !(a.seconds >= 0 && a.seconds < 1e9)) {
        python_refuse("seconds: expected a time from 0 to 1e9, got %R", seconds);
        return NULL;
    }
    python_batch *self = python_batch_look(me, "advance");
    if (!self || !python_members_parse(self, members, &call.members) ||
        !python_batch_run(self, &call))
        return NULL;
    Py_RETURN_NONE;
}

/* ---- states that can be kept ---------------------------------------------------------------- */

/* No step: what has broken off says so, and why. */
static lar_status find_broken(python_member_call *call, python_member *member, int place,
                              bool caller, lar_error *error) {
    (void)call, (void)place, (void)caller;
    lar_status status = lar_simulation_advance(member->taken, 0, error);
    if (status != LAR_ERROR_UNSTABLE) return status;
    lar_error why = *error;
    snprintf(error->message, sizeof error->message,
             "its state is not kept, put it back with reset first: %.900s", why.message);
    return status;
}

bool python_batch_sound(python_batch *self, const char *name) {
    python_member_call call = {.name = name, .work = find_broken};
    return python_members_parse(self, NULL, &call.members) && python_batch_run(self, &call);
}

/* ---- life ----------------------------------------------------------------------------------- */

static bool is_alone(PyObject *options) {
    return !PyDict_GetItemString(options, "grid") && !PyDict_GetItemString(options, "threads");
}

/* A simulation of a model: the clone of one that is known, or a new one. */
static PyObject *make_simulation(PyObject *model, PyObject *options, PyObject *known) {
    PyObject *first = PyDict_GetItem(known, model); /* borrowed */
    if (first) return PyObject_CallMethod(first, "clone", NULL);
    if (PyErr_Occurred()) return NULL;
    PyObject *arguments = PyTuple_Pack(1, model);
    PyObject *made =
        arguments ? PyObject_Call((PyObject *)python_simulation_type, arguments, options) : NULL;
    Py_XDECREF(arguments);
    if (made && PyDict_SetItem(known, model, made)) Py_CLEAR(made);
    return made;
}

/* A list of simulations from one model n times, a sequence of models, or of simulations. */
static PyObject *list_simulations(PyObject *source, PyObject *count, PyObject *options) {
    bool one = Py_TYPE(source) == python_model_type;
    unsigned long long n = 0;
    if (count != Py_None && !python_steps(count, "n", &n)) return NULL;
    if (one && (n < 1 || n > 1000000)) {
        python_refuse("n: expected how many simulations, 1 to 1000000, got %R", count);
        return NULL;
    }
    if (!is_alone(options)) {
        python_refuse_type("Batch: each member is computed by one thread; grid and threads are for "
                           "a Simulation");
        return NULL;
    }
    PyObject *each = !one && PySequence_Check(source) && !PyUnicode_Check(source)
                         ? PySequence_Tuple(source)
                         : NULL;
    if (!one && !each) {
        PyErr_Clear();
        python_refuse_type("model: expected a Model, or a sequence of Models or Simulations, got "
                           "%R",
                           (PyObject *)Py_TYPE(source));
        return NULL;
    }
    Py_ssize_t total = one ? (Py_ssize_t)n : PyTuple_Size(each);
    bool ok = total > 0 || python_refuse("model: expected at least one");
    if (ok && !one && count != Py_None && (Py_ssize_t)n != total)
        ok = python_refuse("n: %zd models or simulations are given, and n is %R", total, count);
    PyObject *known = ok ? PyDict_New() : NULL, *list = known ? PyList_New(0) : NULL;
    for (Py_ssize_t i = 0; list && i < total; i++) {
        PyObject *item = one ? source : PyTuple_GetItem(each, i), *made = NULL;
        if (Py_TYPE(item) == python_simulation_type && PyDict_Size(options) == 0) {
            Py_INCREF(made = item);
        } else if (Py_TYPE(item) == python_simulation_type) {
            python_refuse_type("Batch: simulations are there already, options are for models");
        } else if (Py_TYPE(item) == python_model_type) {
            made = make_simulation(item, options, known);
        } else {
            python_refuse_type("model: expected Models or Simulations, item %zd is %R", i,
                               (PyObject *)Py_TYPE(item));
        }
        if (!made || PyList_Append(list, made) || PyErr_CheckSignals()) Py_CLEAR(list);
        Py_XDECREF(made);
    }
    Py_XDECREF(known);
    Py_XDECREF(each);
    return list;
}

/* What arrays over all members ask for. */
static bool check_member(const python_batch *self, int index, lar_simulation *simulation) {
    lar_simulation_info info;
    lar_simulation_inspect(simulation, &info);
    int nodes = lar_model_node_count(info.model);
    if (nodes != self->nodes || info.tools != self->tools)
        return python_refuse("model: member %d has %d nodes and %d tools, member 0 has %d and %d; "
                             "all have as many",
                             index, nodes, (int)info.tools, self->nodes, self->tools);
    return (lar_simulation_processors(simulation) == 1 &&
            lar_simulation_threads(simulation) == 1) ||
           python_refuse("model: member %d has several processors or threads; each member is "
                         "computed by one thread",
                         index);
}

static bool adopt(python_batch *self, PyObject *list) {
    int count = (int)PyList_Size(list);
    self->member = calloc((size_t)count, sizeof *self->member);
    if (!self->member) return PyErr_NoMemory() != NULL;
    for (int i = 0; i < count; i++) {
        python_simulation *simulation = (python_simulation *)PyList_GetItem(list, i);
        lar_simulation *looked = python_simulation_look(simulation, "Batch");
        lar_simulation_info info;
        if (!looked) {
            name_member(i);
            return false;
        }
        lar_simulation_inspect(looked, &info);
        if (i == 0) {
            self->nodes = lar_model_node_count(info.model);
            self->tools = info.tools;
        }
        if (!check_member(self, i, looked)) return false;
        for (int k = 0; k < i; k++)
            if (self->member[k].simulation == simulation)
                return python_refuse("model: members %d and %d are the same simulation", k, i);
        Py_INCREF((PyObject *)simulation);
        self->member[i].simulation = simulation;
        self->count = i + 1;
    }
    return true;
}

static void let_go(python_batch *self) {
    python_pool *pool = self->pool;
    bool lost = self->generation != python_generation;
    self->pool = NULL;
    self->busy = true; /* for other threads while this one waits for the pool's */
    if (pool) PYTHON_UNLOCKED(python_pool_destroy(pool, lost));
    self->busy = false;
    for (int i = 0; i < self->count; i++) Py_DECREF((PyObject *)self->member[i].simulation);
    free(self->member);
    self->member = NULL;
    self->count = 0;
}

/* Splits the keywords: those that are ours, and Simulation's. */
static bool parse_new(PyObject *args, PyObject *keywords, PyObject **source, PyObject **count,
                      unsigned long long *workers, PyObject **options) {
    static char *names[] = {"model", "n", "workers", NULL};
    PyObject *ours = PyDict_New(), *wanted = NULL;
    *options = keywords ? PyDict_Copy(keywords) : PyDict_New();
    bool ok = ours && *options;
    for (int i = 0; names[i] && ok; i++) {
        PyObject *value = PyDict_GetItemString(*options, names[i]);
        if (value)
            ok = PyDict_SetItemString(ours, names[i], value) == 0 &&
                 PyDict_DelItemString(*options, names[i]) == 0;
    }
    *count = Py_None;
    ok =
        ok && PyArg_ParseTupleAndKeywords(args, ours, "O|O$O:Batch", names, source, count, &wanted);
    *workers = 0;
    if (ok && wanted && wanted != Py_None) ok = python_steps(wanted, "workers", workers);
    if (ok && *workers > 1024)
        ok = python_refuse("workers: expected at most 1024 threads, got %R", wanted);
    Py_XINCREF(ok ? *source : NULL);
    Py_XINCREF(ok ? *count : NULL);
    Py_XDECREF(ours);
    if (!ok) Py_CLEAR(*options);
    return ok;
}

static PyObject *batch_new(PyTypeObject *type, PyObject *args, PyObject *keywords) {
    (void)type;
    PyObject *source, *count, *options;
    unsigned long long workers;
    if (!parse_new(args, keywords, &source, &count, &workers, &options)) return NULL;
    PyObject *list = list_simulations(source, count, options);
    Py_DECREF(source);
    Py_DECREF(count);
    Py_DECREF(options);
    if (!list) return NULL;
    python_batch *self = PyObject_New(python_batch, python_batch_type);
    if (self) {
        *self = (python_batch){.ob_base = self->ob_base, .generation = python_generation};
        self->workers = workers > 0 ? (int)workers : (int)lar_usable_cores();
        if (!adopt(self, list)) Py_CLEAR(self);
    }
    Py_DECREF(list);
    return (PyObject *)self;
}

static void batch_dealloc(PyObject *me) {
    let_go((python_batch *)me);
    python_object_free(me);
}

static PyObject *batch_close(PyObject *me, PyObject *nothing) {
    (void)nothing;
    if (!((python_batch *)me)->member) Py_RETURN_NONE;
    python_batch *self = python_batch_look(me, "close");
    if (!self) return NULL;
    let_go(self);
    Py_RETURN_NONE;
}

static PyObject *batch_enter(PyObject *me, PyObject *nothing) {
    (void)nothing;
    Py_INCREF(me);
    return me;
}

static PyObject *batch_exit(PyObject *me, PyObject *args) {
    (void)args;
    return batch_close(me, NULL);
}

static PyObject *batch_repr(PyObject *me) {
    python_batch *self = (python_batch *)me;
    if (!self->member) return PyUnicode_FromString("<lariat.Batch, closed>");
    return PyUnicode_FromFormat("<lariat.Batch of %d, %d nodes and %d tools each, %d workers>",
                                self->count, self->nodes, self->tools, self->workers);
}

static Py_ssize_t batch_length(PyObject *me) {
    return ((python_batch *)me)->count;
}

static PyObject *batch_item(PyObject *me, Py_ssize_t index) {
    python_batch *self = (python_batch *)me;
    if (!self->member) {
        PyErr_SetString(python_error_state, "Batch: the batch is closed");
        return NULL;
    }
    if (index < 0 || index >= self->count) {
        /* Python has added the count to a negative one. */
        PyErr_Format(PyExc_IndexError, "there is no member %zd; the batch has %d",
                     index < 0 ? index - self->count : index, self->count);
        return NULL;
    }
    PyObject *simulation = (PyObject *)self->member[index].simulation;
    Py_INCREF(simulation);
    return simulation;
}

static PyObject *batch_reduce(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_batch *self = python_batch_look(me, "pickle");
    PyObject *list = self && python_batch_sound(self, "pickle") ? PySequence_List(me) : NULL;
    PyObject *package = list ? PyImport_ImportModule("lariat") : NULL;
    PyObject *restore = package ? PyObject_GetAttrString(package, "_restore_batch") : NULL;
    PyObject *answer = restore ? Py_BuildValue("(O(Oi))", restore, list, self->workers) : NULL;
    Py_XDECREF(restore);
    Py_XDECREF(package);
    Py_XDECREF(list);
    return answer;
}

static PyObject *get_closed(PyObject *me, void *unused) {
    (void)unused;
    return PyBool_FromLong(!((python_batch *)me)->member);
}
static PyObject *get_workers(PyObject *me, void *unused) {
    (void)unused;
    return PyLong_FromLong(((python_batch *)me)->workers);
}
static PyObject *get_nodes(PyObject *me, void *unused) {
    (void)unused;
    return PyLong_FromLong(((python_batch *)me)->nodes);
}
static PyObject *get_tools(PyObject *me, void *unused) {
    (void)unused;
    return PyLong_FromLong(((python_batch *)me)->tools);
}

static PyGetSetDef batch_properties[] = {
    {"workers", get_workers, NULL, "Threads that compute, the caller's among them, an int.", NULL},
    {"node_count", get_nodes, NULL, "Nodes of each member, an int.", NULL},
    {"tool_count", get_tools, NULL, "Tools of each member, hands included, an int.", NULL},
    {"closed", get_closed, NULL, "True after close().", NULL},
    {NULL, NULL, NULL, NULL, NULL}};

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
static PyMethodDef batch_methods[] = {
    {"advance", FUNCTION(advance), METH_VARARGS | METH_KEYWORDS,
     "advance($self, steps=None, *, seconds=None, members=None)\n--\n\n"
     "Advances all members by so many steps each, or by seconds of simulated time, rounded to "
     "whole\nsteps of each. Other Python threads run meanwhile.\n\n"
     "members  int32 [k], which ones; None: all\n\n"
     "When a member becomes unstable, the others do all their steps; then UnstableError names the "
     "first,\nand its attribute `members` is a dict of member: message. Ctrl-C stops all between "
     "two steps, at\ndifferent ones; all are sound then."},
    {"close", batch_close, METH_NOARGS,
     "close($self)\n--\n\nEnds the threads and lets go of the members; they are freed when nobody "
     "else has them. Closing\ntwice is fine."},
    {"__enter__", batch_enter, METH_NOARGS, NULL},
    {"__exit__", batch_exit, METH_VARARGS, NULL},
    {"__reduce__", batch_reduce, METH_NOARGS, "For pickle: sound members and the workers."},
    {NULL, NULL, 0, NULL}};

static const char batch_doc[] =
    "Batch(model, n=None, *, workers=0, **options)\n--\n\n"
    "Many simulations that one call advances on all cores.\n\n"
    "model    a Model, for n simulations of it; or a sequence of Models, one for each member, with "
    "as\n"
    "         many nodes and tools; or a sequence of Simulations, which become the members\n"
    "n        how many\n"
    "workers  threads that compute, the caller's among them; 0: one for each core\n"
    "options  of Simulation, but for grid and threads\n\n"
    "batch[i] is member i, a Simulation, for calls to one of them: materials, forces, grasps, "
    "hash. Every\nmember has the bits of a single simulation, with any number of workers. One "
    "thread at a time.";

bool python_batch_add(PyObject *module) {
    PyMethodDef *const methods[] = {batch_methods, python_batch_state_methods};
    PyMethodDef *all = python_join_methods(methods, 2);
    if (!all) return false;
    PyType_Slot slots[] = {{Py_tp_doc, (void *)(uintptr_t)batch_doc},
                           {Py_tp_new, batch_new},
                           {Py_tp_dealloc, batch_dealloc},
                           {Py_tp_repr, batch_repr},
                           {Py_tp_methods, all},
                           {Py_tp_getset, batch_properties},
                           {Py_sq_length, batch_length},
                           {Py_sq_item, batch_item},
                           {0, NULL}};
    PyType_Spec spec = {.name = "lariat.Batch",
                        .basicsize = sizeof(python_batch),
                        .flags = Py_TPFLAGS_DEFAULT,
                        .slots = slots};
    python_batch_type = python_type_add(module, &spec, true);
    return python_batch_type != NULL;
}
