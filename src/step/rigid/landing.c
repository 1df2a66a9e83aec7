#include "step/rigid/landing.h"

#include <math.h>

#include "base/vector.h"

/* Pushes the body at a place: momentum and spin, and what it goes and turns by for that. */
static void add_impulse(lar_landing *landing, const double arm[3], const double impulse[3]) {
    lar_rigid_sum *sum = landing->sum;
    double spin[3], turn[3];
    lar_cross(arm, impulse, spin);
    lar_symmetric_product(landing->inverse, spin, turn);
    for (int i = 0; i < 3; i++) {
        sum->momentum[i] += impulse[i];
        sum->spin[i] += spin[i];
        if (landing->tool->free >> i & 1) landing->v[i] += impulse[i] / sum->mass;
        landing->w[i] += turn[i];
    }
}

/* The speed along b of what is pushed by one along a, at the same place [1/kg]. */
static double yields(const lar_landing *landing, const double arm[3], const double a[3],
                     const double b[3]) {
    double spin[3], turn[3], swung[3], sum = 0;
    lar_cross(arm, a, spin);
    lar_symmetric_product(landing->inverse, spin, turn);
    lar_cross(turn, arm, swung);
    for (int i = 0; i < 3; i++) {
        sum += b[i] * swung[i];
        if (landing->tool->free >> i & 1) sum += b[i] * a[i] / landing->sum->mass;
    }
    return sum;
}

/* Two directions along a plane. */
static void along(const double normal[3], double out[2][3]) {
    int least = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(normal[i]) < fabs(normal[least])) least = i;
    double axis[3] = {0};
    axis[least] = 1;
    lar_cross(normal, axis, out[0]);
    const double length = lar_length(out[0]);
    for (int i = 0; i < 3; i++) out[0][i] /= length;
    lar_cross(normal, out[0], out[1]);
}

void lar_landing_begin(const lar_model *model, const lar_tool *tool, lar_rigid_sum *sum, double dt,
                       lar_landing *landing) {
    landing->model = model;
    landing->tool = tool;
    landing->sum = sum;
    landing->dt = dt;
    landing->nodes = 0;
    landing->count = 0;
    lar_rigid_sum_yields(sum, tool, landing->inverse);
    lar_symmetric_product(landing->inverse, sum->spin, landing->w);
    for (int i = 0; i < 3; i++)
        landing->v[i] = tool->free >> i & 1 ? sum->momentum[i] / sum->mass : 0;
    for (int i = 0; i < model->contact_count && i < 32; i++)
        for (int k = 0; k < LAR_LANDING_SPOTS && tool->planes >> i & 1; k++)
            landing->spot[landing->count++] = (lar_landing_spot){.plane = i};
}

/* ---- who may touch --------------------------------------------------------------------------- */

static void keep_farther(lar_landing_spot *spot, double value, const lar_landing_spot *fresh) {
    if (spot->node > 0 && !(value > spot->most)) return;
    *spot = *fresh;
    spot->most = value;
}

void lar_landing_meet(lar_landing *landing, const double arm[3]) {
    static const double WAY[8][2] = {
        {1, 0},
        {0.92387953251128674, 0.38268343236508977},
        {0.70710678118654752, 0.70710678118654752},
        {0.38268343236508977, 0.92387953251128674},
        {0, 1},
        {-0.38268343236508977, 0.92387953251128674},
        {-0.70710678118654752, 0.70710678118654752},
        {-0.92387953251128674, 0.38268343236508977},
    };
    const double fast = lar_length(landing->v) + lar_length(landing->w) * lar_length(arm);
    landing->nodes++;
    for (int first = 0; first < landing->count; first += LAR_LANDING_SPOTS) {
        lar_landing_spot *spot = &landing->spot[first];
        const lar_contact *plane = &landing->model->contact[spot->plane];
        lar_landing_spot fresh = {.node = landing->nodes, .plane = spot->plane};
        double beside[2][3];
        for (int i = 0; i < 3; i++) {
            fresh.arm[i] = arm[i];
            fresh.gap += plane->normal[i] * (landing->sum->centre[i] + arm[i] - plane->through[i]);
        }
        if (fresh.gap > 2 * landing->dt * fast) continue;
        along(plane->normal, beside);
        const double x = lar_dot(beside[0], arm), y = lar_dot(beside[1], arm);
        for (int k = 0; k < 8; k++) {
            const double value = WAY[k][0] * x + WAY[k][1] * y;
            keep_farther(&spot[2 * k], value, &fresh);
            keep_farther(&spot[2 * k + 1], -value, &fresh);
        }
        keep_farther(&spot[16], -fresh.gap, &fresh);
    }
}

