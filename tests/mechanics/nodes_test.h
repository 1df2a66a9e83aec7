/* Tests make nodes one by one, four values each (the last is 0); kernels have them axis by axis. */
#ifndef LAR_TESTS_MECHANICS_NODES_TEST_H
#define LAR_TESTS_MECHANICS_NODES_TEST_H

#include <assert.h>
#include <string.h>

#include "mechanics/hex8_block.h"

enum { TEST_STRIDE = 1024 }; /* more than any of these tests has nodes */

static inline const double *test_axes(const double (*node)[4], int nodes, double *axes) {
    assert(nodes <= TEST_STRIDE);
    for (int n = 0; n < nodes; n++) lar_axes_put(axes, TEST_STRIDE, n, node[n]);
    return axes;
}

/* As lar_hex8_recover. */
static inline int64_t test_recover(const lar_kernels *kernels, const lar_block_run *run, int nodes,
                                   const double (*u)[4], int64_t (*force)[4],
                                   const lar_hex8_limits *limits, lar_hex8_monitor *monitor) {
    static double axes[3 * TEST_STRIDE] __attribute__((aligned(64)));
    static int64_t sums[3 * TEST_STRIDE] __attribute__((aligned(64)));
    lar_block_run strided = *run;
    strided.axis_stride = TEST_STRIDE;
    for (int n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) sums[n + i * TEST_STRIDE] = force[n][i];
    int64_t found = kernels->recover(&strided, test_axes(u, nodes, axes), sums, limits, monitor);
    for (int n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) force[n][i] = sums[n + i * TEST_STRIDE];
    return found;
}

#endif
