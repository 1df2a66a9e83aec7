#include "step/rigid/landing.h"

#include <math.h>
#include <string.h>

#include "base/vector.h"

/* The body goes and turns by an impulse at a spot along one of its ways. */
static void add_impulse(lar_landing *landing, const lar_landing_spot *spot, int k, double impulse) {
    for (int i = 0; i < 3; i++) {
        landing->v[i] += impulse * spot->way[k][i] * landing->light[i];
        landing->w[i] += impulse * spot->swing[k][i];
    }
}

static double speed_along(const lar_landing *landing, const lar_landing_spot *spot, int k) {
    double speed = 0;
    for (int i = 0; i < 3; i++)
        speed += spot->way[k][i] * landing->v[i] + spot->lever[k][i] * landing->w[i];
    return speed;
}

/* The speed along one way by an impulse of one along another [1/kg]. */
static double yields(const lar_landing *landing, const lar_landing_spot *spot, int by, int k) {
    double speed = 0;
    for (int i = 0; i < 3; i++)
        speed += spot->way[k][i] * landing->light[i] * spot->way[by][i] +
                 spot->lever[k][i] * spot->swing[by][i];
    return speed;
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
    for (int i = 0; i < 3; i++) {
        landing->light[i] = tool->free >> i & 1 ? 1 / sum->mass : 0;
        landing->v[i] = sum->momentum[i] * landing->light[i];
    }
    for (int i = 0; i < model->contact_count && i < 32; i++)
        for (int k = 0; k < LAR_LANDING_SPOTS && tool->planes >> i & 1; k++)
            landing->spot[landing->count++] = (lar_landing_spot){.plane = i};
}

/* ---- who may touch --------------------------------------------------------------------------- */

static void keep_farther(lar_landing_spot *spot, double value, const lar_landing_spot *fresh) {
    if (spot->node > 0 && !(value > spot->most)) return;
    memcpy(spot, fresh, offsetof(lar_landing_spot, came)); /* the rest is not known yet */
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

static void find_ways(const lar_landing *landing, lar_landing_spot *spot) {
    double beside[2][3];
    memcpy(spot->way[0], landing->model->contact[spot->plane].normal, sizeof spot->way[0]);
    along(spot->way[0], beside);
    memcpy(spot->way[1], beside, sizeof beside);
    for (int k = 0; k < 3; k++) {
        lar_cross(spot->arm, spot->way[k], spot->lever[k]);
        lar_symmetric_product(landing->inverse, spot->lever[k], spot->swing[k]);
    }
    spot->yields = yields(landing, spot, 0, 0);
    spot->yields_beside = lar_greater(yields(landing, spot, 1, 1), yields(landing, spot, 2, 2)) +
                          fabs(yields(landing, spot, 1, 2));
}

/* How it comes, and half of what the step's forces have given it of that. */
static void come(const lar_landing *landing, lar_landing_spot *spot) {
    double turn[3];
    lar_symmetric_product(landing->inverse, landing->sum->had_spin, turn);
    for (int k = 0; k < 3; k++) {
        double had = 0;
        for (int i = 0; i < 3; i++)
            had += spot->way[k][i] * landing->sum->had[i] * landing->light[i] +
                   spot->lever[k][i] * turn[i];
        spot->came[k] = speed_along(landing, spot, k);
        spot->half[k] = 0.5 * (spot->came[k] - had);
    }
}

/* Speed away from the plane of what would come below it, and came faster than what lies there falls
 * in a few steps. Restitution is of the speed in the middle of the step: half of what the step's
 * forces give comes before, and half behind. */
static double thrown_back(const lar_landing *landing, const lar_landing_spot *spot) {
    static const double STEPS = 4;
    const lar_contact *plane = &landing->model->contact[spot->plane];
    const double least = STEPS * lar_length(landing->model->gravity) * landing->dt;
    const double down = -spot->came[0], half = lar_greater(0, -spot->half[0]);
    if (!(plane->restitution > 0) || !(down * landing->dt > spot->gap)) return 0;
    if (!(down + 2 * spot->half[0] > least)) return 0;
    return lar_greater(0, plane->restitution * (down - half) - half);
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
        find_ways(landing, &spot);
        come(landing, &spot);
        spot.back = thrown_back(landing, &spot);
        if (spot.yields > 1e-9 / landing->sum->mass) landing->spot[count++] = spot;
    }
    landing->count = count;
}

/* ---- impulses -------------------------------------------------------------------------------- */

/* Not below the plane at the end of the step; what is, by what turns have of the second order,
 * comes up in a few. Returns how much the impulse changed. */
