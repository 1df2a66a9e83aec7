/* What is said to help a body that does not come to rest. */
#include <string.h>

#include "cli/report/rest_remedy.h"
#include "testing.h"

static void what_trembles_wants_a_smaller_step(void **unused) {
    (void)unused;
    char text[REST_REMEDY_SIZE];
    lar_rest rest = {.looked = 1, .left = 3e-3, .strain = 0.05, .mean_before = 6.5e-9};
    /* Swings, and creeps: whatever else there is, the kinetic energy is not that far below zero. */
    assert_non_null(strstr(rest_remedy(&rest, 6.4e-9, 386, 1.73e-4, false, text), "creeps"));
    assert_non_null(strstr(rest_remedy(&rest, -1e-9, 386, 1.73e-4, false, text), "creeps"));
    assert_non_null(
        strstr(rest_remedy(&rest, 6.4e-9, 386, 1.8e-104, true, text), "--time-step 9e-105, or"));
    const char *said = rest_remedy(&rest, -6.5e-9, 386, 1.73e-4, false, text);
    assert_non_null(strstr(said, "from step to step"));
    assert_non_null(strstr(said, "--time-step 0.00014"));
    assert_true(strlen(rest_remedy(&rest, -6.5e-9, 0, 1.2345678e-104, false, text)) <
                REST_REMEDY_SIZE - 1);
    rest.mean_before = 1e-3;
    assert_non_null(strstr(rest_remedy(&rest, 1e-3, 1, 1e-4, false, text), "swings"));
    assert_non_null(strstr(rest_remedy(&rest, 1e-3, 0, 1e-4, false, text), "without damping"));
    rest.looked = 2;
    assert_non_null(strstr(rest_remedy(&rest, -1e-3, 1, 1e-4, false, text), "viscous"));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_trembles_wants_a_smaller_step)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
