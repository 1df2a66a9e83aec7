/* The cells of the demonstration organ and a first guess where their nodes are. */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "model/demo/demo_parts.h"
#include "model/mesh/mesh.h"

/* Bricks of cells, i0 <= i < i1 and so on, for the half i >= 0. Together 920 cells; a later brick
 * does not overlap an earlier one. */
static const struct brick {
    int i0, i1, j0, j1, k0, k1, part;
} bricks[] = {
    {0, 4, 0, 8, 0, 6, LAR_DEMO_UTERUS},       /* cervix */
    {0, 6, 0, 8, 6, 18, LAR_DEMO_UTERUS},      /* corpus and fundus */
    {6, 15, 3, 5, 14, 16, LAR_DEMO_TUBES},     /* tube, from the cornu outwards */
    {13, 15, 3, 5, 11, 14, LAR_DEMO_TUBES},    /* tube, the free end turning down */
    {6, 12, 3, 5, 12, 14, LAR_DEMO_LIGAMENTS}, /* mesosalpinx, under the tube */
    {6, 8, 3, 5, 8, 12, LAR_DEMO_LIGAMENTS},   /* broad ligament with the ovarian ligament */
    {8, 12, 2, 6, 9, 12, LAR_DEMO_OVARIES},
    {3, 5, -4, 0, 12, 14, LAR_DEMO_LIGAMENTS}, /* round ligament */
};
enum { BRICKS = sizeof bricks / sizeof bricks[0] };

/* Number of the node at grid point (I, J, K), -1 where there is none. */
typedef int node_table[LAR_DEMO_K_END + 1][LAR_DEMO_J_NODES][LAR_DEMO_I_END + 1];

static int *node_at(node_table table, int i, int j, int k) {
    return &table[k][j - LAR_DEMO_J_FIRST][i];
}

void lar_demo_half_clear(lar_demo_half *half) {
    free(half->grid);
    free(half->position);
    free(half->corner);
    free(half->cell);
    free(half->part);
    *half = (lar_demo_half){0};
}

static void add_cell(lar_demo_half *half, node_table table, int i, int j, int k, int part) {
    const int e = half->cell_count++;
    half->part[e] = part;
    half->cell[e][0] = i;
    half->cell[e][1] = j;
    half->cell[e][2] = k;
    for (int a = 0; a < 8; ++a) {
        const int at[3] = {i + (lar_node_sign[a][0] > 0), j + (lar_node_sign[a][1] > 0),
                           k + (lar_node_sign[a][2] > 0)};
        int *node = node_at(table, at[0], at[1], at[2]);
        if (*node < 0) {
            *node = half->node_count++;
            for (int c = 0; c < 3; ++c) half->grid[*node][c] = at[c];
        }
        half->corner[e][a] = *node;
    }
}

/* Square [-1, 1]^2 to disc, bent only so far that corners keep an angle. */
static void round_off(double *u, double *v) {
    const double bend = 0.42;
    const double x = *u * sqrt(1.0 - bend * *v * *v), y = *v * sqrt(1.0 - bend * *u * *u);
    *u = x;
    *v = y;
}

static void guess_uterus(const int at[3], double p[3]) {
    const double z = at[2] / (double)LAR_DEMO_K_END;
    double u = at[0] / (at[2] < 6 ? 4.0 : at[0] > 4 || at[2] > 8 ? 6.0 : 5.0);
    double v = (at[1] - 4) / 4.0, w = z < 0.5 ? 0.0 : 2.0 * z - 1.0;
    const double flat = 1.0 - 0.40 * w * w; /* the fundus is a dome */
    const double width = (at[2] < 6 ? 15.0 + 0.3 * at[2] : 17.0 + 9.0 * (z - 0.33) / 0.67) * 1.1;
    const double depth = 13.0 + 5.0 * z;
    const double dome = 1.0 - 0.13 * w * (u * u + v * v);
    round_off(&u, &v);
    p[0] = width * u * sqrt(flat);
    p[1] = depth * v * sqrt(flat);
    p[2] = 78.0 * z * dome;
}

/* Section through a centre line: `across` in the x-z plane, `deep` towards the back. */
static void guess_tube_section(double s, double across, double deep, double p[3]) {
    double axis[3], tangent[3], radius;
    lar_demo_tube_axis(s, axis, tangent, &radius);
    const double norm = sqrt(tangent[0] * tangent[0] + tangent[2] * tangent[2]);
    round_off(&across, &deep);
    p[0] = axis[0] - radius * across * tangent[2] / norm;
    p[1] = axis[1] + radius * deep;
    p[2] = axis[2] + radius * across * tangent[0] / norm;
}

/* The tube turns from the i direction into the -k direction in its corner block of 2 x 2 columns:
 * sections 0..7 before it, 9..12 after it, and those between fan out from its inner edge. */
