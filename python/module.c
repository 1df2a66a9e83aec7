/* The module itself: types, functions that belong to no class. One interpreter only: what it knows
 * of types stands in variables of the process, as the library's own things do. */
#include <pthread.h>

#include "module.h"

unsigned python_generation;

static void after_fork(void) {
    python_generation++;
}

void python_object_free(PyObject *object) {
    PyTypeObject *type = Py_TYPE(object);
    freefunc release = (freefunc)PyType_GetSlot(type, Py_tp_free);
    release(object);
    Py_DECREF((PyObject *)type);
}

PyTypeObject *python_type_add(PyObject *module, PyType_Spec *spec, bool is_public) {
    PyObject *type = PyType_FromSpec(spec);
    if (!type || !is_public) return (PyTypeObject *)type;
    if (PyModule_AddObjectRef(module, strrchr(spec->name, '.') + 1, type) < 0) Py_CLEAR(type);
    return (PyTypeObject *)type;
}

/* Types keep their tables for as long as they live, which is the process. */
PyMethodDef *python_join_methods(PyMethodDef *const *tables, int count) {
    size_t total = 0, at = 0;
    for (int t = 0; t < count; t++)
        for (const PyMethodDef *row = tables[t]; row->ml_name; row++) total++;
    PyMethodDef *all = calloc(total + 1, sizeof *all);
    for (int t = 0; all && t < count; t++)
        for (const PyMethodDef *row = tables[t]; row->ml_name; row++) all[at++] = *row;
    return all;
}

PyGetSetDef *python_join_properties(PyGetSetDef *const *tables, int count) {
    size_t total = 0, at = 0;
    for (int t = 0; t < count; t++)
        for (const PyGetSetDef *row = tables[t]; row->name; row++) total++;
    PyGetSetDef *all = calloc(total + 1, sizeof *all);
    for (int t = 0; all && t < count; t++)
        for (const PyGetSetDef *row = tables[t]; row->name; row++) all[at++] = *row;
    return all;
}

/* ---- functions ------------------------------------------------------------------------------ */

static PyObject *demo(PyObject *module, PyObject *folder) {
    (void)module;
    PyObject *path = python_path(folder, "folder");
    if (!path) return NULL;
    const char *bytes = PyBytes_AsString(path);
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = lar_demo_write(bytes, &error));
    PyObject *text = status ? python_raise(&error) : PyUnicode_DecodeFSDefault(bytes);
    Py_DECREF(path);
    return text;
}

static PyObject *checkpoint_info(PyObject *module, PyObject *source) {
    (void)module;
    static const char *const elements[] = {"hex8", "hex8-full", "hex8-matrix"};
    PyObject *path = python_path(source, "path");
    if (!path) return NULL;
    const char *bytes = PyBytes_AsString(path);
    lar_checkpoint_info i;
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status = lar_checkpoint_inspect(bytes, &i, &error));
    Py_DECREF(path);
    if (status) return python_raise(&error);
    return Py_BuildValue("{s:s,s:i,s:i,s:i,s:i,s:d,s:K}", "element", elements[i.element], "nodes",
                         (int)i.nodes, "elements", (int)i.elements, "tools", (int)i.tools, "spares",
                         (int)i.spares, "time_step", i.time_step, "step",
                         (unsigned long long)i.step);
}

