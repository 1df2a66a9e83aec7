/* Arrays by the buffer protocol: out as memoryviews, which numpy takes without a copy, and in from
 * whatever exports one. */
#include <limits.h>
#include <math.h>

#include "module.h"

PyTypeObject *python_array_type;

/* The exporter behind a memoryview. */
typedef struct python_array {
    PyObject_HEAD PyObject *owner; /* of the memory; NULL: it is in `own` */
    void *own;
    const void *data;
    char format[2];
    int dimensions;
    Py_ssize_t item, shape[3], strides[3];
} python_array;

static Py_ssize_t item_of(char format) {
    return format == 'd' ? 8 : format == 'H' ? 2 : 4;
}

static int array_getbuffer(PyObject *me, Py_buffer *view, int flags) {
    python_array *self = (python_array *)me;
    view->obj = NULL;
    if ((flags & PyBUF_WRITABLE) && self->owner) {
        PyErr_SetString(PyExc_BufferError, "this memory is the library's and read only; copy it");
        return -1;
    }
    if ((flags & PyBUF_F_CONTIGUOUS) == PyBUF_F_CONTIGUOUS && self->dimensions > 1) {
        PyErr_SetString(PyExc_BufferError, "this array is stored by rows");
        return -1;
    }
    view->buf = (void *)(uintptr_t)self->data;
    view->len = self->shape[0] * self->strides[0];
    view->itemsize = self->item;
    view->readonly = self->owner != NULL;
    view->ndim = self->dimensions;
    view->format = flags & PyBUF_FORMAT ? self->format : NULL;
    view->shape = flags & PyBUF_ND ? self->shape : NULL;
    view->strides = (flags & PyBUF_STRIDES) == PyBUF_STRIDES ? self->strides : NULL;
    view->suboffsets = NULL;
    view->internal = NULL;
    Py_INCREF(me);
    view->obj = me;
    return 0;
}

static void array_dealloc(PyObject *me) {
    python_array *self = (python_array *)me;
    Py_XDECREF(self->owner);
    free(self->own);
    python_object_free(me);
}

static PyType_Slot array_slots[] = {
    {Py_bf_getbuffer, array_getbuffer}, {Py_tp_dealloc, array_dealloc}, {0, NULL}};
static PyType_Spec array_spec = {.name = "lariat._Array",
                                 .basicsize = sizeof(python_array),
                                 .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                                 .slots = array_slots};

bool python_array_add(PyObject *module) {
    python_array_type = python_type_add(module, &array_spec, false);
    return python_array_type != NULL;
}

static python_array *array_of(PyObject *owner, const void *data, char format, int dimensions,
                              const Py_ssize_t *shape) {
    python_array *self = PyObject_New(python_array, python_array_type);
    if (!self) return NULL;
    Py_XINCREF(owner);
    self->owner = owner;
    self->own = NULL;
    self->data = data ? data : "";
    self->format[0] = format;
    self->format[1] = 0;
    self->item = item_of(format);
    self->dimensions = dimensions;
    Py_ssize_t stride = self->item;
    for (int i = dimensions; i-- > 0; stride *= shape[i]) {
        self->shape[i] = shape[i];
        self->strides[i] = stride;
    }
    return self;
}

static PyObject *view_of(python_array *array) {
    PyObject *view = array ? PyMemoryView_FromObject((PyObject *)array) : NULL;
    Py_XDECREF((PyObject *)array);
    return view;
}

PyObject *python_array_of(PyObject *owner, const void *data, char format, Py_ssize_t rows,
                          Py_ssize_t columns) {
    const Py_ssize_t shape[2] = {rows, columns};
    return view_of(array_of(owner, data, format, columns > 0 ? 2 : 1, shape));
}

static PyObject *new_of_shape(char format, int dimensions, const Py_ssize_t *shape, void **data) {
    size_t items = 1;
    for (int i = 0; i < dimensions; i++) items *= (size_t)shape[i];
    void *own = calloc(items ? items : 1, (size_t)item_of(format));
    if (!own) return PyErr_NoMemory();
    python_array *array = array_of(NULL, own, format, dimensions, shape);
    if (array) {
        array->own = own;
        *data = own;
    } else {
        free(own);
    }
    return view_of(array);
}

