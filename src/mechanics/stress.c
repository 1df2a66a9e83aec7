#include "mechanics/stress.h"

#include <math.h>
#include <string.h>

#include "law/fibre_stress.h"
#include "law/viscous_stress.h"

static const double nowhere[3];

static lar_fibre_lane lane_of(const lar_fibre *fibre, const double *direction) {
    lar_fibre_lane lane = {.along = fibre->along, .across = fibre->across};
    memcpy(lane.direction, direction, sizeof lane.direction);
    memcpy(lane.parameter, fibre->parameter, sizeof lane.parameter);
    return lane;
}

/* What lanes do, once for all callers. Without `fibre` the law alone. */
static double relax(const lar_material *material, int terms, double factor, double past,
                    const double *fibre, const double F[3][3], double *history, double P[3][3]) {
    const lar_viscosity *v = &material->viscosity;
    double J = lar_lane_cofactor(&F[0][0], &P[0][0]), I1 = lar_lane_square_sum(&F[0][0]);
    lar_fibre_lane lane = lane_of(&material->fibre, fibre ? fibre : nowhere);
    lar_law_table[material->law].stress(&F[0][0], &P[0][0], J, I1, material->parameter);
    if (fibre && material->fibre.law != LAR_FIBRE_NONE)
        for (int k = 0; k < lar_fibre_families(&material->fibre); k++) {
            const lar_fibre_lane family = lane_of(&material->fibre, fibre + 3 * k);
            (void)lar_fibre_stress(lar_fibre_kind_single(&material->fibre), &F[0][0], &family,
                                   &P[0][0]);
        }
    if (v->terms > 0) {
        lar_viscous_lane c = {.rest = v->rest, .unit = factor, .inverse = 1 / factor};
        for (int i = 0; i < terms; i++) {
            c.share[i] = v->share[i];
            lar_viscous_fade(past, 1 / v->time[i], &c.less[i], &c.rise[i]);
        }
        lar_viscous_stress(&F[0][0], &c, terms, v->isochoric, history, history, 1, &P[0][0]);
    }
    if (fibre && lar_fibre_active(&material->fibre))
        (void)lar_active_stress(&F[0][0], &lane, &P[0][0]);
    return J;
}

double lar_law_stress(const lar_material *material, const double F[3][3], double P[3][3]) {
    double forgotten[LAR_HISTORY_MAX] = {0};
    return relax(material, 0, 1, 0, NULL, F, forgotten, P);
}

double lar_material_stress(const lar_material *material, const double *fibre, const double F[3][3],
                           double P[3][3]) {
    double forgotten[LAR_HISTORY_MAX] = {0};
    return relax(material, 0, 1, 0, fibre, F, forgotten, P);
}

void lar_viscous_stress_at(const lar_material *material, double factor, double past,
                           const double *fibre, const double F[3][3], double *history,
                           double P[3][3]) {
    relax(material, material->viscosity.terms, factor, past, fibre, F, history, P);
}

void lar_relaxing_stress(const lar_material *material, const double *fibre, const double F[3][3],
                         double S[6]) {
    double history[LAR_HISTORY_MAX] = {0}, P[3][3];
    relax(material, 0, 1, 0, fibre, F, history, P);
    memcpy(S, history + LAR_HISTORY_STRESS, 6 * sizeof *S);
}

/* Of a law with an isochoric part: that of a ball as large. */
static double volume_energy(const lar_material *material, double J) {
    double side = 1 / lar_lane_rcbrt(J);
    const double ball[9] = {side, 0, 0, 0, side, 0, 0, 0, side};
    return lar_law_table[material->law].energy(ball, J, 3 * side * side, material->parameter);
}

/* Of the law and its fibres without viscosity, what the fibres have apart. */
static double relaxed(const lar_material *material, double fibres, const double F[3][3]) {
    double cof[9], J = lar_lane_cofactor(&F[0][0], cof), I1 = lar_lane_square_sum(&F[0][0]);
    double energy = lar_law_table[material->law].energy(&F[0][0], J, I1, material->parameter);
    const lar_viscosity *v = &material->viscosity;
    if (v->terms == 0) return energy + fibres;
    double volume = v->isochoric ? volume_energy(material, J) : 0;
    return volume + v->rest * (energy - volume + fibres);
}

double lar_law_energy(const lar_material *material, const double F[3][3]) {
    return relaxed(material, 0, F);
}

/* The integral of c3 (exp(c4 (l - 1)) - 1) / l from 1 to l <= lam_max, an exponential integral: by
 * Gauss's rule with eight points, in as many parts that the exponent grows by two in each at most
 * (1e-15), and of a straight rest in closed form. */
