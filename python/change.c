/* Gravity, damping, stiffness, parameters, activation, forces on nodes and supports, of a
 * simulation and of a session: the same words for both, because the library has the same calls for
 * both. */
#include "module.h"

/* A number for each material: the library's calls. */
typedef lar_status set_for_material(void *it, int32_t material, double value, lar_error *error);
typedef double of_material(const void *it, int32_t material);

/* What a class has: how it is taken, and the library's calls with a plain pointer. */
typedef struct changes {
    void *(*take)(PyObject *me, const char *call);
    void *(*look)(PyObject *me, const char *call);
    void (*give)(PyObject *me);
    const lar_model *(*model)(PyObject *me);
    lar_status (*set_gravity)(void *it, const double gravity[3], lar_error *error);
    lar_status (*set_damping)(void *it, double damping, lar_error *error);
    set_for_material *set_stiffness, *activate;
    lar_status (*set_parameter)(void *it, int32_t material, const char *name, double value,
                                lar_error *error);
    lar_status (*set_force)(void *it, int32_t node, const double force[3], lar_error *error);
    lar_status (*set_force_on)(void *it, const char *set, const double force[3], lar_error *error);
    lar_status (*set_support)(void *it, int32_t node, unsigned axes, int held, lar_error *error);
    lar_status (*set_support_on)(void *it, const char *set, unsigned axes, int held,
                                 lar_error *error);
    void (*gravity)(const void *it, double gravity[3]);
    double (*damping)(const void *it);
    of_material *stiffness, *activation;
} changes;

/* What a session's run has come to the library finds out, between two ticks. */
static lar_session *python_session_take_sound(python_session *self, const char *call) {
    return python_session_take(self, call);
}

/* ---- the two of them ------------------------------------------------------------------------ */

#define ROWS(kind)                                                                                 \
    static lar_status kind##_set_gravity(void *it, const double gravity[3], lar_error *error) {    \
        return lar_##kind##_set_gravity(it, gravity, error);                                       \
    }                                                                                              \
    static lar_status kind##_set_damping(void *it, double damping, lar_error *error) {             \
        return lar_##kind##_set_damping(it, damping, error);                                       \
    }                                                                                              \
    static lar_status kind##_set_stiffness(void *it, int32_t material, double factor,              \
                                           lar_error *error) {                                     \
        return lar_##kind##_set_stiffness(it, material, factor, error);                            \
    }                                                                                              \
    static lar_status kind##_activate(void *it, int32_t material, double value,                    \
                                      lar_error *error) {                                          \
        return lar_##kind##_activate(it, material, value, error);                                  \
    }                                                                                              \
    static lar_status kind##_set_parameter(void *it, int32_t material, const char *name,           \
                                           double value, lar_error *error) {                       \
        return lar_##kind##_set_parameter(it, material, name, value, error);                       \
    }                                                                                              \
    static lar_status kind##_set_force(void *it, int32_t node, const double force[3],              \
                                       lar_error *error) {                                         \
        return lar_##kind##_set_force(it, node, force, error);                                     \
    }                                                                                              \
    static lar_status kind##_set_force_on(void *it, const char *set, const double force[3],        \
                                          lar_error *error) {                                      \
        return lar_##kind##_set_force_on(it, set, force, error);                                   \
    }                                                                                              \
    static lar_status kind##_set_support(void *it, int32_t node, unsigned axes, int held,          \
                                         lar_error *error) {                                       \
        return lar_##kind##_set_support(it, node, axes, held, error);                              \
    }                                                                                              \
    static lar_status kind##_set_support_on(void *it, const char *set, unsigned axes, int held,    \
                                            lar_error *error) {                                    \
        return lar_##kind##_set_support_on(it, set, axes, held, error);                            \
    }                                                                                              \
    static void kind##_gravity(const void *it, double gravity[3]) {                                \
        lar_##kind##_gravity(it, gravity);                                                         \
    }                                                                                              \
    static double kind##_damping(const void *it) {                                                 \
        return lar_##kind##_damping(it);                                                           \
    }                                                                                              \
    static double kind##_stiffness(const void *it, int32_t material) {                             \
        return lar_##kind##_stiffness(it, material);                                               \
    }                                                                                              \
    static double kind##_activation(const void *it, int32_t material) {                            \
        return lar_##kind##_activation(it, material);                                              \
    }                                                                                              \
    static void *kind##_take(PyObject *me, const char *call) {                                     \
        return python_##kind##_take_sound((python_##kind *)me, call);                              \
    }                                                                                              \
    static void *kind##_look(PyObject *me, const char *call) {                                     \
        return python_##kind##_look((python_##kind *)me, call);                                    \
    }                                                                                              \
    static void kind##_give(PyObject *me) {                                                        \
        python_##kind##_give((python_##kind *)me);                                                 \
    }                                                                                              \
    static const changes kind##_changes = {                                                        \
        kind##_take,           kind##_look,        kind##_give,          kind##_model,             \
        kind##_set_gravity,    kind##_set_damping, kind##_set_stiffness, kind##_activate,          \
        kind##_set_parameter,  kind##_set_force,   kind##_set_force_on,  kind##_set_support,       \
        kind##_set_support_on, kind##_gravity,     kind##_damping,       kind##_stiffness,         \
        kind##_activation};

