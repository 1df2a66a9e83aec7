/* What the tests of layouts share: what must hold of every layout, looked at from the outside only
 * (blocks, corners and numbers), and meshes to try them on. */
#ifndef LAR_TESTS_LAYOUT_TEST_H
#define LAR_TESTS_LAYOUT_TEST_H

#include "base/simd.h"
#include "layout/row_plan.h"
#include "engine_test.h"

/* ---- what must hold ------------------------------------------------------------------------- */

/* `turned` is `node` seen from another side: the same nodes, edges and handedness. */
TEST_UNUSED static bool is_turn(const int32_t node[8], const int32_t turned[8]) {
    int old[8];
    for (int a = 0; a < 8; a++) {
        old[a] = 0;
        while (old[a] < 8 && node[old[a]] != turned[a]) old[a]++;
        if (old[a] == 8) return false;
    }
    double axis[3][3]; /* old natural directions of the new xi, eta, zeta */
    static const int end[3] = {1, 3, 4};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            axis[i][k] = 0.5 * (lar_node_sign[old[end[i]]][k] - lar_node_sign[old[0]][k]);
    for (int a = 0; a < 8; a++)
        for (int k = 0; k < 3; k++) {
            double sign = 0;
            for (int i = 0; i < 3; i++) sign += lar_node_sign[a][i] * axis[i][k];
            if (sign != lar_node_sign[old[a]][k]) return false;
        }
    double det = 0;
    for (int k = 0; k < 3; k++)
        det += axis[0][k] * (axis[1][(k + 1) % 3] * axis[2][(k + 2) % 3] -
                             axis[1][(k + 2) % 3] * axis[2][(k + 1) % 3]);
    return det == 1;
}

TEST_UNUSED static bool is_box(const lar_mesh *mesh, const lar_gid corner[8], int turn) {
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) {
            int axis = (i + turn) % 3;
            double x = mesh->position[corner[a]][axis];
            if (x != mesh->position[corner[lar_node_sign[a][i] < 0 ? 0 : 6]][axis]) return false;
        }
    for (int i = 0; i < 3; i++)
        if (!(mesh->position[corner[0]][i] < mesh->position[corner[6]][i])) return false;
    return true;
}

/* The ranges of the threads, one behind the other. */
TEST_UNUSED static void check_ranges(const lar_layout *layout) {
    assert_in_range(layout->thread_count, 1, LAR_LAYOUT_THREADS);
    assert_int_equal(layout->first_node[0], 0);
    for (int t = 0; t < LAR_LAYOUT_THREADS; t++) {
        assert_true(layout->first_node[t] % LAR_NODES_TOGETHER == 0);
        assert_true(layout->first_node[t] <= layout->first_node[t + 1]);
    }
    for (int t = layout->thread_count; t <= LAR_LAYOUT_THREADS; t++)
        assert_int_equal(layout->first_node[t], layout->node_padded);
}

static bool begins_range(const lar_layout *layout, lar_lid n) {
    bool begins = false;
    for (int t = 0; t < layout->thread_count; t++) begins |= layout->first_node[t] == n;
    return begins;
}

/* From node n on a range has spare nodes only. */
static bool fills_up(const lar_layout *layout, lar_lid n) {
    while (n < layout->node_padded && layout->global[n] < 0 && !begins_range(layout, n)) n++;
    return n == layout->node_padded || begins_range(layout, n);
}

/* `owner`: thread that moves a node of the model, -1: not in the layout; NULL: all thread 0. */
TEST_UNUSED static void check_nodes(const lar_mesh *mesh, const lar_layout *layout,
                                    const int32_t *owner) {
    int32_t real = 0;
    assert_true(layout->node_padded % LAR_NODES_TOGETHER == 0);
    assert_in_range(layout->node_padded, layout->node_count + 1,
                    layout->node_count + LAR_NODES_TOGETHER);
    check_ranges(layout);
    for (lar_gid n = 0; n < mesh->node_count; n++) {
        int32_t thread = owner ? owner[n] : 0;
        if (thread < 0) {
            assert_int_equal(layout->local[n], -1);
            continue;
        }
        real++;
        assert_true(layout->local[n] >= layout->first_node[thread]);
        assert_true(layout->local[n] < layout->first_node[thread + 1]);
        assert_true(layout->local[n] < layout->node_count);
        assert_int_equal(layout->global[layout->local[n]], n);
    }
    int32_t spare = 0;
    for (lar_lid n = 0; n < layout->node_padded; n++) {
        assert_in_range(layout->global[n] + 1, 0, mesh->node_count);
        spare += layout->global[n] < 0;
        if (n >= layout->node_count) assert_int_equal(layout->global[n], -1);
        if (n > 0 && layout->global[n] < 0 && layout->global[n - 1] < 0)
            assert_true(fills_up(layout, n) || begins_range(layout, n));
    }
    assert_int_equal(spare, layout->node_padded - real);
}

