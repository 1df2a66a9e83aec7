#include "contact/contact_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/vector.h"

enum { DEPTH = 64 };

/* ---- boxes ---------------------------------------------------------------------------------- */

static const lar_box no_box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

/* What a face may move along any axis [m]. */
static double face_allow(const lar_contact_search *search, int32_t f) {
    const int32_t *corner = search->tree->surface.face[f].corner;
    const double *allow = search->next.allow;
    return lar_greater(lar_greater(allow[corner[0]], allow[corner[1]]),
                       lar_greater(allow[corner[2]], allow[corner[3]]));
}

/* A face's box, grown by its reach for any node, and by what it may move. */
static lar_box box_of(const lar_contact_search *search, int32_t f) {
    const lar_contact_surface *s = &search->tree->surface;
    const lar_contact_face *face = &s->face[f];
    lar_box box = no_box;
    double grown = s->body[face->body].reach[s->body_count > 1] + face_allow(search, f);
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) {
            box.lower[i] = lar_lesser(box.lower[i], search->x[face->corner[a]][i] - grown);
            box.upper[i] = lar_greater(box.upper[i], search->x[face->corner[a]][i] + grown);
        }
    return box;
}

/* The box of branch k: of a face, or around those of a fork. */
static void fit_branch(lar_contact_search *search, int32_t fork, int k) {
    const int32_t *branch = search->tree->fork[fork].branch;
    const bool there = k == 0 || branch[k] != branch[0];
    lar_fork_box *box = &search->fork_box[fork];
    const lar_box *face = there && branch[k] < 0 ? &search->face_box[~branch[k]] : &no_box;
    const lar_fork_box *below = there && branch[k] >= 0 ? &search->fork_box[branch[k]] : NULL;
    for (int i = 0; i < 3; i++) {
        box->lower[i][k] = (float)face->lower[i];
        box->upper[i][k] = (float)face->upper[i];
        for (int j = 0; j < LAR_FORK && below; j++) {
            if (below->lower[i][j] < box->lower[i][k]) box->lower[i][k] = below->lower[i][j];
            if (below->upper[i][j] > box->upper[i][k]) box->upper[i][k] = below->upper[i][j];
        }
    }
}

/* The boxes of some more faces; with the last ones, those of all forks. */
static void fit_boxes(lar_contact_search *search, int32_t faces) {
    const lar_contact_tree *tree = search->tree;
    const lar_contact_surface *s = &tree->surface;
    int32_t left = s->face_count - search->boxes,
            end = search->boxes + (faces < left ? faces : left);
    for (int32_t i = search->boxes; i < end; i++)
        search->face_box[i] = box_of(search, tree->order[i]);
    search->boxes = end;
    if (end < s->face_count) return;
    for (int32_t fork = tree->fork_count - 1; fork >= 0; fork--)
        for (int k = 0; k < LAR_FORK; k++) fit_branch(search, fork, k);
}

/* Which branches' boxes meet another one: -1, or 0. Without a jump between comparisons, and where
 * they are used: nobody could guess how they come out. */
typedef int32_t lanes __attribute__((vector_size(4 * LAR_FORK)));
static inline lanes meets(const lar_fork_box *box, const lar_fours lower[3],
                          const lar_fours upper[3]) {
    return (upper[0] >= box->lower[0]) & (lower[0] <= box->upper[0]) & (upper[1] >= box->lower[1]) &
           (lower[1] <= box->upper[1]) & (upper[2] >= box->lower[2]) & (lower[2] <= box->upper[2]);
}

/* ---- the list ------------------------------------------------------------------------------- */

/* By body, then by number. They are few. */
static void sort(const lar_contact_face *face, int32_t *list, int32_t count) {
    for (int32_t i = 1; i < count; i++) {
        const int32_t f = list[i], body = face[f].body;
        int32_t at = i;
        for (; at > 0; at--) {
            const int32_t before = list[at - 1], other = face[before].body;
            if (other < body || (other == body && before < f)) break;
            list[at] = before;
        }
        list[at] = f;
    }
}

/* Marks the faces that a node never meets: every node is in the boxes of its neighbours. */
static void mark_apart(lar_contact_search *search, int32_t node) {
    const lar_contact_surface *s = &search->tree->surface;
    for (int64_t i = s->apart_first[node]; i < s->apart_first[node + 1]; i++)
        search->apart[s->apart[i]] = node + 1;
}

