/* Counting changes no bit, counts what is there, and depends on nothing but the code. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "law/every_term.h"
#include "mechanics/hex8_block.h"
#include "mechanics/hex8_full.h"
#include "mechanics/hex8_matrix.h"
#include "model/mesh/mesh.h"
#include "study/requirements/operations.h"

enum { NODES = 64 };

/* -1..1 */
static double next_random(uint64_t *state) {
    *state = *state * 6364136223846793005ULL + 1442695040888963407ULL;
    return (double)(int32_t)(*state >> 32) * 0x1p-31;
}

/* Eight elements with nodes of their own, of some shape and in some state. */
typedef struct block {
    lar_material material;
    double corner[8][8][3];
    double u[3][NODES];
    lar_counted_block numbers;
    lar_hex8_block general;
    lar_box_block boxes;
    lar_block_more more;
} block;

static void make_block(int law, bool box, uint64_t seed, block *b) {
    memset(b, 0, sizeof *b);
    b->material = (lar_material){.law = (lar_law)law, .density = 1000};
    lar_material_from_shear_bulk(&b->material, 1500, 30000);
    every_term(&b->material, 0.3);
    for (int lane = 0; lane < 8; lane++) {
        lar_hex8 e;
        for (int a = 0; a < 8; a++)
            for (int i = 0; i < 3; i++) {
                double off = box ? 0 : 0.2 * next_random(&seed);
                b->corner[lane][a][i] = 0.004 * (lar_node_sign[a][i] + off);
                b->u[i][8 * lane + a] = 0.0005 * next_random(&seed);
            }
        lar_hex8_prepare((const double(*)[3])b->corner[lane], &b->material, &e);
        lar_block_head *const head[2] = {&b->general.head, &b->boxes.head};
        for (int h = 0; h < 2; h++) {
            for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
                *lar_block_parameter(head[h], &b->more, k, lane) =
                    b->material.parameter[k] *
                    (lar_law_scales(b->material.law, k) ? e.volume * 0x1p40 : 1);
            for (int m = 0; m < 4; m++) head[h]->stiffness[m][lane] = e.stiffness[m] * 0x1p40;
            for (int a = 0; a < 8; a++) head[h]->node[a][lane] = 8 * lane + a;
        }
        for (int j = 0; j < 3; j++) {
            for (int m = 0; m < 6; m++) b->general.gradient[m][j][lane] = e.gradient[m][j];
            for (int m = 0; m < 4; m++) b->general.shape[m][j][lane] = e.shape[m][j];
            b->boxes.gradient[j][lane] = e.gradient[j][j];
        }
    }
    memcpy(b->numbers.modulus, b->general.head.modulus, sizeof b->general.head.modulus);
    memcpy(b->numbers.modulus[LAR_BLOCK_PARAMETERS], b->more.modulus, sizeof b->more.modulus);
    memcpy(b->numbers.stiffness, b->general.head.stiffness, sizeof b->numbers.stiffness);
    memcpy(b->numbers.node, b->general.head.node, sizeof b->numbers.node);
    memcpy(b->numbers.shape, b->general.shape, sizeof b->numbers.shape);
    memcpy(b->numbers.gradient, b->general.gradient, sizeof b->numbers.gradient);
    for (int m = 0; box && m < 3; m++)
        memcpy(b->numbers.gradient[m][0], b->boxes.gradient[m], sizeof b->boxes.gradient[m]);
}

