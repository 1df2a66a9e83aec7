/* Directions of fibres by potentials and depth (scene_fibre_rule.c): against closed forms on a
 * piece of a pipe, their bits, and what is said where there can be none. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>

#include "base/hash.h"
#include "base/vector.h"
#include "brick.h"
#include "model/scene/scene.h"

/* ---- a piece of a pipe ---------------------------------------------------------------------- */

/* Elements along the radius, around and along z: r from 20 to 30 mm, 1.5 rad, 30 mm. Face sets
 * "inner", "outer", "start", "end", "low", "high"; "below" and "above" are the part of the last two
 * that is nearest to the start. "fine.vtu" has twice as many elements each way, "parts.vtu" nothing
 * that connects its lower with its upper half, "long.vtu" 60 around, "thin.vtu" one across and
 * "bent.vtu" places that are made by + - * alone. */
static int cells[3], across[3];
static bool apart, bent;

static int pipe_node(int i, int j, int k) {
    return i + across[0] * (j + across[1] * k);
}

static void pipe_sizes(const char *path) {
    const int coarse[3] = {4, 12, 4};
    int times = strstr(path, "fine.vtu") ? 2 : 1;
    apart = strstr(path, "parts.vtu") != NULL;
    bent = strstr(path, "bent.vtu") != NULL;
    for (int i = 0; i < 3; i++) cells[i] = times * coarse[i];
    if (strstr(path, "long.vtu")) cells[0] = cells[2] = 2, cells[1] = 60;
    if (strstr(path, "thin.vtu")) cells[0] = cells[2] = 1;
    for (int i = 0; i < 3; i++) across[i] = cells[i] + 1;
    across[2] += apart;
}

static void pipe_place(int i, int j, int k, double scale, double place[3]) {
    double u = (double)i / cells[0], v = (double)j / cells[1];
    double w = (double)(k - (apart && k > cells[2] / 2)) / cells[2];
    double r = 0.02 + 0.01 * u, angle = cells[1] == 60 ? 6 * v : 1.5 * v;
    place[0] = bent ? 0.01 * (u + v * v) : r * cos(angle);
    place[1] = bent ? 0.03 * (v + 0.2 * u * w) : r * sin(angle);
    place[2] = bent ? 0.02 * (w + 0.1 * u * v) : 0.03 * w;
    for (int axis = 0; axis < 3; axis++) place[axis] *= scale;
}

/* The faces at one end of an axis, all or those with j = 0. */
static lar_status pipe_set(lar_mesh *mesh, const char *name, int side, bool first,
                           lar_error *error) {
    int32_t *index = lar_calloc((size_t)mesh->element_count, sizeof *index), count = 0;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        const int at[3] = {e % cells[0], e / cells[0] % cells[1], e / cells[0] / cells[1]};
        bool there = at[side / 2] == (side % 2 ? cells[side / 2] - 1 : 0);
        if (there && (!first || at[1] == 0)) index[count++] = 6 * e + side;
    }
    return lar_mesh_add_set(mesh, name, LAR_SET_FACES, index, count, error);
}

static lar_status pipe_read(const char *path, double scale, lar_mesh *mesh, lar_error *error) {
    static const char *const names[] = {"inner", "outer", "start", "end", "low", "high"};
    if (strstr(path, "brick.vtu")) return brick_read(path, scale, mesh, error);
    pipe_sizes(path);
    size_t nodes = (size_t)(across[0] * across[1] * across[2]);
    size_t elements = (size_t)(cells[0] * cells[1] * cells[2]);
    lar_status status = lar_mesh_allocate(mesh, path, nodes, elements, error);
    if (status) return status;
    mesh->node_count = (int32_t)nodes;
    mesh->element_count = (int32_t)elements;
    for (int32_t n = 0; n < mesh->node_count; n++) {
        pipe_place(n % across[0], n / across[0] % across[1], n / across[0] / across[1], scale,
                   mesh->position[n]);
        mesh->node_id[n] = n + 1;
    }
    for (int32_t e = 0; e < mesh->element_count; e++) {
        int i = e % cells[0], j = e / cells[0] % cells[1], k = e / cells[0] / cells[1];
        k += apart && k >= cells[2] / 2;
        for (int a = 0; a < 8; a++)
            mesh->element[e][a] =
                pipe_node(i + (lar_node_sign[a][0] > 0), j + (lar_node_sign[a][1] > 0),
                          k + (lar_node_sign[a][2] > 0));
        mesh->element_id[e] = e + 1;
    }
    for (int side = 0; side < 6 && !status; side++)
        status = pipe_set(mesh, names[side], side, false, error);
    if (!status) status = pipe_set(mesh, "below", 4, true, error);
    return status ? status : pipe_set(mesh, "above", 5, true, error);
}

