/* Fits of parameters: twin experiments, whose truth is known, of every kind; what cannot be told;
 * intervals that hold what they promise. */
#include "fit_twin.h"

#include "study/inverse/output.h"
#include "study/inverse/parameters.h"

#define FACE(z) "{ plane: { point: [0, 0, " z "], normal: [0, 0, 1] } }"
#define NEO     "law: neo-hookean, density: 1050, shear_modulus: 1.0e3, bulk_modulus: 4.0e4"

static const double SIZE[3] = {0.01, 0.01, 0.02};
static const char CLAMPED[] = "fix: [ { nodes: " FACE("0") ", axes: xyz }, { nodes: " FACE(
    "0.02") ", axes: xy } ]\nmove: [ { nodes: " FACE("0.02") ", axes: z, by: 1, over: 1 } ]\n";
static const char SQUEEZED[] = "fix: [ { nodes: " FACE("0") ", axes: xyz }, { nodes: " FACE(
    "0.02") ", axes: xy } ]\nmove: [ { nodes: " FACE("0.02") ", axes: z, by: -1, over: 1 } ]\n";

/* Forces with the true parameters in one scene, written as the table of another. */
static void write_curve(const char *data, const char *header, const double (*row)[2], int rows,
                        const double *force, bool in_time) {
    char text[16384];
    size_t used = (size_t)snprintf(text, sizeof text, "%s,force\n", header);
    for (int i = 0; i < rows; i++)
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 in_time ? "%.9g,%.9g,%.12g\n" : "%.9g,%.12g\n", row[i][0],
                                 in_time ? row[i][1] : force[i], force[i]);
    twin_write(data, text);
}

/* The clamped bar takes the even ones. */
static const double WAY[6][2] = {{0.001}, {0.002}, {0.003}, {0.004}, {0.005}, {0.006}},
                    FEW[3][2] = {{0.002}, {0.004}, {0.006}};
static const double ONES[6] = {1, 1, 1, 1, 1, 1};

/* A clamped bar: the data are of a finer mesh. */
static void curve_is_fitted(const char *kind, const char *conditions) {
    const double truth[1] = {2.3e3};
    double force[3];
    lar_inverse_result r;
    twin_block("fine.vtk", (const int[3]){5, 5, 10}, SIZE);
    twin_block("coarse.vtk", (const int[3]){4, 4, 8}, SIZE);
    write_scene("fine.yaml", "fine.vtk", NEO, conditions);
    write_scene("coarse.yaml", "coarse.vtk", NEO, conditions);
    write_curve("curve.csv", "displacement", FEW, 3, ONES, false);
    write_fit("of_fine.yaml", FREE("shear_modulus", "1.0e3", "1.0e2", "1.0e5"), kind, "fine.yaml",
              "curve.csv", "");
    twin_measure("of_fine.yaml", truth, force);
    write_curve("curve.csv", "displacement", FEW, 3, force, false);
    write_fit("of_coarse.yaml", FREE("shear_modulus", "1.0e3", "1.0e2", "1.0e5"), kind,
              "coarse.yaml", "curve.csv", "");
    twin_fit("of_coarse.yaml", &r);
    assert_true(r.converged);
    assert_true(r.estimate[0].told);
    assert_below(fabs(r.estimate[0].value / truth[0] - 1), 0.01);
    print_message("%s: %.6g instead of %g, %d runs, %.3g s\n", kind, r.estimate[0].value, truth[0],
                  r.runs, r.seconds);
    lar_inverse_result_clear(&r);
}

static void tension_is_fitted(void **state) {
    (void)state;
    curve_is_fitted("tension", CLAMPED);
}

static void compression_is_fitted(void **state) {
    (void)state;
    curve_is_fitted("compression", SQUEEZED);
}

