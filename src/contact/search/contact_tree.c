/* The tree over the faces, and what is asked before anything moves: whether bodies lie in each
 * other, and what is near by shape alone. */
#include "contact/contact_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "contact/history/flush.h"
#include "mechanics/face_contact.h"
#include "model/contact_check.h"

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

static int32_t fork_of(lar_contact_tree *tree, int32_t first, int32_t count,
                       const double (*middle)[3]);

/* The branches of some faces, as halves of halves where these are too many for one fork; its depth
 * is that of a balanced tree. */
static int32_t add_branches(lar_contact_tree *tree, int32_t fork, int32_t used, int32_t first,
                            int32_t count, int halvings, const double (*middle)[3]) {
    int32_t *order = tree->order + first;
    if (halvings == 0 || (halvings == 1 && count <= LAR_FORK)) {
        int32_t below = fork_of(tree, first, count, middle);
        tree->fork[fork].branch[used] = below;
        return used + 1;
    }
    halve(order, count, middle, widest_axis(order, count, middle));
    used = add_branches(tree, fork, used, first, count / 2, halvings - 1, middle);
    return add_branches(tree, fork, used, first + count / 2, count - count / 2, halvings - 1,
                        middle);
}

static int32_t fork_of(lar_contact_tree *tree, int32_t first, int32_t count,
                       const double (*middle)[3]) {
    int32_t own = tree->fork_count++, used = count;
    if (count <= LAR_FORK)
        for (int32_t k = 0; k < count; k++) tree->fork[own].branch[k] = ~(first + k);
    else
        used = add_branches(tree, own, 0, first, count, 2, middle);
    for (int32_t k = used; k < LAR_FORK; k++) tree->fork[own].branch[k] = tree->fork[own].branch[0];
    return own;
}

static lar_status build_tree(lar_contact_tree *tree, lar_error *error) {
    const lar_contact_surface *s = &tree->surface;
    size_t faces = (size_t)s->face_count;
    double(*middle)[3] = lar_calloc(faces, sizeof *middle);
    tree->order = lar_calloc(faces, sizeof *tree->order);
    tree->fork = lar_calloc(faces + 1, sizeof *tree->fork);
    tree->place = lar_calloc(faces, sizeof *tree->place);
    bool fits = middle && tree->order && tree->fork && tree->place;
    for (int32_t f = 0; f < s->face_count && fits; f++) {
        tree->order[f] = f;
        for (int a = 0; a < 4; a++)
            for (int i = 0; i < 3; i++) middle[f][i] += 0.25 * s->rest[s->face[f].corner[a]][i];
    }
    if (fits) fork_of(tree, 0, s->face_count, (const double(*)[3])middle);
    for (int32_t i = 0; i < s->face_count && fits; i++) tree->place[tree->order[i]] = i;
    free(middle);
    return fits ? LAR_OK : lar_fail_memory(error, 64 * faces, "the boxes of surfaces");
}

/* ---- at rest -------------------------------------------------------------------------------- */

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

/* Whether a face lies over one of another body, in its plane, and looks the same way: with its
 * middle, or with a corner, a little inwards, for bodies that stand side by side have corners on
 * each other's sides. How little that is counts where bodies are thin. */
static bool lies_on(const lar_contact_surface *s, int32_t face, int32_t other, double rounding) {
    static const double INWARDS = 1e-3;
    double own[4][3], corner[4][3], way[2][3], near = rounding;
    bool on = false;
    for (int a = 0; a < 4; a++) {
        memcpy(own[a], s->rest[s->face[face].corner[a]], sizeof own[a]);
        memcpy(corner[a], s->rest[s->face[other].corner[a]], sizeof corner[a]);
    }
    for (int a = 0; a < 4; a++) {
        double side[3];
        lar_minus(own[(a + 1) % 4], own[a], side);
        near = lar_lesser(near, 0.25 * INWARDS * lar_length(side));
    }
    for (int p = 0; p < 5 && !on; p++) {
        double weight[4], x[3];
        lar_face_point point;
        for (int a = 0; a < 4; a++) weight[a] = p == 4 ? 0.25 : 0.25 * INWARDS;
        if (p < 4) weight[p] += 1 - INWARDS;
        lar_face_mean((const double(*)[3])own, weight, x);
        lar_face_closest(x, (const double(*)[3])corner, LAR_FACE_TIE * s->face[other].size, &point);
        on = point.distance <= (p == 4 ? rounding : near);
    }
    lar_face_normal((const double(*)[3])own, way[0]);
    lar_face_normal((const double(*)[3])corner, way[1]);
    return on && lar_dot(way[0], way[1]) > 0;
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

/* Who begins straight before a block may be some layers away from it, as far as the list has room
 * for. */
static lar_status find_flush(const lar_model *model, lar_contact_search *search,
                             lar_contact_surface *s, lar_error *error) {
    static const double LAYERS = 8;
    const double far = s->body_count > 1 ? LAYERS * s->reach_max : 0;
    if (!lar_contact_search_run(search, (const double(*)[3])s->rest, far)) return LAR_OK;
    return lar_flush_find(s, &search->list, lar_overlap_rounding(&model->mesh), error);
}

/* Within one body that is its shape, and nothing to be pushed apart. Bodies that lie in each other
 * are refused. */
static lar_status keep_shape(const lar_model *model, lar_contact_search *search,
                             lar_contact_surface *s, lar_error *error) {
    const lar_contact_list *list = &search->list;
    s->rounding = lar_overlap_rounding(&model->mesh);
    lar_status status = find_flush(model, search, s, error);
    if (status) return status;
    if (!lar_contact_search_run(search, (const double(*)[3])s->rest, 0))
        return lar_fail(
            error, LAR_ERROR_MODEL,
            "contact: more than %d faces, or %d bodies, are near the nodes that may "
            "touch them, in the mean: bodies of one or two elements are packed closely, "
            "or surfaces overlap at many places; take fewer or larger bodies, or wider "
            "gaps",
            LAR_PAIRS_PER_NODE, LAR_PAIRS_PER_NODE / 8);
    status = refuse_overlap(model, search, error);
    if (!status) status = refuse_twice(model, search, error);
    if (!status) status = lar_contact_refuse_inside(model, s, list, error);
    if (status) return status;
    measure_clearance(s, list, lar_overlap_rounding(&model->mesh));
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

/* ---- creation ------------------------------------------------------------------------------- */

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
    free(tree->fork);
    free(tree->order);
    free(tree->place);
    *tree = (lar_contact_tree){0};
}