#define SCENE(mesh, direction)                                                                     \
    "lariat: 1\nmesh: " mesh                                                                       \
    "\nmaterials:\n  - {cells: all, law: yeoh, density: 1000, shear_modulus: 1e3, bulk_modulus: "  \
    "1e5, fibres: {active: {along: 1}, direction: {" direction "}}}\n"

static lar_status parse(const char *text, lar_model **model, lar_error *error) {
    lar_bytes bytes = {(unsigned char *)lar_strdup(text), strlen(text)};
    lar_status status = lar_scene_parse_with("s.yaml", &bytes, pipe_read, model, error);
    lar_bytes_free(&bytes);
    return status;
}

static lar_model *scene(const char *text) {
    lar_model *model = NULL;
    lar_error error = {0};
    if (parse(text, &model, &error)) fail_msg("%s", error.message);
    return model;
}

/* The centre of an element: its distance from the z axis, the unit vectors along that and around.
 */
static double polar(const lar_model *model, int32_t e, double out[3], double around[3]) {
    double corner[8][3], radius;
    memset(out, 0, 3 * sizeof *out);
    lar_mesh_corners(&model->mesh, e, corner);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 2; i++) out[i] += corner[a][i] / 8;
    radius = lar_length(out);
    for (int i = 0; i < 2; i++) out[i] /= radius;
    lar_cross((const double[3]){0, 0, 1}, out, around);
    return radius;
}

/* Sine of the angle between the fibre of an element and another direction; no matter which way. */
static double askew(const lar_model *model, int32_t e, const double wanted[3]) {
    double cross[3];
    lar_cross(lar_model_fibre(model, e), wanted, cross);
    return lar_length(cross);
}

#define BELOW(x, y) assert_true((x) < (y))

/* ---- closed forms --------------------------------------------------------------------------- */

/* Between the ends of a pipe they run around it, exactly so by its symmetry; between the inside and
 * the outside out of it; from below to above along z, to the last digits. */
static void a_path_follows_the_pipe(void **state) {
    (void)state;
    static const double up[3] = {0, 0, 1};
    double out[3], around[3];
    lar_model *model = scene(SCENE("pipe.vtu", "path: {from: start, to: end}"));
    for (int32_t e = 0; e < model->mesh.element_count; e++) {
        polar(model, e, out, around);
        BELOW(askew(model, e, around), 1e-9);
        assert_true(lar_dot(lar_model_fibre(model, e), around) > 0);
    }
    lar_model_destroy(model);
    model = scene(SCENE("pipe.vtu", "path: {from: outer, to: inner}"));
    for (int32_t e = 0; e < model->mesh.element_count; e++) {
        polar(model, e, out, around);
        BELOW(askew(model, e, out), 1e-9);
        assert_true(lar_dot(lar_model_fibre(model, e), out) < 0);
    }
    lar_model_destroy(model);
    model = scene(SCENE("pipe.vtu", "path: {from: low, to: high}"));
    for (int32_t e = 0; e < model->mesh.element_count; e++) BELOW(askew(model, e, up), 1e-9);
    lar_model_destroy(model);
}

/* A path round a corner, which no element has by its shape: below, near the start, to the end. The
 * coarse mesh against the fine one, each of whose elements has eight in it. */
static void a_finer_mesh_has_the_same_path(void **state) {
    (void)state;
    lar_model *coarse = scene(SCENE("pipe.vtu", "path: {from: below, to: end}"));
    lar_model *fine = scene(SCENE("fine.vtu", "path: {from: below, to: end}"));
    double sum = 0;
    for (int k = 0; k < 4; k++)
        for (int j = 3; j < 12; j++) /* two elements behind the edge where it begins */
            for (int i = 0; i < 4; i++) {
                double mean[3] = {0};
                for (int a = 0; a < 8; a++) {
                    int at = 2 * i + (a & 1) + 8 * (2 * j + (a >> 1 & 1) + 24 * (2 * k + (a >> 2)));
                    for (int axis = 0; axis < 3; axis++)
                        mean[axis] += lar_model_fibre(fine, at)[axis];
                }
                double length = lar_length(mean);
                for (int axis = 0; axis < 3; axis++) mean[axis] /= length;
                sum += askew(coarse, i + 4 * (j + 12 * k), mean) / (9 * 16);
            }
    print_message("coarse and fine differ by %.4f in the mean\n", sum);
    BELOW(sum, 0.01);
    lar_model_destroy(coarse);
    lar_model_destroy(fine);
}