/* The faces whose boxes a node's meets, behind those in the list; -1: there is no room. */
static int32_t find_faces(const lar_contact_search *search, int32_t node, const double x[3],
                          double allow, int32_t *face, int32_t room) {
    const lar_contact_tree *tree = search->tree;
    const lar_contact_surface *s = &tree->surface;
    const uint64_t passes = s->node[node].passes;
    const int32_t not_of = node < s->node_count ? -1 : s->node[node].body;
    int32_t stack[DEPTH], depth = 0, count = 0;
    lar_fours lower[3], upper[3];
    for (int i = 0; i < 3; i++) {
        lower[i] = (lar_fours){0} + (float)(x[i] - allow);
        upper[i] = (lar_fours){0} + (float)(x[i] + allow);
    }
    stack[depth++] = 0;
    while (depth > 0) {
        const int32_t fork = stack[--depth], *branch = tree->fork[fork].branch;
        const lanes in = meets(&search->fork_box[fork], lower, upper);
        for (int k = 0; k < LAR_FORK && branch[0] >= 0; k++) {
            stack[depth] = branch[k];
            depth -= in[k];
        }
        if (branch[0] >= 0) continue;
        if (room - count < LAR_FORK) return -1;
        for (int k = 0; k < LAR_FORK; k++) {
            const int32_t f = face[count] = tree->order[~branch[k]];
            const lar_contact_face *one = &s->face[f];
            count += (in[k] != 0) & (search->apart[f] != node + 1) & (one->body != not_of) &
                     ((passes & (one->active | one->mute)) != 0);
        }
    }
    sort(s->face, face, count);
    return count;
}

/* How far a node is outside a face's box that is grown by its reach only, along some axis. */
static double outside(const lar_contact_search *search, int32_t f, const double x[3]) {
    const lar_box *box = &search->face_box[search->tree->place[f]];
    double allow = face_allow(search, f), max = -INFINITY;
    for (int i = 0; i < 3; i++)
        max = lar_greater(
            max, lar_greater(box->lower[i] + allow - x[i], x[i] - (box->upper[i] - allow)));
    return max;
}

/* Cuts the faces of a node into groups of one body each. A group of mute faces pushes nobody. */
static bool add_groups(lar_contact_search *search, int32_t node, const double x[3], int32_t count) {
    const lar_contact_surface *s = &search->tree->surface;
    lar_contact_list *list = &search->next;
    int32_t *face = list->face + list->face_count, kept = 0;
    float *gap = list->gap + list->face_count;
    for (int32_t from = 0, to; from < count; from = to) {
        bool active = false;
        float least = INFINITY;
        for (to = from; to < count && s->face[face[to]].body == s->face[face[from]].body; to++) {
            active = active || lar_contact_active(&s->node[node], &s->face[face[to]]);
            int32_t at = kept + to - from;
            gap[at] = (float)(0.999 * outside(search, face[to], x));
            least = gap[at] < least ? gap[at] : least;
        }
        if (!active) continue;
        if (list->group_count == list->group_room || to - from > LAR_GROUP_FACES_MAX) return false;
        list->group[list->group_count++] =
            (lar_contact_group){node, list->face_count + kept, to - from, least};
        for (int32_t i = from; i < to; i++) face[kept++] = face[i];
    }
    list->face_count += kept;
    return true;
}

/* A node's place, or a point's, and what it may move: no more than some parent. */
static double find_place(const lar_contact_search *search, int32_t node, double x[3]) {
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    int count = lar_contact_parents(&search->tree->surface, node, parent, weight);
    double allow = search->next.allow[parent[0]];
    for (int k = 1; k < count; k++) allow = lar_greater(allow, search->next.allow[parent[k]]);
    for (int i = 0; i < 3; i++) {
        x[i] = weight[0] * search->x[parent[0]][i];
        for (int k = 1; k < count; k++) x[i] += weight[k] * search->x[parent[k]][i];
    }
    return allow;
}

void lar_contact_share_alike(lar_contact_search *search) {
    for (int32_t n = 0; n < search->tree->surface.node_count; n++) search->share[n] = 1;
}

void lar_contact_search_begin(lar_contact_search *search, const double (*x)[3], double skin) {
    lar_contact_list *list = &search->next;
    list->group_count = list->face_count = 0;
    list->skin = skin;
    for (int32_t n = 0; n < search->tree->surface.node_count; n++)
        list->allow[n] = 0.5 * skin * search->share[n];
    search->x = x;
    search->at = search->boxes = 0;
}

/* Boxes are made several times as fast as nodes are looked for. */
enum { BOXES_PER_NODE = 4 };

int32_t lar_contact_search_left(const lar_contact_search *search) {
    return search->tree->surface.point_count - search->at +
           (search->tree->surface.face_count - search->boxes) / BOXES_PER_NODE;
}

