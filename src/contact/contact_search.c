#include "contact/contact_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "contact/history/flush.h"
#include "mechanics/face_contact.h"
#include "model/contact_check.h"

enum { PATCH_FACES = 8, DEPTH = 64 };

/* ---- the tree ------------------------------------------------------------------------------- */

/* Puts the faces order[first ..] with the smaller middles along an axis before the others, half of
 * them each (Hoare's selection). */
static void halve(int32_t *order, int32_t count, const double (*middle)[3], int axis) {
    int32_t low = 0, high = count - 1, half = count / 2;
    while (low < high) {
        double pivot = middle[order[low + (high - low) / 2]][axis];
        int32_t i = low, j = high;
        while (i <= j) {
            while (middle[order[i]][axis] < pivot) i++;
            while (middle[order[j]][axis] > pivot) j--;
            if (i > j) break;
            int32_t swap = order[i];
            order[i++] = order[j];
            order[j--] = swap;
        }
        if (half <= j)
            high = j;
        else if (half >= i)
            low = i;
        else
            break;
    }
}

static int widest_axis(const int32_t *order, int32_t count, const double (*middle)[3]) {
    double extent[3];
    for (int i = 0; i < 3; i++) {
        double low = INFINITY, high = -INFINITY;
        for (int32_t f = 0; f < count; f++) {
            low = fmin(low, middle[order[f]][i]);
            high = fmax(high, middle[order[f]][i]);
        }
        extent[i] = high - low;
    }
    return extent[0] >= extent[1] && extent[0] >= extent[2] ? 0 : extent[1] >= extent[2] ? 1 : 2;
}

/* The patch of some faces and all below it; its depth is that of a balanced tree. */
static void divide(lar_contact_tree *tree, int32_t first, int32_t count,
                   const double (*middle)[3]) {
    int32_t own = tree->patch_count++;
    tree->patch[own] = (lar_patch){first, count, 0};
    if (count <= PATCH_FACES) return;
    int32_t *order = tree->order + first;
    halve(order, count, middle, widest_axis(order, count, middle));
    divide(tree, first, count / 2, middle);
    tree->patch[own].right = tree->patch_count;
    divide(tree, first + count / 2, count - count / 2, middle);
}

static lar_status build_tree(lar_contact_tree *tree, lar_error *error) {
    const lar_contact_surface *s = &tree->surface;
    size_t faces = (size_t)s->face_count;
    double(*middle)[3] = lar_calloc(faces, sizeof *middle);
    tree->order = lar_calloc(faces, sizeof *tree->order);
    tree->patch = lar_calloc(2 * faces + 1, sizeof *tree->patch);
    tree->place = lar_calloc(faces, sizeof *tree->place);
    bool fits = middle && tree->order && tree->patch && tree->place;
    for (int32_t f = 0; f < s->face_count && fits; f++) {
        tree->order[f] = f;
        for (int a = 0; a < 4; a++)
            for (int i = 0; i < 3; i++) middle[f][i] += 0.25 * s->rest[s->face[f].corner[a]][i];
    }
    if (fits) divide(tree, 0, s->face_count, (const double(*)[3])middle);
    for (int32_t i = 0; i < s->face_count && fits; i++) tree->place[tree->order[i]] = i;
    free(middle);
    return fits ? LAR_OK : lar_fail_memory(error, 64 * faces, "the boxes of surfaces");
}

/* ---- boxes ---------------------------------------------------------------------------------- */

static void join_box(lar_box *box, const lar_box *other) {
    for (int i = 0; i < 3; i++) {
        box->lower[i] = lar_lesser(box->lower[i], other->lower[i]);
        box->upper[i] = lar_greater(box->upper[i], other->upper[i]);
    }
}

static const lar_box no_box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

/* A face's box, grown by its reach for any node and the skin. */
static lar_box box_of(const lar_contact_surface *s, const lar_contact_face *face,
                      const double (*x)[3], double skin) {
    lar_box box = no_box;
    double reach = s->body[face->body].reach[s->body_count > 1];
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) {
            box.lower[i] = lar_lesser(box.lower[i], x[face->corner[a]][i] - reach - skin);
            box.upper[i] = lar_greater(box.upper[i], x[face->corner[a]][i] + reach + skin);
        }
    return box;
}

/* The boxes of some more faces; with the last ones, those of all patches. Halves stand behind what
 * they are halves of. */
