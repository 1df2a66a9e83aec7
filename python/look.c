/* Looking at a body: rays against its surface, stress and strain of its elements, forces on its
 * nodes. */
#include <math.h>

#include "module.h"

/* ---- rays ----------------------------------------------------------------------------------- */

static PyObject *hit_dict(const lar_ray_hit *h) {
    if (h->face < 0) Py_RETURN_NONE;
    return Py_BuildValue("{s:d,s:N,s:N,s:i,s:i,s:i}", "distance", h->distance, "point",
                         python_tuple(h->point, 3), "normal", python_tuple(h->normal, 3), "face",
                         (int)h->face, "element", (int)h->element, "body", (int)h->body);
}

/* One array for each field; the others are let go of where one cannot be made. */
static PyObject *hits_dict(const lar_ray_hit *hit, Py_ssize_t count) {
    static const struct {
        const char *name;
        char format;
        int columns;
    } column[] = {{"distances", 'd', 0}, {"points", 'd', 3},   {"normals", 'd', 3},
                  {"faces", 'i', 0},     {"elements", 'i', 0}, {"bodies", 'i', 0}};
    enum { COLUMNS = sizeof column / sizeof column[0] };
    void *data[COLUMNS];
    PyObject *dict = PyDict_New();
    for (int c = 0; c < COLUMNS && dict; c++) {
        PyObject *array = python_array_new(column[c].format, count, column[c].columns, &data[c]);
        if (!array || PyDict_SetItemString(dict, column[c].name, array)) Py_CLEAR(dict);
        Py_XDECREF(array);
    }
    for (Py_ssize_t k = 0; k < count && dict; k++) {
        ((double *)data[0])[k] = hit[k].distance;
        memcpy((double *)data[1] + 3 * k, hit[k].point, sizeof hit[k].point);
        memcpy((double *)data[2] + 3 * k, hit[k].normal, sizeof hit[k].normal);
        ((int32_t *)data[3])[k] = hit[k].face;
        ((int32_t *)data[4])[k] = hit[k].element;
        ((int32_t *)data[5])[k] = hit[k].body;
    }
    return dict;
}

/* Rays that were asked for, and where the nodes are. */
typedef struct rays {
    python_rows origin, direction, displacement;
    double longest;
    double (*u)[3]; /* owned */
    lar_ray_hit *hit;
} rays;

static void rays_free(rays *r) {
    python_rows_free(&r->origin);
    python_rows_free(&r->direction);
    python_rows_free(&r->displacement);
    free(r->u);
    free(r->hit);
}

/* None: any distance. */
static bool longest_parse(PyObject *source, rays *r) {
    r->longest = source == Py_None ? INFINITY : PyFloat_AsDouble(source);
    if (PyErr_Occurred()) {
        PyErr_Clear();
        return python_refuse_type("longest: expected a number, got %R",
                                  (PyObject *)Py_TYPE(source));
    }
    return r->longest >= 0 ||
           python_refuse(
               "longest: expected the longest distance, 0 or more, or None for any, got %R",
               source);
}

/* Where a ray can begin, and whether it has a direction. `row`: of many. */
static bool check_ray(const double origin[3], const double direction[3], Py_ssize_t row) {
    static const double FARTHEST = 1e30; /* [m] */
    char which[2][40] = {"origin", "direction"};
    if (row >= 0) snprintf(which[0], sizeof which[0], "origins: row %zd", row);
    if (row >= 0) snprintf(which[1], sizeof which[1], "directions: row %zd", row);
    for (int i = 0; i < 3; i++)
        if (!(fabs(origin[i]) <= FARTHEST))
            return python_refuse("%s: expected three numbers in metres, none beyond 1e30",
                                 which[0]);
    return direction[0] != 0 || direction[1] != 0 || direction[2] != 0 ||
           python_refuse("%s: expected three numbers, which cannot all be 0", which[1]);
}

static bool rays_parse(PyObject *origins, PyObject *directions, PyObject *longest, rays *r) {
    if (!longest_parse(longest, r)) return false;
    if (!python_doubles(origins, "origins", 3, &r->origin) ||
        !python_doubles(directions, "directions", 3, &r->direction))
        return false;
    if (r->direction.rows != r->origin.rows)
        return python_refuse("directions: expected one for each of %zd origins, got %zd",
                             r->origin.rows, r->direction.rows);
    if (r->origin.rows > INT32_MAX) return python_refuse("origins: at most 2^31 - 1");
    const double(*from)[3] = r->origin.data, (*along)[3] = r->direction.data;
    for (Py_ssize_t k = 0; k < r->origin.rows; k++)
        if (!check_ray(from[k], along[k], k)) return false;
    r->hit = calloc((size_t)r->origin.rows + 1, sizeof *r->hit);
    return r->hit || PyErr_NoMemory() != NULL;
}