/* Every node once, and those alone that can give way. */
static void settle(lar_landing *landing) {
    int count = 0;
    for (int k = 0; k < landing->count; k++) {
        lar_landing_spot spot = landing->spot[k];
        bool known = spot.node == 0;
        for (int i = 0; i < count; i++)
            known = known ||
                    (landing->spot[i].node == spot.node && landing->spot[i].plane == spot.plane);
        if (known) continue;
        const double *normal = landing->model->contact[spot.plane].normal;
        double beside[2][3];
        along(normal, beside);
        spot.yields = yields(landing, spot.arm, normal, normal);
        spot.yields_beside = lar_greater(yields(landing, spot.arm, beside[0], beside[0]),
                                         yields(landing, spot.arm, beside[1], beside[1])) +
                             fabs(yields(landing, spot.arm, beside[0], beside[1]));
        if (spot.yields > 1e-9 / landing->sum->mass) landing->spot[count++] = spot;
    }
    landing->count = count;
}

/* ---- impulses -------------------------------------------------------------------------------- */

static double speed_along(const lar_landing *landing, const lar_landing_spot *spot,
                          const double direction[3]) {
    double swung[3];
    lar_cross(landing->w, spot->arm, swung);
    return lar_dot(direction, landing->v) + lar_dot(direction, swung);
}

/* Not below the plane at the end of the step; what is, by what turns have of the second order,
 * comes up in a few. Returns how much the impulse changed. */
static double press(lar_landing *landing, lar_landing_spot *spot) {
    static const double RISE = 0.2, FASTEST = 0.1; /* [m/s] */
    const double *normal = landing->model->contact[spot->plane].normal;
    const double wanted = spot->gap > 0 ? -spot->gap / landing->dt
                                        : lar_lesser(-RISE * spot->gap / landing->dt, FASTEST);
    const double more = (wanted - speed_along(landing, spot, normal)) / spot->yields;
    const double change = lar_greater(spot->push + more, 0) - spot->push;
    double impulse[3];
    for (int i = 0; i < 3; i++) impulse[i] = change * normal[i];
    spot->push += change;
    add_impulse(landing, spot->arm, impulse);
    return fabs(change);
}

static void rub(lar_landing *landing, lar_landing_spot *spot) {
    const lar_contact *plane = &landing->model->contact[spot->plane];
    if (!(plane->friction > 0) || !(spot->yields_beside > 0)) return;
    double beside[2][3], wanted[2], impulse[3] = {0};
    along(plane->normal, beside);
    for (int k = 0; k < 2; k++)
        wanted[k] = spot->rub[k] - speed_along(landing, spot, beside[k]) / spot->yields_beside;
    const double size = sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1]);
    const double most = plane->friction * spot->push;
    for (int k = 0; k < 2; k++) {
        if (size > most) wanted[k] *= most / size;
        for (int i = 0; i < 3; i++) impulse[i] += (wanted[k] - spot->rub[k]) * beside[k][i];
        spot->rub[k] = wanted[k];
    }
    add_impulse(landing, spot->arm, impulse);
}

void lar_landing_end(lar_landing *landing) {
    enum { SWEEPS = 60 };
    static const double LITTLE = 1e-12; /* of all impulses */
    settle(landing);
    double most = INFINITY, all = 0;
    for (int n = 0; n < SWEEPS && most > LITTLE * all; n++) {
        most = all = 0;
        for (int k = 0; k < landing->count; k++) {
            /* To and fro, so that no side of the body comes first. */
            lar_landing_spot *spot = &landing->spot[n % 2 ? landing->count - 1 - k : k];
            most = lar_greater(most, press(landing, spot));
            rub(landing, spot);
            all += spot->push;
        }
    }
}

void lar_landing_on(const lar_landing *landing, int32_t node, double impulse[3]) {
    for (int k = 0; k < landing->count; k++) {
        const lar_landing_spot *spot = &landing->spot[k];
        const double *normal = landing->model->contact[spot->plane].normal;
        double beside[2][3];
        if (spot->node != node) continue;
        along(normal, beside);
        for (int i = 0; i < 3; i++)
            impulse[i] +=
                spot->push * normal[i] + spot->rub[0] * beside[0][i] + spot->rub[1] * beside[1][i];
    }
}