PyObject *python_array_new(char format, Py_ssize_t rows, Py_ssize_t columns, void **data) {
    const Py_ssize_t shape[2] = {rows, columns};
    return new_of_shape(format, columns > 0 ? 2 : 1, shape, data);
}

/* ---- what came from the caller -------------------------------------------------------------- */

/* "format 'f' of shape [8, 3]" */
static void describe(const Py_buffer *view, char *text, size_t size) {
    int at = snprintf(text, size, "format '%.8s' of shape [", view->format ? view->format : "B");
    for (int i = 0; i < view->ndim && i < 4 && at > 0 && (size_t)at < size; i++)
        at += snprintf(text + at, size - (size_t)at, "%s%lld", i ? ", " : "",
                       (long long)(view->shape ? view->shape[i] : view->len));
    if (at > 0 && (size_t)at < size) snprintf(text + at, size - (size_t)at, "]");
}

/* The type of a format of one item in this machine's order; 0: another one. */
static char type_of(const Py_buffer *view) {
    const char *format = view->format ? view->format : "B";
    if (*format == '@' || *format == '=' || *format == '<') format++;
    return *format && !format[1] ? *format : 0;
}

static const char *shape_words(int columns, char *text, size_t size) {
    if (columns > 0)
        snprintf(text, size, "[n, %d]", columns);
    else
        snprintf(text, size, "[n]");
    return text;
}

static bool has_shape(const Py_buffer *view, int columns) {
    return columns > 0 ? view->ndim == 2 && view->shape[1] == columns : view->ndim == 1;
}

static void shape_text(int dimensions, const Py_ssize_t *shape, char *text, size_t size) {
    int at = snprintf(text, size, "[");
    for (int i = 0; i < dimensions; i++)
        at += snprintf(text + at, size - (size_t)at, "%s%lld", i ? ", " : "", (long long)shape[i]);
    snprintf(text + at, size - (size_t)at, "]");
}

static bool same_shape(const Py_buffer *view, int dimensions, const Py_ssize_t *shape) {
    bool same = view->ndim == dimensions;
    for (int i = 0; i < dimensions && same; i++) same = view->shape[i] == shape[i];
    return same;
}

bool python_target_of_shape(PyObject *out, char format, int dimensions, const Py_ssize_t *shape,
                            python_target *target) {
    *target = (python_target){.result = NULL};
    if (!out || out == Py_None) {
        target->result = new_of_shape(format, dimensions, shape, &target->data);
        return target->result != NULL;
    }
    const char *kind = format == 'd' ? "float64" : format == 'f' ? "float32" : "int32";
    if (!PyObject_CheckBuffer(out))
        return python_refuse_type("out: expected an array of %s, writable, got %R", kind,
                                  (PyObject *)Py_TYPE(out));
    if (PyObject_GetBuffer(out, &target->view, PyBUF_RECORDS_RO)) return false;
    const Py_buffer *view = &target->view;
    bool fits = same_shape(view, dimensions, shape) && type_of(view) == format &&
                view->itemsize == item_of(format) && !view->readonly &&
                PyBuffer_IsContiguous(view, 'C');
    if (!fits) {
        char got[160], wanted[80];
        describe(view, got, sizeof got);
        shape_text(dimensions, shape, wanted, sizeof wanted);
        python_refuse("out: expected a writable, contiguous array of %s (format '%c') of shape %s, "
                      "got %s%s%s",
                      kind, format, wanted, got, view->readonly ? ", read only" : "",
                      PyBuffer_IsContiguous(view, 'C') ? "" : ", not contiguous");
        PyBuffer_Release(&target->view);
        return false;
    }
    target->data = view->buf;
    Py_INCREF(out);
    target->result = out;
    return true;
}

bool python_target_open(PyObject *out, char format, Py_ssize_t rows, Py_ssize_t columns,
                        python_target *target) {
    const Py_ssize_t shape[2] = {rows, columns};
    return python_target_of_shape(out, format, columns > 0 ? 2 : 1, shape, target);
}

