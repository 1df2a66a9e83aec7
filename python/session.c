/* class Session: a simulation in real time, on a thread of the library's own. */

#include <time.h>

#include "module.h"

PyTypeObject *python_session_type;
static python_session *open_sessions;

/* ---- who may use it ------------------------------------------------------------------------- */

lar_session *python_session_look(python_session *self, const char *call) {
    const char *why = NULL;
    if (!self->session || self->closing)
        why = "the session is closed";
    else if (self->generation != python_generation)
        why = "the session runs in the process that this one was forked from";
    if (!why) return self->session;
    PyErr_Format(python_error_state, "%s: %s", call, why);
    return NULL;
}

/* Calls of a session may come from any thread; what is counted is that none is under way when it is
 * closed. */
lar_session *python_session_take(python_session *self, const char *call) {
    lar_session *session = python_session_look(self, call);
    if (session) self->calls++;
    return session;
}

void python_session_give(python_session *self) {
    self->calls--;
}

lar_session *python_session_tool(python_session *self, const char *call, PyObject *source,
                                 int32_t *index) {
    unsigned long long number = 0;
    lar_tool_info info;
    const bool named = PyUnicode_Check(source);
    const char *wanted = named ? python_text(source, "tool") : NULL;
    if (named ? !wanted : !python_steps(source, "tool", &number)) return NULL;
    lar_session *session = python_session_look(self, call); /* reading may have run any code */
    if (!session) return NULL;
    for (int32_t i = 0; !lar_session_tool_info(session, i, &info, NULL); i++) {
        *index = i;
        if (named ? !strcmp(info.name, wanted) : number == (unsigned long long)i) return session;
    }
    python_refuse(named ? "tool: there is none called %R; Session.tools lists them"
                        : "tool: there is no tool %R; Session.tools lists them",
                  source);
    return NULL;
}

/* ---- life ----------------------------------------------------------------------------------- */

/* Numbers of a session: from 0 to 1e6, which is beyond all that means something. */
static bool parse_number(PyObject *source, const char *name, double *out) {
    return python_real(source, name, out) &&
           ((*out >= 0 && *out <= 1e6) ||
            python_refuse("%s: expected a number from 0 to 1e6, got %R", name, source));
}

static bool parse_options(PyObject *args, PyObject *keywords, PyObject **simulation,
                          PyObject **record, lar_session_options *o) {
    static char *names[] = {"simulation", "tick",   "pace",     "paused",     "tool_speed",
                            "hand_force", "record", "priority", "hash_every", "stop_when_unstable",
                            NULL};
    PyObject *tick = NULL, *pace = NULL, *speed = NULL, *force = NULL, *priority = NULL;
    PyObject *hash_every = NULL;
    unsigned long long every = 0;
    *o = lar_session_options_default();
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O!|$OOpOOOOOp:Session", names,
                                     python_simulation_type, simulation, &tick, &pace, &o->paused,
                                     &speed, &force, record, &priority, &hash_every,
                                     &o->stop_when_unstable) ||
        !parse_number(tick, "tick", &o->tick) || !parse_number(pace, "pace", &o->pace) ||
        !parse_number(speed, "tool_speed", &o->tool_speed) ||
        !parse_number(force, "hand_force", &o->hand_force) ||
        !python_int(priority, "priority", &o->priority) ||
        (hash_every && !python_steps(hash_every, "hash_every", &every)))
        return false;
    o->hash_every = every;
    return true;
}

static void unlink_session(const python_session *self) {
    for (python_session **at = &open_sessions; *at; at = &(*at)->next)
        if (*at == self) {
            *at = self->next;
            return;
        }
}

static PyObject *session_new(PyTypeObject *type, PyObject *args, PyObject *keywords) {
    (void)type;
    PyObject *simulation, *record = Py_None;
    lar_session_options options;
    if (!parse_options(args, keywords, &simulation, &record, &options)) return NULL;
    PyObject *path = record == Py_None ? NULL : python_path(record, "record");
    if (record != Py_None && !path) return NULL;
    options.record = path ? PyBytes_AsString(path) : NULL;
    python_session *self = PyObject_New(python_session, python_session_type);
    lar_simulation *taken =
        self ? python_simulation_take((python_simulation *)simulation, "Session") : NULL;
    lar_session *session = NULL;
    lar_error error;
    lar_status status = LAR_OK;
    if (self) *self = (python_session){.ob_base = self->ob_base, .generation = python_generation};
    if (self) python_asked_forget(self->asked);
    if (taken) {
        PYTHON_UNLOCKED({
            status = lar_session_open(taken, &options, &session, &error);
            if (!status) status = lar_session_start(session, &error);
            if (status) lar_session_close(session, NULL);
        });
        python_simulation_give((python_simulation *)simulation);
    }
    Py_XDECREF(path);
    if (taken && !status) {
        Py_INCREF(simulation);
        self->simulation = (python_simulation *)simulation;
        self->simulation->session = self;
        self->session = session;
        self->next = open_sessions;
        open_sessions = self;
        return (PyObject *)self;
    }
    Py_XDECREF((PyObject *)self);
    return status ? python_raise(&error) : NULL;
}

