/* A tool before one face of the surface, flat or crumpled: what lies before it is kept outside,
 * what has been passed is let go. */
#include <math.h>
#include <string.h>

#include "contact/tool_contact_face.h"
#include "testing.h"

static const double RADIUS = 1.5e-3;

/* A face alone: its corners, each of a gram and at rest, and the weights of its points. */
typedef struct lone_face {
    lar_tool_contact_face face;
    lar_tool_body body;
    lar_point_weights weights;
    double mass[4];
} lone_face;

static void make(const double corner[4][3], lone_face *f) {
    *f = (lone_face){.face = {.node = {0, 1, 2, 3}, .edge = 0.02, .wall = 0.2, .body = -1},
                     .body = {.count = 1}};
    for (int a = 0; a < 4; a++) {
        f->face.share[a] = 1;
        f->mass[a] = 1e-3;
        memcpy(f->face.rest[a], corner[a], sizeof f->face.rest[a]);
    }
    for (int n = 2; n <= LAR_POINTS_ALONG_EDGE; n++) lar_tool_contact_grid(n, &f->weights.of[n]);
}

/* How the face is pushed by a line from `tip` to `end`, along a unit direction [N]. */
static double pushed(lone_face *f, const double tip[3], const double end[3],
                     const double direction[3]) {
    const lar_contact_law law = {.stiffness = 1e6};
    lar_tool_contact_patch patch = {.face = &f->face,
                                    .body = &f->body,
                                    .radius = RADIUS,
                                    .rate_of = 1e4,
                                    .hard = 1,
                                    .closest = INFINITY};
    memcpy(f->body.now[0].end[0], tip, sizeof f->body.now[0].end[0]);
    memcpy(f->body.now[0].end[1], end, sizeof f->body.now[0].end[1]);
    f->body.next[0] = f->body.now[0];
    memcpy(patch.x, f->face.rest, sizeof patch.x);
    lar_tool_contact_push_face(&patch, &law, f->mass, &f->weights);
    double sum = 0;
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) sum += patch.force[i][a] * direction[i];
    return sum;
}

static void a_flat_face_is_pushed_from_outside_only(void **unused) {
    (void)unused;
    static const double corner[4][3] = {{0, 0, 0}, {0.02, 0, 0}, {0.02, 0.02, 0}, {0, 0.02, 0}};
    static const double down[3] = {0, 0, -1};
    lone_face f;
    make(corner, &f);
    for (int k = 1; k < 8; k++) { /* deeper than where the wall begins */
        double height = 0.1 * k * RADIUS;
        const double above[3] = {0.007, 0.008, height}, far[3] = {0.007, 0.008, 0.02};
        const double below[3] = {0.007, 0.008, -height}, deep[3] = {0.007, 0.008, -0.02};
        assert_true(pushed(&f, above, far, down) > 0);
        assert_true(pushed(&f, below, deep, down) == 0);
    }
}

/* A crease of a pancreas of 300 elements, on closed jaws that a hand draws out of it, two steps
 * before it let them in (random session 66068): the faces' corners are 20 mm apart, the middle is
 * far from the plane of any three. Before, the whole face's normal counted. */
static void a_crumpled_face_keeps_out_what_is_before_it(void **unused) {
    (void)unused;
    static const double corner[4][3] = {{-7.24e-3, 13.56e-3, 15.37e-3},
                                        {-14.02e-3, 21.42e-3, 4.79e-3},
                                        {-19.01e-3, 4.12e-3, 17.68e-3},
                                        {-5.37e-3, 13.42e-3, 9.37e-3}};
    static const double tip[3] = {0}, end[3] = {-8.29e-3, 12.88e-3, 12.86e-3};
    lone_face f;
    make(corner, &f);
    /* Along the line: away from what comes from the tip. */
    double way[3], length = sqrt(end[0] * end[0] + end[1] * end[1] + end[2] * end[2]);
    for (int i = 0; i < 3; i++) way[i] = end[i] / length;
    double force = pushed(&f, tip, end, way);
    print_message("a crumpled face: pushed with %.3g N\n", force);
    assert_true(force > 0);
    /* The wall of the face pushes, as deep as the jaw is: stiffness times its mass, a share of it.
     */
    assert_true(force > 0.1 * 1e6 * 1e-3 * 0.5 * RADIUS);
}

/* A face folded around a sphere along a diagonal: as the sphere goes from the one side of the fold
 * to the other, what pushes it across goes through nothing, without a jump. */
static void a_folded_face_pushes_evenly(void **unused) {
    (void)unused;
    static const double corner[4][3] = {
        {0, 0, 0}, {0.02, 0, 0.014}, {0.02, 0.02, 0}, {0, 0.02, 0.014}};
    static const double across[3] = {0.70710678118654752, -0.70710678118654752, 0},
                        down[3] = {0, 0, -1};
    lone_face f;
    make(corner, &f);
    double before = 0, jump = 0, push = 0;
    for (int k = -100; k <= 100; k++) {
        double to = 1e-6 * k; /* [m] */
        const double at[3] = {0.007 + to * across[0], 0.007 + to * across[1], 0.0059};
        double now = pushed(&f, at, at, across);
        if (k > -100) jump = fmax(jump, fabs(now - before));
        if (k == 0) push = pushed(&f, at, at, down);
        before = now;
    }
    print_message("a folded face: %.3g N down, in a micrometre at most %.2g N across\n", push,
                  jump);
    assert_true(push > 0.1);
    assert_below(jump, 0.01 * push);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flat_face_is_pushed_from_outside_only),
        cmocka_unit_test(a_crumpled_face_keeps_out_what_is_before_it),
        cmocka_unit_test(a_folded_face_pushes_evenly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
