/* Rows and boxes against loose general blocks: the same int64 forces, to the bit, on every
 * instruction set of this processor. */
#include "mechanics_test.h"
#include "nodes_test.h"

#include "base/simd.h"
#include "mechanics/hex8_block.h"

enum { MAX = 9, LANES = MAX * LAR_BLOCK, ROOM = 8 * LANES + 2, SPARE = ROOM - 1 };
static const double size = 0.01, scale = 0x1p52; /* m, force units per newton: every bit shows */
static const double modulus_shear = 4e3, modulus_bulk = 2e5;

/* Plain C twice where fma() may be an instruction or a call. */
extern const lar_kernels lar_kernels_c;
static const lar_kernels *kernels[5];
static int kernel_count;

static int find_kernels(void **state) {
    static const lar_isa wanted[] = {LAR_ISA_C, LAR_ISA_NEON, LAR_ISA_AVX2, LAR_ISA_AVX512};
    (void)state;
    kernels[kernel_count++] = &lar_kernels_c;
    for (int i = 0; i < 4; i++)
        if (lar_kernels_find(wanted[i], &kernels[kernel_count], NULL) == LAR_OK)
            print_message("kernels: %s\n", kernels[kernel_count++]->name);
    return 0;
}

/* The same elements twice: general and loose, and as boxes when they are some. */
typedef struct body {
    int turn; /* of boxes; -1: crooked elements */
    lar_law law;
    lar_block_rows rows;
    lar_hex8_block general[MAX];
    lar_box_block box[MAX];
    lar_block_more more[MAX];
    double x[ROOM][3];
    double u[ROOM][4] __attribute__((aligned(64)));
} body;

typedef struct forces {
    int64_t at[ROOM][4] __attribute__((aligned(64)));
} forces;

/* ---- rows of elements --------------------------------------------------------------------------
 */

static void fill_lane(body *b, int n, const int node[8]) {
    lar_hex8_block *general = &b->general[n / LAR_BLOCK];
    lar_box_block *box = &b->box[n / LAR_BLOCK];
    int lane = n % LAR_BLOCK;
    lar_material material = test_material((int)b->law, modulus_shear, modulus_bulk);
    double corner[8][3];
    lar_hex8 element;
    for (int a = 0; a < 8; a++) memcpy(corner[a], b->x[node[a]], sizeof corner[a]);
    lar_hex8_prepare((rows)corner, &material, &element);
    assert_true(element.volume > 0);
    for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
        for (int j = 0; j < 3; j++) {
            general->gradient[m][j][lane] = element.gradient[m][j];
            if (b->turn < 0) continue;
            if (m < 3 && j == (m + b->turn) % 3)
                box->gradient[m][lane] = element.gradient[m][j];
            else
                assert_true(element.gradient[m][j] == 0); /* what makes a box a box */
        }
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        for (int j = 0; j < 3; j++) {
            general->shape[m][j][lane] = element.shape[m][j];
            if (b->turn >= 0) assert_true(element.shape[m][j] == 0);
        }
        general->head.stiffness[m][lane] = scale * element.stiffness[m];
    }
    for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
        *lar_block_parameter(&general->head, &b->more[n / LAR_BLOCK], k, lane) =
            material.parameter[k] * (lar_law_scales(material.law, k) ? scale * element.volume : 1);
    for (int a = 0; a < 8; a++) general->head.node[a][lane] = node[a];
    box->head = general->head;
}

/* Corner a of place p in a row of `length`, whose four lines begin at nodes line[0..3]. */
static int row_node(const int line[4], int p, int a) {
    static const int line_of[8] = {0, 0, 1, 1, 2, 2, 3, 3};
    return line[line_of[a]] + p + (lar_node_sign[a][0] > 0);
}

/* Positions of a row that begins `start` cells along its own xi. */
static void place_row(body *b, uint64_t *seed, const int line[4], int length, int start) {
    for (int p = 0; p <= length; p++)
        for (int k = 0; k < 4; k++) {
            double natural[3] = {size * (start + p) * 1.25, size * (k % 2), size * (k / 2) * 0.75};
            for (int i = 0; i < 3; i++) {
                double jitter = b->turn < 0 ? 0.15 * size * random_value(seed) : 0;
                b->x[line[k] + p][(i + (b->turn < 0 ? 0 : b->turn)) % 3] = natural[i] + jitter;
            }
        }
}

/* Rows one behind the other and one beside the other: every second row begins where the one before
 * it ends (shared nodes), its lines going on; odd line beginnings for some (`shift`), as the rows
 * beside a longer one have them. Loose rows (LAR_ROWS_NONE) are eight elements in any lanes. */
