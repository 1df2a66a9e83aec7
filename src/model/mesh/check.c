#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/mesh/mesh.h"

/* Smallest determinant of the edge directions at a corner, and smallest volume in units of the
 * cubed longest edge, that count as more than rounding. */
static const double FLAT = 1e-12;
/* Coordinates beyond this overflow when three of them are multiplied. */
static const double FARTHEST = 1e60;

/* The node at the other end of the edge of node a along axis 0, 1 or 2. */
static const uint8_t neighbour[8][3] = {{1, 3, 4}, {0, 2, 5}, {3, 1, 6}, {2, 0, 7},
                                        {5, 7, 0}, {4, 6, 1}, {7, 5, 2}, {6, 4, 3}};

static double triple(const double a[3], const double b[3], const double c[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Determinant of the three unit edges at corner a, taken in the directions of xi, eta and zeta;
 * 0 when an edge has no length. */
static double corner_jacobian(const double corner[8][3], int a) {
    double edge[3][3];
    for (int axis = 0; axis < 3; axis++) {
        double length = 0;
        for (int i = 0; i < 3; i++) {
            edge[axis][i] =
                -lar_node_sign[a][axis] * (corner[neighbour[a][axis]][i] - corner[a][i]);
            length += edge[axis][i] * edge[axis][i];
        }
        length = sqrt(length);
        if (!(length > 0)) return 0;
        for (int i = 0; i < 3; i++) edge[axis][i] /= length;
    }
    return triple(edge[0], edge[1], edge[2]);
}

double lar_scaled_jacobian(const double corner[8][3]) {
    double smallest = corner_jacobian(corner, 0);
    for (int a = 1; a < 8; a++) smallest = fmin(smallest, corner_jacobian(corner, a));
    return smallest;
}

/* By the divergence theorem: the volume is the sum of the cones from one point to the six faces.
 * A bilinear face halves the tetrahedron between its two ways of being cut into triangles, so its
 * cone is the mean of both. Exact for the trilinear hexahedron. */
double lar_hexahedron_volume(const double corner[8][3]) {
    double x[8][3], twelfths = 0;
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) x[a][i] = corner[a][i] - corner[0][i];
    for (int f = 0; f < 6; f++) {
        const double *a = x[lar_face_node[f][0]], *b = x[lar_face_node[f][1]];
        const double *c = x[lar_face_node[f][2]], *d = x[lar_face_node[f][3]];
        twelfths += triple(a, b, c) + triple(a, c, d) + triple(a, b, d) + triple(b, c, d);
    }
    return twelfths / 12;
}

static double longest_edge(const double corner[8][3]) {
    double longest = 0;
    for (int a = 0; a < 8; a++)
        for (int axis = 0; axis < 3; axis++) {
            double squared = 0;
            for (int i = 0; i < 3; i++) {
                double d = corner[neighbour[a][axis]][i] - corner[a][i];
                squared += d * d;
            }
            longest = fmax(longest, squared);
        }
    return sqrt(longest);
}

typedef enum { SHAPE_GOOD, SHAPE_FLAT, SHAPE_LEFT_HANDED, SHAPE_INVERTED } element_shape;

static element_shape shape_of(const double corner[8][3]) {
    double edge = longest_edge(corner);
    double volume = lar_hexahedron_volume(corner);
    if (!(fabs(volume) > FLAT * edge * edge * edge)) return SHAPE_FLAT;
    int positive = 0, negative = 0;
    for (int a = 0; a < 8; a++) {
        double jacobian = corner_jacobian(corner, a);
        if (jacobian > FLAT) positive++;
        if (jacobian < -FLAT) negative++;
    }
    if (positive == 8 && volume > 0) return SHAPE_GOOD;
    return negative == 8 ? SHAPE_LEFT_HANDED : SHAPE_INVERTED;
}

static const char *source_of(const lar_mesh *mesh) {
    return mesh->source ? mesh->source : "mesh";
}

/* "file" or "file:line" of an element. */
typedef struct place {
    char text[400];
} place;

static place place_of(const lar_mesh *mesh, int32_t e) {
    place where;
    const int line = mesh->element_line ? mesh->element_line[e] : 0;
    int length = snprintf(where.text, sizeof where.text, "%.380s", source_of(mesh));
    if (line > 0) snprintf(where.text + length, sizeof where.text - (size_t)length, ":%d", line);
    return where;
}

static lar_status check_positions(const lar_mesh *mesh, lar_error *error) {
    for (int32_t n = 0; n < mesh->node_count; n++)
        for (int i = 0; i < 3; i++)
            if (!(fabs(mesh->position[n][i]) <= FARTHEST))
                return lar_fail(error, LAR_ERROR_MODEL,
                                "%s: node %lld has the %c coordinate %g, which is no usable "
                                "number; correct it",
                                source_of(mesh), (long long)mesh->node_id[n], "xyz"[i],
                                mesh -> position[n][i]);
    return LAR_OK;
}

static lar_status check_connectivity(const lar_mesh *mesh, lar_error *error) {
    for (int32_t e = 0; e < mesh->element_count; e++) {
        const int32_t *node = mesh->element[e];
        long long id = (long long)mesh->element_id[e];
        for (int a = 0; a < 8; a++) {
            if (node[a] < 0 || node[a] >= mesh->node_count)
                return lar_fail(error, LAR_ERROR_FORMAT,
                                "%s: element %lld refers to node number %d (from 0), but there "
                                "are %d nodes; the file is damaged, write it again",
                                source_of(mesh), id, node[a], mesh->node_count);
            for (int b = 0; b < a; b++)
                if (node[a] == node[b])
                    return lar_fail(error, LAR_ERROR_MODEL,
                                    "%s: element %lld has node %lld twice; a hexahedron needs "
                                    "eight different nodes, so mesh this place again without "
                                    "collapsed elements",
                                    place_of(mesh, e).text, id, (long long)mesh->node_id[node[a]]);
        }
    }
    return LAR_OK;
}

/* An element and a number that does not depend on the order of its nodes. */
typedef struct fingerprint {
    uint64_t sum;
    int32_t element;
} fingerprint;

static int compare_fingerprints(const void *a, const void *b) {
    const fingerprint *x = a, *y = b;
    if (x->sum != y->sum) return x->sum < y->sum ? -1 : 1;
    return (x->element > y->element) - (x->element < y->element);
}

static bool same_nodes(const int32_t a[8], const int32_t b[8]) {
    int found = 0;
    for (int i = 0; i < 8; i++)
        for (int j = 0; j < 8; j++) found += a[i] == b[j];
    return found == 8; /* no node is twice in an element */
}

/* Two elements in one place would count mass and stiffness twice without any sign of it. */
static lar_status check_repeats(const lar_mesh *mesh, lar_error *error) {
    fingerprint *print = lar_calloc((size_t)mesh->element_count, sizeof *print);
    if (!print)
        return lar_fail_memory(error, (size_t)mesh->element_count * sizeof *print, "the check");
    for (int32_t e = 0; e < mesh->element_count; e++) {
        print[e].element = e;
        for (int a = 0; a < 8; a++) {
            uint64_t mixed = ((uint64_t)mesh->element[e][a] + 1) * UINT64_C(0x9e3779b97f4a7c15);
            print[e].sum += (mixed ^ mixed >> 29) * UINT64_C(0xbf58476d1ce4e5b9);
        }
    }
    qsort(print, (size_t)mesh->element_count, sizeof *print, compare_fingerprints);
    lar_status status = LAR_OK;
    for (int32_t i = 1; i < mesh->element_count && !status; i++) {
        int32_t first = print[i - 1].element, second = print[i].element;
        if (print[i].sum == print[i - 1].sum &&
            same_nodes(mesh->element[first], mesh->element[second]))
            status = lar_fail(error, LAR_ERROR_MODEL,
                              "%s: elements %lld and %lld have the same eight nodes; remove one of "
                              "them (a Gmsh file of version 2 may hold an element once per "
                              "physical group: save it as version 4.1)",
                              place_of(mesh, second).text, (long long)mesh->element_id[first],
                              (long long)mesh->element_id[second]);
    }
    free(print);
    return status;
}

static lar_status check_sets(const lar_mesh *mesh, lar_error *error) {
    for (int32_t s = 0; s < mesh->set_count; s++) {
        const lar_set *set = &mesh->set[s];
        int64_t range = set->kind == LAR_SET_NODES      ? mesh->node_count
                        : set->kind == LAR_SET_ELEMENTS ? mesh->element_count
                                                        : (int64_t)mesh->element_count * 6;
        for (int32_t i = 0; i < set->count; i++)
            if (set->index[i] < 0 || set->index[i] >= range)
                return lar_fail(error, LAR_ERROR_FORMAT,
                                "%s: set '%s' holds the number %d, but only 0 to %lld exist; "
                                "the file is damaged, write it again",
                                source_of(mesh), set->name, set->index[i], (long long)range - 1);
    }
    return LAR_OK;
}

void lar_mesh_turn(lar_mesh *mesh) {
    if (mesh->collapsed_count > 0) return;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(mesh, e, corner);
        if (shape_of((const double(*)[3])corner) != SHAPE_LEFT_HANDED) return;
    }
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 4; a++) {
            int32_t low = mesh->element[e][a];
            mesh->element[e][a] = mesh->element[e][a + 4];
            mesh->element[e][a + 4] = low;
        }
    for (int32_t s = 0; s < mesh->set_count; s++)
        for (int32_t i = 0; mesh->set[s].kind == LAR_SET_FACES && i < mesh->set[s].count; i++) {
            int32_t *face = &mesh->set[s].index[i];
            if (*face % 6 >= 4) *face ^= 1; /* 6 e + 4 and 6 e + 5: below and above */
        }
    mesh->turned = mesh->element_count > 0;
}

