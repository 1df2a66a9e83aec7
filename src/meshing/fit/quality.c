#include "meshing/fit/quality.h"

#include <math.h>

#include "base/vector.h"

const uint8_t lar_fit_edge[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                                    {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};

double lar_fit_corner_energy(const lar_fit_law *law, const double edge[3][3]) {
    double across[3][3], r = 0;
    for (int k = 0; k < 3; k++) {
        lar_cross(edge[(k + 1) % 3], edge[(k + 2) % 3], across[k]);
        r += lar_dot(across[k], across[k]);
    }
    const double d = lar_dot(edge[0], across[0]);
    if (!(d > 0)) return INFINITY;
    const double a = lar_dot(edge[0], edge[0]), b = lar_dot(edge[1], edge[1]);
    const double c = lar_dot(edge[2], edge[2]), above = d / sqrt(a * b * c) - law->floor;
    if (!(above > 0)) return INFINITY;
    const double energy = law->shape * (a + b + c + r / (d * d) - 6);
    const double missing = law->aim - law->floor - above;
    return missing > 0 ? energy + law->steep * missing * missing / above : energy;
}

/* First and second derivatives of a corner's quantities by the place of the node that moves. */
typedef struct slopes {
    double q[3], q_second; /* times the unit matrix */
    double d[3];           /* none */
    double r[3], r_second[6];
    double l[3], l_second[6]; /* of log(|e_1| |e_2| |e_3|) */
} slopes;

/* One edge's part in q and l; `sign` 1 when its end moves, -1 when the corner does. */
static inline void add_edge(const double e[3], double sign, slopes *slope) {
    const double one = 1 / lar_dot(e, e), two = -2 * one * one;
    for (int i = 0; i < 3; i++) {
        slope->q[i] += sign * 2 * e[i];
        slope->l[i] += sign * one * e[i];
        slope->l_second[i] += one + two * e[i] * e[i];
        slope->l_second[3 + i] += two * e[i] * e[(i + 1) % 3];
    }
    slope->q_second += 2;
}

/* The part of an area: a x b changes by x x w when the node moves by x. */
static inline void add_area(const double across[3], const double w[3], slopes *slope) {
    const double square = lar_dot(w, w);
    double turned[3];
    lar_cross(w, across, turned);
    for (int i = 0; i < 3; i++) {
        slope->r[i] += 2 * turned[i];
        slope->r_second[i] += 2 * (square - w[i] * w[i]);
        slope->r_second[3 + i] -= 2 * w[i] * w[(i + 1) % 3];
    }
}

static void corner_moves(const double edge[3][3], const double across[3][3], slopes *slope) {
    for (int k = 0; k < 3; k++) {
        double w[3];
        add_edge(edge[k], -1, slope);
        lar_minus(edge[(k + 1) % 3], edge[(k + 2) % 3], w);
        add_area(across[k], w, slope);
        for (int i = 0; i < 3; i++) slope->d[i] -= across[k][i];
    }
}

static void end_moves(const double edge[3][3], const double across[3][3], int moves,
                      slopes *slope) {
    const int next = (moves + 1) % 3, last = (moves + 2) % 3;
    double back[3];
    for (int i = 0; i < 3; i++) {
        slope->d[i] = across[moves][i];
        back[i] = -edge[last][i];
    }
    add_edge(edge[moves], 1, slope);
    add_area(across[last], edge[next], slope); /* e_moves x e_next */
    add_area(across[next], back, slope);       /* e_last x e_moves */
}

/* hessian += factor * (a b^T + b a^T) / 2 */
static inline void add_products(double hessian[6], double factor, const double a[3],
                                const double b[3]) {
    const double half = 0.5 * factor;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        hessian[i] += factor * a[i] * b[i];
        hessian[3 + i] += half * (a[i] * b[j] + a[j] * b[i]);
    }
}

/* With A = aim - floor and y = s - floor: A^2 / y - 2 A + y, by way of log s. */
static void add_limit(const lar_fit_law *law, double s, double one, const slopes *slope,
                      lar_fit_newton *sum) {
    const double y = s - law->floor, range = law->aim - law->floor, ratio = range / y;
    const double first = law->steep * (1 - ratio * ratio) * s;
    const double second = law->steep * 2 * ratio * ratio / y * s * s;
    double log_d[3], log_s[3];
    sum->value += law->steep * (range - y) * (range - y) / y;
    for (int i = 0; i < 3; i++) {
        log_d[i] = slope->d[i] * one;
        log_s[i] = log_d[i] - slope->l[i];
        sum->gradient[i] += first * log_s[i];
    }
    add_products(sum->hessian, first + second, log_s, log_s);
    add_products(sum->hessian, -first, log_d, log_d);
    for (int i = 0; i < 6; i++) sum->hessian[i] -= first * slope->l_second[i];
}

void lar_fit_corner_newton(const lar_fit_law *law, const double edge[3][3], int moves,
                           lar_fit_newton *sum) {
    double across[3][3];
    for (int k = 0; k < 3; k++) lar_cross(edge[(k + 1) % 3], edge[(k + 2) % 3], across[k]);
    slopes slope = {0};
    if (moves == LAR_FIT_MOVES_CORNER)
        corner_moves(edge, across, &slope);
    else
        end_moves(edge, across, moves, &slope);
    const double a = lar_dot(edge[0], edge[0]), b = lar_dot(edge[1], edge[1]);
    const double c = lar_dot(edge[2], edge[2]), d = lar_dot(edge[0], across[0]), one = 1 / d;
    const double r = lar_dot(across[0], across[0]) + lar_dot(across[1], across[1]) +
                     lar_dot(across[2], across[2]);
    const double by_r = law->shape * one * one, by_d = -2 * by_r * r * one;
    sum->value += law->shape * (a + b + c - 6) + by_r * r;
    for (int i = 0; i < 3; i++) {
        sum->gradient[i] += law->shape * slope.q[i] + by_r * slope.r[i] + by_d * slope.d[i];
        sum->hessian[i] += law->shape * slope.q_second + by_r * slope.r_second[i];
        sum->hessian[3 + i] += by_r * slope.r_second[3 + i];
    }
    add_products(sum->hessian, -4 * by_r * one, slope.r, slope.d);
    add_products(sum->hessian, 6 * by_r * r * one * one, slope.d, slope.d);
    const double s = d / sqrt(a * b * c);
    if (s < law->aim) add_limit(law, s, one, &slope, sum);
}
