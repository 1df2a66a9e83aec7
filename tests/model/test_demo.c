/* The demonstration organ: its numbers, its quality, its time step, and that it can be read back.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "model/contact_check.h"
#include "model/demo/demo.h"
#include "model/format/mesh_io.h"
#include "model/model.h"

static const char folder[] = LAR_TEST_BUILD "/demo_organ/inside";

#define GOLDEN_ORGAN UINT64_C(0x52de7d08d19ae716)

static lar_mesh mesh;

static int make_mesh(void **state) {
    (void)state;
    lar_error error = {0};
    if (!lar_demo_mesh(&mesh, &error) && !lar_demo_write(folder, &error)) return 0;
    print_error("%s\n", error.message);
    return -1;
}

static int clear_mesh(void **state) {
    (void)state;
    lar_mesh_clear(&mesh);
    return 0;
}

static void test_numbers_of_the_thesis(void **state) {
    (void)state;
    lar_error error = {0};
    assert_int_equal(mesh.element_count, 1840);
    assert_in_range(mesh.node_count, 2478, 2578); /* 2528 within 2 % */
    if (lar_mesh_check(&mesh, &error)) fail_msg("%s", error.message);
    char *used = calloc((size_t)mesh.node_count, 1);
    for (int32_t e = 0; e < mesh.element_count; e++)
        for (int a = 0; a < 8; a++) used[mesh.element[e][a]] = 1;
    for (int32_t n = 0; n < mesh.node_count; n++) assert_true(used[n]);
    free(used);
}

static void test_size_and_symmetry(void **state) {
    (void)state;
    double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};
    for (int32_t n = 0; n < mesh.node_count; n++)
        for (int c = 0; c < 3; c++) {
            low[c] = fmin(low[c], mesh.position[n][c]);
            high[c] = fmax(high[c], mesh.position[n][c]);
        }
    assert_true(high[0] - low[0] > 0.115 && high[0] - low[0] < 0.125);
    assert_true(high[2] - low[2] > 0.07 && high[2] - low[2] < 0.085);
    for (int32_t n = 0; n < mesh.node_count; n++) {
        const double *p = mesh.position[n];
        int32_t twin = 0;
        while (twin < mesh.node_count &&
               !(mesh.position[twin][0] == -p[0] && mesh.position[twin][1] == p[1] &&
                 mesh.position[twin][2] == p[2]))
            twin++;
        assert_true(twin < mesh.node_count);
    }
}

static void test_quality(void **state) {
    (void)state;
    double worst = 1.0, sum = 0.0;
    for (int32_t e = 0; e < mesh.element_count; e++) {
        double corner[8][3];
        lar_mesh_corners(&mesh, e, corner);
        const double quality = lar_scaled_jacobian(corner);
        sum += quality;
        if (quality < worst) worst = quality;
    }
    print_message("scaled Jacobian: smallest %.3f, mean %.3f\n", worst, sum / mesh.element_count);
    assert_true(worst > 0.38);
}

/* ---- one manifold body --------------------------------------------------------------------- */

static int by_key(const void *a, const void *b) {
    return memcmp(a, b, 4 * sizeof(int32_t));
}

typedef struct keyed {
    int32_t key[4]; /* sorted corners, -1 where an edge has none */
    int32_t owner;
} keyed;

static keyed make_key(const int32_t *corner, int count, int32_t owner) {
    keyed k = {{-1, -1, -1, -1}, owner};
    memcpy(k.key, corner, (size_t)count * sizeof *corner);
    for (int i = 1; i < count; i++)
        for (int j = i; j > 0 && k.key[j - 1] > k.key[j]; j--) {
            const int32_t swap = k.key[j];
            k.key[j] = k.key[j - 1];
            k.key[j - 1] = swap;
        }
    return k;
}

static int32_t root_of(int32_t *parent, int32_t e) {
    while (parent[e] != e) e = parent[e] = parent[parent[e]];
    return e;
}