static void recovering_has_the_same_bits(void **state) {
    (void)state;
    const lar_kernels *plain;
    const lar_hex8_limits limits = {1e-3, INFINITY, INFINITY};
    assert_int_equal(lar_kernels_find(LAR_ISA_C, &plain, NULL), LAR_OK);
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        for (int box = 0; box < 2; box++)
            for (uint64_t seed = 1; seed < 20; seed++) {
                block b;
                int64_t force[3][NODES], expected[3][NODES];
                lar_operations counts = {0};
                make_block(law, box, seed, &b);
                for (int n = 0; n < NODES; n++)
                    for (int i = 0; i < 3; i++) force[i][n] = expected[i][n] = n - 30;
                const lar_block_run run = {.law = (lar_law)law,
                                           .shape = box ? LAR_SHAPE_BOX : LAR_SHAPE_GENERAL,
                                           .rows = LAR_ROWS_NONE,
                                           .count = 1,
                                           .axis_stride = NODES,
                                           .blocks = box ? (void *)&b.boxes : (void *)&b.general,
                                           .more = lar_law_has_more((lar_law)law) ? &b.more : NULL};
                assert_int_equal(plain->recover(&run, &b.u[0][0], &expected[0][0], &limits, false),
                                 -1);
                lar_counted_recover(law, box, &b.numbers, &b.u[0][0], NODES, &force[0][0], &counts);
                assert_memory_equal(force, expected, sizeof force);
                /* And all eight cost what one element is said to cost, whatever the values. */
                lar_kernel_kind kind = box ? LAR_KERNEL_HEX8_BOX : LAR_KERNEL_HEX8;
                lar_operations one = lar_operations_of_element(kind, law);
                assert_int_equal(lar_operations_floating(&counts),
                                 8 * lar_operations_floating(&one));
                assert_int_equal(counts.integer_additions, 8 * one.integer_additions);
                assert_int_equal(counts.bytes_loaded, 8 * one.bytes_loaded);
            }
}

static void moving_has_the_same_bits(void **state) {
    (void)state;
    enum { MOVED = 8 };
    const lar_kernels *plain;
    uint64_t seed = 7;
    double u[2][3][MOVED] __attribute__((aligned(64))), v[2][3][MOVED] __attribute__((aligned(64)));
    double push[MOVED] __attribute__((aligned(64))), damped = 0, fastest = 0;
    int64_t force[2][3][MOVED] __attribute__((aligned(64)));
    lar_operations counts = {0};
    const lar_leapfrog motion = {.keep = 0.999, .dt = 1e-4, .speed = INFINITY, .push = 1};
    assert_int_equal(lar_kernels_find(LAR_ISA_C, &plain, NULL), LAR_OK);
    for (int n = 0; n < MOVED; n++) {
        push[n] = 1e-12 * (2 + next_random(&seed));
        for (int i = 0; i < 3; i++) {
            u[0][i][n] = u[1][i][n] = next_random(&seed);
            v[0][i][n] = v[1][i][n] = next_random(&seed);
            force[0][i][n] = force[1][i][n] = (int64_t)(1e15 * next_random(&seed));
        }
    }
    assert_true(plain->update(&motion, 0, MOVED, MOVED, &u[0][0][0], &v[0][0][0], &force[0][0][0],
                              push, NULL, &damped, &fastest));
    lar_counted_update(motion.keep, motion.dt, &u[1][0][0], &v[1][0][0], &force[1][0][0], push,
                       &counts);
    assert_memory_equal(u[0], u[1], sizeof u[0]);
    assert_memory_equal(v[0], v[1], sizeof v[0]);
    assert_memory_equal(force[0], force[1], sizeof force[0]);
    assert_int_equal(counts.fused, 8 * lar_operations_of_node().fused);
}

typedef double element_force(const double corner[8][3], const lar_material *material,
                             const double u[8][3], double force[8][3]);
typedef double counted_force(int law, const double parameter[LAR_LAW_PARAMETERS],
                             const double corner[8][3], const double u[8][3], double force[8][3],
                             lar_operations *counts);

static void slow_kinds_have_the_same_bits(void **state) {
    (void)state;
    static element_force *const plain[2] = {lar_hex8_full_force, lar_hex8_matrix_force};
    static counted_force *const counting[2] = {lar_counted_full, lar_counted_matrix};
    for (int kind = 0; kind < 2; kind++)
        for (int law = 0; law < LAR_LAW_COUNT; law++)
            for (int lane = 0; lane < 8; lane++) {
                block b;
                double u[8][3], force[8][3], expected[8][3];
                lar_operations counts = {0};
                make_block(law, false, 3, &b);
                for (int k = 0; k < 24; k++) u[k / 3][k % 3] = b.u[k % 3][8 * lane + k / 3];
                const double(*corner)[3] = (const double(*)[3])b.corner[lane];
                double J = plain[kind](corner, &b.material, (const double(*)[3])u, expected);
                double counted = counting[kind](law, b.material.parameter, corner,
                                                (const double(*)[3])u, force, &counts);
                assert_memory_equal(&J, &counted, sizeof J);
                assert_memory_equal(force, expected, sizeof force);
                lar_operations one =
                    lar_operations_of_element(kind == 0 ? LAR_KERNEL_FULL : LAR_KERNEL_MATRIX, law);
                assert_int_equal(lar_operations_floating(&counts), lar_operations_floating(&one));
            }
}