PyObject *python_target_close(python_target *target, bool failed) {
    if (target->view.obj) PyBuffer_Release(&target->view);
    if (!failed) return target->result;
    Py_CLEAR(target->result);
    return NULL;
}

void python_rows_free(python_rows *rows) {
    if (rows->held) PyBuffer_Release(&rows->view);
    PyMem_Free(rows->own);
    *rows = (python_rows){.data = NULL};
}

/* Converts the number `source` for a place of an array. */
typedef bool take_number(PyObject *source, void *place);

static bool take_double(PyObject *source, void *place) {
    double value = PyFloat_AsDouble(source);
    if (value == -1.0 && PyErr_Occurred()) return false;
    *(double *)place = value;
    return true;
}

static bool take_int32(PyObject *source, void *place) {
    PyObject *index = PyNumber_Index(source);
    if (!index) return false;
    long value = PyLong_AsLong(index);
    Py_DECREF(index);
    if (value == -1 && PyErr_Occurred()) return false;
    if (value < INT32_MIN || value > INT32_MAX)
        return python_refuse("%ld is no 32-bit integer", value);
    *(int32_t *)place = (int32_t)value;
    return true;
}

/* The numbers of one row, `count` of them. */
static bool take_row(PyObject *row, const char *name, Py_ssize_t number, int count, size_t item,
                     take_number *take, char *place) {
    PyObject *list = PySequence_Check(row) ? PySequence_Tuple(row) : NULL;
    if (!list || PyTuple_Size(list) != count) {
        Py_XDECREF(list);
        PyErr_Clear();
        return python_refuse("%s: row %zd is no sequence of %d numbers", name, number, count);
    }
    bool ok = true;
    for (int i = 0; i < count && ok; i++) ok = take(PyTuple_GetItem(list, i), place + i * item);
    Py_DECREF(list);
    return ok;
}

/* Python's own words do not say where. */
static bool refuse_item(const char *name, Py_ssize_t number, size_t item) {
    const char *kind = item == 8 ? "number" : "whole number";
    if (PyErr_ExceptionMatches(PyExc_TypeError)) {
        PyErr_Clear();
        return python_refuse_type("%s: row %zd has something that is no %s", name, number, kind);
    }
    if (PyErr_ExceptionMatches(PyExc_OverflowError)) {
        PyErr_Clear();
        return python_refuse("%s: row %zd has a %s that is too large", name, number, kind);
    }
    return false;
}

/* Lists of lists, for whoever has no arrays. */
static bool take_sequence(PyObject *source, const char *name, int columns, size_t item,
                          take_number *take, python_rows *out) {
    char shape[32];
    if (!PySequence_Check(source) || PyUnicode_Check(source))
        return python_refuse_type(
            "%s: expected an array of %s of shape %s, or nested lists, got %R", name,
            item == 8 ? "float64" : "int32", shape_words(columns, shape, sizeof shape),
            (PyObject *)Py_TYPE(source));
    PyObject *list = PySequence_Tuple(source);
    if (!list) return false;
    out->rows = PyTuple_Size(list);
    size_t width = item * (size_t)(columns > 0 ? columns : 1);
    out->own = PyMem_Calloc((size_t)out->rows + 1, width);
    bool ok = out->own != NULL;
    if (!ok) PyErr_NoMemory();
    for (Py_ssize_t i = 0; i < out->rows && ok; i++) {
        char *place = (char *)out->own + (size_t)i * width;
        PyObject *row = PyTuple_GetItem(list, i);
        ok = columns > 0 ? take_row(row, name, i, columns, item, take, place) : take(row, place);
        if (!ok) refuse_item(name, i, item);
    }
    Py_DECREF(list);
    out->data = out->own;
    return ok;
}

