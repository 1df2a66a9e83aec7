#include "mechanics/hex8_guard.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/vector.h"
#include "law/fibre_stress.h"
#include "mechanics/hexahedron.h"
#include "model/mesh/mesh.h"

/* Part of K + 4/3 G. */
static const double KAPPA = 0.5;
static const double MIN = 0.2; /* of START: where the parabola begins */
static const double WIDE = 16; /* times the square of dj/dx at rest: from there on barriers fade */

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
    double square;     /* of all of dj/dx [1/m^2] */
    double share;      /* which part of the barrier a corner with such a square has */
    double grad[4][3]; /* dj/dx of the corner itself and of its neighbours [1/m] */
    double fall[4][3]; /* d share/dx [1/m] */
} corner_span;

/* dj/dx of a corner with these edges, and its square. */
static double gradient(const double edge[3][3], double volume, double grad[4][3]) {
    double square = 0;
    memset(grad[0], 0, sizeof grad[0]);
    for (int k = 0; k < 3; k++) {
        lar_cross(edge[(k + 1) % 3], edge[(k + 2) % 3], grad[1 + k]);
        for (int i = 0; i < 3; i++) {
            grad[1 + k][i] /= volume;
            grad[0][i] -= grad[1 + k][i];
        }
        square += lar_dot(grad[1 + k], grad[1 + k]);
    }
    return square + lar_dot(grad[0], grad[0]);
}

/* With long edges a corner's volume changes fast, and its barrier, which is as stiff as the square
 * of that, would ask for shorter steps than there are. From r = square / (WIDE of that at rest) = 1
 * on it has the part (2 r - 1) / r^2, whose slope there is none, and is never more than twice as
 * stiff as at 1. The part belongs to the energy, so that what goes in comes out. */
static void share_corner(const double rest_edge[3][3], const double edge[3][3], corner_span *c) {
    double rest_grad[4][3], length = 0;
    c->share = 1;
    memset(c->fall, 0, sizeof c->fall);
    for (int k = 0; k < 3; k++) length += lar_dot(rest_edge[k], rest_edge[k]);
    /* Edges e_k with gradients g_k have e_k . g_k = 1, so by Cauchy and Schwarz the square at rest
     * is not below 9 / (sum of |e_k|^2); a tenth is far more than what rounding could change. */
    if (c->square * length < 8.1 * WIDE) return;
    double square_at_rest = gradient(rest_edge, c->volume, rest_grad);
    double r = c->square / (WIDE * square_at_rest);
    if (!(r > 1)) return;
    c->share = (2 * r - 1) / (r * r);
    double slope = 2 * (1 - r) / (r * r * r) / (WIDE * square_at_rest);
    for (int m = 0; m < 3; m++) { /* d square/d edge m */
        int p = (m + 1) % 3, q = (m + 2) % 3;
        double a[3], b[3], one[3], other[3];
        for (int i = 0; i < 3; i++) {
            a[i] = c->grad[1 + p][i] - c->grad[0][i];
            b[i] = c->grad[1 + q][i] - c->grad[0][i];
        }
        lar_cross(a, edge[q], one);
        lar_cross(edge[p], b, other);
        for (int i = 0; i < 3; i++) {
            c->fall[1 + m][i] = slope * 2 / c->volume * (one[i] + other[i]);
            c->fall[0][i] -= c->fall[1 + m][i];
        }
    }
}

static void span_corner(const double rest[8][3], const double now[8][3], int a, corner_span *c) {
    double rest_edge[3][3], edge[3][3];
    c->volume = span(rest, a, rest_edge);
    c->j = span(now, a, edge) / c->volume;
    if (!(c->j < LAR_GUARD_START)) return;
    c->square = gradient((const double(*)[3])edge, c->volume, c->grad);
    share_corner((const double(*)[3])rest_edge, (const double(*)[3])edge, c);
}

static int node_of(int a, int k) {
    return k == 0 ? a : neighbour[a][k - 1];
}

static double wave_modulus(const lar_material *material) {
    return lar_material_bulk(material) + 4 * lar_material_shear(material) / 3;
}

void lar_hex8_guard_force(const double rest[8][3], const double now[8][3], const double v[8][3],
                          const lar_material *material, lar_guard_lead lead, unsigned corners,
                          double force[8][3], lar_guard *guard) {
    double modulus = KAPPA * wave_modulus(material) / 8;
    guard->min = INFINITY;
    guard->energy = guard->stiffness = 0;
    memset(guard->slope, 0, sizeof guard->slope);
    memset(guard->damper, 0, sizeof guard->damper);
    for (; corners; corners &= corners - 1) {
        int a = __builtin_ctz(corners);
        corner_span c;
        span_corner(rest, now, a, &c);
        if (!(c.j >= guard->min)) guard->min = c.j;
        if (!(c.j < LAR_GUARD_START) || !(c.volume > 0)) continue;
        double energy, slope, curvature, weight = modulus * c.volume * c.share, rate = 0;
        barrier(c.j, &energy, &slope, &curvature);
        for (int k = 0; k < 4 && v; k++) {
            guard->opening[a][k] = lar_dot(c.grad[k], v[node_of(a, k)]);
            rate += guard->opening[a][k];
        }
        guard->energy += weight * energy;
        guard->stiffness += weight * curvature * c.square;
        if (!force) continue;
        double damped =
            fmin(slope + (rate > 0 ? lead.opening : lead.closing) * curvature * rate, 0);
        guard->slope[a] = weight * slope;
        guard->damper[a] = weight * (damped - slope);
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < 3; i++)
                force[node_of(a, k)][i] +=
                    weight * damped * c.grad[k][i] + modulus * c.volume * energy * c.fall[k][i];
    }
}

