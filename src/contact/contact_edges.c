/* Sharp edges of surfaces in contact, at rest, and faces that have no others.
 *
 * What comes under a body from beside meets its sharp edge first. There springs are taken up and
 * let go little by little, over half a face, or each node that goes by would be a blow
 * (docs/theory.md, contact). How far an edge turns decides: the faces of an organ stand at small
 * angles to each other, those of a block at a right one.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/contact_surface.h"
#include "mechanics/contact.h"

/* A side of a face, by its nodes in ascending order. */
typedef struct side {
    int32_t node[2], face;
    int32_t other; /* of a sharp edge: the second face */
} side;

static int by_nodes(const void *a, const void *b) {
    const side *x = a, *y = b;
    for (int i = 0; i < 2; i++)
        if (x->node[i] != y->node[i]) return x->node[i] < y->node[i] ? -1 : 1;
    return (x->face > y->face) - (x->face < y->face);
}

/* The unit normal of a face at rest, and its middle; returns its area. */
static double stand(const lar_contact_surface *s, int32_t face, double normal[3],
                    double middle[3]) {
    double corner[4][3], length = 0;
    for (int i = 0; i < 3; i++) middle[i] = 0;
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) {
            corner[a][i] = s->rest[s->face[face].corner[a]][i];
            middle[i] += 0.25 * corner[a][i];
        }
    lar_face_normal((const double(*)[3])corner, normal);
    for (int i = 0; i < 3; i++) length += normal[i] * normal[i];
    length = sqrt(length);
    for (int i = 0; i < 3 && length > 0; i++) normal[i] /= length;
    return 0.5 * length;
}

/* 1 where two faces make no sharp edge, 0 where they do. */
static double bluntness(const lar_contact_surface *s, int32_t one, int32_t other) {
    static const double BLUNT = 0.26, SHARP = 0.09; /* cosines of 75 and 85 degrees */
    double normal[2][3], middle[2][3], cosine = 0, under = 0;
    stand(s, one, normal[0], middle[0]);
    stand(s, other, normal[1], middle[1]);
    for (int i = 0; i < 3; i++) {
        cosine += normal[0][i] * normal[1][i];
        under += normal[0][i] * (middle[1][i] - middle[0][i]);
    }
    if (!(under < 0)) return 1;
    return fmin(fmax((cosine - SHARP) / (BLUNT - SHARP), 0), 1);
}

/* All sides of faces, equal ones beside each other. */
static side *list_sides(const lar_contact_surface *s, size_t count) {
    side *sides = lar_calloc(count, sizeof *sides);
    for (size_t i = 0; i < count && sides; i++) {
        const lar_contact_face *face = &s->face[i / 4];
        int32_t a = face->corner[i % 4], b = face->corner[(i + 1) % 4];
        sides[i] = (side){{a < b ? a : b, a < b ? b : a}, (int32_t)(i / 4), -1};
    }
    if (sides) qsort(sides, count, sizeof *sides, by_nodes);
    return sides;
}

static const double MEETS = 0.5; /* edges that are blunter: faces are enough */

/* The node beside an end of a sharp edge, on one of its faces. */
static void add_inward(const lar_contact_surface *s, int32_t inward[3], const side *edge,
                       int32_t face, int end) {
    const int32_t *corner = s->face[face].corner;
    int a = 0, k = 0;
    while (corner[a] != edge->node[end]) a++;
    int32_t next = corner[(a + 1) % 4];
    if (next == edge->node[!end]) next = corner[(a + 3) % 4];
    while (k < 3 && inward[k] >= 0 && inward[k] != next) k++;
    if (k < 3) inward[k] = next;
}

/* One of the nodes along the edge, for a node or point on both sides of which that goes on. (In a
 * corner all nodes that are along edges lie in the body.) */