static const lar_model *simulation_model(PyObject *me) {
    return ((python_simulation *)me)->model->model;
}
static const lar_model *session_model(PyObject *me) {
    return ((python_session *)me)->simulation->model->model;
}
ROWS(simulation)
ROWS(session)

static const changes *changes_of(PyObject *me) {
    return Py_TYPE(me) == python_session_type ? &session_changes : &simulation_changes;
}

/* Ends a call that took `me`. */
static PyObject *done(PyObject *me, const changes *c, lar_status status, const lar_error *error) {
    c->give(me);
    return python_answer(status, error);
}

/* ---- the calls ------------------------------------------------------------------------------ */

static int assign_gravity(PyObject *me, PyObject *value, void *unused) {
    (void)unused;
    const changes *c = changes_of(me);
    double gravity[3];
    bool given = value != Py_None;
    if (!value) {
        python_refuse_type("gravity: it cannot be deleted; None is the model's again");
        return -1;
    }
    if (given && !python_vector(value, "gravity", 3, gravity)) return -1;
    void *it = c->take(me, "gravity");
    if (!it) return -1;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = c->set_gravity(it, given ? gravity : NULL, &error));
    PyObject *answer = done(me, c, status, &error);
    Py_XDECREF(answer);
    return answer ? 0 : -1;
}

static int assign_damping(PyObject *me, PyObject *value, void *unused) {
    (void)unused;
    const changes *c = changes_of(me);
    double damping;
    if (!value) {
        python_refuse_type("damping: it cannot be deleted");
        return -1;
    }
    if (!python_number(value, "damping", &damping)) return -1;
    void *it = c->take(me, "damping");
    if (!it) return -1;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = c->set_damping(it, damping, &error));
    PyObject *answer = done(me, c, status, &error);
    Py_XDECREF(answer);
    return answer ? 0 : -1;
}

static PyObject *get_gravity(PyObject *me, void *unused) {
    (void)unused;
    double gravity[3];
    void *it = changes_of(me)->look(me, "gravity");
    if (!it) return NULL;
    changes_of(me)->gravity(it, gravity);
    return python_tuple(gravity, 3);
}

static PyObject *get_damping(PyObject *me, void *unused) {
    (void)unused;
    void *it = changes_of(me)->look(me, "damping");
    return it ? PyFloat_FromDouble(changes_of(me)->damping(it)) : NULL;
}