/* In a pipe one has come ln(r/r1) / ln(r2/r1) of the way through its wall. */
static void angles_go_through_the_wall(void **state) {
    (void)state;
    static const char *const scenes[2] = {
        SCENE("pipe.vtu", "wall: {inner: inner, outer: outer, axis: [0, 0.1, 3], angle: {inner: "
                          "100, outer: -40}}"),
        SCENE("fine.vtu", "wall: {inner: inner, outer: outer, path: {from: low, to: high}, angle: "
                          "{inner: 100, outer: -40}}")};
    for (int fine = 0; fine < 2; fine++) {
        lar_model *model = scene(scenes[fine]);
        double out[3], around[3], worst = 0;
        for (int32_t e = 0; e < model->mesh.element_count; e++) {
            double far = log(polar(model, e, out, around) / 0.02) / log(1.5), t[3], b[3];
            double angle = (100 - 140 * far) * acos(-1) / 180, wanted[3];
            double along[3] = {0, fine ? 0 : 0.1, 3};
            double part = lar_dot(along, out);
            for (int i = 0; i < 3; i++) t[i] = along[i] - part * out[i];
            double length = lar_length(t);
            for (int i = 0; i < 3; i++) t[i] /= length;
            lar_cross(out, t, b);
            for (int i = 0; i < 3; i++) wanted[i] = cos(angle) * t[i] + sin(angle) * b[i];
            lar_minus(wanted, lar_model_fibre(model, e), wanted);
            worst = fmax(worst, lar_length(wanted));
        }
        print_message("%d: at most %.2g off\n", fine, worst);
        BELOW(worst, fine ? 2e-3 : 8e-3);
        lar_model_destroy(model);
    }
}

/* All angles, quarters to the last bit: the series for sine and cosine. */
static void every_angle_is_turned_by(void **state) {
    (void)state;
    for (int degrees = -360; degrees <= 360; degrees += 5) {
        char text[400];
        snprintf(text, sizeof text,
                 SCENE("brick.vtu", "wall: {inner: bottom, outer: lid, axis: [2, 0, 0], angle: "
                                    "{inner: %d, outer: %d}}"),
                 degrees, degrees);
        lar_model *model = scene(text);
        const double *a = lar_model_fibre(model, 3);
        double angle = degrees * acos(-1) / 180;
        BELOW(fabs(a[0] - cos(angle)) + fabs(a[1] - sin(angle)) + fabs(a[2]), 1e-12);
        lar_model_destroy(model);
    }
}

/* Without inner faces: the nearest face of the surface, or of those that are named. The middle of
 * the wall is the deepest. */
static void depth_counts_from_the_surface(void **state) {
    (void)state;
    lar_model *model = scene(SCENE("pipe.vtu", "wall: {outer: {any: [inner, outer]}, axis: [0, 0, "
                                               "1], angle: {inner: 0, outer: 90}}"));
    double out[3], around[3];
    for (int32_t e = 0; e < model->mesh.element_count; e++) {
        /* Flat faces: depths of 1.25 and 3.75 mm, but for a little that is the same around. */
        polar(model, e, out, around);
        bool middle = e % 4 == 1 || e % 4 == 2;
        const double *a = lar_model_fibre(model, e);
        double angle = atan2(fabs(lar_dot(a, around)), a[2]) * 180 / acos(-1);
        BELOW(fabs(lar_dot(a, out)), 1e-9);
        BELOW(fabs(angle - (middle ? 0 : 60)), 1);
    }
    lar_model_destroy(model);
    model = scene(SCENE("brick.vtu", "wall: {axis: [1, 2, 4], angle: {inner: 0, outer: 0}}"));
    for (int32_t e = 0; e < model->mesh.element_count; e++) {
        /* As near to three faces: the first of them counts, always the same. */
        const double *a = lar_model_fibre(model, e);
        BELOW(fmin(fabs(a[0]), fmin(fabs(a[1]), fabs(a[2]))), 1e-12);
    }
    lar_model_destroy(model);
}

