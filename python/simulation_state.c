/* class Simulation: arrays, energies, hash; states saved and taken up again. */
#include "module.h"

#include <math.h>

/* ---- arrays --------------------------------------------------------------------------------- */

typedef void fill(const lar_simulation *simulation, double (*out)[3]);

void python_positions(const lar_simulation *simulation, double (*out)[3]) {
    lar_simulation_info info;
    lar_simulation_inspect(simulation, &info);
    const double(*rest)[3] = lar_model_positions(info.model);
    int32_t count = lar_model_node_count(info.model);
    lar_simulation_displacements(simulation, out);
    for (int32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) out[i][k] += rest[i][k];
}

static PyObject *nodes_of(PyObject *me, PyObject *args, PyObject *keywords, const char *call,
                          const char *format, fill *fill_in) {
    static char *names[] = {"out", NULL};
    python_simulation *self = (python_simulation *)me;
    PyObject *out = NULL;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, format, names, &out)) return NULL;
    python_target target;
    if (!python_target_open(out, 'd', lar_model_node_count(self->model->model), 3, &target))
        return NULL;
    lar_simulation *simulation = python_simulation_take(self, call);
    if (!simulation) return python_target_close(&target, true);
    PYTHON_UNLOCKED(fill_in(simulation, target.data));
    python_simulation_give(self);
    return python_target_close(&target, false);
}

static PyObject *positions(PyObject *me, PyObject *args, PyObject *keywords) {
    return nodes_of(me, args, keywords, "positions", "|O:positions", python_positions);
}
static PyObject *displacements(PyObject *me, PyObject *args, PyObject *keywords) {
    return nodes_of(me, args, keywords, "displacements", "|O:displacements",
                    lar_simulation_displacements);
}
static PyObject *velocities(PyObject *me, PyObject *args, PyObject *keywords) {
    return nodes_of(me, args, keywords, "velocities", "|O:velocities", lar_simulation_velocities);
}

static PyObject *field(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"name", "out", NULL};
    static const struct {
        const char *name;
        lar_field field;
    } known[] = {{"displacement", LAR_FIELD_DISPLACEMENT},
                 {"von_mises", LAR_FIELD_VON_MISES},
                 {"pressure", LAR_FIELD_PRESSURE},
                 {"energy", LAR_FIELD_ENERGY},
                 {"processor", LAR_FIELD_PROCESSOR}};
    python_simulation *self = (python_simulation *)me;
    const char *name;
    PyObject *word, *out = NULL;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O|O:field", names, &word, &out) ||
        !(name = python_text(word, "name")))
        return NULL;
    int k = 0, count = sizeof known / sizeof known[0];
    while (k < count && strcmp(name, known[k].name) != 0) k++;
    if (k == count) {
        python_refuse("name: \"%s\" is none; there are displacement, von_mises, pressure, energy, "
                      "processor",
                      name);
        return NULL;
    }
    int32_t nodes = lar_model_node_count(self->model->model);
    python_target target;
    if (!python_target_open(out, 'f', nodes, 0, &target)) return NULL;
    lar_simulation *simulation = python_simulation_take(self, "field");
    if (!simulation) return python_target_close(&target, true);
    lar_error error = {.status = LAR_ERROR_MEMORY, .message = "no memory for a field"};
    lar_status status = LAR_ERROR_MEMORY;
    double(*u)[3] = malloc(((size_t)nodes + 1) * sizeof *u);
    PYTHON_UNLOCKED(if (u) {
        lar_simulation_displacements(simulation, u);
        status = lar_simulation_field(simulation, known[k].field, (const double(*)[3])u,
                                      target.data, &error);
    });
    free(u);
    python_simulation_give(self);
    if (status) python_raise(&error);
    return python_target_close(&target, status != LAR_OK);
}

/* ---- numbers -------------------------------------------------------------------------------- */