static double press(lar_landing *landing, lar_landing_spot *spot) {
    static const double RISE = 0.2, FASTEST = 0.1; /* [m/s] */
    double wanted = spot->gap > 0 ? -spot->gap / landing->dt
                                  : lar_lesser(-RISE * spot->gap / landing->dt, FASTEST);
    if (landing->bounces * spot->back > 0)
        wanted = lar_greater(wanted, landing->bounces * spot->back);
    const double more = (wanted - speed_along(landing, spot, 0)) / spot->yields;
    const double change = lar_greater(spot->push[0] + more, 0) - spot->push[0];
    spot->push[0] += change;
    add_impulse(landing, spot, 0, change);
    return fabs(change);
}

static void rub(lar_landing *landing, lar_landing_spot *spot) {
    const double friction = landing->model->contact[spot->plane].friction;
    if (!(friction > 0) || !(spot->yields_beside > 0)) return;
    double wanted[2];
    for (int k = 0; k < 2; k++)
        wanted[k] = spot->push[1 + k] - speed_along(landing, spot, 1 + k) / spot->yields_beside;
    const double size = sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1]);
    const double most = friction * spot->push[0];
    for (int k = 0; k < 2; k++) {
        if (size > most) wanted[k] *= most / size;
        add_impulse(landing, spot, 1 + k, wanted[k] - spot->push[1 + k]);
        spot->push[1 + k] = wanted[k];
    }
}

/* What the body has got at a spot. */
static void impulse_at(const lar_landing_spot *spot, double impulse[3]) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) impulse[i] += spot->push[k] * spot->way[k][i];
}

/* Sweeps over all of them until nothing changes. */
static void find_impulses(lar_landing *landing) {
    enum { SWEEPS = 400 };
    static const double LITTLE = 1e-12; /* of all impulses */
    double most = INFINITY, all = 0;
    for (int n = 0; n < SWEEPS && most > LITTLE * all; n++) {
        most = all = 0;
        for (int k = 0; k < landing->count; k++) {
            /* To and fro, so that no side of the body comes first. */
            lar_landing_spot *spot = &landing->spot[n % 2 ? landing->count - 1 - k : k];
            most = lar_greater(most, press(landing, spot));
            rub(landing, spot);
            all += spot->push[0];
        }
    }
}

/* Whether the impulses have given the body energy, at its speeds in the middle of the step. */
static bool gives(const lar_landing *landing) {
    static const double ROUNDING = 1e-12;
    double sum = 0, all = 0;
    for (int k = 0; k < landing->count; k++)
        for (int i = 0; i < 3; i++) {
            const lar_landing_spot *spot = &landing->spot[k];
            const double came = spot->came[i] - spot->half[i];
            sum += spot->push[i] * (came + (speed_along(landing, spot, i) - spot->half[i]));
            all += fabs(spot->push[i] * came);
        }
    return sum > ROUNDING * all;
}

static void take_back(lar_landing *landing) {
    for (int k = 0; k < landing->count; k++)
        for (int i = 0; i < 3; i++) {
            add_impulse(landing, &landing->spot[k], i, -landing->spot[k].push[i]);
            landing->spot[k].push[i] = 0;
        }
}

/* With friction, or at several spots at once, what is thrown back as fast as restitution says may
 * get more energy than it brought (Kane's paradox): then it is thrown back by the largest part of
 * that with which it does not, to some thousandths. */
static void throw_back(lar_landing *landing) {
    enum { HALVINGS = 10 };
    double less = 0, more = 1;
    for (int n = 0; n < HALVINGS; n++) {
        take_back(landing);
        landing->bounces = 0.5 * (less + more);
        find_impulses(landing);
        *(gives(landing) ? &more : &less) = landing->bounces;
    }
    take_back(landing);
    landing->bounces = less;
    find_impulses(landing);
}

void lar_landing_end(lar_landing *landing) {
    settle(landing);
    landing->bounces = 0;
    for (int k = 0; k < landing->count; k++)
        if (landing->spot[k].back > 0) landing->bounces = 1;
    find_impulses(landing);
    if (landing->bounces > 0 && gives(landing)) throw_back(landing);
    for (int k = 0; k < landing->count; k++) {
        const lar_landing_spot *spot = &landing->spot[k];
        double impulse[3] = {0}, spin[3];
        impulse_at(spot, impulse);
        lar_cross(spot->arm, impulse, spin);
        for (int i = 0; i < 3; i++) {
            landing->sum->momentum[i] += impulse[i];
            landing->sum->spin[i] += spin[i];
        }
    }
}

void lar_landing_on(const lar_landing *landing, int32_t node, double impulse[3]) {
    for (int k = 0; k < landing->count; k++)
        if (landing->spot[k].node == node) impulse_at(&landing->spot[k], impulse);
}
