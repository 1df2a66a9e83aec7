/* class Model: constant once it is read, so any thread may use it. */
#include "module.h"

PyTypeObject *python_model_type;
PyObject *python_model_from_arrays(PyObject *type, PyObject *args, PyObject *keywords);
PyObject *python_model_wrap(lar_model *model);

PyObject *python_model_wrap(lar_model *model) {
    python_model *self = PyObject_New(python_model, python_model_type);
    if (!self) {
        lar_model_destroy(model);
        return NULL;
    }
    self->model = model;
    self->recipe = NULL;
    return (PyObject *)self;
}

PyObject *python_model_scene(const python_model *model) {
    PyObject *arguments = model->recipe ? PyTuple_GetItem(model->recipe, 1) : NULL;
    return arguments && PyTuple_Size(arguments) > 2 ? PyTuple_GetItem(arguments, 2) : NULL;
}

/* Whoever unpickles may stand in another folder. */
static PyObject *absolute(PyObject *path) {
    PyObject *os = PyImport_ImportModule("os.path");
    PyObject *text = os ? PyUnicode_DecodeFSDefault(PyBytes_AsString(path)) : NULL;
    PyObject *whole = text ? PyObject_CallMethod(os, "abspath", "O", text) : NULL;
    Py_XDECREF(text);
    Py_XDECREF(os);
    return whole;
}

static PyObject *model_new(PyTypeObject *type, PyObject *args, PyObject *keywords) {
    static char *names[] = {"path", NULL};
    PyObject *source;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O:Model", names, &source)) return NULL;
    if (PyDict_Check(source)) {
        python_refuse_type("path: expected a path, got a dict; Model.from_arrays takes a scene as "
                           "a dict");
        return NULL;
    }
    PyObject *path = python_path(source, "path");
    if (!path) return NULL;
    lar_model *model = NULL;
    lar_error error;
    lar_status status;
    const char *bytes = PyBytes_AsString(path);
    PYTHON_UNLOCKED(status = lar_model_open(bytes, &model, &error));
    python_model *self = status ? NULL : (python_model *)python_model_wrap(model);
    PyObject *whole = self ? absolute(path) : NULL;
    if (whole) self->recipe = Py_BuildValue("(O(N))", type, whole);
    if (self && !self->recipe) Py_CLEAR(self);
    Py_DECREF(path);
    return status ? python_raise(&error) : (PyObject *)self;
}

static void model_dealloc(PyObject *me) {
    python_model *self = (python_model *)me;
    lar_model_destroy(self->model);
    Py_XDECREF(self->recipe);
    python_object_free(me);
}

static const lar_model *model_of(PyObject *me) {
    return ((python_model *)me)->model;
}

static PyObject *model_repr(PyObject *me) {
    const lar_model *model = model_of(me);
    return PyUnicode_FromFormat("<lariat.Model %s: %d nodes, %d elements>", lar_model_source(model),
                                (int)lar_model_node_count(model),
                                (int)lar_model_element_count(model));
}

static PyObject *itself(PyObject *me, PyObject *memo) {
    (void)memo;
    Py_INCREF(me);
    return me;
}

static PyObject *model_reduce(PyObject *me, PyObject *nothing) {
    (void)nothing;
    PyObject *recipe = ((python_model *)me)->recipe;
    Py_INCREF(recipe);
    return recipe;
}

/* ---- counts and lists ----------------------------------------------------------------------- */

static PyObject *get_node_count(PyObject *me, void *unused) {
    (void)unused;
    return PyLong_FromLong(lar_model_node_count(model_of(me)));
}
static PyObject *get_element_count(PyObject *me, void *unused) {
    (void)unused;
    return PyLong_FromLong(lar_model_element_count(model_of(me)));
}
static PyObject *get_source(PyObject *me, void *unused) {
    (void)unused;
    return PyUnicode_DecodeFSDefault(lar_model_source(model_of(me)));
}
static PyObject *get_duration(PyObject *me, void *unused) {
    (void)unused;
    return PyFloat_FromDouble(lar_model_duration(model_of(me)));
}
static PyObject *get_output_interval(PyObject *me, void *unused) {
    (void)unused;
    return PyFloat_FromDouble(lar_model_output_interval(model_of(me)));
}

static PyObject *get_damping(PyObject *me, void *unused) {
    (void)unused;
    return PyFloat_FromDouble(lar_model_damping(model_of(me)));
}

/* A list of what `make` gives for each index. */
static PyObject *list_of(const lar_model *model, int32_t count,
                         PyObject *make(const lar_model *, int32_t)) {
    PyObject *list = PyList_New(count);
    for (int32_t i = 0; list && i < count; i++) {
        PyObject *item = make(model, i);
        if (!item || PyList_SetItem(list, i, item)) Py_CLEAR(list);
    }
    return list;
}

