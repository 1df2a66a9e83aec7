#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "meshing/fit/work.h"
#include "model/mesh/faces.h"

/* ---- which elements and faces are around each node ------------------------------------------ */

bool lar_fit_list_around(const int32_t *node, size_t stride, size_t count, int per, int32_t nodes,
                         int32_t **start, int32_t **around) {
    *start = lar_calloc((size_t)nodes + 1, sizeof **start);
    *around = lar_calloc(count * (size_t)per, sizeof **around);
    if (!*start || !*around) return false;
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < per; a++) (*start)[node[i * stride + (size_t)a] + 1]++;
    for (int32_t n = 0; n < nodes; n++) (*start)[n + 1] += (*start)[n];
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < per; a++)
            (*around)[(*start)[node[i * stride + (size_t)a]]++] = (int32_t)i * per + a;
    for (int32_t n = nodes; n > 0; n--) (*start)[n] = (*start)[n - 1];
    (*start)[0] = 0;
    return true;
}

/* ---- pairs of regions ---------------------------------------------------------------------- */

static int32_t find_pair(const lar_fit_work *work, int a, int b) {
    for (int32_t p = 0; p < work->pair_count; p++)
        if (work->pair[p].region[0] == a && work->pair[p].region[1] == b) return p;
    return -1;
}

static lar_status list_points(lar_fit_work *work, const lar_unfitted_mesh *unfitted,
                              lar_error *error) {
    const int32_t nodes = unfitted->mesh.node_count;
    size_t capacity = 0;
    work->point_count = unfitted->meet_start[nodes];
    work->point = lar_calloc((size_t)work->point_count, sizeof *work->point);
    work->point_start = lar_calloc((size_t)nodes + 1, sizeof *work->point_start);
    if (!work->point || !work->point_start)
        return lar_fail_memory(error, (size_t)work->point_count * sizeof *work->point,
                               "fitting the boundary");
    memcpy(work->point_start, unfitted->meet_start,
           ((size_t)nodes + 1) * sizeof *work->point_start);
    int32_t last = -1;
    for (int32_t n = 0; n < nodes; n++)
        for (int32_t i = unfitted->meet_start[n]; i < unfitted->meet_start[n + 1]; i++) {
            const uint16_t *meet = unfitted->meet[i];
            if (last < 0 || work->pair[last].region[0] != meet[0] ||
                work->pair[last].region[1] != meet[1])
                last = find_pair(work, meet[0], meet[1]);
            if (last < 0) {
                if (!LAR_GROW(work->pair, capacity, work->pair_count))
                    return lar_fail_memory(error, 2 * capacity * sizeof *work->pair,
                                           "the pairs of regions");
                last = work->pair_count++;
                work->pair[last] = (lar_fit_pair){.region = {meet[0], meet[1]}};
            }
            work->point[i].node = n;
            work->point[i].pair = last;
        }
    return LAR_OK;
}

/* ---- faces between regions ------------------------------------------------------------------ */

static bool meets(const lar_fit_work *work, int32_t node, int32_t pair) {
    for (int32_t i = work->point_start[node]; i < work->point_start[node + 1]; i++)
        if (work->point[i].pair == pair) return true;
    return false;
}

void lar_fit_area(const lar_fit_work *work, const int32_t node[4], double area[3]) {
    double along[3], across[3];
    lar_minus(work->x[node[2]], work->x[node[0]], along);
    lar_minus(work->x[node[3]], work->x[node[1]], across);
    lar_cross(along, across, area);
    for (int i = 0; i < 3; i++) area[i] *= 0.5;
}

/* What lies in front of an outer face of region r: of what its four nodes all meet the outside,
 * or the flat cut that the face looks along best. */
static int32_t outer_pair(const lar_fit_work *work, const int32_t node[4], int region) {
    double normal[3];
    lar_fit_area(work, node, normal);
    int32_t best = -1;
    double best_cosine = -2;
    for (int32_t i = work->point_start[node[0]]; i < work->point_start[node[0] + 1]; i++) {
        const int32_t pair = work->point[i].pair;
        const uint16_t *of = work->pair[pair].region;
        const bool cut = of[0] == region && of[1] >= LAR_REGION_CUT;
        if (!cut && !(of[0] == 0 && of[1] == region)) continue;
        if (!meets(work, node[1], pair) || !meets(work, node[2], pair) ||
            !meets(work, node[3], pair))
            continue;
        const double cosine =
            cut ? lar_dot(normal, work->boundary->cut[of[1] - LAR_REGION_CUT].normal) /
                      lar_length(normal)
                : 0.6;
        if (cosine > best_cosine) {
            best = pair;
            best_cosine = cosine;
        }
    }
    return best;
}

