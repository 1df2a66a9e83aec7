/* The closest point of a face: against a fine search, and on which side of a body a point is. */
#include "mechanics/face_contact.h"

#include "mechanics/contact.h"
#include "mechanics/face_parts.h"
#include "testing.h"

static uint32_t seed = 1;

/* Pseudo-random in [-1, 1). */
static double noise(void) {
    seed = seed * 1664525u + 1013904223u;
    return (double)seed / 2147483648.0 - 1;
}

static double apart(const double a[3], const double b[3]) {
    double square = 0;
    for (int i = 0; i < 3; i++) square += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(square);
}

static void random_face(double corner[4][3], double bend) {
    static const double flat[4][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) corner[a][i] = flat[a][i] + bend * noise();
}

/* The least distance over many points of the four triangles. */
static double searched_distance(const double x[3], const double corner[4][3]) {
    enum { FINE = 60 };
    double min = INFINITY;
    for (int t = 0; t < 4; t++)
        for (int i = 0; i <= FINE; i++)
            for (int j = 0; i + j <= FINE; j++) {
                double m = (double)i / FINE, n = (double)j / FINE, point[3];
                for (int k = 0; k < 3; k++) {
                    double middle =
                        0.25 * (corner[0][k] + corner[1][k] + corner[2][k] + corner[3][k]);
                    point[k] = m * middle + n * corner[(t + 1) % 4][k] + (1 - m - n) * corner[t][k];
                }
                min = fmin(min, apart(x, point));
            }
    return min;
}

static void the_closest_point_is_the_closest(void **unused) {
    (void)unused;
    for (int trial = 0; trial < 300; trial++) {
        double corner[4][3], x[3] = {2.5 * noise(), 2.5 * noise(), 1.5 * noise()}, point[3];
        random_face(corner, 0.3);
        lar_face_point found;
        lar_face_closest(x, (const double(*)[3])corner, 1e-9, &found);
        double sum = 0;
        for (int a = 0; a < 4; a++) {
            assert_true(found.weight[a] >= -1e-15);
            sum += found.weight[a];
        }
        assert_below(fabs(sum - 1), 1e-14);
        lar_face_mean((const double(*)[3])corner, found.weight, point);
        assert_below(fabs(apart(x, point) - found.distance), 1e-14);
        assert_below(fabs(found.distance - lar_face_distance(x, (const double(*)[3])corner)), 1e-9);
        double searched = searched_distance(x, (const double(*)[3])corner);
        assert_true(found.distance <= searched + 1e-12);
        assert_below(searched - found.distance, 0.03);
        assert_true(fabs(found.height) <= found.distance + 1e-12);
    }
}

/* Forces w_a F on the corners and -F on the point, along the line between point and face. */
static void forces_and_moments_balance(void **unused) {
    (void)unused;
    for (int trial = 0; trial < 300; trial++) {
        double corner[4][3], x[3] = {1.5 * noise(), 1.5 * noise(), noise()}, point[3];
        random_face(corner, 0.3);
        lar_face_point found;
        lar_face_closest(x, (const double(*)[3])corner, 1e-9, &found);
        lar_face_mean((const double(*)[3])corner, found.weight, point);
        double force[3], sum[3], moment[3] = {0}, size = 0;
        for (int i = 0; i < 3; i++) {
            sum[i] = force[i] = (point[i] - x[i]) / found.distance;
            size += fabs(force[i]);
        }
        for (int i = 0; i < 3; i++) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            moment[i] = x[j] * force[k] - x[k] * force[j];
            for (int a = 0; a < 4; a++)
                moment[i] -= found.weight[a] * (corner[a][j] * force[k] - corner[a][k] * force[j]);
        }
        for (int a = 0; a < 4; a++)
            for (int i = 0; i < 3; i++) sum[i] -= found.weight[a] * force[i];
        for (int i = 0; i < 3; i++) {
            assert_below(fabs(sum[i]), 1e-14 * size);
            assert_below(fabs(moment[i]), 1e-13 * size);
        }
    }
}