PyObject *python_model_rays(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"origins", "directions", "longest", "displacements", NULL};
    const lar_model *model = ((python_model *)me)->model;
    PyObject *origins, *directions, *longest = Py_None, *u = Py_None;
    rays r = {.hit = NULL};
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "OO|OO:rays", names, &origins, &directions,
                                     &longest, &u))
        return NULL;
    bool good = rays_parse(origins, directions, longest, &r) &&
                (u == Py_None || python_doubles(u, "displacements", 3, &r.displacement));
    if (good && u != Py_None && r.displacement.rows != lar_model_node_count(model))
        good = python_refuse("displacements: expected shape [%d, 3], got [%zd, 3]",
                             (int)lar_model_node_count(model), r.displacement.rows);
    const double *moved = good ? r.displacement.data : NULL;
    for (Py_ssize_t k = 0; good && moved && k < 3 * r.displacement.rows; k++)
        if (!(fabs(moved[k]) <= 1e29))
            good = python_refuse("displacements: row %zd has a number beyond 1e29 m", k / 3);
    PyObject *answer = NULL;
    lar_error error;
    lar_status status;
    if (good) {
        PYTHON_UNLOCKED(status = lar_model_rays(model, r.displacement.data, (int32_t)r.origin.rows,
                                                r.origin.data, r.direction.data, r.longest, r.hit,
                                                &error));
        answer = status ? python_raise(&error) : hits_dict(r.hit, r.origin.rows);
    }
    rays_free(&r);
    return answer;
}

/* From a simulation, whose nodes are where they are now. */
static bool shoot(python_simulation *self, const char *call, const void *origin,
                  const void *direction, int32_t count, rays *r) {
    const lar_model *model = self->model->model;
    lar_simulation *simulation = python_simulation_take(self, call);
    if (!simulation) return false;
    lar_error error = {.status = LAR_ERROR_MEMORY, .message = "no memory for rays"};
    lar_status status = LAR_ERROR_MEMORY;
    r->u = malloc(((size_t)lar_model_node_count(model) + 1) * sizeof *r->u);
    PYTHON_UNLOCKED(if (r->u) {
        lar_simulation_displacements(simulation, r->u);
        status = lar_model_rays(model, (const double(*)[3])r->u, count, origin, direction,
                                r->longest, r->hit, &error);
    });
    python_simulation_give(self);
    return !status || python_raise(&error) != NULL;
}

static PyObject *simulation_rays(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"origins", "directions", "longest", NULL};
    PyObject *origins, *directions, *longest = Py_None, *answer = NULL;
    rays r = {.hit = NULL};
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "OO|O:rays", names, &origins, &directions,
                                     &longest))
        return NULL;
    if (rays_parse(origins, directions, longest, &r) &&
        shoot((python_simulation *)me, "rays", r.origin.data, r.direction.data,
              (int32_t)r.origin.rows, &r))
        answer = hits_dict(r.hit, r.origin.rows);
    rays_free(&r);
    return answer;
}

static PyObject *simulation_ray(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"origin", "direction", "longest", NULL};
    PyObject *origin, *direction, *longest = Py_None, *answer = NULL;
    double from[3], along[3];
    rays r = {.hit = NULL};
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "OO|O:ray", names, &origin, &direction,
                                     &longest) ||
        !python_vector(origin, "origin", 3, from) ||
        !python_vector(direction, "direction", 3, along) || !check_ray(from, along, -1) ||
        !longest_parse(longest, &r))
        return NULL;
    r.hit = calloc(1, sizeof *r.hit);
    if (!r.hit) return PyErr_NoMemory();
    if (shoot((python_simulation *)me, "ray", from, along, 1, &r)) answer = hit_dict(r.hit);
    rays_free(&r);
    return answer;
}

/* ---- stress and strain ---------------------------------------------------------------------- */

/* Hencky's strain ln(C) / 2 from Green and Lagrange's, (C - 1) / 2: by Jacobi's rotations, which
 * keep small parts of a tensor as exact as large ones. */
