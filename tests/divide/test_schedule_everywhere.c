/* Built schedules, proved for all grids up to 4x4x4, one to four threads, every scheme and use of
 * channels, cut, random and METIS distributions, on regular and irregular meshes.
 *
 *     test_divide_schedule_everywhere            a sample of the combinations
 *     test_divide_schedule_everywhere all        all of them
 */
#include "divide/proof/schedule_proof.h"

#include "model/demo/demo.h"
#include "model/format/mesh_io.h"
#include "plain_schedule.h"
#include "step_player.h"

/* Of all divisions, and of all schedules of one, every so many are tried: prime to all numbers
 * here, so that all values of everything occur. */
static int some_divisions = 31, some_schedules = 5;

enum { EDGE = 4, THREADS = 4, CUT = 0, RANDOM, METIS, DISTRIBUTIONS };
enum {
    DIVISIONS = EDGE * EDGE * EDGE * DISTRIBUTIONS,
    SCHEDULES = LAR_SCHEMES * LAR_CHANNEL_USES * THREADS
};

typedef struct combination {
    int edge[3], distribution, scheme, channels, threads;
} combination;

static combination combination_of(int division, int schedule) {
    return (combination){.distribution = division % DISTRIBUTIONS,
                         .edge = {division / DISTRIBUTIONS % EDGE + 1,
                                  division / DISTRIBUTIONS / EDGE % EDGE + 1,
                                  division / DISTRIBUTIONS / EDGE / EDGE + 1},
                         .threads = schedule % THREADS + 1,
                         .scheme = schedule / THREADS % LAR_SCHEMES,
                         .channels = schedule / THREADS / LAR_SCHEMES};
}

static bool distribute(const lar_mesh *mesh, const lar_incidence *incidence, const combination *c,
                       lar_distribution *out) {
    lar_grid grid = grid_of(c->edge[0], c->edge[1], c->edge[2]);
    if (grid.count > mesh->element_count) return false;
    if (c->distribution == METIS && !lar_distribution_has_metis()) return false;
    lar_error error = {0};
    lar_status status = c->distribution == CUT ? lar_distribution_cut(mesh, &grid, out, &error)
                        : c->distribution == RANDOM
                            ? lar_distribution_random(mesh, &grid, 7, out, &error)
                            : lar_distribution_metis(mesh, incidence, &grid, 1, out, &error);
    if (status) fail_msg("%s", error.message);
    return true;
}

static void prove_one(const lar_mesh *mesh, const lar_incidence *incidence,
                      const lar_distribution *distribution, const combination *c, bool play) {
    lar_schedule_options options = lar_schedule_options_default();
    options.scheme = (lar_scheme)c->scheme;
    options.channels = (lar_channel_use)c->channels;
    options.threads = c->threads;
    options.search = 500;
    lar_schedule_set set;
    lar_schedule_proof proof;
    lar_error error = {0};
    const char *wrong = NULL;
    lar_status status = lar_schedule_build(mesh, incidence, distribution, &options, &set, &error);
    if (!status) {
        status = lar_schedule_prove(mesh, incidence, &set, &proof, &error);
        if (!status && play) wrong = play_steps(mesh, &set, 1);
        lar_schedule_set_clear(&set);
    }
    if (status || wrong)
        fail_msg("%s, %dx%dx%d, %s, %s, %d threads, %s distribution: %s", mesh->source, c->edge[0],
                 c->edge[1], c->edge[2], lar_scheme_name[c->scheme],
                 lar_channel_use_name[c->channels], c->threads,
                 c->distribution == CUT      ? "cut"
                 : c->distribution == RANDOM ? "random"
                                             : "METIS",
                 status ? error.message : wrong);
    assert_true(proof.balanced);
}

/* Clears the mesh. With `play`, every schedule is also played. */
static void prove_mesh(lar_mesh *mesh, bool play) {
    lar_incidence incidence;
    assert_int_equal(lar_incidence_build(mesh, &incidence, NULL), LAR_OK);
    for (int i = 0; i < DIVISIONS; i += some_divisions) {
        combination c = combination_of(i, 0);
        lar_distribution distribution = {0};
        if (!distribute(mesh, &incidence, &c, &distribution)) continue;
        for (int j = i % some_schedules; j < SCHEDULES; j += some_schedules) {
            c = combination_of(i, j);
            prove_one(mesh, &incidence, &distribution, &c, play);
        }
        lar_distribution_clear(&distribution);
    }
    lar_incidence_clear(&incidence);
    lar_mesh_clear(mesh);
}

static void demonstration_organ(void **state) {
    (void)state;
    lar_mesh mesh = {0};
    assert_int_equal(lar_demo_mesh(&mesh, NULL), LAR_OK);
    prove_mesh(&mesh, false);
}

static void regular_brick(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(8, 8, 8);
    prove_mesh(&mesh, false);
}

