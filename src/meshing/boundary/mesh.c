/* The boundary of the regions of a mesh of any solids.
 *
 *     solids, collapsed --> faces, sorted by their corners --> one closed surface per region
 *     (model/mesh/mesh.h)          once: outside                      (boundary.h; they share what
 * lies twice: inside, or between two       between them) more often: refused
 *
 * Nodes at one place are one: parts that were never merged hang together then, and a region's
 * surface is closed.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "meshing/boundary/boundary.h"
#include "model/format/mesh_io.h"

typedef struct solid_face {
    int32_t key[4]; /* its corners ascending, -1 for the fourth of a triangle */
    int32_t corner[4];
    int32_t element;
} solid_face;

typedef struct solids {
    const char *path;
    lar_mesh mesh;
    int32_t region_count;
    int32_t tag[LAR_REGIONS_MAX];
    uint8_t *region; /* [element_count] from 0 */
    size_t face_count;
    solid_face *face;
} solids;

static void clear_solids(solids *s) {
    lar_mesh_clear(&s->mesh);
    free(s->region);
    free(s->face);
}

/* ---- nodes and regions ---------------------------------------------------------------------- */

static lar_status join_nodes(solids *s, int32_t *joined, lar_error *error) {
    int32_t *leader = NULL;
    lar_status status = lar_mesh_doubled_nodes(&s->mesh, joined, &leader, error);
    for (int32_t e = 0; e < s->mesh.element_count && !status; e++)
        for (int a = 0; a < 8; a++) s->mesh.element[e][a] = leader[s->mesh.element[e][a]];
    free(leader);
    return status;
}

static int compare_tags(const void *a, const void *b) {
    int32_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

/* Regions are the elements of one tag, in the order of the tags. */
static lar_status find_regions(solids *s, bool fuse, lar_error *error) {
    const lar_mesh *mesh = &s->mesh;
    const size_t count = (size_t)mesh->element_count;
    s->region = lar_calloc(count, sizeof *s->region);
    int32_t *tag = lar_calloc(count, sizeof *tag);
    if (!s->region || !tag) {
        free(tag);
        return lar_fail_memory(error, count * sizeof *tag, s->path);
    }
    if (!fuse) memcpy(tag, mesh->element_tag, count * sizeof *tag);
    qsort(tag, count, sizeof *tag, compare_tags);
    size_t regions = 0;
    for (size_t e = 0; e < count; e++) {
        if (e > 0 && tag[e] == tag[e - 1]) continue;
        if (regions < LAR_REGIONS_MAX) s->tag[regions] = tag[e];
        regions++;
    }
    free(tag);
    if (regions > LAR_REGIONS_MAX)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: its elements have %zu tags, but there can be %d regions; --fuse makes "
                        "one of all",
                        s->path, regions, LAR_REGIONS_MAX);
    s->region_count = (int32_t)regions;
    for (size_t e = 0; e < count && !fuse; e++) {
        const int32_t *at =
            bsearch(&mesh->element_tag[e], s->tag, regions, sizeof *s->tag, compare_tags);
        s->region[e] = (uint8_t)(at - s->tag);
    }
    return LAR_OK;
}

/* The set that holds the region's elements and no others. */
static const char *set_of_region(const solids *s, int32_t region) {
    int32_t members = 0;
    for (int32_t e = 0; e < s->mesh.element_count; e++) members += s->region[e] == region;
    for (int32_t i = 0; i < s->mesh.set_count; i++) {
        const lar_set *set = &s->mesh.set[i];
        bool same = set->kind == LAR_SET_ELEMENTS && set->count == members;
        for (int32_t k = 0; k < set->count && same; k++) same = s->region[set->index[k]] == region;
        if (same) return set->name;
    }
    return NULL;
}

static char *name_of_region(const solids *s, int32_t region, const char *title) {
    const char *set = set_of_region(s, region);
    char words[32];
    snprintf(words, sizeof words, "region %d", (int)s->tag[region]);
    return lar_strdup(set ? set : s->region_count == 1 ? title : words);
}

/* ---- faces ---------------------------------------------------------------------------------- */

static int compare_faces(const void *a, const void *b) {
    const solid_face *x = a, *y = b;
    for (int i = 0; i < 4; i++)
        if (x->key[i] != y->key[i]) return x->key[i] < y->key[i] ? -1 : 1;
    return (x->element > y->element) - (x->element < y->element);
}

/* Whether two faces, or a face and none, are the same but for their elements. */
static bool same_face(const solid_face *a, const solid_face *b) {
    return memcmp(a->key, b->key, sizeof a->key) == 0;
}

/* The corners of a collapsed face, each once; false when it is none. */
static bool take_face(const lar_mesh *mesh, int32_t e, int f, solid_face *face) {
    int corners = 0;
    *face = (solid_face){.corner = {-1, -1, -1, -1}, .element = e};
    for (int c = 0; c < 4; c++) {
        int32_t node = mesh->element[e][lar_face_node[f][c]];
        bool again = false;
        for (int k = 0; k < corners; k++) again = again || face->corner[k] == node;
        if (!again) face->corner[corners++] = node;
    }
    if (corners < 3) return false;
    memcpy(face->key, face->corner, sizeof face->key);
    for (int i = 1; i < corners; i++)
        for (int k = i; k > 0 && face->key[k] < face->key[k - 1]; k--) {
            int32_t lower = face->key[k];
            face->key[k] = face->key[k - 1];
            face->key[k - 1] = lower;
        }
    return true;
}

