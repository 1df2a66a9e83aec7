#include <stdlib.h>
#include <string.h>

#include "base/parallel_for.h"
#include "base/vector.h"
#include "meshing/fit/crossing.h"
#include "meshing/fit/face_boxes.h"
#include "meshing/fit/work.h"

/* Outer faces shall not go through each other. the unfitted mesh's do not. After each round all
 * pairs are looked at: where some cross, the round is gone back on and done again, and from then on
 * nodes of these faces and of those near them are watched: they move only as far as their faces
 * stay clear of all others. When some cross once more all nodes are watched, and none can. Most
 * bodies have none to watch, and nothing of the work. */

/* Faces that share no node keep so far apart, so that no rounding in a file makes them cross; a
 * watched node moves no farther in a round, for which the faces near it are listed [cells]. */
static const double GAP = 0.01, LEASH = 0.5;
/* Faces that come so near, and so many rings of faces around them, are watched as soon as some
 * cross: they may be the next. */
static const double WARY = 0.15;
enum { RINGS = 2, LOCAL = 3 }; /* the third time in a round all are */
/* Where a smaller part of the faces than this cross once more, only places around them are added.
 */
static const double FEW = 1e-3;
/* The cosine between normals of neighbours that look the same way. */
static const double ALIKE = 0.8;

void lar_fit_apart_clear(lar_fit_apart *apart) {
    void *const owned[] = {apart->face,    apart->start,      apart->around, apart->checked,
                           apart->from,    apart->near_start, apart->near,   apart->awake,
                           apart->crosses, apart->extent,     apart->strict, apart->ring,
                           apart->way,     apart->span};
    for (size_t i = 0; i < sizeof owned / sizeof *owned; i++) free(owned[i]);
    lar_face_boxes_clear(&apart->boxes);
    *apart = (lar_fit_apart){0};
}

static void span_face(const lar_fit_work *work, const int32_t (*point)[3], int32_t f) {
    lar_fit_span *span = &work->apart.span[f];
    for (int i = 0; i < 3; i++) {
        span->lower[i] = INT32_MAX;
        span->upper[i] = INT32_MIN;
        for (int a = 0; a < 4; a++) {
            const int32_t at = point[work->apart.face[f][a]][i];
            if (at < span->lower[i]) span->lower[i] = at;
            if (at > span->upper[i]) span->upper[i] = at;
        }
    }
}

lar_status lar_fit_apart_create(lar_fit_work *work, const int32_t (*point)[3], lar_error *error) {
    lar_fit_apart *apart = &work->apart;
    const size_t nodes = (size_t)work->mesh->node_count;
    int32_t *outer = NULL;
    lar_status status = lar_mesh_boundary(work->mesh, &outer, &apart->count, error);
    if (status) return status;
    apart->face = lar_calloc((size_t)apart->count, sizeof *apart->face);
    apart->crosses = lar_calloc((size_t)apart->count, sizeof *apart->crosses);
    apart->strict = lar_calloc((size_t)apart->count, sizeof *apart->strict);
    apart->ring = lar_calloc(nodes, sizeof *apart->ring);
    apart->extent = lar_calloc((size_t)apart->count, sizeof *apart->extent);
    apart->way = lar_calloc((size_t)apart->count, sizeof *apart->way);
    apart->span = lar_calloc((size_t)apart->count, sizeof *apart->span);
    apart->near_start = lar_calloc((size_t)apart->count + 1, sizeof *apart->near_start);
    apart->checked = lar_calloc(nodes, sizeof *apart->checked);
    apart->awake = lar_calloc(nodes, sizeof *apart->awake);
    apart->from = lar_calloc(nodes, sizeof *apart->from);
    bool ready = apart->face && apart->crosses && apart->strict && apart->ring && apart->extent &&
                 apart->near_start && apart->checked && apart->awake && apart->from && apart->way &&
                 apart->span;
    for (int32_t f = 0; ready && f < apart->count; f++) {
        for (int a = 0; a < 4; a++)
            apart->face[f][a] = work->mesh->element[outer[f] / 6][lar_face_node[outer[f] % 6][a]];
        span_face(work, point, f);
    }
    free(outer);
    ready = ready && lar_fit_list_around(apart->face[0], 4, (size_t)apart->count, 4,
                                         work->mesh->node_count, &apart->start, &apart->around);
    return ready ? LAR_OK : lar_fail_memory(error, 40 * nodes, "the outer faces");
}

/* ---- watching ------------------------------------------------------------------------------- */

enum { PORTION = 256 }; /* faces that one core lists at a time */

typedef struct listing {
    const lar_fit_work *work;
    lar_fit_near *near;
    size_t used, capacity;
    int32_t face, reach[3]; /* points of the grid between nodes of faces that are near */
    bool failed;
} listing;

