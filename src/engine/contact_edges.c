/* Sharp edges of surfaces in contact, at rest.
 *
 * What comes under a body from beside meets its sharp edge first. There springs are taken up and
 * let go little by little, over half a face, or each node that goes by would be a blow
 * (docs/theory.md, contact). How far an edge turns decides: the faces of an organ stand at small
 * angles to each other, those of a block at a right one.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "engine/contact_surface.h"
#include "mechanics/contact.h"

/* A side of a face, by its nodes in ascending order. */
typedef struct side {
    int32_t node[2], face;
} side;

static int by_nodes(const void *a, const void *b) {
    const side *x = a, *y = b;
    for (int i = 0; i < 2; i++)
        if (x->node[i] != y->node[i]) return x->node[i] < y->node[i] ? -1 : 1;
    return (x->face > y->face) - (x->face < y->face);
}

/* The unit normal of a face at rest, and its middle. */
static void stand(const lar_contact_surface *s, int32_t face, double normal[3], double middle[3]) {
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
}

/* 1 where two faces make no sharp edge, 0 where they do. */
static double bluntness(const lar_contact_surface *s, int32_t one, int32_t other) {
    static const double BLUNT = 0.85, SHARP = 0.5; /* cosines of 32 and 60 degrees */
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

lar_status lar_contact_surface_blunt(lar_contact_surface *s, lar_error *error) {
    size_t count = 4 * (size_t)s->face_count;
    side *sides = lar_calloc(count, sizeof *sides);
    if (!sides) return lar_fail_memory(error, count * sizeof *sides, "the edges of surfaces");
    for (int32_t n = 0; n < s->node_count; n++) s->node[n].blunt = 1;
    for (size_t i = 0; i < count; i++) {
        const lar_contact_face *face = &s->face[i / 4];
        int32_t a = face->corner[i % 4], b = face->corner[(i + 1) % 4];
        sides[i] = (side){{a < b ? a : b, a < b ? b : a}, (int32_t)(i / 4)};
    }
    qsort(sides, count, sizeof *sides, by_nodes);
    for (size_t i = 0; i + 1 < count; i++) {
        if (memcmp(sides[i].node, sides[i + 1].node, sizeof sides[i].node) != 0) continue;
        double blunt = bluntness(s, sides[i].face, sides[i + 1].face);
        for (int k = 0; k < 2; k++) {
            lar_contact_node *node = &s->node[sides[i].node[k]];
            node->blunt = fmin(node->blunt, blunt);
        }
    }
    for (int32_t f = 0; f < s->face_count; f++)
        for (int a = 0; a < 4; a++)
            s->face[f].fades = s->face[f].fades || s->node[s->face[f].corner[a]].blunt < 1;
    free(sides);
    return LAR_OK;
}