/* Two constants of a law that stiffens, the same mesh. */
static void two_constants_are_fitted(void **state) {
    (void)state;
    static const char OGDEN[] = "law: ogden, density: 1050, c1: 2.0e3, m1: 5, bulk_modulus: 4.0e4",
                      FREED[] = FREE("c1", "2.0e3", "1.0e2", "1.0e5") FREE("m1", "5", "2", "40");
    const double truth[2] = {1.4e3, 12};
    double force[6];
    lar_inverse_result r;
    twin_block("small.vtk", (const int[3]){2, 2, 4}, SIZE);
    write_scene("ogden.yaml", "small.vtk", OGDEN, CLAMPED);
    write_curve("ogden.csv", "displacement", WAY, 6, ONES, false);
    write_fit("ogden_fit.yaml", FREED, "tension", "ogden.yaml", "ogden.csv", "");
    twin_measure("ogden_fit.yaml", truth, force);
    write_curve("ogden.csv", "displacement", WAY, 6, force, false);
    twin_fit("ogden_fit.yaml", &r);
    for (int j = 0; j < 2; j++) {
        assert_true(r.estimate[j].told);
        assert_below(fabs(r.estimate[j].value / truth[j] - 1), 0.01);
        assert_true(r.estimate[j].low < truth[j] && truth[j] < r.estimate[j].high);
    }
    print_message("ogden: %.6g, %.6g, %d runs, %.3g s\n", r.estimate[0].value, r.estimate[1].value,
                  r.runs, r.seconds);
    lar_inverse_result_clear(&r);
}

/* A pull and what is left of its force: shear modulus, share and time of one term. */
static void relaxation_is_fitted(void **state) {
    (void)state;
    static const char VISCOUS[] =
        NEO ", viscous: { part: isochoric, terms: [ { g: 0.4, time: 0.2 } ] }",
                      FREED[] = FREE("shear_modulus", "1.0e3", "1.0e2", "1.0e5")
                          FREE("g1", "0.3", "0.01", "5") FREE("time1", "0.4", "0.02", "10");
    enum { ROWS = 14 };
    const double truth[3] = {2.0e3, 0.8, 0.15};
    double row[ROWS][2], force[ROWS], ones[ROWS];
    lar_inverse_result r;
    for (int i = 0; i < ROWS; i++) {
        row[i][0] = 0.1 + 0.06 * i;
        row[i][1] = 0.003;
        ones[i] = 1;
    }
    twin_block("small.vtk", (const int[3]){2, 2, 4}, SIZE);
    char conditions[1024];
    snprintf(conditions, sizeof conditions, "%sdamping: 100\n", CLAMPED);
    write_scene("viscous.yaml", "small.vtk", VISCOUS, conditions);
    write_curve("viscous.csv", "time,displacement", row, ROWS, ones, true);
    write_fit("viscous_fit.yaml", FREED, "tension", "viscous.yaml", "viscous.csv", "");
    twin_measure("viscous_fit.yaml", truth, force);
    write_curve("viscous.csv", "time,displacement", row, ROWS, force, true);
    twin_fit("viscous_fit.yaml", &r);
    print_message("viscous: %.6g, %.6g, %.6g, %d runs, %.3g s\n", r.estimate[0].value,
                  r.estimate[1].value, r.estimate[2].value, r.runs, r.seconds);
    for (int j = 0; j < 3; j++) {
        assert_true(r.estimate[j].told);
        assert_below(fabs(r.estimate[j].value / truth[j] - 1), 0.01);
    }
    lar_inverse_result_clear(&r);
}

/* Pressed to 0.7 of its height a block was too fast for the automatic step: forces got noisy, and a
 * search among noise ended near its guess, with narrow intervals. */