static void make_body(body *b, uint64_t *seed, int turn, lar_law law, lar_block_rows joined) {
    memset(b, 0, sizeof *b);
    b->turn = turn;
    b->law = law;
    b->rows = joined;
    int length = joined == LAR_ROWS_FOUR ? 4 : 8, next = 0, line[4], start = 0;
    for (int first = 0; first < LANES; first += length) {
        bool goes_on = first / length % 3 == 1;
        for (int k = 0; k < 4; k++) {
            if (goes_on) {
                line[k] += length;
                continue;
            }
            int shift = first / length % 2;
            line[k] = next + next % 2 + shift;
            next = line[k] + 2 * length + 1;
        }
        start = goes_on ? start + length : 0;
        place_row(b, seed, line, length, start);
        if (goes_on) /* the shared section has moved: the row before is prepared with it */
            for (int p = 0; p < length; p++) {
                int node[8], before[4];
                for (int k = 0; k < 4; k++) before[k] = line[k] - length;
                for (int a = 0; a < 8; a++) node[a] = row_node(before, p, a);
                int n = first - length + p;
                fill_lane(b, n, node);
            }
        for (int p = 0; p < length; p++) {
            int node[8], n = first + p;
            for (int a = 0; a < 8; a++) node[a] = row_node(line, p, a);
            fill_lane(b, n, node);
        }
        assert_true(next < SPARE);
    }
    for (int p = 0; p < SPARE; p++) random_fill(seed, 0.12 * size, b->u[p], 3);
}

/* The first lane of those that the kernel names, or -1. */
static int64_t recover_run(int k, const lar_block_run *run, const double (*u)[4],
                           int64_t (*force)[4], const lar_hex8_limits *limits, bool monitor) {
    static int32_t lane[MAX * LAR_BLOCK];
    static double limit[MAX * LAR_BLOCK] __attribute__((aligned(64)));
    for (int i = 0; i < MAX * LAR_BLOCK; i++) limit[i] = INFINITY;
    static float strain[MAX * LAR_BLOCK][LAR_STRAIN_NUMBERS];
    lar_hex8_monitor listed = {.limit = limit, .lane = lane, .strain = strain};
    int64_t found = test_recover(kernels[k], run, ROOM, u, force, limits, monitor ? &listed : NULL);
    return found < 0 ? -1 : (found >> 8) * LAR_BLOCK + __builtin_ctz((unsigned)(found & 0xff));
}

static int64_t recover(const body *b, int k, bool boxes, lar_block_rows joined, int count,
                       const lar_hex8_limits *limits, bool monitor, forces *f) {
    lar_block_run run = {.law = b->law,
                         .shape = boxes ? LAR_SHAPE_BOX : LAR_SHAPE_GENERAL,
                         .rows = joined,
                         .turn = boxes ? b->turn : 0,
                         .count = count,
                         .blocks = boxes ? (const void *)b->box : b->general,
                         .more = lar_law_has_more(b->law) ? b->more : NULL};
    memset(f, 0, sizeof *f);
    return recover_run(k, &run, (const double(*)[4])b->u, f->at, limits, monitor);
}

static const lar_hex8_limits no_limits = {-INFINITY, INFINITY, INFINITY};

/* Every kind of block, every law, 0 to 9 blocks, watched or not: the forces of the plain C kernel
 * for loose general blocks. */
static void every_kind_gives_the_same_bits(void **state) {
    (void)state;
    static body b;
    static forces expected, f;
    int compared = 0;
    for (int turn = -1; turn < 3; turn++)
        for (int law = 0; law < LAR_LAW_COUNT; law++)
            for (int joined = 0; joined < LAR_ROWS_COUNT; joined++) {
                uint64_t seed = (uint64_t)(100 * turn + 10 * law + joined + 1000);
                make_body(&b, &seed, turn, (lar_law)law, (lar_block_rows)joined);
                for (int count = 0; count <= MAX; count++) {
                    recover(&b, 0, false, LAR_ROWS_NONE, count, &no_limits, false, &expected);
                    int64_t max = 0;
                    for (int p = 0; p < ROOM; p++)
                        for (int i = 0; i < 3; i++)
                            if (max < expected.at[p][i]) max = expected.at[p][i];
                    assert_true(count == 0 ? max == 0 : max > 1000000);
                    for (int k = 0; k < kernel_count; k++)
                        for (int form = 0; form < 4; form++) {
                            bool boxes = turn >= 0 && form / 2, monitor = form % 2;
                            assert_true(recover(&b, k, boxes, (lar_block_rows)joined, count,
                                                &no_limits, monitor, &f) == -1);
                            assert_memory_equal(&f, &expected, sizeof f);
                            compared++;
                        }
                }
            }
    print_message("%d force arrays compared\n", compared);
}

/* ---- limits ------------------------------------------------------------------------------------
 */