static void guess_tube(const int at[3], double p[3]) {
    const double deep = at[1] - 4.0, root = 0.17, bend = 0.67;
    double section, across;
    if (at[0] <= 13 && at[2] >= 14) {
        section = at[0] - 6;
        across = at[2] - 15;
        if (at[0] == 13) section += 0.5 * (1.0 - across) * 0.6;
    } else if (at[2] <= 14) {
        section = 9 + (14 - at[2]);
        across = at[0] - 14;
        if (at[2] == 14) section -= 0.5 * (1.0 - across) * 0.6;
    } else {
        const int a = at[0] - 13, b = 16 - at[2]; /* 1..2, 0..1 */
        section = a == 1 && b == 0 ? 7.5 : a == 2 && b == 1 ? 8.5 : 8.0;
        across = a == 1 && b == 1 ? 0.0 : 1.0;
    }
    const double t = section < 8.0 ? root + (bend - root) * section / 8.0
                                   : bend + (1.0 - bend) * (section - 8.0) / 4.0;
    guess_tube_section(t, across, deep, p);
}

/* Sheet and ovary: columns hang from the tube's underside. */
static void guess_hanging(const int at[3], double p[3]) {
    const int top_at[3] = {at[0], 4, 14};
    double top[3];
    guess_tube(top_at, top);
    const double t = (14 - at[2]) / 6.0, s = (at[0] - 6) / 6.0;
    const double low_x = 19.0 + 30.0 * s, low_z = 33.0 - 9.0 * s;
    const double inwards = t < 0.33 ? 3.0 * t : 1.0; /* away from the tube's free end */
    p[0] = top[0] + t * (low_x - top[0]) - 5.0 * s * s * inwards;
    p[2] = top[2] + t * (low_z - top[2]);
    const int ovary = at[0] >= 8 && at[2] <= 12;
    p[1] = (at[1] - 4) * (ovary ? 4.0 : 3.0);
}

static void guess_ligament(const int at[3], double p[3]) {
    double axis[3], tangent[3], radius;
    lar_demo_ligament_axis(0.25 - 0.1875 * at[1], axis, tangent, &radius);
    double across = at[0] - 4, up = at[2] - 13;
    round_off(&across, &up);
    const double norm = sqrt(tangent[0] * tangent[0] + tangent[1] * tangent[1]);
    const double length = sqrt(norm * norm + tangent[2] * tangent[2]);
    const double side[3] = {-tangent[1] / norm, tangent[0] / norm, 0.0};
    const double top[3] = {-tangent[0] * tangent[2] / (norm * length),
                           -tangent[1] * tangent[2] / (norm * length), norm / length};
    for (int c = 0; c < 3; ++c) p[c] = axis[c] + radius * (across * side[c] + up * top[c]);
}

static void guess(const int at[3], double p[3]) {
    if (at[1] < 0) {
        guess_ligament(at, p);
        return;
    }
    if (at[0] <= 6) {
        guess_uterus(at, p);
        return;
    }
    if (at[2] >= 14 || at[0] >= 13)
        guess_tube(at, p);
    else
        guess_hanging(at, p);
    p[1] += lar_demo_sweep(p[0]);
}

lar_status lar_demo_grid(lar_demo_half *half, lar_error *error) {
    int cells = 0;
    for (int b = 0; b < BRICKS; ++b)
        cells += (bricks[b].i1 - bricks[b].i0) * (bricks[b].j1 - bricks[b].j0) *
                 (bricks[b].k1 - bricks[b].k0);
    const size_t max_nodes = sizeof(node_table) / sizeof(int);
    half->grid = lar_calloc(max_nodes, sizeof *half->grid);
    half->position = lar_calloc(max_nodes, sizeof *half->position);
    half->corner = lar_calloc((size_t)cells, sizeof *half->corner);
    half->cell = lar_calloc((size_t)cells, sizeof *half->cell);
    half->part = lar_calloc((size_t)cells, sizeof *half->part);
    if (!half->grid || !half->position || !half->corner || !half->cell || !half->part)
        return lar_fail_memory(error, max_nodes * sizeof *half->position,
                               "the demonstration organ");
    node_table table;
    for (int *node = &table[0][0][0]; node != &table[0][0][0] + max_nodes; ++node) *node = -1;
    for (int b = 0; b < BRICKS; ++b)
        for (int k = bricks[b].k0; k < bricks[b].k1; ++k)
            for (int j = bricks[b].j0; j < bricks[b].j1; ++j)
                for (int i = bricks[b].i0; i < bricks[b].i1; ++i)
                    add_cell(half, table, i, j, k, bricks[b].part);
    for (int a = 0; a < half->node_count; ++a) guess(half->grid[a], half->position[a]);
    return LAR_OK;
}
