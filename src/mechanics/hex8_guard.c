#include "mechanics/hex8_guard.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/vector.h"
#include "mechanics/hexahedron.h"
#include "model/mesh/mesh.h"

/* Part of K + 4/3 G. */
static const double KAPPA = 0.5;
static const double MIN = 0.3; /* of START: where the parabola begins */

/* The neighbours of a corner along xi, eta, zeta, in an order in which a sound element's three
 * edges are right-handed. */
static const int neighbour[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                                    {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};

/* Volume that the edges of corner a span, and the edges. */
static double span(const double x[8][3], int a, double edge[3][3]) {
    double normal[3];
    for (int k = 0; k < 3; k++) lar_minus(x[neighbour[a][k]], x[a], edge[k]);
    lar_cross(edge[1], edge[2], normal);
    return lar_dot(edge[0], normal);
}

/* Energy, and its first and second derivative by j, per kappa V/8. */
static void barrier(double j, double *energy, double *slope, double *curvature) {
    double x = j / LAR_GUARD_START, min = fmax(x, MIN);
    double s = LAR_GUARD_START, inverse = 1 / min;
    *energy = 0.5 * s * s * (inverse + min - 2);
    *slope = -0.5 * s * (inverse * inverse - 1);
    *curvature = inverse * inverse * inverse;
    if (x >= MIN) return;
    double beyond = j - MIN * s;
    *energy += *slope * beyond + 0.5 * *curvature * beyond * beyond;
    *slope += *curvature * beyond;
}

/* A corner and the directions in which its volume grows. */
typedef struct corner_span {
    double volume;     /* at rest [m^3] */
    double j;          /* of that, now */
    double grad[4][3]; /* dj/dx of the corner itself and of its neighbours [1/m] */
} corner_span;

static void span_corner(const double rest[8][3], const double now[8][3], int a, corner_span *c) {
    double edge[3][3];
    c->volume = span(rest, a, edge);
    c->j = span(now, a, edge) / c->volume;
    if (!(c->j < LAR_GUARD_START)) return;
    memset(c->grad[0], 0, sizeof c->grad[0]);
    for (int k = 0; k < 3; k++) {
        lar_cross(edge[(k + 1) % 3], edge[(k + 2) % 3], c->grad[1 + k]);
        for (int i = 0; i < 3; i++) {
            c->grad[1 + k][i] /= c->volume;
            c->grad[0][i] -= c->grad[1 + k][i];
        }
    }
}

static int node_of(int a, int k) {
    return k == 0 ? a : neighbour[a][k - 1];
}

static double wave_modulus(const lar_material *material) {
    return lar_material_bulk(material) + 4 * lar_material_shear(material) / 3;
}

void lar_hex8_guard_force(const double rest[8][3], const double now[8][3], const double v[8][3],
                          const lar_material *material, double lead, double force[8][3],
                          lar_guard *guard) {
    double modulus = KAPPA * wave_modulus(material) / 8;
    *guard = (lar_guard){.min = INFINITY};
    for (int a = 0; a < 8; a++) {
        corner_span c = {0};
        span_corner(rest, now, a, &c);
        if (!(c.j >= guard->min)) guard->min = c.j;
        if (!(c.j < LAR_GUARD_START) || !(c.volume > 0)) continue;
        double energy, slope, curvature, weight = modulus * c.volume, square = 0, rate = 0;
        barrier(c.j, &energy, &slope, &curvature);
        for (int k = 0; k < 4; k++) {
            square += lar_dot(c.grad[k], c.grad[k]);
            if (v) rate += lar_dot(c.grad[k], v[node_of(a, k)]);
        }
        guard->energy += weight * energy;
        guard->stiffness += weight * curvature * square;
        if (!force) continue;
        double damped = fmin(slope + lead * curvature * rate, 0);
        guard->taken -= weight * (damped - slope) * rate;
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < 3; i++) force[node_of(a, k)][i] += weight * damped * c.grad[k][i];
    }
}

void lar_hex8_guard(const double rest[8][3], const double now[8][3], const lar_material *material,
                    lar_guard *guard) {
    lar_hex8_guard_force(rest, now, NULL, material, 0, NULL, guard);
}

/* Signs of the seven modes at node a (hex8.h). */
static void mode_signs(int a, double sign[7]) {
    double x = lar_node_sign[a][0], y = lar_node_sign[a][1], z = lar_node_sign[a][2];
    const double signs[7] = {x, y, z, y * z, x * z, x * y, x * y * z};
    memcpy(sign, signs, sizeof signs);
}

/* B_m as a sum of B_0 .. B_2, m = 3 .. 5: what is left over of a linear field has no mean gradient,
 * so its modes 0 .. 2 follow from the others. False where these are no three directions. */
static bool dependence(const lar_hex8 *element, double share[4][3]) {
    const double(*B)[3] = (const double(*)[3])element->gradient;
    double area[3];
    lar_cross(B[1], B[2], area);
    double volume = lar_dot(B[0], area);
    if (volume == 0) return false;
    for (int k = 0; k < 3; k++) {
        lar_cross(B[(k + 1) % 3], B[(k + 2) % 3], area);
        for (int m = 0; m < 3; m++) share[m][k] = lar_dot(B[3 + m], area) / volume;
        share[3][k] = 0;
    }
    return true;
}

double lar_hex8_corner_limit(const lar_hex8 *element, const double rest[8][3]) {
    double share[4][3], worst = 0;
    if (!dependence(element, share)) return 0;
    for (int c = 0; c < 8; c++) {
        double at[3], gradient[8][3], mode[7][3] = {{0}}, sum = 0;
        for (int i = 0; i < 3; i++) at[i] = lar_node_sign[c][i];
        lar_hexahedron_gradients(rest, at, gradient);
        for (int a = 0; a < 8; a++) {
            double sign[7];
            mode_signs(a, sign);
            for (int m = 0; m < 7; m++)
                for (int i = 0; i < 3; i++) mode[m][i] += sign[m] * gradient[a][i] / 8;
        }
        for (int m = 0; m < 4; m++) {
            double g[3];
            for (int i = 0; i < 3; i++) {
                g[i] = mode[3 + m][i];
                for (int k = 0; k < 3; k++) g[i] -= share[m][k] * mode[k][i];
            }
            sum += lar_dot(g, g) / (element->stiffness[m] * element->stiffness[m]);
        }
        if (!(sum <= worst)) worst = sum;
    }
    return 1 / worst;
}

double lar_hex8_growth(const lar_material *material, const float strain[LAR_STRAIN_NUMBERS]) {
    double J = strain[LAR_STRAIN_VOLUME], area = strain[LAR_STRAIN_AREA] / 3.0;
    if (!(J > 0)) return INFINITY;
    lar_law_strained now = lar_law_table[material->law].strained(
        material->parameter, J, strain[LAR_STRAIN_LENGTH], strain[LAR_STRAIN_AREA]);
    double stretch = sqrt(strain[LAR_STRAIN_LENGTH] / 3.0);
    double volume = fmax(now.slope, 0) * area + fabs(now.pressure) * stretch;
    double shear = now.shear * fmax(1, area / (J * J)) + now.further;
    return (volume + shear) / wave_modulus(material);
}
