/* The public calls refuse what makes no sense: a status and a sentence, never a crash, and nothing
 * is set. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "lariat.h"

#define BEAM LAR_TEST_EXAMPLES "/beam.yaml"

static lar_error error;

#define REFUSED(call)                                                                              \
    do {                                                                                           \
        error = (lar_error){LAR_OK, ""};                                                           \
        assert_int_equal(call, LAR_ERROR_ARGUMENT);                                                \
        assert_int_equal(error.status, LAR_ERROR_ARGUMENT);                                        \
        assert_true(strlen(error.message) > 20);                                                   \
    } while (0)

static void model_calls(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_model_info info;
    lar_material_info material;
    lar_set_info set;
    lar_model_contact_info contact;
    lar_tool_info tool;
    REFUSED(lar_model_open(NULL, &model, &error));
    REFUSED(lar_model_open(BEAM, NULL, &error));
    assert_null(model);
    assert_int_equal(lar_model_open(BEAM, &model, &error), LAR_OK);
    REFUSED(lar_model_inspect(NULL, &info, &error));
    REFUSED(lar_model_inspect(model, NULL, &error));
    REFUSED(lar_model_material(NULL, 0, &material, &error));
    REFUSED(lar_model_material(model, 0, NULL, &error));
    REFUSED(lar_model_material(model, -1, &material, &error));
    REFUSED(lar_model_material(model, 1, &material, &error));
    REFUSED(lar_model_set(NULL, 0, &set, &error));
    REFUSED(lar_model_set(model, 0, NULL, &error));
    REFUSED(lar_model_set(model, -1, &set, &error));
    REFUSED(lar_model_set(model, 99, &set, &error));
    assert_int_equal(lar_model_contact_count(model), 0);
    REFUSED(lar_model_contact(NULL, 0, &contact, &error));
    REFUSED(lar_model_contact(model, 0, NULL, &error));
    REFUSED(lar_model_contact(model, 0, &contact, &error));
    assert_int_equal(lar_model_tool_count(model), 0);
    REFUSED(lar_model_tool(NULL, 0, &tool, &error));
    REFUSED(lar_model_tool(model, 0, NULL, &error));
    REFUSED(lar_model_tool(model, 0, &tool, &error));
    REFUSED(lar_demo_write(NULL, &error));
    lar_model_destroy(model);
    lar_model_destroy(NULL);
}

static void simulation_calls(void **unused) {
    (void)unused;
    lar_model *model = NULL;
    lar_simulation *simulation = NULL;
    lar_results *results = NULL;
    assert_int_equal(lar_model_open(BEAM, &model, &error), LAR_OK);
    REFUSED(lar_simulation_create(NULL, NULL, &simulation, &error));
    REFUSED(lar_simulation_create(model, NULL, NULL, &error));
    static const double steps[] = {-1, NAN, INFINITY, -INFINITY};
    lar_options options = lar_options_default();
    for (int i = 0; i < 4; i++) {
        options.time_step = steps[i];
        REFUSED(lar_simulation_create(model, &options, &simulation, &error));
    }
    options = lar_options_default();
    options.element = (lar_element_kind)42;
    REFUSED(lar_simulation_create(model, &options, &simulation, &error));
    options = lar_options_default();
    options.isa = (lar_isa)77;
    REFUSED(lar_simulation_create(model, &options, &simulation, &error));
    assert_null(simulation);
    REFUSED(lar_simulation_advance(NULL, 1, &error));
    REFUSED(lar_results_open(NULL, simulation, &results, &error));
    REFUSED(lar_results_add(NULL, NULL, &error));
    assert_int_equal(lar_results_close(NULL, &error), LAR_OK);
    lar_simulation_destroy(NULL);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(model_calls),
                                       cmocka_unit_test(simulation_calls)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