/* The last lane may have no element: then the number behind each line is there, and nobody's but
 * the thread's own. */
TEST_UNUSED static int check_row(const lar_layout *layout, const lar_lanes *block, int first,
                                 int lanes) {
    bool spare = block->element[first + lanes - 1] < 0;
    int length = spare ? lanes - 1 : lanes;
    for (int k = 0; k < length; k++) assert_true(block->element[first + k] >= 0);
    for (int line = 0; line < 4; line++) {
        lar_lid begin = layout->local[layout->corner[block->element[first]][lar_line_left[line]]];
        for (int k = 0; k < length; k++) {
            const lar_gid *node = layout->corner[block->element[first + k]];
            assert_int_equal(layout->local[node[lar_line_left[line]]], begin + k);
            assert_int_equal(layout->local[node[lar_line_right[line]]], begin + k + 1);
        }
        if (!spare) continue;
        assert_in_range(begin, layout->first_node[block->thread], layout->node_padded - 1 - lanes);
        assert_true(begin + lanes < layout->first_node[block->thread + 1]);
    }
    return length;
}

TEST_UNUSED static void check_block(const lar_model *model, const lar_layout *layout,
                                    const lar_lanes *block, bool *seen) {
    int elements = 0;
    for (int lane = 0; lane < LAR_BLOCK; lane++) {
        lar_gid e = block->element[lane];
        if (e < 0) continue;
        assert_in_range(e, 0, model->mesh.element_count - 1);
        assert_false(seen[e]);
        seen[e] = true;
        elements++;
        assert_int_equal(model->material[model->element_material[e]].law, block->law);
        if (block->shape == LAR_SHAPE_BOX)
            assert_true(is_box(&model->mesh, layout->corner[e], block->turn));
        else
            assert_int_equal(block->turn, 0);
    }
    assert_true(elements > 0);
    if (block->rows == LAR_ROWS_NONE) return;
    if (block->rows == LAR_ROWS_EIGHT)
        assert_int_equal(elements, check_row(layout, block, 0, 8));
    else
        assert_int_equal(elements, check_row(layout, block, 0, 4) + check_row(layout, block, 4, 4));
}

/* Threads and batches one after the other; within, equal kinds stand together. */
TEST_UNUSED static void check_order(const lar_layout *layout) {
    bool met[LAR_LAW_COUNT][LAR_SHAPE_COUNT][3][LAR_ROWS_COUNT];
    for (int32_t b = 0; b < layout->block_count; b++) {
        const lar_lanes *block = &layout->block[b], *last = block - 1;
        bool together = b > 0 && last->thread == block->thread && last->batch == block->batch;
        if (!together) {
            memset(met, 0, sizeof met);
            assert_true(b == 0 || last->thread < block->thread ||
                        (last->thread == block->thread && last->batch < block->batch));
        }
        bool *here = &met[block->law][block->shape][block->turn][block->rows];
        bool same = together && last->law == block->law && last->shape == block->shape &&
                    last->turn == block->turn && last->rows == block->rows;
        assert_int_equal(*here, same);
        *here = true;
    }
}

typedef struct share {
    int32_t elements, loose, boxes;
} share;

TEST_UNUSED static share what_is_in(const lar_layout *layout, int32_t elements) {
    share in = {elements, 0, 0};
    for (int32_t b = 0; b < layout->block_count; b++)
        for (int lane = 0; lane < LAR_BLOCK; lane++)
            if (layout->block[b].element[lane] >= 0) {
                in.loose += layout->block[b].rows == LAR_ROWS_NONE;
                in.boxes += layout->block[b].shape == LAR_SHAPE_BOX;
            }
    return in;
}

/* ---- meshes ---------------------------------------------------------------------------------- */

TEST_UNUSED static uint32_t chance_state;

TEST_UNUSED static int chance(int below) {
    chance_state = chance_state * 1664525u + 1013904223u;
    return (int)(chance_state >> 8) % below;
}

TEST_UNUSED static lar_model *boxes(int nx, int ny, int nz, double shift) {
    brick b = {{nx, ny, nz}, 0.01, shift, LAR_LAW_neo_hookean, 2e3, 2e4, 1000};
    return brick_model(&b);
}

