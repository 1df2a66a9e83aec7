/* Viscous materials in one point (law/viscous_stress.h): relaxation and creep against closed forms,
 * and that no path of strain gets more out of the terms than it has put in. */
#include "law/every_term.h"
#include "mechanics/stress.h"
#include "testing.h"

static lar_material material_of(lar_law law, bool isochoric, double poisson, int terms,
                                const double (*term)[2]) {
    lar_material m = {.law = law, .density = 1000};
    lar_material_from_young(&m, 1000, poisson);
    m.viscosity = (lar_viscosity){.terms = terms, .isochoric = isochoric, .rest = 0.8};
    for (int i = 0; i < terms; i++) {
        m.viscosity.share[i] = term[i][0];
        m.viscosity.time[i] = term[i][1];
    }
    return m;
}

static const double NOWHERE[3]; /* no fibres */
static const double TERMS[LAR_VISCOUS_TERMS][2] = {{0.5, 0.01}, {1.2, 0.3}, {0.25, 4},
                                                   {0.4, 0.05}, {0.1, 20},  {0.3, 1}};

/* ---- relaxation ----------------------------------------------------------------------------- */

static const double STRAINED[3][3] = {{1.2, 0.1, -0.05}, {0.02, 0.9, 0.15}, {-0.1, 0.07, 1.05}};

/* The law's own stress, and the part of it that relaxes. */
static void parts_of(const lar_material *m, double whole[3][3], double part[3][3]) {
    lar_material elastic = *m;
    elastic.viscosity.terms = 0;
    double cof[9], J = lar_law_stress(&elastic, STRAINED, whole), product = 0;
    lar_lane_cofactor((const double *)(const void *)STRAINED, cof);
    for (int k = 0; k < 9; k++) product += whole[k / 3][k % 3] * STRAINED[k / 3][k % 3];
    for (int k = 0; k < 9; k++)
        part[k / 3][k % 3] =
            whole[k / 3][k % 3] - (m->viscosity.isochoric ? product / (3 * J) * cof[k] : 0);
}

/* Strained at once and held: S falls as g0 + sum g_i exp(-t / t_i), whatever the steps. */
static void check_relaxation(lar_law law, bool isochoric, int terms, int step_count) {
    const lar_material m = material_of(law, isochoric, 0.3, terms, TERMS);
    double history[LAR_HISTORY_MAX] = {0}, P[3][3], whole[3][3], part[3][3], time = 0;
    parts_of(&m, whole, part);
    lar_viscous_stress_at(&m, 1, 0, NOWHERE, STRAINED, history, P);
    for (int n = 0; n <= step_count; n++) {
        double left = m.viscosity.rest;
        for (int i = 0; i < terms; i++) left += TERMS[i][0] * exp(-time / TERMS[i][1]);
        for (int k = 0; k < 9; k++) {
            int i = k / 3, j = k % 3;
            double wanted = whole[i][j] + (left - 1) * part[i][j];
            if (fabs(P[i][j] - wanted) > 1e-10 * fabs(whole[0][0]))
                fail_msg("%s, %d terms, %g s: %g instead of %g", lar_law_name[law], terms, time,
                         P[i][j], wanted);
        }
        double dt = 1.0 / step_count * (1 + n % 3);
        lar_viscous_stress_at(&m, 1, dt, NOWHERE, STRAINED, history, P);
        time += dt;
    }
}

static void relaxation_is_the_closed_form(void **unused) {
    (void)unused;
    for (int law = 0; law < LAR_LAW_COUNT; law++)
        for (int terms = 1; terms <= LAR_VISCOUS_TERMS; terms++)
            for (int isochoric = 0; isochoric < 2; isochoric++) {
                if (isochoric && !lar_law_table[law].uncoupled) continue;
                check_relaxation((lar_law)law, isochoric, terms, 7);
                check_relaxation((lar_law)law, isochoric, terms, 200);
            }
}

/* What is left in the end is lar_law_stress, and half of its factor is half the stress. */
static void the_end_is_the_law_times_g0(void **unused) {
    (void)unused;
    for (int isochoric = 0; isochoric < 2; isochoric++) {
        lar_material m = material_of(LAR_LAW_yeoh, isochoric, 0.3, 3, TERMS), half = m;
        for (int k = 0; k < LAR_LAW_PARAMETERS; k++) half.parameter[k] *= 0.5;
        double history[LAR_HISTORY_MAX] = {0}, P[3][3], Q[3][3], end[3][3];
        lar_viscous_stress_at(&m, 1, 0, NOWHERE, STRAINED, history, P);
        lar_viscous_stress_at(&half, 0.5, 0.1, NOWHERE, STRAINED, history, Q);
        lar_viscous_stress_at(&m, 1, 1e4, NOWHERE, STRAINED, history, P);
        lar_law_stress(&m, STRAINED, end);
        for (int k = 0; k < 9; k++)
            assert_true(fabs(P[k / 3][k % 3] - end[k / 3][k % 3]) < 1e-9 * fabs(end[0][0]));
        assert_true(lar_material_shear(&m) == 0.8 * lar_material_instant_shear(&m) / 2.75);
    }
}

/* ---- creep ---------------------------------------------------------------------------------- */

/* P11 at the small strain e, from `history` on, which stays. Poisson's ratio is 0: the sides stay
 * where they are. */
