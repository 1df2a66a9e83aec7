/* What probes.csv says of tools, contact and energies is what the calls say. */
#include "engine/engine_test.h"
#include "engine/tools_test.h"

#include "engine/tool_contact_test.h"

#define FOLDER LAR_TEST_BUILD "/probes"

static lar_probe *add_probe(lar_model *model, const char *name, int what) {
    lar_probe *probe = LAR_MODEL_APPEND(model, output.probe);
    *probe = (lar_probe){.name = lar_strdup(name), .what = what};
    return probe;
}

/* Pressed from above and pulled against a wall by tools. */
static lar_model *probed_model(void) {
    lar_model *model = tool_model();
    double farthest = 0;
    for (int32_t n = 0; n < model->mesh.node_count; n++)
        farthest = fmax(farthest, model->mesh.position[n][0]);
    add_plane(model, (double[]){farthest + 1e-6, 0, 0}, (double[]){-1, 0, 0});
    add_probe(model, "all", LAR_PROBE_ENERGY);
    add_probe(model, "ball", LAR_PROBE_TOOL)->tool = TEST_BALL;
    lar_probe *wall = add_probe(model, "wall", LAR_PROBE_CONTACT);
    int32_t count = model->mesh.node_count;
    wall->nodes = (lar_node_list){count, lar_calloc((size_t)count, sizeof(int32_t))};
    for (int32_t n = 0; n < count; n++) wall->nodes.node[n] = n;
    return model;
}

enum { COLUMNS = 1 + 7 + 6 + 3 };

/* The header, and the values of the last line. */
static void last_line(double value[COLUMNS], char header[400]) {
    FILE *file = fopen(FOLDER "/probes.csv", "r");
    char line[1000] = "";
    assert_non_null(file);
    assert_non_null(fgets(header, 400, file));
    while (fgets(line, sizeof line, file)) {
        char *at = line;
        for (int i = 0; i < COLUMNS; i++) value[i] = strtod(at, &at), at += *at == ',';
        assert_int_equal(*at, '\n');
    }
    fclose(file);
}

static void same_energies(const lar_simulation *simulation, const double value[7]) {
    lar_energy e;
    lar_simulation_energy(simulation, &e);
    const double expected[] = {e.kinetic, e.strain,  e.hourglass, e.external,
                               e.damping, e.contact, e.viscous};
    for (int i = 0; i < 7; i++) assert_true(value[i] == expected[i]);
}

/* The sum of contact over all nodes. */
static void same_contact(const lar_simulation *simulation, int32_t nodes, const double value[3]) {
    double(*force)[3] = calloc((size_t)nodes, sizeof *force), sum[3] = {0};
    for (int part = 0; part < 2; part++) {
        lar_cause cause = part ? LAR_CAUSE_PLANES : LAR_CAUSE_BODIES;
        assert_int_equal(lar_simulation_nodal_forces(simulation, cause, 0, force, NULL), LAR_OK);
        for (int32_t n = 0; n < nodes; n++)
            for (int i = 0; i < 3; i++) sum[i] += force[n][i];
    }
    free(force);
    for (int i = 0; i < 3; i++) assert_below(fabs(sum[i] - value[i]), 1e-12);
}

static void columns_are_what_the_calls_say(void **state) {
    (void)state;
    lar_model *model = probed_model();
    lar_options options = lar_options_default();
    options.hands = 1;
    lar_simulation *simulation = start_with(model, options);
    lar_results *results = NULL;
    lar_error error;
    if (lar_results_open(FOLDER, simulation, &results, &error)) fail_msg("%s", error.message);
    double value[COLUMNS], pressed = 0, carried = 0;
    char header[400];
    for (int tick = 0; tick < 8; tick++) {
        lar_tool_pose pose;
        lar_tool_force force;
        act(simulation, tick, tick + 1);
        assert_int_equal(lar_results_add(results, simulation, &error), LAR_OK);
        last_line(value, header);
        same_energies(simulation, value + 1);
        same_contact(simulation, model->mesh.node_count, value + 14);
        lar_simulation_tool_pose(simulation, TEST_BALL, &pose, NULL);
        for (int i = 0; i < 3; i++) assert_true(value[8 + i] == pose.position[i]);
        pressed = fmax(pressed, value[13]);
        carried = fmax(carried, -value[14]);
        /* The next step begins with this force; its mean is a little on. */
        advance(simulation, 1);
        lar_simulation_tool_force(simulation, TEST_BALL, &force, NULL);
        assert_below(fabs(force.force[2] - value[13]), 0.02);
    }
    assert_string_equal(
        header, "time [s],all kinetic [J],all strain [J],all hourglass [J],all external [J],"
                "all damping [J],all contact [J],all viscous [J],ball x [m],ball y [m],"
                "ball z [m],ball force x [N],ball force y [N],ball force z [N],wall x [N],"
                "wall y [N],wall z [N]\n");
    assert_true(pressed > 0.02 && carried > 0.02);
    lar_results_close(results, NULL);
    finish(simulation, model);
}

/* A probe of a tool that is not there. */
static void tools_are_checked(void **state) {
    (void)state;
    lar_model *model = probed_model();
    lar_error error;
    model->output.probe[1].tool = model->tool_count;
    assert_int_equal(lar_model_check(model, &error), LAR_ERROR_MODEL);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_are_what_the_calls_say),
        cmocka_unit_test(tools_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
