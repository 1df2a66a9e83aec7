/* The element kernels of every instruction set this processor has: against the plain element of
 * hex8.h, and against each other bit by bit. */
#include "mechanics_test.h"
#include "nodes_test.h"

#include "mechanics/hex8_block.h"

/* Seven blocks: whatever number of them a kernel takes together, there is a rest. */
enum { BLOCKS = 7, LANES = BLOCKS * LAR_BLOCK, NODES = 48, SPARE = NODES, ROOM = NODES + 2 };
static const double size = 0.01; /* m */

/* Plain C twice where fma() may be an instruction or a call. */
extern const lar_kernels lar_kernels_c;
static const lar_kernels *kernels[5];
static int kernel_count;

static int find_kernels(void **state) {
    static const lar_isa wanted[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    (void)state;
    kernels[kernel_count++] = &lar_kernels_c;
    for (int i = 0; i < 4; i++) {
        lar_error error = {LAR_OK, ""};
        if (lar_kernels_find(wanted[i], &kernels[kernel_count], &error) == LAR_OK)
            print_message("kernels: %s\n", kernels[kernel_count++]->name);
        else
            print_message("passed over: %s\n", error.message);
    }
    return 0;
}

/* Elements with their own shapes and materials on nodes picked from a small pool, so that many
 * lanes of a block share nodes, sometimes as the same local node. */
typedef struct load {
    lar_hex8_block block[BLOCKS];
    lar_block_more more[BLOCKS];
    lar_hex8 element[LANES];
    lar_material material[LANES];
    int node[LANES][8];
    double u[ROOM][4] __attribute__((aligned(64)));
    double scale; /* force units per newton */
} load;

typedef struct forces {
    int64_t at[ROOM][4] __attribute__((aligned(64)));
} forces;

static const lar_hex8_limits no_limits = {-INFINITY, INFINITY, INFINITY};

static void fill_lane(load *l, int n) {
    lar_hex8_block *block = &l->block[n / LAR_BLOCK];
    const lar_hex8 *element = &l->element[n];
    int lane = n % LAR_BLOCK;
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
        for (int j = 0; j < 3; j++) block->gradient[m][j][lane] = element->gradient[m][j];
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        for (int j = 0; j < 3; j++) block->shape[m][j][lane] = element->shape[m][j];
        block->head.stiffness[m][lane] = l->scale * element->stiffness[m];
    }
    for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
        *lar_block_parameter(&block->head, &l->more[n / LAR_BLOCK], k, lane) =
            l->material[n].parameter[k] *
            (lar_law_scales(l->material[n].law, k) ? l->scale * element->volume : 1);
    for (int a = 0; a < 8; a++) block->head.node[a][lane] = l->node[n][a];
}

static void lane_displacements(const load *l, int n, double u[8][3]) {
    for (int a = 0; a < 8; a++) memcpy(u[a], l->u[l->node[n][a]], 3 * sizeof(double));
}

/* Random elements of one law, strongly deformed. */
static void make_load(load *l, uint64_t *seed, int law, double scale) {
    memset(l, 0, sizeof *l);
    l->scale = scale;
    for (int p = 0; p < ROOM; p++) random_fill(seed, 0.12 * size, l->u[p], 3);
    for (int n = 0; n < LANES; n++) {
        double corner[8][3], u[8][3], force[8][3], J = 0;
        l->material[n] = test_material(law, 4e3 * (1 + n % 3), n % 2 ? 2e6 : 2e4);
        while (!(J > 0.1)) {
            random_corners(seed, size, 0.2, corner);
            for (int a = 0; a < 8; a++) { /* eight different nodes */
                bool taken = true;
                while (taken) {
                    l->node[n][a] = (int)(random_bits(seed) >> 33) % NODES;
                    taken = false;
                    for (int b = 0; b < a; b++) taken |= l->node[n][b] == l->node[n][a];
                }
            }
            lane_displacements(l, n, u);
            lar_hex8_prepare((rows)corner, &l->material[n], &l->element[n]);
            J = lar_hex8_force(&l->element[n], &l->material[n], (rows)u, force);
        }
        fill_lane(l, n);
    }
}

static void empty_lane(load *l, int n) {
    memset(&l->element[n], 0, sizeof l->element[n]);
    memset(l->material[n].parameter, 0, sizeof l->material[n].parameter);
    for (int a = 0; a < 8; a++) l->node[n][a] = SPARE;
    fill_lane(l, n);
}

