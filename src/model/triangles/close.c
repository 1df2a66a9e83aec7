/* Makes the triangles of a closed surface all look outward.
 *
 *     triangles --edges of two--> patches, each turned one way by flooding
 *     patches that are not closed alone --edges of more--> shells, each closed
 *     shells --who lies in whom--> the outermost ones to the outside, the others along with them
 *     shells with the body on both sides are left out
 *
 * Where just two triangles meet at an edge they must use it in opposite directions, so one tells
 * the other how to be turned; the smaller part of a patch is turned to the larger part's side.
 * Where more than two meet (bodies that touch along an edge) nothing is told. */
#include "model/triangles/triangles.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "base/union_find.h"
#include "base/vector.h"
#include "model/triangles/tree.h"

/* One use of an edge by a triangle. */
typedef struct edge_use {
    int32_t low, high; /* vertices */
    int32_t triangle;
    bool upward; /* from low to high */
} edge_use;

typedef struct shell_box {
    double lower[3], upper[3];
} shell_box;

typedef struct closing {
    lar_triangles *triangles;
    lar_error *error;
    int64_t use_count;
    edge_use *use;   /* those of an edge side by side */
    int32_t *beside; /* [3 triangles] the triangle behind an edge of two, or -1 */
    bool *against;   /* [3 triangles] that one uses the edge in the same direction */
    bool *turned;    /* [triangles] */
    int32_t *patch;  /* [triangles] then the shell */
    int32_t *queue;  /* [triangles] */
    int32_t patch_count;
    int32_t *root;   /* [patches] of the shells, a forest */
    int64_t *sum;    /* [patches] scratch, zero between uses */
    double *volume;  /* [patches] of the shell, at its root */
    shell_box *box;  /* [patches] the same */
    int32_t *around; /* [patches] at a shell's root: the outermost shell around it, or itself */
    int64_t *within; /* [patches] the same: how often the others go around it, as they are given */
} closing;

/* ---- edges -------------------------------------------------------------------------------- */

