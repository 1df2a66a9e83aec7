/* Viewers ask for values of a node, of an element, of the whole body: those of one step, as
 * pictures and results have them. docs/viewer-protocol.md, "inspect". */
#include "session/session_test.h"

#include "session/server_test.h"

#include "simulation/simulation.h"
#include "mechanics/stress.h"

static served s;
static client c;
static lar_simulation *plain; /* at the same step */

static void pause_somewhere(void) {
    s = serve(NULL);
    c = open_client(s.port);
    for (int i = 0; i < 100 && number_of(await_text(&c, "status"), "step") < 300; i++) {
    }
    say(&c, "{\"do\":\"pause\"}");
    await_status(&c, "\"state\":\"paused\"");
    await_text(&c, "status");
    plain = served_simulation(s.b.model, NULL);
    advance(plain, (uint64_t)number_of((char *)c.data, "step"));
}

static void leave(void) {
    lar_simulation_destroy(plain);
    close_client(&c);
    end_serving(&s);
}

static void near(double value, double wanted, double share) {
    if (!(fabs(value - wanted) <= share * fabs(wanted)))
        fail_msg("%.12g instead of %.12g", value, wanted);
}

static const char *ask(const char *text) {
    say(&c, text);
    return await_text(&c, "values");
}

static void a_node_is_as_in_pictures(void **unused) {
    (void)unused;
    lar_surface_info surface;
    pause_somewhere();
    lar_model_surface(s.b.model, &surface);
    int32_t node = surface.nodes - 3;
    char text[64];
    snprintf(text, sizeof text, "{\"do\":\"inspect\",\"node\":%d}", (int)node);
    char *told = strdup(ask(text));
    assert_int_equal((int)number_of(told, "index"), surface.node[node]);
    assert_int_equal((int)number_of(told, "number"),
                     (int)s.b.model->mesh.node_id[surface.node[node]]);
    assert_true((uint64_t)number_of(told, "step") == lar_simulation_steps(plain));
    assert_null(strstr(told, "element"));
    assert_null(strstr(told, "kinetic"));
    static const char *const field[] = {"von_mises", "pressure", "energy"};
    for (int i = 0; i < 3; i++) {
        ask_frame(&c, field[i]);
        const float *value = positions_of(&c) + 3 * surface.nodes;
        near(number_of(told, field[i]), (double)value[node], 1e-6);
    }
    const double *rest = s.b.model->mesh.position[surface.node[node]];
    const char *u = strstr(told, "\"displacement\":[") + 16;
    for (int i = 0; i < 3; i++, u = strchr(u, ',') + 1)
        assert_below(fabs(rest[i] + strtod(u, NULL) - (double)positions_of(&c)[3 * node + i]),
                     1e-7);
    free(told);
    leave();
}

static void an_element_and_the_energies_are_those_of_results(void **unused) {
    (void)unused;
    lar_surface_info surface;
    lar_energy energy;
    double cauchy[6];
    pause_somewhere();
    lar_model_surface(s.b.model, &surface);
    const char *told = ask("{\"do\":\"inspect\",\"face\":2,\"energy\":true}");
    lar_gid e = surface.element[2];
    double density = lar_measure_stress(&plain->domain, lar_simulation_state(plain), e, cauchy);
    assert_int_equal((int)number_of(told, "index"), e);
    assert_int_equal((int)number_of(told, "number"), (int)lar_model_element_id(s.b.model, e));
    assert_int_equal((int)number_of(told, "material"), 0);
    near(number_of(told, "von_mises"), lar_von_mises(cauchy), 1e-12);
    near(number_of(told, "pressure"), lar_mean_pressure(cauchy), 1e-12);
    near(number_of(told, "energy"), density, 1e-12);
    assert_null(strstr(told, "\"node\""));
    lar_simulation_energy(plain, &energy);
    near(number_of(told, "strain"), energy.strain, 1e-9);
    near(number_of(told, "hourglass"), energy.hourglass, 1e-9);
    /* Half a step apart. */
    assert_below(fabs(number_of(told, "kinetic") - energy.kinetic), 0.05 * energy.kinetic + 1e-12);
    leave();
}

static void what_is_not_there_is_refused_and_many_may_ask(void **unused) {
    (void)unused;
    pause_somewhere();
    say(&c, "{\"do\":\"inspect\",\"node\":1000000}");
    assert_non_null(strstr(await_text(&c, "note"), "counted from 0"));
    say(&c, "{\"do\":\"inspect\",\"face\":1000000}");
    assert_non_null(strstr(await_text(&c, "note"), "counted from 0"));
    client other = open_client_at(s.port, "/socket?watch=1");
    for (int i = 0; i < 20; i++) {
        say(&other, "{\"do\":\"inspect\",\"node\":0}");
        say(&c, "{\"do\":\"inspect\",\"node\":1}");
        await_text(&other, "values");
        await_text(&c, "values");
    }
    close_client(&other);
    leave();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_node_is_as_in_pictures),
        cmocka_unit_test(an_element_and_the_energies_are_those_of_results),
        cmocka_unit_test(what_is_not_there_is_refused_and_many_may_ask)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
