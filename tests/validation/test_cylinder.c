/* A measured experiment: a silicone cylinder, 38 x 178 mm, clamped at one end, sagging by two
 * thirds of its length; its surface was scanned. The stiffness is not known independently: E = 78
 * kPa is what CalculiX needs to meet the scan, so this tests shape, and code against code. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "model/format/mesh_io.h"
#include "validation/reference.h"

typedef double point[3];

typedef struct surface {
    int vertices, triangles;
    point *vertex;
    int (*triangle)[3];
} surface;

/* "v x y z" and "f a/a b/b c/c" lines. */
static surface read_surface(const char *relative) {
    lar_bytes bytes;
    lar_error error;
    if (lar_bytes_read(reference_path(relative), &bytes, &error)) fail_msg("%s", error.message);
    surface s = {0, 0, lar_calloc(bytes.size / 8, sizeof *s.vertex),
                 lar_calloc(bytes.size / 8, sizeof *s.triangle)};
    assert_true(s.vertex && s.triangle);
    lar_text text = lar_text_from(&bytes);
    for (lar_span line; lar_text_line(&text, &line);) {
        lar_text part = {line.at + 1, line.at + line.length, 1};
        if (line.length < 2 || line.at[1] != ' ') continue;
        if (line.at[0] == 'v') {
            for (int i = 0; i < 3; i++)
                assert_true(lar_text_double(&part, &s.vertex[s.vertices][i]));
            s.vertices++;
        } else if (line.at[0] == 'f') {
            for (int i = 0; i < 3; i++) {
                lar_span word, head, rest;
                int64_t id;
                assert_true(lar_text_word(&part, &word));
                lar_span_split(word, '/', &head, &rest);
                assert_true(lar_span_int64(head, &id));
                s.triangle[s.triangles][i] = (int)id - 1;
            }
            s.triangles++;
        }
    }
    lar_bytes_free(&bytes);
    return s;
}

static double dot(const point a, const point b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double segment_square(const point p, const point a, const point b) {
    point ab, ap, d;
    for (int i = 0; i < 3; i++) {
        ab[i] = b[i] - a[i];
        ap[i] = p[i] - a[i];
    }
    double t = fmin(fmax(dot(ap, ab) / fmax(dot(ab, ab), DBL_MIN), 0), 1);
    for (int i = 0; i < 3; i++) d[i] = ap[i] - t * ab[i];
    return dot(d, d);
}

/* Squared distance of a point to a triangle: to its plane where the foot lies inside, otherwise to
 * its edges. */
static double triangle_square(const point p, const point a, const point b, const point c) {
    point u, v, w;
    for (int i = 0; i < 3; i++) {
        u[i] = b[i] - a[i];
        v[i] = c[i] - a[i];
        w[i] = p[i] - a[i];
    }
    double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w);
    double area = uu * vv - uv * uv;
    if (area > 0) {
        double s = (vv * uw - uv * vw) / area, t = (uu * vw - uv * uw) / area;
        if (s >= 0 && t >= 0 && s + t <= 1) {
            point d;
            for (int i = 0; i < 3; i++) d[i] = w[i] - s * u[i] - t * v[i];
            return dot(d, d);
        }
    }
    return fmin(segment_square(p, a, b), fmin(segment_square(p, b, c), segment_square(p, c, a)));
}

static double distance(const surface *s, const point p) {
    double min = DBL_MAX;
    for (int t = 0; t < s->triangles; t++) {
        const int *n = s->triangle[t];
        min = fmin(min, triangle_square(p, s->vertex[n[0]], s->vertex[n[1]], s->vertex[n[2]]));
    }
    return sqrt(min);
}

/* Mean distance of the body's boundary nodes to the measured surface; `simulation` may be NULL: the
 * body at rest. */
