/* Shapes whose volume and topology are known, as label images and as triangles: about
 * 60 mm wide, around the world's origin.
 *
 *     shape_image(&image, &shape_torus, 2e-3, SHAPE_STRAIGHT);     lar_image_clear(&image);
 *     shape_ellipsoid_surface(&triangles, axes, centre, 32);       lar_triangles_clear(&triangles);
 */
#ifndef LAR_TESTS_SHAPES_H
#define LAR_TESTS_SHAPES_H

#include "testing.h"

#include "meshing/image/image.h"
#include "model/triangles/triangles.h"

#define SHAPE_PI 3.14159265358979323846

typedef struct shape {
    const char *name;
    int (*label)(const double x[3]); /* at a place [m]; 0 outside */
    double half[3];                  /* of its box around the origin [m] */
    double volume;                   /* [m^3] */
    int labels;                      /* 1, 2, .. */
    int euler; /* Euler characteristic of the solid: pieces - handles + hollows */
} shape;

static inline int shape_ellipsoid_label(const double x[3]) {
    double a = x[0] / 0.030, b = x[1] / 0.024, c = x[2] / 0.018;
    return a * a + b * b + c * c < 1;
}

static inline int shape_torus_label(const double x[3]) {
    double ring = sqrt(x[0] * x[0] + x[1] * x[1]) - 0.022;
    return ring * ring + x[2] * x[2] < 0.008 * 0.008;
}

/* Two balls of radius 20 mm, 28 mm apart, that touch in a disc at x = 0. */
static inline int shape_balls_label(const double x[3]) {
    double along = fabs(x[0]) - 0.014;
    if (along * along + x[1] * x[1] + x[2] * x[2] >= 0.020 * 0.020) return 0;
    return x[0] < 0 ? 1 : 2;
}

static inline int shape_sheet_label(const double x[3]) {
    return fabs(x[0]) < 0.030 && fabs(x[1]) < 0.024 && fabs(x[2]) < 0.002;
}

/* A box with a hole through it along z, and a hollow beside. */
static inline int shape_holes_label(const double x[3]) {
    if (fabs(x[0]) >= 0.030 || fabs(x[1]) >= 0.024 || fabs(x[2]) >= 0.016) return 0;
    if (fabs(x[0] - 0.014) < 0.006 && fabs(x[1]) < 0.006) return 0;
    return !(fabs(x[0] + 0.014) < 0.006 && fabs(x[1]) < 0.006 && fabs(x[2]) < 0.006);
}

static const shape shape_ellipsoid = {"ellipsoid",
                                      shape_ellipsoid_label,
                                      {0.030, 0.024, 0.018},
                                      4.0 / 3 * SHAPE_PI * 0.030 * 0.024 * 0.018,
                                      1,
                                      1};
static const shape shape_torus = {
    "torus", shape_torus_label, {0.030, 0.030, 0.008}, 2 * SHAPE_PI *SHAPE_PI * 0.022 * 6.4e-5, 1,
    0};
/* Each ball is cut at 14 mm from its centre: a cap of height 6 mm is missing. */
static const shape shape_balls = {
    "balls",
    shape_balls_label,
    {0.034, 0.020, 0.020},
    2 * (4.0 / 3 * SHAPE_PI * 8e-6 - SHAPE_PI * 0.006 * 0.006 * (3 * 0.020 - 0.006) / 3),
    2,
    1};
static const shape shape_sheet = {
    "sheet", shape_sheet_label, {0.030, 0.024, 0.002}, 8 * 0.030 * 0.024 * 0.002, 1, 1};
static const shape shape_holes = {"holes",
                                  shape_holes_label,
                                  {0.030, 0.024, 0.016},
                                  8 * (0.030 * 0.024 * 0.016 - 0.006 * 0.006 * 0.016 - 2.16e-7),
                                  1,
                                  1};

/* How the image lies in the world. */
typedef enum shape_frame {
    SHAPE_STRAIGHT, /* i, j, k along x, y, z */
    SHAPE_OBLIQUE,  /* turned about (1, 2, 3) by 0.6 rad */
    SHAPE_MIRRORED  /* i runs against x: a left-handed image */
} shape_frame;

/* Unit directions of i, j, k as columns. */
static inline void shape_directions(shape_frame frame, double direction[3][3]) {
    double n[3] = {0, 0, 0}, turn = frame == SHAPE_OBLIQUE ? 0.6 : 0;
    for (int a = 0; a < 3; a++) n[a] = (a + 1) / sqrt(14.0);
    double c = cos(turn), s = sin(turn);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            double across = b == (a + 1) % 3 ? -n[(a + 2) % 3] : n[(a + 1) % 3];
            direction[a][b] = n[a] * n[b] * (1 - c) + (a == b ? c : s * across);
        }
    if (frame == SHAPE_MIRRORED) direction[0][0] = -1;
}

/* A label image of any function with voxels of `spacing` along its axes, whose middle is the
 * world's origin. */