static void steps_are_short_enough(void **state) {
    (void)state;
    static const double CUBE[3] = {0.02, 0.02, 0.02}, truth[2] = {0.7, 0.3};
    static const char GEL[] =
        "law: mooney-rivlin, density: 300, c1: 3.1e4, c2: 0, bulk_modulus: 8.0e4, viscous: { part: "
        "isochoric, terms: [ { g: 0.2, time: 0.5 } ] }",
                      FREED[] = FREE("g1", "0.9", "0.01", "10") FREE("time1", "0.15", "0.02", "10");
    double row[16][2] = {{0}}, force[16];
    char conditions[1024];
    lar_inverse_result r;
    for (int i = 0; i < 16; i++) {
        row[i][0] = 0.1 * i;
        row[i][1] = fmin(0.003 * i, 0.006);
        force[i] = 1;
    }
    twin_block("cube.vtk", (const int[3]){4, 4, 4}, CUBE);
    snprintf(conditions, sizeof conditions, "damping: 10\n%s", SQUEEZED);
    write_scene("cube.yaml", "cube.vtk", GEL, conditions);
    write_curve("cube.csv", "time,displacement", row, 16, force, true);
    write_fit("cube_fit.yaml", FREED, "compression", "cube.yaml", "cube.csv", "");
    twin_measure("cube_fit.yaml", truth, force);
    write_curve("cube.csv", "time,displacement", row, 16, force, true);
    twin_fit("cube_fit.yaml", &r);
    print_message("crushed: g1 %.5g [%.5g, %.5g], time1 %.5g [%.5g, %.5g], %d runs, %.3g s\n",
                  r.estimate[0].value, r.estimate[0].low, r.estimate[0].high, r.estimate[1].value,
                  r.estimate[1].low, r.estimate[1].high, r.runs, r.seconds);
    assert_true(r.converged);
    assert_int_equal(r.notes, 0);
    for (int i = 0; i < 2; i++) {
        assert_below(fabs(r.estimate[i].value / truth[i] - 1), 0.01);
        assert_below(r.estimate[i].low, truth[i]);
        assert_below(truth[i], r.estimate[i].high);
    }
    lar_inverse_result_clear(&r);
}

/* The curve has kinks at its rows, the first one among them. What would throw the plate's nodes
 * from one speed to the next is no tissue's: a plate ten times as heavy tells the same. */
static void kinks_throw_nothing(void **state) {
    (void)state;
    enum { ROWS = 4 };
    static const double row[ROWS][2] = {{0, 0}, {0.5, 0.0005}, {1, 0.001}, {1.5, 0.001}};
    static const char HEAVY[] =
        "law: neo-hookean, density: %d, shear_modulus: 1.0e3, bulk_modulus: 4.0e4, "
        "viscous: { part: isochoric, terms: [ { g: 0.4, time: 5 } ] }";
    const double truth[1] = {1.0e3}, ones[ROWS] = {1, 1, 1, 1};
    double force[2][ROWS];
    char material[256], conditions[1024];
    twin_block("small.vtk", (const int[3]){2, 2, 4}, SIZE);
    snprintf(conditions, sizeof conditions, "%sdamping: 10\n", CLAMPED);
    write_curve("kinks.csv", "time,displacement", row, ROWS, ones, true);
    write_fit("kinks_fit.yaml", FREE("shear_modulus", "1.0e3", "1.0e2", "1.0e5"), "tension",
              "kinks.yaml", "kinks.csv", "");
    for (int i = 0; i < 2; i++) {
        snprintf(material, sizeof material, HEAVY, i ? 1000 : 100);
        write_scene("kinks.yaml", "small.vtk", material, conditions);
        twin_measure("kinks_fit.yaml", truth, force[i]);
        assert_true(force[i][0] == 0);
    }
    for (int i = 1; i < ROWS; i++) {
        print_message("row %d: %.6g N, %.6g N\n", i, force[0][i], force[1][i]);
        assert_below(fabs(force[1][i] / force[0][i] - 1), 0.01);
    }
}

/* A sphere into a pad. The tool begins just above it. The mesh tells 2 % under a ball of two
 * elements; so the data are of the same mesh and a finer step, and in full of another mesh. */
