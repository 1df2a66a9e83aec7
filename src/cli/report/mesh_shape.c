/* A closed surface of g holes and s shells has V - E + F = 2 s - 2 g (Euler and Poincare); E is 3
 * F/2 of triangles and 2 F of quadrilaterals. */
#include "cli/report/mesh_shape.h"

#include <stdlib.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "base/vector.h"

enum { UNUSED = -1 };

/* Holes are the shells of a surface whose corners are joined in `parent`, less what Euler's sum has
 * of them; nodes that are not on it are UNUSED. Returns the shells. */
static int32_t count_holes(const int32_t *parent, int32_t nodes, int64_t faces_less_edges,
                           mesh_shape *shape) {
    int64_t euler = faces_less_edges, shells = 0;
    for (int32_t n = 0; n < nodes; n++) {
        euler += parent[n] != UNUSED;
        shells += parent[n] == n;
    }
    shape->holes = (int32_t)(shells - euler / 2);
    return (int32_t)shells;
}

static void join_used(int32_t *parent, int32_t a, int32_t b) {
    if (parent[a] == UNUSED) parent[a] = a;
    if (parent[b] == UNUSED) parent[b] = b;
    lar_union_join(parent, a, b);
}

bool mesh_shape_of_surface(const lar_surface_arrays *s, double least, mesh_shape *shape) {
    int32_t *parent = lar_calloc((size_t)s->vertices + 1, sizeof *parent);
    double *volume = lar_calloc((size_t)s->vertices + 1, sizeof *volume);
    const bool done = parent && volume;
    *shape = (mesh_shape){0};
    for (int32_t n = 0; done && n < s->vertices; n++) parent[n] = UNUSED;
    for (int32_t i = 0; done && i < s->triangles; i++)
        for (int k = 1; k < 3; k++) join_used(parent, s->triangle[i][0], s->triangle[i][k]);
    /* A hollow has a volume below zero. */
    for (int32_t i = 0; done && i < s->triangles; i++) {
        const int32_t *corner = s->triangle[i];
        double across[3];
        lar_cross(s->vertex[corner[1]], s->vertex[corner[2]], across);
        volume[lar_union_root(parent, corner[0])] += lar_dot(s->vertex[corner[0]], across) / 6;
    }
    for (int32_t n = 0; done && n < s->vertices; n++) {
        shape->bodies += volume[n] > 0;
        shape->hollows += volume[n] < 0 && volume[n] <= -least;
    }
    if (done) count_holes(parent, s->vertices, -(int64_t)s->triangles / 2, shape);
    free(parent);
    free(volume);
    return done;
}

/* A face by its least node and the one across from it, which no other face of hexahedra has. */
typedef struct face_key {
    int32_t least, across, beside[2];
} face_key;

static face_key key_of(const int32_t *element, const int corner[4]) {
    int least = 0;
    for (int a = 1; a < 4; a++)
        if (element[corner[a]] < element[corner[least]]) least = a;
    return (face_key){element[corner[least]],
                      element[corner[(least + 2) % 4]],
                      {element[corner[(least + 1) % 4]], element[corner[(least + 3) % 4]]}};
}

static int by_face(const void *a, const void *b) {
    const face_key *x = a, *y = b;
    if (x->least != y->least) return x->least < y->least ? -1 : 1;
    return (x->across > y->across) - (x->across < y->across);
}

static bool counts(const lar_mesh_arrays *m, int32_t element, const int32_t *tag) {
    return !tag || m->tag[element] == *tag;
}

/* The faces of all elements that count in order: equal ones stand together. NULL: no memory. */
static face_key *sorted_faces(const lar_mesh_arrays *m, const int32_t *tag, size_t *faces) {
    static const int corner[6][4] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4},
                                     {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};
    face_key *face = lar_calloc(6 * (size_t)m->elements + 1, sizeof *face);
    *faces = 0;
    for (int32_t e = 0; face && e < m->elements; e++)
        for (int f = 0; f < 6 && counts(m, e, tag); f++)
            face[(*faces)++] = key_of(m->element[e], corner[f]);
    if (face) qsort(face, *faces, sizeof *face, by_face);
    return face;
}

bool mesh_shape_of_mesh(const lar_mesh_arrays *m, const int32_t *tag, mesh_shape *shape) {
    size_t count = 0;
    int32_t *parent = lar_calloc((size_t)m->nodes + 1, sizeof *parent);
    face_key *face = sorted_faces(m, tag, &count);
    const bool done = parent && face;
    int64_t outer = 0;
    *shape = (mesh_shape){0};
    for (int32_t n = 0; done && n < m->nodes; n++) parent[n] = UNUSED;
    for (int32_t e = 0; done && e < m->elements; e++)
        for (int a = 1; a < 8 && counts(m, e, tag); a++)
            join_used(parent, m->element[e][0], m->element[e][a]);
    for (int32_t n = 0; done && n < m->nodes; n++) shape->bodies += parent[n] == n;
    for (int32_t n = 0; done && n < m->nodes; n++) parent[n] = UNUSED;
    for (size_t i = 0, next; done && i < count; i = next) {
        for (next = i + 1; next < count && by_face(&face[i], &face[next]) == 0;) next++;
        if (next > i + 1) continue; /* between two elements */
        outer++;
        join_used(parent, face[i].least, face[i].across);
        for (int a = 0; a < 2; a++) join_used(parent, face[i].least, face[i].beside[a]);
    }
    if (done) shape->hollows = count_holes(parent, m->nodes, -outer, shape) - shape->bodies;
    free(parent);
    free(face);
    return done;
}