/* `call` (number, material=None), the number called `name`. */
static PyObject *set_number(PyObject *me, PyObject *args, PyObject *keywords, const char *call,
                            char *name, set_for_material *set) {
    char *names[] = {name, "material", NULL};
    const changes *c = changes_of(me);
    PyObject *value, *material = Py_None;
    double number;
    int32_t index;
    char format[32];
    snprintf(format, sizeof format, "O|O:%s", call);
    if (!PyArg_ParseTupleAndKeywords(args, keywords, format, names, &value, &material) ||
        !python_number(value, name, &number) || !python_material(c->model(me), material, &index))
        return NULL;
    void *it = c->take(me, call);
    if (!it) return NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = set(it, index, number, &error));
    return done(me, c, status, &error);
}

static PyObject *set_stiffness(PyObject *me, PyObject *args, PyObject *keywords) {
    return set_number(me, args, keywords, "set_stiffness", "factor", changes_of(me)->set_stiffness);
}

static PyObject *activate(PyObject *me, PyObject *args, PyObject *keywords) {
    return set_number(me, args, keywords, "activate", "value", changes_of(me)->activate);
}

/* The index of `material`, which one has to be; false: an exception. */
static bool one_material(PyObject *me, PyObject *material, int32_t *index) {
    const lar_model *model = changes_of(me)->model(me);
    if (!python_material(model, material, index)) return false;
    if (*index >= 0 && *index < lar_model_material_count(model)) return true;
    return python_refuse("material: there is no material %R; the model has %d, counted from 0",
                         material, (int)lar_model_material_count(model));
}

static PyObject *set_parameter(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"material", "name", "value", NULL};
    const changes *c = changes_of(me);
    PyObject *material, *word = NULL, *value = Py_None;
    const char *name = NULL;
    double number = 0;
    int32_t index;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O|OO:set_parameter", names, &material, &word,
                                     &value) ||
        !python_word(word, "name", &name) || !one_material(me, material, &index))
        return NULL;
    if ((name != NULL) != (value != Py_None)) {
        python_refuse("set_parameter: expected a name and a value, or neither");
        return NULL;
    }
    if (name && !python_number(value, "value", &number)) return NULL;
    void *it = c->take(me, "set_parameter");
    if (!it) return NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = c->set_parameter(it, index, name, number, &error));
    return done(me, c, status, &error);
}

static PyObject *parameter(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"material", "name", NULL};
    PyObject *material, *word;
    const char *name;
    int32_t index;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "OO:parameter", names, &material, &word) ||
        !(name = python_text(word, "name")) || !one_material(me, material, &index))
        return NULL;
    lar_simulation *simulation = python_simulation_look((python_simulation *)me, "parameter");
    if (!simulation) return NULL;
    double value = lar_simulation_parameter(simulation, index, name);
    if (!isnan(value)) return PyFloat_FromDouble(value);
    python_refuse("parameter: the material has no parameter %R", word);
    return NULL;
}

/* `call` (material). */
static PyObject *get_number(PyObject *me, PyObject *args, PyObject *keywords, const char *call,
                            of_material *get) {
    static char *names[] = {"material", NULL};
    const changes *c = changes_of(me);
    PyObject *material;
    int32_t index;
    char format[32];
    snprintf(format, sizeof format, "O:%s", call);
    if (!PyArg_ParseTupleAndKeywords(args, keywords, format, names, &material) ||
        !one_material(me, material, &index))
        return NULL;
    void *it = c->look(me, call);
    return it ? PyFloat_FromDouble(get(it, index)) : NULL;
}

static PyObject *stiffness(PyObject *me, PyObject *args, PyObject *keywords) {
    return get_number(me, args, keywords, "stiffness", changes_of(me)->stiffness);
}

static PyObject *activation(PyObject *me, PyObject *args, PyObject *keywords) {
    return get_number(me, args, keywords, "activation", changes_of(me)->activation);
}