/* numpy.ma: its buffer has what is masked, too. */
bool python_unmasked(PyObject *source, const char *name) {
    PyObject *mask = PyObject_GetAttrString(source, "mask");
    PyObject *any = mask ? PyObject_CallMethod(mask, "any", NULL) : NULL;
    const bool masked = any && PyObject_IsTrue(any) == 1;
    Py_XDECREF(any);
    Py_XDECREF(mask);
    PyErr_Clear();
    return !masked || python_refuse("%s: some of the array is masked, and nothing here may be left "
                                    "open; fill it (array.filled(value)), or leave it out "
                                    "(array.compressed())",
                                    name);
}

/* Opens the view of a buffer of that shape, whatever its items. */
static bool open_buffer(PyObject *source, const char *name, const char *kind, int columns,
                        python_rows *out) {
    if (!python_unmasked(source, name)) return false;
    if (PyObject_GetBuffer(source, &out->view, PyBUF_RECORDS_RO)) return false;
    out->held = true;
    char got[160], shape[32];
    describe(&out->view, got, sizeof got);
    shape_words(columns, shape, sizeof shape);
    if (!has_shape(&out->view, columns))
        return python_refuse("%s: expected %s of shape %s, got %s", name, kind, shape, got);
    if (!PyBuffer_IsContiguous(&out->view, 'C'))
        return python_refuse("%s: expected a contiguous array, got %s with gaps or by columns; "
                             "numpy.ascontiguousarray makes one",
                             name, got);
    out->data = out->view.buf;
    out->rows = out->view.shape[0];
    return true;
}

static bool check_finite(const python_rows *rows, const char *name, int columns) {
    const double *value = rows->data;
    Py_ssize_t width = columns > 0 ? columns : 1;
    for (Py_ssize_t i = 0; i < rows->rows * width; i++)
        if (!isfinite(value[i]))
            return python_refuse("%s: row %zd has a number that is not finite", name, i / width);
    return true;
}

bool python_doubles(PyObject *source, const char *name, int columns, python_rows *out) {
    *out = (python_rows){.data = NULL};
    bool ok;
    if (PyObject_CheckBuffer(source)) {
        ok = open_buffer(source, name, "float64", columns, out);
        if (ok && (type_of(&out->view) != 'd' || out->view.itemsize != 8)) {
            char got[160];
            describe(&out->view, got, sizeof got);
            ok = python_refuse("%s: expected float64 (format 'd'), got %s; "
                               "array.astype(numpy.float64) converts",
                               name, got);
        }
    } else {
        ok = take_sequence(source, name, columns, 8, take_double, out);
    }
    ok = ok && check_finite(out, name, columns);
    if (!ok) python_rows_free(out);
    return ok;
}

/* One integer of another kind: `item` bytes, the first the highest where it is turned. */
static bool convert(const unsigned char *from, char type, Py_ssize_t item, bool turned,
                    int32_t *to) {
    unsigned long long bits = 0;
    for (Py_ssize_t i = 0; i < item; i++) bits = bits << 8 | from[turned ? i : item - 1 - i];
    const bool is_signed = strchr("bhilq", type) != NULL;
    const int unused = 64 - 8 * (int)item;
    const long long value = is_signed                    ? (long long)(bits << unused) >> unused
                            : bits > (uint64_t)LLONG_MAX ? LLONG_MAX
                                                         : (long long)bits;
    if (value < INT32_MIN || value > INT32_MAX) return false;
    *to = (int32_t)value;
    return true;
}

/* As type_of, also of the other order of bytes: *turned. */
static char integer_type_of(const Py_buffer *view, bool *turned) {
    const char *format = view->format ? view->format : "B";
    *turned = *format == '>' || *format == '!';
    const char type = *turned && !format[2] ? format[1] : type_of(view);
    const Py_ssize_t item = view->itemsize;
    const bool known = item == 1 || item == 2 || item == 4 || item == 8;
    return type && known && strchr("bBhHiIlLqQ", type) ? type : 0;
}

