/* What is forced through other bodies although contact pushes it out is counted, and on every grid
 * as often; what is not forced is not counted. */
#include "engine/body_contact_test.h"

/* A block that is held as a whole, `thick` elements, and one above it that goes down as a whole by
 * `way` [m] within 20 ms. */
static lar_model *forced(int thick, double way) {
    const brick below = {{6, 6, thick}, 0.004, 0, LAR_LAW_neo_hookean, 3e3, 3e4, 1060};
    const brick above = {{3, 3, 3}, 0.0041, 0, LAR_LAW_neo_hookean, 3e3, 3e4, 1060};
    lar_model *model = empty_model(&below);
    add_brick(model, &below, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count, nodes = model->mesh.node_count;
    add_brick(model, &above, (double[]){0.0052, 0.0049, 0.004 * thick + 0.001});
    touch_between(model, split);
    lar_node_list part[2] = {{nodes, lar_calloc((size_t)nodes, sizeof(int32_t))},
                             {model->mesh.node_count - nodes, NULL}};
    part[1].node = lar_calloc((size_t)part[1].count, sizeof(int32_t));
    for (int32_t n = 0; n < nodes; n++) part[0].node[n] = n;
    for (int32_t n = 0; n < part[1].count; n++) part[1].node[n] = nodes + n;
    fix_nodes(model, part[0], LAR_AXIS_X | LAR_AXIS_Y | LAR_AXIS_Z);
    move_nodes(model, part[1], LAR_AXIS_Z, -way, add_ramp(model, 0.02));
    return model;
}

static lar_contact_info contact_of(lar_model *model, const char *grid) {
    lar_options options = lar_options_default();
    options.grid = grid;
    lar_simulation *s = start_with(model, options);
    lar_contact_info info;
    while (lar_simulation_time(s) < 0.022) advance(s, 1);
    lar_simulation_contact(s, &info);
    lar_simulation_destroy(s);
    return info;
}

static void what_goes_through_is_counted(void **state) {
    (void)state;
    static const struct {
        int thick;
        double way;
        bool through;
    } cases[] = {{4, 0.002, false}, {4, 0.01, true}, {1, 0.002, false}, {1, 0.006, true}};
    for (int i = 0; i < 4; i++) {
        lar_model *model = forced(cases[i].thick, cases[i].way);
        lar_contact_info one = contact_of(model, "1x1x1"), two = contact_of(model, "2x1x1");
        print_message("%d thick, by %.0f mm: %d touch, through %d times, %.3g mm in a step\n",
                      cases[i].thick, 1e3 * cases[i].way, (int)one.touching, (int)one.through,
                      1e3 * one.way);
        assert_true((one.through > 0) == cases[i].through);
        assert_true(one.through == two.through && one.way == two.way);
        lar_model_destroy(model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_goes_through_is_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
