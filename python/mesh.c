/* lariat.mesh, which makes a Meshing: of files, of a label image or of surfaces.
 *
 * The library tells of its progress on the thread that called it; there the interpreter's lock is
 * taken for a moment, for the caller's own callback, or to look for Ctrl-C. */
#include <math.h>
#include <stdint.h>

#include "module.h"

enum { LABELS_MAX = 256, GIVEN_MAX = 255 };

/* ---- what is asked for ---------------------------------------------------------------------- */

typedef struct request {
    lar_meshing_options options;
    PyObject *source, *triangles, *affine, *label, *names, *tissue, *progress;
    PyObject *kept; /* list: what texts below belong to */
    int32_t count;
    const char *path[GIVEN_MAX], *word[LABELS_MAX], *entry[GIVEN_MAX];
    /* of surfaces */
    lar_surface_arrays surface[GIVEN_MAX];
    python_rows vertex[GIVEN_MAX], triangle[GIVEN_MAX];
    /* of a label image */
    lar_image_info image;
    uint16_t *voxels;
    const char **name;
    int32_t *named;
    python_watch watch;
    bool stopped; /* by the callback */
} request;

static void request_free(request *r) {
    for (int32_t i = 0; i < GIVEN_MAX; i++) {
        python_rows_free(&r->vertex[i]);
        python_rows_free(&r->triangle[i]);
    }
    PyMem_Free(r->voxels);
    PyMem_Free(r->name);
    PyMem_Free(r->named);
    Py_XDECREF(r->kept);
    PyMem_Free(r);
}

/* A text as long as the request lives; takes `text` over. */
static const char *keep_text(request *r, PyObject *text, const char *name) {
    const char *utf8 = NULL;
    if (text && !PyList_Append(r->kept, text))
        utf8 = PyBytes_Check(text) ? PyBytes_AsString(text) : python_text(text, name);
    Py_XDECREF(text);
    return utf8;
}

static bool is_path(PyObject *source) {
    return PyUnicode_Check(source) || PyBytes_Check(source) ||
           PyObject_HasAttrString(source, "__fspath__");
}

/* A number or a name. */
static bool take_label(request *r, PyObject *item) {
    if (r->options.label_count == LABELS_MAX)
        return python_refuse("label: at most %d can be asked for", LABELS_MAX);
    bool number = PyIndex_Check(item) && !PyUnicode_Check(item);
    if (!number && !PyUnicode_Check(item))
        return python_refuse_type("label: expected names or numbers, got %R", item);
    PyObject *index = number ? PyNumber_Index(item) : NULL;
    PyObject *text = number ? (index ? PyObject_Str(index) : NULL) : Py_NewRef(item);
    Py_XDECREF(index);
    return (r->word[r->options.label_count++] = keep_text(r, text, "label")) != NULL;
}

static bool take_labels(request *r) {
    if (r->label == Py_None) return true;
    r->options.labels = r->word;
    if (PyUnicode_Check(r->label) || PyIndex_Check(r->label)) return take_label(r, r->label);
    if (!PyList_Check(r->label) && !PyTuple_Check(r->label))
        return python_refuse_type("label: expected a name, a number or a list of them, got %R",
                                  (PyObject *)Py_TYPE(r->label));
    PyObject *list = PySequence_Tuple(r->label);
    bool ok = list != NULL;
    for (Py_ssize_t i = 0; ok && i < PyTuple_Size(list); i++)
        ok = take_label(r, PyTuple_GetItem(list, i));
    Py_XDECREF(list);
    return ok;
}

/* ---- tissue files --------------------------------------------------------------------------- */

/* "REGION=FILE"; None: of all but bones, "=FILE". */
static bool take_tissue(request *r, PyObject *region, PyObject *file) {
    const char *name = "";
    if (r->options.tissue_count == GIVEN_MAX)
        return python_refuse("tissue: at most %d files", GIVEN_MAX);
    if (region != Py_None && !PyUnicode_Check(region))
        return python_refuse_type("tissue: expected names of regions (None: all but bones), got %R",
                                  region);
    if (region != Py_None && !(name = keep_text(r, Py_NewRef(region), "tissue"))) return false;
    if (region != Py_None && (!*name || strchr(name, '=')))
        return python_refuse("tissue: a region that is called %R cannot be asked for; give it a "
                             "name without \"=\" (None: all regions but bones)",
                             region);
    PyObject *path = python_path(file, "tissue");
    PyObject *entry = path ? PyBytes_FromFormat("%s=%s", name, PyBytes_AsString(path)) : NULL;
    Py_XDECREF(path);
    return (r->entry[r->options.tissue_count++] = keep_text(r, entry, "tissue")) != NULL;
}