static void fit_boxes(lar_contact_search *search, int32_t faces) {
    const lar_contact_tree *tree = search->tree;
    const lar_contact_surface *s = &tree->surface;
    int32_t left = s->face_count - search->boxes,
            end = search->boxes + (faces < left ? faces : left);
    for (int32_t i = search->boxes; i < end; i++)
        search->face_box[i] = box_of(s, &s->face[tree->order[i]], search->x, search->next.skin);
    search->boxes = end;
    if (end < s->face_count) return;
    for (int32_t p = tree->patch_count - 1; p >= 0; p--) {
        const lar_patch *patch = &tree->patch[p];
        lar_box *box = &search->patch_box[p];
        *box = no_box;
        if (patch->right) {
            join_box(box, &search->patch_box[p + 1]);
            join_box(box, &search->patch_box[patch->right]);
            continue;
        }
        for (int32_t i = 0; i < patch->count; i++)
            join_box(box, &search->face_box[patch->first + i]);
    }
}

/* Without a branch between the comparisons: nobody can guess how they come out. */
static inline bool holds(const lar_box *box, const double x[3]) {
    return ((x[0] >= box->lower[0]) & (x[0] <= box->upper[0]) & (x[1] >= box->lower[1]) &
            (x[1] <= box->upper[1]) & (x[2] >= box->lower[2]) & (x[2] <= box->upper[2])) != 0;
}

/* ---- the list ------------------------------------------------------------------------------- */

/* By body, then by number: few, so they are sorted as they come. */
static void insert(const lar_contact_face *face, int32_t *list, int32_t count, int32_t f) {
    int32_t at = count;
    for (; at > 0; at--) {
        int32_t before = list[at - 1];
        if (face[before].body < face[f].body || (face[before].body == face[f].body && before < f))
            break;
        list[at] = before;
    }
    list[at] = f;
}

/* Marks the faces that a node never meets: every node is in the boxes of its neighbours. */
static void mark_apart(lar_contact_search *search, int32_t node) {
    const lar_contact_surface *s = &search->tree->surface;
    for (int64_t i = s->apart_first[node]; i < s->apart_first[node + 1]; i++)
        search->apart[s->apart[i]] = node + 1;
}

/* The faces whose boxes hold a node, behind those in the list; -1: there is no room. */
static int32_t find_faces(const lar_contact_search *search, int32_t node, const double x[3],
                          int32_t *face, int32_t room) {
    const lar_contact_tree *tree = search->tree;
    const lar_contact_surface *s = &tree->surface;
    uint64_t passes = s->node[node].passes;
    int32_t stack[DEPTH], depth = 0, count = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        int32_t p = stack[--depth];
        const lar_patch *patch = &tree->patch[p];
        if (!holds(&search->patch_box[p], x)) continue;
        if (patch->right) {
            stack[depth++] = patch->right;
            stack[depth++] = p + 1;
            continue;
        }
        for (int32_t i = patch->first; i < patch->first + patch->count; i++) {
            if (!holds(&search->face_box[i], x)) continue;
            int32_t f = tree->order[i];
            if (search->apart[f] == node + 1 || !(passes & (s->face[f].active | s->face[f].mute)))
                continue;
            if (node >= s->node_count && s->face[f].body == s->node[node].body) continue;
            if (count == room) return -1;
            insert(s->face, face, count++, f);
        }
    }
    return count;
}

/* How far a node is outside a face's box without the skin, along some axis. */
static double outside(const lar_box *box, double skin, const double x[3]) {
    double max = -INFINITY;
    for (int i = 0; i < 3; i++)
        max = lar_greater(max,
                          lar_greater(box->lower[i] + skin - x[i], x[i] - (box->upper[i] - skin)));
    return max;
}

/* Cuts the faces of a node into groups of one body each. A group of mute faces pushes nobody. */
static bool add_groups(lar_contact_search *search, int32_t node, const double x[3], int32_t count) {
    const lar_contact_tree *tree = search->tree;
    const lar_contact_surface *s = &tree->surface;
    lar_contact_list *list = &search->next;
    int32_t *face = list->face + list->face_count, kept = 0;
    for (int32_t from = 0, to; from < count; from = to) {
        bool active = false;
        double gap = INFINITY;
        for (to = from; to < count && s->face[face[to]].body == s->face[face[from]].body; to++) {
            active = active || lar_contact_active(&s->node[node], &s->face[face[to]]);
            gap = lar_lesser(gap, outside(&search->face_box[tree->place[face[to]]], list->skin, x));
        }
        if (!active) continue;
        if (list->group_count == list->group_room || to - from > LAR_GROUP_FACES_MAX) return false;
        list->group[list->group_count++] =
            (lar_contact_group){node, list->face_count + kept, to - from, (float)(0.999 * gap)};
        for (int32_t i = from; i < to; i++) face[kept++] = face[i];
    }
    list->face_count += kept;
    return true;
}

