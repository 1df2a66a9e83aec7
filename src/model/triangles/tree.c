/* Built top down: the triangles of a box are sorted into bins along its longest side and cut where
 * the expected number of visits is least (Wald 2007, "On fast construction of SAH-based bounding
 * volume hierarchies"). Nodes lie in preorder: the first child of a node is the next one.
 *
 * Asked by descending into the nearer box first and passing over boxes beyond the nearest point so
 * far. */
#include "model/triangles/tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"

/* From DEEP on nodes are halved by number, so that no path is longer than DEEP + 31. */
enum { LEAF = 4, BINS = 16, DEEP = 32, STACK = 64 };

typedef struct box {
    double lower[3], upper[3];
} box;

/* A box rounded outwards: it holds all, and is half as large. */
typedef struct small_box {
    float lower[3], upper[3];
} small_box;

/* Two numbers side by side, as all processors compute with them. */
typedef double two __attribute__((vector_size(16)));
typedef int64_t two_integers __attribute__((vector_size(16)));
typedef float two_small __attribute__((vector_size(8)));

/* Children's boxes stand in their parent, side by side, so that one look into memory finds both. */
typedef struct tree_node {
    two_small lower[3], upper[3];
    int32_t next;  /* leaf: the first of its triangles; otherwise the second child */
    int32_t count; /* leaf: triangles; otherwise 0 */
} tree_node;

/* A triangle with its corners in the order of their numbers: triangles with a common edge find the
 * same bits on it, and are equally near. */
typedef struct leaf_triangle {
    double at[3][3];
    int32_t triangle;
    uint8_t corner[3]; /* which of the triangle's it is */
} leaf_triangle;

struct lar_triangle_tree {
    leaf_triangle *leaf; /* those of a leaf side by side, ascending */
    small_box *leaf_box; /* around each */
    tree_node *node;
    small_box box;      /* around all */
    int32_t node_count; /* 0: no triangles */
};

/* ---- building ----------------------------------------------------------------------------- */

/* As the processor's own instructions do; fmin must also look for NaN. */
static double smaller(double a, double b) {
    return a < b ? a : b;
}

static double larger(double a, double b) {
    return a > b ? a : b;
}

static const box nothing = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void widen(box *around, const box *more) {
    for (int i = 0; i < 3; i++) {
        around->lower[i] = smaller(around->lower[i], more->lower[i]);
        around->upper[i] = larger(around->upper[i], more->upper[i]);
    }
}

static box box_around(const double a[3], const double b[3], const double c[3]) {
    box around;
    for (int i = 0; i < 3; i++) {
        around.lower[i] = smaller(smaller(a[i], b[i]), c[i]);
        around.upper[i] = larger(larger(a[i], b[i]), c[i]);
    }
    return around;
}

static small_box small_box_of(const box *around) {
    small_box made;
    for (int i = 0; i < 3; i++) {
        made.lower[i] = nextafterf((float)around->lower[i], -INFINITY);
        made.upper[i] = nextafterf((float)around->upper[i], INFINITY);
    }
    return made;
}

static box box_of(const lar_triangles *surface, int32_t triangle) {
    const int32_t *corner = surface->corner[triangle];
    return box_around(surface->vertex[corner[0]], surface->vertex[corner[1]],
                      surface->vertex[corner[2]]);
}

static double centre(const box *around, int axis) {
    return 0.5 * (around->lower[axis] + around->upper[axis]);
}