static PyObject *set_force(PyObject *me, PyObject *args, PyObject *keywords) {
    const changes *c = changes_of(me);
    python_force_call call;
    if (!python_force_parse(args, keywords, &call)) return NULL;
    void *it = c->take(me, "set_force");
    if (!it) return NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = call.set ? c->set_force_on(it, call.set, call.force, &error)
                                      : c->set_force(it, call.node, call.force, &error));
    return done(me, c, status, &error);
}

static PyObject *clear_forces(PyObject *me, PyObject *nothing) {
    (void)nothing;
    const changes *c = changes_of(me);
    void *it = c->take(me, "clear_forces");
    if (!it) return NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = c->set_force(it, -1, NULL, &error));
    return done(me, c, status, &error);
}

/* The axes that a word of x, y and z names; 0: it is none. */
static unsigned axes_of(const char *word) {
    unsigned axes = 0;
    for (; *word; word++) {
        if (*word < 'x' || *word > 'z' || axes & 1u << (*word - 'x')) return 0;
        axes |= 1u << (*word - 'x');
    }
    return axes;
}

static PyObject *set_support(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"where", "held", "axes", NULL};
    const changes *c = changes_of(me);
    PyObject *where, *letters = NULL;
    const char *word = "xyz", *set = NULL;
    int32_t node = -1;
    int held = 1;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O|pO:set_support", names, &where, &held,
                                     &letters) ||
        (letters && !(word = python_text(letters, "axes"))) || !python_where(where, &set, &node))
        return NULL;
    unsigned axes = axes_of(word);
    if (!axes) {
        python_refuse("axes: '%s' is none of 'x', 'y', 'z', 'xy', ..., 'xyz'", word);
        return NULL;
    }
    void *it = c->take(me, "set_support");
    if (!it) return NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = set ? c->set_support_on(it, set, axes, held, &error)
                                 : c->set_support(it, node, axes, held, &error));
    return done(me, c, status, &error);
}

/* The simulation of a `call` (node), and that; NULL: an exception. */
static lar_simulation *of_node(PyObject *me, PyObject *args, PyObject *keywords, const char *call,
                               int *node) {
    static char *names[] = {"node", NULL};
    PyObject *source;
    char format[32];
    snprintf(format, sizeof format, "O:%s", call);
    if (!PyArg_ParseTupleAndKeywords(args, keywords, format, names, &source) ||
        !python_int(source, "node", node))
        return NULL;
    lar_simulation *simulation = python_simulation_look((python_simulation *)me, call);
    const int count = lar_model_node_count(simulation_model(me));
    if (!simulation || (*node >= 0 && *node < count)) return simulation;
    python_refuse("node: there is no node %R; the model has %d, counted from 0", source, count);
    return NULL;
}

static PyObject *support(PyObject *me, PyObject *args, PyObject *keywords) {
    int node, count = 0;
    char word[4];
    lar_simulation *simulation = of_node(me, args, keywords, "support", &node);
    if (!simulation) return NULL;
    for (int i = 0; i < 3; i++)
        if (lar_simulation_support(simulation, node) >> i & 1) word[count++] = (char)('x' + i);
    return PyUnicode_FromStringAndSize(word, count);
}

