/* Numbers, vectors, texts and poses between Python and the library. */
#include <math.h>

#include "module.h"

/* What was given in place of a number, for a message: a number itself, of all else the class. */
static PyObject *shown(PyObject *source) {
    return PyFloat_Check(source) || PyLong_Check(source) ? source : (PyObject *)Py_TYPE(source);
}

/* Beyond this one step could not be told from the next as a number. */
static const unsigned long long WHOLE_MAX = 1ull << 53;

/* `overflow` says on which side the number is beyond all. */
static bool whole_number(PyObject *source, const char *name, long long *number, int *overflow) {
    PyObject *index = PyNumber_Index(source);
    if (!index) {
        PyErr_Clear();
        return python_refuse_type("%s: expected a whole number, got %R", name, shown(source));
    }
    *number = PyLong_AsLongLongAndOverflow(index, overflow);
    Py_DECREF(index);
    return true;
}

bool python_steps(PyObject *source, const char *name, unsigned long long *steps) {
    int overflow = 0;
    long long number;
    if (!whole_number(source, name, &number, &overflow)) return false;
    *steps = (unsigned long long)number;
    if (overflow < 0 || (!overflow && number < 0))
        return python_refuse("%s: expected a whole number from 0 on, got %R", name, source);
    if (!overflow && *steps <= WHOLE_MAX) return true;
    return python_refuse("%s: expected at most 2^53, got %R", name, source);
}

bool python_int(PyObject *source, const char *name, int *out) {
    int overflow = 0;
    long long number;
    if (!source) return true;
    if (!whole_number(source, name, &number, &overflow)) return false;
    *out = (int)number;
    if (!overflow && number >= INT32_MIN && number <= INT32_MAX) return true;
    return python_refuse("%s: %R is beyond all bounds", name, source);
}

bool python_real(PyObject *source, const char *name, double *out) {
    return !source || python_number(source, name, out);
}

bool python_is_no(PyObject *answer) {
    static const char *const numpy[] = {"bool_", "bool"}; /* before version 2, and since */
    if (answer == Py_True || answer == Py_None) return false;
    if (answer == Py_False) return true;
    PyObject *name = PyObject_GetAttrString((PyObject *)Py_TYPE(answer), "__name__");
    bool is_bool = name && (PyUnicode_CompareWithASCIIString(name, numpy[0]) == 0 ||
                            PyUnicode_CompareWithASCIIString(name, numpy[1]) == 0);
    Py_XDECREF(name);
    int yes = is_bool ? PyObject_IsTrue(answer) : 1;
    PyErr_Clear();
    return yes == 0;
}

bool python_number(PyObject *source, const char *name, double *number) {
    *number = PyFloat_AsDouble(source);
    if (*number == -1.0 && PyErr_Occurred()) {
        PyErr_Clear();
        return python_refuse_type("%s: expected a number, got %R", name, shown(source));
    }
    return isfinite(*number) || python_refuse("%s: expected a finite number, got %R", name, source);
}

/* Texts and bytes are sequences, and no vectors. */
static bool is_list(PyObject *source) {
    return PySequence_Check(source) && !PyUnicode_Check(source) && !PyBytes_Check(source) &&
           !PyByteArray_Check(source);
}

bool python_vector(PyObject *source, const char *name, int count, double *out) {
    PyObject *list = is_list(source) ? PySequence_Tuple(source) : NULL;
    bool ok = list && PyTuple_Size(list) == count;
    for (int i = 0; i < count && ok; i++) {
        out[i] = PyFloat_AsDouble(PyTuple_GetItem(list, i));
        ok = !PyErr_Occurred() && isfinite(out[i]);
    }
    Py_XDECREF(list);
    if (ok) return true;
    PyErr_Clear();
    if (is_list(source))
        return python_refuse("%s: expected %d finite numbers, got %R", name, count, source);
    return python_refuse_type("%s: expected a sequence of %d numbers, got %R", name, count,
                              (PyObject *)Py_TYPE(source));
}

