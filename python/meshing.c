/* class Meshing: what lariat.mesh has made. Never changes, so any thread may use it. */
#include "module.h"

PyTypeObject *python_meshing_type;

PyObject *python_meshing_wrap(lar_meshing *meshing) {
    python_meshing *self = PyObject_New(python_meshing, python_meshing_type);
    if (self)
        self->meshing = meshing;
    else
        lar_meshing_destroy(meshing);
    return (PyObject *)self;
}

static lar_meshing *meshing_of(PyObject *me) {
    return ((python_meshing *)me)->meshing;
}

static void meshing_dealloc(PyObject *me) {
    lar_meshing_destroy(meshing_of(me));
    python_object_free(me);
}

static PyObject *meshing_repr(PyObject *me) {
    lar_meshing_info i;
    lar_meshing_inspect(meshing_of(me), &i);
    return PyUnicode_FromFormat("<lariat.Meshing %s: %d nodes, %d elements, %d regions>", i.title,
                                (int)i.nodes, (int)i.elements, (int)i.regions);
}

static lar_mesh_arrays mesh_of(PyObject *me) {
    lar_mesh_arrays mesh;
    lar_meshing_arrays(meshing_of(me), &mesh, NULL);
    return mesh;
}

static PyObject *get_nodes(PyObject *me, void *unused) {
    (void)unused;
    const lar_mesh_arrays m = mesh_of(me);
    return python_array_of(me, m.position, 'd', m.nodes, 3);
}
static PyObject *get_hexahedra(PyObject *me, void *unused) {
    (void)unused;
    const lar_mesh_arrays m = mesh_of(me);
    return python_array_of(me, m.element, 'i', m.elements, 8);
}
static PyObject *get_tags(PyObject *me, void *unused) {
    (void)unused;
    const lar_mesh_arrays m = mesh_of(me);
    return python_array_of(me, m.tag, 'i', m.elements, 0);
}

static PyObject *get_fibres(PyObject *me, void *unused) {
    (void)unused;
    const lar_mesh_arrays m = mesh_of(me);
    return m.fibre ? python_array_of(me, m.fibre, 'd', m.elements, 3) : Py_NewRef(Py_None);
}

static PyObject *get_sets(PyObject *me, void *unused) {
    (void)unused;
    const lar_mesh_arrays m = mesh_of(me);
    PyObject *sets = PyDict_New();
    for (int32_t i = 0; i < m.sets && sets; i++) {
        PyObject *value = Py_BuildValue(
            "(sN)", m.set[i].kind, python_array_of(me, m.set[i].index, 'i', m.set[i].count, 0));
        if (!value || PyDict_SetItemString(sets, m.set[i].name, value)) Py_CLEAR(sets);
        Py_XDECREF(value);
    }
    return sets;
}

static PyObject *get_surface(PyObject *me, void *unused) {
    (void)unused;
    lar_surface_arrays s;
    lar_meshing_arrays(meshing_of(me), NULL, &s);
    return Py_BuildValue("{s:N,s:N}", "vertices", python_array_of(me, s.vertex, 'd', s.vertices, 3),
                         "triangles", python_array_of(me, s.triangle, 'i', s.triangles, 3));
}

static PyObject *get_scene(PyObject *me, void *unused) {
    (void)unused;
    const char *text;
    lar_error error;
    if (lar_meshing_scene(meshing_of(me), &text, &error)) return python_raise(&error);
    return PyUnicode_FromString(text);
}

static PyObject *quality_dict(const lar_mesh_quality *q) {
    return Py_BuildValue("{s:d,s:d,s:d,s:d,s:d,s:d,s:d,s:d,s:i,s:d}", "above_02", q->above_02,
                         "above_05", q->above_05, "mean_edge", q->mean_edge, "volume", q->volume,
                         "true_volume", q->true_volume, "deviation_mean", q->deviation_mean,
                         "deviation_95", q->deviation_95, "deviation_max", q->deviation_max,
                         "crossings", (int)q->crossings, "crossing_depth", q->crossing_depth);
}

static PyObject *get_info(PyObject *me, void *unused) {
    (void)unused;
    lar_meshing_info i;
    lar_meshing_inspect(meshing_of(me), &i);
    return Py_BuildValue(
        "{s:s,s:s,s:i,s:i,s:i,s:d,s:i,s:i,s:i,s:i,s:i,s:s,s:i,s:i,s:i,s:i,s:N}", "title", i.title,
        "name", i.name, "nodes", (int)i.nodes, "elements", (int)i.elements, "regions",
        (int)i.regions, "size", i.size, "islands", (int)i.islands, "pinholes", (int)i.pinholes,
        "added", (int)i.added, "removed", (int)i.removed, "cuts", (int)i.cuts, "fix", i.fix,
        "extra_supports", (int)i.extra_supports, "fixed_nodes", (int)i.fixed_nodes, "joined",
        (int)i.joined, "parted", (int)i.parted, "quality", quality_dict(&i.quality));
}

static PyObject *get_regions(PyObject *me, void *unused) {
    (void)unused;
    lar_region_info r;
    lar_meshing_info info;
    lar_meshing_inspect(meshing_of(me), &info);
    PyObject *list = PyList_New(info.regions);
    for (int32_t i = 0; list && i < info.regions; i++) {
        lar_error error;
        PyObject *item =
            lar_meshing_region(meshing_of(me), i, &r, &error)
                ? python_raise(&error)
                : Py_BuildValue("{s:s,s:i,s:i,s:d,s:d,s:s,s:s,s:d,s:d,s:d,s:N}", "name", r.name,
                                "tag", (int)r.tag, "elements", (int)r.elements, "volume", r.volume,
                                "true_volume", r.true_volume, "tissue", r.tissue, "source",
                                r.source, "shear_modulus", r.shear_modulus, "bulk_modulus",
                                r.bulk_modulus, "density", r.density, "held",
                                PyBool_FromLong(r.held));
        if (!item || PyList_SetItem(list, i, item)) Py_CLEAR(list);
    }
    return list;
}

