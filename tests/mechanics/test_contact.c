/* The law of contact, points of faces, and how deep a point is in a tool. */
#include "mechanics/contact.h"

#include <math.h>

#include "testing.h"

static const double DT = 1e-4, MASS = 3e-4;

/* A mass that flies against a spring of the law: returns how much of its energy it has afterwards,
 * and how deep it was. */
static double bounce(const lar_contact_law *law, double speed, double start, double *deepest) {
    double depth = start * speed * DT, rate = speed; /* half a step back */
    *deepest = 0;
    for (int i = 0; i < 100000 && depth > 0; i++) {
        rate -= DT / MASS * lar_contact_force(law, MASS, depth, rate);
        depth += DT * rate;
        *deepest = fmax(*deepest, depth);
    }
    assert_true(depth <= 0);
    return rate * rate / (speed * speed);
}

/* Wherever in a step contact begins, and however close the step is to the stable one, what comes
 * back has less energy than what came. */
static void a_bounce_takes_energy(void **unused) {
    (void)unused;
    static const double shares[] = {0.01, 0.3, 0.8, 0.95, 1};
    for (int s = 0; s < 5; s++) {
        lar_contact_law law = lar_contact_law_for(DT, DT / shares[s]);
        double max = 0, min = 1, deepest = 0;
        for (int i = 1; i <= 1000; i++)
            for (int k = 0; k < 4; k++) {
                double depth,
                    left = bounce(&law, (double[]){0.01, 0.1, 1, 5}[k], i / 1000.0, &depth);
                max = fmax(max, left);
                min = fmin(min, left);
                deepest = fmax(deepest, depth / ((double[]){0.01, 0.1, 1, 5}[k] * DT));
            }
        print_message(
            "%.2f of the stable step: %.3f to %.3f of the energy comes back, at most %.1f "
            "steps of flight deep\n",
            shares[s], min, max, deepest);
        assert_below(max, 0.9);
        assert_below(deepest, 5);
    }
}

static void there_is_no_tension_and_nothing_outside(void **unused) {
    (void)unused;
    lar_contact_law law = lar_contact_law_for(DT, 1.25 * DT);
    assert_true(lar_contact_force(&law, MASS, -1e-9, 100) == 0);
    assert_true(lar_contact_force(&law, MASS, 0, 100) == 0);
    assert_true(lar_contact_force(&law, MASS, 1e-4, -1.001) == 0); /* outside a step later */
    assert_true(lar_contact_force(&law, MASS, 1e-4, -0.999) > 0);
    assert_true(fabs(lar_contact_force(&law, MASS, 1e-4, 0) - law.stiffness * MASS * 1e-4) < 1e-15);
}

/* The springs that may meet at a node and an element at its limit: the fastest motion, from one
 * side to the other in every step, still dies away. (A spring of stiffness k that looks ahead by
 * `lead` with the velocity of half a step ago counts like k (1 + 2 lead / dt) there.) */
static void the_step_has_room_for_what_meets(void **unused) {
    (void)unused;
    for (double s = 0.1; s <= 0.9; s += 0.05) {
        lar_contact_law body = lar_contact_law_for(DT, DT / s),
                        tool = lar_contact_tool_law_for(DT, DT / s);
        double bodies = body.stiffness * (1 + 2 * body.lead / DT), holds = 0.5 * bodies;
        double tools = tool.stiffness * (1 + 2 * tool.lead / DT);
        assert_below(4 * s * s + (bodies + holds) * DT * DT, 4 * (1 + 1e-12));
        assert_below(4 * s * s + (tools + holds) * DT * DT, 4 * (1 + 1e-12));
        /* Where half of a node's surroundings is a tool's and it lies on a body beside it. */
        assert_below(4 * s * s + (0.5 * tools + bodies + holds) * DT * DT, 4 * (1 + 1e-12));
        /* Harder tools stir tissue that lies still. */
        assert_true(tool.stiffness * DT * DT > 4.6 * fmin(body.stiffness * DT * DT, 0.25));
    }
}

