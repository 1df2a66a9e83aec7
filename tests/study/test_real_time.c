/* The speed of a model: figures that belong together, and why there is none. */
#include "testing.h"

#include "study/real_time.h"

#define BEAM LAR_TEST_EXAMPLES "/beam.yaml"

static lar_error error;

static lar_model *open_model(const char *path) {
    lar_model *model = NULL;
    if (lar_model_open(path, &model, &error)) fail_msg("%s", error.message);
    return model;
}

static void a_model_has_a_speed(void **state) {
    (void)state;
    lar_model *model = open_model(BEAM);
    lar_model_info info;
    lar_real_time found = {0};
    assert_int_equal(lar_model_inspect(model, &info, &error), LAR_OK);
    assert_int_equal(lar_real_time_measure(model, 0.01, &found, &error), LAR_OK);
    assert_true(found.steps >= 10);
    assert_true(found.step > 0 && found.step < 1);
    assert_true(found.time_step == info.time_step);
    assert_below(fabs(found.factor * found.step / found.time_step - 1), 1e-12);
    lar_model_destroy(model);
}

/* The beam with a pull that tears it apart at once. */
static void what_breaks_has_none(void **state) {
    (void)state;
    static const char path[] = LAR_TEST_BUILD "/real_time_torn.yaml";
    FILE *from = fopen(BEAM, "r"), *to = fopen(path, "w");
    char line[512];
    assert_non_null(from);
    assert_non_null(to);
    while (fgets(line, sizeof line, from))
        if (strncmp(line, "mesh:", 5) == 0)
            fprintf(to, "mesh: %s/%s", LAR_TEST_EXAMPLES, line + 5 + strspn(line + 5, " "));
        else if (strncmp(line, "gravity:", 8) == 0)
            fputs("gravity: [0, 0, -1.0e9]\n", to);
        else
            fputs(line, to);
    fclose(from);
    fclose(to);
    lar_model *model = open_model(path);
    lar_real_time found = {.steps = 77};
    assert_int_equal(lar_real_time_measure(model, 1, &found, &error), LAR_ERROR_UNSTABLE);
    assert_true(strlen(error.message) > 20);
    assert_int_equal(found.steps, 77);
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_model_has_a_speed),
                                       cmocka_unit_test(what_breaks_has_none)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
