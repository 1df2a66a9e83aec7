/* class Session: states, recordings, snapshots. */
#include "module.h"

static PyObject *kept(python_session *self, lar_status status, const lar_error *error) {
    python_session_give(self);
    return python_answer(status, error);
}

/* Ends a call that took the session, after which tools may be elsewhere. */
static PyObject *done(python_session *self, lar_status status, const lar_error *error) {
    python_asked_forget(self->asked);
    return kept(self, status, error);
}

static PyObject *reset(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_session *self = (python_session *)me;
    lar_session *session = python_session_take(self, "reset");
    if (!session) return NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = lar_session_reset(session, &error));
    return done(self, status, &error);
}

typedef lar_status path_call(lar_session *session, const char *path, lar_error *error);

/* A call with a path, or None where that means something. */
static PyObject *with_path(PyObject *me, PyObject *source, const char *call, path_call *make) {
    python_session *self = (python_session *)me;
    PyObject *path = source == Py_None ? NULL : python_path(source, "path");
    if (!path && source != Py_None) return NULL;
    lar_session *session = python_session_take(self, call);
    if (!session) {
        Py_XDECREF(path);
        return NULL;
    }
    const char *bytes = path ? PyBytes_AsString(path) : NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = make(session, bytes, &error));
    Py_XDECREF(path);
    bool stays = make == lar_session_record || make == lar_session_save;
    return stays ? kept(self, status, &error) : done(self, status, &error);
}

static PyObject *record(PyObject *me, PyObject *path) {
    return with_path(me, path, "record", lar_session_record);
}
static PyObject *replay(PyObject *me, PyObject *path) {
    return with_path(me, path, "replay", lar_session_replay);
}

static PyObject *with_saved(python_session *self, python_saved *saved, bool save) {
    const char *call = save ? "save" : "load";
    lar_session *session = python_session_look(self, call);
    if (!session || !python_saved_fits(saved, self->simulation->simulation, call)) return NULL;
    if (!python_saved_take(saved, save, call)) return NULL;
    session = python_session_take(self, call);
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = save ? lar_session_save_to(session, saved->saved, &error)
                                  : lar_session_load_from(session, saved->saved, &error));
    python_saved_give(saved);
    if (!status &&
        save) { /* at or after the tick that was saved: there is no call that says which */
        lar_session_status now;
        lar_session_status_get(session, &now);
        saved->step = now.step;
        saved->time = now.time;
        memcpy(saved->asked, self->asked, sizeof saved->asked);
    }
    if (!status && !save) memcpy(self->asked, saved->asked, sizeof self->asked);
    return status && !save ? done(self, status, &error) : kept(self, status, &error);
}

static PyObject *save(PyObject *me, PyObject *target) {
    if (Py_TYPE(target) == python_saved_type)
        return with_saved((python_session *)me, (python_saved *)target, true);
    if (target != Py_None) return with_path(me, target, "save", lar_session_save);
    python_refuse_type("save: expected a path, or a Saved that Simulation.save made");
    return NULL;
}
static PyObject *load(PyObject *me, PyObject *source) {
    if (Py_TYPE(source) == python_saved_type)
        return with_saved((python_session *)me, (python_saved *)source, false);
    if (source != Py_None) return with_path(me, source, "load", lar_session_load);
    python_refuse_type("load: expected a path, or a Saved");
    return NULL;
}

static PyObject *seek(PyObject *me, PyObject *seconds) {
    double number;
    if (!python_number(seconds, "seconds", &number)) return NULL;
    lar_session *session = python_session_look((python_session *)me, "seek");
    if (!session) return NULL;
    if (!(number >= 0 && number <= 1e12)) {
        python_refuse("seconds: expected a moment of the recording, from 0 to 1e12, got %R",
                      seconds);
        return NULL;
    }
    lar_session_status now;
    lar_session_status_get(session, &now);
    if (!now.replaying) {
        python_refuse("seek: no recording is being played; replay(path) begins one");
        return NULL;
    }
    lar_session_seek(session, number);
    Py_RETURN_NONE;
}

/* ---- snapshots ------------------------------------------------------------------------------ */

static void free_snapshot(PyObject *capsule) {
    lar_snapshot_destroy(PyCapsule_GetPointer(capsule, NULL));
}

