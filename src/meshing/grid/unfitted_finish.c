#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "meshing/fit/fit.h"
#include "meshing/grid/part_regions.h"
#include "model/mesh/faces.h"

/* Interfaces that get a set: of a model with hundreds of regions the larger ones. */
enum { INTERFACES_MAX = 2048, NAME_MAX = 200 };
/* An outer face is part of a cut when its normal leans from the cut's by less than 45 degrees. */
static const double CUT_LEAN = 0.7;

typedef struct finishing {
    lar_unfitted_mesh *unfitted;
    const lar_boundary *boundary;
    int32_t *outer, outer_count;
    lar_error *error;
} finishing;

/* Letters, digits and "_" of a name; what else there is becomes "_". */
static void plain_name(const char *name, char plain[NAME_MAX]) {
    size_t length = 0;
    for (; name[length] && length < NAME_MAX / 2; length++) {
        const unsigned char c = (unsigned char)name[length];
        plain[length] = (char)(c < 128 && isalnum(c) ? c : '_');
    }
    plain[length] = '\0';
    if (length == 0) strcpy(plain, "region");
}

/* Adds a set; where another one has the name already a number follows it ("kidney_2"). */
static lar_status add_set(finishing *work, const char *name, lar_set_kind kind,
                          const int32_t *index, int32_t count) {
    lar_mesh *mesh = &work->unfitted->mesh;
    char unique[2 * NAME_MAX + 16];
    snprintf(unique, sizeof unique, "%s", name);
    for (int n = 2; lar_mesh_find_set(mesh, unique, kind); n++)
        snprintf(unique, sizeof unique, "%s_%d", name, n);
    int32_t *copy = lar_calloc((size_t)count, sizeof *copy);
    if (!copy) return lar_fail_memory(work->error, (size_t)count * sizeof *copy, "a set");
    if (count > 0) memcpy(copy, index, (size_t)count * sizeof *copy);
    return lar_mesh_add_set(mesh, unique, kind, copy, count, work->error);
}

static void region_name(const finishing *work, int region, char plain[NAME_MAX]) {
    const char *name = work->boundary->region[region].name;
    plain_name(name ? name : "", plain);
}

/* Elements by region, and their outer faces. */
static lar_status add_regions(finishing *work, int32_t *index) {
    const lar_mesh *mesh = &work->unfitted->mesh;
    lar_status status = LAR_OK;
    for (int r = 1; !status && r <= work->boundary->region_count; r++) {
        char name[NAME_MAX], surface[NAME_MAX + 16];
        region_name(work, r, name);
        int32_t count = 0;
        for (int32_t e = 0; e < mesh->element_count; e++)
            if (mesh->element_tag[e] == r) index[count++] = e;
        if (count == 0) continue;
        status = add_set(work, name, LAR_SET_ELEMENTS, index, count);
        if (status || work->boundary->region_count == 1) continue;
        count = 0;
        for (int32_t f = 0; f < work->outer_count; f++)
            if (mesh->element_tag[work->outer[f] / 6] == r) index[count++] = work->outer[f];
        snprintf(surface, sizeof surface, "%s_surface", name);
        if (count > 0) status = add_set(work, surface, LAR_SET_FACES, index, count);
    }
    return status;
}

/* The unit normal of a face, by its diagonals. */
static void face_normal(const lar_mesh *mesh, int32_t face, double normal[3]) {
    const double *corner[4];
    for (int a = 0; a < 4; a++)
        corner[a] = mesh->position[mesh->element[face / 6][lar_face_node[face % 6][a]]];
    double across[2][3];
    for (int i = 0; i < 2; i++) lar_minus(corner[2 + i], corner[i], across[i]);
    lar_cross(across[0], across[1], normal);
    const double length = lar_length(normal);
    for (int d = 0; d < 3; d++) normal[d] /= length > 0 ? length : 1;
}

static bool node_meets(const lar_unfitted_mesh *unfitted, int32_t node, uint16_t number) {
    for (int32_t m = unfitted->meet_start[node]; m < unfitted->meet_start[node + 1]; m++)
        if (unfitted->meet[m][0] == number || unfitted->meet[m][1] == number) return true;
    return false;
}

static bool is_on_cut(const finishing *work, int32_t face, int cut) {
    const lar_mesh *mesh = &work->unfitted->mesh;
    for (int a = 0; a < 4; a++)
        if (!node_meets(work->unfitted, mesh->element[face / 6][lar_face_node[face % 6][a]],
                        (uint16_t)(LAR_REGION_CUT + cut)))
            return false;
    double normal[3];
    face_normal(mesh, face, normal);
    return lar_dot(normal, work->boundary->cut[cut].normal) > CUT_LEAN;
}

static lar_status add_cuts(finishing *work, int32_t *index) {
    lar_status status = LAR_OK;
    for (int c = 0; !status && c < LAR_CUTS; c++) {
        if (work->boundary->cut[c].name[0] == '\0') continue;
        int32_t count = 0;
        for (int32_t f = 0; f < work->outer_count; f++)
            if (is_on_cut(work, work->outer[f], c)) index[count++] = work->outer[f];
        char plain[NAME_MAX], name[NAME_MAX + 16];
        plain_name(work->boundary->cut[c].name, plain);
        snprintf(name, sizeof name, "cut_%s", plain);
        if (count > 0) status = add_set(work, name, LAR_SET_FACES, index, count);
    }
    return status;
}