/* Leaves only the elements with keep[e], and their nodes. */
TEST_UNUSED static void keep_elements(lar_mesh *mesh, const bool *keep) {
    int32_t *number = lar_calloc((size_t)mesh->node_count, sizeof *number), nodes = 0, kept = 0;
    for (int32_t e = 0; e < mesh->element_count; e++)
        if (keep[e]) memcpy(mesh->element[kept++], mesh->element[e], sizeof *mesh->element);
    mesh->element_count = kept;
    for (int32_t e = 0; e < kept; e++)
        for (int a = 0; a < 8; a++) number[mesh->element[e][a]] = 1;
    for (int32_t n = 0; n < mesh->node_count; n++) {
        if (!number[n]) continue;
        memcpy(mesh->position[nodes], mesh->position[n], sizeof mesh->position[n]);
        number[n] = nodes++;
    }
    mesh->node_count = nodes;
    for (int32_t e = 0; e < kept; e++)
        for (int a = 0; a < 8; a++) mesh->element[e][a] = number[mesh->element[e][a]];
    free(number);
}

/* Numbers the nodes of every element from another of its 24 sides. */
TEST_UNUSED static void turn_elements(lar_mesh *mesh) {
    for (int32_t e = 0; e < mesh->element_count; e++) {
        int32_t node[8], turned[8];
        memcpy(node, mesh->element[e], sizeof node);
        do { /* any of the 48 ways until it is right-handed */
            int first = chance(3), second = (first + 1 + chance(2)) % 3;
            int axis[3] = {first, second, 3 - first - second};
            int flip[3] = {chance(2), chance(2), chance(2)};
            for (int a = 0; a < 8; a++)
                for (int b = 0; b < 8; b++) {
                    bool same = true;
                    for (int i = 0; i < 3; i++)
                        same = same && lar_node_sign[b][axis[i]] ==
                                           (flip[i] ? -1 : 1) * lar_node_sign[a][i];
                    if (same) turned[a] = node[b];
                }
        } while (!is_turn(node, turned));
        memcpy(mesh->element[e], turned, sizeof turned);
    }
}

/* Three laws: in layers along x where `layers`, else at random. */
TEST_UNUSED static void mix_laws(lar_model *model, bool layers) {
    for (int law = 1; law < LAR_LAW_COUNT; law++) {
        lar_material *material = LAR_MODEL_APPEND(model, material);
        material->law = (lar_law)law;
        material->density = 1000;
        lar_material_from_shear_bulk(material, 2e3, 2e4);
    }
    for (int32_t e = 0; e < model->mesh.element_count; e++)
        model->element_material[e] =
            layers ? (int)(model->mesh.position[model->mesh.element[e][0]][0] / 0.05) %
                         model->material_count
                   : chance(model->material_count);
}

/* A ring of `around` elements with a section of width x width; after one round the section has
 * made `quarters` quarter turns, so that the rows of a twisted ring go round several times. */
TEST_UNUSED static lar_model *ring(int around, int width, int quarters) {
    int side = width + 1, section = side * side;
    lar_model *model = boxes(around, width, width, 0); /* the arrays have room enough */
    lar_mesh *mesh = &model->mesh;
    mesh->node_count = around * section;
    double radius = 6 * width, quarter = 1.5707963267948966;
    for (int j = 0; j < around; j++)
        for (int k = 0; k < side; k++)
            for (int i = 0; i < side; i++) {
                double angle = 4 * quarter * j / around, twist = quarter * quarters * j / around;
                double s = i - 0.5 * width, t = k - 0.5 * width;
                double r = radius + s * cos(twist) - t * sin(twist);
                double at[3] = {r * cos(angle), r * sin(angle), s * sin(twist) + t * cos(twist)};
                memcpy(mesh->position[i + side * k + section * j], at, sizeof at);
            }
    int32_t e = 0;
    for (int j = 0; j < around; j++)
        for (int k = 0; k < width; k++)
            for (int i = 0; i < width; i++, e++)
                for (int a = 0; a < 8; a++) {
                    int at[2] = {i + (lar_node_sign[a][0] > 0), k + (lar_node_sign[a][2] > 0)};
                    int along = j + (lar_node_sign[a][1] > 0);
                    for (int q = 0; along == around && q < quarters; q++) {
                        int turned[2] = {width - at[1], at[0]};
                        memcpy(at, turned, sizeof at);
                    }
                    mesh->element[e][a] = at[0] + side * at[1] + section * (along % around);
                }
    return model;
}

/* A row that leaves an element towards x, makes a loop to the right and crosses the same element
 * again towards y. Sections 0 and SECTIONS - 1 are faces of that element. */
