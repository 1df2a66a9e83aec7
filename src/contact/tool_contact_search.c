/* Which faces are near a tool: first groups of them, then faces (T 3.8.1). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/tool_contact.h"

static double square_between(const double a[3], const double b[3]) {
    double square = 0;
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) square += (a[i] - b[i]) * (a[i] - b[i]);
    return square;
}

void lar_tool_contact_corners(const lar_tool_contact_face *face, const lar_state *state,
                              double x[4][3]) {
    for (int a = 0; a < 4; a++)
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++)
            x[a][i] = face->rest[a][i] + state->u[lar_state_at(state, face->node[a], i)];
}

double lar_tool_contact_ball_of(const double x[4][3], double center[3]) {
    double most = 0;
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) center[i] = 0.25 * ((x[0][i] + x[1][i]) + (x[2][i] + x[3][i]));
    for (int a = 0; a < 4; a++) {
        double square = square_between(center, x[a]);
        most = square > most ? square : most; /* no call, and not what is no number */
    }
    return sqrt(most);
}

double lar_tool_contact_distance(const lar_tool_body *body, double radius, const double point[3]) {
    double deepest = -INFINITY, away[3], along;
    for (int32_t s = 0; s < body->count; s++) { /* lar_segment_depth, without the normal */
        const lar_segment_axis axis = lar_segment_axis_of(&body->now[s]);
        double distance = sqrt(lar_segment_away(&body->now[s], &axis, point, away, &along));
        double depth = distance > 0 ? radius - distance : -radius;
        deepest = depth > deepest ? depth : deepest;
    }
    return -deepest;
}

/* ---- groups -------------------------------------------------------------------------------- */

enum { GROUP = 16 };

static double center_along(const lar_tool_contact_face *face, int axis) {
    return (face->rest[0][axis] + face->rest[1][axis]) +
           (face->rest[2][axis] + face->rest[3][axis]);
}

#define COMPARE_ALONG(name, axis)                                                                  \
    static int name(const void *a, const void *b) {                                                \
        double x = center_along(a, axis), y = center_along(b, axis);                               \
        if (x != y) return x < y ? -1 : 1;                                                         \
        int32_t f = ((const lar_tool_contact_face *)a)->of,                                        \
                g = ((const lar_tool_contact_face *)b)->of;                                        \
        return (f > g) - (f < g);                                                                  \
    }
COMPARE_ALONG(along_x, 0)
COMPARE_ALONG(along_y, 1)
COMPARE_ALONG(along_z, 2)
#undef COMPARE_ALONG

/* Halves across the longest side until they are small: neighbours stay together. */
static void halve(lar_tool_faces *faces, int32_t first, int32_t count) {
    static int (*const compare[3])(const void *, const void *) = {along_x, along_y, along_z};
    if (count <= GROUP) {
        if (count > 0) faces->group[faces->group_count++] = (lar_tool_contact_group){first, count};
        return;
    }
    double longest = -1;
    int axis = 0;
    for (int i = 0; i < 3; i++) {
        double low = INFINITY, high = -INFINITY;
        for (int32_t f = first; f < first + count; f++) {
            low = fmin(low, center_along(&faces->face[f], i));
            high = fmax(high, center_along(&faces->face[f], i));
        }
        if (high - low > longest) {
            longest = high - low;
            axis = i;
        }
    }
    qsort(faces->face + first, (size_t)count, sizeof *faces->face, compare[axis]);
    halve(faces, first, count / 2);
    halve(faces, first + count / 2, count - count / 2);
}

lar_status lar_tool_faces_group(lar_tool_faces *faces, lar_error *error) {
    size_t max = (size_t)faces->face_count / (GROUP / 2) + 1;
    faces->group = lar_calloc(max, sizeof *faces->group);
    if (!faces->group)
        return lar_fail_memory(error, max * sizeof *faces->group, "the groups of faces");
    halve(faces, 0, faces->face_count);
    return LAR_OK;
}

/* ---- the search ---------------------------------------------------------------------------- */

/* The ball around all corners of a group: that of the corners' mean, which is not the smallest. */
static void measure_group(const lar_tool_contact *contact, const lar_tool_contact_group *group,
                          const lar_state *state, lar_tool_contact_ball *ball) {
    const lar_tool_contact_face *face = contact->faces->face;
    double x[4][3], center[3];
    memset(ball->center, 0, sizeof ball->center);
    for (int32_t f = group->first; f < group->first + group->count; f++) {
        lar_tool_contact_corners(&face[f], state, x);
        lar_tool_contact_ball_of((const double(*)[3])x, center);
        for (int i = 0; i < 3; i++) ball->center[i] += center[i] / group->count;
    }
    double most = 0;
    for (int32_t f = group->first; f < group->first + group->count; f++) {
        lar_tool_contact_corners(&face[f], state, x);
        for (int a = 0; a < 4; a++) {
            double square = square_between(ball->center, x[a]);
            most = square > most ? square : most;
        }
    }
    ball->radius = sqrt(most);
    ball->travel = contact->travel;
}

static void search_group(lar_tool_contact *contact, lar_tool_vicinity *vicinity, double radius,
                         double reach, const lar_tool_contact_group *group,
                         const lar_state *state) {
    double x[4][3], center[3];
    for (int32_t f = group->first; f < group->first + group->count; f++) {
        lar_tool_contact_corners(&contact->faces->face[f], state, x);
        double size = lar_tool_contact_ball_of((const double(*)[3])x, center);
        double gap = lar_tool_contact_distance(&vicinity->body, radius, center) - size;
        if (gap > reach) continue; /* not a number is near */
        vicinity->near[vicinity->near_count] = f;
        vicinity->look[vicinity->near_count++] = lar_tool_contact_clear(gap, radius);
    }
    contact->seen.boxed += (uint64_t)group->count;
}

void lar_tool_contact_search(lar_tool_contact *contact, int32_t tool, const lar_state *state,
                             double step_path) {
    enum { AHEAD = 48 };
    lar_tool_vicinity *vicinity = &contact->vicinity[tool];
    double radius = contact->list->tool[tool].radius;
    double reach = fmin(fmax(AHEAD * step_path, 0.02 * radius), 4 * radius);
    if (!(reach > 0)) reach = radius;
    vicinity->near_count = 0;
    vicinity->path = 0; /* short sums keep the smallest steps */
    vicinity->limit = lar_tool_contact_clear(reach, radius);
    vicinity->known = true;
    for (int32_t g = 0; g < contact->faces->group_count; g++) {
        const lar_tool_contact_group *group = &contact->faces->group[g];
        lar_tool_contact_ball *ball = &contact->ball[g];
        /* As it was, grown by what its corners can have gone: mostly that is far enough away. */
        double grown = ball->radius + (contact->travel - ball->travel);
        if (lar_tool_contact_distance(&vicinity->body, radius, ball->center) - grown > reach)
            continue;
        if (!(contact->travel == ball->travel)) {
            measure_group(contact, group, state, ball);
            if (lar_tool_contact_distance(&vicinity->body, radius, ball->center) - ball->radius >
                reach)
                continue;
        }
        search_group(contact, vicinity, radius, reach, group, state);
    }
    contact->seen.searches++;
}