static void indentation_is_fitted(void **state) {
    (void)state;
    static const double PAD[3] = {0.04, 0.04, 0.02};
    static const double depth[2][2] = {{0.003}, {0.005}};
    static const char PRESSED[] = "fix: [ { nodes: " FACE(
        "0") ", axes: xyz } ]\n"
             "tools: [ { name: ball, shape: sphere, radius: 0.008, at: [0.02, 0.02, 0.02801] } ]\n";
    const double truth[1] = {2.3e3};
    double force[2];
    lar_inverse_result r;
    const bool full = test_in_full();
    char finer[1024];
    snprintf(finer, sizeof finer, "%s%s", PRESSED, full ? "" : "time_step: 1.0e-4\n");
    twin_block("pad_fine.vtk", full ? (const int[3]){20, 20, 10} : (const int[3]){10, 10, 5}, PAD);
    twin_block("pad.vtk", full ? (const int[3]){16, 16, 8} : (const int[3]){10, 10, 5}, PAD);
    write_scene("pad_fine.yaml", "pad_fine.vtk", NEO, finer);
    write_scene("pad.yaml", "pad.vtk", NEO, PRESSED);
    write_curve("pad.csv", "depth", depth, 2, ONES, false);
    write_fit("pad_fine_fit.yaml", FREE("shear_modulus", "1.5e3", "1.0e2", "1.0e5"), "indentation",
              "pad_fine.yaml", "pad.csv", "");
    twin_measure("pad_fine_fit.yaml", truth, force);
    write_curve("pad.csv", "depth", depth, 2, force, false);
    write_fit("pad_fit.yaml", FREE("shear_modulus", "1.5e3", "1.0e2", "1.0e5"), "indentation",
              "pad.yaml", "pad.csv", "");
    twin_fit("pad_fit.yaml", &r);
    print_message("indentation: %.6g, residual %.3g, %d runs, %.3g s\n", r.estimate[0].value,
                  r.residuals[0].relative, r.runs, r.seconds);
    assert_true(r.estimate[0].told);
    assert_below(fabs(r.estimate[0].value / truth[0] - 1), 0.01);
    lar_inverse_result_clear(&r);
}

/* A flat punch, 20 mm wide: the nodes under it go down together, without friction and stuck to it.
 */
static void flat_punch_is_fitted(const char *more) {
    static const double PAD[3] = {0.04, 0.04, 0.02};
    static const double depth[2][2] = {{0.002}, {0.004}};
    const double truth[1] = {2.3e3};
    double force[2];
    lar_inverse_result r;
    char pressed[1024], finer[1100];
    const bool full = test_in_full();
    snprintf(
        pressed, sizeof pressed,
        "sets: [ { name: punch, nodes: { box: [[0.0099, 0.0099, 0.0199], [0.0301, 0.0301, 0.0201]] "
        "} } ]\n"
        "move: [ { nodes: punch, axes: z, by: -1, over: 1 } ]\n"
        "fix:\n  - { nodes: " FACE("0") ", axes: xyz }\n%s",
        more);
    snprintf(finer, sizeof finer, "%s%s", pressed, full ? "" : "time_step: 1.0e-4\n");
    twin_block("punched_fine.vtk", full ? (const int[3]){20, 20, 10} : (const int[3]){8, 8, 4},
               PAD);
    twin_block("punched.vtk", full ? (const int[3]){16, 16, 8} : (const int[3]){8, 8, 4}, PAD);
    write_scene("punched_fine.yaml", "punched_fine.vtk", NEO, finer);
    write_scene("punched.yaml", "punched.vtk", NEO, pressed);
    write_curve("punched.csv", "depth", depth, 2, ONES, false);
    write_fit("punched_fine_fit.yaml", FREE("shear_modulus", "1.5e3", "1.0e2", "1.0e5"),
              "indentation", "punched_fine.yaml", "punched.csv", "");
    twin_measure("punched_fine_fit.yaml", truth, force);
    assert_true(force[0] > 0 && force[1] > force[0]);
    write_curve("punched.csv", "depth", depth, 2, force, false);
    write_fit("punched_fit.yaml", FREE("shear_modulus", "1.5e3", "1.0e2", "1.0e5"), "indentation",
              "punched.yaml", "punched.csv", "");
    twin_fit("punched_fit.yaml", &r);
    print_message("flat punch: %.6g, %.4g and %.4g N, residual %.3g, %d runs, %.3g s\n",
                  r.estimate[0].value, force[0], force[1], r.residuals[0].relative, r.runs,
                  r.seconds);
    assert_true(r.estimate[0].told);
    assert_below(fabs(r.estimate[0].value / truth[0] - 1), 0.01);
    lar_inverse_result_clear(&r);
}

