#include "step/rigid/inertia.h"

#include <string.h>

#include "base/vector.h"

void lar_symmetric_product(const double a[6], const double v[3], double out[3]) {
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[i] * v[i] + a[3 + i] * v[j] + a[3 + k] * v[k];
    }
}

/* A body whose inertia about an axis is less of that about the others lies in that axis. */
static const double LINE = 1e-9;

static double mean_of(const double inertia[6]) {
    return (inertia[0] + inertia[1] + inertia[2]) / 3;
}

/* Symmetric as well; false: of nodes that lie in a line, or nearly. */
static bool invert(const double a[6], double out[6]) {
    double det = 0, mean = mean_of(a);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * a[k] - a[3 + j] * a[3 + j];
        out[3 + i] = a[3 + j] * a[3 + k] - a[3 + i] * a[k];
    }
    det = a[0] * out[0] + a[3] * out[3] + a[5] * out[5];
    for (int i = 0; i < 6; i++) out[i] /= det;
    return det > LINE * mean * mean * mean;
}

/* What is left of the inverse where a body turns about an axis. */
static bool invert_along(const double inertia[6], const double axis[3], double out[6]) {
    double carried[3];
    lar_symmetric_product(inertia, axis, carried);
    const double about = lar_dot(axis, carried);
    for (int i = 0; i < 3; i++) {
        out[i] = axis[i] * axis[i] / about;
        out[3 + i] = axis[i] * axis[(i + 1) % 3] / about;
    }
    return about > LINE * mean_of(inertia);
}

bool lar_inertia_invert(const double inertia[6], const double axis[3], double out[6]) {
    if (lar_dot(axis, axis) > 0 ? invert_along(inertia, axis, out) : invert(inertia, out))
        return true;
    memset(out, 0, 6 * sizeof *out);
    return false;
}

void lar_rigid_sum_yields(const lar_rigid_sum *sum, const lar_tool *tool, double inverse[6]) {
    memset(inverse, 0, 6 * sizeof *inverse);
    if (tool->free & LAR_FREE_TURNS) lar_inertia_invert(sum->inertia, tool->axis, inverse);
}