TEST_UNUSED static lar_model *loop(void) {
    enum { SECTIONS = 40 };
    lar_model *model = boxes(SECTIONS, 1, 1, 0);
    lar_mesh *mesh = &model->mesh;
    const double bend = 6, pi = 3.14159265358979324;
    int32_t node[SECTIONS][4], count = 0;
    for (int n = 0; n < SECTIONS - 1; n++) {
        int arc = n < 5 ? 0 : n > SECTIONS - 6 ? SECTIONS - 11 : n - 5;
        double heading = -1.5 * pi * arc / (SECTIONS - 11);
        double x = bend - bend * sin(heading), y = -bend + bend * cos(heading);
        if (n < 5) x = 0.5 + 1.1 * n;
        if (n > SECTIONS - 6) y = -0.5 - 1.1 * (SECTIONS - 1 - n);
        for (int k = 0; k < 4; k++) { /* eta to the left, zeta up */
            double left = k % 2 ? 0.5 : -0.5;
            double at[3] = {x - left * sin(heading), y + left * cos(heading), k / 2};
            memcpy(mesh->position[count], at, sizeof at);
            node[n][k] = count++;
        }
    }
    for (int up = 0; up < 2; up++) /* the left side of the crossing */
        for (int k = 0; k < 2; k++)
            memcpy(mesh->position[count++], (double[]){-0.5, k - 0.5, up}, 24);
    int32_t far[4] = {count - 4, count - 3, count - 2, count - 1};
    /* heading to y, left is -x: the lower side of the crossing */
    memcpy(node[SECTIONS - 1], (int32_t[]){node[0][0], far[0], node[0][2], far[2]}, 16);
    for (int n = 0; n < SECTIONS; n++) {
        const int32_t *a = n ? node[n - 1] : far, *b = n ? node[n] : node[0];
        memcpy(mesh->element[n], (int32_t[]){a[0], b[0], b[1], a[1], a[2], b[2], b[3], a[3]}, 32);
    }
    mesh->node_count = count;
    return model;
}

/* A node of ring k around a core of width x width elements, counter-clockwise from its corner; ring
 * 0 is the core's outline. */
static int32_t disc_node(int width, int k, int along) {
    int side = width + 1, p = along % (4 * width), q = p % width;
    const int at[4][2] = {{q, 0}, {width, q}, {width - q, width}, {0, width - q}};
    if (k > 0) return side * side + 4 * width * (k - 1) + p;
    return at[p / width][0] + side * at[p / width][1];
}

/* A disc of several layers: a square core, and rings around it that four blocks make. Lines of
 * nodes turn around the core, and one that leaves it may come back beside itself. */
TEST_UNUSED static lar_model *disc(int width, int rings, int layers) {
    int side = width + 1, section = side * side + 4 * width * rings;
    lar_model *model = boxes((width * width + 4 * width * rings) * layers, 1, 1, 0);
    lar_mesh *mesh = &model->mesh;
    mesh->node_count = section * (layers + 1);
    for (int l = 0; l <= layers; l++) {
        double(*at)[3] = mesh->position + section * l;
        for (int n = 0; n < side * side; n++)
            memcpy(at[n], (double[]){n % side - 0.5 * width, n / side - 0.5 * width, l}, 24);
        for (int n = 0; n < 4 * width * rings; n++) {
            const double *inner = at[disc_node(width, 0, n)];
            double out = 1 + 0.5 * (n / (4 * width) + 1), turn = hypot(inner[0], inner[1]) / width;
            memcpy(at[side * side + n], (double[]){out * inner[0] / turn, out * inner[1] / turn, l},
                   24);
        }
    }
    int32_t e = 0;
    for (int l = 0; l < layers; l++)
        for (int n = 0; n < width * width + 4 * width * rings; n++, e++) {
            int i = n % width, j = n / width, inside = n < width * width;
            int p = inside ? 0 : n - width * width, k = p / (4 * width);
            const int32_t core[4] = {i + side * j, i + 1 + side * j, i + 1 + side * (j + 1),
                                     i + side * (j + 1)};
            const int32_t around[4] = {disc_node(width, k + 1, p % (4 * width)),
                                       disc_node(width, k + 1, p % (4 * width) + 1),
                                       disc_node(width, k, p % (4 * width) + 1),
                                       disc_node(width, k, p % (4 * width))};
            for (int a = 0; a < 8; a++)
                mesh->element[e][a] = (inside ? core : around)[a % 4] + section * (l + a / 4);
        }
    return model;
}

#endif
