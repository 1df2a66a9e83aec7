/* How far a tool is from the surface at rest.
 *
 * A tool is made of segments with a radius (a sphere's segment is a point), a face of four
 * triangles around its middle, as contact has them (mechanics/face_contact.h). Segment and triangle
 * are next to each other at an end of the segment, at an edge of the triangle, or where they cross.
 * What crosses nothing may still lie inside a body as a whole: the solid angles of all faces, seen
 * from it, then sum to 4 pi instead of zero (Van Oosterom and Strackee 1983, eq. 8).
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "model/contact_check.h"

typedef double vec[3];

static void minus(const vec a, const vec b, vec out) {
    for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

static double dot(const vec a, const vec b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const vec a, const vec b, vec out) {
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double within(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}

/* ---- distances, squared --------------------------------------------------------------------- */

static double point_segment(const vec p, const vec a, const vec b) {
    vec ab, ap;
    minus(b, a, ab);
    minus(p, a, ap);
    double square = dot(ab, ab), t = square > 0 ? within(dot(ap, ab) / square, 0, 1) : 0;
    for (int i = 0; i < 3; i++) ap[i] -= t * ab[i];
    return dot(ap, ap);
}

/* The least of: an end to the other segment (four), and the crossing of the two lines when it is
 * within both. */
static double segment_segment(const vec a, const vec b, const vec c, const vec d) {
    double best = fmin(fmin(point_segment(a, c, d), point_segment(b, c, d)),
                       fmin(point_segment(c, a, b), point_segment(d, a, b)));
    vec u, v, w;
    minus(b, a, u);
    minus(d, c, v);
    minus(c, a, w);
    double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), det = uu * vv - uv * uv;
    if (!(det > 1e-14 * uu * vv)) return best; /* parallel: an end is next */
    double s = (dot(w, u) * vv - dot(w, v) * uv) / det;
    double t = (dot(w, u) * uv - dot(w, v) * uu) / det;
    if (s < 0 || s > 1 || t < 0 || t > 1) return best;
    for (int i = 0; i < 3; i++) w[i] += t * v[i] - s * u[i];
    return fmin(best, dot(w, w));
}

/* Is the foot of p on the triangle's plane within it? Its height, signed, and the share of the way
 * from p where that is. */
static bool above_triangle(const vec p, const double (*t)[3], double *height) {
    vec n, side, to, turned;
    vec edge[2];
    minus(t[1], t[0], edge[0]);
    minus(t[2], t[0], edge[1]);
    cross(edge[0], edge[1], n);
    double length = sqrt(dot(n, n));
    if (!(length > 0)) return false;
    for (int i = 0; i < 3; i++) {
        minus(t[(i + 1) % 3], t[i], side);
        minus(p, t[i], to);
        cross(side, to, turned);
        if (dot(turned, n) < 0) return false;
    }
    minus(p, t[0], to);
    *height = dot(to, n) / length;
    return true;
}

static bool crosses(const vec a, const vec b, const double (*t)[3]) {
    vec n, edge[2], to_a, to_b, at;
    double height;
    minus(t[1], t[0], edge[0]);
    minus(t[2], t[0], edge[1]);
    cross(edge[0], edge[1], n);
    minus(a, t[0], to_a);
    minus(b, t[0], to_b);
    double ha = dot(to_a, n), hb = dot(to_b, n);
    if ((ha > 0) == (hb > 0) || ha == hb) return false;
    for (int i = 0; i < 3; i++) at[i] = a[i] + ha / (ha - hb) * (b[i] - a[i]);
    return above_triangle(at, t, &height);
}

static double segment_triangle(const vec a, const vec b, const double (*t)[3]) {
    double best = DBL_MAX, height;
    if (crosses(a, b, t)) return 0;
    if (above_triangle(a, t, &height)) best = height * height;
    if (above_triangle(b, t, &height)) best = fmin(best, height * height);
    for (int i = 0; i < 3; i++) best = fmin(best, segment_segment(a, b, t[i], t[(i + 1) % 3]));
    return best;
}

/* ---- inside or outside ----------------------------------------------------------------------- */

