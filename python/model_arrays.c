/* Model.from_arrays. */

#include "module.h"

PyObject *python_model_from_arrays(PyObject *type, PyObject *args, PyObject *keywords);
PyObject *python_model_wrap(lar_model *model);

typedef struct arrays {
    python_rows nodes, hexahedra, tags, fibres, fibres2, *set_rows;
    lar_array_set *set;
    int32_t sets;
    PyObject *named; /* a copy of the caller's dict: converting numbers may run any code */
} arrays;

static void arrays_free(arrays *a) {
    python_rows_free(&a->nodes);
    python_rows_free(&a->hexahedra);
    python_rows_free(&a->tags);
    python_rows_free(&a->fibres);
    python_rows_free(&a->fibres2);
    for (int32_t i = 0; i < a->sets; i++) python_rows_free(&a->set_rows[i]);
    PyMem_Free(a->set_rows);
    PyMem_Free(a->set);
    Py_XDECREF(a->named);
}

/* A set's value: indices, or a kind and indices. */
static bool take_set(PyObject *value, const char *name, lar_array_set *set, python_rows *rows) {
    char label[96];
    snprintf(label, sizeof label, "sets[\"%.60s\"]", name);
    set->name = name;
    set->kind = "nodes";
    if (PyTuple_Check(value) && PyTuple_Size(value) == 2 &&
        PyUnicode_Check(PyTuple_GetItem(value, 0))) {
        set->kind = python_text(PyTuple_GetItem(value, 0), label);
        value = PyTuple_GetItem(value, 1);
    }
    if (!set->kind || !python_integers(value, label, 0, rows)) return false;
    if (rows->rows > INT32_MAX) return python_refuse("%s: too many", label);
    set->count = (int32_t)rows->rows;
    set->index = rows->data;
    return true;
}

static bool take_sets(PyObject *sets, arrays *a) {
    if (!PyDict_Check(sets))
        return python_refuse_type("sets: expected a dict of names to indices, got %R",
                                  (PyObject *)Py_TYPE(sets));
    a->named = PyDict_Copy(sets);
    if (!a->named) return false;
    size_t count = (size_t)PyDict_Size(a->named);
    a->set = PyMem_Calloc(count + 1, sizeof *a->set);
    a->set_rows = PyMem_Calloc(count + 1, sizeof *a->set_rows);
    if (!a->set || !a->set_rows) return PyErr_NoMemory() != NULL;
    PyObject *key, *value;
    Py_ssize_t at = 0;
    while (PyDict_Next(a->named, &at, &key, &value)) {
        if (!PyUnicode_Check(key))
            return python_refuse_type("sets: expected names as keys, got %R", key);
        const char *name = python_text(key, "sets");
        int32_t i = a->sets++;
        if (!name || !take_set(value, name, &a->set[i], &a->set_rows[i])) return false;
    }
    return true;
}

static bool same_rows(const python_rows *rows, const char *name, Py_ssize_t elements) {
    return !rows->data || rows->rows == elements ||
           python_refuse("%s: expected one row for each of %zd elements, got %zd", name, elements,
                         rows->rows);
}

static bool take_arrays(PyObject *const source[6], arrays *a) {
    return python_doubles(source[0], "nodes", 3, &a->nodes) &&
           python_integers(source[1], "hexahedra", 8, &a->hexahedra) &&
           (source[2] == Py_None || python_integers(source[2], "tags", 0, &a->tags)) &&
           (source[3] == Py_None || take_sets(source[3], a)) &&
           (source[4] == Py_None || python_doubles(source[4], "fibres", 3, &a->fibres)) &&
           (source[5] == Py_None || python_doubles(source[5], "fibres2", 3, &a->fibres2)) &&
           same_rows(&a->tags, "tags", a->hexahedra.rows) &&
           same_rows(&a->fibres, "fibres", a->hexahedra.rows) &&
           same_rows(&a->fibres2, "fibres2", a->hexahedra.rows) &&
           ((a->nodes.rows <= INT32_MAX && a->hexahedra.rows <= INT32_MAX) ||
            python_refuse("nodes, hexahedra: at most 2^31 - 1 of each"));
}