/* Half of the surface, which is proportional to the chance that a line meets the box. */
static double half_area(const box *around) {
    double side[3];
    lar_minus(around->upper, around->lower, side);
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

typedef struct builder {
    lar_triangle_tree *tree;
    box *box;      /* by position in the list that was asked for */
    int32_t *item; /* such positions, being sorted; then triangles */
} builder;

typedef struct bin {
    box box;
    int32_t count;
} bin;

/* The bin of an item along `axis`, where all centres lie in from..from + BINS / scale. */
static int bin_of(const builder *b, int32_t item, int axis, double from, double scale) {
    int at = (int)((centre(&b->box[item], axis) - from) * scale);
    return at < 0 ? 0 : at >= BINS ? BINS - 1 : at;
}

/* The number of bins that go to the first child; the cost of a child is its area times its
 * triangles. */
static int cheapest_cut(const bin *bins) {
    double behind[BINS];
    box around = nothing;
    int32_t count = 0;
    for (int i = BINS - 1; i > 0; i--) {
        widen(&around, &bins[i].box);
        count += bins[i].count;
        behind[i] = count > 0 ? half_area(&around) * count : 0;
    }
    around = nothing;
    count = 0;
    int best = 1;
    double min = INFINITY;
    for (int i = 1; i < BINS; i++) {
        widen(&around, &bins[i - 1].box);
        count += bins[i - 1].count;
        double cost = (count > 0 ? half_area(&around) * count : 0) + behind[i];
        if (cost < min) {
            min = cost;
            best = i;
        }
    }
    return best;
}

/* Sorts the items first..first + count into two; the number of the first part. */
static int32_t divide(builder *b, int32_t first, int32_t count, int depth) {
    double from[3] = {INFINITY, INFINITY, INFINITY}, to[3] = {-INFINITY, -INFINITY, -INFINITY};
    int32_t *item = b->item + first;
    for (int32_t k = 0; k < count; k++)
        for (int i = 0; i < 3; i++) {
            double at = centre(&b->box[item[k]], i);
            from[i] = smaller(from[i], at);
            to[i] = larger(to[i], at);
        }
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (to[i] - from[i] > to[axis] - from[axis]) axis = i;
    double scale = BINS / (to[axis] - from[axis]);
    if (depth >= DEEP || !isfinite(scale)) return count / 2;

    bin bins[BINS];
    for (int i = 0; i < BINS; i++) bins[i] = (bin){nothing, 0};
    for (int32_t k = 0; k < count; k++) {
        bin *into = &bins[bin_of(b, item[k], axis, from[axis], scale)];
        widen(&into->box, &b->box[item[k]]);
        into->count++;
    }
    int cut = cheapest_cut(bins);
    int32_t part = 0;
    for (int32_t k = 0; k < count; k++) {
        int32_t moved = item[k];
        if (bin_of(b, moved, axis, from[axis], scale) >= cut) continue;
        item[k] = item[part];
        item[part++] = moved;
    }
    return part > 0 && part < count ? part : count / 2;
}

static int ascending(const void *a, const void *b) {
    int32_t i = *(const int32_t *)a, k = *(const int32_t *)b;
    return (i > k) - (i < k);
}

static void place_child(tree_node *node, int child, const small_box *around) {
    for (int i = 0; i < 3; i++) {
        node->lower[i][child] = around->lower[i];
        node->upper[i][child] = around->upper[i];
    }
}

/* The box around what was built. */
static small_box build(builder *b, int32_t first, int32_t count, int depth) {
    lar_triangle_tree *tree = b->tree;
    tree_node *node = &tree->node[tree->node_count++];
    box around = nothing;
    for (int32_t k = 0; k < count; k++) widen(&around, &b->box[b->item[first + k]]);
    if (count <= LEAF) {
        node->next = first;
        node->count = count;
        return small_box_of(&around);
    }
    const int32_t part = divide(b, first, count, depth);
    small_box child = build(b, first, part, depth + 1);
    place_child(node, 0, &child);
    node->next = tree->node_count;
    child = build(b, first + part, count - part, depth + 1);
    place_child(node, 1, &child);
    return small_box_of(&around);
}

/* Items become triangles. */
static void name_triangles(builder *b, const int32_t *index, int32_t count) {
    const lar_triangle_tree *tree = b->tree;
    if (index)
        for (int32_t k = 0; k < count; k++) b->item[k] = index[b->item[k]];
    for (int32_t n = 0; n < tree->node_count; n++)
        if (tree->node[n].count > 0)
            qsort(b->item + tree->node[n].next, (size_t)tree->node[n].count, sizeof *b->item,
                  ascending);
}

static small_box leaf_box_of(const leaf_triangle *leaf) {
    const box around = box_around(leaf->at[0], leaf->at[1], leaf->at[2]);
    return small_box_of(&around);
}

static leaf_triangle leaf_of(const lar_triangles *surface, int32_t triangle) {
    const int32_t *corner = surface->corner[triangle];
    leaf_triangle leaf = {.triangle = triangle, .corner = {0, 1, 2}};
    for (int i = 0; i < 2; i++)
        for (int k = i + 1; k < 3; k++)
            if (corner[leaf.corner[k]] < corner[leaf.corner[i]]) {
                uint8_t swapped = leaf.corner[i];
                leaf.corner[i] = leaf.corner[k];
                leaf.corner[k] = swapped;
            }
    for (int a = 0; a < 3; a++)
        memcpy(leaf.at[a], surface->vertex[corner[leaf.corner[a]]], sizeof leaf.at[a]);
    return leaf;
}

static bool allocate(builder *b, size_t triangles) {
    lar_triangle_tree *tree = b->tree = lar_calloc(1, sizeof *tree);
    if (!tree) return false;
    tree->leaf = lar_calloc(triangles, sizeof *tree->leaf);
    tree->leaf_box = lar_calloc(triangles, sizeof *tree->leaf_box);
    tree->node = lar_calloc(2 * triangles, sizeof *tree->node);
    b->box = lar_calloc(triangles, sizeof *b->box);
    b->item = lar_calloc(triangles, sizeof *b->item);
    return tree->leaf && tree->leaf_box && tree->node && b->box && b->item;
}

lar_status lar_triangle_tree_create(const lar_triangles *triangles, const int32_t *index,
                                    int32_t count, lar_triangle_tree **tree, lar_error *error) {
    if (!index) count = triangles->triangle_count;
    builder b = {0};
    const bool ready = allocate(&b, (size_t)count);
    for (int32_t k = 0; ready && k < count; k++) {
        b.box[k] = box_of(triangles, index ? index[k] : k);
        b.item[k] = k;
    }
    if (ready && count > 0) b.tree->box = build(&b, 0, count, 0);
    if (ready) name_triangles(&b, index, count);
    for (int32_t k = 0; ready && k < count; k++) {
        b.tree->leaf[k] = leaf_of(triangles, b.item[k]);
        b.tree->leaf_box[k] = leaf_box_of(&b.tree->leaf[k]);
    }
    free(b.box);
    free(b.item);
    if (!ready) {
        lar_triangle_tree_destroy(b.tree);
        return lar_fail_memory(error, (size_t)count * (sizeof *b.box + 2 * sizeof *b.tree->node),
                               "the tree of triangles");
    }
    const size_t nodes = (size_t)b.tree->node_count;
    tree_node *fitted = realloc(b.tree->node, (nodes + 1) * sizeof *fitted);
    if (fitted) b.tree->node = fitted;
    *tree = b.tree;
    return LAR_OK;
}

void lar_triangle_tree_destroy(lar_triangle_tree *tree) {
    if (!tree) return;
    free(tree->leaf);
    free(tree->leaf_box);
    free(tree->node);
    free(tree);
}

/* ---- the nearest point -------------------------------------------------------------------- */

static double square(const double a[3]) {
    return lar_dot(a, a);
}

/* Nearest point of the edge from `from` to `to`: a number 0..1 and the squared distance. */
static double nearest_on_edge(const double p[3], const double from[3], const double to[3],
                              double *along, double at[3]) {
    double edge[3], away[3];
    lar_minus(to, from, edge);
    lar_minus(p, from, away);
    double long2 = square(edge), t = lar_dot(away, edge);
    t = long2 > 0 ? smaller(larger(t / long2, 0), 1) : 0;
    for (int i = 0; i < 3; i++) at[i] = t == 1 ? to[i] : from[i] + t * edge[i];
    *along = t;
    lar_minus(p, at, away);
    return square(away);
}

/* The foot of the perpendicular, when it lies inside the triangle and that has an area. The areas
 * of the parts are taken from cross products: they stay good in slivers. */
static bool perpendicular(const double p[3], const double c[3][3], double weight[3], double at[3]) {
    const double flat = 1e-24; /* of the squared product of two edges */
    double e[3], f[3], away[3], normal[3], turned[3];
    lar_minus(c[1], c[0], e);
    lar_minus(c[2], c[0], f);
    lar_minus(p, c[0], away);
    lar_cross(e, f, normal);
    double area2 = square(normal);
    if (!(area2 > flat * square(e) * square(f))) return false;
    lar_cross(away, f, turned);
    weight[1] = lar_dot(turned, normal) / area2;
    lar_cross(e, away, turned);
    weight[2] = lar_dot(turned, normal) / area2;
    weight[0] = 1 - weight[1] - weight[2];
    if (!(weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0)) return false;
    for (int i = 0; i < 3; i++) at[i] = c[0][i] + weight[1] * e[i] + weight[2] * f[i];
    return true;
}

/* Fills `nearest` (distance: its square) for one triangle. */
static void nearest_on_triangle(const leaf_triangle *leaf, const double p[3],
                                lar_nearest *nearest) {
    const uint8_t *rank = leaf->corner;
    nearest->triangle = leaf->triangle;
    double weight[3], away[3];
    if (perpendicular(p, leaf->at, weight, nearest->point)) {
        for (int a = 0; a < 3; a++) nearest->weight[rank[a]] = weight[a];
        lar_minus(p, nearest->point, away);
        nearest->distance = square(away);
        return;
    }
    nearest->distance = INFINITY;
    for (int edge = 0; edge < 3; edge++) {
        int from = edge == 2 ? 1 : 0, to = edge == 0 ? 1 : 2; /* 01, 02, 12 */
        double along, at[3];
        double distance = nearest_on_edge(p, leaf->at[from], leaf->at[to], &along, at);
        if (!(distance < nearest->distance)) continue;
        nearest->distance = distance;
        memcpy(nearest->point, at, sizeof at);
        nearest->weight[rank[3 - from - to]] = 0;
        nearest->weight[rank[from]] = 1 - along;
        nearest->weight[rank[to]] = along;
    }
}

/* How far p lies beyond one of two ends. Without a branch, which would go one way as often as the
 * other: of x and 0 the larger one is (x + |x|) / 2, exactly. */
static inline double beyond(double lower, double upper, double p) {
    const double below = lower - p, above = p - upper;
    return 0.5 * ((below + fabs(below)) + (above + fabs(above)));
}

static inline double box_distance(const small_box *around, const double p[3]) {
    double away[3];
    for (int i = 0; i < 3; i++) away[i] = beyond(around->lower[i], around->upper[i], p[i]);
    return square(away);
}

/* Of both children. */
static inline two boxes_distance(const tree_node *node, const double p[3]) {
    const two_integers sign = {INT64_MIN, INT64_MIN};
    two sum = {0};
    for (int i = 0; i < 3; i++) {
        const two below = __builtin_convertvector(node->lower[i], two) - p[i];
        const two above = p[i] - __builtin_convertvector(node->upper[i], two);
        const two away = 0.5 * ((below + (two)((two_integers)below & ~sign)) +
                                (above + (two)((two_integers)above & ~sign)));
        sum += away * away;
    }
    return sum;
}

/* Distances to a triangle are rounded otherwise than those to its box. */
static const double SLACK = 1 + 1e-12;

typedef struct waiting {
    int32_t node;
    double distance; /* squared, from the point to the node's box */
} waiting;

/* Goes on until `best` is nearest, or with `any` until something is as near as that asks. */
static void look_into_leaf(const lar_triangle_tree *tree, const tree_node *leaf, const double p[3],
                           bool any, lar_nearest *best) {
    for (int32_t k = 0; k < leaf->count && !(any && best->triangle >= 0); k++) {
        lar_nearest candidate;
        /* Cheaper than the distance to the triangle itself, and mostly enough. */
        if (box_distance(&tree->leaf_box[leaf->next + k], p) > best->distance * SLACK) continue;
        nearest_on_triangle(&tree->leaf[leaf->next + k], p, &candidate);
        if (candidate.distance < best->distance ||
            (candidate.distance == best->distance &&
             (best->triangle < 0 || candidate.triangle < best->triangle)))
            *best = candidate;
    }
}

/* The nearest triangle, or the first that is found within reach; best.triangle < 0: none is. */
static lar_nearest descend(const lar_triangle_tree *tree, const double point[3], double reach,
                           bool any) {
    lar_nearest best = {.triangle = -1, .distance = reach * reach};
    waiting stack[STACK];
    int height = 0;
    if (tree->node_count > 0 && reach >= 0)
        stack[height++] = (waiting){0, box_distance(&tree->box, point)};
    while (height > 0 && !(any && best.triangle >= 0)) {
        waiting next = stack[--height];
        while (!(next.distance > best.distance * SLACK)) { /* of no number as well: who knows */
            const tree_node *node = &tree->node[next.node];
            if (node->count > 0) {
                look_into_leaf(tree, node, point, any, &best);
                break;
            }
            const two distance = boxes_distance(node, point);
            waiting near = {next.node + 1, distance[0]}, far = {node->next, distance[1]};
            if (far.distance < near.distance) {
                waiting swapped = near;
                near = far;
                far = swapped;
            }
            if (!(far.distance > best.distance * SLACK)) stack[height++] = far;
            next = near;
        }
    }
    return best;
}

bool lar_triangle_tree_nearest(const lar_triangle_tree *tree, const double point[3], double reach,
                               lar_nearest *nearest) {
    lar_nearest best = descend(tree, point, reach, false);
    if (best.triangle < 0) return false;
    best.distance = sqrt(best.distance);
    *nearest = best;
    return true;
}

bool lar_triangle_tree_is_near(const lar_triangle_tree *tree, const double point[3], double reach) {
    return descend(tree, point, reach, true).triangle >= 0;
}

/* ---- boxes -------------------------------------------------------------------------------- */

static bool child_meets(const tree_node *node, int child, const double lower[3],
                        const double upper[3]) {
    for (int i = 0; i < 3; i++)
        if (node->upper[i][child] < lower[i] || node->lower[i][child] > upper[i]) return false;
    return true;
}

static bool meets(const lar_triangle_tree *tree, int32_t k, const double lower[3],
                  const double upper[3]) {
    const small_box *rough = &tree->leaf_box[k];
    for (int i = 0; i < 3; i++)
        if (rough->upper[i] < lower[i] || rough->lower[i] > upper[i]) return false;
    const double(*at)[3] = (const double(*)[3])tree->leaf[k].at;
    const box around = box_around(at[0], at[1], at[2]);
    for (int i = 0; i < 3; i++)
        if (around.upper[i] < lower[i] || around.lower[i] > upper[i]) return false;
    return true;
}

void lar_triangle_tree_boxes(const lar_triangle_tree *tree, const double lower[3],
                             const double upper[3], double margin, lar_triangle_visit *visit,
                             void *context) {
    double from[3], to[3];
    for (int i = 0; i < 3; i++) {
        from[i] = lower[i] - margin;
        to[i] = upper[i] + margin;
    }
    int32_t stack[STACK];
    int height = 0;
    if (tree->node_count > 0) stack[height++] = 0;
    while (height > 0) {
        int32_t at = stack[--height];
        const tree_node *node = &tree->node[at];
        if (node->count == 0) {
            if (child_meets(node, 1, from, to)) stack[height++] = node->next;
            if (child_meets(node, 0, from, to)) stack[height++] = at + 1;
            continue;
        }
        for (int32_t k = node->next; k < node->next + node->count; k++)
            if (meets(tree, k, from, to) && !visit(context, tree->leaf[k].triangle)) return;
    }
}

/* ---- lines -------------------------------------------------------------------------------- */

/* Where a line comes into a child's box; INFINITY: not within `reach`. */
static double line_enters(const tree_node *node, int child, const double origin[3],
                          const double direction[3], double reach) {
    double from = 0, to = reach;
    for (int i = 0; i < 3; i++) {
        const double below = node->lower[i][child] - origin[i],
                     above = node->upper[i][child] - origin[i];
        if (direction[i] == 0) {
            if (below > 0 || above < 0) return INFINITY;
            continue;
        }
        const double one = below / direction[i], other = above / direction[i];
        from = larger(from, smaller(one, other));
        to = smaller(to, larger(one, other));
    }
    return from > to * SLACK ? INFINITY : from;
}

void lar_triangle_tree_line(const lar_triangle_tree *tree, const double origin[3],
                            const double direction[3], const double *reach,
                            lar_triangle_visit *visit, void *context) {
    waiting stack[STACK];
    int height = 0;
    if (tree->node_count > 0) stack[height++] = (waiting){0, 0};
    while (height > 0) {
        const waiting next = stack[--height];
        const tree_node *node = &tree->node[next.node];
        if (next.distance > *reach * SLACK) continue;
        for (int32_t k = 0; k < node->count; k++)
            if (!visit(context, tree->leaf[node->next + k].triangle)) return;
        if (node->count > 0) continue;
        waiting near = {next.node + 1, line_enters(node, 0, origin, direction, *reach)};
        waiting far = {node->next, line_enters(node, 1, origin, direction, *reach)};
        if (far.distance < near.distance) {
            waiting swapped = near;
            near = far;
            far = swapped;
        }
        if (far.distance < INFINITY) stack[height++] = far;
        if (near.distance < INFINITY) stack[height++] = near;
    }
}