static void add_face(lar_fit_work *work, int32_t face, int other) {
    const lar_mesh *mesh = work->mesh;
    const int region = mesh->element_tag[face / 6];
    int32_t node[4];
    for (int a = 0; a < 4; a++) node[a] = mesh->element[face / 6][lar_face_node[face % 6][a]];
    const int32_t pair =
        other ? find_pair(work, region < other ? region : other, region < other ? other : region)
              : outer_pair(work, node, region);
    if (pair < 0) return;
    lar_fit_face *added = &work->face[work->face_count++];
    const bool turn = work->pair[pair].region[0] == region; /* seen from the first: from inside */
    for (int a = 0; a < 4; a++) added->node[a] = node[turn ? 3 - a : a];
    added->pair = pair;
    for (int a = 0; a < 4; a++)
        for (int32_t i = work->point_start[node[a]]; i < work->point_start[node[a] + 1]; i++)
            if (work->point[i].pair == pair) work->point[i].faces++;
}

static lar_status list_faces(lar_fit_work *work, lar_error *error) {
    lar_face_table table = {0};
    lar_status status = lar_face_table_build(work->mesh, &table, error);
    if (status != LAR_OK) return status;
    const int32_t *tag = work->mesh->element_tag;
    size_t count = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < table.count; i++) {
            const lar_face_key *key = &table.key[i];
            const bool inner = i + 1 < table.count && lar_face_key_same(key, key + 1);
            const int other = inner ? tag[key[1].face / 6] : 0;
            i += inner;
            if (other == tag[key->face / 6]) continue;
            if (pass == 0)
                count++;
            else
                add_face(work, key->face, other);
        }
        if (pass == 0 && !(work->face = lar_calloc(count, sizeof *work->face))) {
            status = lar_fail_memory(error, count * sizeof *work->face, "the boundary's faces");
            break;
        }
    }
    free(table.key);
    return status;
}

/* ---- the whole ------------------------------------------------------------------------------ */

static bool list_neighbours(lar_fit_work *work, size_t slots) {
    const lar_mesh *mesh = work->mesh;
    const size_t stride = sizeof *work->face / sizeof(int32_t);
    return lar_fit_list_around(mesh->element[0], 8, (size_t)mesh->element_count, 8,
                               mesh->node_count, &work->element_start, &work->element_around) &&
           lar_fit_list_around(work->face[0].node, stride, (size_t)work->face_count, 4,
                               mesh->node_count, &work->face_start, &work->face_around) &&
           lar_fit_list_around(slots > 0 ? work->slot[0] : NULL, 4, slots, 4, mesh->node_count,
                               &work->slot_start, &work->slot_around);
}

lar_status lar_fit_work_create(const lar_boundary *boundary, const lar_unfitted_mesh *unfitted,
                               lar_fit_work *work, lar_error *error) {
    const lar_mesh *mesh = &unfitted->mesh;
    const size_t nodes = (size_t)mesh->node_count;
    work->boundary = boundary;
    work->mesh = mesh;
    work->size = unfitted->size;
    work->slot = (const int32_t(*)[4])unfitted->slot;
    memcpy(work->origin, mesh->position[0], sizeof work->origin);
    work->x = lar_calloc(nodes, sizeof *work->x);
    work->awake = lar_calloc(nodes, sizeof *work->awake);
    work->region = lar_calloc((size_t)boundary->region_count + 1, sizeof *work->region);
    work->record.action = lar_calloc(LAR_FIT_SWEEPS * nodes, sizeof *work->record.action);
    work->record.differs = lar_calloc(nodes, sizeof *work->record.differs);
    if (!work->x || !work->awake || !work->region || !work->record.action || !work->record.differs)
        return lar_fail_memory(error, nodes * sizeof *work->x, "the nodes' places");
    for (size_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++)
            work->x[n][i] = (mesh->position[n][i] - work->origin[i]) / work->size;
    lar_status status = list_points(work, unfitted, error);
    if (status == LAR_OK) status = list_faces(work, error);
    if (status == LAR_OK && !list_neighbours(work, (size_t)unfitted->slot_count))
        status = lar_fail_memory(error, nodes * 12 * sizeof(int32_t), "the elements around nodes");
    if (status == LAR_OK)
        status = lar_fit_apart_create(work, (const int32_t(*)[3])unfitted->point, error);
    return status ? status : lar_fit_rows_create(work, unfitted, error);
}

void lar_fit_work_clear(lar_fit_work *work) {
    for (int32_t p = 0; p < work->pair_count; p++) lar_triangle_tree_destroy(work->pair[p].tree);
    void *const owned[] = {
        work->x,          work->awake,         work->element_start, work->element_around,
        work->face_start, work->face_around,   work->point_start,   work->face,
        work->slot_start, work->slot_around,   work->point,         work->pair,
        work->region,     work->record.action, work->record.differs};
    for (size_t i = 0; i < sizeof owned / sizeof *owned; i++) free(owned[i]);
    lar_fit_apart_clear(&work->apart);
    lar_fit_rows_clear(&work->rows);
    memset(work, 0, sizeof *work);
}

void lar_fit_corners(const lar_fit_work *work, int32_t e, double corner[8][3]) {
    for (int a = 0; a < 8; a++)
        memcpy(corner[a], work->x[work->mesh->element[e][a]], sizeof corner[a]);
}