static double exp_linear_energy(const double *p, double stretch) {
    static const double at[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                 0.9602898564975363};
    static const double weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                     0.1012285362903763};
    enum { PARTS_MAX = 400 };
    double x = stretch - 1, toe = fmin(x, p[3] - 1), sum = 0;
    if (!(x > 0)) return 0;
    int parts = 1 + (int)fmin(0.5 * p[1] * toe + 4 * toe, PARTS_MAX);
    double half = 0.5 * toe / parts;
    for (int i = 0; i < parts; i++)
        for (int k = 0; k < 8; k++) {
            double where = (2 * i + 1 + (k < 4 ? at[k] : -at[k - 4])) * half;
            sum += weight[k % 4] * half * p[0] * lar_lane_expm1(p[1] * where) / (1 + where);
        }
    if (x > toe) {
        double end = p[0] * lar_lane_expm1(p[1] * toe) - p[2] * p[3];
        sum += end * log(stretch / p[3]) + p[2] * (stretch - p[3]);
    }
    return sum;
}

static double exp_pow_energy(const double *p, double square) {
    double x = square - 1;
    if (!(x > 0)) return 0;
    double power = lar_lane_exp(p[2] * lar_lane_log(x));
    return p[1] > 0 ? p[0] * lar_lane_expm1(p[1] * power) / (p[1] * p[2]) : p[0] * power / p[2];
}

/* Up to the end of the toe its power law's, from there on that of a force that grows evenly. */
static double pow_linear_energy(const double *p, double square) {
    double end = p[1] * p[1] - 1, x = fmin(square - 1, end), beyond = sqrt(square) - p[1];
    if (!(x > 0)) return 0;
    double k = p[0] / (4 * (p[2] - 1) * p[1] * p[1] * p[1]);
    double first = k * x * lar_lane_exp((p[2] - 2) * lar_lane_log(x / end)), toe = first * x / p[2];
    if (!(beyond > 0)) return toe;
    return toe + 2 * first * p[1] * beyond + (first + 0.5 * p[0] / p[1]) * beyond * beyond;
}

static double hgo_energy(const double *p, double square) {
    double x = fmax(square - 1, 0);
    return 0.5 * p[0] * (p[1] > 0 ? lar_lane_expm1(p[1] * x * x) / p[1] : x * x);
}

/* Of one family. */
static double fibre_energy(const lar_fibre *fibre, const double *direction, const double F[3][3]) {
    double g[3], cof[9], J = lar_lane_cofactor(&F[0][0], cof);
    double length = lar_fibre_push(&F[0][0], direction, g);
    if (fibre->law == LAR_FIBRE_HGO) length = lar_fibre_mean(&F[0][0], length, fibre->parameter[2]);
    double square = lar_fibre_square(lar_fibre_kind_single(fibre), length, J);
    if (fibre->law == LAR_FIBRE_EXP_POW) return exp_pow_energy(fibre->parameter, square);
    if (fibre->law == LAR_FIBRE_HGO) return hgo_energy(fibre->parameter, square);
    if (fibre->law == LAR_FIBRE_POW_LINEAR) return pow_linear_energy(fibre->parameter, square);
    return exp_linear_energy(fibre->parameter, sqrt(square));
}

double lar_active_energy(const lar_material *material, const double *fibre, const double F[3][3]) {
    double g[3], length = lar_fibre_push(&F[0][0], fibre, g);
    double along = lar_fibre_directed(&material->fibre) ? length - 1 : 0;
    double pull = material->fibre.along - material->fibre.across;
    return 0.5 * (pull * along + material->fibre.across * (lar_lane_square_sum(&F[0][0]) - 3));
}

double lar_material_energy(const lar_material *material, const double *fibre,
                           const double F[3][3]) {
    if (!lar_fibre_here(&material->fibre)) return lar_law_energy(material, F);
    double passive = 0;
    for (int k = 0; k < lar_fibre_families(&material->fibre); k++)
        if (material->fibre.law != LAR_FIBRE_NONE)
            passive += fibre_energy(&material->fibre, fibre + 3 * k, F);
    return relaxed(material, passive, F) + lar_active_energy(material, fibre, F);
}

void lar_cauchy_stress(const double F[3][3], const double P[3][3], double J, double cauchy[6]) {
    static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
    for (int n = 0; n < 6; n++) {
        double sum = 0;
        for (int k = 0; k < 3; k++) sum += P[row[n]][k] * F[column[n]][k];
        cauchy[n] = sum / J;
    }
}

double lar_von_mises(const double cauchy[6]) {
    double xy = cauchy[0] - cauchy[1], yz = cauchy[1] - cauchy[2], zx = cauchy[2] - cauchy[0];
    double shear = cauchy[3] * cauchy[3] + cauchy[4] * cauchy[4] + cauchy[5] * cauchy[5];
    return sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3 * shear);
}

double lar_mean_pressure(const double cauchy[6]) {
    return -(cauchy[0] + cauchy[1] + cauchy[2]) / 3;
}