static void test_one_body_through_faces(void **state) {
    (void)state;
    const int32_t count = 6 * mesh.element_count;
    keyed *face = calloc((size_t)count, sizeof *face);
    int32_t *parent = calloc((size_t)mesh.element_count, sizeof *parent);
    for (int32_t e = 0; e < mesh.element_count; e++) {
        parent[e] = e;
        for (int f = 0; f < 6; f++) {
            int32_t corner[4];
            for (int q = 0; q < 4; q++) corner[q] = mesh.element[e][lar_face_node[f][q]];
            face[6 * e + f] = make_key(corner, 4, e);
        }
    }
    qsort(face, (size_t)count, sizeof *face, by_key);
    for (int32_t i = 0; i + 1 < count; i++)
        if (by_key(&face[i], &face[i + 1]) == 0) {
            assert_true(i + 2 >= count || by_key(&face[i], &face[i + 2]) != 0);
            parent[root_of(parent, face[i].owner)] = root_of(parent, face[i + 1].owner);
        }
    for (int32_t e = 0; e < mesh.element_count; e++)
        assert_int_equal(root_of(parent, e), root_of(parent, 0));
    free(face);
    free(parent);
}

/* Boundary edges belong to two quads, and the quads around a node form one ring. */
static void test_boundary_is_a_manifold(void **state) {
    (void)state;
    lar_error error = {0};
    int32_t *faces = NULL, count = 0;
    assert_int_equal(lar_mesh_boundary(&mesh, &faces, &count, &error), LAR_OK);
    keyed *edge = calloc(4 * (size_t)count, sizeof *edge);
    int32_t *quads_at = calloc((size_t)mesh.node_count, sizeof *quads_at);
    for (int32_t i = 0; i < count; i++)
        for (int q = 0; q < 4; q++) {
            const uint8_t *local = lar_face_node[faces[i] % 6];
            const int32_t *node = mesh.element[faces[i] / 6];
            const int32_t end[2] = {node[local[q]], node[local[(q + 1) % 4]]};
            edge[4 * i + q] = make_key(end, 2, i);
            quads_at[end[0]]++;
        }
    qsort(edge, 4 * (size_t)count, sizeof *edge, by_key);
    for (int32_t i = 0; i < 4 * count; i += 2) {
        assert_memory_equal(edge[i].key, edge[i + 1].key, sizeof edge[i].key);
        assert_true(i + 2 >= 4 * count || by_key(&edge[i], &edge[i + 2]) != 0);
    }
    /* Walk around every node from the first of its edges: the ring must hold all its quads. */
    for (int32_t i = 0; i < 4 * count; i += 2)
        for (int end = 0; end < 2; end++) {
            const int32_t node = edge[i].key[end];
            int32_t at = i, quad = edge[i].owner, steps = 0;
            do {
                int32_t next = -1;
                for (int32_t j = 0; j < 4 * count && next < 0; j += 2)
                    if (j != at && (edge[j].key[0] == node || edge[j].key[1] == node) &&
                        (edge[j].owner == quad || edge[j + 1].owner == quad))
                        next = j;
                assert_true(next >= 0);
                quad = edge[next].owner == quad ? edge[next + 1].owner : edge[next].owner;
                at = next;
                steps++;
            } while (at != i && steps < 100);
            assert_int_equal(steps, quads_at[node]);
        }
    /* A ball has 2: no handles, no holes (Euler). */
    int32_t nodes = 0;
    for (int32_t n = 0; n < mesh.node_count; n++) nodes += quads_at[n] > 0;
    assert_int_equal(nodes - 2 * count + count, 2);
    free(faces);
    free(edge);
    free(quads_at);
}