PyObject *python_tuple(const double *value, int count) {
    PyObject *tuple = PyTuple_New(count);
    for (int i = 0; tuple && i < count; i++) {
        PyObject *number = PyFloat_FromDouble(value[i]);
        if (!number || PyTuple_SetItem(tuple, i, number)) Py_CLEAR(tuple);
    }
    return tuple;
}

/* ---- texts ---------------------------------------------------------------------------------- */

/* In place of the UnicodeEncodeError that is set, which does not say what it is about. */
static bool refuse_surrogate(const char *name) {
    PyObject *class, *value, *trace;
    PyErr_Fetch(&class, &value, &trace);
    PyErr_NormalizeException(&class, &value, &trace);
    PyObject *at = PyObject_GetAttrString(value, "start");
    PyObject *text = PyObject_GetAttrString(value, "object");
    PyObject *wrong = at && text ? PyObject_GetItem(text, at) : NULL;
    PyErr_Clear();
    if (wrong)
        python_refuse("%s: character %S of the text, counted from 0, is %R, half of a pair of "
                      "surrogates and no character; leave it out",
                      name, at, wrong);
    else
        python_refuse("%s: there is half of a pair of surrogates in the text; leave it out", name);
    Py_XDECREF(wrong);
    Py_XDECREF(text);
    Py_XDECREF(at);
    Py_XDECREF(trace);
    Py_XDECREF(value);
    Py_XDECREF(class);
    return false;
}

const char *python_text(PyObject *text, const char *name) {
    Py_ssize_t length = 0;
    if (!PyUnicode_Check(text)) {
        python_refuse_type("%s: expected a text, got %R", name, (PyObject *)Py_TYPE(text));
        return NULL;
    }
    const char *utf8 = PyUnicode_AsUTF8AndSize(text, &length);
    if (utf8 && strlen(utf8) == (size_t)length) return utf8;
    if (utf8)
        python_refuse("%s: there is a character 0 in the text", name);
    else if (PyErr_ExceptionMatches(PyExc_UnicodeEncodeError))
        refuse_surrogate(name);
    return NULL;
}

bool python_word(PyObject *source, const char *name, const char **out) {
    return !source || source == Py_None || (*out = python_text(source, name)) != NULL;
}

PyObject *python_path(PyObject *source, const char *name) {
    PyObject *path = NULL;
    if (PyUnicode_FSConverter(source, &path)) {
        if (PyBytes_Size(path) > 0) return path;
        Py_CLEAR(path);
        python_refuse("%s: expected a path, got %R", name, source);
    } else if (PyErr_ExceptionMatches(PyExc_UnicodeEncodeError)) {
        refuse_surrogate(name);
    } else if (PyErr_ExceptionMatches(PyExc_ValueError)) {
        PyErr_Clear();
        python_refuse("%s: there is a character 0 in the path %R", name, source);
    } else if (PyErr_ExceptionMatches(PyExc_TypeError)) {
        PyErr_Clear();
        python_refuse_type("%s: expected a path, got %R", name, (PyObject *)Py_TYPE(source));
    }
    return NULL;
}

/* ---- scenes --------------------------------------------------------------------------------- */

PyObject *python_scene_text(PyObject *scene) {
    if (PyUnicode_Check(scene)) {
        Py_INCREF(scene);
        return scene;
    }
    if (!PyDict_Check(scene)) {
        python_refuse_type("scene: expected a str (YAML) or a dict, got %R",
                           (PyObject *)Py_TYPE(scene));
        return NULL;
    }
    PyObject *module = PyImport_ImportModule("lariat._scene_text");
    PyObject *text = module ? PyObject_CallMethod(module, "text_of", "Os", scene, "scene") : NULL;
    Py_XDECREF(module);
    return text;
}