/* Asked for ahead or not, blocks give the same forces, and list the same elements. */
static int64_t call_both(int k, lar_block_run *run, const double (*u)[4], int64_t (*force)[4],
                         const lar_hex8_limits *limits, lar_hex8_monitor *listed) {
    static int64_t before[ROOM][4], again[ROOM][4];
    lar_hex8_monitor second = {.limit = listed ? listed->limit : NULL};
    static int32_t lane[64 * LAR_BLOCK];
    static float strain[64 * LAR_BLOCK][LAR_STRAIN_NUMBERS];
    second.lane = lane;
    second.strain = strain;
    memcpy(before, force, sizeof before);
    int64_t found = test_recover(kernels[k], run, ROOM, u, force, limits, listed);
    static const int asks[] = {LAR_ASK_FEW, LAR_ASK_MANY};
    for (size_t i = 0; i < sizeof asks / sizeof asks[0]; i++) {
        run->asks = asks[i];
        second.count = 0;
        memcpy(again, before, sizeof again);
        assert_true(test_recover(kernels[k], run, ROOM, u, again, limits,
                                 listed ? &second : NULL) == found);
        assert_memory_equal(again, force, sizeof again);
        if (!listed) continue;
        size_t count = (size_t)listed->count;
        assert_int_equal(second.count, listed->count);
        assert_memory_equal(lane, listed->lane, count * sizeof *lane);
        assert_memory_equal(strain, listed->strain, count * sizeof *strain);
    }
    return found;
}

/* Loose blocks of general elements. */
static int64_t call(int k, lar_law law, const lar_hex8_block *blocks, const lar_block_more *more,
                    int count, const double (*u)[4], int64_t (*force)[4],
                    const lar_hex8_limits *limits, bool monitor) {
    lar_block_run run = {.law = law,
                         .shape = LAR_SHAPE_GENERAL,
                         .rows = LAR_ROWS_NONE,
                         .count = count,
                         .blocks = blocks,
                         .more = lar_law_has_more(law) ? more : NULL};
    enum { MAX = 64 };
    static int32_t lane[MAX * LAR_BLOCK];
    static double limit[MAX * LAR_BLOCK] __attribute__((aligned(64)));
    assert_true(count <= MAX);
    for (int i = 0; i < MAX * LAR_BLOCK; i++) limit[i] = INFINITY;
    static float strain[MAX * LAR_BLOCK][LAR_STRAIN_NUMBERS];
    lar_hex8_monitor listed = {.limit = limit, .lane = lane, .strain = strain};
    int64_t found = call_both(k, &run, u, force, limits, monitor ? &listed : NULL);
    /* The first lane of those of the block that is named. */
    return found < 0 ? -1 : (found >> 8) * LAR_BLOCK + __builtin_ctz((unsigned)(found & 0xff));
}

static int64_t recover(const load *l, int k, bool monitor, const lar_hex8_limits *limits,
                       forces *f) {
    lar_law law = l->material[0].law;
    memset(f, 0, sizeof *f);
    return call(k, law, l->block, l->more, BLOCKS, (const double(*)[4])l->u, f->at, limits,
                monitor);
}

/* Each element within the rounding of its seven modal forces (half a unit each); the scale is
 * coarse enough that double precision does not matter beside it, then fine. */
static void agrees_with_plain_element(void **state) {
    (void)state;
    static load l;
    static forces f;
    double worst = 0;
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        for (int fine = 0; fine < 2; fine++) {
            uint64_t seed = 51 + (uint64_t)law;
            make_load(&l, &seed, law, fine ? 0x1p36 : 0x1p16);
            double exact[NODES][3] = {{0}}, bound[NODES] = {0};
            for (int n = 0; n < LANES; n++) {
                double u[8][3], force[8][3];
                lane_displacements(&l, n, u);
                lar_hex8_force(&l.element[n], &l.material[n], (rows)u, force);
                double rounding = 1e-14 * (largest(&force[0][0], 24) +
                                           layer_modulus(&l.material[n]) * size * size);
                for (int a = 0; a < 8; a++) {
                    bound[l.node[n][a]] += 3.5 + l.scale * rounding;
                    for (int i = 0; i < 3; i++) exact[l.node[n][a]][i] += l.scale * force[a][i];
                }
            }
            for (int k = 0; k < kernel_count; k++) {
                assert_true(recover(&l, k, false, &no_limits, &f) == -1);
                for (int p = 0; p < NODES; p++) {
                    assert_true(f.at[p][3] == 0);
                    for (int i = 0; i < 3; i++) {
                        double error = fabs((double)f.at[p][i] - exact[p][i]);
                        assert_below(error, bound[p]);
                        worst = fmax(worst, error / bound[p]);
                    }
                }
            }
        }
    print_message("largest error %.2f of the bound\n", worst);
}