static void find_place(const lar_contact_search *search, int32_t node, double x[3]) {
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    int count = lar_contact_parents(&search->tree->surface, node, parent, weight);
    for (int i = 0; i < 3; i++) {
        x[i] = weight[0] * search->x[parent[0]][i];
        for (int k = 1; k < count; k++) x[i] += weight[k] * search->x[parent[k]][i];
    }
}

void lar_contact_search_begin(lar_contact_search *search, const double (*x)[3], double skin) {
    lar_contact_list *list = &search->next;
    list->group_count = list->face_count = 0;
    list->skin = skin;
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
        find_place(search, n, x);
        int32_t count = find_faces(search, n, x, list->face + list->face_count,
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
    list->group = lar_calloc((size_t)list->group_room, sizeof *list->group);
    if (list->face && list->group) return LAR_OK;
    return lar_fail_memory(error, 4 * (size_t)pairs + sizeof *list->group * (size_t)groups,
                           "pairs in contact");
}

/* Where a node stands to a face when nothing has moved. */
static void stand_at_rest(const lar_contact_surface *s, int32_t node, int32_t face,
                          lar_face_point *point) {
    const lar_contact_face *f = &s->face[face];
    double corner[4][3];
    for (int a = 0; a < 4; a++) memcpy(corner[a], s->rest[f->corner[a]], sizeof corner[a]);
    lar_face_closest(s->rest[node], (const double(*)[3])corner, LAR_FACE_TIE * f->size, point);
}

/* The node lies in the layer below the face although nothing has moved. */
static bool overlaps_at_rest(const lar_contact_surface *s, int32_t node, int32_t face) {
    const lar_contact_face *f = &s->face[face];
    lar_face_point point;
    stand_at_rest(s, node, face, &point);
    return point.distance <= lar_contact_reach(s, &s->node[node], f) &&
           point.height < -LAR_FACE_TIE * f->size;
}

/* A node inside another body, at rest. */
typedef struct overlap {
    int32_t node, face;
    double depth; /* [m] */
} overlap;

/* What contact would do to the node of a group at rest: of its faces within reach the closest one
 * counts, of equally close ones the one over or under whose plane it is farthest (body_contact.h).
 */
static void find_overlap(const lar_contact_surface *s, const lar_contact_list *list,
                         const lar_contact_group *group, overlap *deepest) {
    const int32_t *face = list->face + group->first;
    double reach = lar_contact_reach(s, &s->node[group->node], &s->face[face[0]]), min = reach;
    lar_face_point point, chosen = {0};
    int32_t at = -1;
    for (int32_t i = 0; i < group->count; i++) {
        stand_at_rest(s, group->node, face[i], &point);
        min = lar_lesser(min, point.distance);
    }
    for (int32_t i = 0; i < group->count; i++) {
        stand_at_rest(s, group->node, face[i], &point);
        if (point.distance > min + LAR_FACE_TIE * s->face[face[i]].size) continue;
        if (at >= 0 && !lar_face_point_before(&point, &chosen)) continue;
        chosen = point;
        at = face[i];
    }
    if (at < 0 || !(chosen.height < 0) || !(chosen.distance > deepest->depth) ||
        !lar_contact_active(&s->node[group->node], &s->face[at]))
        return;
    *deepest = (overlap){group->node, at, chosen.distance};
}

/* How far bodies are from others at rest: from there on nothing may push them. What touches but for
 * rounding touches. */
static void measure_clearance(lar_contact_surface *s, const lar_contact_list *list,
                              double rounding) {
    for (int32_t g = 0; g < list->group_count; g++) {
        const lar_contact_group *group = &list->group[g];
        int32_t own = s->node[group->node].body, other = s->face[list->face[group->first]].body;
        if (own == other) continue;
        for (int32_t i = 0; i < group->count; i++) {
            lar_face_point point;
            stand_at_rest(s, group->node, list->face[group->first + i], &point);
            double clear = point.distance > rounding ? 0.999 * point.distance : 0;
            s->body[own].clear = lar_lesser(s->body[own].clear, clear);
            s->body[other].clear = lar_lesser(s->body[other].clear, clear);
        }
    }
}

/* Whether a face lies over one of another body, in its plane, and looks the same way. */
static bool lies_on(const lar_contact_surface *s, int32_t face, int32_t other, double rounding) {
    static const double middle[4] = {0.25, 0.25, 0.25, 0.25};
    double own[4][3], corner[4][3], x[3], way[2][3];
    lar_face_point point;
    for (int a = 0; a < 4; a++) {
        memcpy(own[a], s->rest[s->face[face].corner[a]], sizeof own[a]);
        memcpy(corner[a], s->rest[s->face[other].corner[a]], sizeof corner[a]);
    }
    lar_face_mean((const double(*)[3])own, middle, x);
    lar_face_closest(x, (const double(*)[3])corner, LAR_FACE_TIE * s->face[other].size, &point);
    lar_face_normal((const double(*)[3])own, way[0]);
    lar_face_normal((const double(*)[3])corner, way[1]);
    double along = way[0][0] * way[1][0] + way[0][1] * way[1][1] + way[0][2] * way[1][2];
    return point.distance <= rounding && along > 0;
}

/* A face of another body that this one lies on, among those near its corners; -1: none. Groups come
 * by node: those of node n are first[n] up to first[n + 1]. */
static int32_t find_under(const lar_contact_surface *s, const lar_contact_list *list,
                          const int32_t *first, int32_t face, double rounding) {
    for (int a = 0; a < 4; a++) {
        int32_t n = s->face[face].corner[a];
        for (int32_t g = first[n]; g < first[n + 1]; g++)
            for (int32_t i = 0; i < list->group[g].count; i++) {
                int32_t other = list->face[list->group[g].first + i];
                if (s->face[other].body != s->face[face].body &&
                    lar_contact_active(&s->node[n], &s->face[other]) &&
                    lies_on(s, face, other, rounding))
                    return other;
            }
    }
    return -1;
}

/* Bodies may be in each other with all nodes on each other's surfaces: a mesh that was given twice,
 * bars of one width that are shifted along. Then faces of both lie in one plane, one over the
 * other, and look the same way. */
static lar_status refuse_twice(const lar_model *model, const lar_contact_search *search,
                               lar_error *error) {
    const lar_contact_surface *s = &search->tree->surface;
    const lar_contact_list *list = &search->list;
    double rounding = lar_overlap_rounding(&model->mesh);
    int32_t own = -1, other = -1;
    int32_t *first = lar_calloc((size_t)s->point_count + 1, sizeof *first);
    if (!first) return lar_fail_memory(error, 4 * (size_t)s->point_count, "bodies at rest");
    for (int32_t g = 0; g < list->group_count; g++) first[list->group[g].node + 1] = g + 1;
    for (int32_t n = 0; n < s->point_count; n++)
        if (first[n + 1] < first[n]) first[n + 1] = first[n];
    for (int32_t f = 0; f < s->face_count && other < 0; f++) {
        own = f;
        other = find_under(s, list, first, f, rounding);
    }
    free(first);
    if (other < 0) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s: elements %lld and %lld, of two bodies that may touch, lie in each other "
                    "at the start, and contact could not tell which way is out; move the bodies "
                    "apart (was a mesh given twice?), or leave contact between them out",
                    lar_model_source(model),
                    (long long)model->mesh.element_id[s->face[own].element],
                    (long long)model->mesh.element_id[s->face[other].element]);
}