static void add_along(lar_contact_surface *s, int32_t at, int32_t next) {
    lar_contact_node *node = &s->node[at];
    int k = 0;
    while (k < 3 && node->inward[k] >= 0) k++;
    if (k == 3 || node->along < 3) return;
    node->along = k;
    node->inward[k] = next;
}

/* Sharp edges to the front; returns how many. */
static size_t find_edges(lar_contact_surface *s, side *sides, size_t count) {
    size_t edges = 0;
    for (int32_t n = 0; n < s->node_count; n++) {
        s->node[n].blunt = 1;
        s->node[n].along = 3;
        memset(s->node[n].inward, -1, sizeof s->node[n].inward);
    }
    for (size_t i = 0; i + 1 < count; i++) {
        if (memcmp(sides[i].node, sides[i + 1].node, sizeof sides[i].node) != 0) continue;
        double blunt = bluntness(s, sides[i].face, sides[i + 1].face);
        for (int k = 0; k < 2; k++) {
            lar_contact_node *node = &s->node[sides[i].node[k]];
            node->blunt = fmin(node->blunt, blunt);
        }
        if (!(blunt < MEETS)) continue;
        for (int k = 0; k < 4; k++)
            add_inward(s, s->node[sides[i].node[k % 2]].inward, &sides[i], sides[i + k / 2].face,
                       k % 2);
        sides[edges] = sides[i];
        sides[edges++].other = sides[i + 1].face;
    }
    for (size_t i = 0; i < 2 * edges; i++)
        add_along(s, sides[i / 2].node[i % 2], sides[i / 2].node[1 - i % 2]);
    for (int32_t f = 0; f < s->face_count; f++)
        for (int a = 0; a < 4; a++)
            s->face[f].fades = s->face[f].fades || s->node[s->face[f].corner[a]].blunt < 1;
    return edges;
}

/* Points of an edge: between nodes, which are points already. Each has so small a part of the mass
 * behind it, or two edges that lie along each other would have more springs than a step bears. */
enum { EDGE_POINTS = 4, POINT_PARTS = 12 };

static void add_point(lar_contact_surface *s, const lar_contact_point *point) {
    int32_t at = s->point_count++;
    s->point[at - s->node_count] = *point;
    s->node[at] = s->node[point->node[0]];
    s->node[at].along = 3;
    for (int i = 0; i < 3; i++) s->rest[at][i] = 0;
    for (int k = 0; k < point->count; k++) {
        s->node[at].passes &= s->node[point->node[k]].passes;
        for (int i = 0; i < 3; i++) s->rest[at][i] += point->weight[k] * s->rest[point->node[k]][i];
    }
    s->slave_count += s->node[at].passes != 0;
}

static void add_edge(lar_contact_surface *s, const side *edge) {
    for (int k = 0; k < EDGE_POINTS; k++) {
        double along = (k + 0.5) / EDGE_POINTS;
        add_point(s, &(lar_contact_point){2, {edge->node[0], edge->node[1]}, {1 - along, along}});
        int32_t *inward = s->node[s->point_count - 1].inward;
        memset(inward, -1, sizeof s->node->inward);
        add_inward(s, inward, edge, edge->face, 0);
        add_inward(s, inward, edge, edge->other, 0);
        add_along(s, s->point_count - 1, edge->node[1]);
    }
}

/* Points of a face whose corners are all on sharp edges, as of a body that is one element wide: a
 * node on an edge that has gone down exactly along the side of another body is on its surface, and
 * nothing pushes it; a point amid a face knows where it has come in. */
enum { FACE_POINTS = 4 };

static bool among_edges(const lar_contact_surface *s, int32_t face) {
    bool all = true;
    for (int a = 0; a < 4; a++) all = all && s->node[s->face[face].corner[a]].blunt < MEETS;
    return all;
}

/* Half-way from the middle to the corners, on the four triangles that others take the face for
 * (mechanics/face_contact.h): those of a twisted face would lie in what it lies on. */