static void to_logarithmic(double strain[6]) {
    double a[3][3] = {{strain[0], strain[3], strain[5]},
                      {strain[3], strain[1], strain[4]},
                      {strain[5], strain[4], strain[2]}};
    double q[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int turn = 0; turn < 24; turn++) {
        const int i = turn % 3 == 2 ? 1 : 0, j = turn % 3 == 0 ? 1 : 2;
        if (a[i][j] == 0) continue;
        const double half = (a[j][j] - a[i][i]) / (2 * a[i][j]);
        const double t = copysign(1, half) / (fabs(half) + sqrt(1 + half * half));
        const double c = 1 / sqrt(1 + t * t), s = t * c;
        for (int k = 0; k < 3; k++) {
            const double x = a[k][i], y = a[k][j], p = q[k][i], r = q[k][j];
            a[k][i] = c * x - s * y, a[k][j] = s * x + c * y;
            q[k][i] = c * p - s * r, q[k][j] = s * p + c * r;
        }
        for (int k = 0; k < 3; k++) {
            const double x = a[i][k], y = a[j][k];
            a[i][k] = c * x - s * y, a[j][k] = s * x + c * y;
        }
    }
    static const int row[] = {0, 1, 2, 0, 1, 2}, column[] = {0, 1, 2, 1, 2, 0};
    for (int v = 0; v < 6; v++) strain[v] = 0;
    for (int k = 0; k < 3; k++) {
        const double part = 0.5 * log1p(2 * a[k][k]);
        for (int v = 0; v < 6; v++) strain[v] += part * q[row[v]][k] * q[column[v]][k];
    }
}

typedef enum tensor { STRESS, STRAIN, LOGARITHMIC } tensor;

static PyObject *tensors(PyObject *me, PyObject *out, const char *call, tensor kind) {
    python_simulation *self = (python_simulation *)me;
    const int32_t elements = lar_model_element_count(self->model->model);
    python_target target;
    if (!python_target_open(out, 'd', elements, 6, &target)) return NULL;
    lar_simulation *simulation = python_simulation_take(self, call);
    if (!simulation) return python_target_close(&target, true);
    lar_error error;
    lar_status status;
    double(*value)[6] = target.data;
    PYTHON_UNLOCKED({
        status = lar_simulation_stresses(simulation, kind == STRESS ? value : NULL,
                                         kind == STRESS ? NULL : value, &error);
        for (int32_t e = 0; e < elements && !status && kind == LOGARITHMIC; e++)
            to_logarithmic(value[e]);
    });
    python_simulation_give(self);
    if (status) python_raise(&error);
    return python_target_close(&target, status != LAR_OK);
}

static PyObject *stresses(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"out", NULL};
    PyObject *out = NULL;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|O:stresses", names, &out)) return NULL;
    return tensors(me, out, "stresses", STRESS);
}

static PyObject *strains(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"out", "logarithmic", NULL};
    PyObject *out = NULL;
    int logarithmic = 0;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|O$p:strains", names, &out, &logarithmic))
        return NULL;
    return tensors(me, out, "strains", logarithmic ? LOGARITHMIC : STRAIN);
}

/* ---- forces on nodes ------------------------------------------------------------------------ */

static bool find_cause(const char *name, lar_cause *cause) {
    static const char *const names[] = {
        [LAR_CAUSE_ELEMENTS] = "elements", [LAR_CAUSE_TOOL] = "tool",
        [LAR_CAUSE_BODIES] = "bodies",     [LAR_CAUSE_LOADS] = "loads",
        [LAR_CAUSE_PLANES] = "planes",     [LAR_CAUSE_SUPPORTS] = "supports",
        [LAR_CAUSE_GRAVITY] = "gravity",   [LAR_CAUSE_DAMPING] = "damping"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        *cause = (lar_cause)i;
        if (strcmp(name, names[i]) == 0) return true;
    }
    return python_refuse("cause: \"%s\" is none; there are elements, tool, bodies, loads, "
                         "planes, supports, gravity and damping",
                         name);
}

static PyObject *nodal_forces(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"cause", "tool", "out", NULL};
    python_simulation *self = (python_simulation *)me;
    const char *name;
    PyObject *word, *tool = Py_None, *out = NULL;
    lar_cause cause;
    int32_t index = -1;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "O|OO:nodal_forces", names, &word, &tool,
                                     &out) ||
        !(name = python_text(word, "cause")) || !find_cause(name, &cause))
        return NULL;
    if ((tool != Py_None) != (cause == LAR_CAUSE_TOOL)) {
        python_refuse("nodal_forces: the cause \"tool\" needs a tool, and the others take none");
        return NULL;
    }
    lar_simulation *simulation = tool == Py_None
                                     ? python_simulation_look(self, "nodal_forces")
                                     : python_simulation_tool(self, "nodal_forces", tool, &index);
    if (!simulation) return NULL;
    python_target target;
    if (!python_target_open(out, 'd', lar_model_node_count(self->model->model), 3, &target))
        return NULL;
    simulation = python_simulation_take(self, "nodal_forces");
    if (!simulation) return python_target_close(&target, true);
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status =
                        lar_simulation_nodal_forces(simulation, cause, index, target.data, &error));
    python_simulation_give(self);
    if (status) python_raise(&error);
    return python_target_close(&target, status != LAR_OK);
}