static bool take_tissues(request *r) {
    r->options.tissues = r->entry;
    if (r->tissue == Py_None) return true;
    if (is_path(r->tissue)) return take_tissue(r, Py_None, r->tissue);
    if (!PyDict_Check(r->tissue))
        return python_refuse_type("tissue: expected a path or a dict of regions to paths, got %R",
                                  (PyObject *)Py_TYPE(r->tissue));
    PyObject *items = PyDict_Items(r->tissue); /* a copy: finding a path may run any code */
    bool ok = items != NULL;
    for (Py_ssize_t i = 0; ok && i < PyList_Size(items); i++) {
        PyObject *item = PyList_GetItem(items, i);
        ok = take_tissue(r, PyTuple_GetItem(item, 0), PyTuple_GetItem(item, 1));
    }
    Py_XDECREF(items);
    return ok;
}

/* ---- files ---------------------------------------------------------------------------------- */

static bool take_path(request *r, PyObject *item) {
    if (r->count == GIVEN_MAX) return python_refuse("source: at most %d files", GIVEN_MAX);
    return (r->path[r->count++] = keep_text(r, python_path(item, "source"), "source")) != NULL;
}

static bool take_paths(request *r) {
    if (r->affine != Py_None)
        return python_refuse("affine: it belongs to an array of labels; a file brings its own");
    if (r->names != Py_None && !is_path(r->names))
        return python_refuse("names: expected the path of a list of names beside a file; a dict "
                             "belongs to an array of labels");
    if (r->names != Py_None &&
        !(r->options.names = keep_text(r, python_path(r->names, "names"), "names")))
        return false;
    if (is_path(r->source)) return take_path(r, r->source);
    PyObject *list = PySequence_Tuple(r->source);
    bool ok = list != NULL;
    for (Py_ssize_t i = 0; ok && i < PyTuple_Size(list); i++)
        ok = take_path(r, PyTuple_GetItem(list, i));
    if (ok && r->count == 0) ok = python_refuse("source: there is no file in the list");
    Py_XDECREF(list);
    return ok;
}

/* ---- surfaces ------------------------------------------------------------------------------- */

static bool take_surface(request *r, const char *name, PyObject *vertices, PyObject *triangles) {
    if (r->count == GIVEN_MAX) return python_refuse("source: at most %d surfaces", GIVEN_MAX);
    const int32_t i = r->count++;
    char label[2][96];
    snprintf(label[0], sizeof label[0], "%s%.60s%svertices", name ? "[\"" : "", name ? name : "",
             name ? "\"] " : "");
    snprintf(label[1], sizeof label[1], "%s%.60s%striangles", name ? "[\"" : "", name ? name : "",
             name ? "\"] " : "");
    if (!python_doubles(vertices, label[0], 3, &r->vertex[i]) ||
        !python_integers(triangles, label[1], 3, &r->triangle[i]))
        return false;
    if (r->vertex[i].rows > INT32_MAX || r->triangle[i].rows > INT32_MAX)
        return python_refuse("%s: more than 2^31 - 1", label[0]);
    r->surface[i] =
        (lar_surface_arrays){name ? name : r->options.title, (int32_t)r->vertex[i].rows,
                             (int32_t)r->triangle[i].rows, r->vertex[i].data, r->triangle[i].data};
    return true;
}

static bool take_surfaces(request *r) {
    if (r->affine != Py_None || r->names != Py_None)
        return python_refuse("affine, names: they belong to an array of labels, not to surfaces");
    if (!PyDict_Check(r->source)) return take_surface(r, NULL, r->source, r->triangles);
    PyObject *items = PyDict_Items(r->source); /* a copy: converting numbers may run any code */
    bool ok = items && (PyList_Size(items) > 0 || python_refuse("source: the dict is empty"));
    for (Py_ssize_t i = 0; ok && i < PyList_Size(items); i++) {
        PyObject *item = PyList_GetItem(items, i), *key = PyTuple_GetItem(item, 0);
        PyObject *pair = PyTuple_GetItem(item, 1);
        if (!PyUnicode_Check(key) || !PyTuple_Check(pair) || PyTuple_Size(pair) != 2) {
            ok = python_refuse_type(
                "source: expected a dict of names to (vertices, triangles), got %R: %R", key,
                (PyObject *)Py_TYPE(pair));
            break;
        }
        const char *name = keep_text(r, Py_NewRef(key), "source");
        ok = name && take_surface(r, name, PyTuple_GetItem(pair, 0), PyTuple_GetItem(pair, 1));
    }
    Py_XDECREF(items);
    return ok;
}

