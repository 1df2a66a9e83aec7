/* The guard of corners: a barrier with the forces of its energy, that is nothing where corners are
 * sound; and the kernels that look for corners to be guarded, on every instruction set. */
#include "mechanics_test.h"
#include "nodes_test.h"

#include "base/vector.h"
#include "mechanics/hex8_guard.h"

enum { NODES = 8 * LAR_BLOCK + 4 };
static const double size = 0.01;

/* A crooked element, and where its corners are when some are pushed in. */
static void crooked(uint64_t *seed, double push, double rest[8][3], double now[8][3]) {
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) {
            rest[a][i] = 0.5 * size * (lar_node_sign[a][i] + 0.3 * random_value(seed));
            now[a][i] = rest[a][i] + push * size * random_value(seed);
        }
}

static double energy_of(const double rest[8][3], const double now[8][3],
                        const lar_material *material) {
    lar_guard guard;
    lar_hex8_guard(rest, now, material, &guard);
    return guard.energy;
}

static void forces_are_slopes_of_the_energy(void **state) {
    (void)state;
    uint64_t seed = 11;
    lar_material material = test_material(LAR_LAW_neo_hookean, 2e3, 1e5);
    int guarded = 0, folded = 0;
    for (int k = 0; k < 2000; k++) {
        double rest[8][3], now[8][3], force[8][3] = {{0}}, sum[3] = {0};
        lar_guard guard;
        crooked(&seed, 0.6, rest, now);
        lar_hex8_guard_force((rows)rest, (rows)now, NULL, &material, (lar_guard_lead){0},
                             LAR_ALL_CORNERS, force, &guard);
        if (guard.min >= LAR_GUARD_START) {
            assert_true(guard.energy == 0 && guard.stiffness == 0);
            assert_true(largest(&force[0][0], 24) == 0);
            continue;
        }
        guarded++;
        folded += guard.min < 0;
        assert_true(guard.energy >= 0 && guard.stiffness > 0);
        double step = 1e-7 * size, max = largest(&force[0][0], 24);
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) {
                double at = now[a][i];
                now[a][i] = at + step;
                double above = energy_of((rows)rest, (rows)now, &material);
                now[a][i] = at - step;
                double below = energy_of((rows)rest, (rows)now, &material);
                now[a][i] = at;
                double bound =
                    1e-5 * max + 1e-13 * guard.energy / step + 2 * step * guard.stiffness;
                assert_below(fabs((above - below) / (2 * step) - force[a][i]), bound);
                sum[i] += force[a][i];
            }
        assert_below(largest(sum, 3), 1e-12 * max);
    }
    assert_true(guarded > 500 && folded > 100);
}

/* An element that is drawn out in two directions, with a corner pushed through to the other side.
 * Its barrier is as stiff as the square of dj/dx, which grows with the fourth power of that; steps
 * have no parts for it, and a barrier that is softened for the step gives more than it took. */
static void long_edges_do_not_make_it_stiff(void **state) {
    (void)state;
    lar_material material = test_material(LAR_LAW_neo_hookean, 2e3, 1e5);
    double stiffness[4];
    for (int k = 0; k < 4; k++) {
        double rest[8][3], now[8][3], out = pow(2, k);
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) {
                rest[a][i] = 0.5 * size * lar_node_sign[a][i];
                now[a][i] = rest[a][i] * (i < 2 ? out : 1);
            }
        now[6][2] = rest[2][2] - 0.2 * size; /* below the corner under it */
        lar_guard guard;
        lar_hex8_guard((rows)rest, (rows)now, &material, &guard);
        assert_true(guard.min < 0);
        stiffness[k] = guard.stiffness;
    }
    print_message("drawn out to 1, 2, 4, 8: %.3g, %.3g, %.3g, %.3g N/m\n", stiffness[0],
                  stiffness[1], stiffness[2], stiffness[3]);
    for (int k = 1; k < 4; k++) assert_below(stiffness[k], 64 * stiffness[0]);
}