/* The same elements on all instruction sets, with and without watching, with empty lanes between
 * them: the same integers. */
static void same_bits_everywhere(void **state) {
    (void)state;
    static load l;
    static forces first, f;
    int compared = 0;
    for (int round = 0; round < 60; round++) {
        uint64_t seed = 5200 + (uint64_t)round;
        make_load(&l, &seed, round % LAR_LAW_COUNT, round % 2 ? 0x1p40 : 0x1p30);
        for (int n = 0; n < LANES; n++)
            if (round >= 30 && random_value(&seed) > 0.5) empty_lane(&l, n);
        recover(&l, 0, false, &no_limits, &first);
        assert_true(first.at[SPARE][0] == 0 && first.at[SPARE][1] == 0 && first.at[SPARE][2] == 0);
        for (int k = 0; k < kernel_count; k++)
            for (int monitor = 0; monitor < 2; monitor++) {
                assert_true(recover(&l, k, monitor, &no_limits, &f) == -1);
                assert_memory_equal(&f, &first, sizeof f);
                compared++;
            }
    }
    print_message("%d force arrays compared\n", compared);
}

/* One element alone in every lane of every block, all other lanes empty: the same forces, and the
 * empty lanes add nothing to a spare node that is not at rest. */
static void every_lane_alike(void **state) {
    (void)state;
    static load l, one;
    static forces first, f;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        uint64_t seed = 53 + (uint64_t)law;
        make_load(&l, &seed, law, 0x1p36);
        for (int n = 0; n < LANES; n++)
            for (int k = 0; k < kernel_count; k++) {
                one = l;
                for (int m = 0; m < LANES; m++) empty_lane(&one, m);
                one.element[n] = l.element[0];
                one.material[n] = l.material[0];
                memcpy(one.node[n], l.node[0], sizeof l.node[0]);
                fill_lane(&one, n);
                recover(&one, k, true, &no_limits, n == 0 && k == 0 ? &first : &f);
                if (n || k) assert_memory_equal(&f, &first, sizeof f);
                assert_true(first.at[SPARE][0] == 0 && first.at[SPARE + 1][0] == 0);
            }
    }
}

/* The forces of all elements add up to zero: not nearly, but as integers. Adding a second call
 * doubles them. */
static void integers_balance(void **state) {
    (void)state;
    static load l;
    static forces f, once;
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        for (int k = 0; k < kernel_count; k++) {
            uint64_t seed = 54 + (uint64_t)law;
            make_load(&l, &seed, law, 0x1p38);
            recover(&l, k, false, &no_limits, &once);
            f = once;
            call(k, (lar_law)law, l.block, l.more, BLOCKS, (const double(*)[4])l.u, f.at,
                 &no_limits, false);
            int64_t sum[4] = {0}, max = 0;
            for (int p = 0; p < ROOM; p++)
                for (int i = 0; i < 4; i++) {
                    assert_true(f.at[p][i] == 2 * once.at[p][i]);
                    sum[i] += once.at[p][i];
                    max = max < once.at[p][i] ? once.at[p][i] : max;
                }
            assert_true(max > 1000000);
            for (int i = 0; i < 4; i++) assert_true(sum[i] == 0);
        }
}

/* Any number of blocks in one call, none included, is the same as one call for each. */
static void any_count_of_blocks(void **state) {
    (void)state;
    static load l;
    static forces together, single;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        uint64_t seed = 58 + (uint64_t)law;
        make_load(&l, &seed, law, 0x1p38);
        for (int k = 0; k < kernel_count; k++)
            for (int count = 0; count <= BLOCKS; count++) {
                memset(&together, 0, sizeof together);
                memset(&single, 0, sizeof single);
                assert_true(call(k, (lar_law)law, l.block, l.more, count, (const double(*)[4])l.u,
                                 together.at, &no_limits, false) == -1);
                for (int b = 0; b < count; b++)
                    call(k, (lar_law)law, &l.block[b], &l.more[b], 1, (const double(*)[4])l.u,
                         single.at, &no_limits, false);
                assert_memory_equal(&together, &single, sizeof single);
            }
    }
}