/* Bytes of an array with its format and shape, for pickles; None where there is none. */
static PyObject *pack(const python_rows *rows, const char *format, int columns) {
    if (!rows->data) Py_RETURN_NONE;
    Py_ssize_t item = *format == 'd' ? 8 : 4;
    Py_ssize_t size = rows->rows * item * (columns > 0 ? columns : 1);
    return Py_BuildValue("(y#si)", rows->data, size, format, columns);
}

/* (lariat._from_packed, (nodes, hexahedra, scene, tags, sets, fibres, fibres2)): what was taken,
 * copied, for the caller may change its arrays afterwards. */
static PyObject *recipe_of(const arrays *a, PyObject *scene) {
    PyObject *package = PyImport_ImportModule("lariat"), *sets = PyDict_New(), *recipe = NULL;
    PyObject *maker = package ? PyObject_GetAttrString(package, "_from_packed") : NULL;
    bool ok = maker && sets;
    for (int32_t i = 0; i < a->sets && ok; i++) {
        PyObject *value = Py_BuildValue("(sN)", a->set[i].kind, pack(&a->set_rows[i], "i", 0));
        ok = value && !PyDict_SetItemString(sets, a->set[i].name, value);
        Py_XDECREF(value);
    }
    if (ok)
        recipe = Py_BuildValue("(O(NNONONN))", maker, pack(&a->nodes, "d", 3),
                               pack(&a->hexahedra, "i", 8), scene, pack(&a->tags, "i", 0), sets,
                               pack(&a->fibres, "d", 3), pack(&a->fibres2, "d", 3));
    Py_XDECREF(maker);
    Py_XDECREF(sets);
    Py_XDECREF(package);
    return recipe;
}

static PyObject *make(const arrays *a, PyObject *scene) {
    const lar_mesh_arrays mesh = {.nodes = (int32_t)a->nodes.rows,
                                  .elements = (int32_t)a->hexahedra.rows,
                                  .sets = a->sets,
                                  .position = a->nodes.data,
                                  .element = a->hexahedra.data,
                                  .tag = a->tags.data,
                                  .set = a->set,
                                  .fibre = a->fibres.data,
                                  .fibre2 = a->fibres2.data};
    PyObject *text = scene == Py_None ? scene : python_scene_text(scene);
    const char *utf8 = text && text != Py_None ? python_text(text, "scene") : NULL;
    if (!text || (text != Py_None && !utf8)) {
        if (text != Py_None) Py_XDECREF(text);
        return NULL;
    }
    lar_model *model = NULL;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = lar_model_from_arrays(&mesh, utf8, &model, &error));
    python_model *self = status ? NULL : (python_model *)python_model_wrap(model);
    if (self && !(self->recipe = recipe_of(a, text))) Py_CLEAR(self);
    if (status) python_raise_of(text, &error);
    if (text != Py_None) Py_DECREF(text);
    return (PyObject *)self;
}

PyObject *python_model_from_arrays(PyObject *type, PyObject *args, PyObject *keywords) {
    static char *names[] = {"nodes", "hexahedra", "scene",   "tags",
                            "sets",  "fibres",    "fibres2", NULL};
    PyObject *scene = Py_None, *source[6] = {NULL, NULL, Py_None, Py_None, Py_None, Py_None};
    arrays a = {.set = NULL};
    (void)type;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "OO|O$OOOO:from_arrays", names, &source[0],
                                     &source[1], &scene, &source[2], &source[3], &source[4],
                                     &source[5]))
        return NULL;
    PyObject *model = take_arrays(source, &a) ? make(&a, scene) : NULL;
    arrays_free(&a);
    return model;
}
