#include <math.h>
#include <string.h>

#include "base/vector.h"
#include "meshing/fit/work.h"

/* Newton's method for one node at a time, in the order of their numbers (Gauss-Seidel): the
 * Hessian, made positive definite, has three rows, and a node that cannot go on holds up no other
 * one, which a step of all nodes at once would. All cores take part, and what comes out is what one
 * core would find: rows.c keeps the order wherever it matters. */

/* Steps below it [cells] do not wake the neighbours; none is longer than the other. */
static const double STILL = 5e-3, LONGEST = 0.35;
enum { HALVINGS = 12, BLOCKED = 3 }; /* of a step; because faces would cross */

/* ---- the energy around a node --------------------------------------------------------------- */

/* The corners of elements around a node that its place has a part in: four per element. */
static double elements_value(const lar_fit_work *work, int32_t n, const double x[3]) {
    double sum = 0;
    for (int32_t i = work->element_start[n]; i < work->element_start[n + 1]; i++) {
        const int32_t *node = work->mesh->element[work->element_around[i] / 8];
        const int a = work->element_around[i] & 7;
        const double *at[8];
        for (int b = 0; b < 8; b++) at[b] = work->x[node[b]];
        at[a] = x;
        for (int k = 0; k < 4; k++) {
            const int c = k == 3 ? a : lar_fit_edge[a][k];
            double edge[3][3];
            for (int j = 0; j < 3; j++) lar_minus(at[lar_fit_edge[c][j]], at[c], edge[j]);
            sum += lar_fit_corner_energy(&work->law, edge);
            if (!(sum < INFINITY)) return INFINITY;
        }
    }
    return sum;
}

static void elements_newton(const lar_fit_work *work, int32_t n, lar_fit_newton *sum) {
    for (int32_t i = work->element_start[n]; i < work->element_start[n + 1]; i++) {
        const int32_t *node = work->mesh->element[work->element_around[i] / 8];
        const int a = work->element_around[i] & 7;
        for (int k = 0; k < 4; k++) {
            const int c = k == 3 ? a : lar_fit_edge[a][k];
            double edge[3][3];
            int moves = LAR_FIT_MOVES_CORNER;
            for (int j = 0; j < 3; j++) {
                lar_minus(work->x[node[lar_fit_edge[c][j]]], work->x[node[c]], edge[j]);
                if (lar_fit_edge[c][j] == a) moves = j;
            }
            lar_fit_corner_newton(&work->law, edge, moves, sum);
        }
    }
}

/* The corners of slots around a node. */
static double slots_value(const lar_fit_work *work, int32_t n, const double x[3]) {
    double sum = 0;
    for (int32_t i = work->slot_start[n]; i < work->slot_start[n + 1]; i++) {
        const int32_t *node = work->slot[work->slot_around[i] / 4];
        const double *at[4];
        double edge[3][3];
        for (int b = 0; b < 4; b++) at[b] = work->x[node[b]];
        at[work->slot_around[i] & 3] = x;
        for (int j = 0; j < 3; j++) lar_minus(at[j], at[LAR_FIT_MOVES_CORNER], edge[j]);
        sum += lar_fit_corner_energy(&work->slot_law, edge);
    }
    return sum;
}

static void slots_newton(const lar_fit_work *work, int32_t n, lar_fit_newton *sum) {
    for (int32_t i = work->slot_start[n]; i < work->slot_start[n + 1]; i++) {
        const int32_t *node = work->slot[work->slot_around[i] / 4];
        double edge[3][3];
        for (int j = 0; j < 3; j++)
            lar_minus(work->x[node[j]], work->x[node[LAR_FIT_MOVES_CORNER]], edge[j]);
        lar_fit_corner_newton(&work->slot_law, edge, work->slot_around[i] & 3, sum);
    }
}

static void add_plane(const lar_fit_plane *plane, double offset, const double x[3], double share,
                      lar_fit_newton *sum) {
    const double *normal = plane->normal;
    const double off = lar_dot(normal, x) - plane->level - offset,
                 factor = 2 * plane->weight * share;
    sum->value += plane->weight * off * off;
    for (int i = 0; i < 3; i++) {
        sum->gradient[i] += factor * off * normal[i];
        sum->hessian[i] += factor * share * normal[i] * normal[i];
        sum->hessian[3 + i] += factor * share * normal[i] * normal[(i + 1) % 3];
    }
}