/* Forces are slopes there as well. */
static void long_edges_have_slopes(void **state) {
    (void)state;
    uint64_t seed = 13;
    lar_material material = test_material(LAR_LAW_neo_hookean, 2e3, 1e5);
    int guarded = 0;
    for (int k = 0; k < 1000; k++) {
        double rest[8][3], now[8][3], force[8][3] = {{0}};
        lar_guard guard;
        crooked(&seed, 0.6, rest, now);
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) now[a][i] *= i == k % 3 ? 1 : 6;
        lar_hex8_guard_force((rows)rest, (rows)now, NULL, &material, (lar_guard_lead){0},
                             LAR_ALL_CORNERS, force, &guard);
        if (guard.min >= LAR_GUARD_START) continue;
        guarded++;
        double step = 1e-7 * size, max = largest(&force[0][0], 24);
        for (int i = 0; i < 24; i++) {
            double *at = &now[i / 3][i % 3], value = *at;
            *at = value + step;
            double above = energy_of((rows)rest, (rows)now, &material);
            *at = value - step;
            double below = energy_of((rows)rest, (rows)now, &material);
            *at = value;
            double bound = 1e-4 * max + 1e-13 * guard.energy / step + 4 * step * guard.stiffness;
            assert_below(fabs((above - below) / (2 * step) - force[i / 3][i % 3]), bound);
        }
    }
    assert_true(guarded > 300);
}

/* What damps takes energy, and a barrier pulls nothing together. */
static void damping_only_takes(void **state) {
    (void)state;
    uint64_t seed = 12;
    lar_material material = test_material(LAR_LAW_coupled_neo_hookean, 3e3, 3e4);
    for (int k = 0; k < 2000; k++) {
        double rest[8][3], now[8][3], v[8][3], force[8][3] = {{0}}, still[8][3] = {{0}};
        lar_guard guard;
        crooked(&seed, 0.6, rest, now);
        random_fill(&seed, 1, &v[0][0], 24);
        const lar_guard_lead lead = {.closing = 1e-4, .opening = 1e-3};
        lar_hex8_guard_force((rows)rest, (rows)now, NULL, &material, (lar_guard_lead){0},
                             LAR_ALL_CORNERS, still, &guard);
        lar_hex8_guard_force((rows)rest, (rows)now, (rows)v, &material, lead, LAR_ALL_CORNERS,
                             force, &guard);
        double power = 0, max = 0;
        for (int i = 0; i < 24; i++) {
            double part = (force[i / 3][i % 3] - still[i / 3][i % 3]) * v[i / 3][i % 3];
            power += part;
            max += fabs(part);
        }
        double taken = lar_hex8_guard_power((rows)rest, (rows)now, (rows)v, guard.damper);
        assert_true(taken >= 0);
        assert_below(fabs(power - taken), 1e-10 * max + 1e-300);
        for (int a = 0; a < 8; a++) assert_true(guard.slope[a] + guard.damper[a] <= 0);
    }
}

/* ---- kernels ------------------------------------------------------------------------------- */

typedef struct block_nodes {
    double rest[NODES][4] __attribute__((aligned(64)));
    double u[NODES][4] __attribute__((aligned(64)));
    double v[NODES][4] __attribute__((aligned(64)));
} block_nodes;

/* Eight loose elements, or a row of eight on four lines of nodes. */
static void fill(uint64_t *seed, bool row, lar_hex8_block *block, block_nodes *nodes) {
    static const int line_of[8] = {0, 0, 1, 1, 2, 2, 3, 3};
    memset(nodes, 0, sizeof *nodes);
    for (int n = 0; n < LAR_BLOCK; n++)
        for (int a = 0; a < 8; a++) {
            int right = lar_node_sign[a][0] > 0;
            int node = row ? 16 * line_of[a] + n + right : 8 * n + a;
            for (int i = 0; i < 3; i++) {
                nodes->rest[node][i] = 0.5 * size * lar_node_sign[a][i] +
                                       (row && i == 0 ? size * n : 0) +
                                       0.1 * size * random_value(seed);
                nodes->u[node][i] = 0.45 * size * random_value(seed);
                nodes->v[node][i] = random_value(seed);
            }
            block->head.node[a][n] = node;
        }
}

static double min_of(const lar_hex8_block *block, const block_nodes *nodes, int lane,
                     double *largest) {
    double rest[8][3], now[8][3];
    lar_material material = test_material(LAR_LAW_neo_hookean, 2e3, 1e5);
    lar_guard guard;
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) {
            int node = block->head.node[a][lane];
            rest[a][i] = nodes->rest[node][i];
            now[a][i] = rest[a][i] + nodes->u[node][i];
        }
    lar_hex8_guard((rows)rest, (rows)now, &material, &guard);
    *largest = lar_hex8_largest_corner((rows)rest);
    return guard.min;
}

