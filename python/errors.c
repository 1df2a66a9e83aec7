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

/* ---- the library's sentences ---------------------------------------------------------------- */

/* They are written for callers from C. Whole phrases first; of what is left the names of calls. */
static const char *const phrase[][2] = {
    {"create the simulation with options.spares", "make the Simulation with spares="},
    {"options.spares", "spares"},
    {"lar_simulation_save_to and lar_simulation_load_from", "save and load"},
    {"lar_model_set names those", "Model.sets lists those"},
    {"the session (lar_session_...)", "the session"},
    {", and -1 without a force removes all forces that were set",
     "; clear_forces() removes all forces that were set"},
    {", and -1 means all", "; None means all"},
    {"with NULL for the name", "by set_parameter without a name"},
    {"use time_step: auto, a smaller step,",
     "use time_step: auto in the scene and time_step=0 here, a smaller step,"},
    {"name its scene, and go on from it with lariat run SCENE --resume",
     "make a Simulation of its scene and load() it there; as a command: lariat run SCENE --resume"},
    {"name its scene, and play it with lariat replay SCENE",
     "open a Session on its scene and replay() it there; as a command: lariat replay SCENE"},
    {"--grid ", "grid="},
    {"start with --priority 10", "make the Session with priority=10"},
    {"(--scale)", "(scale=)"},
    {"; --fuse makes", "; fuse=True makes"},
    {"--fibres RULE", "fibres=RULE"},
    {"lar_session_options.", ""},
    {"lar_simulation_set_force_on", "set_force"},
    {"lar_simulation_set_support_on", "set_support"},
    {"lar_simulation_set_gravity", "gravity"},
    {"lar_simulation_set_damping", "damping"},
    {"lar_simulation_save_to", "save"},
    {"lar_simulation_load_from", "load"},
    {"lar_model_from_arrays", "Model.from_arrays"},
    {"lar_simulation_", ""},
    {"lar_session_", ""},
    {"lar_model_", "Model."},
    {"lar_meshing_", "Meshing."},
    {"lar_results_", "Results."},
    {"lar_saved_create", "save"},
};

/* In place of the first of *text, which is taken over. NULL: an exception. */
static PyObject *replace(PyObject *text, const char *from, const char *to) {
    PyObject *old = PyUnicode_FromString(from), *new = PyUnicode_FromString(to);
    PyObject *made = old && new ? PyUnicode_Replace(text, old, new, -1) : NULL;
    Py_XDECREF(new);
    Py_XDECREF(old);
    Py_DECREF(text);
    return made;
}

/* A path in the message need not be UTF-8. What looks like a call may be the name of a file. */
PyObject *python_sentence(const char *message) {
    PyObject *text = PyUnicode_DecodeUTF8(message, (Py_ssize_t)strlen(message), "replace");
    for (size_t i = 0; text && i < sizeof phrase / sizeof phrase[0]; i++) {
        const char *at = strstr(message, phrase[i][0]);
        bool named = strncmp(phrase[i][0], "lar_", 4) == 0;
        if (at && (!named || at == message || at[-1] == ' '))
            text = replace(text, phrase[i][0], phrase[i][1]);
    }
    return text;
}

PyObject *python_sentence_of(PyObject *scene, const char *message) {
    PyObject *sentence = python_sentence(message);
    if (!sentence || !scene || scene == Py_None) return sentence;
    PyObject *module = PyImport_ImportModule("lariat._scene_text");
    PyObject *told = module ? PyObject_CallMethod(module, "keyed", "OO", sentence, scene) : NULL;
    Py_XDECREF(module);
    Py_DECREF(sentence);
    return told;
}

static PyObject *raise_sentence(lar_status status, PyObject *sentence) {
    PyObject *class =
        status > LAR_OK && status <= LAR_ERROR_PEER ? class_of_status[status] : error_class;
    if (sentence) PyErr_SetObject(class, sentence);
    Py_XDECREF(sentence);
    return NULL;
}

PyObject *python_raise_of(PyObject *scene, const lar_error *error) {
    return raise_sentence(error->status, python_sentence_of(scene, error->message));
}

PyObject *python_raise(const lar_error *error) {
    return raise_sentence(error->status, python_sentence(error->message));
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