static double mean_distance(const lar_model *model, const lar_simulation *simulation,
                            const surface *measured) {
    const lar_mesh *mesh = &model->mesh;
    int32_t *face, faces, count = 0;
    lar_error error;
    unsigned char *seen = lar_calloc((size_t)mesh->node_count, 1);
    assert_non_null(seen);
    assert_int_equal(lar_mesh_boundary(mesh, &face, &faces, &error), LAR_OK);
    double sum = 0;
    for (int32_t f = 0; f < 4 * faces; f++) {
        int32_t node = mesh->element[face[f / 4] / 6][lar_face_node[face[f / 4] % 6][f % 4]];
        if (seen[node]) continue;
        seen[node] = 1;
        point p;
        for (int i = 0; i < 3; i++)
            p[i] = mesh->position[node][i] + (simulation ? displacement(simulation, node, i) : 0);
        sum += distance(measured, p);
        count++;
    }
    free(face);
    free(seen);
    return sum / count;
}

static lar_model *cylinder(double young) {
    lar_model *model = lar_model_create();
    lar_error error;
    assert_non_null(model);
    if (lar_mesh_read(reference_path("data/bench/silicone_cylinder/cylinder_Hexa.msh"), 1,
                      &model->mesh, &error))
        fail_msg("%s", error.message);
    lar_material *material = LAR_MODEL_APPEND(model, material);
    assert_non_null(material);
    material->density = 0.216 / 2.00581e-4; /* weighed mass over the mesh's volume */
    lar_material_from_young(material, young, 0.49);
    model->element_material = lar_calloc((size_t)model->mesh.element_count, sizeof(int32_t));
    lar_node_list clamped = {0, lar_calloc((size_t)model->mesh.node_count, sizeof(int32_t))};
    assert_true(model->element_material && clamped.node);
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        if (model->mesh.position[n][2] < 1e-3) clamped.node[clamped.count++] = n;
    assert_int_equal(clamped.count, 140);
    fix_nodes(model, clamped, LAR_AXIS_ALL);
    model->damping = 18; /* critical for the slowest bending of a bar of this size */
    model->gravity[1] = -9.81;
    model->gravity_curve[1] = add_ramp(model, 0, 0.3, 0, 1);
    return model;
}

/* Sags the cylinder; compares its tip with CalculiX (C3D8I), and gives the mean distance to the
 * measured surface [m]. */
static double sag(double young, const double tip[3], double tolerance, const surface *measured) {
    char title[64];
    lar_model *model = cylinder(young);
    lar_simulation *simulation = start(model, LAR_ELEMENT_HEX8);
    begin_report();
    run_until(simulation, 0.3);
    run_to_rest(simulation, 1e-7, 5);
    int32_t node = node_near(model, 0, 0, 0.178);
    snprintf(title, sizeof title, "silicone cylinder, %g kPa", young / 1000);
    double off = 0;
    for (int i = 0; i < 3; i++) {
        double at = model->mesh.position[node][i] + displacement(simulation, node, i);
        if (i > 0)
            report(title, "hex8", "4920 elements", i == 1 ? "tip y [m]" : "tip z [m]", tip[i], at,
                   simulation);
        off += (at - tip[i]) * (at - tip[i]);
    }
    double mean = mean_distance(model, simulation, measured);
    print_message("%s: tip %.2f mm from CalculiX, surface %.3f mm from the measured one (mean)\n",
                  title, 1e3 * sqrt(off), 1e3 * mean);
    assert_true(sqrt(off) < tolerance);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return mean;
}

static void the_cylinder_sags_as_measured(void **unused) {
    (void)unused;
    NEED_REFERENCE();
    surface measured = read_surface("data/bench/silicone_cylinder/truthCylinder-Deformed.obj");
    assert_int_equal(measured.triangles, 3440);
    lar_model *rest = cylinder(78e3);
    double before = mean_distance(rest, NULL, &measured);
    print_message("silicone cylinder at rest: surface %.3f mm from the measured one (mean)\n",
                  1e3 * before);
    assert_true(fabs(before - 36.1e-3) < 0.1e-3);
    lar_model_destroy(rest);

    double mean = sag(78e3, (double[]){-0.00055, -0.12041, 0.12675}, 3e-3, &measured);
    assert_true(mean < 1e-3);
    sag(60e3, (double[]){-0.00055, -0.13406, 0.11164}, 3e-3, &measured);
    free(measured.vertex);
    free(measured.triangle);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_cylinder_sags_as_measured)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