static void flat_punches_are_fitted(void **state) {
    (void)state;
    flat_punch_is_fitted("");
    flat_punch_is_fitted("  - { nodes: punch, axes: xy }\n");
}

/* ---- points --------------------------------------------------------------------------------- */

static const char HANGING[] =
    "gravity: [0, 0, -30]\nfix: [ { nodes: " FACE("0.02") ", axes: xyz } ]\n";

/* Markers on a bar that hangs, and its outer surface: displacements of the finer mesh's nodes. */
static void points_are_fitted(const char *kind, bool after_only) {
    enum { MARKERS = 24 };
    const double truth[1] = {700};
    double moved[3 * MARKERS], from[MARKERS][3];
    char text[8192], of_fine[64];
    lar_inverse_result r;
    size_t used = (size_t)snprintf(text, sizeof text, "x,y,z,to_x,to_y,to_z\n");
    twin_block("fine.vtk", (const int[3]){6, 6, 12}, SIZE);
    twin_block("coarse.vtk", (const int[3]){5, 5, 10}, SIZE);
    write_scene("hang_fine.yaml", "fine.vtk", NEO, HANGING);
    write_scene("hang.yaml", "coarse.vtk", NEO, HANGING);
    for (int i = 0; i < MARKERS; i++) {
        from[i][0] = i % 2 ? 0.01 : 0;
        from[i][1] = 0.0011 + 0.0078 * (i % 5) / 4;
        from[i][2] = 0.015 * (i / 2) / (MARKERS / 2);
        if (i / 2 == 0) from[i][0] = 0.0023 + 0.004 * i; /* the bottom */
        used += (size_t)snprintf(text + used, sizeof text - used, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n",
                                 from[i][0], from[i][1], from[i][2], from[i][0], from[i][1],
                                 from[i][2] - 0.001);
    }
    twin_write("points.csv", text);
    snprintf(of_fine, sizeof of_fine, "%s_fine_fit.yaml", kind);
    write_fit(of_fine, FREE("shear_modulus", "1.0e3", "2.0e2", "1.0e5"), "markers",
              "hang_fine.yaml", "points.csv", "");
    twin_measure(of_fine, truth, moved);
    used = (size_t)snprintf(text, sizeof text, after_only ? "x,y,z\n" : "x,y,z,to_x,to_y,to_z\n");
    for (int i = 0; i < MARKERS; i++) {
        double *x = from[i], *u = &moved[3 * i];
        if (!after_only)
            used += (size_t)snprintf(text + used, sizeof text - used, "%.12g,%.12g,%.12g,", x[0],
                                     x[1], x[2]);
        used += (size_t)snprintf(text + used, sizeof text - used, "%.12g,%.12g,%.12g\n",
                                 x[0] + u[0], x[1] + u[1], x[2] + u[2]);
    }
    twin_write("points.csv", text);
    write_fit("points_fit.yaml", FREE("shear_modulus", "1.0e3", "2.0e2", "1.0e5"), kind,
              "hang.yaml", "points.csv", "");
    twin_fit("points_fit.yaml", &r);
    print_message("%s: %.6g, %d runs, %.3g s\n", kind, r.estimate[0].value, r.runs, r.seconds);
    assert_true(r.estimate[0].told);
    assert_below(fabs(r.estimate[0].value / truth[0] - 1), 0.01);
    lar_inverse_result_clear(&r);
}