/* A face between regions a < b, of the element of a. */
typedef struct interface_face {
    uint8_t a, b;
    int32_t face;
} interface_face;

static int compare_interface_faces(const void *x, const void *y) {
    const interface_face *p = x, *q = y;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    if (p->b != q->b) return p->b < q->b ? -1 : 1;
    return (p->face > q->face) - (p->face < q->face);
}

static lar_status find_interface_faces(finishing *work, interface_face **found, size_t *count) {
    const lar_mesh *mesh = &work->unfitted->mesh;
    lar_face_table table = {0};
    size_t capacity = 0;
    lar_status status = lar_face_table_build(mesh, &table, work->error);
    for (size_t i = 0; !status && i + 1 < table.count; i++) {
        const int32_t p = table.key[i].face, q = table.key[i + 1].face;
        const int32_t a = mesh->element_tag[p / 6], b = mesh->element_tag[q / 6];
        if (a == b || !lar_face_key_same(&table.key[i], &table.key[i + 1])) continue;
        if (!LAR_GROW(*found, capacity, *count))
            status = lar_fail_memory(work->error, capacity * sizeof **found, "the interfaces");
        else
            (*found)[(*count)++] =
                (interface_face){(uint8_t)(a < b ? a : b), (uint8_t)(a < b ? b : a), a < b ? p : q};
    }
    free(table.key);
    if (!status && *count > 0) qsort(*found, *count, sizeof **found, compare_interface_faces);
    return status;
}

static bool same_interface(const interface_face *p, const interface_face *q) {
    return p->a == q->a && p->b == q->b;
}

static int compare_sizes(const void *x, const void *y) {
    size_t a, b;
    memcpy(&a, x, sizeof a);
    memcpy(&b, y, sizeof b);
    return (a < b) - (a > b);
}

/* The number of faces that an interface must have to get a set. */
static lar_status interface_floor(finishing *work, const interface_face *found, size_t count,
                                  size_t *floor) {
    size_t *size = lar_calloc(count, sizeof *size), interfaces = 0;
    if (!size) return lar_fail_memory(work->error, count * sizeof *size, "the interfaces");
    for (size_t i = 0; i < count; i++) {
        if (i > 0 && !same_interface(&found[i], &found[i - 1])) interfaces++;
        size[interfaces]++;
    }
    *floor = 1;
    if (count > 0 && interfaces + 1 > INTERFACES_MAX) {
        qsort(size, interfaces + 1, sizeof *size, compare_sizes);
        *floor = size[INTERFACES_MAX - 1] + 1;
    }
    free(size);
    return LAR_OK;
}

static lar_status add_interfaces(finishing *work, int32_t *index) {
    interface_face *found = NULL;
    size_t count = 0, floor = 1;
    lar_status status = find_interface_faces(work, &found, &count);
    if (!status) status = interface_floor(work, found, count, &floor);
    for (size_t i = 0, next; !status && i < count; i = next) {
        for (next = i; next < count && same_interface(&found[next], &found[i]); next++)
            index[next - i] = found[next].face;
        if (next - i < floor) continue;
        char a[NAME_MAX], b[NAME_MAX], name[2 * NAME_MAX];
        region_name(work, found[i].a, a);
        region_name(work, found[i].b, b);
        snprintf(name, sizeof name, "%s_%s", a, b);
        status = add_set(work, name, LAR_SET_FACES, index, (int32_t)(next - i));
    }
    free(found);
    return status;
}

/* Where regions are cut off and meet is seen while they hang together. */
static lar_status add_borders(finishing *work, int32_t *index) {
    lar_status status = add_cuts(work, index);
    return status ? status : add_interfaces(work, index);
}

static lar_status part(finishing *work, int32_t *added) {
    lar_mesh *mesh = &work->unfitted->mesh;
    lar_status status = lar_regions_part(mesh, added, work->error);
    free(work->outer);
    work->outer = NULL;
    if (!status) status = lar_mesh_boundary(mesh, &work->outer, &work->outer_count, work->error);
    return status;
}

lar_status lar_unfitted_finish(lar_unfitted_mesh *unfitted, const lar_boundary *boundary,
                               int32_t *added, lar_mesh *mesh, lar_error *error) {
    finishing work = {.unfitted = unfitted, .boundary = boundary, .error = error};
    const size_t faces = (size_t)unfitted->mesh.element_count * 6;
    int32_t *index = lar_calloc(faces, sizeof *index);
    if (!index) return lar_fail_memory(error, faces * sizeof *index, "the sets of the mesh");
    lar_status status = lar_mesh_boundary(&unfitted->mesh, &work.outer, &work.outer_count, error);
    if (!status && added) status = add_borders(&work, index);
    if (!status && added) status = part(&work, added);
    if (!status) status = add_set(&work, "surface", LAR_SET_FACES, work.outer, work.outer_count);
    if (!status) status = add_regions(&work, index);
    if (!status && !added) status = add_borders(&work, index);
    free(work.outer);
    free(index);
    if (status) return status;
    for (int32_t e = 0; e < unfitted->mesh.element_count; e++)
        unfitted->mesh.element_tag[e] = boundary->region[unfitted->mesh.element_tag[e]].tag;
    *mesh = unfitted->mesh;
    unfitted->mesh = (lar_mesh){0};
    return LAR_OK;
}
