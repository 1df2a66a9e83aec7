/* A rigid sphere pressed into a large block: Hertz (1882). The force of a sphere of radius R that
 * is pressed d deep into a half-space is F = 4/3 E / (1 - nu^2) sqrt(R) d^(3/2), as long as the
 * radius of contact, sqrt(R d), is small beside R.
 *
 * The block is so large that its sides and bottom do not count, and fine where the sphere is. The
 * tool's springs are part of what is measured: at 0.8 of the stable step and where the volume may
 * change they are nearly as soft as the body's first layer of elements (docs/theory.md, contact).
 */
#include "engine/engine_test.h"
#include "engine/tool_contact_test.h"

enum { FINE = 6, COARSE = 13 };

/* Lines of the mesh on one side of the middle, in radii of contact: even, then wider and wider. */
static void lines(double line[FINE + COARSE + 1]) {
    double width = 0.25;
    line[0] = 0;
    for (int i = 1; i <= FINE + COARSE; i++) {
        if (i > FINE) width *= 1.35;
        line[i] = line[i - 1] + width;
    }
}

static lar_model *half_space(double contact, double young, double poisson, double density) {
    enum { SIDE = FINE + COARSE };
    brick b = {{2 * SIDE, 2 * SIDE, SIDE},
               contact,
               0,
               LAR_LAW_neo_hookean,
               young / (2 * (1 + poisson)),
               young / (3 * (1 - 2 * poisson)),
               density};
    double line[SIDE + 1];
    lines(line);
    lar_model *model = brick_model(&b);
    for (int k = 0; k <= SIDE; k++)
        for (int j = 0; j <= 2 * SIDE; j++)
            for (int i = 0; i <= 2 * SIDE; i++) {
                double *x = model->mesh.position[brick_node(&b, i, j, k)];
                x[0] = contact * (i < SIDE ? -line[SIDE - i] : line[i - SIDE]);
                x[1] = contact * (j < SIDE ? -line[SIDE - j] : line[j - SIDE]);
                x[2] = -contact * line[SIDE - k];
            }
    fix_nodes(model, brick_side(&b, 2, 0), LAR_AXIS_ALL);
    return model;
}

static void indent(double poisson, double share_of_stable) {
    const double radius = 0.05, young = 1e4, density = 1000, depth = 0.02 * radius;
    double contact = sqrt(radius * depth);
    lar_model *model = half_space(contact, young, poisson, density);
    touch_tool(model, "ball", (lar_tool){.shape = LAR_TOOL_SPHERE, .radius = radius},
               (double[]){0, 0, 1.0001 * radius});
    /* Critical for waves over some ten radii of contact: what is farther hardly counts. */
    double shear_speed = sqrt(young / (2 * (1 + poisson)) / density);
    model->damping = shear_speed / (5 * contact);
    lar_options options = lar_options_default();
    options.time_step = share_of_stable * stable_step_of(model);
    lar_simulation *simulation = start_with(model, options);
    double ramp = 20 * contact / shear_speed;
    uint64_t steps = (uint64_t)(ramp / options.time_step);
    place(simulation, 0, (double[]){0, 0, radius - depth}, (double[]){1, 0, 0, 0}, 1, steps);
    advance(simulation, 3 * steps);
    lar_tool_force force;
    lar_error error;
    advance(simulation, steps);
    assert_int_equal(lar_simulation_tool_force(simulation, 0, &force, &error), LAR_OK);
    double hertz = 4.0 / 3 * young / (1 - poisson * poisson) * sqrt(radius) * pow(depth, 1.5);
    print_message("Poisson's ratio %.3f, %.2f of the stable step: %.4f N, Hertz %.4f N, off by "
                  "%+.2f %%; %d points, %llu steps\n",
                  poisson, share_of_stable, force.force[2], hertz,
                  100 * (force.force[2] / hertz - 1), (int)force.touching,
                  (unsigned long long)lar_simulation_steps(simulation));
    assert_below(fabs(force.force[2] / hertz - 1), 0.05);
    for (int i = 0; i < 2; i++) assert_below(fabs(force.force[i]), 1e-6 * hertz);
    finish(simulation, model);
}

static void a_sphere_is_pressed_in(void **unused) {
    (void)unused;
    indent(0.3, 0.8);
    indent(0.3, 0.5);
    indent(0.3, 0.41); /* the automatic one */
    indent(0.49, 0.8);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_sphere_is_pressed_in)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
