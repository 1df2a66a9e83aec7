/* The whole way of an aspiration (T 1.3): a run of examples/fit_tube.yaml with parameters that are
 * known, frames of it as a camera would take them, profiles from these, and a fit. */
#include "film.h"

#include "study/frames/profiles.h"

enum { FRAMES = 31, POINTS = 12 };
static const double REACH = 0.0046, TUBE = 0.005;

/* Heights at some distances from the axis, and nothing at the rim; between them a cubic spline,
 * level at the axis: tissue has no kinks. */
typedef struct knots {
    double r[POINTS + 1], z[POINTS + 1], bend[POINTS + 1]; /* second derivatives */
} knots;

static void make_knots(const double *z, knots *s) {
    double right[POINTS + 1], above[POINTS + 1];
    for (int k = 0; k <= POINTS; k++) {
        s->r[k] = k < POINTS ? REACH * k / (POINTS - 1) : TUBE;
        s->z[k] = z && k < POINTS ? z[k] : 0;
    }
    /* A tridiagonal system: slope 0 at the axis, no bend at the rim. */
    double first = s->r[1] - s->r[0];
    above[0] = 0.5;
    right[0] = 3 * (s->z[1] - s->z[0]) / (first * first);
    for (int k = 1; k < POINTS; k++) {
        double h = s->r[k] - s->r[k - 1], next = s->r[k + 1] - s->r[k];
        double jump = (s->z[k + 1] - s->z[k]) / next - (s->z[k] - s->z[k - 1]) / h;
        double pivot = 2 * (h + next) - h * above[k - 1];
        above[k] = next / pivot;
        right[k] = (6 * jump - h * right[k - 1]) / pivot;
    }
    s->bend[POINTS] = 0;
    for (int k = POINTS - 1; k >= 0; k--) s->bend[k] = right[k] - above[k] * s->bend[k + 1];
}

static double height_at(const void *context, double r) {
    const knots *s = context;
    int k = 0;
    while (k + 1 < POINTS && r > s->r[k + 1]) k++;
    double h = s->r[k + 1] - s->r[k], b = (r - s->r[k]) / h, a = 1 - b;
    return a * s->z[k] + b * s->z[k + 1] +
           h * h / 6 * ((a * a * a - a) * s->bend[k] + (b * b * b - b) * s->bend[k + 1]);
}

/* The example's experiment with another table in SI units. */
static void write_experiment(const char *name, const char *table) {
    char text[2000];
    snprintf(text, sizeof text,
             "lariat-fit: 1\nparameters:\n"
             "  - { material: tissue, parameter: shear_modulus, guess: 4.0e3, bounds: [1.0e2, "
             "1.0e5] }\n"
             "  - { material: tissue, parameter: g1, guess: 0.4, bounds: [0.01, 5] }\n"
             "  - { material: tissue, parameter: time1, guess: 0.2, bounds: [0.02, 10] }\n"
             "experiments:\n"
             "  - { kind: aspiration, scene: %s/fit_tube.yaml, data: %s, pressure: %s, columns: { "
             "pressure: pressure_mbar }, scale: { pressure: 100 }, origin: [0, 0, 0], axis: [0, 0, "
             "1] }\n",
             LAR_TEST_EXAMPLES, table, twin_path("suction_s.csv"));
    twin_write(name, text);
}

static void write_table(const char *name) {
    FILE *out = fopen(twin_path(name), "w");
    assert_non_null(out);
    fprintf(out, "time,r,z\n");
    for (int i = 1; i < FRAMES; i++)
        for (int k = 0; k < POINTS; k++)
            fprintf(out, "%.9g,%.9g,%.9g\n", i / 25.0, REACH * k / (POINTS - 1), 1e-3);
    assert_int_equal(fclose(out), 0);
}

static void frames_lead_to_the_tissue(void **state) {
    (void)state;
    static const double truth[3] = {2.7e3, 0.9, 0.3};
    static double z[TWIN_ROWS];
    char path[600], view[600];
    film f = {.width = 300,
              .height = 150,
              .scale = 4e-5,
              .axis = 150.4,
              .rim = 125.3,
              .tube = TUBE,
              .tissue = 0.7,
              .behind = 0.25,
              .blur = 1.5,
              .noise = 0.04,
              .uneven = 0.5,
              .specks = 6,
              .seed = 88172645463325252u};
    write_table("whole.csv");
    twin_write("suction_s.csv", "time,pressure_mbar\n0,0\n0.2,30\n1.2,30\n");
    write_experiment("whole.yaml", twin_path("whole.csv"));
    twin_measure("whole.yaml", truth, z);
    film_folder("whole");
    for (int i = 0; i < FRAMES; i++) {
        knots s;
        make_knots(i > 0 ? &z[(i - 1) * POINTS] : NULL, &s);
        snprintf(path, sizeof path, "%s/side%d.pgm", twin_path("whole"), i);
        film_write(&f, height_at, &s, path);
    }
    snprintf(view, sizeof view,
             "lariat-view: 1\nmm_per_pixel: 0.04\naxis_pixel: %g\nrim_pixel: %g\nradius_mm: %g\n"
             "points: %d\n",
             f.axis, f.rim, 1e3 * REACH, POINTS);
    twin_write("whole_view.yaml", view);
    lar_profiles p = {0};
    lar_error error = {0};
    if (lar_profiles_read(twin_path("whole"), twin_path("whole_view.yaml"), NULL, &p, &error) ||
        lar_profiles_write(&p, twin_path("seen.csv"), &error))
        fail_msg("%s", error.message);
    double worst = 0, covered = 0;
    for (int i = POINTS; i < FRAMES * POINTS; i++) {
        double off = fabs(p.point[i].z - z[i - POINTS]);
        if (!(p.point[i].error > 0)) continue;
        worst = fmax(worst, off);
        covered += off < 1.96 * p.point[i].error;
    }
    print_message("%d points, %d missed, worst %.1f um, stated %.1f um, %.1f %% covered, %.0f "
                  "frames/s\n",
                  p.found, p.missed, 1e6 * worst, 1e6 * p.error, 100 * covered / (p.found - POINTS),
                  FRAMES / p.seconds);
    assert_below(worst, 30e-6);
    lar_profiles_clear(&p);
    write_experiment("seen.yaml", twin_path("seen.csv"));
    lar_inverse_result r;
    twin_fit("seen.yaml", &r);
    for (int j = 0; j < 3; j++) {
        print_message("%.6g, 95 %% between %.6g and %.6g\n", r.estimate[j].value, r.estimate[j].low,
                      r.estimate[j].high);
        assert_true(r.estimate[j].told);
        assert_true(r.estimate[j].low <= truth[j] && truth[j] <= r.estimate[j].high);
        assert_below(fabs(r.estimate[j].value / truth[j] - 1), 0.1);
    }
    print_message("%d runs, %.3g s\n", r.runs, r.seconds);
    lar_inverse_result_clear(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(frames_lead_to_the_tissue)};
    return cmocka_run_group_tests(tests, twin_needs_cminpack, NULL);
}
