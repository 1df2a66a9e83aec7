#include "model/mesh/faces.h"

#include <stdlib.h>
#include <string.h>

#include "base/vector.h"

void lar_face_sort_nodes(int32_t node[4]) {
    for (int i = 1; i < 4; i++) {
        int32_t moving = node[i];
        int j = i;
        for (; j > 0 && node[j - 1] > moving; j--) node[j] = node[j - 1];
        node[j] = moving;
    }
}

static int compare_nodes(const int32_t a[4], const int32_t b[4]) {
    for (int i = 0; i < 4; i++)
        if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
    return 0;
}

static int compare_keys(const void *a, const void *b) {
    const lar_face_key *x = a, *y = b;
    int nodes = compare_nodes(x->node, y->node);
    return nodes ? nodes : (x->face > y->face) - (x->face < y->face);
}

bool lar_face_key_same(const lar_face_key *a, const lar_face_key *b) {
    return compare_nodes(a->node, b->node) == 0;
}

static lar_face_key face_key(const lar_mesh *mesh, int32_t e, int f) {
    lar_face_key key = {.face = e * 6 + f};
    for (int i = 0; i < 4; i++) key.node[i] = mesh->element[e][lar_face_node[f][i]];
    lar_face_sort_nodes(key.node);
    return key;
}

lar_status lar_face_table_build(const lar_mesh *mesh, lar_face_table *table, lar_error *error) {
    size_t count = (size_t)mesh->element_count * 6;
    size_t *start = lar_calloc((size_t)mesh->node_count + 1, sizeof *start);
    table->key = lar_calloc(count, sizeof *table->key);
    if (!start || !table->key) {
        free(start);
        free(table->key);
        *table = (lar_face_table){0};
        return lar_fail_memory(error, count * sizeof *table->key, "the faces of the mesh");
    }
    table->count = count;

    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int f = 0; f < 6; f++) start[face_key(mesh, e, f).node[0] + 1]++;
    for (int32_t n = 0; n < mesh->node_count; n++) start[n + 1] += start[n];
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int f = 0; f < 6; f++) {
            lar_face_key key = face_key(mesh, e, f);
            table->key[start[key.node[0]]++] = key;
        }
    /* start[n] is now the end of bucket n. */
    for (int32_t n = 0; n < mesh->node_count; n++) {
        size_t first = n == 0 ? 0 : start[n - 1];
        if (start[n] - first > 1)
            qsort(table->key + first, start[n] - first, sizeof *table->key, compare_keys);
    }
    free(start);
    return LAR_OK;
}

const lar_face_key *lar_face_table_find(const lar_face_table *table, const int32_t node[4]) {
    size_t low = 0, high = table->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (compare_nodes(table->key[middle].node, node) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    bool found = low < table->count && compare_nodes(table->key[low].node, node) == 0;
    return found ? &table->key[low] : NULL;
}

static int compare_faces(const void *a, const void *b) {
    int32_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

lar_status lar_mesh_boundary(const lar_mesh *mesh, int32_t **faces, int32_t *count,
                             lar_error *error) {
    lar_face_table table = {0};
    lar_status status = lar_face_table_build(mesh, &table, error);
    if (status) return status;

    int32_t single = 0;
    for (size_t i = 0, next; i < table.count; i = next) {
        for (next = i + 1; next < table.count; next++)
            if (!lar_face_key_same(&table.key[i], &table.key[next])) break;
        /* The first keys are read already; what is found moves to the front. */
        if (next == i + 1) table.key[single++] = table.key[i];
    }
    int32_t *found = lar_calloc((size_t)single, sizeof *found);
    if (!found) {
        free(table.key);
        return lar_fail_memory(error, (size_t)single * sizeof *found, "the boundary faces");
    }
    for (int32_t i = 0; i < single; i++) found[i] = table.key[i].face;
    free(table.key);
    qsort(found, (size_t)single, sizeof *found, compare_faces);
    *faces = found;
    *count = single;
    return LAR_OK;
}

void lar_face_share(const lar_mesh *mesh, int32_t face, double sign, double (*share)[4]) {
    static const double at[2] = {-0.57735026918962576, 0.57735026918962576};
    static const int side[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    const int32_t *element = mesh->element[face / 6];
    for (int point = 0; point < 4; point++) {
        double r = at[point % 2], s = at[point / 2], along[2][3] = {{0}}, normal[3];
        for (int a = 0; a < 4; a++)
            for (int i = 0; i < 3; i++) {
                double x = 0.25 * mesh->position[element[lar_face_node[face % 6][a]]][i];
                along[0][i] += side[a][0] * (1 + side[a][1] * s) * x;
                along[1][i] += side[a][1] * (1 + side[a][0] * r) * x;
            }
        lar_cross(along[0], along[1], normal);
        for (int a = 0; a < 4; a++) {
            double part = 0.25 * (1 + side[a][0] * r) * (1 + side[a][1] * s);
            double *to = share[element[lar_face_node[face % 6][a]]];
            for (int i = 0; i < 3; i++) to[i] += part * sign * normal[i];
            to[3] += part * lar_length(normal);
        }
    }
}