static void markers_are_fitted(void **state) {
    (void)state;
    points_are_fitted("markers", false);
}

static void surfaces_are_fitted(void **state) {
    (void)state;
    points_are_fitted("surface", true);
}

/* ---- what is known --------------------------------------------------------------------------- */

static const char FREELY[] =
    "fix: [ { nodes: " FACE("0") ", axes: z }, { nodes: { nearest: [0, 0, 0] }, axes: xy }, "
                                 "{ nodes: { nearest: [0.01, 0, 0] }, axes: y } ]\n"
                                 "move: [ { nodes: " FACE("0.02") ", axes: z, by: 1, over: 1 } ]\n";

/* One element, free to the sides: two numbers, of which its force knows one. */
static void bulk_modulus_cannot_be_told(void **state) {
    (void)state;
    static const char FREED[] = FREE("shear_modulus", "1.0e3", "1.0e2", "1.0e5")
        FREE("bulk_modulus", "1.0e5", "4.0e4", "1.0e6");
    const double truth[2] = {2.0e3, 2.0e5};
    double force[6];
    uint64_t seed = 88172645463325252u;
    lar_inverse_result r;
    twin_block("one.vtk", (const int[3]){1, 1, 1}, SIZE);
    write_scene("one.yaml", "one.vtk", NEO, FREELY);
    write_curve("one.csv", "displacement", WAY, 6, ONES, false);
    write_fit("one_fit.yaml", FREED, "tension", "one.yaml", "one.csv", "");
    twin_measure("one_fit.yaml", truth, force);
    for (int i = 0; i < 6; i++) force[i] += 0.01 * force[5] * twin_noise(&seed);
    write_curve("one.csv", "displacement", WAY, 6, force, false);
    twin_fit("one_fit.yaml", &r);
    bool said = false;
    for (int i = 0; i < r.notes; i++) {
        print_message("note: %s\n", r.note[i]);
        said = said || strstr(r.note[i], "bulk_modulus of gel cannot be told");
    }
    assert_true(said);
    assert_false(r.estimate[1].told);
    assert_true(r.estimate[0].told);
    assert_below(fabs(r.estimate[0].value / truth[0] - 1), 0.05);
    print_message("cannot be told: %d runs, %.3g s\n", r.runs, r.seconds);
    lar_inverse_result_clear(&r);
}

/* With noise the interval covers the truth in 95 of 100 fits. */
static void intervals_cover_the_truth(void **state) {
    (void)state;
    const int fits = test_in_full() ? 200 : 24;
    const double truth[1] = {2.0e3};
    double clean[6], force[6], begin = 0;
    uint64_t seed = 88172645463325252u;
    int covered = 0;
    twin_block("one.vtk", (const int[3]){1, 1, 1}, SIZE);
    write_scene("one.yaml", "one.vtk", NEO, FREELY);
    write_curve("cover.csv", "displacement", WAY, 6, ONES, false);
    write_fit("cover_fit.yaml", FREE("shear_modulus", "1.5e3", "1.0e2", "1.0e5"), "tension",
              "one.yaml", "cover.csv", "");
    twin_measure("cover_fit.yaml", truth, clean);
    for (int k = 0; k < fits; k++) {
        lar_inverse_result r;
        for (int i = 0; i < 6; i++) force[i] = clean[i] + 0.02 * clean[5] * twin_noise(&seed);
        write_curve("cover.csv", "displacement", WAY, 6, force, false);
        twin_fit("cover_fit.yaml", &r);
        covered += r.estimate[0].low <= truth[0] && truth[0] <= r.estimate[0].high;
        begin += r.seconds;
        lar_inverse_result_clear(&r);
    }
    print_message("%d of %d intervals cover the truth, %.3g s\n", covered, fits, begin);
    if (test_in_full()) assert_in_range(covered, 180, 196);
    assert_true(covered >= 20); /* fewer of 24 would be one draw in 200, and these are fixed */
}