/* ---- label images --------------------------------------------------------------------------- */

static bool check_affine_shape(PyObject *affine) {
    Py_buffer view;
    if (!PyObject_CheckBuffer(affine)) return true;
    if (PyObject_GetBuffer(affine, &view, PyBUF_RECORDS_RO)) return false;
    const int dimensions = view.ndim;
    const Py_ssize_t rows = dimensions == 2 ? view.shape[0] : 0;
    const Py_ssize_t columns = dimensions == 2 ? view.shape[1] : 0;
    PyBuffer_Release(&view);
    if ((rows == 3 || rows == 4) && columns == 4) return true;
    if (dimensions != 2)
        return python_refuse("affine: expected shape [4, 4] or [3, 4], got %d dimensions",
                             dimensions);
    return python_refuse("affine: expected shape [4, 4] or [3, 4], got [%zd, %zd]%s", rows, columns,
                         columns == 3 ? "; the fourth column is where voxel (0, 0, 0) is" : "");
}

/* Three rows, or four of which the last is 0 0 0 1; `scale`: metres per unit. */
static bool take_affine(request *r) {
    if (r->affine == Py_None)
        return python_refuse("affine: an array of labels needs it: 3 or 4 rows of 4, voxel (i, j, "
                             "k, 1) to the world; for a nibabel image image.affine with "
                             "scale=0.001");
    python_rows rows;
    if (!check_affine_shape(r->affine) || !python_doubles(r->affine, "affine", 4, &rows))
        return false;
    const double(*row)[4] = rows.data;
    bool ok = rows.rows == 3 || rows.rows == 4 ||
              python_refuse("affine: expected shape [4, 4] or [3, 4], got [%zd, 4]", rows.rows);
    if (ok && rows.rows == 4 && (row[3][0] || row[3][1] || row[3][2] || row[3][3] != 1))
        ok = python_refuse("affine: the last of four rows must be 0 0 0 1");
    const double scale = r->options.scale > 0 ? r->options.scale : 1;
    for (int i = 0; ok && i < 3; i++)
        for (int k = 0; k < 4; k++) r->image.to_world[i][k] = scale * row[i][k];
    r->options.scale = 0;
    python_rows_free(&rows);
    return ok;
}

typedef struct voxel_reader {
    const char *data;
    Py_ssize_t stride[3], item;
    bool is_signed;
    int64_t bad; /* voxel; -1: none */
} voxel_reader;

static int64_t read_voxel(const voxel_reader *v, const char *at) {
    union {
        int8_t i1;
        uint8_t u1;
        int16_t i2;
        uint16_t u2;
        int32_t i4;
        uint32_t u4;
        int64_t i8;
    } x;
    memcpy(&x, at, (size_t)v->item);
    switch (v->item) {
    case 1:
        return v->is_signed ? x.i1 : x.u1;
    case 2:
        return v->is_signed ? x.i2 : x.u2;
    case 4:
        return v->is_signed ? x.i4 : (int64_t)x.u4;
    default:
        return x.i8; /* unsigned ones beyond 2^63 are negative here, and no labels either */
    }
}

/* Any order of axes in memory; i runs fastest in the copy. */
static void copy_voxels(voxel_reader *v, const int32_t size[3], uint16_t *out) {
    v->bad = -1;
    int64_t n = 0;
    for (int32_t k = 0; k < size[2]; k++)
        for (int32_t j = 0; j < size[1]; j++) {
            const char *at = v->data + k * v->stride[2] + j * v->stride[1];
            for (int32_t i = 0; i < size[0]; i++, n++, at += v->stride[0]) {
                int64_t label = read_voxel(v, at);
                if ((label < 0 || label > UINT16_MAX) && v->bad < 0) v->bad = n;
                out[n] = (uint16_t)label;
            }
        }
}

