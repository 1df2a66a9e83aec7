/* The springs of contact are as hard as the masses of nodes and faces allow, which changes along a
 * face. Between what is rigid the slope of what they store is a force: what slides while it is
 * pushed gains nothing. */
#include "engine/engine_test.h"

#include "engine/body_contact_test.h"
#include "engine/tools_test.h"

static const brick block = {{3, 3, 3}, 0.01, 0, LAR_LAW_neo_hookean, 2e4, 2e5, 1000};
static const brick tip = {{1, 1, 1}, 0.001, 0, LAR_LAW_neo_hookean, 2e4, 2e5, 1000};
enum { BLOCK_NODES = 4 * 4 * 4, TIP_NODES = 8 };

/* A rigid block that falls on a tip that stands still, beside one of its edges, and slides. */
static lar_model *block_above(double x, const double velocity[3]) {
    lar_model *model = empty_model(&block);
    add_brick(model, &block, (double[]){0, 0, 0.002});
    add_brick(model, &tip, (double[]){x, 0.0145, -0.002});
    bind_nodes(model, 0, BLOCK_NODES);
    lar_node_list held = {TIP_NODES, lar_calloc(TIP_NODES, 4)};
    for (int32_t n = 0; n < TIP_NODES; n++) held.node[n] = BLOCK_NODES + n;
    fix_nodes(model, held, LAR_AXIS_ALL);
    touch_self(model);
    throw_nodes(model, 0, BLOCK_NODES, velocity);
    return model;
}

/* Without the slope it had 0.02 to 0.1 % more afterwards, and runs were stopped for that. */
static void what_slides_while_it_is_pushed_gains_nothing(void **unused) {
    (void)unused;
    static const double slides[][2] = {{0.001, -0.3}, {0.001, -0.6}, {0.006, 0.3}, {0.012, 0.6}};
    for (int i = 0; i < 4; i++) {
        lar_model *model = block_above(slides[i][0], (double[]){slides[i][1], 0, -0.3});
        lar_simulation *simulation = start(model);
        lar_energy e;
        lar_simulation_energy(simulation, &e);
        const double began = e.kinetic;
        double most = 0;
        while (lar_simulation_time(simulation) < 0.03) {
            advance(simulation, 10);
            lar_simulation_energy(simulation, &e);
            most = fmax(most, e.kinetic / began);
        }
        print_message("%g m/s: at most %.7f, at the end %.5f of the energy\n", slides[i][1], most,
                      e.kinetic / began);
        assert_below(most, 1 + 1e-6);
        assert_true(e.kinetic > 0.97 * began && e.kinetic < 0.9999 * began);
        finish(simulation, model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_slides_while_it_is_pushed_gains_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
