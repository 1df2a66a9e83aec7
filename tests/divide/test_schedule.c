/* Schedules: the thesis's figures, counted from what the schedules send, and their shape. */
#include "divide/schedule.h"

#include "divide/schedule_proof.h"
#include "lattice.h"
#include "model/demo/demo.h"

typedef struct divided {
    lar_mesh mesh;
    lar_incidence incidence;
    lar_distribution distribution;
} divided;

/* gx x gy x gz cubes of n^3 elements, one for each processor. */
static divided cubes(int n, int gx, int gy, int gz) {
    divided d = {.mesh = lattice(n * gx, n * gy, n * gz)};
    lar_grid grid = grid_of(gx, gy, gz);
    assert_int_equal(lar_distribution_cut(&d.mesh, &grid, &d.distribution, NULL), LAR_OK);
    assert_int_equal(lar_incidence_build(&d.mesh, &d.incidence, NULL), LAR_OK);
    return d;
}

static void clear(divided *d) {
    lar_distribution_clear(&d->distribution);
    lar_incidence_clear(&d->incidence);
    lar_mesh_clear(&d->mesh);
}

static void build(const divided *d, lar_scheme scheme, lar_channel_use channels, int threads,
                  lar_schedule_set *set) {
    lar_schedule_options options = lar_schedule_options_default();
    options.scheme = scheme;
    options.channels = channels;
    options.threads = threads;
    lar_error error = {0};
    if (lar_schedule_build(&d->mesh, &d->incidence, &d->distribution, &options, set, &error))
        fail_msg("%s", error.message);
}

static void prove(const divided *d, const lar_schedule_set *set) {
    lar_schedule_proof proof;
    lar_error error = {0};
    if (lar_schedule_prove(&d->mesh, &d->incidence, set, &proof, &error))
        fail_msg("grid %dx%dx%d, %s, %s, %d threads: %s", set->of->grid.edge[0],
                 set->of->grid.edge[1], set->of->grid.edge[2], lar_scheme_name[set->of->scheme],
                 lar_channel_use_name[set->of->channels], set->of->threads, error.message);
}

enum { CENTRE = 13 };

/* Table 3.1, counted from what the schedule of the processor in the middle sends. */
static void table_3_1(void **state) {
    (void)state;
    for (int n = 3; n <= 10; n++) {
        divided d = cubes(n, 3, 3, 3);
        for (int s = 0; s < LAR_SCHEMES; s++)
            for (int c = 0; c < LAR_CHANNEL_USES; c++) {
                int64_t local, global;
                lar_schedule_set set;
                lar_traffic traffic;
                lar_traffic_formula((lar_scheme)s, n, &local, &global);
                build(&d, (lar_scheme)s, (lar_channel_use)c, 1, &set);
                lar_schedule_traffic(&set.of[CENTRE], &traffic);
                assert_int_equal(traffic.local, local);
                assert_int_equal(traffic.global, global);
                if (n == 5 && s == LAR_SCHEME_ALL) assert_int_equal(local + global, 296);
                if (n == 5 && s == LAR_SCHEME_LOCAL) assert_int_equal(local + global, 216);
                lar_schedule_set_clear(&set);
            }
        clear(&d);
    }
}

static void demo(void **state) {
    (void)state;
    static const int edges[][3] = {{1, 1, 1}, {2, 1, 1}, {1, 2, 2}, {2, 2, 3}, {4, 4, 4}};
    divided d = {0};
    assert_int_equal(lar_demo_mesh(&d.mesh, NULL), LAR_OK);
    assert_int_equal(lar_incidence_build(&d.mesh, &d.incidence, NULL), LAR_OK);
    for (size_t g = 0; g < sizeof edges / sizeof *edges; g++)
        for (int random = 0; random < 2; random++) {
            lar_grid grid = grid_of(edges[g][0], edges[g][1], edges[g][2]);
            if (random)
                lar_distribution_random(&d.mesh, &grid, 5, &d.distribution, NULL);
            else
                lar_distribution_cut(&d.mesh, &grid, &d.distribution, NULL);
            for (int s = 0; s < LAR_SCHEMES; s++)
                for (int c = 0; c < 2; c++)
                    for (int threads = 1; threads <= 4; threads++) {
                        lar_schedule_set set;
                        if (c == 1 && s != LAR_SCHEME_LOCAL) continue;
                        build(&d, (lar_scheme)s, (lar_channel_use)c, threads, &set);
                        prove(&d, &set);
                        lar_schedule_set_clear(&set);
                    }
            lar_distribution_clear(&d.distribution);
        }
    clear(&d);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_3_1),
        cmocka_unit_test(demo),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