/* A law that cannot stiffen for data that do. */
static void a_wrong_law_is_pointed_out(void **state) {
    (void)state;
    enum { ROWS = 12 };
    static const char OGDEN[] = "law: ogden, density: 1050, c1: 2.0e3, m1: 25, bulk_modulus: 4.0e4";
    const double truth[1] = {2.0e3};
    double row[ROWS][2], ones[ROWS], force[ROWS];
    bool said = false;
    lar_inverse_result r;
    for (int i = 0; i < ROWS; i++) {
        row[i][0] = 0.0005 * (i + 1);
        ones[i] = 1;
    }
    twin_block("one.vtk", (const int[3]){1, 1, 1}, SIZE);
    write_scene("stiffens.yaml", "one.vtk", OGDEN, FREELY);
    write_scene("straight.yaml", "one.vtk", NEO, FREELY);
    write_curve("wrong.csv", "displacement", row, ROWS, ones, false);
    write_fit("stiffens_fit.yaml", FREE("c1", "2.0e3", "1.0e2", "1.0e5"), "tension",
              "stiffens.yaml", "wrong.csv", "");
    twin_measure("stiffens_fit.yaml", truth, force);
    write_curve("wrong.csv", "displacement", row, ROWS, force, false);
    write_fit("wrong_fit.yaml", FREE("shear_modulus", "1.5e3", "1.0e2", "1.0e5"), "tension",
              "straight.yaml", "wrong.csv", "");
    twin_fit("wrong_fit.yaml", &r);
    for (int i = 0; i < r.notes; i++) said = said || strstr(r.note[i], "too soft at large strain");
    assert_true(said);
    assert_true(r.residuals[0].systematic);
    lar_inverse_result_clear(&r);
}

/* Two experiments of one tissue: what neither tells alone they tell together. */
static void experiments_share_parameters(void **state) {
    (void)state;
    static const char CONFINED[] = "fix: [ { nodes: all, axes: xy }, { nodes: " FACE(
        "0") ", axes: z } ]\n"
             "move: [ { nodes: " FACE("0.02") ", axes: z, by: 1, over: 1 } ]\n";
    static const char FREED[] = FREE("shear_modulus", "1.0e3", "1.0e2", "1.0e5")
        FREE("bulk_modulus", "1.0e5", "1.0e4", "1.0e6");
    const double truth[2] = {2.0e3, 6.0e4};
    double force[6];
    char text[TWIN_TEXT];
    lar_inverse_result r;
    twin_block("one.vtk", (const int[3]){1, 1, 1}, SIZE);
    write_scene("one.yaml", "one.vtk", NEO, FREELY);
    write_scene("confined.yaml", "one.vtk", NEO, CONFINED);
    static const char *const name[2] = {"one", "confined"};
    for (int k = 0; k < 2; k++) {
        char data[64], scene[64], fit[64];
        snprintf(data, sizeof data, "two_%s.csv", name[k]);
        snprintf(scene, sizeof scene, "%s.yaml", name[k]);
        snprintf(fit, sizeof fit, "two_%s_fit.yaml", name[k]);
        write_curve(data, "displacement", WAY, 6, ONES, false);
        write_fit(fit, FREED, "tension", scene, data, "");
        twin_measure(fit, truth, force);
        write_curve(data, "displacement", WAY, 6, force, false);
    }
    snprintf(text, sizeof text,
             "lariat-fit: 1\nparameters:\n%s\nexperiments:\n"
             "  - { kind: tension, scene: %s, data: %s }\n"
             "  - { kind: tension, scene: %s, data: %s }\n",
             FREED, twin_path("one.yaml"), twin_path("two_one.csv"), twin_path("confined.yaml"),
             twin_path("two_confined.csv"));
    twin_write("two_fit.yaml", text);
    twin_fit("two_fit.yaml", &r);
    for (int j = 0; j < 2; j++) {
        assert_true(r.estimate[j].told);
        assert_below(fabs(r.estimate[j].value / truth[j] - 1), 0.01);
    }
    lar_inverse_result_clear(&r);
}