static bool take_buffer(request *r, const Py_buffer *view) {
    const char *format = view->format ? view->format : "B";
    if (*format == '@' || *format == '=' || *format == '<') format++;
    const bool whole = *format && !format[1] && strchr("?bBhHiIlLqQnN", *format);
    if (view->ndim != 3 || !whole)
        return python_refuse("labels: expected an array of integers of shape [i, j, k], got format "
                             "'%s' with %d axes%s",
                             view->format ? view->format : "B", view->ndim,
                             view->ndim == 3 ? "; labels.astype(\"uint16\") converts whole numbers"
                                             : "");
    int64_t voxels = 1;
    for (int a = 0; a < 3; a++) {
        if (view->shape[a] < 1 || view->shape[a] > 8192 || (voxels *= view->shape[a]) > 1 << 29)
            return python_refuse("labels: expected 1 to 8192 voxels along each axis and 2^29 in "
                                 "all, got [%zd, %zd, %zd]; crop it",
                                 view->shape[0], view->shape[1], view->shape[2]);
        r->image.size[a] = (int32_t)view->shape[a];
    }
    r->voxels = PyMem_Malloc((size_t)voxels * sizeof *r->voxels);
    if (!r->voxels) return PyErr_NoMemory() != NULL;
    voxel_reader v = {
        .data = view->buf, .item = view->itemsize, .is_signed = strchr("bhilqn", *format)};
    memcpy(v.stride, view->strides, sizeof v.stride);
    PYTHON_UNLOCKED(copy_voxels(&v, r->image.size, r->voxels));
    r->image.label = r->voxels;
    const int64_t plane = (int64_t)r->image.size[0] * r->image.size[1];
    return v.bad < 0 ||
           python_refuse("labels: voxel (%lld, %lld, %lld) is not between 0 and 65535",
                         (long long)(v.bad % r->image.size[0]),
                         (long long)(v.bad % plane / r->image.size[0]), (long long)(v.bad / plane));
}

/* A dict of labels to names. */
static bool take_names(request *r) {
    if (r->names == Py_None) return true;
    if (!PyDict_Check(r->names))
        return python_refuse_type("names: expected a dict of labels to names, got %R",
                                  (PyObject *)Py_TYPE(r->names));
    PyObject *items = PyDict_Items(r->names);
    size_t count = items ? (size_t)PyList_Size(items) : 0;
    r->name = PyMem_Calloc(count + 1, sizeof *r->name);
    r->named = PyMem_Calloc(count + 1, sizeof *r->named);
    bool ok = items && ((r->name && r->named) || PyErr_NoMemory());
    for (size_t i = 0; ok && i < count; i++) {
        PyObject *key = PyTuple_GetItem(PyList_GetItem(items, (Py_ssize_t)i), 0);
        PyObject *value = PyTuple_GetItem(PyList_GetItem(items, (Py_ssize_t)i), 1);
        Py_ssize_t label = PyIndex_Check(key) ? PyNumber_AsSsize_t(key, NULL) : -1;
        ok = !PyErr_Occurred() && ((label >= 0 && label <= UINT16_MAX && PyUnicode_Check(value)) ||
                                   python_refuse("names: expected labels between 0 and 65535 to "
                                                 "names, got %R: %R",
                                                 key, value));
        r->named[i] = (int32_t)label;
        ok = ok && (r->name[i] = keep_text(r, Py_NewRef(value), "names"));
        r->image.names++;
    }
    Py_XDECREF(items);
    return ok;
}

static bool take_image(request *r) {
    Py_buffer view;
    if (!take_affine(r) || !take_names(r)) return false;
    if (!python_unmasked(r->source, "source")) return false;
    if (PyObject_GetBuffer(r->source, &view, PyBUF_RECORDS_RO)) return false;
    bool ok = take_buffer(r, &view);
    PyBuffer_Release(&view);
    return ok;
}

/* ---- making it ------------------------------------------------------------------------------ */

/* lar_meshing_progress. */
static int tell(void *context, const char *what, double part) {
    request *r = context;
    if (r->progress == Py_None) return python_watch_look(&r->watch);
    PyEval_RestoreThread(r->watch.thread);
    PyObject *answer =
        PyErr_CheckSignals() ? NULL : PyObject_CallFunction(r->progress, "sd", what, part);
    r->watch.stopped = !answer;
    r->stopped = answer && python_is_no(answer);
    Py_XDECREF(answer);
    r->watch.thread = PyEval_SaveThread();
    return !r->watch.stopped && !r->stopped;
}

static lar_status make(request *r, lar_meshing **meshing, lar_error *error) {
    if (r->voxels) {
        lar_image *image = NULL;
        lar_status status = lar_image_create(&r->image, r->name, r->named, &image, error);
        if (!status) status = lar_meshing_of_image(image, &r->options, meshing, error);
        lar_image_destroy(image);
        return status;
    }
    if (r->surface[0].vertex || r->surface[0].triangles)
        return lar_meshing_of_surfaces(r->surface, r->count, &r->options, meshing, error);
    return lar_meshing_create(r->path, r->count, &r->options, meshing, error);
}

