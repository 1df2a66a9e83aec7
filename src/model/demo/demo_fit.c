/* Moves the nodes of the demonstration organ until its elements are good.
 *
 * An energy is minimised with L-BFGS (Nocedal and Wright, algorithm 7.5):
 *
 *   corners   A = edges at an element's corner over the lengths they should have, d = det A,
 *             f = (|A|^2 / 3)^(3/2) / h(d) + theta (h(d) + 1/h(d)) / 2,  squared, so that the
 *             worst corners weigh most. h(d) = (d + sqrt(d^2 + 4 delta^2)) / 2 stays positive, so
 *             that an inverted first guess is untangled (Escobar et al. 2003; Garanzha et al.
 *             2021); delta shrinks from round to round. Corners whose scaled Jacobian is small
 *             pay extra.
 *   surface   (distance to the tangent plane at the node's nearest surface point)^2: nodes may
 *             slide along the surface. The planes are found anew every round.
 *
 * Nodes on the middle plane I = 0 keep x = 0, so the mirrored halves fit.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "model/demo/demo_parts.h"
#include "model/mesh/mesh.h"

enum { ROUNDS = 30, STEPS_PER_ROUND = 30, PAIRS = 8 };

static const double theta = 0.8;         /* weight of even volumes against shape */
static const double evenness = 0.4;      /* 1: every cell of a part should be the same cube */
static const double wanted_angle = 0.49; /* scaled Jacobian below which a corner pays */
static const double wanted_edge = 3.6;   /* [mm], see step_energy */

typedef struct plane {
    int node;
    bool tube; /* a corner of a tube's cell */
    double normal[3], offset;
} plane;