static double solid_angle(const vec p, const double (*t)[3]) {
    vec r[3], turned;
    double length[3];
    for (int i = 0; i < 3; i++) {
        minus(t[i], p, r[i]);
        length[i] = sqrt(dot(r[i], r[i]));
    }
    cross(r[1], r[2], turned);
    double below = length[0] * length[1] * length[2] + dot(r[0], r[1]) * length[2] +
                   dot(r[0], r[2]) * length[1] + dot(r[1], r[2]) * length[0];
    return 2 * atan2(dot(r[0], turned), below);
}

static void corners_of(const lar_model *model, int32_t face, double corner[4][3]) {
    for (int a = 0; a < 4; a++)
        memcpy(corner[a], model->mesh.position[model->surface.corner[face][a]], sizeof corner[a]);
}

/* Triangle `a` of the four around a face's middle. */
static void triangle_of(double corner[4][3], int a, double t[3][3]) {
    memcpy(t[0], corner[a], sizeof(vec));
    memcpy(t[1], corner[(a + 1) % 4], sizeof(vec));
    for (int i = 0; i < 3; i++)
        t[2][i] = 0.25 * ((corner[0][i] + corner[1][i]) + (corner[2][i] + corner[3][i]));
}

static bool inside(const lar_model *model, const vec p) {
    double sum = 0, corner[4][3], t[3][3];
    for (int32_t f = 0; f < model->surface.face_count; f++) {
        corners_of(model, f, corner);
        for (int a = 0; a < 4; a++) {
            triangle_of(corner, a, t);
            sum += solid_angle(p, (const double(*)[3])t);
        }
    }
    return sum > 2 * LAR_PI;
}

/* ---- tools ---------------------------------------------------------------------------------- */

/* Rotates by the unit quaternion q: v + 2 w (a x v) + 2 a x (a x v). */
static void turned_by(const double q[4], const vec v, vec out) {
    vec c, d;
    cross(q + 1, v, c);
    cross(q + 1, c, d);
    for (int i = 0; i < 3; i++) out[i] = v[i] + 2 * (q[0] * c[i] + d[i]);
}

/* The segments of a tool at rest, from the tip; their count. */
static int segments_of(const lar_tool *tool, double end[2][3]) {
    double half = 0.5 * tool->spread * tool->rest.opening, length = tool->length;
    const vec shaft = {0, 0, length};
    const vec jaw[2] = {{length * sin(half), 0, -length * cos(half)},
                        {-length * sin(half), 0, -length * cos(half)}};
    int count = tool->shape == LAR_TOOL_GRASPER ? 2 : 1;
    for (int s = 0; s < count; s++) {
        turned_by(tool->rest.orientation, count == 2 ? jaw[s] : shaft, end[s]);
        for (int i = 0; i < 3; i++) end[s][i] += tool->rest.position[i];
    }
    return count;
}

static double segment_face(const vec a, const vec b, double corner[4][3], double best) {
    double reach = 0, t[3][3];
    vec d;
    for (int c = 1; c < 4; c++) {
        minus(corner[c], corner[0], d);
        reach = fmax(reach, sqrt(dot(d, d)));
    }
    if (sqrt(point_segment(corner[0], a, b)) - reach > best) return DBL_MAX; /* too far away */
    double min = DBL_MAX;
    for (int c = 0; c < 4; c++) {
        triangle_of(corner, c, t);
        min = fmin(min, segment_triangle(a, b, (const double(*)[3])t));
    }
    return sqrt(min);
}

double lar_tool_gap(const lar_model *model, const lar_tool *tool, int32_t *face) {
    double end[2][3], corner[4][3], best = DBL_MAX;
    int count = segments_of(tool, end);
    *face = 0;
    for (int32_t f = 0; f < model->surface.face_count; f++) {
        corners_of(model, f, corner);
        for (int s = 0; s < count; s++) {
            double distance = segment_face(tool->rest.position, end[s], corner, best);
            if (distance < best) {
                best = distance;
                *face = f;
            }
        }
    }
    if (inside(model, tool->rest.position)) best = -best;
    return best - tool->radius;
}