static PyObject *make_material(const lar_model *model, int32_t index) {
    lar_material_info m;
    lar_error error;
    if (lar_model_material(model, index, &m, &error)) return python_raise(&error);
    return Py_BuildValue(
        "{s:s,s:s,s:i,s:d,s:d,s:d,s:i,s:d,s:s,s:d,s:i,s:d,s:d,s:d}", "name", m.name, "law", m.law,
        "elements", (int)m.elements, "density", m.density, "shear_modulus", m.shear_modulus,
        "bulk_modulus", m.bulk_modulus, "viscous_terms", (int)m.viscous_terms,
        "instant_shear_modulus", m.instant_shear_modulus, "fibres", m.fibres, "fibre_modulus",
        m.fibre_modulus, "fibre_families", (int)m.fibre_families, "fibre_dispersion",
        m.fibre_dispersion, "active_along", m.active_along, "active_across", m.active_across);
}
static PyObject *get_materials(PyObject *me, void *unused) {
    (void)unused;
    return list_of(model_of(me), lar_model_material_count(model_of(me)), make_material);
}

static PyObject *make_set(const lar_model *model, int32_t index) {
    lar_set_info s;
    lar_error error;
    if (lar_model_set(model, index, &s, &error)) return python_raise(&error);
    return Py_BuildValue("{s:s,s:s,s:i}", "name", s.name, "kind", s.kind, "count", (int)s.count);
}
static PyObject *get_sets(PyObject *me, void *unused) {
    (void)unused;
    return list_of(model_of(me), lar_model_set_count(model_of(me)), make_set);
}

static PyObject *make_tool(const lar_model *model, int32_t index) {
    lar_tool_info info;
    lar_error error;
    return lar_model_tool(model, index, &info, &error) ? python_raise(&error)
                                                       : python_tool_dict(&info);
}
static PyObject *get_tools(PyObject *me, void *unused) {
    (void)unused;
    return list_of(model_of(me), lar_model_tool_count(model_of(me)), make_tool);
}

static PyObject *get_notices(PyObject *me, void *unused) {
    (void)unused;
    const lar_model *model = model_of(me);
    PyObject *scene = python_model_scene((python_model *)me);
    int32_t count = lar_model_notice_count(model);
    PyObject *list = PyList_New(count);
    for (int32_t i = 0; list && i < count; i++) {
        PyObject *text = python_sentence_of(scene, lar_model_notice_text(model, i));
        if (!text || PyList_SetItem(list, i, text)) Py_CLEAR(list);
    }
    return list;
}

static PyObject *make_mass_scaling(const lar_mass_scaling *m) {
    return Py_BuildValue("{s:d,s:d,s:i,s:i,s:d,s:d,s:d,s:d,s:d,s:d,s:d}", "time_step", m->time_step,
                         "largest_share", m->largest_share, "elements", (int)m->elements, "worst",
                         (int)m->worst, "factor", m->factor, "added", m->added, "share", m->share,
                         "stable_step", m->stable_step, "possible_step", m->possible_step,
                         "slowing", m->slowing, "strained_share", m->strained_share);
}

static PyObject *get_info(PyObject *me, void *unused) {
    (void)unused;
    lar_model_info i;
    lar_error error;
    lar_status status;
    const lar_model *model = model_of(me);
    PYTHON_UNLOCKED(status = lar_model_inspect(model, &i, &error));
    if (status) return python_raise_of(python_model_scene((python_model *)me), &error);
    return Py_BuildValue(
        "{s:s,s:i,s:i,s:i,s:i,s:N,s:N,s:d,s:d,s:d,s:d,s:d,s:i,s:d,s:i,s:d,s:N,s:i,s:i,s:d,s:d,s:d}",
        "title", i.title, "nodes", (int)i.nodes, "elements", (int)i.elements, "materials",
        (int)i.materials, "fixed_nodes", (int)i.fixed_nodes, "lower", python_tuple(i.lower, 3),
        "upper", python_tuple(i.upper, 3), "volume", i.volume, "mass", i.mass, "shortest_edge",
        i.shortest_edge, "scaled_jacobian_min", i.scaled_jacobian_min, "scaled_jacobian_mean",
        i.scaled_jacobian_mean, "scaled_jacobian_worst", (int)i.scaled_jacobian_worst,
        "stable_step", i.stable_step, "stable_worst", (int)i.stable_worst, "time_step", i.time_step,
        "mass_scaling", make_mass_scaling(&i.mass_scaling), "thin_elements", (int)i.thin_elements,
        "spring_nodes", (int)i.spring_nodes, "spring_stiffness", i.spring_stiffness, "duration",
        i.duration, "rounding", i.rounding);
}

/* ---- arrays --------------------------------------------------------------------------------- */