/* Waits in tenths of a second, so that Ctrl-C is heard. */
static bool wait_for(const python_session *self, lar_session *session, lar_snapshot *snapshot,
                     double seconds) {
    lar_error error;
    lar_status status;
    do {
        double portion = seconds < 0.1 ? seconds : 0.1;
        PYTHON_UNLOCKED(status = lar_session_snapshot(session, snapshot, portion, &error));
        if (PyErr_CheckSignals()) return false;
        seconds -= portion;
    } while (status == LAR_ERROR_PEER && seconds > 0 && !self->closing);
    if (status) python_raise(&error);
    return !status;
}

static PyObject *tools_of(const lar_snapshot *s) {
    PyObject *list = PyList_New(0);
    for (int32_t i = 0; i < s->tools && list; i++) {
        const lar_snapshot_tool *t = &s->tool[i];
        PyObject *one =
            Py_BuildValue("{s:N,s:N,s:N}", "pose", python_pose_dict(&t->pose), "force",
                          python_tuple(t->force, 3), "torque", python_tuple(t->torque, 3));
        if (!one || PyList_Append(list, one)) Py_CLEAR(list);
        Py_XDECREF(one);
    }
    return list;
}

static PyObject *snapshot(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"timeout", NULL};
    python_session *self = (python_session *)me;
    PyObject *seconds = NULL;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|O:snapshot", names, &seconds)) return NULL;
    double timeout = seconds ? PyFloat_AsDouble(seconds) : 5;
    if (PyErr_Occurred()) {
        PyErr_Clear();
        python_refuse_type("timeout: expected a number, got %R", (PyObject *)Py_TYPE(seconds));
        return NULL;
    }
    if (!(timeout >= 0)) {
        python_refuse("timeout: expected seconds from 0 on, got %R", seconds);
        return NULL;
    }
    lar_session *session = python_session_take(self, "snapshot");
    if (!session) return NULL;
    lar_snapshot *s = NULL;
    lar_error error;
    PyObject *answer = NULL, *owner = NULL;
    if (lar_snapshot_create(session, &s, &error))
        python_raise(&error);
    else if (!(owner = PyCapsule_New(s, NULL, free_snapshot)))
        lar_snapshot_destroy(s);
    else if (wait_for(self, session, s, timeout))
        answer = Py_BuildValue("{s:K,s:d,s:K,s:N,s:d,s:N}", "step", (unsigned long long)s->step,
                               "time", s->time, "hash", (unsigned long long)s->hash,
                               "displacements", python_array_of(owner, s->u, 'd', s->nodes, 3),
                               "kinetic", s->kinetic, "tools", tools_of(s));
    Py_XDECREF(owner);
    python_session_give(self);
    return answer;
}

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
PyMethodDef python_session_state_methods[] = {
    {"reset", reset, METH_NOARGS, "reset($self)\n--\n\nBack to the state at the start."},
    {"save", save, METH_O,
     "save($self, target)\n--\n\nSaves the state at the end of the tick: a checkpoint at a path, "
     "or into a Saved that Simulation.save made."},
    {"load", load, METH_O,
     "load($self, source)\n--\n\nTakes up a checkpoint at a path, or a Saved."},
    {"record", record, METH_O,
     "record($self, path)\n--\n\nBegins a recording at a path, after the end of the one under way; "
     "one "
     "that is there is replaced; "
     "None ends that."},
    {"replay", replay, METH_O,
     "replay($self, path)\n--\n\nPlays a recording, at the session's pace; None ends that. Returns "
     "None when it "
     "has begun; status() has replay_time and replay_length."},
    {"seek", seek, METH_O,
     "seek($self, seconds)\n--\n\nGoes to a moment of what is being played [s]. Returns None at "
     "once."},
    {"snapshot", FUNCTION(snapshot), METH_VARARGS | METH_KEYWORDS,
     "snapshot($self, timeout=5.0)\n--\n\nAll nodes at the end of a tick: a dict with step, time "
     "[s], hash, displacements (memoryview, float64 [nodes, 3], read only, the snapshot's own "
     "memory), kinetic energy [J] and tools: a list of dicts with pose, as of tool_pose, force [N] "
     "and torque about the tip [N m] of the same tick. PeerError when none came within so many "
     "seconds."},
    {NULL, NULL, 0, NULL}};