static TEST_UNUSED void shape_image_of(lar_image *image, int (*label)(const double x[3]),
                                       const int32_t size[3], const double spacing[3],
                                       shape_frame frame) {
    *image = (lar_image){.size = {size[0], size[1], size[2]}};
    image->source = lar_strdup("shape.nii");
    double direction[3][3];
    shape_directions(frame, direction);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            image->to_world[a][b] = direction[a][b] * spacing[b];
            image->to_world[a][3] -= image->to_world[a][b] * (size[b] - 1) / 2;
        }
    image->label =
        lar_calloc((size_t)size[0] * (size_t)size[1] * (size_t)size[2], sizeof *image->label);
    assert_non_null(image->label);
    uint16_t *next = image->label;
    for (int32_t k = 0; k < size[2]; k++)
        for (int32_t j = 0; j < size[1]; j++)
            for (int32_t i = 0; i < size[0]; i++) {
                double x[3];
                for (int a = 0; a < 3; a++)
                    x[a] = image->to_world[a][0] * i + image->to_world[a][1] * j +
                           image->to_world[a][2] * k + image->to_world[a][3];
                *next++ = (uint16_t)label(x);
            }
}

/* The shape in cubic voxels with at least two empty ones around it, in any frame. */
static TEST_UNUSED void shape_image(lar_image *image, const shape *body, double spacing,
                                    shape_frame frame) {
    int32_t size[3];
    double widest = fmax(body->half[0], fmax(body->half[1], body->half[2]));
    for (int a = 0; a < 3; a++) {
        double half = frame == SHAPE_OBLIQUE ? widest * 1.3 : body->half[a];
        size[a] = 2 * (int32_t)ceil(half / spacing) + 4;
    }
    double spacings[3] = {spacing, spacing, spacing};
    shape_image_of(image, body->label, size, spacings, frame);
}

/* ---- triangles ---------------------------------------------------------------------------- */

static TEST_UNUSED void shape_surface_begin(lar_triangles *triangles, int vertices, int count) {
    *triangles = (lar_triangles){.vertex_count = vertices, .triangle_count = count};
    triangles->source = lar_strdup("shape.stl");
    triangles->vertex = lar_calloc((size_t)vertices, sizeof *triangles->vertex);
    triangles->corner = lar_calloc((size_t)count, sizeof *triangles->corner);
    assert_non_null(triangles->vertex);
    assert_non_null(triangles->corner);
}

static inline void shape_triangle(lar_triangles *triangles, int t, int a, int b, int c) {
    triangles->corner[t][0] = a;
    triangles->corner[t][1] = b;
    triangles->corner[t][2] = c;
}

/* 2 n meridians and n circles of latitude with a vertex at each pole: 4 n (n - 1) triangles. */
static TEST_UNUSED void shape_ellipsoid_surface(lar_triangles *triangles, const double half[3],
                                                const double centre[3], int n) {
    int around = 2 * n, last = around * (n - 1) + 1, t = 0;
    shape_surface_begin(triangles, last + 1, 2 * around * (n - 1));
    for (int v = 0; v <= last; v++) {
        int row = (v - 1) / around + 1, column = (v - 1) % around;
        double latitude = v == 0 ? 0 : v == last ? SHAPE_PI : SHAPE_PI * row / n;
        double longitude = 2 * SHAPE_PI * column / around;
        double on[3] = {sin(latitude) * cos(longitude), sin(latitude) * sin(longitude),
                        cos(latitude)};
        for (int a = 0; a < 3; a++) triangles->vertex[v][a] = centre[a] + half[a] * on[a];
    }
    for (int column = 0; column < around; column++) {
        int next = (column + 1) % around;
        shape_triangle(triangles, t++, 0, 1 + column, 1 + next);
        for (int row = 0; row + 2 < n; row++) {
            int a = 1 + row * around + column, b = 1 + row * around + next;
            shape_triangle(triangles, t++, a, a + around, b + around);
            shape_triangle(triangles, t++, a, b + around, b);
        }
        int foot = 1 + (n - 2) * around;
        shape_triangle(triangles, t++, foot + column, last, foot + next);
    }
    assert_int_equal(t, triangles->triangle_count);
}

/* Around the z axis; n facets around the tube, 2 n along it. */
static TEST_UNUSED void shape_torus_surface(lar_triangles *triangles, double radius, double tube,
                                            const double centre[3], int n) {
    int along = 2 * n;
    shape_surface_begin(triangles, along * n, 2 * along * n);
    for (int i = 0; i < along; i++)
        for (int j = 0; j < n; j++) {
            double u = 2 * SHAPE_PI * i / along, w = 2 * SHAPE_PI * j / n;
            double *x = triangles->vertex[i * n + j];
            x[0] = centre[0] + (radius + tube * cos(w)) * cos(u);
            x[1] = centre[1] + (radius + tube * cos(w)) * sin(u);
            x[2] = centre[2] + tube * sin(w);
            int ahead = (i + 1) % along, up = (j + 1) % n, t = 2 * (i * n + j);
            shape_triangle(triangles, t, i * n + j, ahead * n + j, ahead * n + up);
            shape_triangle(triangles, t + 1, i * n + j, ahead * n + up, i * n + up);
        }
}

static TEST_UNUSED void shape_box_surface(lar_triangles *triangles, const double lower[3],
                                          const double upper[3]) {
    static const int face[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    shape_surface_begin(triangles, 8, 12);
    for (int v = 0; v < 8; v++)
        for (int a = 0; a < 3; a++) triangles->vertex[v][a] = (v >> a) & 1 ? upper[a] : lower[a];
    for (int f = 0; f < 6; f++) {
        shape_triangle(triangles, 2 * f, face[f][0], face[f][1], face[f][2]);
        shape_triangle(triangles, 2 * f + 1, face[f][0], face[f][2], face[f][3]);
    }
}

#endif