static PyObject *hash(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_simulation *self = (python_simulation *)me;
    lar_simulation *simulation = python_simulation_take(self, "hash");
    if (!simulation) return NULL;
    unsigned long long value;
    PYTHON_UNLOCKED(value = lar_simulation_hash(simulation));
    python_simulation_give(self);
    return PyLong_FromUnsignedLongLong(value);
}

static PyObject *energies(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_simulation *self = (python_simulation *)me;
    lar_simulation *simulation = python_simulation_take(self, "energies");
    if (!simulation) return NULL;
    lar_energy e;
    PYTHON_UNLOCKED(lar_simulation_energy(simulation, &e));
    python_simulation_give(self);
    if (!python_simulation_sound(self, "energies")) return NULL;
    if (!isfinite(e.kinetic + e.strain + e.hourglass)) {
        lar_error error = {.status = LAR_ERROR_UNSTABLE};
        snprintf(error.message, sizeof error.message,
                 "energies: they are no numbers after the last step, in which an element was "
                 "crushed to nothing or turned inside out; the next one ends the run");
        return python_raise(&error);
    }
    return Py_BuildValue("{s:d,s:d,s:d,s:d,s:d,s:d,s:d}", "kinetic", e.kinetic, "strain", e.strain,
                         "hourglass", e.hourglass, "external", e.external, "damping", e.damping,
                         "contact", e.contact, "viscous", e.viscous);
}

static PyObject *contact(PyObject *me, PyObject *nothing) {
    (void)nothing;
    lar_simulation *simulation = python_simulation_look((python_simulation *)me, "contact");
    if (!simulation) return NULL;
    lar_contact_info c;
    lar_simulation_contact(simulation, &c);
    return Py_BuildValue("{s:i,s:d,s:d,s:d,s:K,s:d,s:K,s:K}", "touching", (int)c.touching,
                         "deepest", c.deepest, "deepest_ever", c.deepest_ever, "distance",
                         lar_simulation_contact_distance(simulation), "through",
                         (unsigned long long)c.through, "way", c.way, "searches",
                         (unsigned long long)c.searches, "tested", (unsigned long long)c.tested);
}

/* Every one's force is there twice. */
static PyObject *contact_springs(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_simulation *self = (python_simulation *)me;
    lar_simulation *simulation = python_simulation_take(self, "contact_springs");
    if (!simulation) return NULL;
    const int32_t nodes = lar_model_node_count(self->model->model);
    double(*force)[3] = calloc((size_t)nodes + 1, sizeof *force), all = 0;
    lar_contact_info c;
    lar_error error = {.status = LAR_ERROR_MEMORY};
    lar_status status = force ? LAR_OK : LAR_ERROR_MEMORY;
    lar_simulation_contact(simulation, &c);
    if (!status && c.deepest > 0)
        status = lar_simulation_nodal_forces(simulation, LAR_CAUSE_BODIES, 0, force, &error);
    for (int32_t n = 0; !status && n < nodes; n++)
        all +=
            sqrt(force[n][0] * force[n][0] + force[n][1] * force[n][1] + force[n][2] * force[n][2]);
    free(force);
    python_simulation_give(self);
    return status ? python_raise(&error) : PyFloat_FromDouble(0.25 * all * c.deepest);
}

/* ---- states --------------------------------------------------------------------------------- */

static PyObject *reset(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_simulation *self = (python_simulation *)me;
    lar_simulation *simulation = python_simulation_take(self, "reset");
    if (!simulation) return NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = lar_simulation_reset(simulation, &error));
    if (!status) self->broken = false;
    python_asked_forget(self->asked);
    python_simulation_give(self);
    return python_answer(status, &error);
}