/* One material's path ends where the next one begins; one that has lost all of its elements asks
 * for no way through them. */
static void every_material_has_its_own_potential(void **state) {
    (void)state;
#define MORE(which, direction)                                                                     \
    "  - {cells: " which ", law: yeoh, density: 1000, shear_modulus: 1e3, bulk_modulus: 1e5, "     \
    "fibres: {active: {along: 1}, direction: {" direction "}}}\n"
#define SIDE(x) "{box: [[" x ", 0, 0], [" x ", 1, 1]]}"
#define BRICK   SCENE("brick.vtu", "path: {from: " SIDE("0") ", to: " SIDE("0.02") "}")
    lar_model *model = scene(BRICK MORE("2", "axis: [0, 0, 1]"));
    for (int32_t e = 0; e < model->mesh.element_count; e++) {
        const double *a = lar_model_fibre(model, e);
        BELOW(fabs(a[0] - (e < 4)) + fabs(a[1]) + fabs(a[2] - (e >= 4)), 1e-9);
    }
    lar_model_destroy(model);
    /* What touches a material is an end of it, by its tag or by the name of its elements. */
    static const char *const ends[2] = {"{tag: 2}", "upper"};
    for (int i = 0; i < 2; i++) {
        char text[1000];
        snprintf(text, sizeof text,
                 SCENE("brick.vtu", "path: {from: bottom, to: %s}") MORE("2", "axis: [0, 1, 0]"),
                 ends[i]);
        model = scene(text);
        for (int32_t e = 0; e < 4; e++) BELOW(fabs(lar_model_fibre(model, e)[2] - 1), 1e-9);
        lar_model_destroy(model);
    }
    model = scene(BRICK MORE("all", "axis: [0, 1, 0]"));
    for (int32_t e = 0; e < model->mesh.element_count; e++)
        assert_true(lar_model_fibre(model, e)[1] == 1);
    lar_model_destroy(model);
}

/* ---- bits ----------------------------------------------------------------------------------- */

static void the_bits_are_known(void **state) {
    (void)state;
    lar_model *model = scene(
        SCENE("bent.vtu", "wall: {inner: inner, outer: outer, path: {from: start, to: end}, angle: "
                          "{inner: 70, outer: -35}}"));
    uint64_t hash = 0;
    for (int32_t e = 0; e < model->mesh.element_count; e++)
        for (int i = 0; i < 3; i++) hash = lar_hash_double(hash, lar_model_fibre(model, e)[i]);
    print_message("%016llx\n", (unsigned long long)hash);
    assert_true(hash == 0x2cf5a10eebc49bae);
    lar_model_destroy(model);
}

/* ---- what is wrong -------------------------------------------------------------------------- */