/* Corners below 0.3 of their volume, one by one. */
static void corners_are(const lar_hex8_group *group, const block_nodes *nodes, unsigned lanes,
                        const double *ahead, const uint8_t at[LAR_BLOCK]) {
    lar_material material = test_material(LAR_LAW_neo_hookean, 2e3, 1e5);
    for (int lane = 0; lane < LAR_BLOCK; lane++) {
        double rest[8][3], now[8][3];
        unsigned below = 0;
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) {
                int node = group->node[a][lane];
                rest[a][i] = nodes->rest[node][i];
                now[a][i] = rest[a][i] + nodes->u[node][i];
                if (ahead) now[a][i] += ahead[lane] * nodes->v[node][i];
            }
        for (int a = 0; a < 8; a++) {
            lar_guard guard;
            lar_hex8_guard_force((rows)rest, (rows)now, NULL, &material, (lar_guard_lead){0},
                                 1u << a, NULL, &guard);
            if (!(guard.min > 0.3)) below |= 1u << a;
        }
        assert_int_equal(at[lane], lanes >> lane & 1 ? below : 0);
    }
}

static double longest_edge(const double x[8][3]) {
    static const int end[12][2] = {{0, 1}, {3, 2}, {4, 5}, {7, 6}, {0, 3}, {1, 2},
                                   {4, 7}, {5, 6}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
    double longest = 0;
    for (int e = 0; e < 12; e++) {
        double d[3];
        lar_minus(x[end[e][1]], x[end[e][0]], d);
        longest = fmax(longest, lar_dot(d, d));
    }
    return longest;
}

/* However flat or folded it is, and whichever way its corners go. */
static void areas_stay_while_corners_go_little(void **state) {
    (void)state;
    uint64_t seed = 29;
    double most = 0;
    for (int k = 0; k < 2000; k++) {
        double at[8][3], then[8][3], worst = 0;
        box_corners(size, size * (k % 3 ? 1 : 0.1), size * (k % 5 ? 0.2 : 1), at);
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) at[a][i] += 0.1 * (k % 10) * size * random_value(&seed);
        double areas = lar_hex8_areas((rows)at);
        double way = lar_hex8_steady_way(areas, longest_edge((rows)at));
        assert_true(way > 0);
        for (int n = 0; n < 40; n++) { /* uphill, from anywhere */
            for (int a = 0; a < 8; a++) {
                double d[3], length;
                for (int i = 0; i < 3; i++) d[i] = random_value(&seed);
                length = sqrt(lar_dot(d, d));
                for (int i = 0; i < 3; i++) then[a][i] = at[a][i] + way * d[i] / length;
            }
            worst = fmax(worst, lar_hex8_areas((rows)then));
        }
        for (int i = 0; i < 3; i++) { /* and as it becomes larger most */
            double middle = 0;
            for (int a = 0; a < 8; a++) middle += at[a][i] / 8;
            for (int a = 0; a < 8; a++)
                then[a][i] = at[a][i] + (at[a][i] > middle ? way : -way) / sqrt(3);
        }
        worst = fmax(worst, lar_hex8_areas((rows)then));
        assert_true(worst <= LAR_HEX8_STEADY * areas);
        most = fmax(most, worst / areas);
    }
    print_message("areas grew to %.3f times at most, %.3f is said\n", most, LAR_HEX8_STEADY);
    assert_true(most > 1.05);
}

/* Areas and the largest square of a speed beside the first corner, to the bit. */
static void motion_is(const lar_hex8_group *group, const block_nodes *nodes, unsigned lanes,
                      const lar_hex8_motion *motion) {
    for (int lane = 0; lane < LAR_BLOCK; lane++) {
        double now[8][3], most = 0;
        const double *first = nodes->v[group->node[0][lane]];
        for (int a = 0; a < 8; a++) {
            int node = group->node[a][lane];
            double away[3];
            for (int i = 0; i < 3; i++) now[a][i] = nodes->rest[node][i] + nodes->u[node][i];
            lar_minus(nodes->v[node], first, away);
            most = fmax(most, lar_dot(away, away));
        }
        if (!(lanes >> lane & 1)) continue;
        assert_true(motion->areas[lane] == lar_hex8_areas((rows)now));
        assert_true(motion->parting[lane] == most);
        assert_true(motion->longest[lane] == longest_edge((rows)now));
    }
}