static double pulled(const lar_material *m, double dt, double e, const double *history) {
    const double F[3][3] = {{1 + e, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double P[3][3], tried[LAR_HISTORY_MAX];
    memcpy(tried, history, sizeof tried);
    lar_viscous_stress_at(m, 1, dt, NOWHERE, F, tried, P);
    return P[0][0];
}

/* Loaded at once and held: strain grows from s / (E (g0 + g)) to s / (E g0) with the time
 * t (g0 + g) / g0 (the standard linear solid; Findley, Lai and Onaran 1976, ch. 5). */
static void check_creep(const double term[2]) {
    enum { STEPS = 400 };
    const lar_material m =
        material_of(LAR_LAW_coupled_neo_hookean, false, 0, 1, (const double(*)[2])term);
    double rest = m.viscosity.rest, share = term[0], stress = 1e-3, young = 1000;
    double slow = term[1] * (rest + share) / rest, end = stress / (young * rest), e = 0;
    double history[LAR_HISTORY_MAX] = {0}, worst = 0;
    for (int n = 0; n <= STEPS; n++) {
        double dt = n ? 4 * slow / STEPS : 0;
        for (int k = 0; k < 20; k++) /* Newton with the slope at once */
            e += (stress - pulled(&m, dt, e, history)) / (young * (rest + share));
        const double F[3][3] = {{1 + e, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        double P[3][3];
        lar_viscous_stress_at(&m, 1, dt, NOWHERE, F, history, P);
        double wanted = end * (1 - share / (rest + share) * exp(-4.0 * n / STEPS));
        worst = fmax(worst, fabs(e / wanted - 1));
    }
    if (worst > 1e-3) fail_msg("a term of g %g, %g s creeps by %g else", share, term[1], worst);
}

static void creep_is_the_closed_form(void **unused) {
    (void)unused;
    for (int i = 0; i < LAR_VISCOUS_TERMS; i++) check_creep(TERMS[i]);
}

/* ---- dissipation ---------------------------------------------------------------------------- */

static uint64_t dice = 88172645463325252u;

/* In [-1, 1). */
static double chance(void) {
    dice ^= dice << 13;
    dice ^= dice >> 7;
    dice ^= dice << 17;
    return (double)(dice >> 11) * 0x1p-52 - 1;
}

/* Changes of volume count `volume` times: false where a body would be inside out. */
static bool keep_volume(double F[9], double volume) {
    double cof[9], J = lar_lane_cofactor(F, cof);
    if (!(J > 0.2)) return false;
    double side = cbrt((1 + volume * (J - 1)) / J);
    for (int k = 0; k < 9; k++) F[k] *= side;
    return true;
}

/* From rest along random straight ways in strain, each in a random time from a thirtieth of the
 * relaxation time to thirty of them: the least work that the terms have ever taken, as a part of
 * all that went in and out. */
static double least_work(const lar_material *m, double strain, double volume) {
    enum { WAYS = 5, STEPS = 12 };
    double history[LAR_HISTORY_MAX] = {0}, from[9] = {0}, to[9], all = 0, least = 0;
    for (int w = 0; w < WAYS; w++) {
        double dt = pow(30, chance()) / STEPS;
        for (int k = 0; k < 9; k++) to[k] = strain * chance();
        for (int n = 1; n <= STEPS; n++) {
            double F[9], P[3][3], before = history[LAR_HISTORY_WORK];
            for (int k = 0; k < 9; k++)
                F[k] = (k % 4 == 0) + from[k] + (to[k] - from[k]) * n / STEPS;
            if (!keep_volume(F, volume)) return least / (all + 1e-300);
            lar_viscous_stress_at(m, 1, dt, NOWHERE, (const double(*)[3])(const void *)F, history,
                                  P);
            all += fabs(history[LAR_HISTORY_WORK] - before) + 1e-300;
            least = fmin(least, history[LAR_HISTORY_WORK]);
        }
        memcpy(from, to, sizeof from);
    }
    return least / all;
}

/* 10^5 paths, of isochoric terms with changes of volume as soft tissue has them. The whole stress
 * only where the volume gives way easily: theory.md says why. */
static void nothing_comes_out_of_the_terms(void **unused) {
    (void)unused;
    const int paths = 100000 / test_every(5);
    static const double one[1][2] = {{1, 1}};
    double worst = 0;
    for (int p = 0; p < paths; p++) {
        lar_law law = (lar_law)(p % LAR_LAW_COUNT);
        bool isochoric = lar_law_table[law].uncoupled;
        lar_material m = material_of(law, isochoric, isochoric ? 0.45 : 0.3, 1, one);
        if (isochoric) every_term(&m, 0.25);
        double least = least_work(&m, 0.3, isochoric ? 0.1 : 1);
        if (least < worst) worst = least;
        if (least < 0) fail_msg("%s, path %d: %g of the work", lar_law_name[law], p, least);
    }
    print_message("least work of %d paths: %g of what went in and out\n", paths, worst);
}

/* A swollen, nearly incompressible body whose whole stress relaxes is where the model itself gives
 * energy: the formats say so, and this sees that it is still true. */
static void a_swollen_body_gives_energy(void **unused) {
    (void)unused;
    static const double one[1][2] = {{1, 1}};
    const lar_material m = material_of(LAR_LAW_coupled_neo_hookean, false, 0.49, 1, one);
    double least = 0;
    for (int p = 0; p < 2000; p++) least = fmin(least, least_work(&m, 0.1, 1));
    assert_true(least < -0.01);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(relaxation_is_the_closed_form),
        cmocka_unit_test(the_end_is_the_law_times_g0),
        cmocka_unit_test(creep_is_the_closed_form),
        cmocka_unit_test(nothing_comes_out_of_the_terms),
        cmocka_unit_test(a_swollen_body_gives_energy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
