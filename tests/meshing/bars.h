/* Bars along x for tests of stiffness: books have the answers. */
#ifndef LAR_TESTS_BARS_H
#define LAR_TESTS_BARS_H

#include "testing.h"

#include "meshing/meshing.h"

enum { BAR_WIDE = 4, BAR_LONG = 80, BAR_NODES = (BAR_LONG + 1) * (BAR_WIDE + 1) * (BAR_WIDE + 1) };
static const double BAR_SIDE = 0.01, BAR_LENGTH = 0.2, BAR_SHEAR = 3000, BAR_DENSITY = 1000;

/* One of 0.2 x 0.01 x height; its region is soft. Nothing of it is freed. */
static inline lar_meshing bar(double height) {
    static lar_region_info region;
    static int32_t element[BAR_LONG * BAR_WIDE * BAR_WIDE][8], tag[BAR_LONG * BAR_WIDE * BAR_WIDE];
    static double position[BAR_NODES][3];
    lar_meshing m = {.region = &region};
    region = (lar_region_info){.tag = 1,
                               .shear_modulus = BAR_SHEAR,
                               .bulk_modulus = BAR_SHEAR * 2 * 1.45 / 0.3,
                               .density = BAR_DENSITY};
    m.info.regions = 1;
    m.info.size = BAR_LENGTH / BAR_LONG;
    m.mesh.position = position;
    m.mesh.element = element;
    m.mesh.element_tag = tag;
    for (int i = 0; i <= BAR_LONG; i++)
        for (int j = 0; j <= BAR_WIDE; j++)
            for (int k = 0; k <= BAR_WIDE; k++) {
                double *x = position[m.mesh.node_count++];
                x[0] = BAR_LENGTH * i / BAR_LONG;
                x[1] = BAR_SIDE * j / BAR_WIDE;
                x[2] = height * k / BAR_WIDE;
            }
    for (int i = 0; i < BAR_LONG; i++)
        for (int j = 0; j < BAR_WIDE; j++)
            for (int k = 0; k < BAR_WIDE; k++) {
                int32_t *node = element[m.mesh.element_count];
                tag[m.mesh.element_count++] = 1;
                for (int a = 0; a < 8; a++) {
                    int at[3];
                    for (int c = 0; c < 3; c++) at[c] = lar_node_sign[a][c] > 0;
                    node[a] =
                        ((i + at[0]) * (BAR_WIDE + 1) + j + at[1]) * (BAR_WIDE + 1) + k + at[2];
                }
            }
    return m;
}

/* [BAR_NODES] the nodes within half an element of x. */
static inline void bar_mark(const lar_meshing *m, double x, bool *mark) {
    for (int32_t n = 0; n < m->mesh.node_count; n++)
        mark[n] = fabs(m->mesh.position[n][0] - x) < 0.5 * BAR_LENGTH / BAR_LONG;
}

/* Bending stiffness E I [N m^2], E = 2 G (1 + 0.45). */
static inline double bar_bending(double height) {
    return 2.9 * BAR_SHEAR * BAR_SIDE * height * height * height / 12;
}

#endif
