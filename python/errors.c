/* What the library says, as exceptions. Each class is also the one that Python's users expect. */
#include <stdarg.h>

#include "module.h"

PyObject *python_error_argument, *python_error_state;
static PyObject *error_class, *class_of_status[LAR_ERROR_PEER + 1];

static const struct {
    lar_status status;
    const char *name, *word, *doc;
    PyObject **base;
} table[] = {{LAR_ERROR_ARGUMENT, "ArgumentError", "argument", "An invalid argument of a call.",
              &PyExc_ValueError},
             {LAR_ERROR_IO, "FileError", "io", "A file or folder that cannot be read or written.",
              &PyExc_OSError},
             {LAR_ERROR_FORMAT, "FormatError", "format",
              "A file that is damaged or breaks its format.", &PyExc_ValueError},
             {LAR_ERROR_MODEL, "ModelError", "model", "A readable model that cannot be simulated.",
              &PyExc_ValueError},
             {LAR_ERROR_UNSUPPORTED, "UnsupportedError", "unsupported",
              "A valid request that Lariat does not support.", &PyExc_NotImplementedError},
             {LAR_ERROR_MEMORY, "OutOfMemoryError", "memory", "The system refuses memory.",
              &PyExc_MemoryError},
             {LAR_ERROR_UNSTABLE, "UnstableError", "unstable",
              "A run that became unstable: its results mean nothing.", &PyExc_ArithmeticError},
             {LAR_ERROR_PEER, "PeerError", "peer",
              "Another processor, or an answer, that is lost, silent or late.",
              &PyExc_RuntimeError}};

/* A subclass of lariat.Error and of `base`. */
static PyObject *add_class(PyObject *module, const char *name, const char *word, const char *doc,
                           PyObject *base) {
    char path[64];
    snprintf(path, sizeof path, "lariat.%s", name);
    PyObject *bases = base ? PyTuple_Pack(2, error_class, base) : NULL;
    PyObject *members = Py_BuildValue("{s:s}", "status", word);
    PyObject *made =
        members && (bases || !base) ? PyErr_NewExceptionWithDoc(path, doc, bases, members) : NULL;
    Py_XDECREF(bases);
    Py_XDECREF(members);
    if (made && PyModule_AddObjectRef(module, name, made) < 0) Py_CLEAR(made);
    return made;
}

bool python_errors_add(PyObject *module) {
    error_class =
        add_class(module, "Error", "",
                  "What Lariat refuses or cannot do; `status` is the kind in a word.", NULL);
    if (!error_class) return false;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        PyObject *made =
            add_class(module, table[i].name, table[i].word, table[i].doc, *table[i].base);
        if (!made) return false;
        class_of_status[table[i].status] = made;
    }
    python_error_argument = class_of_status[LAR_ERROR_ARGUMENT];
    python_error_state =
        add_class(module, "StateError", "state",
                  "An object that is closed, in use by another thread, or of another process.",
                  PyExc_RuntimeError);
    return python_error_state != NULL;
}

PyObject *python_raise(const lar_error *error) {
    PyObject *class = error->status > LAR_OK && error->status <= LAR_ERROR_PEER
                          ? class_of_status[error->status]
                          : error_class;
    /* A path in the message need not be UTF-8. */
    PyObject *message =
        PyUnicode_DecodeUTF8(error->message, (Py_ssize_t)strlen(error->message), "replace");
    if (message) PyErr_SetObject(class, message);
    Py_XDECREF(message);
    return NULL;
}

PyObject *python_answer(lar_status status, const lar_error *error) {
    if (status) return python_raise(error);
    Py_RETURN_NONE;
}

static bool refuse(PyObject *class, const char *format, va_list list) {
    PyObject *message = PyUnicode_FromFormatV(format, list);
    if (message) PyErr_SetObject(class, message);
    Py_XDECREF(message);
    return false;
}

bool python_refuse(const char *format, ...) {
    va_list list;
    va_start(list, format);
    refuse(python_error_argument, format, list);
    va_end(list);
    return false;
}

bool python_refuse_type(const char *format, ...) {
    va_list list;
    va_start(list, format);
    refuse(PyExc_TypeError, format, list);
    va_end(list);
    return false;
}