#define WALL "wall: {inner: inner, outer: outer, "
#define TURN "angle: {inner: 60, outer: -60}"
static void scenes_say_what_is_wrong(void **state) {
    (void)state;
    static const char *const wrong[][2] = {
        {SCENE("pipe.vtu", "path: {from: low}"), "path needs the key \"to\""},
        {SCENE("pipe.vtu", "path: {to: low}"), "path needs the key \"from\""},
        {SCENE("pipe.vtu", "path: low"), "path"},
        {SCENE("pipe.vtu", "path: {}"), "path needs the key \"from\""},
        {SCENE("pipe.vtu", "path: {from: low, to: high, by: 3}"), "by"},
        {SCENE("pipe.vtu", "path: {from: lower, to: high}"), "the set \"lower\" is unknown"},
        {SCENE("pipe.vtu", "path: {from: [], to: high}"), "this selects no node at all"},
        {SCENE("pipe.vtu",
               "path: {from: {box: [[0.024, 0.001, 0.01], [0.026, 0.01, 0.02]]}, to: high}"),
         "from: none of this is a face of an element of this material"},
        {SCENE("pipe.vtu", "path: {from: 3, to: high}"), "a number alone says too little"},
        {SCENE("pipe.vtu", "path: {from: .nan, to: high}"), "unknown"},
        {SCENE("pipe.vtu", "path: {from: low, to: low}"), "belongs to both ends"},
        {SCENE("pipe.vtu", "path: {from: low, to: start}"), "node 1 belongs to both ends"},
        {SCENE("parts.vtu", "path: {from: low, to: high}"),
         "element 1 has no way through this material to the faces of \"to\""},
        {SCENE("parts.vtu", "path: {from: high, to: low}"),
         "element 1 has no way through this material to the faces of \"from\""},
        {SCENE("long.vtu", "path: {from: below, to: above}"),
         "nothing leads from \"from\" to \"to\""},
        {SCENE("thin.vtu", "path: {from: {box: [[0, 0, 0], [1, 0.0038, 1]]}, to: end}"),
         "from: all nodes of element 1 belong to these faces"},
        {SCENE("pipe.vtu", "axis: [0, 0, 1], path: {from: low, to: high}"), "direction: expected"},
        {SCENE("pipe.vtu", "axes: [0, 0, 1]"), "did you mean"},
        {SCENE("pipe.vtu", "wall: 3"), "wall"},
        {SCENE("pipe.vtu", WALL "axis: [0, 0, 1]}"), "wall needs the key \"angle\""},
        {SCENE("pipe.vtu", WALL TURN "}"), "wall: expected one of axis"},
        {SCENE("pipe.vtu", WALL TURN ", axis: [0, 0, 1], path: {from: low, to: high}}"),
         "wall: expected one of axis"},
        {SCENE("pipe.vtu", WALL TURN ", axis: [0, 0, 0]}"), "axis"},
        {SCENE("pipe.vtu", WALL TURN ", axis: 1}"), "axis"},
        {SCENE("pipe.vtu", "wall: {inner: inner, axis: [0, 0, 1], " TURN "}"),
         "wall needs the key \"outer\""},
        {SCENE("pipe.vtu", WALL "axis: [0, 0, 1], angle: {inner: 3}}"),
         "angle needs the key \"outer\""},
        {SCENE("pipe.vtu", WALL "axis: [0, 0, 1], angle: 60}"), "angle"},
        {SCENE("pipe.vtu", WALL "axis: [0, 0, 1], angle: {inner: .nan, outer: 3}}"),
         "not a finite number"},
        {SCENE("pipe.vtu", WALL "axis: [0, 0, 1], angle: {inner: 60 deg, outer: 3}}"),
         "a number in degrees"},
        {SCENE("pipe.vtu", WALL "axis: [0, 0, 1], angle: {inner: 400, outer: 3}}"),
         "an angle of 400 degrees; give one from -360 to 360"},
        {SCENE("pipe.vtu", "wall: {inner: inner, outer: inner, axis: [0, 0, 1], " TURN "}"),
         "belongs to both ends"},
        {SCENE("pipe.vtu", WALL TURN ", path: {from: inner, to: outer}}"),
         "the path goes straight through the wall"},
        {SCENE("brick.vtu", "wall: {inner: bottom, outer: lid, axis: [0, 0, 2], " TURN "}"),
         "in element 101 the axis goes straight through the wall, so that no angle can count from "
         "it; take another one, or give that part a material with a direction of its own"},
        {SCENE("brick.vtu", "wall: {outer: lid, axis: [0, 0, 2], " TURN "}"),
         "take another one, or name faces as outer that leave out the ends"},
        {SCENE("pipe.vtu", "wall: {outer: outside, axis: [0, 0, 1], " TURN "}"),
         "the set \"outside\" is unknown"},
        {SCENE("brick.vtu", "path: {from: bottom, to: lid}") MORE("2", "axis: [1, 0, 0]"),
         "to: none of this is a face of an element of this material"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        lar_model *model = NULL;
        lar_error error = {0};
        lar_status status = parse(wrong[i][0], &model, &error);
        if (!status || !strstr(error.message, wrong[i][1]) ||
            strncmp(error.message, "s.yaml:4:", 9) != 0)
            fail_msg("%zu: \"%s\" lacks \"%s\"", i, error.message, wrong[i][1]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_path_follows_the_pipe),
        cmocka_unit_test(a_finer_mesh_has_the_same_path),
        cmocka_unit_test(angles_go_through_the_wall),
        cmocka_unit_test(every_angle_is_turned_by),
        cmocka_unit_test(depth_counts_from_the_surface),
        cmocka_unit_test(every_material_has_its_own_potential),
        cmocka_unit_test(the_bits_are_known),
        cmocka_unit_test(scenes_say_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