/* The faces of a cube of edge 2 around the origin, sheared by s so that edges are sharp. */
static void cube_face(int f, double s, double corner[4][3]) {
    static const int at[6][4][3] = {{{-1, -1, -1}, {-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}},
                                    {{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}},
                                    {{-1, -1, -1}, {1, -1, -1}, {1, -1, 1}, {-1, -1, 1}},
                                    {{-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}},
                                    {{-1, -1, -1}, {-1, 1, -1}, {1, 1, -1}, {1, -1, -1}},
                                    {{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};
    for (int a = 0; a < 4; a++) {
        for (int i = 0; i < 3; i++) corner[a][i] = at[f][a][i];
        corner[a][0] += s * corner[a][2];
    }
}

/* Where several faces are equally close, at edges and corners, the choice between them has the
 * sign of the whole body right. */
static void inside_is_inside_also_at_edges(void **unused) {
    (void)unused;
    static const double shear[] = {0, 1, 2.5};
    for (int k = 0; k < 3; k++)
        for (int trial = 0; trial < 20000; trial++) {
            double x[3] = {1.3 * noise(), 1.3 * noise(), 1.3 * noise()}, corner[4][3];
            if (trial % 4 == 0) x[1] = x[1] > 0 ? 1.05 : -1.05; /* beside an edge */
            bool inside = fabs(x[0]) < 1 && fabs(x[1]) < 1 && fabs(x[2]) < 1;
            x[0] += shear[k] * x[2];
            lar_face_point face[6];
            double min = INFINITY;
            for (int f = 0; f < 6; f++) {
                cube_face(f, shear[k], corner);
                lar_face_closest(x, (const double(*)[3])corner, 1e-9, &face[f]);
                min = fmin(min, face[f].distance);
            }
            int chosen = -1;
            for (int f = 0; f < 6; f++)
                if (face[f].distance <= min + 1e-9 &&
                    (chosen < 0 || lar_face_point_before(&face[f], &face[chosen])))
                    chosen = f;
            if (min > 1e-6) assert_true((face[chosen].height < 0) == inside);
        }
}

/* How often the surface of a body winds around x: the solid angles of its triangles (van Oosterom,
 * Strackee 1983). */
static double winding(const double x[3], const double corner[6][4][3]) {
    double sum = 0;
    for (int k = 0; k < 24; k++) {
        const double(*c)[3] = corner[k / 4];
        double r[3][3], length[3], dot[3] = {0}, volume = 0;
        for (int i = 0; i < 3; i++) {
            r[0][i] = c[k % 4][i] - x[i];
            r[1][i] = c[(k + 1) % 4][i] - x[i];
            r[2][i] = 0.25 * ((c[0][i] + c[1][i]) + (c[2][i] + c[3][i])) - x[i];
        }
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3;
            length[a] = sqrt(r[a][0] * r[a][0] + r[a][1] * r[a][1] + r[a][2] * r[a][2]);
            for (int i = 0; i < 3; i++) dot[a] += r[a][i] * r[b][i];
            volume += r[0][a] * (r[1][b] * r[2][3 - a - b] - r[1][3 - a - b] * r[2][b]);
        }
        double below = length[0] * length[1] * length[2] + dot[0] * length[2] + dot[1] * length[0] +
                       dot[2] * length[1];
        sum += atan2(volume, below) / (2 * 3.14159265358979323846);
    }
    return sum;
}

/* Uneven cubes, drawn out and sheared into spikes: at their corners some edges turn in beside
 * others that turn out. A plane at such a corner may have the point far on its wrong side, although
 * it is not next to it. */
static void inside_is_inside_also_at_dented_corners(void **unused) {
    (void)unused;
    int at_corners = 0;
    for (int trial = 0; trial < 40000; trial++) {
        double node[8][3], corner[6][4][3], x[3], min = INFINITY;
        for (int n = 0; n < 8; n++)
            for (int i = 0; i < 3; i++) node[n][i] = (n >> i & 1 ? 1 : -1) + 0.6 * noise();
        for (int i = 0; i < 3; i++) {
            double tilt = 2.5 * noise(), slide = 2.5 * noise();
            for (int n = 0; n < 8; n++)
                node[n][i] += tilt * node[n][(i + 1) % 3] + slide * node[n][(i + 2) % 3];
        }
        for (int i = 0; i < 3; i++) x[i] = node[trial % 8][i] + 1.5 * noise();
        lar_face_point face[6];
        for (int f = 0; f < 6; f++) {
            cube_face(f, 0, corner[f]);
            for (int a = 0; a < 4; a++) {
                double *c = corner[f][a];
                memcpy(c, node[(c[0] > 0) + 2 * (c[1] > 0) + 4 * (c[2] > 0)], sizeof corner[f][a]);
            }
            lar_face_closest(x, (const double(*)[3])corner[f], 1e-9, &face[f]);
            min = fmin(min, face[f].distance);
        }
        int chosen = -1;
        for (int f = 0; f < 6; f++)
            if (face[f].distance <= min + 1e-9 &&
                (chosen < 0 || lar_face_point_before(&face[f], &face[chosen])))
                chosen = f;
        double around = winding(x, (const double(*)[4][3])corner);
        if (min < 1e-6) continue;
        at_corners += face[chosen].toward < -LAR_TOWARD_TIE;
        assert_true((face[chosen].height < 0) == (around > 0.5));
    }
    assert_true(at_corners > 2000);
}

/* A step of each of five places, half of what they may move against each other, along the corners
 * of a cube within that ball: the worst is where all go as far as they may. */
static void who_is_before_a_face_stays_so(void **unused) {
    (void)unused;
    int before = 0, behind = 0;
    for (int trial = 0; trial < 20000; trial++) {
        double corner[4][3], x[3] = {1.5 * noise(), 1.5 * noise(), 1.5 * noise()};
        double bend = 0.5 + 0.5 * noise(), least = INFINITY;
        random_face(corner, bend);
        double may = lar_face_before(x, (const double(*)[3])corner);
        before += may > 0.1;
        for (int k = 0; k < 20; k++) {
            double moved[4][3], to[3], step = 0.5 * may / sqrt(3);
            lar_face_point found;
            for (int i = 0; i < 3; i++) {
                to[i] = x[i] + (noise() < 0 ? -step : step);
                for (int a = 0; a < 4; a++)
                    moved[a][i] = corner[a][i] + (noise() < 0 ? -step : step);
            }
            lar_face_closest(to, (const double(*)[3])moved, 1e-9, &found);
            least = fmin(least, found.height);
        }
        if (may > 0) assert_true(least >= 0);
        behind += may == 0;
    }
    assert_true(before > 1000 && behind > 1000);
    double flat[4][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    double over = lar_face_before((double[]){0, 0, 1}, (const double(*)[3])flat);
    assert_true(over > 0.15 && over < 1);
    assert_true(lar_face_before((double[]){0, 0, -1}, (const double(*)[3])flat) == 0);
    assert_true(lar_face_before((double[]){0, 0, NAN}, (const double(*)[3])flat) == 0);
}

static void what_has_no_size_makes_no_trouble(void **unused) {
    (void)unused;
    double corner[4][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    lar_face_point found;
    lar_face_closest((double[]){0, 3, 4}, (const double(*)[3])corner, 0, &found);
    assert_below(fabs(found.distance - 5), 1e-15);
    assert_true(found.height == 0);
    corner[1][0] = corner[2][0] = 1; /* a line */
    lar_face_closest((double[]){0.5, 0, 2}, (const double(*)[3])corner, 0, &found);
    assert_below(fabs(found.distance - 2), 1e-15);
    corner[0][0] = NAN;
    lar_face_closest((double[]){0.5, 0, 2}, (const double(*)[3])corner, 0, &found);
    assert_false(found.height < 0);
}

/* Bent, flat, of one point, with corners or edges that coincide. */
static void any_face(int kind, double corner[4][3]) {
    random_face(corner, kind % 3 ? 0.5 : 0);
    if (kind % 7 == 1) memcpy(corner[1], corner[0], sizeof corner[1]);
    if (kind % 7 == 2) memcpy(corner[2], corner[0], sizeof corner[2]);
    if (kind % 7 == 3)
        for (int a = 1; a < 4; a++) memcpy(corner[a], corner[0], sizeof corner[a]);
    if (kind % 7 == 4)
        for (int a = 0; a < 4; a++) corner[a][1] = corner[a][0];
}

/* Anywhere, at a corner, on an edge, in the middle, on a triangle. */
static void any_place(int kind, const double corner[4][3], const double middle[3], double x[3]) {
    double m = fabs(noise()), n = (1 - m) * fabs(noise());
    for (int i = 0; i < 3; i++) {
        double a = corner[kind % 4][i], b = corner[(kind + 1) % 4][i];
        const double place[5] = {2 * noise(), a, 0.5 * a + 0.5 * b, middle[i],
                                 m * a + n * b + (1 - m - n) * middle[i]};
        x[i] = place[kind % 5];
    }
}

/* One by one or in lanes: the same bits, 0 and -0 apart. */
static void the_widest_has_the_same_bits(void **unused) {
    (void)unused;
    const lar_face_finders here = lar_face_finders_here();
    if (here.parts == lar_face_parts_one_by_one) skip();
    for (int n = 0; n < 200000; n++) {
        double corner[4][3], middle[3], x[3];
        lar_face_parts one, wide;
        any_face(n, corner);
        lar_face_mean((const double(*)[3])corner, (const double[4]){0.25, 0.25, 0.25, 0.25},
                      middle);
        any_place(n / 7, (const double(*)[3])corner, middle, x);
        lar_face_parts_one_by_one(x, (const double(*)[3])corner, middle, &one);
        here.parts(x, (const double(*)[3])corner, middle, &wide);
        for (int t = 0; t < 4; t++) {
            assert_true(one.distance[t] == wide.distance[t]);
            assert_true(one.height[t] == wide.height[t]);
            for (int a = 0; a < 4; a++) assert_true(one.weight[t][a] == wide.weight[t][a]);
        }
        assert_true(lar_face_before_one_by_one(x, (const double(*)[3])corner, middle) ==
                    here.before(x, (const double(*)[3])corner, middle));
    }
}

static void assert_same(double a, double b) {
    assert_true(a == b || (isnan(a) && isnan(b)));
}

/* Segments from anywhere to anywhere, points among them, and now and then no number. */
static void any_segment(int n, double corner[4][3], lar_segment *segment) {
    double middle[3];
    lar_face_mean((const double(*)[3])corner, (const double[4]){0.25, 0.25, 0.25, 0.25}, middle);
    any_place(n / 7, (const double(*)[3])corner, middle, segment->end[0]);
    any_place(n / 35, (const double(*)[3])corner, middle, segment->end[1]);
    if (n % 11 == 0) memcpy(segment->end[1], segment->end[0], sizeof segment->end[1]);
    if (n % 101 == 0) corner[n % 4][n % 3] = n % 2 ? NAN : INFINITY;
    if (n % 103 == 0) segment->end[n % 2][n % 3] = n % 4 ? NAN : INFINITY;
}

static void segments_have_the_same_bits(void **unused) {
    (void)unused;
    const lar_face_finders here = lar_face_finders_here();
    if (here.segment == lar_face_segment_one_by_one) skip();
    int through = 0;
    for (int n = 0; n < 200000; n++) {
        double corner[4][3], middle[3];
        lar_segment segment;
        lar_face_segment one[4], wide[4];
        any_face(n, corner);
        any_segment(n, corner, &segment);
        lar_face_mean((const double(*)[3])corner, (const double[4]){0.25, 0.25, 0.25, 0.25},
                      middle);
        double reach = fabs(noise());
        assert_same(
            lar_face_segment_one_by_one(&segment, (const double(*)[3])corner, middle, reach, one),
            here.segment(&segment, (const double(*)[3])corner, middle, reach, wide));
        for (int t = 0; t < 4; t++) {
            assert_same(one[t].distance, wide[t].distance);
            assert_same(one[t].along, wide[t].along);
            for (int a = 0; a < 4; a++) assert_same(one[t].weight[a], wide[t].weight[a]);
            for (int i = 0; i < 3; i++) assert_same(one[t].normal[i], wide[t].normal[i]);
            through += one[t].distance < 1e-12 && one[t].along > 0 && one[t].along < 1;
        }
    }
    assert_true(through > 1000);
}

/* A segment that lies along a face, its edges or its diagonals turns by next to nothing: no point
 * of the face at which it pushes moves by more. */
static void points_beside_a_segment_do_not_jump(void **unused) {
    (void)unused;
    static const double square[4][3] = {{0, 0, 0}, {0.01, 0, 0}, {0.01, 0.01, 0}, {0, 0.01, 0}};
    double most = 0;
    for (int n = 0; n < 3000; n++) {
        double angle = n % 3 == 0 ? 0 : n % 3 == 1 ? atan(1) : 3 * noise();
        double x = 0.005 * (n % 4), reach = 0.0015 + 0.006 * fabs(noise());
        double high = reach * fabs(noise()), turned = 1e-7 * noise(), least = 0;
        lar_face_segment at[2][4];
        for (int k = 0; k < 2; k++) {
            double tilt = k == 0 ? turned : -turned, c = 0.05 * cos(angle), s = 0.05 * sin(angle);
            lar_segment segment = {{{x - s + tilt * c, 0.005 - c - tilt * s, high - 0.05 * tilt},
                                    {x + s - tilt * c, 0.005 + c + tilt * s, high + 0.05 * tilt}}};
            least = lar_face_segment_closest(&segment, square, reach, at[k]);
        }
        for (int t = 0; t < 4; t++) {
            assert_true(at[1][t].distance >= least - 1e-12);
            if (at[0][t].distance < reach)
                for (int a = 0; a < 4; a++)
                    most = fmax(most, (reach - at[0][t].distance) / reach *
                                          fabs(at[1][t].weight[a] - at[0][t].weight[a]));
        }
    }
    print_message("no weight of a point moves by more than %.1e\n", most);
    assert_below(most, 1e-5);
}

static void grids_have_the_same_bits(void **unused) {
    (void)unused;
    const lar_face_finders here = lar_face_finders_here();
    if (here.grid == lar_face_grid_one_by_one) skip();
    int seen = 0;
    for (int n = 0; n < 100000; n++) {
        double corner[4][3], within = fabs(noise());
        lar_segment segment;
        lar_face_near one, wide;
        lar_face_grid grid = {.count = n % LAR_FACE_GRID_MAX + 1};
        for (int i = 0; i < LAR_FACE_GRID_MAX; i++) {
            double weight[4];
            if (i < grid.count) lar_face_weights(noise(), noise(), weight);
            for (int a = 0; a < 4; a++) grid.weight[a][i] = weight[a];
        }
        any_face(n, corner);
        any_segment(n, corner, &segment);
        lar_face_grid_one_by_one(&segment, (const double(*)[3])corner, &grid, within, &one);
        here.grid(&segment, (const double(*)[3])corner, &grid, within, &wide);
        assert_true(one.points == wide.points && one.least == wide.least);
        for (int p = 0; p < grid.count; p++) {
            if (!(one.points >> p & 1)) continue;
            assert_true(one.square[p] == wide.square[p] && one.along[p] == wide.along[p]);
            for (int i = 0; i < 3; i++) assert_true(one.away[i][p] == wide.away[i][p]);
        }
        seen += one.points != 0;
    }
    assert_true(seen > 1000);
}

/* Over a flat row of two squares, one corner row on a sharp edge: no kink from face to face, nor
 * between triangles, and the slope is that of the number. */
static void springs_fade_without_kinks(void **unused) {
    (void)unused;
    static const double blunt[2][4] = {{0, 0.2, 1, 1}, {0.2, 0, 0.7, 1}}, ahead = 1e-6;
    double worst = 0;
    for (int trial = 0; trial < 2000; trial++) {
        double y = 0.5 + 0.49 * noise(), x = trial % 2 ? 1 : 1 + 0.98 * noise(), part[3],
               slope[2] = {0};
        for (int k = 0; k < 3; k++) {
            double point[3] = {x + (k == 1) * ahead, y + (k == 2) * ahead, -0.01}, change[5];
            double corner[4][3] = {{0}}, value[5], by[5][3];
            int face = point[0] > 1;
            for (int a = 0; a < 4; a++) {
                corner[a][0] = face + (a == 1 || a == 2);
                corner[a][1] = a >= 2;
            }
            lar_face_point found;
            lar_face_closest(point, (const double(*)[3])corner, 1e-9, &found);
            part[k] = lar_face_firmness(found.weight, blunt[face], change);
            memcpy(value, change, sizeof value);
            lar_face_slope(point, (const double(*)[3])corner, &found, value, by);
            for (int i = 0; i < 2 && k == 0; i++) slope[i] = by[4][i];
        }
        assert_true(part[0] >= 0 && part[0] <= 1);
        for (int i = 0; i < 2; i++)
            worst = fmax(worst, fabs((part[1 + i] - part[0]) / ahead - slope[i]));
    }
    assert_below(worst, 1e-4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_closest_point_is_the_closest),
        cmocka_unit_test(forces_and_moments_balance),
        cmocka_unit_test(inside_is_inside_also_at_edges),
        cmocka_unit_test(inside_is_inside_also_at_dented_corners),
        cmocka_unit_test(who_is_before_a_face_stays_so),
        cmocka_unit_test(what_has_no_size_makes_no_trouble),
        cmocka_unit_test(springs_fade_without_kinks),
        cmocka_unit_test(the_widest_has_the_same_bits),
        cmocka_unit_test(segments_have_the_same_bits),
        cmocka_unit_test(points_beside_a_segment_do_not_jump),
        cmocka_unit_test(grids_have_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