typedef struct listings {
    lar_fit_work *work;
    listing *portion;
    int32_t portions;
} listings;

/* Whether two faces share a node, and all corners of both look the same way. */
static bool look_alike(const lar_fit_work *work, const int32_t a[4], const int32_t b[4]) {
    double normal[8][3];
    int shared = 0;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) shared += a[i] == b[k];
    if (shared == 0) return false;
    for (int c = 0; c < 8; c++) {
        const int32_t *node = c < 4 ? a : b;
        double out[3], in[3];
        lar_minus(work->x[node[(c + 1) & 3]], work->x[node[c & 3]], out);
        lar_minus(work->x[node[(c + 3) & 3]], work->x[node[c & 3]], in);
        lar_cross(out, in, normal[c]);
        const double length = lar_length(normal[c]);
        for (int i = 0; i < 3; i++) normal[c][i] /= length;
    }
    for (int c = 0; c < 8; c++)
        for (int d = 0; d < c; d++)
            if (!(lar_dot(normal[c], normal[d]) > ALIKE)) return false;
    return true;
}

static bool add_near(void *context, int32_t other) {
    listing *list = context;
    const lar_fit_apart *apart = &list->work->apart;
    if (other == list->face) return true;
    if (!apart->strict[list->face] && !apart->strict[other] &&
        look_alike(list->work, apart->face[list->face], apart->face[other]))
        return true;
    if (list->used == INT32_MAX || !LAR_GROW(list->near, list->capacity, list->used)) {
        list->failed = true;
        return false;
    }
    list->near[list->used++] = (lar_fit_near){.face = other};
    const lar_fit_span *a = &apart->span[list->face], *b = &apart->span[other];
    for (int i = 0; i < 3; i++) {
        const int32_t below = a->upper[i] - b->lower[i], above = b->upper[i] - a->lower[i];
        if (below > list->reach[i]) list->reach[i] = below;
        if (above > list->reach[i]) list->reach[i] = above;
    }
    return true;
}

static bool is_among(const bool *marked, const int32_t face[4]) {
    return marked[face[0]] || marked[face[1]] || marked[face[2]] || marked[face[3]];
}

/* Compares, where fmin and fmax would be calls: this is done for every step that is tried. */
static void bound_face(const lar_fit_work *work, int32_t f) {
    const int32_t *node = work->apart.face[f];
    lar_fit_extent *extent = &work->apart.extent[f];
    for (int i = 0; i < 3; i++) {
        double lower = work->x[node[0]][i], upper = lower;
        for (int a = 1; a < 4; a++) {
            const double at = work->x[node[a]][i];
            lower = at < lower ? at : lower;
            upper = at > upper ? at : upper;
        }
        extent->lower[i] = lower;
        extent->upper[i] = upper;
    }
}

/* Of one portion of faces; near_start[f + 1] becomes the number of f's. */
static void list_portion(void *context, int32_t first, int32_t end) {
    listings *all = context;
    lar_fit_apart *apart = &all->work->apart;
    listing *list = &all->portion[first / PORTION];
    list->work = all->work;
    for (int32_t f = first; f < end; f++) {
        const size_t before = list->used;
        apart->way[f] = 0;
        bound_face(all->work, f);
        list->face = f;
        if (is_among(apart->checked, apart->face[f]))
            lar_face_boxes_near(&apart->boxes, f, 2 * LEASH + GAP, add_near, list);
        apart->near_start[f + 1] = (int32_t)(list->used - before);
    }
}

/* The portions' lists, one after the other. */
static bool join_lists(const listings *all, lar_fit_apart *apart, int32_t reach[3]) {
    size_t count = 0, at = 0;
    for (int32_t p = 0; p < all->portions; p++) {
        if (all->portion[p].failed) return false;
        count += all->portion[p].used;
    }
    apart->near = count <= INT32_MAX ? lar_calloc(count + 1, sizeof *apart->near) : NULL;
    if (!apart->near) return false;
    for (int32_t p = 0; p < all->portions; p++) {
        const listing *list = &all->portion[p];
        if (list->used > 0) memcpy(apart->near + at, list->near, list->used * sizeof *list->near);
        at += list->used;
        for (int i = 0; i < 3; i++)
            if (list->reach[i] > reach[i]) reach[i] = list->reach[i];
    }
    for (int32_t f = 0; f < apart->count; f++) apart->near_start[f + 1] += apart->near_start[f];
    return true;
}

/* Boxes serve until nodes move. */
static lar_status make_boxes(lar_fit_work *work, lar_error *error) {
    lar_fit_apart *apart = &work->apart;
    if (apart->boxes.tree) return LAR_OK;
    return lar_face_boxes_create((const double(*)[3])work->x, (const int32_t(*)[4])apart->face,
                                 apart->count, &apart->boxes, error);
}

