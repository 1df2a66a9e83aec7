/* class View: a session in the browser. */
#include "module.h"

PyTypeObject *python_view_type;

void python_view_shut(python_view *view) {
    lar_server *server = view->server;
    view->server = NULL;
    view->session->view = NULL;
    PYTHON_UNLOCKED(lar_server_close(server));
}

static PyObject *view_close(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_view *self = (python_view *)me;
    if (self->server && python_session_look(self->session, "close")) python_view_shut(self);
    if (PyErr_Occurred()) return NULL;
    Py_RETURN_NONE;
}

static void view_dealloc(PyObject *me) {
    python_view *self = (python_view *)me;
    if (self->server && self->session->generation == python_generation) {
        PyObject *kind, *value, *trace;
        PyErr_Fetch(&kind, &value, &trace);
        python_view_shut(self);
        PyErr_Restore(kind, value, trace);
    }
    Py_XDECREF((PyObject *)self->session);
    python_object_free(me);
}

/* The viewer's page where wheels have it: beside the package. A new reference, or NULL. */
static PyObject *page_folder(void) {
    PyObject *package = PyImport_ImportModule("lariat");
    PyObject *folder = package ? PyObject_GetAttrString(package, "_viewer_folder") : NULL;
    Py_XDECREF(package);
    if (!folder) PyErr_Clear();
    if (folder && !PyUnicode_Check(folder)) Py_CLEAR(folder);
    return folder;
}

/* A browser that does not open is no error: the address is there. */
static void show(const char *url) {
    PyObject *browser = PyImport_ImportModule("webbrowser");
    PyObject *answer = browser ? PyObject_CallMethod(browser, "open", "s", url) : NULL;
    Py_XDECREF(answer);
    Py_XDECREF(browser);
    PyErr_Clear();
}

static PyObject *open_view(python_session *session, const lar_server_options *options, int shown) {
    lar_error error;
    lar_status status;
    lar_server *server = NULL;
    python_view *self = PyObject_New(python_view, python_view_type);
    if (!self) return NULL;
    Py_INCREF((PyObject *)session);
    *self = (python_view){.ob_base = self->ob_base, .session = session};
    lar_session *taken = python_session_take(session, "view");
    if (taken) {
        PYTHON_UNLOCKED(status = lar_server_open(taken, session->simulation->model->model, options,
                                                 &server, &error));
        python_session_give(session);
        if (status) python_raise(&error);
    }
    self->server = server;
    if (!server) {
        Py_DECREF((PyObject *)self);
        return NULL;
    }
    session->view = self;
    if (shown) show(lar_server_url(server));
    return (PyObject *)self;
}

PyObject *python_view_open(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"open",   "address", "port",        "token", "watch_token",
                            "folder", "scan",    "save_folder", NULL};
    python_session *session = (python_session *)me;
    PyObject *port = NULL, *word[6] = {NULL};
    lar_server_options o = {.port = 0};
    int shown = 1;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|$pOOOOOOO:view", names, &shown, &word[0],
                                     &port, &word[1], &word[2], &word[3], &word[4], &word[5]) ||
        !python_word(word[0], "address", &o.address) || !python_int(port, "port", &o.port) ||
        !python_word(word[1], "token", &o.token) ||
        !python_word(word[2], "watch_token", &o.watch_token) ||
        !python_word(word[3], "folder", &o.folder) || !python_word(word[4], "scan", &o.scan) ||
        !python_word(word[5], "save_folder", &o.save_folder) ||
        !python_session_look(session, "view"))
        return NULL;
    if (session->view) {
        PyErr_Format(python_error_state, "view: the session is shown at %s; close that view first",
                     lar_server_url(session->view->server));
        return NULL;
    }
    PyObject *folder = o.folder ? NULL : page_folder();
    if (folder) o.folder = PyUnicode_AsUTF8AndSize(folder, NULL);
    PyObject *view = open_view(session, &o, shown);
    Py_XDECREF(folder);
    return view;
}

static PyObject *get_url(PyObject *me, void *unused) {
    (void)unused;
    return PyUnicode_FromString(lar_server_url(((python_view *)me)->server));
}
static PyObject *get_watch_url(PyObject *me, void *unused) {
    (void)unused;
    return PyUnicode_FromString(lar_server_watch_url(((python_view *)me)->server));
}
static PyObject *get_viewers(PyObject *me, void *unused) {
    (void)unused;
    return PyLong_FromLong(lar_server_viewers(((python_view *)me)->server));
}

static PyObject *view_repr(PyObject *me) {
    python_view *self = (python_view *)me;
    return PyUnicode_FromFormat("<lariat.View %s>",
                                self->server ? lar_server_url(self->server) : "closed");
}

static PyObject *view_html(PyObject *me, PyObject *nothing) {
    (void)nothing;
    python_view *self = (python_view *)me;
    if (!self->server) Py_RETURN_NONE;
    return PyUnicode_FromFormat(
        "<iframe src=\"%s\" width=\"100%%\" height=\"600\" style=\"border: 0\"></iframe>",
        lar_server_url(self->server));
}

static PyObject *view_enter(PyObject *me, PyObject *nothing) {
    (void)nothing;
    Py_INCREF(me);
    return me;
}
static PyObject *view_exit(PyObject *me, PyObject *args) {
    (void)args;
    return view_close(me, NULL);
}

static PyGetSetDef view_properties[] = {
    {"url", get_url, NULL,
     "Where it is, with the token behind where there is one; \"\" once closed.", NULL},
    {"watch_url", get_watch_url, NULL, "The address for those who may only watch; \"\".", NULL},
    {"viewers", get_viewers, NULL, "How many are connected now.", NULL},
    {NULL, NULL, NULL, NULL, NULL}};
static PyMethodDef view_methods[] = {
    {"close", view_close, METH_NOARGS, "close($self)\n--\n\nEnds the server; the session goes on."},
    {"_repr_html_", view_html, METH_NOARGS, "For notebooks: the viewer in the cell."},
    {"__enter__", view_enter, METH_NOARGS, NULL},
    {"__exit__", view_exit, METH_VARARGS, NULL},
    {NULL, NULL, 0, NULL}};
static PyType_Slot view_slots[] = {
    {Py_tp_doc,
     "A session in the browser; Session.view makes it. It ends when it is closed, when the "
     "session is, and when nobody keeps it."},
    {Py_tp_dealloc, view_dealloc},
    {Py_tp_repr, view_repr},
    {Py_tp_methods, view_methods},
    {Py_tp_getset, view_properties},
    {0, NULL}};
static PyType_Spec view_spec = {.name = "lariat.View",
                                .basicsize = sizeof(python_view),
                                .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                                .slots = view_slots};

bool python_view_add(PyObject *module) {
    python_view_type = python_type_add(module, &view_spec, true);
    return python_view_type != NULL;
}