static void test_sets(void **state) {
    (void)state;
    static const char *const nodes[] = {
        "cervix", "ligament_ends", "ligament_end_left", "ligament_end_right",
        "fundus", "posterior",     "ovary_left",        "ovary_right"};
    static const char *const cells[] = {"uterus", "tubes", "ovaries", "ligaments"};
    for (size_t s = 0; s < sizeof nodes / sizeof nodes[0]; s++) {
        const lar_set *set = lar_mesh_find_set(&mesh, nodes[s], LAR_SET_NODES);
        assert_non_null(set);
        assert_true(set->count > 0);
    }
    assert_int_equal(lar_mesh_find_set(&mesh, "ligament_ends", LAR_SET_NODES)->count, 18);
    const lar_set *left = lar_mesh_find_set(&mesh, "ligament_end_left", LAR_SET_NODES);
    for (int32_t i = 0; i < left->count; i++) assert_true(mesh.position[left->index[i]][0] > 0.0);
    int32_t all = 0;
    for (int s = 0; s < 4; s++) {
        const lar_set *set = lar_mesh_find_set(&mesh, cells[s], LAR_SET_ELEMENTS);
        assert_non_null(set);
        assert_true(set->count > 0);
        for (int32_t i = 0; i < set->count; i++)
            assert_int_equal(mesh.element_tag[set->index[i]], s + 1);
        all += set->count;
    }
    assert_int_equal(all, mesh.element_count);
}

/* ---- the files ----------------------------------------------------------------------------- */

/* 2 / omega of one element's own mass and uniform-strain stiffness V B^T C B, by power iteration
 * (lumped mass rho V / 8 per node). B by differences of the volume, exact to rounding because the
 * volume is linear in one coordinate. */
static double stable_step(double corner[8][3], double shear, double bulk, double density) {
    double B[8][3], v[8][3], omega2 = 0.0;
    const double volume = lar_hexahedron_volume(corner);
    for (int a = 0; a < 8; a++)
        for (int c = 0; c < 3; c++) {
            const double kept = corner[a][c], step = 1e-3;
            corner[a][c] = kept + step;
            const double more = lar_hexahedron_volume(corner);
            corner[a][c] = kept - step;
            B[a][c] = (more - lar_hexahedron_volume(corner)) / (2.0 * step * volume);
            corner[a][c] = kept;
        }
    memcpy(v, B, sizeof v);
    v[0][0] *= 1.1;
    for (int iteration = 0; iteration < 300; iteration++) {
        double gradient[3][3] = {{0}}, norm = 0.0;
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) gradient[i][j] += v[a][i] * B[a][j];
        const double trace = gradient[0][0] + gradient[1][1] + gradient[2][2];
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) {
                v[a][i] = 0.0;
                for (int j = 0; j < 3; j++) {
                    double stress = shear * (gradient[i][j] + gradient[j][i]);
                    if (i == j) stress += (bulk - 2.0 / 3.0 * shear) * trace;
                    v[a][i] += 8.0 / density * stress * B[a][j];
                }
                norm += v[a][i] * v[a][i];
            }
        omega2 = sqrt(norm);
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) v[a][i] /= omega2;
    }
    return 2.0 / sqrt(omega2);
}

static void test_scene_is_read_back_with_its_time_step(void **state) {
    (void)state;
    lar_error error = {0};
    lar_model *model = NULL;
    char path[sizeof folder + 20];
    snprintf(path, sizeof path, "%s/uterus.yaml", folder);
    if (lar_scene_read(path, &model, &error)) fail_msg("%s", error.message);
    assert_int_equal(model->mesh.element_count, mesh.element_count);
    assert_int_equal(model->mesh.node_count, mesh.node_count);
    assert_memory_equal(model->mesh.position, mesh.position,
                        (size_t)mesh.node_count * sizeof *mesh.position);
    assert_memory_equal(model->mesh.element, mesh.element,
                        (size_t)mesh.element_count * sizeof *mesh.element);
    assert_int_equal(model->mesh.set_count, mesh.set_count);
    assert_int_equal(model->material_count, 4);
    assert_int_equal(model->fix_count, 2);
    assert_int_equal(model->load_count, 1);
    assert_int_equal(model->output.probe_count, 3);
    double min[4] = {1.0, 1.0, 1.0, 1.0};
    for (int32_t e = 0; e < mesh.element_count; e++) {
        const int part = model->element_material[e];
        const lar_material *material = &model->material[part];
        const double shear = lar_material_shear(material), bulk = lar_material_bulk(material);
        assert_true(bulk / shear >= 200.0 * (1.0 - 1e-12));
        assert_int_equal(part, mesh.element_tag[e] - 1);
        double corner[8][3];
        lar_mesh_corners(&mesh, e, corner);
        min[part] = fmin(min[part], stable_step(corner, shear, bulk, material->density));
    }
    print_message("stable step [us]: uterus %.1f, tubes %.1f, ovaries %.1f, ligaments %.1f\n",
                  1e6 * min[0], 1e6 * min[1], 1e6 * min[2], 1e6 * min[3]);
    for (int part = 0; part < 4; part++) assert_true(min[part] >= 115e-6);
    lar_model_destroy(model);
}