static void kernels_see_the_same_corners(void **state) {
    (void)state;
    static const lar_isa wanted[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    static const double share[2] = {0.3, 0.6};
    static lar_hex8_block block;
    static block_nodes nodes;
    static double ahead[LAR_BLOCK] __attribute__((aligned(64)));
    for (int lane = 0; lane < LAR_BLOCK; lane++) ahead[lane] = 0.02 * size * lane;
    static double rest[3 * TEST_STRIDE], u[3 * TEST_STRIDE], v[3 * TEST_STRIDE];
    lar_hex8_group group;
    uint64_t seed = 13;
    int seen[3] = {0};
    for (int k = 0; k < 400; k++) {
        fill(&seed, k % 2, &block, &nodes);
        test_axes((const double(*)[4])nodes.rest, NODES, rest);
        test_axes((const double(*)[4])nodes.u, NODES, u);
        test_axes((const double(*)[4])nodes.v, NODES, v);
        unsigned expected = 0;
        memcpy(group.node, block.head.node, sizeof group.node);
        for (int lane = 0; lane < LAR_BLOCK; lane++) {
            double min = min_of(&block, &nodes, lane, &group.largest[lane]);
            for (int s = 0; s < 2; s++)
                if (!(min > share[s])) expected |= 1u << (lane + LAR_BLOCK * s);
            seen[min < 0.3 ? 0 : min < 0.6 ? 1 : 2]++;
        }
        for (int i = 0; i < 4; i++) {
            const lar_kernels *kernels;
            lar_hex8_motion motion;
            lar_hex8_corner_look look;
            if (lar_kernels_find(wanted[i], &kernels, NULL) != LAR_OK) continue;
            unsigned lanes = 0xffu >> k % 8 << k % 3 & 0xff, both = lanes | lanes << LAR_BLOCK;
            const lar_hex8_places now = {.stride = TEST_STRIDE, .rest = rest, .u = u};
            assert_int_equal(kernels->corners(&group, lanes, &now, share, &look), expected & both);
            for (int lane = 0; lane < LAR_BLOCK; lane++)
                if (lanes >> lane & 1 && expected >> (lane + LAR_BLOCK) & 1)
                    assert_true((look.over[lane] > 0) == !(expected >> lane & 1));
            corners_are(&group, &nodes, lanes, NULL, look.at);
            kernels->motion(&group, lanes, &now, v, &motion);
            motion_is(&group, &nodes, lanes, &motion);
            lar_hex8_places then = now;
            then.v = v;
            then.ahead = ahead;
            kernels->corners(&group, lanes, &then, share, &look);
            corners_are(&group, &nodes, lanes, ahead, look.at);
        }
    }
    assert_true(seen[0] > 100 && seen[1] > 100 && seen[2] > 100);
}

/* Eight cubes, each with a deformation of its own that leaves its volume as it is. */
static void fill_deformed(uint64_t *seed, const lar_material *material, lar_hex8_block *block,
                          lar_block_more *more, block_nodes *nodes, double F[LAR_BLOCK][3][3]) {
    static const double still[3];
    double corner[8][3], u[8][3];
    lar_hex8 element;
    memset(nodes, 0, sizeof *nodes);
    box_corners(size, size, size, corner);
    lar_hex8_prepare((rows)corner, material, &element);
    for (int n = 0; n < LAR_BLOCK; n++) {
        random_deformation(seed, 0.1 + 0.06 * n, F[n]);
        double side = cbrt(determinant((rows)F[n]));
        for (int k = 0; k < 9; k++) (&F[n][0][0])[k] /= side;
        affine((rows)F[n], still, 8, (rows)corner, u);
        for (int a = 0; a < 8; a++) {
            memcpy(nodes->u[8 * n + a], u[a], sizeof u[a]);
            block->head.node[a][n] = 8 * n + a;
        }
        for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
            *lar_block_parameter(&block->head, more, k, n) =
                material->parameter[k] *
                (lar_law_scales(material->law, k) ? element.volume * 0x1p30 : 1);
        for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
            for (int i = 0; i < 3; i++) block->gradient[m][i][n] = element.gradient[m][i];
        for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) block->head.stiffness[m][n] = 0x1p30;
    }
}