/* ---- tools ---------------------------------------------------------------------------------- */

bool python_pose(PyObject *position, PyObject *orientation, PyObject *opening,
                 const python_asked *asked, bool turns, const lar_tool_pose *now,
                 lar_tool_pose *pose) {
    const bool known = !turns && !isnan(asked->orientation[0]);
    const double *kept = known ? asked->orientation : now->orientation;
    memcpy(pose->orientation, kept, sizeof pose->orientation);
    pose->opening = isnan(asked->opening) ? now->opening : asked->opening;
    return python_vector(position, "position", 3, pose->position) &&
           (!orientation || orientation == Py_None ||
            python_vector(orientation, "orientation", 4, pose->orientation)) &&
           (!opening || opening == Py_None || python_number(opening, "opening", &pose->opening));
}

void python_asked_set(python_asked *asked, const lar_tool_pose *pose) {
    memcpy(asked->orientation, pose->orientation, sizeof asked->orientation);
    asked->opening = pose->opening;
}

void python_asked_forget(python_asked asked[LAR_TOOLS_MAX]) {
    for (int i = 0; i < LAR_TOOLS_MAX; i++) asked[i].orientation[0] = asked[i].opening = NAN;
}

PyObject *python_pose_dict(const lar_tool_pose *pose) {
    return Py_BuildValue("{s:N,s:N,s:d}", "position", python_tuple(pose->position, 3),
                         "orientation", python_tuple(pose->orientation, 4), "opening",
                         pose->opening);
}

PyObject *python_force_dict(const lar_tool_force *f) {
    return Py_BuildValue("{s:N,s:N,s:i,s:i,s:d,s:d,s:d,s:N,s:d}", "force",
                         python_tuple(f->force, 3), "torque", python_tuple(f->torque, 3),
                         "touching", (int)f->touching, "held", (int)f->held, "limit", f->limit,
                         "depth", f->depth, "apart", f->apart, "limited",
                         PyBool_FromLong(f->limited), "grasp_force", f->grasp_force);
}

PyObject *python_wrench(const lar_tool_force *f) {
    const double wrench[6] = {f->force[0],  f->force[1],  f->force[2],
                              f->torque[0], f->torque[1], f->torque[2]};
    return python_tuple(wrench, 6);
}

static PyObject *touch_dict(const lar_touch *t) {
    static const char *const kind[] = {"pressed", "held", "rubbed"};
    return Py_BuildValue(
        "{s:N,s:N,s:N,s:d,s:s,s:i,s:i,s:(iiii),s:N}", "place", python_tuple(t->place, 3), "normal",
        python_tuple(t->normal, 3), "force", python_tuple(t->force, 3), "depth", t->depth, "kind",
        kind[t->kind], "jaw", (int)t->jaw, "face", (int)t->face, "nodes", (int)t->node[0],
        (int)t->node[1], (int)t->node[2], (int)t->node[3], "weights", python_tuple(t->weight, 4));
}

PyObject *python_touch_list(const lar_touch *touch, int32_t count) {
    PyObject *list = PyList_New(count);
    for (int32_t i = 0; list && i < count; i++) {
        PyObject *dict = touch_dict(&touch[i]);
        if (!dict || PyList_SetItem(list, i, dict)) Py_CLEAR(list);
    }
    return list;
}

static const char *const shape_name[] = {"sphere", "capsule", "grasper", "hand", "none", "rigid"};

PyObject *python_tool_dict(const lar_tool_info *t) {
    return Py_BuildValue("{s:s,s:s,s:d,s:d,s:d,s:d,s:N,s:i}", "name", t->name, "shape",
                         shape_name[t->shape], "radius", t->radius, "length", t->length, "spread",
                         t->spread, "friction", t->friction, "rest", python_pose_dict(&t->rest),
                         "serial", (int)t->serial);
}