/* ---- limits ------------------------------------------------------------------------------------
 */

enum { LOOSE = 6 }; /* elements that share no node: as many as the pool of 48 has */

/* Element n of six, in lane `lane` of the last block; the others are empty. All at rest. */
static void make_loose(load *l, int law, int lane) {
    uint64_t seed = 55;
    double corner[8][3];
    make_load(l, &seed, law, 0x1p30);
    memset(l->u, 0, sizeof l->u);
    for (int n = 0; n < LANES; n++) {
        int e = (n % LAR_BLOCK + LAR_BLOCK - lane) % LAR_BLOCK;
        if (n / LAR_BLOCK != BLOCKS - 1 || e >= LOOSE) {
            empty_lane(l, n);
            continue;
        }
        l->material[n] = test_material(law, 4e3, 2e5);
        box_corners(size, size, size, corner);
        lar_hex8_prepare((rows)corner, &l->material[n], &l->element[n]);
        for (int a = 0; a < 8; a++) l->node[n][a] = 8 * e + a;
        fill_lane(l, n);
    }
}

/* Moves element 0, the one in lane `lane`: u = factor * sign of `mode` along x. */
static void move_element(load *l, bool hourglass, double amount) {
    for (int a = 0; a < 8; a++)
        l->u[a][0] = amount * lar_node_sign[a][0] * (hourglass ? lar_node_sign[a][1] : 1);
}

static void limits_name_their_lane(void **state) {
    (void)state;
    static load l;
    static forces f;
    /* stresses up to 2e5 Pa and hourglass forces of 0.1 N pass */
    double stress = 2e5 * size * size * size * 0x1p30, hourglass = 0.1 * 0x1p30;
    const lar_hex8_limits limits = {0.05, stress * stress, hourglass * hourglass};
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        for (int k = 0; k < kernel_count; k++)
            for (int lane = 0; lane < LAR_BLOCK; lane++) {
                int64_t own = (BLOCKS - 1) * LAR_BLOCK + lane;
                make_loose(&l, law, lane);
                for (int monitor = 0; monitor < 2; monitor++) {
                    move_element(&l, false, 0); /* at rest */
                    assert_true(recover(&l, k, monitor, &limits, &f) == -1);
                    move_element(&l, false, -0.1 * size); /* F11 = 0.8 */
                    assert_true(recover(&l, k, monitor, &limits, &f) == -1);
                    move_element(&l, false, -0.49 * size); /* F11 = 0.02: nearly flat */
                    assert_true(recover(&l, k, monitor, &limits, &f) == own);
                    move_element(&l, false, -0.6 * size); /* F11 = -0.2: inverted */
                    assert_true(recover(&l, k, monitor, &limits, &f) == own);
                    move_element(&l, false, 20 * size); /* F11 = 41: too much stress */
                    assert_true(recover(&l, k, monitor, &limits, &f) == own);
                    move_element(&l, false, NAN);
                    assert_true(recover(&l, k, monitor, &limits, &f) == own);
                    move_element(&l, false, 0);
                    l.u[7][1] = NAN; /* one number of one node */
                    assert_true(recover(&l, k, monitor, &limits, &f) == own);
                    l.u[7][1] = INFINITY;
                    assert_true(recover(&l, k, monitor, &limits, &f) == own);
                    l.u[7][1] = 0;
                    move_element(&l, true, size); /* hourglass: seen by a watching call only */
                    assert_true(recover(&l, k, monitor, &limits, &f) == (monitor ? own : -1));
                }
                /* two bad elements: the first in order is named */
                move_element(&l, false, -0.6 * size);
                l.u[8][0] = NAN;
                int64_t next = (BLOCKS - 1) * LAR_BLOCK + (lane + 1) % LAR_BLOCK;
                assert_true(recover(&l, k, true, &limits, &f) == (own < next ? own : next));
            }
}