static int by_edge(const void *a, const void *b) {
    const edge_use *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    if (p->high != q->high) return p->high < q->high ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

static void list_edges(closing *c) {
    for (int32_t t = 0; t < c->triangles->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            int32_t from = c->triangles->corner[t][k], to = c->triangles->corner[t][(k + 1) % 3];
            bool upward = from < to;
            c->use[c->use_count++] = (edge_use){upward ? from : to, upward ? to : from, t, upward};
        }
    qsort(c->use, (size_t)c->use_count, sizeof *c->use, by_edge);
}

/* Behind the last use of the edge that begins at `first`. */
static int64_t edge_end(const closing *c, int64_t first) {
    int64_t end = first + 1;
    while (end < c->use_count && c->use[end].low == c->use[first].low &&
           c->use[end].high == c->use[first].high)
        end++;
    return end;
}

/* +1 or -1: the direction in which a use goes along its edge, after turning. */
static int direction(const closing *c, const edge_use *use) {
    return use->upward != c->turned[use->triangle] ? 1 : -1;
}

static void add_neighbour(closing *c, const edge_use *use, const edge_use *other) {
    int64_t slot = 3 * (int64_t)use->triangle;
    while (c->beside[slot] >= 0) slot++;
    c->beside[slot] = other->triangle;
    c->against[slot] = use->upward == other->upward;
}

static void list_neighbours(closing *c) {
    for (int64_t i = 0; i < 3 * (int64_t)c->triangles->triangle_count; i++) c->beside[i] = -1;
    for (int64_t first = 0, end; first < c->use_count; first = end) {
        end = edge_end(c, first);
        if (end - first != 2) continue;
        add_neighbour(c, &c->use[first], &c->use[first + 1]);
        add_neighbour(c, &c->use[first + 1], &c->use[first]);
    }
}

/* ---- patches ------------------------------------------------------------------------------ */

/* All triangles that hang together with `seed` by edges of two. */
static void flood(closing *c, int32_t seed) {
    int32_t head = 0, tail = 0, turned = 0, name = c->patch_count++;
    c->patch[seed] = name;
    c->queue[tail++] = seed;
    while (head < tail) {
        int32_t t = c->queue[head++];
        turned += c->turned[t];
        for (int64_t slot = 3 * (int64_t)t; slot < 3 * (int64_t)t + 3; slot++) {
            int32_t next = c->beside[slot];
            if (next < 0 || c->patch[next] >= 0) continue;
            c->patch[next] = name;
            c->turned[next] = c->turned[t] != c->against[slot];
            c->queue[tail++] = next;
        }
    }
    if (turned > tail - turned)
        for (int32_t k = 0; k < tail; k++) c->turned[c->queue[k]] = !c->turned[c->queue[k]];
}

static lar_status check_edges(const closing *c) {
    int64_t open = 0, one_sided = 0, bad = -1;
    for (int64_t first = 0, end; first < c->use_count; first = end) {
        int sum = 0;
        end = edge_end(c, first);
        for (int64_t i = first; i < end; i++) sum += direction(c, &c->use[i]);
        if (sum == 0) continue;
        if (bad < 0) bad = first;
        open += (end - first) % 2;
        one_sided += (end - first) % 2 == 0;
    }
    if (bad < 0) return LAR_OK;
    double place[3];
    for (int i = 0; i < 3; i++)
        place[i] = 0.5 * (c->triangles->vertex[c->use[bad].low][i] +
                          c->triangles->vertex[c->use[bad].high][i]);
    const char *source = c->triangles->source ? c->triangles->source : "surface";
    if (open > 0)
        return lar_fail(c->error, LAR_ERROR_MODEL,
                        "%s: the surface is not closed: %" PRId64
                        " open edge%s, one at (%.6g, %.6g, %.6g) m; close the holes in a mesh "
                        "editor (MeshLab: Merge Close Vertices, Close Holes; Blender: Merge by "
                        "Distance, Fill Holes) and remove inner walls",
                        source, open, open == 1 ? "" : "s", place[0], place[1], place[2]);
    return lar_fail(c->error, LAR_ERROR_MODEL,
                    "%s: the surface has no inside: its sides meet twisted at %" PRId64
                    " edge%s, one at (%.6g, %.6g, %.6g) m; remake it in a mesh editor (Blender: "
                    "remesh modifier)",
                    source, one_sided, one_sided == 1 ? "" : "s", place[0], place[1], place[2]);
}

/* ---- shells ------------------------------------------------------------------------------- */

/* Patches that are open at an edge of more than two belong to one shell with the others there. */
static void join_patches(closing *c) {
    lar_union_start(c->root, c->patch_count);
    for (int64_t first = 0, end; first < c->use_count; first = end) {
        end = edge_end(c, first);
        if (end - first == 2) continue;
        for (int64_t i = first; i < end; i++)
            c->sum[c->patch[c->use[i].triangle]] += direction(c, &c->use[i]);
        int32_t joined = -1;
        for (int64_t i = first; i < end; i++) {
            int32_t patch = c->patch[c->use[i].triangle];
            if (c->sum[patch] == 0) continue;
            if (joined >= 0) lar_union_join(c->root, patch, joined);
            joined = patch;
        }
        for (int64_t i = first; i < end; i++) c->sum[c->patch[c->use[i].triangle]] = 0;
    }
    for (int32_t t = 0; t < c->triangles->triangle_count; t++)
        c->patch[t] = lar_union_root(c->root, c->patch[t]);
}

static void measure_shells(closing *c) {
    const lar_triangles *all = c->triangles;
    for (int32_t p = 0; p < c->patch_count; p++)
        for (int i = 0; i < 3; i++) {
            c->box[p].lower[i] = INFINITY;
            c->box[p].upper[i] = -INFINITY;
        }
    for (int32_t t = 0; t < all->triangle_count; t++) {
        double corner[3][3], turned[3];
        shell_box *box = &c->box[c->patch[t]];
        for (int a = 0; a < 3; a++) {
            const double *at = all->vertex[all->corner[t][a]];
            lar_minus(at, all->vertex[0], corner[a]);
            for (int i = 0; i < 3; i++) {
                box->lower[i] = fmin(box->lower[i], at[i]);
                box->upper[i] = fmax(box->upper[i], at[i]);
            }
        }
        lar_cross(corner[1], corner[2], turned);
        c->volume[c->patch[t]] += (c->turned[t] ? -1 : 1) * lar_dot(corner[0], turned) / 6;
    }
}

/* ---- who lies in whom --------------------------------------------------------------------- */

typedef struct ray {
    closing *closing;
    double from[3]; /* it runs towards +x */
    int32_t own;    /* shell that is not counted */
    int32_t *met;   /* [patches] shells with a crossing */
    int32_t met_count;
    bool *seen; /* [patches] of them, false between uses */
} ray;

/* On which side of an edge the ray passes: the sign of the area that it spans with the edge, seen
 * along the ray. Computed from the lower vertex to the higher, so that both triangles of an edge
 * find the same bits. Where it is 0 the ray is thought of as moved by a whiff in y and by a whiff
 * of that in z (Edelsbrunner, Muecke 1990). */
static int side_of(const ray *r, int32_t a, int32_t b, double *area) {
    bool swap = a > b;
    const double *p = r->closing->triangles->vertex[swap ? b : a];
    const double *q = r->closing->triangles->vertex[swap ? a : b];
    double spanned =
        (p[1] - r->from[1]) * (q[2] - r->from[2]) - (p[2] - r->from[2]) * (q[1] - r->from[1]);
    *area = swap ? -spanned : spanned;
    if (spanned == 0) spanned = p[2] != q[2] ? p[2] - q[2] : q[1] - p[1];
    int sign = (spanned > 0) - (spanned < 0);
    return swap ? -sign : sign;
}

/* Adds the crossing of the ray with a triangle to the sum of its shell. */
static bool cross(void *context, int32_t triangle) {
    ray *r = context;
    closing *c = r->closing;
    int32_t shell = c->patch[triangle];
    if (shell == r->own) return true;
    const int32_t *corner = c->triangles->corner[triangle];
    double area[3];
    int sides = 0;
    for (int k = 0; k < 3; k++)
        sides += side_of(r, corner[(k + 1) % 3], corner[(k + 2) % 3], &area[k]);
    double whole = area[0] + area[1] + area[2], x = 0;
    if (abs(sides) != 3 || whole == 0) return true;
    for (int k = 0; k < 3; k++) x += area[k] / whole * c->triangles->vertex[corner[k]][0];
    if (x < r->from[0]) return true;
    if (!r->seen[shell]) r->met[r->met_count++] = shell;
    r->seen[shell] = true;
    c->sum[shell] += (sides > 0) != c->turned[triangle] ? 1 : -1;
    return true;
}

/* The largest shell around a triangle: the outermost one, as shells do not cross; and how often it
 * is gone around. Bodies that only touch do not lie in each other's boxes. */
static int32_t outermost(ray *r, const lar_triangle_tree *tree, int32_t triangle) {
    closing *c = r->closing;
    r->own = c->patch[triangle];
    r->met_count = 0;
    for (int i = 0; i < 3; i++) {
        r->from[i] = 0;
        for (int a = 0; a < 3; a++)
            r->from[i] += c->triangles->vertex[c->triangles->corner[triangle][a]][i] / 3;
    }
    const double far[3] = {INFINITY, r->from[1], r->from[2]};
    lar_triangle_tree_boxes(tree, r->from, far, 0, cross, r);
    int32_t around = r->own;
    for (int32_t k = 0; k < r->met_count; k++) {
        int32_t shell = r->met[k];
        bool inside = c->sum[shell] != 0;
        for (int i = 0; i < 3; i++)
            inside = inside && c->box[shell].lower[i] < c->box[r->own].lower[i] &&
                     c->box[shell].upper[i] > c->box[r->own].upper[i];
        if (inside) c->within[r->own] += c->sum[shell];
        if (inside && fabs(c->volume[shell]) > fabs(c->volume[around])) around = shell;
        c->sum[shell] = 0;
        r->seen[shell] = false;
    }
    return around;
}

static lar_status nest_shells(closing *c) {
    int32_t shells = 0;
    for (int32_t p = 0; p < c->patch_count; p++) {
        shells += c->root[p] == p;
        c->around[p] = -1;
    }
    if (shells < 2) {
        for (int32_t p = 0; p < c->patch_count; p++) c->around[p] = p;
        return LAR_OK;
    }
    lar_triangle_tree *tree = NULL;
    ray r = {.closing = c};
    lar_status status = lar_triangle_tree_create(c->triangles, NULL, 0, &tree, c->error);
    r.met = lar_calloc((size_t)c->patch_count, sizeof *r.met);
    r.seen = lar_calloc((size_t)c->patch_count, sizeof *r.seen);
    if (!status && (!r.met || !r.seen))
        status = lar_fail_memory(c->error, (size_t)c->patch_count * 5, "the shells of a surface");
    for (int32_t t = 0; t < c->triangles->triangle_count && !status; t++)
        if (c->around[c->patch[t]] < 0) c->around[c->patch[t]] = outermost(&r, tree, t);
    free(r.met);
    free(r.seen);
    lar_triangle_tree_destroy(tree);
    return status;
}

/* ---- all of it ---------------------------------------------------------------------------- */

static lar_status allocate(closing *c) {
    size_t n = (size_t)c->triangles->triangle_count;
    c->use = lar_calloc(3 * n, sizeof *c->use);
    c->beside = lar_calloc(3 * n, sizeof *c->beside);
    c->against = lar_calloc(3 * n, sizeof *c->against);
    c->turned = lar_calloc(n, sizeof *c->turned);
    c->patch = lar_calloc(n, sizeof *c->patch);
    c->queue = lar_calloc(n, sizeof *c->queue);
    if (c->use && c->beside && c->against && c->turned && c->patch && c->queue) return LAR_OK;
    return lar_fail_memory(c->error, n * 80, "the edges of a surface");
}

static lar_status allocate_patches(closing *c) {
    size_t n = (size_t)c->patch_count;
    c->root = lar_calloc(n, sizeof *c->root);
    c->sum = lar_calloc(n, sizeof *c->sum);
    c->volume = lar_calloc(n, sizeof *c->volume);
    c->box = lar_calloc(n, sizeof *c->box);
    c->around = lar_calloc(n, sizeof *c->around);
    c->within = lar_calloc(n, sizeof *c->within);
    if (c->root && c->sum && c->volume && c->box && c->around && c->within) return LAR_OK;
    return lar_fail_memory(c->error, n * 80, "the shells of a surface");
}

static int32_t turn_triangles(closing *c) {
    int32_t turned = 0;
    for (int32_t t = 0; t < c->triangles->triangle_count; t++) {
        bool outward = c->volume[c->around[c->patch[t]]] >= 0;
        if (c->turned[t] == outward) {
            int32_t *corner = c->triangles->corner[t], swapped = corner[1];
            corner[1] = corner[2];
            corner[2] = swapped;
            turned++;
        }
    }
    return turned;
}

/* Whether a shell parts inside from outside, once all are turned: inside is where the surface goes
 * around at least once. One in another that looks the same way has the body on both of its sides.
 */
static bool is_boundary(const closing *c, int32_t shell) {
    int sign = c->volume[c->around[shell]] >= 0 ? 1 : -1;
    int64_t before = sign * c->within[shell];
    int64_t behind = before + (sign * c->volume[shell] >= 0 ? 1 : -1);
    return c->around[shell] == shell || (before > 0) != (behind > 0);
}

static void leave_out(closing *c) {
    lar_triangles *all = c->triangles;
    int32_t kept = 0;
    for (int32_t t = 0; t < all->triangle_count; t++) {
        if (!is_boundary(c, c->patch[t])) continue;
        for (int a = 0; a < 3; a++) all->corner[kept][a] = all->corner[t][a];
        if (all->tag) all->tag[kept] = all->tag[t];
        kept++;
    }
    all->triangle_count = kept;
}

lar_status lar_triangles_close(lar_triangles *triangles, int32_t *turned, lar_error *error) {
    closing c = {.triangles = triangles, .error = error};
    lar_status status = allocate(&c);
    if (!status) {
        list_edges(&c);
        list_neighbours(&c);
        for (int32_t t = 0; t < triangles->triangle_count; t++) c.patch[t] = -1;
        for (int32_t t = 0; t < triangles->triangle_count; t++)
            if (c.patch[t] < 0) flood(&c, t);
        status = check_edges(&c);
    }
    if (!status) status = allocate_patches(&c);
    if (!status) {
        join_patches(&c);
        measure_shells(&c);
        status = nest_shells(&c);
    }
    if (!status) {
        int32_t count = turn_triangles(&c);
        if (turned) *turned = count;
        leave_out(&c);
    }
    free(c.use);
    free(c.beside);
    free(c.against);
    free(c.turned);
    free(c.patch);
    free(c.queue);
    free(c.root);
    free(c.sum);
    free(c.volume);
    free(c.box);
    free(c.around);
    free(c.within);
    return status;
}