/* The commonest slip is millimetres taken for metres: a warning says so. */
static bool doubt_units(lar_meshing *meshing) {
    static const double LARGE = 10; /* [m] */
    lar_mesh_arrays mesh;
    lar_region_info region;
    lar_meshing_arrays(meshing, &mesh, NULL);
    double longest = 0;
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (int32_t n = 0; n < mesh.nodes; n++) {
            low = fmin(low, mesh.position[n][axis]);
            high = fmax(high, mesh.position[n][axis]);
        }
        longest = fmax(longest, high - low);
    }
    char text[400] = "";
    for (int32_t i = 0; !lar_meshing_region(meshing, i, &region, NULL); i++)
        if (region.usual_max > 0 && region.true_volume > region.usual_max)
            snprintf(text, sizeof text, "%.100s holds %.3g L, more than any %s", region.name,
                     1e3 * region.true_volume, region.tissue);
    if (!*text && longest > LARGE) snprintf(text, sizeof text, "the body is %.4g m long", longest);
    return !*text ||
           !PyErr_WarnFormat(PyExc_UserWarning, 1,
                             "%s: if what was given is in millimetres, say scale=0.001", text);
}

static PyObject *make_meshing(request *r) {
    lar_meshing *made = NULL;
    lar_error error;
    r->options.progress = tell;
    r->options.context = r;
    python_watch_begin(&r->watch);
    r->watch.thread = PyEval_SaveThread();
    lar_status status = make(r, &made, &error);
    PyEval_RestoreThread(r->watch.thread);
    if (r->watch.stopped) {
        lar_meshing_destroy(made);
        return NULL;
    }
    if (status) return python_raise(&error);
    PyObject *self = python_meshing_wrap(made);
    if (self && !doubt_units(((python_meshing *)self)->meshing)) Py_CLEAR(self);
    return self;
}

/* A buffer of numbers, or nested lists of them, is an array; what else can be walked, files. */
static bool take_source(request *r) {
    if (r->triangles != Py_None || PyDict_Check(r->source)) return take_surfaces(r);
    if (is_path(r->source)) return take_paths(r);
    if (PyObject_CheckBuffer(r->source)) return take_image(r);
    if (PyList_Check(r->source) || PyTuple_Check(r->source)) return take_paths(r);
    return python_refuse_type("source: expected a path or a list of paths, an array of labels "
                              "[i, j, k], vertices with triangles, or a dict of names to "
                              "(vertices, triangles); got %R",
                              (PyObject *)Py_TYPE(r->source));
}

static bool parse(PyObject *args, PyObject *keywords, request *r) {
    static char *names[] = {"source",    "triangles", "affine", "label",    "names",
                            "elements",  "size",      "scale",  "fuse",     "principal",
                            "voxel",     "fix",       "title",  "progress", "fibres",
                            "fibres_in", "tissue",    "apart",  NULL};
    lar_meshing_options *o = &r->options;
    int elements = 0;
    PyObject *number[3] = {NULL}, *word[4] = {NULL};
    r->triangles = r->affine = r->label = r->names = r->tissue = r->progress = Py_None;
    r->kept = PyList_New(0);
    if (!r->kept ||
        !PyArg_ParseTupleAndKeywords(args, keywords, "O|O$OOOOOOpppOOOOOOp:mesh", names, &r->source,
                                     &r->triangles, &r->affine, &r->label, &r->names, &number[0],
                                     &number[1], &number[2], &o->fuse, &o->principal, &o->voxel,
                                     &word[0], &word[1], &r->progress, &word[2], &word[3],
                                     &r->tissue, &o->apart) ||
        !python_int(number[0], "elements", &elements) ||
        !python_real(number[1], "size", &o->size) || !python_real(number[2], "scale", &o->scale) ||
        !python_word(word[0], "fix", &o->fix) || !python_word(word[1], "title", &o->title) ||
        !python_word(word[2], "fibres", &o->fibres) ||
        !python_word(word[3], "fibres_in", &o->fibre_region))
        return false;
    o->elements = elements;
    if (elements < 0)
        return python_refuse("elements: expected about how many, or 0 for 5000, got %d", elements);
    if (o->size < 0)
        return python_refuse("size: expected the edge of an element in metres, got %R", number[1]);
    if (r->progress != Py_None && !PyCallable_Check(r->progress))
        return python_refuse_type("progress: expected a function of a text and a number, got %R",
                                  r->progress);
    if (o->scale < 0)
        return python_refuse("scale: expected a positive number, metres per unit, got %R",
                             number[2]);
    return take_labels(r) && take_tissues(r) && take_source(r);
}

PyObject *python_mesh(PyObject *module, PyObject *args, PyObject *keywords) {
    (void)module;
    request *r = PyMem_Calloc(1, sizeof *r);
    if (!r) return PyErr_NoMemory();
    PyObject *meshing = parse(args, keywords, r) ? make_meshing(r) : NULL;
    request_free(r);
    return meshing;
}