/* ---- irregular meshes --------------------------------------------------------------------- */

/* Leaves out elements, and then nodes that none has any more. */
static void thin_out(lar_mesh *mesh, lar_random *random, int32_t keep_percent) {
    int32_t *number = calloc((size_t)mesh->node_count, sizeof *number), elements = 0, nodes = 0;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        if (lar_random_below(random, 100) >= keep_percent) continue;
        memmove(mesh->element[elements++], mesh->element[e], sizeof *mesh->element);
        for (int a = 0; a < 8; a++) number[mesh->element[e][a]] = 1;
    }
    mesh->element_count = elements;
    for (int32_t k = 0; k < mesh->node_count; k++) {
        if (!number[k]) continue;
        memmove(mesh->position[nodes], mesh->position[k], sizeof *mesh->position);
        number[k] = nodes++;
    }
    mesh->node_count = nodes;
    for (int32_t e = 0; e < elements; e++)
        for (int a = 0; a < 8; a++) mesh->element[e][a] = number[mesh->element[e][a]];
    free(number);
}

/* Crumbs: bodies that hang together by faces, edges, corners, or not at all. */
static void bodies_apart(void **state) {
    (void)state;
    for (int32_t keep = 20; keep <= 60; keep += 40) {
        lar_random random = {(uint64_t)keep};
        lar_mesh mesh = brick_mesh(7, 6, 5);
        thin_out(&mesh, &random, keep);
        prove_mesh(&mesh, true);
    }
}

/* Layers of elements around an axis, `spokes` of them at each node of the axis. */
static lar_mesh fan(int32_t spokes, int32_t layers) {
    int32_t ring = 2 * spokes + 1;
    lar_mesh mesh = {.source = lar_strdup("fan"),
                     .node_count = ring * (layers + 1),
                     .element_count = spokes * layers};
    mesh.position = lar_calloc((size_t)mesh.node_count, sizeof *mesh.position);
    mesh.element = lar_calloc((size_t)mesh.element_count, sizeof *mesh.element);
    for (int32_t k = 0; k < mesh.node_count; k++) {
        double angle = 3.14159 * (k % ring) / spokes;
        mesh.position[k][0] = k % ring ? cos(angle) : 0;
        mesh.position[k][1] = k % ring ? sin(angle) : 0;
        mesh.position[k][2] = k / ring;
    }
    for (int32_t e = 0; e < mesh.element_count; e++)
        for (int a = 0; a < 8; a++) {
            /* 0 is the axis; 1, 2, ... go around it. */
            int32_t corner = a % 4 ? (2 * (e % spokes) + a % 4 - 1) % (2 * spokes) + 1 : 0;
            mesh.element[e][a] = corner + ring * (e / spokes + a / 4);
        }
    return mesh;
}

static void many_elements_at_a_node(void **state) {
    (void)state;
    lar_mesh mesh = fan(24, 3);
    prove_mesh(&mesh, true);
}

static void meshes_of_others(void **state) {
    (void)state;
    static const char *const name[] = {"volumes/deformed_liver_volume_hexahedrons.vtu",
                                       "bench/automesh/letter_f_3d.inp"};
    for (size_t i = 0; i < sizeof name / sizeof *name; i++) {
        char path[512];
        lar_mesh mesh = {0};
        lar_error error = {0};
        snprintf(path, sizeof path, "%s/data/%s", LAR_TEST_SHARED, name[i]);
        lar_status status = lar_mesh_read(path, 1, &mesh, &error);
        if (status == LAR_ERROR_IO) {
            printf("skipped: no shared data\n");
            continue;
        }
        if (status) fail_msg("%s", error.message);
        prove_mesh(&mesh, false);
    }
}

/* ---- sizes -------------------------------------------------------------------------------- */

/* 20,000 elements on 64 processors. */
static void larger(void **state) {
    (void)state;
    lar_mesh mesh = brick_mesh(28, 27, 27);
    lar_incidence incidence;
    assert_int_equal(lar_incidence_build(&mesh, &incidence, NULL), LAR_OK);
    for (int distribution = CUT; distribution <= RANDOM; distribution++) {
        combination c = {{4, 4, 4}, distribution, LAR_SCHEME_LOCAL, LAR_CHANNELS_CONCURRENT, 2};
        lar_distribution d = {0};
        assert_true(distribute(&mesh, &incidence, &c, &d));
        prove_one(&mesh, &incidence, &d, &c, false);
        lar_distribution_clear(&d);
    }
    lar_incidence_clear(&incidence);
    lar_mesh_clear(&mesh);
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], "all") == 0) some_divisions = some_schedules = 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(demonstration_organ), cmocka_unit_test(regular_brick),
        cmocka_unit_test(bodies_apart),        cmocka_unit_test(many_elements_at_a_node),
        cmocka_unit_test(meshes_of_others),    cmocka_unit_test(larger),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