/* The faces that each face with a watched node may meet in this round. */
static lar_status list_near(lar_fit_work *work, lar_error *error) {
    lar_fit_apart *apart = &work->apart;
    listings all = {.work = work, .portions = apart->count / PORTION + 1};
    int32_t reach[3] = {0};
    free(apart->near);
    apart->near = NULL;
    lar_status status = make_boxes(work, error);
    if (!status) all.portion = lar_calloc((size_t)all.portions, sizeof *all.portion);
    if (all.portion) lar_parallel_for(apart->count, PORTION, list_portion, &all);
    if (!status && !(all.portion && join_lists(&all, apart, reach)))
        status = lar_fail_memory(error, 64 * sizeof *apart->near * (size_t)apart->count,
                                 "the faces near each face");
    for (int32_t p = 0; all.portion && p < all.portions; p++) free(all.portion[p].near);
    free(all.portion);
    if (!status) lar_fit_rows_reach(&work->rows, reach);
    return status;
}

lar_status lar_fit_apart_begin(lar_fit_work *work, lar_error *error) {
    lar_fit_apart *apart = &work->apart;
    const size_t nodes = (size_t)work->mesh->node_count;
    memcpy(apart->from, work->x, nodes * sizeof *apart->from);
    memcpy(apart->awake, work->awake, nodes * sizeof *apart->awake);
    apart->tries = 0;
    const lar_status status = apart->any ? list_near(work, error) : LAR_OK;
    lar_face_boxes_clear(&apart->boxes);
    return status;
}

/* How far the boxes around two faces are apart; negative: they meet. */
static double room_between(const lar_fit_extent *a, const lar_fit_extent *b) {
    double widest = a->lower[0] - b->upper[0];
    for (int i = 0; i < 3; i++) {
        const double above = a->lower[i] - b->upper[i], below = b->lower[i] - a->upper[i];
        widest = above > widest ? above : widest;
        widest = below > widest ? below : widest;
    }
    return widest;
}

/* What was found to be far enough is not looked at again before the nodes have gone as far. */
static bool is_pair_clear(const lar_fit_work *work, int32_t f, lar_fit_near *near) {
    const lar_fit_apart *apart = &work->apart;
    const double(*x)[3] = (const double(*)[3])work->x;
    const int32_t g = near->face;
    const double way = apart->way[f] + apart->way[g];
    if (way < near->clear) return true;
    const double room = room_between(&apart->extent[f], &apart->extent[g]);
    if (room > 2 * GAP) {
        near->clear = way + (room - GAP);
        return true;
    }
    const double clearance = lar_faces_clearance(x, apart->face[f], apart->face[g], GAP);
    near->clear = way + clearance;
    return clearance > 0 || !(lar_faces_cross(x, apart->face[f], apart->face[g], GAP) > 0);
}

static bool is_clear(const lar_fit_work *work, int32_t n) {
    const lar_fit_apart *apart = &work->apart;
    for (int32_t i = apart->start[n]; i < apart->start[n + 1]; i++) {
        const int32_t f = apart->around[i] / 4;
        for (int32_t k = apart->near_start[f]; k < apart->near_start[f + 1]; k++)
            if (!is_pair_clear(work, f, &apart->near[k])) return false;
    }
    return true;
}

void lar_fit_apart_place(lar_fit_work *work, int32_t n, const double x[3]) {
    const lar_fit_apart *apart = &work->apart;
    double step[3];
    lar_minus(x, work->x[n], step);
    memcpy(work->x[n], x, sizeof work->x[n]);
    if (!apart->any) return;
    const double length = lar_length(step);
    for (int32_t i = apart->start[n]; i < apart->start[n + 1]; i++) {
        const int32_t f = apart->around[i] / 4;
        apart->way[f] += length;
        bound_face(work, f);
    }
}

bool lar_fit_apart_move(lar_fit_work *work, int32_t n, const double x[3]) {
    const lar_fit_apart *apart = &work->apart;
    const bool checked = apart->any && apart->checked[n];
    double away[3], before[3];
    if (checked) {
        lar_minus(x, apart->from[n], away);
        if (!(lar_length(away) < LEASH)) return false;
    }
    memcpy(before, work->x[n], sizeof before);
    lar_fit_apart_place(work, n, x);
    if (!checked || is_clear(work, n)) return true;
    lar_fit_apart_place(work, n, before);
    return false;
}

/* ---- after a round -------------------------------------------------------------------------- */

/* Faces that cross though all of their nodes are watched were taken for neighbours that cannot. */
static void note_strict(lar_fit_apart *apart, int32_t *crossing) {
    *crossing = 0;
    for (int32_t f = 0; f < apart->count; f++) {
        bool all = apart->crosses[f];
        *crossing += all;
        for (int a = 0; all && a < 4; a++) all = apart->checked[apart->face[f][a]];
        apart->strict[f] = apart->strict[f] || all;
    }
}