/* Squared distances are quadratic in the node's place: what is summed here once serves for every
 * step that is tried. */
static void boundary_newton(const lar_fit_work *work, int32_t n, lar_fit_newton *sum) {
    for (int32_t i = work->point_start[n]; i < work->point_start[n + 1]; i++)
        if (work->point[i].plane.weight > 0)
            add_plane(&work->point[i].plane, work->pair[work->point[i].pair].offset, work->x[n], 1,
                      sum);
    for (int32_t i = work->face_start[n]; i < work->face_start[n + 1]; i++) {
        const lar_fit_face *face = &work->face[work->face_around[i] / 4];
        const int own = work->face_around[i] & 3;
        for (int g = 0; g < LAR_FIT_GAUSS; g++) {
            if (!(face->plane[g].weight > 0)) continue;
            double x[3] = {0};
            for (int a = 0; a < 4; a++)
                for (int k = 0; k < 3; k++)
                    x[k] += lar_fit_share[(a - g) & 3] * work->x[face->node[a]][k];
            add_plane(&face->plane[g], work->pair[face->pair].offset, x,
                      lar_fit_share[(own - g) & 3], sum);
        }
    }
}

/* ---- a step --------------------------------------------------------------------------------- */

/* step = -H^-1 g by Cholesky's decomposition, with as much added to the diagonal as it needs to be
 * positive definite: a few times what `scale` is does for every matrix of numbers, and one that
 * holds no numbers (a node at NaN, an overflow) moves nothing. */
static void newton_step(const lar_fit_newton *at, double step[3]) {
    const double *h = at->hessian, *g = at->gradient;
    const double scale =
        fabs(h[0]) + fabs(h[1]) + fabs(h[2]) + fabs(h[3]) + fabs(h[4]) + fabs(h[5]) + 1e-12;
    for (double shift = 0; shift<100 * scale; shift = shift> 0 ? 4 * shift : 0.02 * scale) {
        const double a = h[0] + shift;
        if (!(a > 1e-3 * scale)) continue;
        const double l1 = h[3] / a, l2 = h[5] / a;
        const double b = h[1] + shift - l1 * h[3];
        if (!(b > 1e-3 * scale)) continue;
        const double l3 = (h[4] - l1 * h[5]) / b;
        const double c = h[2] + shift - l2 * h[5] - l3 * l3 * b;
        if (!(c > 1e-3 * scale)) continue;
        const double y0 = -g[0], y1 = -g[1] - l1 * y0, y2 = -g[2] - l2 * y0 - l3 * y1;
        step[2] = y2 / c;
        step[1] = y1 / b - l3 * step[2];
        step[0] = y0 / a - l1 * step[1] - l2 * step[2];
        return;
    }
    for (int i = 0; i < 3; i++) step[i] = 0;
}

static double quadratic(const lar_fit_newton *at, const double step[3]) {
    const double *h = at->hessian;
    return at->value + lar_dot(at->gradient, step) +
           0.5 * (h[0] * step[0] * step[0] + h[1] * step[1] * step[1] + h[2] * step[2] * step[2]) +
           h[3] * step[0] * step[1] + h[4] * step[1] * step[2] + h[5] * step[2] * step[0];
}

/* Halves the step until the energy falls by a part of what the slope promises (Armijo). */
static double move(lar_fit_work *work, int32_t n) {
    lar_fit_newton boundary = {0}, all;
    boundary_newton(work, n, &boundary);
    all = boundary;
    elements_newton(work, n, &all);
    slots_newton(work, n, &all);
    double step[3];
    newton_step(&all, step);
    double length = lar_length(step);
    if (!(length > 0.1 * STILL)) return 0;
    int blocked = 0;
    double part = length > LONGEST ? LONGEST / length : 1;
    for (int halving = 0; halving < HALVINGS; halving++, part *= 0.5) {
        double tried[3], x[3];
        for (int i = 0; i < 3; i++) {
            tried[i] = part * step[i];
            x[i] = work->x[n][i] + tried[i];
        }
        const double value =
            quadratic(&boundary, tried) + elements_value(work, n, x) + slots_value(work, n, x);
        if (!(value <= all.value + 1e-3 * lar_dot(all.gradient, tried))) continue;
        if (lar_fit_apart_move(work, n, x)) return part * length;
        if (++blocked == BLOCKED) return 0;
    }
    return 0;
}

