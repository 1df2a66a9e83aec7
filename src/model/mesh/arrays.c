#include "model/mesh/arrays.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/text.h"

static lar_status check_counts(const lar_mesh_arrays *a, lar_error *error) {
    if (a->nodes < 1 || a->elements < 1 || a->elements > INT32_MAX / 6)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a mesh of %ld nodes and %ld elements; it has one element at least, and "
                        "%d at most",
                        (long)a->nodes, (long)a->elements, INT32_MAX / 6);
    if (a->sets < 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "a mesh of %ld sets; it has 0 or more",
                        (long)a->sets);
    if (!a->position || !a->element || (a->sets > 0 && !a->set))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a mesh from arrays needs positions, elements and, where it says that "
                        "there are sets, these; none may be NULL");
    return LAR_OK;
}

/* Before anything is done with them: the sentences of lar_mesh_check speak of files. */
static lar_status check_values(const lar_mesh_arrays *a, uint8_t *used, lar_error *error) {
    for (int32_t n = 0; n < a->nodes; n++)
        for (int i = 0; i < 3; i++)
            if (!isfinite(a->position[n][i]))
                return lar_fail(error, LAR_ERROR_MODEL,
                                "node %ld has the %c coordinate %g, which is no usable number; "
                                "give its place",
                                (long)n, "xyz"[i], a -> position[n][i]);
    for (int32_t e = 0; e < a->elements; e++)
        for (int k = 0; k < 8; k++) {
            int32_t node = a->element[e][k];
            if (node < 0 || node >= a->nodes)
                return lar_fail(error, LAR_ERROR_MODEL,
                                "element %ld has node %ld as its corner %d, but nodes are 0 to "
                                "%ld; give the index of a node",
                                (long)e, (long)node, k, (long)a->nodes - 1);
            used[node] = 1;
        }
    for (int32_t n = 0; n < a->nodes; n++)
        if (!used[n])
            return lar_fail(error, LAR_ERROR_MODEL,
                            "node %ld belongs to no element and would have no mass; leave it out "
                            "and count the others anew",
                            (long)n);
    return LAR_OK;
}

static lar_status check_indices(const lar_mesh_arrays *a, lar_error *error) {
    uint8_t *used = lar_calloc((size_t)a->nodes, sizeof *used);
    if (!used) return lar_fail_memory(error, (size_t)a->nodes, "a mesh from arrays");
    lar_status status = check_values(a, used, error);
    free(used);
    return status;
}

/* ---- sets ---------------------------------------------------------------------------------- */

static bool kind_of(const char *word, lar_set_kind *kind) {
    static const char *const words[] = {"nodes", "elements", "faces"};
    *kind = LAR_SET_NODES;
    for (int k = 0; word && k < 3; k++)
        if (strcmp(word, words[k]) == 0) {
            *kind = (lar_set_kind)k;
            return true;
        }
    return !word;
}

/* Files may have such names, which are shown with ? then; two that differ there are one. */
static lar_status check_name(const char *name, int32_t s, lar_error *error) {
    char shown[101];
    if (!name || !*name)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "set %ld has no name; give it one", (long)s);
    for (const unsigned char *c = (const unsigned char *)name; *c; c++) {
        if (*c >= ' ' && *c != 0x7f && !(c[0] == 0xc2 && c[1] >= 0x80 && c[1] <= 0x9f)) continue;
        snprintf(shown, sizeof shown, "%.100s", name);
        lar_text_show(shown);
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "set %ld, '%s', has a tab, a new line or another control character in its "
                        "name (? here); leave it out",
                        (long)s, shown);
    }
    return LAR_OK;
}

static lar_status check_set(const lar_mesh_arrays *a, int32_t s, lar_set_kind *kind,
                            lar_error *error) {
    const lar_array_set *set = &a->set[s];
    lar_status status = check_name(set->name, s, error);
    if (status) return status;
    if (!kind_of(set->kind, kind))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "set '%.100s' is of kind '%.40s'; a set is of nodes, elements or faces",
                        set->name, set->kind);
    if (set->count < 1 || !set->index)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "set '%.100s' holds nothing; leave it out, or give what belongs to it",
                        set->name);
    int32_t end = *kind == LAR_SET_NODES      ? a->nodes
                  : *kind == LAR_SET_ELEMENTS ? a->elements
                                              : 6 * a->elements;
    for (int32_t i = 0; i < set->count; i++)
        if (set->index[i] < 0 || set->index[i] >= end)
            return lar_fail(error, LAR_ERROR_MODEL,
                            "set '%.100s' of %s holds the index %ld at place %ld, but there are 0 "
                            "to %ld; correct the set",
                            set->name, set->kind ? set->kind : "nodes", (long)set->index[i],
                            (long)i, (long)end - 1);
    return LAR_OK;
}

static lar_status add_sets(const lar_mesh_arrays *a, lar_mesh *mesh, lar_error *error) {
    lar_status status = LAR_OK;
    for (int32_t s = 0; s < a->sets && !status; s++) {
        lar_set_kind kind = LAR_SET_NODES;
        size_t count;
        int32_t *index;
        status = check_set(a, s, &kind, error);
        if (status) return status;
        count = (size_t)a->set[s].count;
        index = lar_calloc(count, sizeof *index);
        if (!index) return lar_fail_memory(error, count * sizeof *index, "a set");
        memcpy(index, a->set[s].index, count * sizeof *index);
        status = lar_mesh_add_set(mesh, a->set[s].name, kind, index, a->set[s].count, error);
    }
    return status;
}

/* ---- the mesh ------------------------------------------------------------------------------ */

static bool copy_family(const double (*given)[3], int32_t elements, double (**fibre)[3]) {
    if (!given) return true;
    *fibre = lar_calloc((size_t)elements, sizeof **fibre);
    if (*fibre) memcpy(*fibre, given, (size_t)elements * sizeof **fibre);
    return *fibre != NULL;
}

static lar_status copy(const lar_mesh_arrays *a, double scale, lar_mesh *mesh, lar_error *error) {
    lar_status status =
        lar_mesh_allocate(mesh, "mesh", (size_t)a->nodes, (size_t)a->elements, error);
    if (status) return status;
    mesh->node_count = a->nodes;
    mesh->element_count = a->elements;
    for (int32_t n = 0; n < a->nodes; n++) {
        for (int i = 0; i < 3; i++) mesh->position[n][i] = a->position[n][i] * scale;
        mesh->node_id[n] = n;
    }
    memcpy(mesh->element, a->element, (size_t)a->elements * sizeof *mesh->element);
    for (int32_t e = 0; e < a->elements; e++) {
        mesh->element_id[e] = e;
        mesh->element_tag[e] = a->tag ? a->tag[e] : 0;
    }
    if (!copy_family(a->fibre, a->elements, &mesh->fibre) ||
        !copy_family(a->fibre2, a->elements, &mesh->second))
        return lar_fail_memory(error, (size_t)a->elements * sizeof *mesh->fibre,
                               "the directions of fibres");
    return add_sets(a, mesh, error);
}

lar_status lar_mesh_from_arrays(const lar_mesh_arrays *arrays, double scale, lar_mesh *mesh,
                                lar_error *error) {
    lar_status status = check_counts(arrays, error);
    if (!status) status = check_indices(arrays, error);
    if (!status) status = copy(arrays, scale, mesh, error);
    if (!status) lar_mesh_turn(mesh);
    if (!status) status = lar_mesh_check(mesh, error);
    if (status) lar_mesh_clear(mesh);
    return status;
}