lar_contact_progress lar_contact_search_go_on(lar_contact_search *search, int32_t nodes) {
    const lar_contact_surface *s = &search->tree->surface;
    lar_contact_list *list = &search->next;
    if (search->boxes < s->face_count) {
        fit_boxes(search,
                  nodes < s->face_count / BOXES_PER_NODE ? nodes * BOXES_PER_NODE : s->face_count);
        if (search->boxes < s->face_count || nodes < s->point_count) return LAR_SEARCH_UNDER_WAY;
    }
    int32_t end = nodes < s->point_count - search->at ? search->at + nodes : s->point_count;
    for (int32_t n = search->at; n < end; n++) {
        double x[3];
        if (!s->node[n].passes) continue;
        if (n < s->node_count) mark_apart(search, n);
        double allow = find_place(search, n, x);
        int32_t count = find_faces(search, n, x, allow, list->face + list->face_count,
                                   list->face_room - list->face_count);
        if (count < 0 || !add_groups(search, n, x, count)) return LAR_SEARCH_FULL;
    }
    search->at = end;
    if (end < s->point_count) return LAR_SEARCH_UNDER_WAY;
    lar_contact_list done = search->next;
    search->next = search->list;
    search->list = done;
    return LAR_SEARCH_DONE;
}

lar_contact_progress lar_contact_search_until(lar_contact_search *search, double until,
                                              double after) {
    enum { AT_ONCE = 64 };
    lar_contact_progress progress = LAR_SEARCH_UNDER_WAY;
    for (double left = until - lar_clock_seconds(); left > 0 && progress == LAR_SEARCH_UNDER_WAY;
         left = until - lar_clock_seconds()) {
        if (lar_contact_search_left(search) <= AT_ONCE && left < after) break;
        progress = lar_contact_search_go_on(search, AT_ONCE);
    }
    return progress;
}

bool lar_contact_search_run(lar_contact_search *search, const double (*x)[3], double skin) {
    enum { HALVINGS = 6 };
    for (int i = 0; i <= HALVINGS; i++, skin /= 2) {
        lar_contact_search_begin(search, x, i < HALVINGS ? skin : 0);
        if (lar_contact_search_go_on(search, INT32_MAX) == LAR_SEARCH_DONE) return true;
    }
    return false;
}

/* ---- creation ------------------------------------------------------------------------------- */

static lar_status allocate_list(const lar_contact_surface *surface, lar_contact_list *list,
                                lar_error *error) {
    int64_t pairs = (int64_t)surface->slave_count * LAR_PAIRS_PER_NODE;
    int64_t groups = (int64_t)surface->slave_count * (LAR_PAIRS_PER_NODE / 8);
    list->face_room = pairs < INT32_MAX ? (int32_t)pairs : INT32_MAX;
    list->group_room = groups < INT32_MAX ? (int32_t)groups : INT32_MAX;
    list->face = lar_calloc((size_t)list->face_room, sizeof *list->face);
    list->gap = lar_calloc((size_t)list->face_room, sizeof *list->gap);
    list->group = lar_calloc((size_t)list->group_room, sizeof *list->group);
    list->allow = lar_calloc((size_t)surface->node_count, sizeof *list->allow);
    if (list->face && list->gap && list->group && list->allow) return LAR_OK;
    return lar_fail_memory(error, 8 * (size_t)pairs + sizeof *list->group * (size_t)groups,
                           "pairs in contact");
}

lar_status lar_contact_search_create(const lar_contact_tree *tree, lar_contact_search *search,
                                     lar_error *error) {
    size_t faces = (size_t)tree->surface.face_count, forks = (size_t)tree->fork_count;
    size_t nodes = (size_t)tree->surface.node_count;
    *search = (lar_contact_search){.tree = tree,
                                   .fork_box = lar_calloc_aligned(forks, sizeof *search->fork_box),
                                   .face_box = lar_calloc(faces, sizeof *search->face_box),
                                   .apart = lar_calloc(faces, sizeof *search->apart),
                                   .share = lar_calloc(nodes, sizeof *search->share)};
    bool fits = search->fork_box && search->face_box && search->apart && search->share;
    lar_status status =
        fits ? LAR_OK : lar_fail_memory(error, 100 * faces, "the boxes of surfaces");
    if (!status) status = allocate_list(&tree->surface, &search->list, error);
    if (!status) status = allocate_list(&tree->surface, &search->next, error);
    if (status)
        lar_contact_search_clear(search);
    else
        lar_contact_share_alike(search);
    return status;
}

void lar_contact_search_clear(lar_contact_search *search) {
    free(search->fork_box);
    free(search->face_box);
    free(search->apart);
    free(search->share);
    for (int i = 0; i < 2; i++) {
        lar_contact_list *list = i ? &search->next : &search->list;
        free(list->group);
        free(list->face);
        free(list->gap);
        free(list->allow);
    }
    *search = (lar_contact_search){0};
}