/* Ends the thread; with the lock held by the caller, who has seen that no call is under way. */
static lar_status shut(python_session *self, lar_error *error) {
    lar_session *session = self->session;
    lar_session_status last;
    lar_status status;
    unlink_session(self);
    self->session = NULL;
    if (self->view) python_view_shut(self->view);
    self->calls++;
    PYTHON_UNLOCKED({
        lar_session_status_get(session, &last);
        status = lar_session_close(session, error);
    });
    self->calls--;
    self->simulation->session = NULL;
    self->simulation->broken = last.state == LAR_SESSION_STOPPED;
    return status;
}

static PyObject *session_close(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_session *self = (python_session *)me;
    lar_error error;
    if (!self->session) Py_RETURN_NONE;
    if (!python_session_look(self, "close")) return NULL;
    /* New calls are refused; those under way take a tick, or a tenth of a second for a snapshot. */
    self->closing = true;
    while (self->calls > 0) {
        static const struct timespec moment = {0, 1000000};
        PYTHON_UNLOCKED(nanosleep(&moment, NULL));
    }
    if (shut(self, &error)) return python_raise(&error);
    Py_RETURN_NONE;
}

static void session_dealloc(PyObject *me) {
    python_session *self = (python_session *)me;
    bool lost = self->session && self->generation != python_generation;
    if (self->session && !lost) {
        PyObject *kind, *value, *trace;
        PyErr_Fetch(&kind, &value, &trace);
        shut(self, NULL);
        PyErr_Restore(kind, value, trace);
    }
    /* In a child of a fork the thread is not there, and the simulation stays taken. */
    if (lost) unlink_session(self);
    if (!lost) Py_XDECREF((PyObject *)self->simulation);
    python_object_free(me);
}

/* A program that ends without closing has its recordings completed all the same. */
static void close_all(void) {
    for (python_session *s = open_sessions; s; s = s->next) {
        if (s->generation != python_generation || s->calls > 0 || !s->session) continue;
        if (s->view) lar_server_close(s->view->server);
        lar_session_close(s->session, NULL);
    }
}

static PyObject *session_enter(PyObject *me, PyObject *nothing) {
    (void)nothing;
    Py_INCREF(me);
    return me;
}

static PyObject *session_exit(PyObject *me, PyObject *args) {
    (void)args;
    return session_close(me, NULL);
}

static PyObject *session_repr(PyObject *me) {
    python_session *self = (python_session *)me;
    if (!self->session || self->generation != python_generation)
        return PyUnicode_FromString("<lariat.Session, closed>");
    lar_session_status status;
    lar_session_status_get(self->session, &status);
    return PyUnicode_FromFormat("<lariat.Session of %s, step %llu>",
                                lar_model_source(self->simulation->model->model),
                                (unsigned long long)status.step);
}

/* ---- the clock ------------------------------------------------------------------------------ */

lar_session *python_session_look_sound(python_session *self, const char *call) {
    lar_session_status now;
    lar_session *session = python_session_look(self, call);
    if (!session) return NULL;
    lar_session_status_get(session, &now);
    if (now.state != LAR_SESSION_STOPPED) return session;
    lar_error error = {.status = now.error ? now.error : LAR_ERROR_UNSTABLE};
    snprintf(error.message, sizeof error.message,
             "%s: the run has broken off; reset() or load() takes it up again: %.800s", call,
             now.message);
    python_raise(&error);
    return NULL;
}

static PyObject *play(PyObject *me, PyObject *nothing) {
    (void)nothing;
    lar_session *session = python_session_look_sound((python_session *)me, "play");
    if (!session) return NULL;
    lar_session_play(session);
    Py_RETURN_NONE;
}