/* Outwards whatever the file's order of corners is: away from the element's middle. */
static void turn_outwards(const lar_mesh *mesh, solid_face *face) {
    const int corners = face->corner[3] < 0 ? 3 : 4;
    double middle[3] = {0}, side[2][3], normal[3], out[3] = {0};
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++)
            middle[i] += mesh->position[mesh->element[face->element][a]][i] / 8;
    for (int c = 0; c < corners; c++)
        for (int i = 0; i < 3; i++)
            out[i] += (mesh->position[face->corner[c]][i] - middle[i]) / corners;
    lar_minus(mesh->position[face->corner[2]], mesh->position[face->corner[0]], side[0]);
    lar_minus(mesh->position[face->corner[corners - 1]], mesh->position[face->corner[1]], side[1]);
    lar_cross(side[0], side[1], normal);
    if (lar_dot(normal, out) >= 0) return;
    int32_t second = face->corner[1];
    face->corner[1] = face->corner[corners - 1];
    face->corner[corners - 1] = second;
}

static lar_status collect_faces(solids *s, lar_error *error) {
    const lar_mesh *mesh = &s->mesh;
    const size_t max = 6 * (size_t)mesh->element_count;
    s->face = lar_calloc(max, sizeof *s->face);
    if (!s->face) return lar_fail_memory(error, max * sizeof *s->face, s->path);
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int f = 0; f < 6; f++)
            if (take_face(mesh, e, f, &s->face[s->face_count])) s->face_count++;
    qsort(s->face, s->face_count, sizeof *s->face, compare_faces);
    for (size_t i = 2; i < s->face_count; i++)
        if (same_face(&s->face[i], &s->face[i - 2]))
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: elements %lld, %lld and %lld have a face in common, so that some "
                            "lie in each other; remove those that are there twice",
                            s->path, (long long)mesh->element_id[s->face[i - 2].element],
                            (long long)mesh->element_id[s->face[i - 1].element],
                            (long long)mesh->element_id[s->face[i].element]);
    return LAR_OK;
}

/* ---- surfaces ------------------------------------------------------------------------------- */

/* Whether face i bounds its element's region. */
static bool bounds(const solids *s, size_t i) {
    const solid_face *face = &s->face[i];
    for (int k = -1; k <= 1; k += 2) {
        size_t other = i + (size_t)k; /* before the first one there is none either */
        if (other < s->face_count && same_face(face, &s->face[other]) &&
            s->region[face->element] == s->region[s->face[other].element])
            return false;
    }
    return true;
}

/* A quadrilateral is cut from its lowest node, so that both of its regions cut it in one way. */
static void add_face(const solid_face *face, lar_triangles *surface) {
    int32_t(*corner)[3] = surface->corner;
    const int corners = face->corner[3] < 0 ? 3 : 4;
    int low = 0;
    for (int c = 1; c < corners; c++)
        if (face->corner[c] < face->corner[low]) low = c;
    for (int t = 0; t < corners - 2; t++, surface->triangle_count++) {
        corner[surface->triangle_count][0] = face->corner[low];
        for (int c = 1; c < 3; c++)
            corner[surface->triangle_count][c] = face->corner[(low + t + c) % corners];
    }
}

static lar_status make_surface(solids *s, int32_t region, lar_triangles *surface,
                               lar_error *error) {
    const lar_mesh *mesh = &s->mesh;
    size_t faces = 0, nodes = (size_t)mesh->node_count;
    for (size_t i = 0; i < s->face_count; i++)
        faces += s->region[s->face[i].element] == region && bounds(s, i);
    surface->source = lar_strdup(s->path);
    surface->vertex = lar_calloc(nodes, sizeof *surface->vertex);
    surface->corner = lar_calloc(2 * faces, sizeof *surface->corner);
    if (!surface->source || !surface->vertex || !surface->corner)
        return lar_fail_memory(error, nodes * sizeof *surface->vertex, s->path);
    memcpy(surface->vertex, mesh->position, nodes * sizeof *surface->vertex);
    surface->vertex_count = mesh->node_count;
    for (size_t i = 0; i < s->face_count; i++) {
        if (s->region[s->face[i].element] != region || !bounds(s, i)) continue;
        turn_outwards(mesh, &s->face[i]);
        add_face(&s->face[i], surface);
    }
    return lar_triangles_join(surface, error);
}

static lar_status make_boundary(solids *s, const char *title, lar_boundary *boundary,
                                lar_error *error) {
    lar_triangles surface[LAR_REGIONS_MAX] = {0};
    char *name[LAR_REGIONS_MAX] = {NULL};
    lar_status status = LAR_OK;
    for (int32_t r = 0; r < s->region_count && !status; r++) {
        name[r] = name_of_region(s, r, title);
        status = name[r] ? make_surface(s, r, &surface[r], error)
                         : lar_fail_memory(error, strlen(title), "a name");
    }
    if (status)
        for (int32_t r = 0; r < s->region_count; r++) lar_triangles_clear(&surface[r]);
    else
        status = lar_boundary_from_surfaces(surface, (const char *const *)name, s->region_count,
                                            boundary, error);
    /* The file's tags, where all can be: 0 is what a mesh without tags has. */
    for (int32_t r = 0; r < s->region_count && !status && s->tag[0] > 0; r++)
        boundary->region[r + 1].tag = s->tag[r];
    for (int32_t r = 0; r < s->region_count; r++) free(name[r]);
    return status;
}

lar_status lar_boundary_from_mesh(const char *path, double scale, bool fuse, const char *title,
                                  lar_boundary *boundary, int32_t *joined, lar_error *error) {
    solids s = {.path = path};
    *boundary = (lar_boundary){0};
    lar_status status = lar_mesh_read_solids(path, scale, &s.mesh, error);
    if (!status) status = join_nodes(&s, joined, error);
    if (!status) status = find_regions(&s, fuse, error);
    if (!status) status = collect_faces(&s, error);
    if (!status) status = make_boundary(&s, title, boundary, error);
    clear_solids(&s);
    return status;
}