/* To or from a file. */
static PyObject *on_disk(python_simulation *self, PyObject *target, bool save) {
    PyObject *path = python_path(target, save ? "target" : "source");
    const char *bytes = path ? PyBytes_AsString(path) : NULL;
    lar_simulation *simulation = path ? python_simulation_take(self, save ? "save" : "load") : NULL;
    if (!simulation) {
        Py_XDECREF(path);
        return NULL;
    }
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = save ? lar_simulation_save(simulation, bytes, &error)
                                  : lar_simulation_load(simulation, bytes, &error));
    if (!save) python_asked_forget(self->asked);
    if (!save && !status) self->broken = false;
    python_simulation_give(self);
    Py_DECREF(path);
    return python_answer(status, &error);
}

static PyObject *in_memory(python_simulation *self, python_saved *saved, bool save) {
    const char *call = save ? "save" : "load";
    lar_simulation *simulation = python_simulation_look(self, call);
    if (!simulation || !python_saved_fits(saved, simulation, call) ||
        !python_saved_take(saved, save, call))
        return NULL;
    self->busy = true;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = save ? lar_simulation_save_to(simulation, saved->saved, &error)
                                  : lar_simulation_load_from(simulation, saved->saved, &error));
    if (!save && status) python_asked_forget(self->asked);
    if (!save && !status) memcpy(self->asked, saved->asked, sizeof self->asked);
    if (!save && !status) self->broken = false;
    python_saved_give(saved);
    if (!status && save) {
        memcpy(saved->asked, self->asked, sizeof saved->asked);
        saved->step = lar_simulation_steps(simulation);
        saved->time = lar_simulation_time(simulation);
    }
    python_simulation_give(self);
    return status ? python_raise(&error) : (PyObject *)self;
}

static bool is_saved(PyObject *object) {
    return Py_TYPE(object) == python_saved_type;
}

static bool is_path(PyObject *object) {
    return PyUnicode_Check(object) || PyBytes_Check(object) ||
           PyObject_HasAttrString(object, "__fspath__");
}

static PyObject *save(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"target", NULL};
    python_simulation *self = (python_simulation *)me;
    PyObject *target = Py_None;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|O:save", names, &target)) return NULL;
    if (target != Py_None && !is_saved(target) && !is_path(target)) {
        python_refuse_type("target: expected a Saved, or a path, got %R",
                           (PyObject *)Py_TYPE(target));
        return NULL;
    }
    if (target != Py_None && !is_saved(target)) return on_disk(self, target, true);
    if (is_saved(target)) {
        Py_INCREF(target);
    } else {
        lar_simulation *simulation = python_simulation_look(self, "save");
        python_saved *made = simulation ? PyObject_New(python_saved, python_saved_type) : NULL;
        if (!made) return NULL;
        lar_error error;
        *made = (python_saved){.ob_base = made->ob_base, .model = self->model};
        Py_INCREF((PyObject *)self->model);
        lar_simulation_inspect(simulation, &made->of);
        if (lar_saved_create(simulation, &made->saved, &error)) {
            Py_DECREF((PyObject *)made);
            return python_raise(&error);
        }
        target = (PyObject *)made;
    }
    if (in_memory(self, (python_saved *)target, true)) return target;
    Py_DECREF(target);
    return NULL;
}

static PyObject *load(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"source", NULL};
    python_simulation *self = (python_simulation *)me;
    PyObject *source;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O:load", names, &source)) return NULL;
    if (!is_saved(source) && !is_path(source)) {
        python_refuse_type("source: expected a Saved, or the path of a checkpoint, got %R",
                           (PyObject *)Py_TYPE(source));
        return NULL;
    }
    if (!is_saved(source)) return on_disk(self, source, false);
    if (!in_memory(self, (python_saved *)source, false)) return NULL;
    Py_RETURN_NONE;
}

