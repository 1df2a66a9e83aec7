/* The surface of the demonstration organ: simple bodies blended into one. Millimetres. */
#include <math.h>

#include "model/demo/demo_parts.h"

typedef struct point4 {
    double v[4]; /* x, y, z, radius */
} point4;

/* Control points of the centre lines (cubic Bezier curves, the radius along with them). */
static const point4 tube_control[4] = {{{17.0, 0.0, 60.0, 8.2}},
                                       {{36.0, 0.0, 70.5, 3.2}},
                                       {{62.0, 0.0, 75.5, 4.6}},
                                       {{55.2, 0.0, 47.0, 5.3}}};
static const point4 ligament_control[4] = {{{12.0, -6.0, 57.0, 5.4}},
                                           {{13.5, -25.0, 61.0, 4.0}},
                                           {{29.0, -30.0, 57.0, 3.8}},
                                           {{36.0, -30.0, 39.0, 4.4}}};

static void bezier(const point4 control[4], double t, double point[4], double tangent[3]) {
    const double u = 1.0 - t;
    for (int c = 0; c < 4; ++c) {
        const double p0 = control[0].v[c], p1 = control[1].v[c];
        const double p2 = control[2].v[c], p3 = control[3].v[c];
        point[c] = u * u * u * p0 + 3.0 * u * u * t * p1 + 3.0 * u * t * t * p2 + t * t * t * p3;
        if (tangent && c < 3)
            tangent[c] = 3.0 * (u * u * (p1 - p0) + 2.0 * u * t * (p2 - p1) + t * t * (p3 - p2));
    }
}

double lar_demo_sweep(double x) {
    const double beyond = fabs(x) - 20.0;
    return beyond > 0.0 ? 0.0065 * beyond * beyond : 0.0;
}

void lar_demo_tube_axis(double t, double point[3], double tangent[3], double *radius) {
    double p[4];
    bezier(tube_control, t, p, tangent);
    for (int c = 0; c < 3; ++c) point[c] = p[c];
    *radius = p[3];
}

void lar_demo_ligament_axis(double t, double point[3], double tangent[3], double *radius) {
    double p[4];
    bezier(ligament_control, t, p, tangent);
    for (int c = 0; c < 3; ++c) point[c] = p[c];
    *radius = p[3];
}

lar_demo_shape lar_demo_shape_create(void) {
    lar_demo_shape shape;
    for (int i = 0; i < LAR_DEMO_TUBE_POINTS; ++i)
        bezier(tube_control, i / (LAR_DEMO_TUBE_POINTS - 1.0), shape.tube[i], NULL);
    for (int i = 0; i < LAR_DEMO_LIGAMENT_POINTS; ++i)
        bezier(ligament_control, i / (LAR_DEMO_LIGAMENT_POINTS - 1.0), shape.ligament[i], NULL);
    return shape;
}

/* Union and intersection with a fillet of about `width` (polynomial smooth minimum). */
static double blend(double a, double b, double width) {
    double h = width - fabs(a - b);
    h = h > 0.0 ? h / width : 0.0;
    return (a < b ? a : b) - 0.25 * h * h * width;
}
static double cut(double a, double b, double width) {
    return -blend(-a, -b, width);
}

/* Distance to an ellipsoid, first order. */
static double ellipsoid(const double p[3], double rx, double ry, double rz) {
    const double a[3] = {p[0] / rx, p[1] / ry, p[2] / rz};
    const double b[3] = {a[0] / rx, a[1] / ry, a[2] / rz};
    const double k0 = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    const double k1 = sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    return k1 > 1e-9 ? k0 * (k0 - 1.0) / k1 : -(rx < ry ? rx : ry);
}

/* Distance to a swept sphere of changing radius. The last section is cut off flat, with a
 * rounded rim. */