/* Contact would throw the two apart, with energy from nowhere. */
static lar_status refuse_overlap(const lar_model *model, const lar_contact_search *search,
                                 lar_error *error) {
    const lar_contact_surface *s = &search->tree->surface;
    const lar_contact_list *list = &search->list;
    overlap deepest = {-1, -1, lar_overlap_rounding(&model->mesh)};
    for (int32_t g = 0; g < list->group_count; g++) {
        const lar_contact_group *group = &list->group[g];
        if (s->face[list->face[group->first]].body != s->node[group->node].body)
            find_overlap(s, list, group, &deepest);
    }
    if (deepest.node < 0) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s: node %lld lies %.3g m inside another body at the start, below the surface "
                    "at element %lld, and contact would throw the two apart; move the bodies "
                    "apart, or leave contact between them out",
                    lar_model_source(model),
                    (long long)model->mesh.node_id[s->node[deepest.node].node], deepest.depth,
                    (long long)model->mesh.element_id[s->face[deepest.face].element]);
}

/* Within one body that is its shape, and nothing to be pushed apart. Bodies that lie in each other
 * are refused. */
static lar_status keep_shape(const lar_model *model, lar_contact_search *search,
                             lar_contact_surface *s, lar_error *error) {
    const lar_contact_list *list = &search->list;
    if (!lar_contact_search_run(search, (const double(*)[3])s->rest, 0))
        return lar_fail(
            error, LAR_ERROR_MODEL,
            "contact: more than %d faces, or %d bodies, are near the nodes that may "
            "touch them, in the mean: bodies of one or two elements are packed closely, "
            "or surfaces overlap at many places; take fewer or larger bodies, or wider "
            "gaps",
            LAR_PAIRS_PER_NODE, LAR_PAIRS_PER_NODE / 8);
    lar_status status = refuse_overlap(model, search, error);
    if (!status) status = refuse_twice(model, search, error);
    if (status) return status;
    measure_clearance(s, list, lar_overlap_rounding(&model->mesh));
    status = lar_flush_find(s, list, lar_overlap_rounding(&model->mesh), error);
    if (status) return status;
    int32_t(*pair)[2] = lar_calloc((size_t)list->face_count, sizeof *pair), count = 0;
    if (!pair) return lar_fail_memory(error, 8 * (size_t)list->face_count, "pairs at rest");
    for (int32_t g = 0; g < list->group_count; g++) {
        const lar_contact_group *group = &list->group[g];
        for (int32_t i = group->first; i < group->first + group->count; i++) {
            int32_t face = list->face[i];
            if (s->face[face].body != s->node[group->node].body ||
                !overlaps_at_rest(s, group->node, face))
                continue;
            pair[count][0] = group->node;
            pair[count++][1] = face;
        }
    }
    status = lar_contact_surface_keep_apart(s, (const int32_t(*)[2])pair, count, error);
    free(pair);
    return status;
}