static PyObject *meshing_model(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"scene", NULL};
    PyObject *scene = Py_None;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|O:model", names, &scene)) return NULL;
    scene = scene == Py_None ? get_scene(me, NULL) : Py_NewRef(scene);
    PyObject *positional =
        scene ? Py_BuildValue("(NNO)", get_nodes(me, NULL), get_hexahedra(me, NULL), scene) : NULL;
    PyObject *named = positional
                          ? Py_BuildValue("{s:N,s:N,s:N}", "tags", get_tags(me, NULL), "sets",
                                          get_sets(me, NULL), "fibres", get_fibres(me, NULL))
                          : NULL;
    PyObject *maker =
        named ? PyObject_GetAttrString((PyObject *)python_model_type, "from_arrays") : NULL;
    PyObject *model = maker ? PyObject_Call(maker, positional, named) : NULL;
    Py_XDECREF(maker);
    Py_XDECREF(named);
    Py_XDECREF(positional);
    Py_XDECREF(scene);
    return model;
}

static PyObject *meshing_write(PyObject *me, PyObject *folder) {
    PyObject *path = python_path(folder, "folder");
    if (!path) return NULL;
    const char *scene = NULL;
    lar_error error;
    /* With the lock: two threads may have one meshing, and it remembers the scene's path. */
    lar_status status = lar_meshing_write(meshing_of(me), PyBytes_AsString(path), &scene, &error);
    Py_DECREF(path);
    return status ? python_raise(&error) : PyUnicode_DecodeFSDefault(scene);
}

/* ---- the class ------------------------------------------------------------------------------ */

static PyGetSetDef meshing_properties[] = {
    {"nodes", get_nodes, NULL,
     "memoryview, float64 [nodes, 3], read only: places in metres. Meshings of images: +x right, "
     "+y front, +z head. No copy.",
     NULL},
    {"hexahedra", get_hexahedra, NULL,
     "memoryview, int32 [elements, 8], read only: nodes of each element, as VTK orders them. No "
     "copy.",
     NULL},
    {"tags", get_tags, NULL,
     "memoryview, int32 [elements], read only: the region's tag: the label in the image, or 1, 2, "
     "... for surfaces. No copy.",
     NULL},
    {"fibres", get_fibres, NULL,
     "memoryview, float64 [elements, 3], read only: along what fibres run, 0 0 0 where there are "
     "none; None without `fibres`. No copy.",
     NULL},
    {"sets", get_sets, NULL,
     "dict of name: (kind, int32 [k]): as Model.from_arrays takes them; \"support\", \"handle\", "
     "...",
     NULL},
    {"surface", get_surface, NULL,
     "dict of memoryviews, read only, no copies: vertices float64 [v, 3] in metres and triangles "
     "int32 [t, 3] of the true surface.",
     NULL},
    {"scene", get_scene, NULL,
     "str: the starter scene (YAML) that `model` takes: materials, supports, a pull, tools.", NULL},
    {"info", get_info, NULL,
     "dict: counts, size of the grid's cells [m], what was cleaned, where it is held, and quality, "
     "a dict: parts of the elements with a scaled Jacobian above 0.2 and 0.5, mean edge [m], "
     "volumes [m^3], deviations from the true surface [m].",
     NULL},
    {"regions", get_regions, NULL,
     "list of dicts: name, tag, elements, volume and true_volume [m^3], tissue and source of the "
     "scene's material (a paper, or its tissue file), its moduli [Pa] and density [kg/m^3], held "
     "(bone).",
     NULL},
    {NULL, NULL, NULL, NULL, NULL}};

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
static PyMethodDef meshing_methods[] = {
    {"model", FUNCTION(meshing_model), METH_VARARGS | METH_KEYWORDS,
     "model($self, scene=None)\n--\n\nA Model of this mesh, without files: with the starter scene, "
     "or one of your own as Model.from_arrays takes it. The embedded fine surface is only in what "
     "`write` writes; the nodes move the same, to the last bit."},
    {"write", meshing_write, METH_O,
     "write($self, folder, /)\n--\n\nWrites FOLDER/NAME.vtu, NAME_surface.vtp and NAME.yaml, as "
     "`lariat mesh` does; files that are there are replaced. Returns the scene's path."},
    {NULL, NULL, 0, NULL}};

static PyType_Slot meshing_slots[] = {
    {Py_tp_doc, "What lariat.mesh has made: a mesh of hexahedra with a starter scene. Never "
                "changes."},
    {Py_tp_dealloc, meshing_dealloc},
    {Py_tp_repr, meshing_repr},
    {Py_tp_methods, meshing_methods},
    {Py_tp_getset, meshing_properties},
    {0, NULL}};
static PyType_Spec meshing_spec = {.name = "lariat.Meshing",
                                   .basicsize = sizeof(python_meshing),
                                   .flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                                   .slots = meshing_slots};

bool python_meshing_add(PyObject *module) {
    python_meshing_type = python_type_add(module, &meshing_spec, true);
    return python_meshing_type != NULL;
}