double lar_hex8_guard_power(const double rest[8][3], const double now[8][3], const double v[8][3],
                            const double damper[8]) {
    double power = 0;
    for (int a = 0; a < 8; a++) {
        double edge[3][3], grad[4][3];
        if (damper[a] == 0) continue;
        double volume = span(rest, a, edge);
        span(now, a, edge);
        gradient((const double(*)[3])edge, volume, grad);
        for (int k = 0; k < 4; k++) power += damper[a] * lar_dot(grad[k], v[node_of(a, k)]);
    }
    return power;
}

void lar_hex8_guard(const double rest[8][3], const double now[8][3], const lar_material *material,
                    lar_guard *guard) {
    lar_hex8_guard_force(rest, now, NULL, material, (lar_guard_lead){0}, LAR_ALL_CORNERS, NULL,
                         guard);
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

double lar_hex8_largest_corner(const double rest[8][3]) {
    static const double ROUNDED = 1e-14; /* of what three such edges can span at most */
    double largest = 0, longest = 0;
    for (int a = 0; a < 8; a++) {
        double edge[3][3];
        largest = fmax(largest, span(rest, a, edge));
        for (int k = 0; k < 3; k++) longest = fmax(longest, lar_dot(edge[k], edge[k]));
    }
    return largest + ROUNDED * longest * sqrt(longest);
}

double lar_fibre_limit(const lar_material *material) {
    static const double PART = 0.1; /* of the law's modulus, by all families together */
    double modulus = lar_material_bulk(material) + 4 * lar_material_shear(material) / 3;
    return lar_fibre_stiffest(&material->fibre) +
           PART * modulus / lar_fibre_families(&material->fibre);
}

/* Stiffness of a pair grows with the number, so the other family's is not above the one that is
 * known. */
double lar_hex8_fibre_growth(const lar_fibre *fibre, const float strain[LAR_STRAIN_NUMBERS]) {
    double p[LAR_FIBRE_PARAMETERS], J = strain[LAR_STRAIN_VOLUME], area = strain[LAR_STRAIN_AREA];
    double length = strain[LAR_STRAIN_FIBRE];
    int kind = lar_fibre_kind_single(fibre);
    double square = lar_fibre_square(kind, length, J);
    memcpy(p, fibre->parameter, sizeof p);
    lar_fibre_answer now = lar_fibre_tension(fibre->law, square, p);
    double stiff = fibre->law == LAR_FIBRE_HGO
                       ? lar_fibre_spread_stiffness(&now, square, length, strain[LAR_STRAIN_LENGTH],
                                                    p[2], J, area)
                       : lar_fibre_stiffness(kind, &now, square, length, J, area);
    return lar_fibre_families(fibre) * fmax(stiff - lar_fibre_stiffest(fibre), 0);
}

/* The square of an element's highest frequency goes with sum |cof F B_a|^2 over its nodes, which is
 * cof F^T cof F times M = sum B_a (x) B_a. Of a cube M is the same along all axes, and that
 * |cof F|^2 / 3; a flat element that is pressed flatter feels the largest of the three squares
 * alone. With a trace of 3, M has no eigenvalue above `steepest`. */
static double steepest_of(const lar_hex8 *element) {
    double trace = 0, square = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double sum = 0;
            for (int m = 0; m < LAR_HEX8_GRADIENTS; m++)
                sum += element->gradient[m][i] * element->gradient[m][j];
            square += sum * sum;
            if (i == j) trace += sum;
        }
    return 1 + sqrt(fmax(6 * square / (trace * trace) - 2, 0));
}

double lar_hex8_area_limit(const lar_hex8 *element) {
    static const double FLAT = 1.7; /* edges as 1.6 to 1 */
    double steepest = steepest_of(element), low = 1, high = LAR_STRAINED_AREA;
    if (!(steepest > FLAT)) return LAR_STRAINED_AREA;
    for (int i = 0; i < 40; i++) { /* the largest square, along the steepest, the volume kept */
        double c = 0.5 * (low + high);
        bool beyond = steepest * c + (3 - steepest) / sqrt(c) > LAR_STRAINED_AREA;
        *(beyond ? &high : &low) = c;
    }
    return low + 2 / sqrt(low);
}

/* Areas are the square of the volume's gradient by the corners, |dV/dx|^2. With edges of L at most
 * the second derivative of V is nowhere more than 3 L, so while no corner goes farther than d,
 * which is not above L / 10, the gradient changes by no more than 3 (1.2 L) sqrt(8) d. */
double lar_hex8_steady_way(double areas, double longest) {
    static const double MORE = 0.12; /* of the gradient: 1.2544 of its square */
    double edge = sqrt(longest);
    return areas > 0 ? fmin(0.1 * edge, MORE * sqrt(areas) / (10.3 * edge)) : 0;
}

void lar_hex8_stiff_begin(const lar_material *material, lar_hex8_stiff *stiff) {
    stiff->of_volume = lar_viscosity_volume_instant(&material->viscosity);
    stiff->of_shear = lar_viscosity_instant(&material->viscosity);
    stiff->whole =
        lar_material_instant_bulk(material) + 4 * lar_material_instant_shear(material) / 3;
    stiff->fibrous = material->fibre.law != LAR_FIBRE_NONE;
}