/* Scenes have degrees, calls radians: whoever takes the one for the other is told. */
static bool check_spread(const lar_tool_info *info, PyObject *spread) {
    static const double PI = 3.14159265358979323846;
    if (info->shape != LAR_TOOL_GRASPER || (info->spread >= 0 && info->spread < PI)) return true;
    return python_refuse("spread: expected an angle in radians, more than 0 and less than pi (0: "
                         "60 degrees), got %R%s",
                         spread,
                         info->spread > 0 && info->spread < 180
                             ? "; math.radians makes it of degrees, which scenes have"
                             : "");
}

bool python_tool_wanted(PyObject *args, PyObject *keywords, lar_tool_info *info) {
    static char *names[] = {"shape", "radius", "length", "spread", NULL};
    PyObject *word, *radius, *length = NULL, *spread = NULL;
    const char *shape;
    *info = (lar_tool_info){.name = ""};
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "OO|OO:add_tool", names, &word, &radius,
                                     &length, &spread) ||
        !(shape = python_text(word, "shape")) || !python_real(radius, "radius", &info->radius) ||
        !python_real(length, "length", &info->length) ||
        !python_real(spread, "spread", &info->spread))
        return false;
    /* Less, and still too large for the body, the library says what fits. */
    if (info->radius > 1e6 || info->length > 1e6)
        return python_refuse("%s: expected metres, got %R",
                             info->radius > 1e6 ? "radius" : "length",
                             info->radius > 1e6 ? radius : length);
    for (int i = LAR_TOOL_SPHERE; i <= LAR_TOOL_GRASPER; i++)
        if (strcmp(shape, shape_name[i]) == 0) {
            info->shape = (lar_tool_shape)i;
            return check_spread(info, spread);
        }
    return python_refuse("shape: expected \"sphere\", \"capsule\" or \"grasper\", got \"%s\"",
                         shape);
}

/* ---- materials and forces ------------------------------------------------------------------- */

static bool int32_of(PyObject *source, const char *name, int32_t *out) {
    unsigned long long value;
    if (!python_steps(source, name, &value)) return false;
    if (value > INT32_MAX)
        return python_refuse("%s: expected less than 2^31, got %R", name, source);
    *out = (int32_t)value;
    return true;
}

bool python_material(const lar_model *model, PyObject *source, int32_t *index) {
    *index = -1;
    if (!source || source == Py_None) return true;
    if (!PyUnicode_Check(source)) return int32_of(source, "material", index);
    const char *wanted = python_text(source, "material");
    lar_material_info info;
    int32_t count = lar_model_material_count(model);
    for (int32_t i = 0; wanted && i < count; i++) {
        if (lar_model_material(model, i, &info, NULL) || strcmp(info.name, wanted) != 0) continue;
        if (*index >= 0) /* in decks: scenes refuse it */
            return python_refuse("material: %R is the name of %d and of %d; give the number",
                                 source, *index, i);
        *index = i;
    }
    if (*index >= 0) return true;
    return wanted &&
           python_refuse("material: there is none called %R; Model.materials lists them", source);
}

bool python_where(PyObject *where, const char **set, int32_t *node) {
    if (PyUnicode_Check(where))
        *set = python_text(where, "where");
    else if (!PyIndex_Check(where))
        return python_refuse_type("where: expected a node, a whole number from 0 on, or the name "
                                  "of a set of nodes, got %R",
                                  shown(where));
    else if (!int32_of(where, "where", node))
        return false;
    return !PyErr_Occurred();
}

bool python_force_parse(PyObject *args, PyObject *keywords, python_force_call *call) {
    static char *names[] = {"where", "force", NULL};
    PyObject *where, *force = Py_None;
    *call = (python_force_call){.node = -1};
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O|O:set_force", names, &where, &force))
        return false;
    if (!python_where(where, &call->set, &call->node)) return false;
    if (force == Py_None) return true;
    call->force = call->vector;
    return python_vector(force, "force", 3, call->vector);
}