lar_status lar_contact_tree_create(const lar_model *model, const double *mass, const int32_t *local,
                                   lar_contact_tree *tree, lar_error *error) {
    lar_contact_search search;
    *tree = (lar_contact_tree){0};
    lar_status status = lar_contact_surface_create(model, mass, local, &tree->surface, error);
    if (status || tree->surface.node_count == 0) return status;
    status = build_tree(tree, error);
    if (!status) status = lar_contact_search_create(tree, &search, error);
    if (!status) {
        status = keep_shape(model, &search, &tree->surface, error);
        lar_contact_search_clear(&search);
    }
    if (status) lar_contact_tree_clear(tree);
    return status;
}

void lar_contact_tree_clear(lar_contact_tree *tree) {
    lar_contact_surface_clear(&tree->surface);
    free(tree->patch);
    free(tree->order);
    free(tree->place);
    *tree = (lar_contact_tree){0};
}

lar_status lar_contact_search_create(const lar_contact_tree *tree, lar_contact_search *search,
                                     lar_error *error) {
    size_t faces = (size_t)tree->surface.face_count, patches = (size_t)tree->patch_count;
    *search = (lar_contact_search){.tree = tree,
                                   .patch_box = lar_calloc(patches, sizeof *search->patch_box),
                                   .face_box = lar_calloc(faces, sizeof *search->face_box),
                                   .apart = lar_calloc(faces, sizeof *search->apart)};
    bool fits = search->patch_box && search->face_box && search->apart;
    lar_status status =
        fits ? LAR_OK : lar_fail_memory(error, 100 * faces, "the boxes of surfaces");
    if (!status) status = allocate_list(&tree->surface, &search->list, error);
    if (!status) status = allocate_list(&tree->surface, &search->next, error);
    if (status) lar_contact_search_clear(search);
    return status;
}

void lar_contact_search_clear(lar_contact_search *search) {
    free(search->patch_box);
    free(search->face_box);
    free(search->apart);
    free(search->list.group);
    free(search->list.face);
    free(search->next.group);
    free(search->next.face);
    *search = (lar_contact_search){0};
}