static PyObject *pause_session(PyObject *me, PyObject *nothing) {
    (void)nothing;
    lar_session *session = python_session_look((python_session *)me, "pause");
    if (!session) return NULL;
    lar_session_pause(session);
    Py_RETURN_NONE;
}

static PyObject *step(PyObject *me, PyObject *steps) {
    unsigned long long count;
    if (!python_steps(steps, "steps", &count)) return NULL;
    lar_session *session = python_session_look_sound((python_session *)me, "step");
    if (!session) return NULL;
    if (count == 0) {
        python_refuse("steps: expected one at least, got 0; pause() is to stand still");
        return NULL;
    }
    lar_session_step(session, count);
    Py_RETURN_NONE;
}

static PyObject *set_pace(PyObject *me, PyObject *pace) {
    double number;
    if (!python_number(pace, "pace", &number)) return NULL;
    lar_session *session = python_session_look((python_session *)me, "set_pace");
    if (!session) return NULL;
    if (!(number >= 0 && number <= 1e6)) {
        python_refuse("pace: expected a number from 0 (as fast as it goes) to 1e6, got %R", pace);
        return NULL;
    }
    lar_session_set_pace(session, number);
    Py_RETURN_NONE;
}

static PyObject *get_simulation(PyObject *me, void *unused) {
    (void)unused;
    PyObject *simulation = (PyObject *)((python_session *)me)->simulation;
    Py_INCREF(simulation);
    return simulation;
}

static PyObject *get_closed(PyObject *me, void *unused) {
    (void)unused;
    return PyBool_FromLong(!((python_session *)me)->session);
}

static PyObject *get_tick(PyObject *me, void *unused) {
    (void)unused;
    lar_session_info info;
    lar_session *session = python_session_look((python_session *)me, "tick");
    if (!session) return NULL;
    lar_session_inspect(session, &info);
    return PyFloat_FromDouble(info.tick);
}

static PyObject *status_dict(const lar_session_status *s) {
    static const char *const states[] = {"idle", "playing", "paused", "stopped"};
    static const char *const causes[] = {"", "step", "division", "machine"};
    return Py_BuildValue(
        "{s:s,s:K,s:d,s:d,s:d,s:d,s:d,s:d,s:d,s:d,s:d,s:K,s:K,s:K,s:d,s:d,s:d,s:d,s:d,s:d,s:N,s:d,"
        "s:d,s:N,s:s,s:s,s:K,s:s,s:N,s:d,s:d,s:i,s:K,s:i,s:d,s:s,s:N}",
        "state", states[s->state], "step", (unsigned long long)s->step, "time", s->time, "step_p50",
        s->step_p50, "step_p99", s->step_p99, "step_p999", s->step_p999, "step_max", s->step_max,
        "tick_p50", s->tick_p50, "tick_p99", s->tick_p99, "tick_p999", s->tick_p999, "tick_max",
        s->tick_max, "ticks", (unsigned long long)s->ticks, "misses", (unsigned long long)s->misses,
        "slow_ticks", (unsigned long long)s->slow_ticks, "pace", s->pace, "real_time_factor",
        s->real_time_factor, "real_time_factor_now", s->real_time_factor_now, "engine_rate",
        s->engine_rate, "haptic_rate", s->haptic_rate, "snapshot_rate", s->snapshot_rate,
        "slow_motion", PyBool_FromLong(s->slow_motion), "lag", s->lag, "skipped", s->skipped,
        "recording", PyBool_FromLong(s->recording), "recording_lost", s->recording_lost, "message",
        s->message, "recoveries", (unsigned long long)s->recoveries, "recovery", s->recovery,
        "replaying", PyBool_FromLong(s->replaying), "replay_time", s->replay_time, "replay_length",
        s->replay_length, "step_parts", (int)s->step_parts, "divided_steps",
        (unsigned long long)s->divided_steps, "heavier", (int)s->heavier, "heavier_share",
        s->heavier_share, "slow_cause", causes[s->slow_cause], "slow_advice",
        python_sentence(s->slow_advice));
}

static PyObject *status(PyObject *me, PyObject *nothing) {
    (void)nothing;
    lar_session_status s;
    lar_session *session = python_session_look((python_session *)me, "status");
    if (!session) return NULL;
    lar_session_status_get(session, &s);
    return status_dict(&s);
}

/* ---- the class ------------------------------------------------------------------------------ */