static bool narrow(const char *name, int columns, python_rows *out) {
    bool turned;
    char type = integer_type_of(&out->view, &turned), got[160];
    Py_ssize_t item = out->view.itemsize, width = columns > 0 ? columns : 1;
    if (!type) {
        describe(&out->view, got, sizeof got);
        return python_refuse("%s: expected int32 (format 'i'), got %s; "
                             "array.astype(numpy.int32) converts",
                             name, got);
    }
    if (item == 4 && !turned && strchr("il", type)) return true;
    Py_ssize_t count = out->rows * width;
    int32_t *own = out->own = PyMem_Calloc((size_t)count + 1, sizeof *own);
    if (!own) return PyErr_NoMemory() != NULL;
    for (Py_ssize_t i = 0; i < count; i++)
        if (!convert((const unsigned char *)out->data + i * item, type, item, turned, &own[i]))
            return python_refuse("%s: row %zd has a number beyond 32 bits", name, i / width);
    out->data = own;
    return true;
}

bool python_integers(PyObject *source, const char *name, int columns, python_rows *out) {
    *out = (python_rows){.data = NULL};
    bool ok;
    if (PyObject_CheckBuffer(source))
        ok = open_buffer(source, name, "int32", columns, out) && narrow(name, columns, out);
    else
        ok = take_sequence(source, name, columns, 4, take_int32, out);
    if (!ok) python_rows_free(out);
    return ok;
}

/* ---- blocks: one layer of rows for each member of a batch -------------------------------------
 */

static bool block_of_layers(PyObject *source, const char *name, const Py_ssize_t shape[3],
                            python_rows *out) {
    char wanted[80];
    shape_text(3, shape, wanted, sizeof wanted);
    PyObject *list =
        PySequence_Check(source) && !PyUnicode_Check(source) ? PySequence_Tuple(source) : NULL;
    if (!list) {
        PyErr_Clear();
        return python_refuse_type(
            "%s: expected an array of float64 of shape %s, or nested lists, got %R", name, wanted,
            (PyObject *)Py_TYPE(source));
    }
    size_t layer = (size_t)shape[1] * (size_t)shape[2];
    double *own = out->own = PyMem_Calloc((size_t)shape[0] * layer + 1, sizeof *own);
    bool ok =
        PyTuple_Size(list) == shape[0] ||
        python_refuse("%s: expected shape %s, got %zd layers", name, wanted, PyTuple_Size(list));
    if (ok && !own) ok = PyErr_NoMemory() != NULL;
    for (Py_ssize_t i = 0; i < shape[0] && ok; i++) {
        python_rows rows;
        ok = python_doubles(PyTuple_GetItem(list, i), name, (int)shape[2], &rows);
        if (!ok) break;
        ok = rows.rows == shape[1] || python_refuse("%s: expected shape %s, layer %zd has %zd rows",
                                                    name, wanted, i, rows.rows);
        if (ok) memcpy(own + (size_t)i * layer, rows.data, layer * sizeof *own);
        python_rows_free(&rows);
    }
    Py_DECREF(list);
    out->data = own;
    return ok;
}

static bool block_of_buffer(PyObject *source, const char *name, const Py_ssize_t shape[3],
                            python_rows *out) {
    if (!python_unmasked(source, name)) return false;
    if (PyObject_GetBuffer(source, &out->view, PyBUF_RECORDS_RO)) return false;
    out->held = true;
    out->data = out->view.buf;
    if (same_shape(&out->view, 3, shape) && type_of(&out->view) == 'd' && out->view.itemsize == 8 &&
        PyBuffer_IsContiguous(&out->view, 'C'))
        return true;
    char got[160], wanted[80];
    describe(&out->view, got, sizeof got);
    shape_text(3, shape, wanted, sizeof wanted);
    return python_refuse("%s: expected a contiguous array of float64 (format 'd') of shape %s, got "
                         "%s%s",
                         name, wanted, got,
                         PyBuffer_IsContiguous(&out->view, 'C') ? "" : ", not contiguous");
}

bool python_block(PyObject *source, const char *name, const Py_ssize_t shape[3], python_rows *out) {
    *out = (python_rows){.data = NULL};
    bool ok = PyObject_CheckBuffer(source) ? block_of_buffer(source, name, shape, out)
                                           : block_of_layers(source, name, shape, out);
    out->rows = shape[0] * shape[1];
    ok = ok && check_finite(out, name, (int)shape[2]);
    if (!ok) python_rows_free(out);
    return ok;
}