/* Squeezes, stretches or spoils one element of an otherwise resting body by the node in its middle
 * (`corner` 6 of place p), which only it and its neighbours in the row see. */
static int64_t beyond(body *b, int k, bool boxes, int n, const double u[3], bool monitor,
                      const lar_hex8_limits *limits) {
    static forces f, loose;
    double *at = b->u[b->general[n / 8].head.node[6][n % 8]];
    memcpy(at, u, 3 * sizeof *u);
    int64_t lane = recover(b, k, boxes, b->rows, MAX, limits, monitor, &f);
    assert_true(lane == recover(b, 0, false, LAR_ROWS_NONE, MAX, limits, monitor, &loose));
    memset(at, 0, 3 * sizeof *at);
    return lane;
}

/* The first of the elements that have node 6 of element n: itself or its neighbours in the row. */
static int64_t first_with_node(const body *b, int n) {
    int32_t node = b->general[n / 8].head.node[6][n % 8];
    for (int m = 0; m < LANES; m++)
        for (int a = 0; a < 8; a++)
            if (b->general[m / 8].head.node[a][m % 8] == node) return m;
    return -1;
}

static void limits_are_reported_in_every_kind(void **state) {
    (void)state;
    static body b;
    double stress = 2e5 * size * size * size * scale, hourglass = 0.004 * scale;
    const lar_hex8_limits limits = {0.05, stress * stress, hourglass * hourglass};
    const double nothing[3] = {0}, spoiled[3] = {0, NAN, 0}, endless[3] = {INFINITY, 0, 0};
    for (int turn = -1; turn < 3; turn++)
        for (int joined = 0; joined < LAR_ROWS_COUNT; joined++)
            for (int law = (turn + 1 + joined) % test_every(4); law < LAR_LAW_COUNT;
                 law += test_every(4)) {
                uint64_t seed = 7;
                make_body(&b, &seed, turn, (lar_law)law, (lar_block_rows)joined);
                memset(b.u, 0, sizeof b.u);
                double far[3] = {0}, bent[3] = {0};
                far[turn < 0 ? 1 : (turn + 1) % 3] = 60 * size;
                bent[turn < 0 ? 1 : (turn + 1) % 3] = 0.3 * size;
                for (int n = 0; n < LANES; n += n % 8 == 7 && n < 56 ? 25 : 1)
                    for (int form = 0; form < 4 * kernel_count; form++) {
                        int k = form / 4;
                        bool boxes = turn >= 0 && form % 2, monitor = form / 2 % 2;
                        int64_t own = first_with_node(&b, n);
                        assert_true(beyond(&b, k, boxes, n, nothing, monitor, &limits) == -1);
                        assert_true(beyond(&b, k, boxes, n, spoiled, monitor, &limits) == own);
                        assert_true(beyond(&b, k, boxes, n, endless, monitor, &limits) == own);
                        assert_true(beyond(&b, k, boxes, n, far, monitor, &limits) == own);
                        assert_true(beyond(&b, k, boxes, n, bent, monitor, &limits) ==
                                    (monitor ? own : -1));
                    }
            }
}

/* Nodes that no element of the run has keep what was there, beside and between the lines. */
static void no_other_node_is_touched(void **state) {
    (void)state;
    static body b;
    static forces before, f;
    static bool used[ROOM];
    for (int joined = 0; joined < LAR_ROWS_COUNT; joined++)
        for (int k = 0; k < kernel_count; k++) {
            uint64_t seed = 9;
            make_body(&b, &seed, joined % 2, LAR_LAW_neo_hookean, (lar_block_rows)joined);
            memset(used, 0, sizeof used);
            for (int n = 0; n < LANES; n++)
                for (int a = 0; a < 8; a++) used[b.general[n / 8].head.node[a][n % 8]] = true;
            for (int p = 0; p < ROOM; p++)
                for (int i = 0; i < 4; i++) f.at[p][i] = (int64_t)random_bits(&seed) >> 8;
            before = f;
            lar_block_run run = {.law = b.law,
                                 .shape = LAR_SHAPE_BOX,
                                 .rows = b.rows,
                                 .turn = b.turn,
                                 .count = MAX,
                                 .blocks = b.box};
            recover_run(k, &run, (const double(*)[4])b.u, f.at, &no_limits, true);
            int spared = 0;
            for (int p = 0; p < ROOM; p++) {
                assert_true(f.at[p][3] == before.at[p][3]);
                if (used[p]) continue;
                assert_memory_equal(f.at[p], before.at[p], sizeof f.at[p]);
                spared++;
            }
            assert_true(spared > 10);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_gives_the_same_bits),
        cmocka_unit_test(limits_are_reported_in_every_kind),
        cmocka_unit_test(no_other_node_is_touched),
    };
    return cmocka_run_group_tests(tests, find_kernels, NULL);
}