static PyGetSetDef session_properties[] = {
    {"simulation", get_simulation, NULL, "The Simulation, which may be used again after close().",
     NULL},
    {"closed", get_closed, NULL, "True after close().", NULL},
    {"tick", get_tick, NULL, "Seconds of simulated time between two exchanges with tools.", NULL},
    {NULL, NULL, NULL, NULL, NULL}};

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
static PyMethodDef session_methods[] = {
    {"play", play, METH_NOARGS,
     "play($self)\n--\n\nGoes on, at its pace, after the tick under way. Returns None at once: "
     "status() "
     "and snapshot() say how far it is. UnstableError when the run has broken off."},
    {"pause", pause_session, METH_NOARGS,
     "pause($self)\n--\n\nPauses after the tick under way. Returns None at once."},
    {"step", step, METH_O,
     "step($self, steps)\n--\n\nDoes so many steps, one at least, at the session's pace, then "
     "pauses. Returns "
     "None at once: status()[\"step\"] tells how far it is; Simulation.advance waits and returns "
     "their number. UnstableError when the run has broken off."},
    {"set_pace", set_pace, METH_O,
     "set_pace($self, pace)\n--\n\nSimulated seconds per second of the clock; 0: as fast as it "
     "goes."},
    {"status", status, METH_NOARGS,
     "status($self)\n--\n\ndict: state (playing, paused, stopped), step, time [s], times of steps "
     "and ticks [s], misses, real_time_factor, slow_motion, recoveries, message ... "
     "(docs/session.md)."},
    {"view", FUNCTION(python_view_open), METH_VARARGS | METH_KEYWORDS,
     "view($self, *, open=True, address=None, port=0, token=None, watch_token=None, folder=None, "
     "scan=None, save_folder=None)\n--\n\nServes the viewer and returns a View; open: in the "
     "browser, too. The last value of a notebook's cell shows it there. address other than "
     "127.0.0.1 needs a token."},
    {"close", session_close, METH_NOARGS,
     "close($self)\n--\n\nEnds the thread within a tick, closes the view, devices and the "
     "recording. The simulation may be used again."},
    {"__enter__", session_enter, METH_NOARGS, NULL},
    {"__exit__", session_exit, METH_VARARGS, NULL},
    {NULL, NULL, 0, NULL}};

static const char session_doc[] =
    "Session(simulation, *, tick=0.0, pace=1.0, paused=False, tool_speed=0.0, hand_force=0.0,\n"
    "        record=None, priority=0, hash_every=0, stop_when_unstable=False)\n--\n\n"
    "Advances a simulation in real time, on a thread of its own, from now on, and exchanges poses "
    "and\n"
    "forces of tools with it once in a tick. Takes the simulation over until it is closed.\n\n"
    "tick        seconds of simulated time between exchanges; 0: 1 ms, 10,000 steps at most\n"
    "pace        simulated seconds per second of the clock; 0: as fast as it goes\n"
    "tool_speed  tools follow no faster than this [m/s]; 0: 1 m/s\n"
    "hand_force  hands pull no harder than this [N]; 0: 1 N\n"
    "record      path of a recording to write, in place of one that is there\n"
    "priority    1 to 99: before all ordinary threads of the machine, where the system allows "
    "it\n\n"
    "All calls may come from any thread; none makes the engine wait. docs/session.md.";

bool python_session_add(PyObject *module) {
    PyMethodDef *const methods[] = {session_methods, python_session_state_methods,
                                    python_session_change_methods, python_session_tool_methods};
    PyGetSetDef *const properties[] = {session_properties, python_session_change_properties,
                                       python_session_tool_properties};
    PyMethodDef *all = python_join_methods(methods, 4);
    PyGetSetDef *shown = python_join_properties(properties, 3);
    if (!all || !shown) return false;
    PyType_Slot slots[] = {{Py_tp_doc, (void *)(uintptr_t)session_doc},
                           {Py_tp_new, session_new},
                           {Py_tp_dealloc, session_dealloc},
                           {Py_tp_repr, session_repr},
                           {Py_tp_methods, all},
                           {Py_tp_getset, shown},
                           {0, NULL}};
    PyType_Spec spec = {.name = "lariat.Session",
                        .basicsize = sizeof(python_session),
                        .flags = Py_TPFLAGS_DEFAULT,
                        .slots = slots};
    python_session_type = python_type_add(module, &spec, true);
    return python_session_type && Py_AtExit(close_all) == 0;
}