static PyObject *get_positions(PyObject *me, void *unused) {
    (void)unused;
    const lar_model *model = model_of(me);
    return python_array_of(me, lar_model_positions(model), 'd', lar_model_node_count(model), 3);
}

static PyObject *get_hexahedra(PyObject *me, void *unused) {
    (void)unused;
    const lar_model *model = model_of(me);
    int32_t count = lar_model_element_count(model);
    void *data;
    PyObject *array = python_array_new('i', count, 8, &data);
    int32_t(*out)[8] = array ? data : NULL;
    for (int32_t e = 0; out && e < count; e++)
        memcpy(out[e], lar_model_element_nodes(model, e), sizeof out[e]);
    return array;
}

static PyObject *get_element_materials(PyObject *me, void *unused) {
    (void)unused;
    const lar_model *model = model_of(me);
    int32_t count = lar_model_element_count(model);
    void *data;
    PyObject *array = python_array_new('i', count, 0, &data);
    int32_t *out = array ? data : NULL;
    for (int32_t e = 0; out && e < count; e++) out[e] = lar_model_element_material(model, e);
    return array;
}

static PyObject *get_surface(PyObject *me, void *unused) {
    (void)unused;
    lar_surface_info s;
    lar_model_surface(model_of(me), &s);
    return Py_BuildValue("{s:N,s:N,s:N}", "faces", python_array_of(me, s.face, 'i', s.faces, 4),
                         "elements", python_array_of(me, s.element, 'i', s.faces, 0), "nodes",
                         python_array_of(me, s.node, 'i', s.nodes, 0));
}

static PyObject *get_embedded(PyObject *me, void *unused) {
    (void)unused;
    lar_embedded_info s;
    if (!lar_model_embedded(model_of(me), &s)) Py_RETURN_NONE;
    return Py_BuildValue("{s:N,s:N,s:N,s:N}", "triangles",
                         python_array_of(me, s.triangle, 'i', s.triangles, 3), "rest",
                         python_array_of(me, s.rest, 'd', s.vertices, 3), "elements",
                         python_array_of(me, s.element, 'i', s.vertices, 0), "weights",
                         python_array_of(me, s.weight, 'f', s.vertices, 8));
}

static PyObject *embedded_positions(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"displacements", "out", NULL};
    PyObject *u = Py_None, *out = NULL;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|OO:embedded_positions", names, &u, &out))
        return NULL;
    const lar_model *model = model_of(me);
    lar_embedded_info s;
    if (!lar_model_embedded(model, &s)) {
        python_refuse("embedded_positions: this model has no embedded surface");
        return NULL;
    }
    python_rows rows = {.data = NULL};
    if (u != Py_None && !python_doubles(u, "displacements", 3, &rows)) return NULL;
    python_target target;
    bool fits = u == Py_None || rows.rows == lar_model_node_count(model);
    if (!fits)
        python_refuse("displacements: expected shape [%d, 3], got [%zd, 3]",
                      (int)lar_model_node_count(model), rows.rows);
    bool ready = fits && python_target_open(out, 'd', s.vertices, 3, &target);
    if (ready) PYTHON_UNLOCKED(lar_model_embedded_move(model, rows.data, target.data));
    python_rows_free(&rows);
    return ready ? python_target_close(&target, false) : NULL;
}

/* ---- the class ------------------------------------------------------------------------------ */