static void add_face(lar_contact_surface *s, int32_t face) {
    for (int k = 0; k < FACE_POINTS; k++) {
        lar_contact_point point = {.count = 4};
        memcpy(point.node, s->face[face].corner, sizeof point.node);
        for (int a = 0; a < 4; a++) point.weight[a] = a == k ? 0.625 : 0.125;
        add_point(s, &point);
        memset(s->node[s->point_count - 1].inward, -1, sizeof s->node->inward);
    }
}

static lar_status add_points(lar_contact_surface *s, const side *edge, size_t edges,
                             lar_error *error) {
    size_t nodes = (size_t)s->node_count, count = nodes + EDGE_POINTS * edges;
    for (int32_t f = 0; f < s->face_count; f++) count += among_edges(s, f) ? FACE_POINTS : 0;
    lar_contact_node *node = realloc(s->node, count * sizeof *node);
    if (node) s->node = node;
    double(*rest)[3] = realloc(s->rest, count * sizeof *rest);
    if (rest) s->rest = rest;
    s->point = lar_calloc(count - nodes, sizeof *s->point);
    if (!node || !rest || !s->point)
        return lar_fail_memory(error, count * sizeof *node, "points of edges");
    for (size_t e = 0; e < edges; e++) add_edge(s, &edge[e]);
    for (int32_t f = 0; f < s->face_count; f++)
        if (among_edges(s, f)) add_face(s, f);
    return LAR_OK;
}

static double seen_along(const double tensor[3][3], const double way[3]) {
    double sum = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) sum += way[i] * tensor[i][j] * way[j];
    return sum;
}

/* A quarter of each face for each corner, by the squared cosine between the faces there: where a
 * body has an edge one side of it is in another one's way, and the largest counts. */
static lar_status find_areas(lar_contact_surface *s, lar_error *error) {
    size_t bytes = (size_t)s->node_count * 9 * sizeof(double);
    double(*tensor)[3][3] = lar_calloc(bytes, 1), normal[3], middle[3];
    if (!tensor) return lar_fail_memory(error, bytes, "the areas of surfaces");
    for (int32_t f = 0; f < s->face_count; f++) {
        double area = stand(s, f, normal, middle);
        for (int a = 0; a < 4; a++)
            for (int i = 0; i < 9; i++)
                tensor[s->face[f].corner[a]][i / 3][i % 3] +=
                    0.25 * area * normal[i / 3] * normal[i % 3];
    }
    for (int32_t f = 0; f < s->face_count; f++) {
        stand(s, f, normal, middle);
        for (int a = 0; a < 4; a++) {
            int32_t n = s->face[f].corner[a];
            s->node[n].area =
                fmax(s->node[n].area, seen_along((const double(*)[3])tensor[n], normal));
        }
    }
    free(tensor);
    return LAR_OK;
}

lar_status lar_contact_surface_edges(lar_contact_surface *s, lar_error *error) {
    size_t count = 4 * (size_t)s->face_count;
    lar_status failed = find_areas(s, error);
    if (failed) return failed;
    side *sides = list_sides(s, count);
    s->point_count = s->node_count;
    if (!sides) return lar_fail_memory(error, count * sizeof *sides, "the edges of surfaces");
    size_t edges = find_edges(s, sides, count);
    lar_status status = edges && s->body_count > 1 ? add_points(s, sides, edges, error) : LAR_OK;
    free(sides);
    return status;
}

void lar_contact_edges_fit(lar_contact_surface *s) {
    for (int32_t n = s->node_count; n < s->point_count; n++) {
        const lar_contact_point *point = &s->point[n - s->node_count];
        double compliance = 0, area = 0;
        for (int i = 0; i < point->count; i++) {
            compliance += point->weight[i] / s->node[point->node[i]].mass;
            area += point->weight[i] * s->node[point->node[i]].area;
        }
        s->node[n].mass = 1 / (POINT_PARTS * compliance);
        s->node[n].area = 2 * area / POINT_PARTS;
    }
}