/* Watches the nodes of faces that cross, and rings of faces around them. */
static void check_around(lar_fit_apart *apart, size_t nodes) {
    memset(apart->ring, 0, nodes * sizeof *apart->ring);
    for (int ring = 0; ring <= RINGS; ring++) {
        for (int32_t f = 0; f < apart->count; f++)
            for (int a = 0; apart->crosses[f] && a < 4; a++) apart->ring[apart->face[f][a]] = true;
        for (int32_t f = 0; f < apart->count; f++)
            apart->crosses[f] = apart->crosses[f] || is_among(apart->ring, apart->face[f]);
    }
    for (size_t n = 0; n < nodes; n++) apart->checked[n] = apart->checked[n] || apart->ring[n];
}

/* Of one face that crosses another one, the pair counts where the other has a higher number. */
static bool crosses(const lar_fit_work *work, int32_t f, int32_t other, bool *pair) {
    const lar_fit_apart *apart = &work->apart;
    if (room_between(&apart->extent[f], &apart->extent[other]) > GAP) return false;
    if (!(lar_faces_cross((const double(*)[3])work->x, apart->face[f], apart->face[other], GAP) >
          0))
        return false;
    *pair = *pair || other > f;
    return true;
}

/* Of some faces, among those that were listed near them and those that share a node with them. */
static void look_at_lists(void *context, int32_t first, int32_t end) {
    lar_fit_work *work = context;
    lar_fit_apart *apart = &work->apart;
    bool pair = false;
    for (int32_t f = first; f < end; f++) {
        bool found = false;
        for (int32_t k = apart->near_start[f]; k < apart->near_start[f + 1]; k++)
            if (crosses(work, f, apart->near[k].face, &pair)) found = true;
        for (int a = 0; a < 4; a++) {
            const int32_t n = apart->face[f][a];
            for (int32_t i = apart->start[n]; i < apart->start[n + 1]; i++)
                if (apart->around[i] / 4 != f && crosses(work, f, apart->around[i] / 4, &pair))
                    found = true;
        }
        apart->crosses[f] = found;
    }
    if (pair) __atomic_store_n(&apart->pairs, true, __ATOMIC_RELAXED);
}

/* Which faces cross, and whether any do. Where all nodes are watched none has gone farther than
 * the lists of near faces reach. */
static lar_status find(lar_fit_work *work, double gap, bool *any, lar_error *error) {
    lar_fit_apart *apart = &work->apart;
    lar_face_crossings found;
    if (apart->all && gap == GAP) {
        apart->pairs = false;
        lar_parallel_for(apart->count, PORTION, look_at_lists, work);
        *any = apart->pairs;
        return LAR_OK;
    }
    lar_status status = make_boxes(work, error);
    if (!status)
        status = lar_faces_find_crossings((const double(*)[3])work->x,
                                          (const int32_t(*)[4])apart->face, apart->count, gap,
                                          &apart->boxes, apart->crosses, &found, error);
    *any = !status && found.pairs > 0;
    return status;
}

/* What is watched from now on. Where a body has but few places to cross, more of them are watched
 * each time; another one's are watched everywhere at once: a round that is done again costs more.
 */
static lar_status check_more(lar_fit_work *work, lar_error *error) {
    lar_fit_apart *apart = &work->apart;
    const size_t nodes = (size_t)work->mesh->node_count;
    int32_t crossing;
    bool near;
    note_strict(apart, &crossing);
    const bool few = !apart->any || crossing < FEW * apart->count;
    if (apart->all || ++apart->tries == LOCAL) memset(apart->strict, true, (size_t)apart->count);
    if (apart->all || !few || apart->tries == LOCAL) {
        apart->all = true;
        memset(apart->checked, true, nodes);
        return LAR_OK;
    }
    lar_status status = find(work, WARY, &near, error);
    if (!status) check_around(apart, nodes);
    return status;
}

lar_status lar_fit_apart_check(lar_fit_work *work, bool *again, lar_error *error) {
    lar_fit_apart *apart = &work->apart;
    const size_t nodes = (size_t)work->mesh->node_count;
    lar_status status = find(work, GAP, again, error);
    if (*again) status = check_more(work, error);
    if (status || !*again) return status;
    apart->any = true;
    memcpy(work->x, apart->from, nodes * sizeof *work->x);
    memcpy(work->awake, apart->awake, nodes * sizeof *work->awake);
    lar_face_boxes_clear(&apart->boxes);
    status = list_near(work, error);
    lar_face_boxes_clear(&apart->boxes);
    return status;
}