/* Of an element that is as long as wide. */
static double growth_of(const lar_material *material, const float strain[LAR_STRAIN_NUMBERS]) {
    lar_hex8_stiff stiff;
    lar_hex8_stiff_begin(material, &stiff);
    lar_hex8_stiff_of(material, strain, &stiff);
    return lar_hex8_growth(&stiff, strain[LAR_STRAIN_AREA] / 3.0);
}

/* Elements whose shear has become six tenths stiffer are listed, whatever the law and the
 * instruction set. (What is squeezed is listed by its volume, when it is 1.7 to 3 times as stiff.)
 */
static void what_stiffens_is_listed(void **state) {
    (void)state;
    static const lar_isa wanted[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    static const lar_hex8_limits limits = {-INFINITY, INFINITY, INFINITY};
    static lar_hex8_block block;
    static lar_block_more more;
    static block_nodes nodes;
    static int64_t force[NODES][4] __attribute__((aligned(64)));
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        uint64_t seed = 17;
        int seen = 0, listed = 0;
        for (int round = 0; round < 200; round++) {
            lar_material material = test_material(law, 2e3, round % 2 ? 4e3 : 1e5);
            double F[LAR_BLOCK][3][3], limit[LAR_BLOCK] __attribute__((aligned(64)));
            fill_deformed(&seed, &material, &block, &more, &nodes, F);
            for (int n = 0; n < LAR_BLOCK; n++) limit[n] = INFINITY;
            for (int i = 0; i < 4; i++) {
                const lar_kernels *kernels;
                int32_t lane[LAR_BLOCK];
                float strain[LAR_BLOCK][LAR_STRAIN_NUMBERS];
                lar_hex8_monitor monitor = {.limit = limit, .lane = lane, .strain = strain};
                const lar_block_run run = {.law = (lar_law)law,
                                           .count = 1,
                                           .blocks = &block,
                                           .more = lar_law_has_more((lar_law)law) ? &more : NULL};
                if (lar_kernels_find(wanted[i], &kernels, NULL) != LAR_OK) continue;
                test_recover(kernels, &run, NODES, (const double(*)[4])nodes.u, force, &limits,
                             &monitor);
                unsigned found = 0;
                for (int k = 0; k < monitor.count; k++) found |= 1U << lane[k];
                for (int n = 0; n < LAR_BLOCK; n++) {
                    double cof[9], *f = &F[n][0][0], J = lar_lane_cofactor(f, cof);
                    const float now[LAR_STRAIN_NUMBERS] = {(float)J, (float)lar_lane_square_sum(f),
                                                           (float)lar_lane_square_sum(cof)};
                    double growth = growth_of(&material, now);
                    if (growth > 1.6 && !(found >> n & 1))
                        fail_msg("%s, %s: %g times as stiff at J %g, |F|^2 %g, |cof F|^2 %g",
                                 lar_law_name[law], kernels->name, growth, J, now[1], now[2]);
                    seen += growth > 1.6;
                    listed += found >> n & 1;
                }
            }
        }
        print_message("%s: %d listed, %d of them six tenths stiffer\n", lar_law_name[law], listed,
                      seen);
        assert_true(seen > 100);
    }
}

static void frequency_grows_from_one(void **state) {
    (void)state;
    const float rest[LAR_STRAIN_NUMBERS] = {1, 3, 3}, flat[LAR_STRAIN_NUMBERS] = {0, 2, 1};
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material material = test_material(law, 2e3, 1e5);
        assert_below(fabs(growth_of(&material, rest) - 1), 0.1);
        assert_true(growth_of(&material, flat) == INFINITY);
        /* A cube pressed to half its length, and one that is pulled to twice. */
        const float pressed[LAR_STRAIN_NUMBERS] = {1, 0.25F + 4, 4 + 0.5F};
        assert_true(growth_of(&material, pressed) > 1.3);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(forces_are_slopes_of_the_energy),
                                       cmocka_unit_test(long_edges_do_not_make_it_stiff),
                                       cmocka_unit_test(long_edges_have_slopes),
                                       cmocka_unit_test(damping_only_takes),
                                       cmocka_unit_test(kernels_see_the_same_corners),
                                       cmocka_unit_test(areas_stay_while_corners_go_little),
                                       cmocka_unit_test(what_stiffens_is_listed),
                                       cmocka_unit_test(frequency_grows_from_one)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