static void masses(void **unused) {
    (void)unused;
    double weight[4];
    for (int a = 0; a < 4; a++) {
        const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
        lar_face_weights(corner[a][0], corner[a][1], weight);
        for (int b = 0; b < 4; b++) assert_true(weight[b] == (a == b));
    }
    assert_true(fabs(lar_contact_pair_mass(1, 3) - 0.75) < 1e-15);
}

/* A force given to the corners by the weights has the moment of the force at the point. */
static void weights_balance_moments(void **unused) {
    (void)unused;
    const double x[4][3] = {{0, 0, 0.1}, {1, 0.1, 0}, {1.2, 0.9, 0.3}, {-0.1, 1.1, -0.2}};
    for (int k = 0; k < 49; k++) {
        double weight[4], point[3], sum = 0, moment[3] = {0};
        lar_face_weights((k % 7 - 3) / 3.0, (k / 7 - 3) / 3.0, weight);
        lar_face_mean(x, weight, point);
        for (int a = 0; a < 4; a++) {
            sum += weight[a];
            for (int i = 0; i < 3; i++) moment[i] += weight[a] * (x[a][i] - point[i]);
        }
        assert_below(fabs(sum - 1), 1e-15);
        for (int i = 0; i < 3; i++) assert_below(fabs(moment[i]), 1e-15);
    }
    double normal[3];
    const double flat[4][3] = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}};
    lar_face_normal(flat, normal);
    assert_true(normal[0] == 0 && normal[1] == 0 && normal[2] == 12);
}

static void depth_in_a_tool(void **unused) {
    (void)unused;
    const lar_segment shaft = {{{0, 0, 0}, {0, 0, 2}}}, ball = {{{1, 1, 1}, {1, 1, 1}}};
    double normal[3], along;
    assert_below(fabs(lar_segment_depth(&shaft, 0.5, (double[]){0.3, 0, 1}, normal, &along) - 0.2),
                 1e-15);
    assert_true(normal[0] == 1 && normal[1] == 0 && normal[2] == 0 && along == 0.5);
    assert_below(fabs(lar_segment_depth(&shaft, 0.5, (double[]){0, 0.3, 2.4}, normal, &along)),
                 1e-15);
    assert_below(fabs(normal[1] - 0.6) + fabs(normal[2] - 0.8), 1e-15);
    assert_true(along == 1);
    assert_true(lar_segment_depth(&shaft, 0.5, (double[]){0, 0, -3}, normal, &along) == -2.5);
    assert_true(along == 0 && normal[2] == -1);
    assert_true(lar_segment_depth(&ball, 0.5, (double[]){1, 1.25, 1}, normal, &along) == 0.25);
    assert_true(normal[1] == 1);
    /* In the middle of it there is no way out that is shorter than another. */
    assert_true(lar_segment_depth(&ball, 0.5, (double[]){1, 1, 1}, normal, &along) < 0);
    assert_true(lar_segment_depth(&shaft, 0.5, (double[]){0, 0, 1}, normal, &along) < 0);
}

static void sines(void **unused) {
    (void)unused;
    double worst = 0;
    for (double angle = -2; angle <= 2; angle += 1e-3) {
        double sine, cosine;
        lar_sine_cosine(angle, &sine, &cosine);
        worst = fmax(worst, fmax(fabs(sine - sin(angle)), fabs(cosine - cos(angle))));
    }
    assert_below(worst, 1e-14);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bounce_takes_energy),
        cmocka_unit_test(there_is_no_tension_and_nothing_outside),
        cmocka_unit_test(the_step_has_room_for_what_meets),
        cmocka_unit_test(masses),
        cmocka_unit_test(weights_balance_moments),
        cmocka_unit_test(depth_in_a_tool),
        cmocka_unit_test(sines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
