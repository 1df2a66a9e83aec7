#include "model/mesh/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/union_find.h"

const uint8_t lar_face_node[6][4] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4},
                                     {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};

const uint8_t lar_edge_node[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                      {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};

const int8_t lar_node_sign[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                    {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};

const uint8_t *lar_solid_corners(int corners) {
    static const uint8_t TETRAHEDRON[8] = {0, 1, 2, 2, 3, 3, 3, 3};
    static const uint8_t PYRAMID[8] = {0, 1, 2, 3, 4, 4, 4, 4};
    static const uint8_t PRISM[8] = {0, 1, 2, 2, 3, 4, 5, 5};
    return corners == 4 ? TETRAHEDRON : corners == 5 ? PYRAMID : corners == 6 ? PRISM : NULL;
}

lar_status lar_mesh_allocate(lar_mesh *mesh, const char *source, size_t nodes, size_t elements,
                             lar_error *error) {
    mesh->source = lar_strdup(source);
    mesh->position = lar_calloc(nodes, sizeof *mesh->position);
    mesh->node_id = lar_calloc(nodes, sizeof *mesh->node_id);
    mesh->element = lar_calloc(elements, sizeof *mesh->element);
    mesh->element_id = lar_calloc(elements, sizeof *mesh->element_id);
    mesh->element_tag = lar_calloc(elements, sizeof *mesh->element_tag);
    bool all = mesh->source && mesh->position && mesh->node_id && mesh->element &&
               mesh->element_id && mesh->element_tag;
    return all ? LAR_OK : lar_fail_memory(error, nodes * 32 + elements * 44, "the mesh");
}

void lar_mesh_clear(lar_mesh *mesh) {
    for (int32_t s = 0; s < mesh->set_count; s++) {
        free(mesh->set[s].name);
        free(mesh->set[s].index);
    }
    free(mesh->set);
    free(mesh->source);
    free(mesh->position);
    free(mesh->node_id);
    free(mesh->element);
    free(mesh->element_id);
    free(mesh->element_line);
    free(mesh->element_tag);
    free(mesh->fibre);
    free(mesh->second);
    *mesh = (lar_mesh){0};
}

const lar_set *lar_mesh_find_set(const lar_mesh *mesh, const char *name, lar_set_kind kind) {
    for (int32_t s = 0; s < mesh->set_count; s++)
        if (mesh->set[s].kind == kind && strcmp(mesh->set[s].name, name) == 0) return &mesh->set[s];
    return NULL;
}

void lar_mesh_bodies(const lar_mesh *mesh, int32_t *body) {
    lar_union_start(body, mesh->node_count);
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 1; a < 8; a++) lar_union_join(body, mesh->element[e][0], mesh->element[e][a]);
    for (int32_t n = 0; n < mesh->node_count; n++) body[n] = lar_union_root(body, n);
}

void lar_mesh_corners(const lar_mesh *mesh, int32_t e, double corner[8][3]) {
    for (int a = 0; a < 8; a++)
        memcpy(corner[a], mesh->position[mesh->element[e][a]], sizeof corner[a]);
}

double lar_mesh_mean_edge(const lar_mesh *mesh) {
    double sum = 0;
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int k = 0; k < 12; k++) {
            const double *a = mesh->position[mesh->element[e][lar_edge_node[k][0]]];
            const double *b = mesh->position[mesh->element[e][lar_edge_node[k][1]]];
            sum += hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
        }
    return mesh->element_count > 0 ? sum / (12.0 * mesh->element_count) : 0;
}

static int compare_int32(const void *a, const void *b) {
    int32_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

static int compare_int64(const void *a, const void *b) {
    int64_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

static int32_t sort_unique(int32_t *index, int32_t count) {
    if (count > 0) qsort(index, (size_t)count, sizeof *index, compare_int32);
    int32_t kept = 0;
    for (int32_t i = 0; i < count; i++)
        if (kept == 0 || index[kept - 1] != index[i]) index[kept++] = index[i];
    return kept;
}

/* Removes repeats and leaves the first of each where it stands, because the order of faces is the
 * order of the file. */
static bool unique_in_order(int32_t *index, int32_t *count) {
    int64_t *order = lar_calloc((size_t)*count, sizeof *order);
    if (!order) return false;
    for (int32_t i = 0; i < *count; i++) order[i] = (int64_t)index[i] * INT64_C(0x100000000) + i;
    qsort(order, (size_t)*count, sizeof *order, compare_int64);
    /* Face indices are not negative, so INT32_MIN can mark what goes. */
    for (int32_t i = *count - 1; i > 0; i--)
        if (order[i] >> 32 == order[i - 1] >> 32) index[order[i] & INT64_C(0xffffffff)] = INT32_MIN;
    free(order);
    int32_t kept = 0;
    for (int32_t i = 0; i < *count; i++)
        if (index[i] != INT32_MIN) index[kept++] = index[i];
    *count = kept;
    return true;
}

lar_status lar_mesh_add_set(lar_mesh *mesh, const char *name, lar_set_kind kind, int32_t *index,
                            int32_t count, lar_error *error) {
    static const char *const kind_name[] = {"node", "element", "face"};
    const char *source = mesh->source ? mesh->source : "mesh";
    if (lar_mesh_find_set(mesh, name, kind)) {
        free(index);
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: there are two %s sets named '%s'; rename one of them", source,
                        kind_name[kind], name);
    }
    if (mesh->set_count >= LAR_MESH_SETS_MAX) {
        free(index);
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: holds more than %d named sets; remove those that are not used", source,
                        LAR_MESH_SETS_MAX);
    }
    lar_set *grown = realloc(mesh->set, ((size_t)mesh->set_count + 1) * sizeof *grown);
    if (grown) mesh->set = grown;
    char *copy = lar_strdup(name);
    if (!grown || !copy || (kind == LAR_SET_FACES && !unique_in_order(index, &count))) {
        free(copy);
        free(index);
        return lar_fail_memory(error, sizeof *grown, "a set");
    }
    if (kind != LAR_SET_FACES) count = sort_unique(index, count);
    mesh->set[mesh->set_count++] = (lar_set){copy, kind, count, index};
    return LAR_OK;
}