/* A tissue file is a material of a scene again. */
static void tissues_go_into_scenes(void **state) {
    (void)state;
    static const char VISCOUS[] =
        "law: ogden, density: 1050, c1: 2.0e3, m1: 5, bulk_modulus: 4.0e4, "
        "viscous: { part: isochoric, g0: 0.9, terms: [ { g: 0.4, time: 0.2 } ] }";
    lar_inverse_problem problem;
    lar_error error = {0};
    lar_model *model = NULL;
    twin_block("one.vtk", (const int[3]){1, 1, 1}, SIZE);
    write_scene("tissue_from.yaml", "one.vtk", VISCOUS, FREELY);
    twin_write("tissue.csv", "time,displacement,force\n0.1,0.001,1\n0.2,0.001,1\n");
    write_fit("tissue_fit.yaml", FREE("c1", "1.0e3", "1.0e2", "1.0e5"), "tension",
              "tissue_from.yaml", "tissue.csv", "");
    twin_read("tissue_fit.yaml", &problem);
    lar_inverse_result r = {
        .estimate = {{.value = 3.5e3, .low = 3.4e3, .high = 3.6e3, .told = true}}};
    if (lar_inverse_write_tissue(twin_path("gel.tissue.yaml"), &problem, &r, "gel", &error))
        fail_msg("%s", error.message);
    char text[TWIN_TEXT];
    snprintf(text, sizeof text, "lariat: 1\nmesh: %s\nmaterials: [ { cells: all, tissue: %s } ]\n",
             twin_path("one.vtk"), twin_path("gel.tissue.yaml"));
    twin_write("tissue_to.yaml", text);
    if (lar_model_open(twin_path("tissue_to.yaml"), &model, &error)) fail_msg("%s", error.message);
    const lar_material *m = &model->material[0];
    assert_int_equal(m->law, LAR_LAW_ogden);
    assert_true(m->parameter[0] == 3.5e3 && m->viscosity.rest == 0.9 && m->density == 1050);
    assert_true(m->viscosity.terms == 1 && m->viscosity.share[0] == 0.4);
    lar_model_destroy(model);
    lar_inverse_problem_clear(&problem);
}

static void student_is_as_in_tables(void **state) {
    (void)state;
    assert_below(fabs(lar_student_95(1) - 12.7062), 1e-3);
    assert_below(fabs(lar_student_95(5) - 2.5706), 1e-3);
    assert_below(fabs(lar_student_95(10) - 2.2281), 1e-3);
    assert_below(fabs(lar_student_95(1000) - 1.9623), 1e-3);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(student_is_as_in_tables),
                                       cmocka_unit_test(tension_is_fitted),
                                       cmocka_unit_test(compression_is_fitted),
                                       cmocka_unit_test(two_constants_are_fitted),
                                       cmocka_unit_test(relaxation_is_fitted),
                                       cmocka_unit_test(kinks_throw_nothing),
                                       cmocka_unit_test(steps_are_short_enough),
                                       cmocka_unit_test(indentation_is_fitted),
                                       cmocka_unit_test(flat_punches_are_fitted),
                                       cmocka_unit_test(markers_are_fitted),
                                       cmocka_unit_test(surfaces_are_fitted),
                                       cmocka_unit_test(bulk_modulus_cannot_be_told),
                                       cmocka_unit_test(intervals_cover_the_truth),
                                       cmocka_unit_test(a_wrong_law_is_pointed_out),
                                       cmocka_unit_test(experiments_share_parameters),
                                       cmocka_unit_test(tissues_go_into_scenes)};
    return cmocka_run_group_tests(tests, twin_needs_cminpack, NULL);
}