static PyObject *contact_pressure(PyObject *me, PyObject *args, PyObject *keywords) {
    static char *names[] = {"out", "traction", NULL};
    python_simulation *self = (python_simulation *)me;
    PyObject *out = NULL;
    int traction = 0;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "|O$p:contact_pressure", names, &out,
                                     &traction))
        return NULL;
    if (!python_simulation_look(self, "contact_pressure")) return NULL;
    python_target target;
    if (!python_target_open(out, 'd', lar_model_node_count(self->model->model), traction ? 3 : 0,
                            &target))
        return NULL;
    lar_simulation *simulation = python_simulation_take(self, "contact_pressure");
    if (!simulation) return python_target_close(&target, true);
    lar_error error;
    lar_status status;
    PYTHON_UNLOCKED(status =
                        lar_simulation_contact_pressure(simulation, traction ? target.data : NULL,
                                                        traction ? NULL : target.data, &error));
    python_simulation_give(self);
    if (status) python_raise(&error);
    return python_target_close(&target, status != LAR_OK);
}

#define FUNCTION(f) ((PyCFunction)(void (*)(void))(f))
#define OUT_DOC                                                                                    \
    " float64 [elements, 6] as xx, yy, zz, xy, yz, zx: components of tensors, shear without a "    \
    "factor 2; not finite in an element that is inside out. Into `out` where given."
PyMethodDef python_look_methods[] = {
    {"ray", FUNCTION(simulation_ray), METH_VARARGS | METH_KEYWORDS,
     "ray($self, origin, direction, longest=None)\n--\n\nWhat a ray meets first of the outer "
     "surface "
     "as it is now: a dict of distance [m], point [m], normal (outwards, of length 1), face (of "
     "Model.surface), element behind it and body (the connected part of the mesh, from 0); None: "
     "nothing within `longest` [m], or at all. `direction` has any length but 0. The same on every "
     "grid."},
    {"rays", FUNCTION(simulation_rays), METH_VARARGS | METH_KEYWORDS,
     "rays($self, origins, directions, longest=None)\n--\n\nMany rays at once, float64 [n, 3] "
     "each: "
     "a dict of memoryviews: distances float64 [n] [m], inf where nothing is met; points [n, 3] "
     "[m] "
     "and normals [n, 3]; faces, elements and bodies int32 [n], -1 where nothing is met."},
    {"nodal_forces", FUNCTION(nodal_forces), METH_VARARGS | METH_KEYWORDS,
     "nodal_forces($self, cause, tool=None, out=None)\n--\n\nForces on all nodes by one cause [N], "
     "float64 [nodes, 3], in the mesh's order: elements (stress of every kind, hourglass control "
     "and barriers together), tool (with `tool`, by place or name: what it pushes, holds and "
     "rubs), bodies (contact with each other and themselves), loads (forces, pressures and springs "
     "of the model, forces that were set), planes, supports, gravity or damping. Those that the "
     "next step begins "
     "with: all together are mass times acceleration, a tool's sum up to minus the force that it "
     "feels in that step, to the last bit where the step is not divided and the tool is not "
     "limited (a limited one decides anew where it goes when the step begins). Into `out` where "
     "given."},
    {"contact_pressure", FUNCTION(contact_pressure), METH_VARARGS | METH_KEYWORDS,
     "contact_pressure($self, out=None, *, traction=False)\n--\n\nWhat other bodies, planes and "
     "tools push the surface with now, per area [Pa]: float64 [nodes], positive inwards, or with "
     "`traction` the vector, [nodes, 3], friction included. The area is that around a node of the "
     "faces that look against the force; 0 where nothing touches. Into `out` where given."},
    {"stresses", FUNCTION(stresses), METH_VARARGS | METH_KEYWORDS,
     "stresses($self, out=None)\n--\n\nMean Cauchy stress of every element now [Pa], viscous and "
     "active stress included," OUT_DOC},
    {"strains", FUNCTION(strains), METH_VARARGS | METH_KEYWORDS,
     "strains($self, out=None, *, logarithmic=False)\n--\n\nGreen-Lagrange strain (F^T F - 1) / 2 "
     "of every element's mean deformation gradient F now, or Hencky's ln(F^T F) / 2, which is the "
     "logarithm of lengths," OUT_DOC},
    {NULL, NULL, 0, NULL}};