static PyGetSetDef model_properties[] = {
    {"node_count", get_node_count, NULL, "Number of nodes.", NULL},
    {"element_count", get_element_count, NULL, "Number of hexahedra.", NULL},
    {"source", get_source, NULL, "The file that it was read from; \"model\" when there is none.",
     NULL},
    {"duration", get_duration, NULL, "How long its own description lasts [s], at least 0.", NULL},
    {"output_interval", get_output_interval, NULL,
     "Simulated time between the frames that the scene asks for [s]; 0: it does not say.", NULL},
    {"damping", get_damping, NULL, "Damping in proportion to mass [1/s].", NULL},
    {"info", get_info, NULL,
     "dict: the beginning of what `lariat info` prints, which tells materials, sets and speed as\n"
     "well, by the names of lar_model_info. Counts, bounding box [m], volume [m^3], mass [kg],\n"
     "quality, largest stable step and time step [s], springs [N/m]; elements by index, -1: none;\n"
     "duration [s] as the scene states it, 0: it states none (`Model.duration`: how long it "
     "lasts).\n"
     "Goes through all elements.",
     NULL},
    {"materials", get_materials, NULL,
     "list of dicts: name, law, elements, density [kg/m^3], moduli [Pa], viscous terms, fibres, "
     "active stress along and across these when all of them are active [Pa].",
     NULL},
    {"sets", get_sets, NULL, "list of dicts: name, kind (nodes, elements, faces), count.", NULL},
    {"tools", get_tools, NULL,
     "list of dicts: name, shape, radius, length [m], spread [rad] (scenes and lariat.info have "
     "degrees), friction, rest (a pose), serial.",
     NULL},
    {"notices", get_notices, NULL,
     "list of str: what the file asks for and Lariat leaves out. Read them.", NULL},
    {"positions", get_positions, NULL,
     "memoryview, float64 [nodes, 3], read only: places of the nodes at rest [m]. The library's "
     "own memory: no copy.",
     NULL},
    {"hexahedra", get_hexahedra, NULL,
     "memoryview, int32 [elements, 8]: nodes of each element. A copy.", NULL},
    {"element_materials", get_element_materials, NULL,
     "memoryview, int32 [elements]: index into `materials`. A copy.", NULL},
    {"surface", get_surface, NULL,
     "dict of memoryviews, read only, no copies: faces int32 [faces, 4], counter-clockwise from "
     "outside; elements int32 [faces], the one behind each; nodes int32 [n] on it.",
     NULL},
    {"embedded", get_embedded, NULL,
     "None, or the fine surface for display, a dict of memoryviews, read only, no copies: "
     "triangles int32 [t, 3], rest float64 [v, 3] in metres, elements int32 [v], weights float32 "
     "[v, 8].",
     NULL},
    {NULL, NULL, NULL, NULL, NULL}};

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
static PyMethodDef model_methods[] = {
    {"from_arrays", FUNCTION(python_model_from_arrays), METH_CLASS | METH_VARARGS | METH_KEYWORDS,
     "from_arrays($type, nodes, hexahedra, scene=None, *, tags=None, sets=None, "
     "fibres=None, fibres2=None)\n--\n\n"
     "A model of arrays in memory; no file is read, everything is copied.\n\n"
     "nodes      float64 [n, 3], metres times the scene's `scale`; each belongs to an element\n"
     "hexahedra  int32 [m, 8]: four nodes around the bottom, counter-clockwise seen from above, "
     "then\n"
     "           those above them\n"
     "scene      str (YAML) or dict with the keys of docs/formats.md but `mesh`; None: a soft "
     "default\n"
     "           material and no supports\n"
     "tags       int32 [m], what scenes select by `tag`; None: all 0\n"
     "sets       dict of name: int32 [k] nodes, or name: (kind, int32 [k]) with kind \"nodes\",\n"
     "           \"elements\" or \"faces\" (6 * element + face)\n"
     "fibres     float64 [m, 3], along fibres, of any length, for `direction: mesh`\n"
     "fibres2    the same of a second family, for `second: mesh`\n\n"
     "Nested lists do for arrays. ModelError names the element, node or set that cannot be so."},
    {"embedded_positions", FUNCTION(embedded_positions), METH_VARARGS | METH_KEYWORDS,
     "embedded_positions($self, displacements=None, out=None)\n--\n\n"
     "Places of the embedded surface's vertices [m], float64 [vertices, 3], when the nodes have "
     "moved by `displacements`, float64 [nodes, 3]; None: at rest. `out` is filled where given."},
    {"rays", FUNCTION(python_model_rays), METH_VARARGS | METH_KEYWORDS,
     "rays($self, origins, directions, longest=None, displacements=None)\n--\n\n"
     "As Simulation.rays, against the surface when the nodes have moved by `displacements`, "
     "float64 "
     "[nodes, 3], such as those of Session.snapshot(); None: at rest."},
    {"__deepcopy__", itself, METH_O,
     "Itself, for it never changes: states in memory serve deep copies of a simulation."},
    {"__reduce__", model_reduce, METH_NOARGS,
     "For pickle: models of files are read again from the same path, models of arrays carry them."},
    {NULL, NULL, 0, NULL}};

static PyType_Slot model_slots[] = {
    {Py_tp_doc,
     "Model(path)\n--\n\nWhat is simulated: mesh, materials, supports, loads, tools. "
     "Reads a scene (.yaml), a deck of\nFEBio (.feb) or of Abaqus and CalculiX (.inp), or a "
     "bare mesh (.vtu .vtk .msh). Never changes;\nany number of simulations and threads may "
     "use one. Model.from_arrays makes one of arrays."},
    {Py_tp_new, model_new},
    {Py_tp_dealloc, model_dealloc},
    {Py_tp_repr, model_repr},
    {Py_tp_methods, model_methods},
    {Py_tp_getset, model_properties},
    {0, NULL}};
static PyType_Spec model_spec = {.name = "lariat.Model",
                                 .basicsize = sizeof(python_model),
                                 .flags = Py_TPFLAGS_DEFAULT,
                                 .slots = model_slots};

bool python_model_add(PyObject *module) {
    python_model_type = python_type_add(module, &model_spec, true);
    return python_model_type != NULL;
}