static PyMethodDef functions[] = {
    {"write_demo", demo, METH_O,
     "write_demo(folder)\n--\n\nWrites the demonstration organ into a folder: uterus.vtu and its "
     "scenes uterus.yaml (pulled by a force) and uterus_live.yaml (to take hold of). A scene "
     "that is there already and differs, as after an edit, is left as it is. Returns the folder."},
    {"mesh", (PyCFunction)(void (*)(void))python_mesh, METH_VARARGS | METH_KEYWORDS,
     "mesh(source, triangles=None, *, affine=None, label=None, names=None, elements=0, size=0.0,\n"
     "     scale=0.0, fuse=False, principal=False, voxel=False, fix=None, title=None,\n"
     "     progress=None, fibres=None, fibres_in=None, tissue=None, apart=False)\n--\n\n"
     "Hexahedra that lie on the true boundary of a body, and a scene that runs: a Meshing.\n\n"
     "source     a path: label image (.nii .nii.gz .nrrd .nhdr), surface (.stl .obj .vtk .vtp) or "
     "mesh\n"
     "           (.msh .vtu .vtk .inp .feb); or a list of paths of surfaces, one region each;\n"
     "           an array of integers [i, j, k], 0 for nothing, with `affine`;\n"
     "           vertices, float64 [v, 3], with `triangles`;\n"
     "           a dict of name: (vertices, triangles), one region each, the later one goes first\n"
     "triangles  int32 [t, 3] vertices, counter-clockwise from outside; the surface is closed\n"
     "affine     float64 [4, 4] or [3, 4]: voxel (i, j, k, 1) to the world times 1 / scale, +x "
     "right,\n"
     "           +y front, +z head\n"
     "label      a name or a number of the image, or a list of them, each a region; None: all\n"
     "names      dict of label: name for an array; the path of a list LABEL,NAME for a file\n"
     "elements   about so many (5000), or\n"
     "size       edge of an element [m]\n"
     "scale      metres per unit of vertices, of `affine`, of a file of surfaces or solids (1)\n"
     "fuse       all labels become one region\n"
     "principal  elements along the body's principal axes\n"
     "voxel      cubes on a grid; without elements and size the image's own voxels\n"
     "fix        where it is held: left, right, back, front, bottom, top, cut, none\n"
     "title      and the name of its files\n"
     "progress   called with a stage and the part of it that is done, 0..1; False stops\n"
     "fibres     along what they run, a rule as scenes have it: \"axis: [0, 0, 1]\"\n"
     "fibres_in  name of the region that has them; None: all but bones\n"
     "tissue     path of a tissue file in place of the literature's figures, for all regions but "
     "bones;\n"
     "           or a dict of region: path, with None for all but bones; the later one counts. "
     "Fibres\n"
     "           in it need `fibres`\n"
     "apart      regions are bodies of their own, which touch where they meet\n\n"
     "Works on all cores and lets other threads run; Ctrl-C ends it at the next stage or round."},
    {"checkpoint_info", checkpoint_info, METH_O,
     "checkpoint_info(path)\n--\n\ndict of a checkpoint: element, nodes, elements, tools, spares, "
     "time_step [s], step. A simulation that shall take it up needs the same element, "
     "time_step\nand model, tools and hands; spares are places of tools that were added."},
    {NULL, NULL, 0, NULL}};

static struct PyModuleDef definition = {.m_base = PyModuleDef_HEAD_INIT,
                                        .m_name = "lariat._lariat",
                                        .m_doc = "The extension behind the package lariat.",
                                        .m_size = -1,
                                        .m_methods = functions};

PyMODINIT_FUNC PyInit__lariat(void);
PyMODINIT_FUNC PyInit__lariat(void) {
    if (python_model_type) {
        PyErr_SetString(PyExc_ImportError, "lariat serves one interpreter of a process only");
        return NULL;
    }
    PyObject *module = PyModule_Create(&definition);
    if (!module) return NULL;
    bool ok = python_errors_add(module) && python_array_add(module) && python_model_add(module) &&
              python_meshing_add(module) && python_saved_add(module) &&
              python_simulation_add(module) && python_results_add(module) &&
              python_batch_add(module) && python_session_add(module) && python_view_add(module) &&
              pthread_atfork(NULL, NULL, after_fork) == 0 &&
              PyModule_AddStringConstant(module, "__version__", lar_version()) == 0;
    if (!ok) Py_CLEAR(module);
    return module;
}