/* Two nodes that have no part in each other's moves may wake a third one at once. */
static void wake(lar_fit_work *work, int32_t n) {
    __atomic_store_n(&work->awake[n], true, __ATOMIC_RELAXED);
}

static void wake_around(lar_fit_work *work, int32_t n) {
    for (int32_t i = work->element_start[n]; i < work->element_start[n + 1]; i++) {
        const int32_t *node = work->mesh->element[work->element_around[i] / 8];
        for (int a = 0; a < 8; a++) wake(work, node[a]);
    }
    for (int32_t i = work->slot_start[n]; i < work->slot_start[n + 1]; i++)
        for (int a = 0; a < 4; a++) wake(work, work->slot[work->slot_around[i] / 4][a]);
}

void lar_fit_wake_boundary(lar_fit_work *work) {
    for (int32_t i = 0; i < work->point_count; i++) work->awake[work->point[i].node] = true;
}

/* ---- as before ------------------------------------------------------------------------------ */

static bool any_differs(const lar_fit_work *work, int32_t n) {
    const bool *differs = work->record.differs;
    bool any = differs[n];
    for (int32_t i = work->element_start[n]; i < work->element_start[n + 1]; i++) {
        const int32_t *node = work->mesh->element[work->element_around[i] / 8];
        for (int a = 0; a < 8; a++) any |= differs[node[a]];
    }
    for (int32_t i = work->slot_start[n]; i < work->slot_start[n + 1]; i++)
        for (int a = 0; a < 4; a++) any |= differs[work->slot[work->slot_around[i] / 4][a]];
    return any;
}

static void act(lar_fit_work *work, int32_t n, lar_fit_action *action) {
    action->what = LAR_FIT_SLEPT;
    if (work->awake[n]) {
        work->awake[n] = false;
        action->what = move(work, n) > STILL ? LAR_FIT_MOVED : LAR_FIT_STAYED;
    }
    memcpy(action->x, work->x[n], sizeof action->x);
}

static int32_t sweep_node(lar_fit_work *work, int32_t n) {
    lar_fit_record *record = &work->record;
    lar_fit_action *known =
        &record->action[(size_t)record->sweep * (size_t)work->mesh->node_count + (size_t)n];
    if (record->sweep < record->sweeps && !work->apart.checked[n] && !any_differs(work, n)) {
        if (known->what != LAR_FIT_SLEPT) {
            work->awake[n] = false;
            lar_fit_apart_place(work, n, known->x);
        }
    } else {
        lar_fit_action action;
        act(work, n, &action);
        if (action.what != known->what || memcmp(action.x, known->x, sizeof action.x) != 0)
            record->differs[n] = true;
        *known = action;
    }
    if (known->what != LAR_FIT_MOVED) return 0;
    wake_around(work, n);
    return 1;
}

void lar_fit_sweep_again(lar_fit_work *work) {
    lar_fit_record *record = &work->record;
    record->sweeps = record->sweep;
    record->sweep = 0;
    memset(record->differs, 0, (size_t)work->mesh->node_count * sizeof *record->differs);
}

int32_t lar_fit_sweep(lar_fit_work *work) {
    const int32_t moved = lar_fit_rows_visit(work, sweep_node);
    work->record.sweep++;
    return moved;
}

double lar_fit_min(const lar_fit_work *work, double bar, double *part_above) {
    double min = INFINITY;
    int32_t above = 0;
    for (int32_t e = 0; e < work->mesh->element_count; e++) {
        double corner[8][3];
        lar_fit_corners(work, e, corner);
        const double jacobian = lar_scaled_jacobian(corner);
        min = fmin(min, jacobian);
        above += jacobian > bar;
    }
    *part_above = (double)above / work->mesh->element_count;
    return min;
}