/* By hand, from the formulas of hex8.h. Whoever makes the kernel do more, or less, changes these
 * numbers here and in docs/requirements.md. */
static void hex8_costs_what_its_formulas_say(void **state) {
    (void)state;
    const lar_operations o = lar_operations_of_element(LAR_KERNEL_HEX8, LAR_LAW_neo_hookean);
    /* Modes: 8 sums and differences along xi, 8 along eta, 7 along zeta, three axes. */
    const int modes = 3 * (8 + 8 + 7);
    /* H: 18 gradients times 3 axes, nine of them without an addition. q = U - H X: 4 x 9. */
    const int gradient_fused = 45, hourglass_fused = 36;
    /* S - c q X: 36. S B: 6 modes x 9; three modes begin with a product (9), three with c q. */
    const int force_fused = 36 + 54 - 9;
    /* Cofactor 9 and determinant 2; |F|^2 6; J^(-1/3) 1 + 2 x 4; the law 1, 9 and 1. */
    const int law_fused = 9 + 2 + 6 + 9 + 11;
    assert_int_equal(o.fused, gradient_fused + hourglass_fused + force_fused + law_fused);
    /* One on the diagonal; |F|^2 is two sums; J - 1. */
    assert_int_equal(o.additions, modes + 3 + 2 + 1);
    /* Back: 7 per axis and half, 4 edges x 2 x 3, 8 nodes x 3. */
    assert_int_equal(o.integer_additions, 2 * 3 * 7 + 24 + 24);
    assert_int_equal(o.conversions, 21);
    assert_int_equal(o.divisions + o.roots, 0);
    assert_int_equal(lar_operations_floating(&o), 540);
    assert_int_equal(lar_operations_all(&o), 630);
    assert_true(lar_operations_all(&o) < 816);
}

static void counts_are_the_documented_ones(void **state) {
    (void)state;
    static const int documented[LAR_KERNEL_KINDS] = {630, 306, 8296, 119504};
    for (int k = 0; k < LAR_KERNEL_KINDS; k++) {
        lar_operations o = lar_operations_of_element((lar_kernel_kind)k, LAR_LAW_neo_hookean);
        assert_int_equal(lar_operations_all(&o), documented[k]);
    }
    lar_operations node = lar_operations_of_node();
    assert_int_equal(lar_operations_all(&node), 18);
    assert_int_equal(node.bytes_loaded, 3 * 3 * 8 + 8);
    assert_int_equal(node.bytes_stored, 3 * 3 * 8);
}

static void bytes_are_those_of_the_blocks(void **state) {
    (void)state;
    assert_int_equal(lar_bytes_of_element(LAR_KERNEL_HEX8, LAR_LAW_neo_hookean).read, 328);
    assert_int_equal(lar_bytes_of_element(LAR_KERNEL_HEX8_BOX, LAR_LAW_neo_hookean).read, 112);
    lar_step_bytes node = lar_bytes_of_node();
    assert_int_equal(node.read + node.written, 3 * 2 * 24 + 8);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(recovering_has_the_same_bits),
                                       cmocka_unit_test(moving_has_the_same_bits),
                                       cmocka_unit_test(slow_kinds_have_the_same_bits),
                                       cmocka_unit_test(hex8_costs_what_its_formulas_say),
                                       cmocka_unit_test(counts_are_the_documented_ones),
                                       cmocka_unit_test(bytes_are_those_of_the_blocks)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