static PyObject *force(PyObject *me, PyObject *args, PyObject *keywords) {
    int node;
    double out[3];
    lar_simulation *simulation = of_node(me, args, keywords, "force", &node);
    if (!simulation) return NULL;
    lar_simulation_force(simulation, node, out);
    return python_tuple(out, 3);
}

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
#define SHARED_METHODS                                                                             \
    {"set_stiffness", FUNCTION(set_stiffness), METH_VARARGS | METH_KEYWORDS,                       \
     "set_stiffness($self, factor, material=None)\n--\n\nHow many times as stiff a material is "   \
     "as "                                                                                         \
     "the model says, 0.1 to 4; by index or name, None: all. While one is stiffer, steps may be "  \
     "divided."},                                                                                  \
        {"stiffness", FUNCTION(stiffness), METH_VARARGS | METH_KEYWORDS,                           \
         "stiffness($self, material)\n--\n\nThat factor now; material by index or name."},         \
        {"set_parameter", FUNCTION(set_parameter), METH_VARARGS | METH_KEYWORDS,                   \
         "set_parameter($self, material, name=None, value=None)\n--\n\nA parameter of a "          \
         "material's law, as scenes call it ('shear_modulus', 'c1'), or of its fibres "            \
         "('fibres.ksi'), in Pa where it has a unit; material by index or name. Without a name: "  \
         "all are the model's again. What would make steps too long is refused."},                 \
        {"activate", FUNCTION(activate), METH_VARARGS | METH_KEYWORDS,                             \
         "activate($self, value, material=None)\n--\n\nHow active a material with active stress "  \
         "is, 0 to 1, times what its curve or wave says; by index or name, None: all that have "   \
         "one. It starts at 1."},                                                                  \
        {"activation", FUNCTION(activation), METH_VARARGS | METH_KEYWORDS,                         \
         "activation($self, material)\n--\n\nWhat was set, without curve and wave; material by "   \
         "index or name."},                                                                        \
        {"set_force", FUNCTION(set_force), METH_VARARGS | METH_KEYWORDS,                           \
         "set_force($self, where, force=None)\n--\n\nA constant force [N], three numbers, on a "   \
         "node "                                                                                   \
         "(an int), or on every node of a set (its name), so much on each; None: none any more. "  \
         "128 "                                                                                    \
         "can be set at a time."},                                                                 \
        {"set_support", FUNCTION(set_support), METH_VARARGS | METH_KEYWORDS,                       \
         "set_support($self, where, held=True, axes='xyz')\n--\n\nHolds a node (an int), or "      \
         "every node of a set (its name), where it is, on these axes, as a clamp or a stitch "     \
         "does; held=False: releases it, also from what the model fixes or moves. Of what is "     \
         "said of an axis the last counts. 128 can be set at a time."},                            \
    {                                                                                              \
        "clear_forces", clear_forces, METH_NOARGS,                                                 \
            "clear_forces($self)\n--\n\nAll forces that were set are gone."                        \
    }

PyMethodDef python_change_methods[] = {
    SHARED_METHODS,
    {"parameter", FUNCTION(parameter), METH_VARARGS | METH_KEYWORDS,
     "parameter($self, material, name)\n--\n\nThat parameter now, without stiffness. One that "
     "the material does not have is refused."},
    {"force", FUNCTION(force), METH_VARARGS | METH_KEYWORDS,
     "force($self, node)\n--\n\nWhat was set on a node and on sets that it is in, together [N], a "
     "tuple."},
    {"support", FUNCTION(support), METH_VARARGS | METH_KEYWORDS,
     "support($self, node)\n--\n\nThe axes that hold or move a node now, by the model or by what "
     "was set: 'xyz', 'z', '', ..."},
    {NULL, NULL, 0, NULL}};
PyMethodDef python_session_change_methods[] = {SHARED_METHODS, {NULL, NULL, 0, NULL}};

#define SHARED_PROPERTIES                                                                          \
    {"gravity", get_gravity, assign_gravity,                                                       \
     "Gravity [m/s^2], three numbers. Can be set, at most 1000 long; None: as the model says.",    \
     NULL},                                                                                        \
    {                                                                                              \
        "damping", get_damping, assign_damping,                                                    \
            "Damping in proportion to mass [1/s]. Can be set, 0 or more.", NULL                    \
    }

PyGetSetDef python_change_properties[] = {SHARED_PROPERTIES, {NULL, NULL, NULL, NULL, NULL}};
PyGetSetDef python_session_change_properties[] = {SHARED_PROPERTIES,
                                                  {NULL, NULL, NULL, NULL, NULL}};