static lar_status check_shapes(const lar_mesh *mesh, lar_error *error) {
    int32_t bad = -1;
    element_shape shape_of_bad = SHAPE_GOOD;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(mesh, e, corner);
        element_shape shape = shape_of((const double(*)[3])corner);
        if (shape == SHAPE_GOOD || bad >= 0) continue;
        bad = e;
        shape_of_bad = shape;
    }
    if (bad < 0) return LAR_OK;

    long long id = (long long)mesh->element_id[bad];
    if (shape_of_bad == SHAPE_FLAT)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: element %lld has no volume: its nodes lie in one plane or in one "
                        "place; remove it or move its nodes apart",
                        place_of(mesh, bad).text, id);
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s: element %lld is %s, with a Jacobian that is not positive at every "
                    "corner: its node order may be wrong (expected: 1-4 around the bottom, 5-8 "
                    "above them, counter-clockwise seen from above) or its nodes are tangled; "
                    "correct the order or mesh this place again",
                    place_of(mesh, bad).text, id,
                    shape_of_bad == SHAPE_LEFT_HANDED ? "inside out" : "inverted or too distorted");
}

/* The command for a file, in quotes where a shell needs them. */
static lar_status refuse_collapsed(const lar_mesh *mesh, lar_error *error) {
    const char *source = source_of(mesh), *quote = "";
    char line[16] = "";
    if (mesh->collapsed_line > 0) snprintf(line, sizeof line, ":%d", mesh->collapsed_line);
    for (const char *c = source; *c; c++)
        if (strchr(" \t'\"\\$&;|<>()*?[]#~`!{}", *c)) quote = strchr(source, '\'') ? "\"" : "'";
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "%s%s: element %lld is a %s, but Lariat computes with eight-node hexahedra; "
                    "make them of the mesh's boundary and regions: lariat mesh %s%s%s",
                    source, line, (long long)mesh->collapsed_id, mesh->collapsed_name, quote,
                    source, quote);
}

lar_status lar_mesh_check_solids(const lar_mesh *mesh, lar_error *error) {
    if (mesh->element_count <= 0)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: holds no solid elements; save the volume mesh, or give its surface as "
                        ".stl .obj .vtk .vtp",
                        source_of(mesh));
    return check_positions(mesh, error);
}

lar_status lar_mesh_check(const lar_mesh *mesh, lar_error *error) {
    if (mesh->element_count <= 0)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: holds no eight-node hexahedra; mesh the volume with hexahedra",
                        source_of(mesh));
    if (mesh->collapsed_count > 0) return refuse_collapsed(mesh, error);
    lar_status status = check_positions(mesh, error);
    if (!status) status = check_connectivity(mesh, error);
    if (!status) status = check_sets(mesh, error);
    if (!status) status = check_shapes(mesh, error);
    if (!status) status = check_repeats(mesh, error);
    return status;
}