/* Both scenes: the same organ, and two tools that wait a little away from it; the one for people
 * touches itself, and has no load. */
static void test_scenes(void **state) {
    (void)state;
    static const char *const name[] = {"uterus.yaml", "uterus_live.yaml"};
    lar_error error = {0};
    for (int i = 0; i < 2; i++) {
        char path[600];
        lar_model *model = NULL;
        snprintf(path, sizeof path, "%s/%s", folder, name[i]);
        if (lar_scene_read(path, &model, &error)) fail_msg("%s", error.message);
        assert_int_equal(model->load_count, i == 0);
        assert_int_equal(model->notice_count, 0);
        assert_int_equal(model->contact_count, i);
        assert_true(model->strained_share == (i ? 0.02 : 0));
        if (i > 0) {
            assert_int_equal(model->contact[0].kind, LAR_CONTACT_SELF);
            assert_int_equal(model->contact[0].face_count, model->surface.face_count);
        }
        assert_int_equal(model->tool_count, 2);
        assert_string_equal(model->tool[0].name, "probe");
        assert_int_equal(model->tool[0].shape, LAR_TOOL_SPHERE);
        assert_string_equal(model->tool[1].name, "grasper");
        assert_int_equal(model->tool[1].shape, LAR_TOOL_GRASPER);
        for (int t = 0; t < 2; t++) {
            int32_t face;
            double gap = lar_tool_gap(model, &model->tool[t], &face);
            print_message("%s: %s is %.1f mm away\n", name[i], model->tool[t].name, 1e3 * gap);
            assert_true(gap > 0.005 && gap < 0.04);
        }
        lar_model_destroy(model);
    }
}

/* FNV-1a over coordinates and elements. The value changes only when the organ is changed on
 * purpose; another one on another machine or compiler means that its arithmetic is not IEEE double.
 */
static void test_same_bits_everywhere(void **state) {
    (void)state;
    uint64_t hash = 14695981039346656037u;
    for (int32_t n = 0; n < mesh.node_count; n++)
        for (int c = 0; c < 3; c++) {
            uint64_t bits;
            memcpy(&bits, &mesh.position[n][c], sizeof bits);
            hash = (hash ^ bits) * 1099511628211u;
        }
    for (int32_t e = 0; e < mesh.element_count; e++)
        for (int a = 0; a < 8; a++) hash = (hash ^ (uint64_t)mesh.element[e][a]) * 1099511628211u;
    print_message("organ %016llx\n", (unsigned long long)hash);
    assert_true(hash == GOLDEN_ORGAN);
}

static void test_folder_that_cannot_be_written(void **state) {
    (void)state;
    lar_error error = {0};
    assert_int_equal(lar_demo_write("/dev/null/organ", &error), LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "/dev/null/organ"));
    assert_int_equal(lar_demo_write("/proc", &error), LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "/proc/uterus.vtu"));
    assert_int_equal(lar_demo_write("", &error), LAR_ERROR_ARGUMENT);
    assert_int_equal(lar_demo_write(NULL, NULL), LAR_ERROR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_of_the_thesis),
        cmocka_unit_test(test_size_and_symmetry),
        cmocka_unit_test(test_quality),
        cmocka_unit_test(test_one_body_through_faces),
        cmocka_unit_test(test_boundary_is_a_manifold),
        cmocka_unit_test(test_sets),
        cmocka_unit_test(test_same_bits_everywhere),
        cmocka_unit_test(test_scene_is_read_back_with_its_time_step),
        cmocka_unit_test(test_scenes),
        cmocka_unit_test(test_folder_that_cannot_be_written),
    };
    return cmocka_run_group_tests(tests, make_mesh, clear_mesh);
}