/* What was asked of tools last, for pickles; with an argument it is put back. */
static PyObject *asked(PyObject *me, PyObject *args) {
    python_simulation *self = (python_simulation *)me;
    const char *bytes = NULL;
    Py_ssize_t size = 0;
    if (!PyArg_ParseTuple(args, "|y#:_asked", &bytes, &size) ||
        !python_simulation_look(self, "_asked"))
        return NULL;
    size_t known = (size_t)size < sizeof self->asked ? (size_t)size : sizeof self->asked;
    if (bytes) memcpy(self->asked, bytes, known);
    return PyBytes_FromStringAndSize((const char *)self->asked, sizeof self->asked);
}

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
#define OUT_DOC                                                                                    \
    " float64 [nodes, 3], in the mesh's order. Copied into `out` where given, which asks for no "  \
    "memory, else into a fresh memoryview; numpy.asarray takes that without another copy."
PyMethodDef python_state_methods[] = {
    {"positions", FUNCTION(positions), METH_VARARGS | METH_KEYWORDS,
     "positions($self, out=None)\n--\n\nWhere the nodes are now [m]," OUT_DOC},
    {"displacements", FUNCTION(displacements), METH_VARARGS | METH_KEYWORDS,
     "displacements($self, out=None)\n--\n\nHow far the nodes are from their places at rest "
     "[m]," OUT_DOC},
    {"velocities", FUNCTION(velocities), METH_VARARGS | METH_KEYWORDS,
     "velocities($self, out=None)\n--\n\nVelocities half a step back [m/s]," OUT_DOC},
    {"field", FUNCTION(field), METH_VARARGS | METH_KEYWORDS,
     "field($self, name, out=None)\n--\n\nA value for every node now, float32 [nodes]: "
     "\"displacement\" [m], \"von_mises\" [Pa], \"pressure\" [Pa], \"energy\" [J/m^3], "
     "\"processor\"."},
    {"hash", hash, METH_NOARGS,
     "hash($self)\n--\n\n64 bits over step, displacements and velocities: the same on every grid, "
     "number of threads and instruction set; `lariat run` prints it in hexadecimal."},
    {"energies", energies, METH_NOARGS,
     "energies($self)\n--\n\ndict [J]: kinetic + strain + hourglass + damping + contact + viscous "
     "= external (+ what it began with). As long as some steps. UnstableError when the run has "
     "broken "
     "off: they are not finite then."},
    {"contact", contact, METH_NOARGS,
     "contact($self)\n--\n\ndict: touching (nodes in contact with bodies and planes), deepest [m], "
     "deepest_ever (the largest of all steps since the start) [m], distance (from how far on "
     "bodies push each other) [m], "
     "through (times that a node was pressed through a face: bodies lie in each other, or behind), "
     "way (the farthest that a node went in a step, or a part of one) [m], searches, tested."},
    {"contact_springs", contact_springs, METH_NOARGS,
     "contact_springs($self)\n--\n\nWhat the springs between bodies that touch store at most [J]. "
     "Above a tenth of what the bodies store, energies()['strain'], they give way in place of the "
     "bodies: a smaller time step makes them harder. As long as some steps."},
    {"reset", reset, METH_NOARGS,
     "reset($self)\n--\n\nBack to the state that it was made with, settings too. Added tools stay, "
     "where "
     "they were added;\nload() of a state has the tools that it was saved with."},
    {"save", FUNCTION(save), METH_VARARGS | METH_KEYWORDS,
     "save($self, target=None)\n--\n\nSaves the state: into a fresh Saved, which is returned; "
     "into the Saved that is given, which asks for no memory; or as a checkpoint at a path. "
     "Nodes, tools, settings and what tools felt; a checkpoint lacks the last, and "
     "tool_force is zero until the next step."},
    {"load", FUNCTION(load), METH_VARARGS | METH_KEYWORDS,
     "load($self, source)\n--\n\nTakes up a Saved or a checkpoint at a path: from then on "
     "everything is as if it had never stopped, on any grid. One of another model is refused, with "
     "what differs. What tool_move keeps where it is not said, opening and orientation, a Saved "
     "has as "
     "asked for last; a file has not: they are then what they are, and jaws that tissue keeps open "
     "must be told again to close (opening=0)."},
    {"_asked", asked, METH_VARARGS, NULL},
    {NULL, NULL, 0, NULL}};
