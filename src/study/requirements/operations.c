#include "study/requirements/operations.h"

#include <string.h>

#include "mechanics/hex8_block.h"
#include "model/mesh/mesh.h"

const char *const lar_kernel_kind_name[LAR_KERNEL_KINDS] = {"hex8", "hex8 box", "hex8-full",
                                                            "hex8-matrix"};

/* A somewhat crooked element, its material and how it is deformed. */
typedef struct sample {
    lar_material material;
    double corner[8][3], u[8][3];
} sample;

static sample sample_of(int law) {
    sample s = {.material = {.law = (lar_law)law, .density = 1000}};
    lar_material_from_shear_bulk(&s.material, 1000, 20000);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) {
            int next = lar_node_sign[a][(i + 1) % 3];
            s.corner[a][i] = 0.005 * (lar_node_sign[a][i] + 0.1 * next * (a % 3));
            s.u[a][i] = 0.0002 * (next + 0.3 * i - 0.1 * a);
        }
    return s;
}

/* Eight of them, each with nodes of its own. */
static lar_operations count_block(const sample *s, bool box) {
    enum { NODES = 8 * LAR_BLOCK };
    lar_counted_block block;
    lar_hex8 element;
    double u[3][NODES] = {{0}};
    int64_t force[3][NODES] = {{0}};
    lar_operations counts = {0};
    memset(&block, 0, sizeof block);
    lar_hex8_prepare(s->corner, &s->material, &element);
    for (int lane = 0; lane < LAR_BLOCK; lane++) {
        for (int k = 0; k < LAR_LAW_PARAMETERS; k++)
            block.modulus[k][lane] =
                s->material.parameter[k] *
                (lar_law_scales(s->material.law, k) ? element.volume * 0x1p40 : 1);
        for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
            block.stiffness[m][lane] = element.stiffness[m] * 0x1p40;
        for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
            for (int j = 0; j < 3; j++)
                block.gradient[m][j][lane] = element.gradient[m][box ? (j + m) % 3 : j];
        for (int m = 0; m < LAR_HEX8_HOURGLASS; m++)
            for (int j = 0; j < 3; j++) block.shape[m][j][lane] = element.shape[m][j];
        for (int a = 0; a < 8; a++) {
            block.node[a][lane] = 8 * lane + a;
            for (int i = 0; i < 3; i++) u[i][8 * lane + a] = s->u[a][i];
        }
    }
    lar_counted_recover((int)s->material.law, box, &block, &u[0][0], NODES, &force[0][0], &counts);
    return counts;
}

/* A count of all of eight, for one: they all need the same. */
static lar_operations eighth(lar_operations all) {
    int64_t *const part[] = {&all.additions,   &all.multiplications, &all.fused,
                             &all.divisions,   &all.roots,           &all.integer_additions,
                             &all.conversions, &all.bytes_loaded,    &all.bytes_stored};
    for (size_t i = 0; i < sizeof part / sizeof part[0]; i++) *part[i] /= 8;
    return all;
}

lar_operations lar_operations_of_element(lar_kernel_kind kind, int law) {
    const sample s = sample_of(law);
    lar_operations counts = {0};
    double force[8][3];
    switch (kind) {
    case LAR_KERNEL_FULL:
        lar_counted_full(law, s.material.parameter, s.corner, s.u, force, &counts);
        return counts;
    case LAR_KERNEL_MATRIX:
        lar_counted_matrix(law, s.material.parameter, s.corner, s.u, force, &counts);
        return counts;
    default:
        return eighth(count_block(&s, kind == LAR_KERNEL_HEX8_BOX));
    }
}

lar_operations lar_operations_of_node(void) {
    double u[3][8] = {{0}}, v[3][8] = {{0}}, push[8] = {0};
    int64_t force[3][8] = {{0}};
    lar_operations counts = {0};
    lar_counted_update(1, 1e-4, &u[0][0], &v[0][0], &force[0][0], push, &counts);
    counts.bytes_stored -= (int64_t)sizeof(double); /* the greatest speed, once per call */
    return eighth(counts);
}

/* The slow kinds read corners and material instead of a block, and have no force sums of their
 * own in between. */
lar_step_bytes lar_bytes_of_element(lar_kernel_kind kind, int law) {
    const size_t more = lar_law_has_more((lar_law)law) ? sizeof(lar_block_more) : 0;
    switch (kind) {
    case LAR_KERNEL_HEX8:
        return (lar_step_bytes){(int64_t)(sizeof(lar_hex8_block) + more) / LAR_BLOCK, 0};
    case LAR_KERNEL_HEX8_BOX:
        return (lar_step_bytes){(int64_t)(sizeof(lar_box_block) + more) / LAR_BLOCK, 0};
    default:
        return (lar_step_bytes){8 * (int64_t)sizeof(int32_t), 0};
    }
}

lar_step_bytes lar_bytes_of_node(void) {
    const int64_t node = 3 * (int64_t)sizeof(double);
    /* u, v and f are read and written; push is read. */
    return (lar_step_bytes){3 * node + (int64_t)sizeof(double), 3 * node};
}