/* Of bad elements in several blocks the first is named, whichever blocks and lanes they are in. */
static void first_of_all_blocks(void **state) {
    (void)state;
    static load l;
    static forces f;
    const lar_hex8_limits limits = {0.05, INFINITY, INFINITY};
    uint64_t seed = 59;
    for (int round = 0; round < 200; round++) {
        int bad[2] = {(int)(random_bits(&seed) >> 40) % LANES,
                      (int)(random_bits(&seed) >> 40) % LANES};
        memset(&l, 0, sizeof l);
        l.scale = 1;
        for (int n = 0; n < LANES; n++) empty_lane(&l, n);
        for (int i = 0; i < 2; i++) {
            double corner[8][3];
            box_corners(size, size, size, corner);
            l.material[bad[i]] = test_material(0, 4e3, 2e5);
            lar_hex8_prepare((rows)corner, &l.material[bad[i]], &l.element[bad[i]]);
            for (int a = 0; a < 8; a++) l.node[bad[i]][a] = a;
            fill_lane(&l, bad[i]);
        }
        move_element(&l, false, -0.6 * size);
        for (int k = 0; k < kernel_count; k++)
            assert_true(recover(&l, k, round % 2, &limits, &f) ==
                        (bad[0] < bad[1] ? bad[0] : bad[1]));
    }
}

/* Broken lanes do not disturb the others of their block. */
static void neighbours_keep_their_bits(void **state) {
    (void)state;
    static load l;
    static forces healthy, f;
    for (int k = 0; k < kernel_count; k++)
        for (int lane = 0; lane < LAR_BLOCK; lane++) {
            make_loose(&l, LAR_LAW_mooney_rivlin, lane);
            uint64_t seed = 56;
            for (int p = 8; p < NODES; p++) random_fill(&seed, 0.1 * size, l.u[p], 3);
            recover(&l, k, false, &no_limits, &healthy);
            move_element(&l, false, NAN);
            recover(&l, k, false, &no_limits, &f);
            assert_memory_equal(f.at[8], healthy.at[8], sizeof f.at[0] * (NODES - 8));
        }
}

/* ---- rounding to integers ----------------------------------------------------------------------
 */

/* A lane with nothing but hourglass stiffness 1 in the last mode has the force round(+-x) at every
 * node when node 0 is moved by x: rounding as IEEE has it, halves to even. */
static void rounds_to_nearest_even(void **state) {
    (void)state;
    static load l;
    static forces f;
    static const double special[] = {0,
                                     0.5,
                                     1.5,
                                     2.5,
                                     0.49999999999999994,
                                     0x1p31 + 0.5,
                                     0x1p31 + 1.5,
                                     0x1p32 - 0.5,
                                     0x1p32 + 0.5,
                                     0x1.8p32 + 0.5,
                                     0x1p50 + 0.5,
                                     0x1p51 + 0.5,
                                     0x1p52 + 1,
                                     0x1p53 + 2,
                                     0x1.fffffffffffffp60,
                                     0x1p61,
                                     0x1.fffffffffffffp61};
    enum { SPECIAL = sizeof special / sizeof special[0] };
    uint64_t seed = 57;
    memset(&l, 0, sizeof l);
    empty_lane(&l, 0);
    for (int lane = 0; lane < LAR_BLOCK; lane++) l.block[0].head.stiffness[3][lane] = 1;
    for (int a = 0; a < 8; a++)
        for (int lane = 0; lane < LAR_BLOCK; lane++) l.block[0].head.node[a][lane] = SPARE;
    for (int round = 0; round < 500 * LAR_BLOCK; round++) {
        int lane = round % LAR_BLOCK, pick = round / LAR_BLOCK / 2;
        double x = pick < SPECIAL ? special[pick] : exp2(30 + 31.9 * random_value(&seed));
        if (round / LAR_BLOCK % 2) x = -x;
        lar_hex8_block block = l.block[0];
        for (int a = 0; a < 8; a++) block.head.node[a][lane] = a;
        l.u[0][0] = x;
        l.u[0][2] = -x;
        for (int k = 0; k < kernel_count; k++) {
            memset(&f, 0, sizeof f);
            call(k, (lar_law)0, &block, NULL, 1, (const double(*)[4])l.u, f.at, &no_limits, false);
            for (int a = 0; a < 8; a++) {
                int sign = -lar_node_sign[a][0] * lar_node_sign[a][1] * lar_node_sign[a][2];
                assert_true(f.at[a][0] == sign * llrint(x));
                assert_true(f.at[a][2] == -sign * llrint(x));
                assert_true(f.at[a][1] == 0 && f.at[a][3] == 0);
            }
        }
    }
}

/* ---- golden bits
 * --------------------------------------------------------------------------------- */

static uint64_t hash_bytes(const void *data, size_t count) { /* FNV-1a */
    uint64_t hash = 0xcbf29ce484222325ULL;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ ((const unsigned char *)data)[i]) * 0x100000001b3ULL;
    return hash;
}