static double swept(const double (*axis)[4], int count, const double p[3], double rim) {
    double best = 1e30;
    for (int i = 0; i + 1 < count; ++i) {
        double along = 0.0, length = 0.0, square = 0.0;
        for (int c = 0; c < 3; ++c) {
            const double d = axis[i + 1][c] - axis[i][c];
            along += (p[c] - axis[i][c]) * d;
            length += d * d;
        }
        along /= length;
        along = along < 0.0 ? 0.0 : along > 1.0 ? 1.0 : along;
        for (int c = 0; c < 3; ++c) {
            const double d = p[c] - axis[i][c] - along * (axis[i + 1][c] - axis[i][c]);
            square += d * d;
        }
        const double radius = axis[i][3] + along * (axis[i + 1][3] - axis[i][3]);
        const double distance = sqrt(square) - radius;
        best = distance < best ? distance : best;
    }
    double ahead = 0.0, norm = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double d = axis[count - 1][c] - axis[count - 2][c];
        ahead += (p[c] - axis[count - 1][c]) * d;
        norm += d * d;
    }
    return cut(best, ahead / sqrt(norm), rim);
}

/* Distance to a sheet: a polygon in the x-z plane with thickness 2 * half. */
static double sheet(const double p[3], double half) {
    static const double corner[][2] = {{10.0, 36.0}, {29.0, 34.0}, {41.0, 43.0},
                                       {42.0, 50.0}, {43.0, 66.0}, {10.0, 62.0}};
    enum { CORNERS = sizeof corner / sizeof corner[0] };
    double square = 1e30;
    int inside = 0;
    for (int i = 0, j = CORNERS - 1; i < CORNERS; j = i++) {
        const double ex = corner[j][0] - corner[i][0], ez = corner[j][1] - corner[i][1];
        const double wx = p[0] - corner[i][0], wz = p[2] - corner[i][1];
        double t = (wx * ex + wz * ez) / (ex * ex + ez * ez);
        t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
        const double dx = wx - t * ex, dz = wz - t * ez;
        square = dx * dx + dz * dz < square ? dx * dx + dz * dz : square;
        if ((corner[i][1] > p[2]) != (corner[j][1] > p[2]) && wx < ex * wz / ez) inside = !inside;
    }
    const double away = inside ? 0.0 : sqrt(square);
    return sqrt(away * away + p[1] * p[1]) - half;
}

/* Corpus, a wide ellipsoid, on the cervix, a slender elliptic cone cut off flat at z = 0. */
static double uterus(const double p[3]) {
    const double body[3] = {p[0], p[1], p[2] - 52.0};
    const double corpus = ellipsoid(body, 27.2, 17.8, 27.5);
    const double grow = 1.0 + 0.006 * p[2];
    const double rx = 15.3 * grow, ry = 14.0 * grow;
    const double q[2] = {p[0] / rx, p[1] / ry};
    const double round = (sqrt(q[0] * q[0] + q[1] * q[1]) - 1.0) * ry;
    const double cone = cut(cut(round, -p[2], 5.0), p[2] - 50.0, 5.0);
    return blend(corpus, cone, 16.0);
}

static double ovary(const double p[3]) {
    const double d[3] = {p[0] - 38.5, p[1] - 1.0, p[2] - 37.5};
    const double cosine = 0.96, sine = 0.28; /* the outer pole hangs lower */
    const double turned[3] = {cosine * d[0] - sine * d[2], d[1], sine * d[0] + cosine * d[2]};
    return ellipsoid(turned, 13.5, 9.0, 10.0);
}

double lar_demo_shape_distance(const lar_demo_shape *shape, bool tube, const double point[3]) {
    const int sections = tube ? LAR_DEMO_TUBE_POINTS : LAR_DEMO_TUBE_BEND;
    const double p[3] = {fabs(point[0]), point[1], point[2]};
    const double back[3] = {p[0], p[1] - lar_demo_sweep(p[0]), p[2]};
    double distance = uterus(p);
    double adnexa = blend(swept(shape->tube, sections, back, 3.0), sheet(back, 3.0), 4.0);
    adnexa = blend(adnexa, ovary(back), 4.0);
    distance = blend(distance, adnexa, 8.0);
    return blend(distance, swept(shape->ligament, LAR_DEMO_LIGAMENT_POINTS, p, 3.0), 5.0);
}