typedef struct fit {
    lar_demo_half *half;
    const lar_demo_shape *shape;
    size_t size;         /* 3 * node_count */
    double (*wanted)[3]; /* edge lengths per cell and direction */
    plane *planes;       /* one per surface node */
    int plane_count;
    double delta, surface_weight, angle_weight, step_weight;
    int neighbour[8][3]; /* local node across each edge of a corner */
    double *work;        /* gradient, trial, direction, pairs */
} fit;

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static void cross3(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* ---- the energy ---------------------------------------------------------------------------- */

/* Energy of one corner with edges A[0..2]; slope[d] = its derivative by A[d]. */
static double corner_energy(const fit *f, double A[3][3], double slope[3][3]) {
    double cofactor[3][3];
    cross3(A[1], A[2], cofactor[0]);
    cross3(A[2], A[0], cofactor[1]);
    cross3(A[0], A[1], cofactor[2]);
    const double square[3] = {dot3(A[0], A[0]), dot3(A[1], A[1]), dot3(A[2], A[2])};
    const double mean = (square[0] + square[1] + square[2]) / 3.0, root = sqrt(mean);
    const double d = dot3(A[0], cofactor[0]);
    const double bent = sqrt(d * d + 4.0 * f->delta * f->delta);
    const double h = 0.5 * (d + bent), dh = h / bent;
    const double shape = mean * root / h, value = shape + 0.5 * theta * (h + 1.0 / h);
    const double by_edge = root / h;
    const double by_det = dh * (0.5 * theta * (1.0 - 1.0 / (h * h)) - shape / h);

    const double norm = sqrt(square[0] * square[1] * square[2]) + 1e-12;
    const double angle = d / norm, lack = wanted_angle - angle;
    const double pay = lack > 0.0 ? f->angle_weight * lack : 0.0;
    for (int e = 0; e < 3; ++e)
        for (int c = 0; c < 3; ++c) {
            slope[e][c] = 2.0 * value * (by_edge * A[e][c] + by_det * cofactor[e][c]);
            slope[e][c] -=
                2.0 * pay * (cofactor[e][c] / norm - angle * A[e][c] / (square[e] + 1e-12));
        }
    return value * value + pay * (lack > 0.0 ? lack : 0.0);
}

static double cell_energy(const fit *f, int cell, const double (*x)[3], double (*gradient)[3]) {
    const int *node = f->half->corner[cell];
    const double *wanted = f->wanted[cell];
    double sum = 0.0;
    for (int a = 0; a < 8; ++a) {
        double A[3][3], slope[3][3];
        for (int d = 0; d < 3; ++d)
            for (int c = 0; c < 3; ++c)
                A[d][c] = -lar_node_sign[a][d] * (x[node[f->neighbour[a][d]]][c] - x[node[a]][c]) /
                          wanted[d];
        sum += corner_energy(f, A, slope);
        for (int d = 0; d < 3; ++d)
            for (int c = 0; c < 3; ++c) {
                const double s = -lar_node_sign[a][d] * slope[d][c] / wanted[d];
                gradient[node[f->neighbour[a][d]]][c] += s;
                gradient[node[a]][c] -= s;
            }
    }
    return sum;
}

/* Volume of a cell and its derivative by the corners: V times the mean gradient B of the
 * uniform-strain element. Exact with 2 x 2 x 2 Gauss points. */
static double volume_slope(double x[8][3], double slope[8][3]) {
    const double point = 0.57735026918962576;
    double volume = 0.0;
    memset(slope, 0, 8 * sizeof *slope);
    for (int g = 0; g < 8; ++g) {
        double jacobian[3][3] = {{0}}, shape[8][3], cofactor[3][3];
        for (int a = 0; a < 8; ++a) {
            double factor[3];
            for (int d = 0; d < 3; ++d)
                factor[d] = 0.5 * (1.0 + point * lar_node_sign[g][d] * lar_node_sign[a][d]);
            for (int d = 0; d < 3; ++d) {
                shape[a][d] = 0.5 * lar_node_sign[a][d] * factor[(d + 1) % 3] * factor[(d + 2) % 3];
                for (int c = 0; c < 3; ++c) jacobian[d][c] += shape[a][d] * x[a][c];
            }
        }
        for (int d = 0; d < 3; ++d)
            cross3(jacobian[(d + 1) % 3], jacobian[(d + 2) % 3], cofactor[d]);
        volume += dot3(jacobian[0], cofactor[0]);
        for (int a = 0; a < 8; ++a)
            for (int c = 0; c < 3; ++c)
                slope[a][c] += shape[a][0] * cofactor[0][c] + shape[a][1] * cofactor[1][c] +
                               shape[a][2] * cofactor[2][c];
    }
    return volume;
}

/* What a cell pays for asking for a small time step. With q = sum |B_a|^2 the greatest frequency
 * of the element is omega^2 = 8 (K + 4/3 G) q / density at most (Flanagan and Belytschko 1984),
 * that of a cube of edge h with h^2 = 3/2 / q. The second derivative of V times a vector comes
 * from a central difference, exact because the slope is a quadratic. */
static double step_energy(const fit *f, int cell, const double (*x)[3], double (*gradient)[3]) {
    const int *node = f->half->corner[cell];
    double at[8][3], slope[8][3], moved[8][3], ahead[8][3], behind[8][3], square = 0.0;
    for (int a = 0; a < 8; ++a) memcpy(at[a], x[node[a]], sizeof at[a]);
    const double volume = volume_slope(at, slope);
    for (int a = 0; a < 8; ++a) square += dot3(slope[a], slope[a]);
    const double q = square / (volume * volume), enough = 1.5 / (wanted_edge * wanted_edge);
    const double excess = q / enough - 1.0;
    if (!(excess > 0.0) || volume <= 0.0) return 0.0;
    for (int side = -1; side <= 1; side += 2) {
        for (int a = 0; a < 8; ++a)
            for (int c = 0; c < 3; ++c) moved[a][c] = at[a][c] + 0.05 * side * slope[a][c];
        volume_slope(moved, side < 0 ? behind : ahead);
    }
    const double factor = 2.0 * f->step_weight * excess / enough;
    for (int a = 0; a < 8; ++a)
        for (int c = 0; c < 3; ++c) {
            const double turned = (ahead[a][c] - behind[a][c]) / 0.1;
            gradient[node[a]][c] +=
                factor * 2.0 * (turned - q * volume * slope[a][c]) / (volume * volume);
        }
    return f->step_weight * excess * excess;
}

static double energy(const fit *f, const double *flat, double *flat_gradient) {
    const double(*x)[3] = (const double(*)[3])flat;
    double(*gradient)[3] = (double(*)[3])flat_gradient;
    memset(flat_gradient, 0, f->size * sizeof *flat_gradient);
    double sum = 0.0;
    for (int e = 0; e < f->half->cell_count; ++e) sum += cell_energy(f, e, x, gradient);
    for (int e = 0; e < f->half->cell_count && f->step_weight > 0.0; ++e)
        sum += step_energy(f, e, x, gradient);
    for (int i = 0; i < f->plane_count; ++i) {
        const plane *p = &f->planes[i];
        const double away = dot3(p->normal, x[p->node]) - p->offset;
        sum += f->surface_weight * away * away;
        for (int c = 0; c < 3; ++c)
            gradient[p->node][c] += 2.0 * f->surface_weight * away * p->normal[c];
    }
    for (int a = 0; a < f->half->node_count; ++a)
        if (f->half->grid[a][0] == 0) gradient[a][0] = 0.0;
    return sum;
}

/* ---- minimising ----------------------------------------------------------------------------- */

static double dot(const double *a, const double *b, size_t n) {
    double sum = 0.0;
    for (size_t i = 0; i < n; ++i) sum += a[i] * b[i];
    return sum;
}

typedef struct history {
    double *moved[PAIRS], *turned[PAIRS]; /* differences of positions and gradients */
    double inverse[PAIRS];                /* 1 / (moved . turned) */
    int count;                            /* pairs ever stored */
} history;

/* direction = - (approximate inverse Hessian) gradient. */
static void descend(const history *past, const double *gradient, double *direction, size_t n) {
    double alpha[PAIRS];
    for (size_t i = 0; i < n; ++i) direction[i] = -gradient[i];
    const int oldest = past->count > PAIRS ? past->count - PAIRS : 0;
    for (int k = past->count - 1; k >= oldest; --k) {
        const int p = k % PAIRS;
        alpha[p] = past->inverse[p] * dot(past->moved[p], direction, n);
        for (size_t i = 0; i < n; ++i) direction[i] -= alpha[p] * past->turned[p][i];
    }
    if (past->count > 0) {
        const int p = (past->count - 1) % PAIRS;
        const double scale = 1.0 / (past->inverse[p] * dot(past->turned[p], past->turned[p], n));
        for (size_t i = 0; i < n; ++i) direction[i] *= scale;
    }
    for (int k = oldest; k < past->count; ++k) {
        const int p = k % PAIRS;
        const double beta = past->inverse[p] * dot(past->turned[p], direction, n);
        for (size_t i = 0; i < n; ++i) direction[i] += (alpha[p] - beta) * past->moved[p][i];
    }
}

static double largest(const double *v, size_t n) {
    double max = 0.0;
    for (size_t i = 0; i < n; ++i) max = fabs(v[i]) > max ? fabs(v[i]) : max;
    return max;
}

static void minimise(const fit *f, double *x) {
    const size_t n = f->size;
    double *gradient = f->work, *trial = f->work + n, *trial_gradient = f->work + 2 * n;
    double *direction = f->work + 3 * n;
    history past = {.count = 0};
    for (int p = 0; p < PAIRS; ++p) {
        past.moved[p] = f->work + (4 + (size_t)p) * n;
        past.turned[p] = f->work + (4 + PAIRS + (size_t)p) * n;
    }
    double now = energy(f, x, gradient);
    for (int step = 0; step < STEPS_PER_ROUND; ++step) {
        descend(&past, gradient, direction, n);
        double slope = dot(direction, gradient, n);
        if (!(slope < 0.0)) return;
        const double reach = largest(direction, n);
        double length = reach > 1.0 ? 1.0 / reach : 1.0; /* at most a millimetre at once */
        if (past.count == 0) length = 0.2 / reach;
        double then = now;
        int halvings = 0;
        for (; halvings < 20; ++halvings, length *= 0.5) {
            for (size_t i = 0; i < n; ++i) trial[i] = x[i] + length * direction[i];
            then = energy(f, trial, trial_gradient);
            if (then <= now + 1e-4 * length * slope) break;
        }
        if (halvings == 20) return;
        const int p = past.count % PAIRS;
        for (size_t i = 0; i < n; ++i) {
            past.moved[p][i] = trial[i] - x[i];
            past.turned[p][i] = trial_gradient[i] - gradient[i];
        }
        const double curvature = dot(past.moved[p], past.turned[p], n);
        if (curvature > 0.0) {
            past.inverse[p] = 1.0 / curvature;
            past.count++;
        }
        memcpy(x, trial, n * sizeof *x);
        memcpy(gradient, trial_gradient, n * sizeof *gradient);
        now = then;
    }
}

/* ---- surface and sizes --------------------------------------------------------------------- */

/* The tangent plane of the shape where Newton's method from the node meets it. */
static void find_plane(const fit *f, plane *p) {
    double at[3], slope[3] = {0};
    memcpy(at, f->half->position[p->node], sizeof at);
    for (int newton = 0; newton < 4; ++newton) {
        const double width = 0.05;
        const double here = lar_demo_shape_distance(f->shape, p->tube, at);
        for (int c = 0; c < 3; ++c) {
            double ahead[3] = {at[0], at[1], at[2]}, behind[3] = {at[0], at[1], at[2]};
            ahead[c] += width;
            behind[c] -= width;
            slope[c] = (lar_demo_shape_distance(f->shape, p->tube, ahead) -
                        lar_demo_shape_distance(f->shape, p->tube, behind)) /
                       (2.0 * width);
        }
        const double square = dot3(slope, slope) + 1e-6;
        double step = here / square;
        const double max = 3.0 / sqrt(square);
        step = step > max ? max : step < -max ? -max : step;
        for (int c = 0; c < 3; ++c) at[c] -= step * slope[c];
    }
    const double norm = sqrt(dot3(slope, slope)) + 1e-12;
    for (int c = 0; c < 3; ++c) p->normal[c] = slope[c] / norm;
    p->offset = dot3(p->normal, at);
}

/* Surface nodes: corners of a face that only one cell has; faces on the middle plane are
 * inside the whole organ. */
static void find_surface(fit *f, char *mark) {
    enum { OUTER = 1, TUBE = 2 };
    const lar_demo_half *half = f->half;
    for (int e = 0; e < half->cell_count; ++e)
        for (int face = 0; face < 6; ++face) {
            const int axis = face / 2, side = face % 2;
            int other[3] = {half->cell[e][0], half->cell[e][1], half->cell[e][2]};
            other[axis] += side ? 1 : -1;
            int inner = other[0] < 0;
            for (int g = 0; g < half->cell_count && !inner; ++g)
                inner = !memcmp(half->cell[g], other, sizeof other);
            for (int q = 0; q < 4 && !inner; ++q)
                mark[half->corner[e][lar_face_node[face][q]]] |= OUTER;
        }
    for (int e = 0; e < half->cell_count; ++e)
        for (int a = 0; a < 8 && half->part[e] == LAR_DEMO_TUBES; ++a)
            mark[half->corner[e][a]] |= TUBE;
    for (int a = 0; a < half->node_count; ++a)
        if (mark[a] & OUTER)
            f->planes[f->plane_count++] = (plane){.node = a, .tube = (mark[a] & TUBE) != 0};
}

/* Edge lengths that a cell should have: its own means, drawn towards a cube of its part's mean
 * edge, because the smallest element limits the time step. */
static void find_sizes(fit *f) {
    const lar_demo_half *half = f->half;
    double part_sum[LAR_DEMO_LIGAMENTS + 1] = {0}, part_count[LAR_DEMO_LIGAMENTS + 1] = {0};
    for (int e = 0; e < half->cell_count; ++e) {
        for (int d = 0; d < 3; ++d) f->wanted[e][d] = 0.0;
        for (int a = 0; a < 8; ++a)
            for (int d = 0; d < 3; ++d) {
                double edge[3];
                for (int c = 0; c < 3; ++c)
                    edge[c] = half->position[half->corner[e][f->neighbour[a][d]]][c] -
                              half->position[half->corner[e][a]][c];
                f->wanted[e][d] += 0.125 * sqrt(dot3(edge, edge));
            }
        part_sum[half->part[e]] += f->wanted[e][0] + f->wanted[e][1] + f->wanted[e][2];
        part_count[half->part[e]] += 3.0;
    }
    for (int e = 0; e < half->cell_count; ++e)
        for (int d = 0; d < 3; ++d) {
            const double even = part_sum[half->part[e]] / part_count[half->part[e]];
            f->wanted[e][d] += evenness * (even - f->wanted[e][d]);
        }
}

lar_status lar_demo_fit(lar_demo_half *half, const lar_demo_shape *shape, lar_error *error) {
    fit f = {.half = half, .shape = shape, .size = 3 * (size_t)half->node_count};
    const size_t nodes = (size_t)half->node_count, cells = (size_t)half->cell_count;
    f.wanted = lar_calloc(cells, sizeof *f.wanted);
    f.planes = lar_calloc(nodes, sizeof *f.planes);
    f.work = lar_calloc((4 + 2 * PAIRS) * f.size, sizeof *f.work);
    char *mark = lar_calloc(nodes, 1);
    lar_status status = LAR_OK;
    if (f.wanted && f.planes && f.work && mark) {
        for (int a = 0; a < 8; ++a)
            for (int b = 0; b < 8; ++b) {
                int differ = 0, axis = 0;
                for (int d = 0; d < 3; ++d)
                    if (lar_node_sign[a][d] != lar_node_sign[b][d]) ++differ, axis = d;
                if (differ == 1) f.neighbour[a][axis] = b;
            }
        find_surface(&f, mark);
        for (int round = 0; round < ROUNDS; ++round) {
            const double done = round / (ROUNDS - 1.0);
            find_sizes(&f);
            for (int i = 0; i < f.plane_count; ++i) find_plane(&f, &f.planes[i]);
            f.delta = 0.3 * (1.0 - done) * (1.0 - done) * (1.0 - done) + 1e-3;
            f.surface_weight = 0.5 + 150.0 * done * done;
            f.angle_weight = 1000.0 * done;
            f.step_weight = done > 0.5 ? 2500.0 * done : 0.0;
            minimise(&f, &half->position[0][0]);
        }
    } else {
        status = lar_fail_memory(error, f.size * sizeof *f.work, "the demonstration organ");
    }
    free(f.wanted);
    free(f.planes);
    free(f.work);
    free(mark);
    return status;
}
