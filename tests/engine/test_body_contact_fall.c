/* Round bodies that fall on each other stay outside each other, with every step. */
#include "engine/body_contact_test.h"
#include "engine/tool_contact_test.h"
#include "mechanics/face_contact.h"

static const brick ball = {{6, 6, 6}, 0.01, 0, LAR_LAW_neo_hookean, 4e3, 4e4, 1000};

/* Two balls, the upper one flying down beside the middle of the lower one, whose lowest nodes are
 * fixed. Returns the upper one's first node. */
static lar_model *two_balls(double speed, int32_t *first) {
    static const double radius = 0.03, gap = 0.002;
    lar_model *model = empty_model(&ball);
    add_brick(model, &ball, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    *first = add_brick(model, &ball, (double[]){0, 0, 0});
    for (int32_t n = 0; n < model->mesh.node_count; n++) {
        double *x = model->mesh.position[n], c[3];
        for (int i = 0; i < 3; i++) c[i] = x[i] / radius - 1;
        for (int i = 0; i < 3; i++) {
            double a = c[(i + 1) % 3], b = c[(i + 2) % 3];
            x[i] = radius * c[i] * sqrt(1 - a * a / 2 - b * b / 2 + a * a * b * b / 3);
        }
        if (n < *first) continue;
        x[0] += 0.3 * radius;
        x[2] += 2 * radius + gap;
    }
    fix_nodes(model, brick_side(&ball, 2, 0), LAR_AXIS_ALL);
    touch_between(model, split);
    throw_nodes(model, *first, model->mesh.node_count, (double[]){0, 0, -speed});
    memcpy(model->gravity, (double[]){0, 0, -9.81}, 24);
    model->damping = 5;
    return model;
}

/* The solid angle of a triangle, as seen from x. */
static double solid_angle(const double x[3], const double *const corner[3]) {
    double r[3][3], length[3], dot[3];
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) r[k][i] = corner[k][i] - x[i];
        length[k] = sqrt(r[k][0] * r[k][0] + r[k][1] * r[k][1] + r[k][2] * r[k][2]);
    }
    for (int k = 0; k < 3; k++) {
        const double *a = r[(k + 1) % 3], *b = r[(k + 2) % 3];
        dot[k] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }
    double volume = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        volume += r[0][i] * (r[1][j] * r[2][k] - r[1][k] * r[2][j]);
    }
    return 2 * atan2(volume, length[0] * length[1] * length[2] + dot[0] * length[0] +
                                 dot[1] * length[1] + dot[2] * length[2]);
}

/* How deep a point is inside the body with these faces; 0 outside. */
static double depth_in(const double x[3], const double (*place)[3], const lar_mesh *mesh,
                       const int32_t *face, int32_t count) {
    static const double PI = 3.14159265358979323846;
    static const double even[4] = {0.25, 0.25, 0.25, 0.25};
    double angle = 0, min = INFINITY;
    for (int32_t f = 0; f < count; f++) {
        double corner[4][3], middle[3];
        for (int a = 0; a < 4; a++)
            memcpy(corner[a], place[mesh->element[face[f] / 6][lar_face_node[face[f] % 6][a]]], 24);
        lar_face_mean((const double(*)[3])corner, even, middle);
        for (int a = 0; a < 4; a++)
            angle +=
                solid_angle(x, (const double *const[]){corner[a], corner[(a + 1) % 4], middle});
        min = fmin(min, lar_face_distance(x, (const double(*)[3])corner));
    }
    return angle > 2 * PI ? min : 0;
}

/* What the surface nodes of one body lie inside the other, times their part of the surface, as a
 * part of the volume of a ball. */
static double overlap(const lar_simulation *s, double (*place)[3], int32_t first) {
    static const double radius = 0.03;
    const lar_model *model = s->domain.model;
    const lar_mesh *mesh = &model->mesh;
    int32_t half = mesh->element_count / 2, count[2], *face[2], nodes = 0;
    double sum = 0;
    lar_simulation_displacements(s, place);
    for (int32_t n = 0; n < mesh->node_count; n++)
        for (int i = 0; i < 3; i++) place[n][i] += mesh->position[n][i];
    face[0] = outer_faces(model, 0, half, &count[0]);
    face[1] = outer_faces(model, half, mesh->element_count, &count[1]);
    for (int32_t n = 0; n < mesh->node_count; n++) {
        if (model->surface.index_of[n] < 0) continue;
        int other = n < first;
        nodes++;
        sum += depth_in(place[n], (const double(*)[3])place, mesh, face[other], count[other]);
    }
    free(face[0]);
    free(face[1]);
    /* 4 pi r^2 for the nodes of each of the two, of 4/3 pi r^3. */
    return 2 * sum / nodes * 3 / radius;
}

static void what_falls_stays_outside(void **unused) {
    (void)unused;
    static const double parts[] = {0.8, 0.4, 0.2};
    for (int k = 0; k < 3; k++) {
        int32_t first;
        lar_model *model = two_balls(1, &first);
        lar_options options = lar_options_default();
        options.time_step = parts[k] * stable_step_of(model);
        lar_simulation *s = start_with(model, options);
        double(*place)[3] = lar_calloc((size_t)model->mesh.node_count, sizeof *place);
        double max = 0, fastest = 0;
        while (lar_simulation_time(s) < 0.06) {
            advance(s, (uint64_t)(0.002 / options.time_step));
            max = fmax(max, overlap(s, place, first));
            for (int32_t n = 0; n < model->mesh.node_count; n++)
                for (int i = 0; i < 3; i++) fastest = fmax(fastest, fabs(node_v(s, n)[i]));
        }
        print_message("%.1f of the stable step: %.3f %% of a ball inside the other at most, nodes "
                      "at most %.2f m/s\n",
                      parts[k], 100 * max, fastest);
        assert_below(max, 1e-3);
        assert_below(fastest, 2.5);
        free(place);
        finish(s, model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_falls_stays_outside)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