/* The integers themselves, from input that no mathematical library has touched: whatever the
 * compiler, its options and the processor. A change of these numbers changes every state hash; it
 * needs a reason in the commit that makes it. */
static void golden_bits(void **state) {
    (void)state;
    static const uint64_t golden[LAR_LAW_COUNT] = {
        [LAR_LAW_neo_hookean] = 0x45dbd776b0e9f8ebULL,
        [LAR_LAW_coupled_neo_hookean] = 0xd435202178cc047eULL,
        [LAR_LAW_mooney_rivlin] = 0x079e701cc8e23e21ULL,
        [LAR_LAW_yeoh] = 0x56871e52e4f6ffc7ULL,
        [LAR_LAW_arruda_boyce] = 0xd7179c09b5001221ULL,
        [LAR_LAW_veronda_westmann] = 0xa449cca7ee6c1576ULL,
        [LAR_LAW_holmes_mow] = 0xc06de25dfd913c5fULL,
        [LAR_LAW_ogden] = 0xb696477b4bed572cULL,
    };
    static load l;
    static forces f;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        uint64_t seed = 60;
        memset(&l, 0, sizeof l);
        for (int p = 0; p < NODES; p++) random_fill(&seed, 0x1p-10, l.u[p], 3);
        for (int n = 0; n < LANES; n++) {
            lar_hex8 *element = &l.element[n];
            random_fill(&seed, 16, &element->gradient[0][0], 18);
            random_fill(&seed, 0x1p-8, &element->shape[0][0], 12);
            for (int m = 0; m < 4; m++) element->stiffness[m] = 2 + random_value(&seed);
            element->volume = 0x1p-20 * (2 + random_value(&seed));
            l.material[n].law = (lar_law)law;
            for (int k = 0; k < LAR_BLOCK_PARAMETERS || k < lar_law_table[law].count; k++)
                l.material[n].parameter[k] = 4000 + 1000 * random_value(&seed);
            for (int k = 0; k < lar_law_table[law].count; k++) /* 1.5 to 2.5 */
                if (!lar_law_scales((lar_law)law, k)) l.material[n].parameter[k] *= 0x1p-11;
            for (int a = 0; a < 8; a++) l.node[n][a] = (int)(random_bits(&seed) >> 33) % NODES;
            l.scale = 0x1p40;
            fill_lane(&l, n);
        }
        for (int k = 0; k < kernel_count; k++) {
            const lar_hex8_limits limits = {0.1, INFINITY, INFINITY};
            assert_true(recover(&l, k, false, &limits, &f) == -1);
            uint64_t hash = hash_bytes(&f, sizeof f);
            if (hash != golden[law])
                fail_msg("%s, %s: 0x%016llx", lar_law_name[law], kernels[k]->name,
                         (unsigned long long)hash);
        }
    }
}

static void finding_kernels(void **state) {
    (void)state;
    const lar_kernels *found = NULL;
    lar_error error = {LAR_OK, ""};
    assert_int_equal(lar_kernels_find((lar_isa)77, &found, &error), LAR_ERROR_ARGUMENT);
    assert_null(found);
    setenv("LARIAT_ISA", "abacus", 1);
    assert_int_equal(lar_kernels_find(LAR_ISA_AUTO, &found, &error), LAR_ERROR_UNSUPPORTED);
    assert_non_null(strstr(error.message, "abacus"));
    assert_non_null(strstr(error.message, "c"));
    assert_null(found);
    setenv("LARIAT_ISA", "c", 1);
    assert_int_equal(lar_kernels_find(LAR_ISA_AUTO, &found, &error), LAR_OK);
    assert_string_equal(found->name, "c");
    unsetenv("LARIAT_ISA");
    assert_int_equal(lar_kernels_find(LAR_ISA_AUTO, &found, NULL), LAR_OK);
    assert_ptr_equal(found, kernels[kernel_count - 1]); /* the widest */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finding_kernels),
        cmocka_unit_test(agrees_with_plain_element),
        cmocka_unit_test(same_bits_everywhere),
        cmocka_unit_test(every_lane_alike),
        cmocka_unit_test(integers_balance),
        cmocka_unit_test(any_count_of_blocks),
        cmocka_unit_test(limits_name_their_lane),
        cmocka_unit_test(first_of_all_blocks),
        cmocka_unit_test(neighbours_keep_their_bits),
        cmocka_unit_test(rounds_to_nearest_even),
        cmocka_unit_test(golden_bits),
    };
    return cmocka_run_group_tests(tests, find_kernels, NULL);
}
