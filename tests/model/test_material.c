/* Materials: moduli there and back for every law, and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "model/material.h"

static void expect_close(double a, double b) {
    assert_true(fabs(a - b) <= 1e-12 * fabs(b));
}

static void test_moduli_come_back(void **state) {
    (void)state;
    for (int law = 0; law < LAR_LAW_COUNT; law++) {
        lar_material material = {.law = (lar_law)law, .density = 1050.0};
        lar_material_from_shear_bulk(&material, 4.0e3, 2.0e6);
        expect_close(lar_material_shear(&material), 4.0e3);
        expect_close(lar_material_bulk(&material), 2.0e6);
        assert_int_equal(lar_material_check(&material, "here", NULL), LAR_OK);

        lar_material_from_young(&material, 12.0e3, 0.45);
        expect_close(lar_material_shear(&material), 12.0e3 / 2.9);
        expect_close(lar_material_bulk(&material), 12.0e3 / 0.3);
    }
}

static void test_own_parameters(void **state) {
    (void)state;
    lar_material coupled = {.law = LAR_LAW_coupled_neo_hookean, .parameter = {3000.0, 5000.0}};
    expect_close(lar_material_shear(&coupled), 3000.0);
    expect_close(lar_material_bulk(&coupled), 7000.0);
    lar_material mooney = {.law = LAR_LAW_mooney_rivlin, .parameter = {1000.0, 500.0, 9000.0}};
    expect_close(lar_material_shear(&mooney), 3000.0);
    expect_close(lar_material_bulk(&mooney), 9000.0);
    lar_material_from_shear_bulk(&mooney, 3000.0, 9000.0);
    expect_close(mooney.parameter[0], 1500.0);
    assert_true(mooney.parameter[1] == 0.0);
}

static void test_names(void **state) {
    (void)state;
    assert_string_equal(lar_law_name[LAR_LAW_neo_hookean], "neo-hookean");
    assert_string_equal(lar_law_name[LAR_LAW_coupled_neo_hookean], "coupled-neo-hookean");
    assert_string_equal(lar_law_name[LAR_LAW_mooney_rivlin], "mooney-rivlin");
    assert_string_equal(lar_law_name[LAR_LAW_yeoh], "yeoh");
    assert_int_equal(LAR_LAW_arruda_boyce, 4); /* files have the numbers */
    assert_int_equal(LAR_LAW_veronda_westmann, 5);
    assert_int_equal(LAR_LAW_holmes_mow, 6);
    assert_int_equal(LAR_LAW_ogden, 7);
}

static void refused(lar_material material, const char *part) {
    lar_error error = {0};
    assert_int_equal(lar_material_check(&material, "a.yaml:3:5", &error), LAR_ERROR_MODEL);
    assert_int_equal(strncmp(error.message, "a.yaml:3:5: ", 12), 0);
    if (!strstr(error.message, part)) fail_msg("%s", error.message);
}

static void test_refusals(void **state) {
    (void)state;
    const lar_material good = {.density = 1050.0, .parameter = {4.0e3, 4.0e5}};
    const double bad_density[] = {0.0, -1.0, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        lar_material material = good;
        material.density = bad_density[i];
        refused(material, "density");
    }
    lar_material material = good;
    material.parameter[0] = -4.0e3;
    refused(material, "shear modulus");
    material = good;
    material.parameter[1] = 0.0;
    refused(material, "bulk modulus");
    material = good;
    material.parameter[2] = NAN;
    refused(material, "not a finite number");
    material = good;
    lar_material_from_young(&material, 1.0e4, 0.5);
    refused(material, "not a finite number");
    lar_material_from_young(&material, 1.0e4, 0.6);
    refused(material, "bulk modulus");
    material = good;
    material.law = LAR_LAW_yeoh;
    material.parameter[2] = 1e30;
    material.parameter[3] = 4e5;
    refused(material, "c3 of the law yeoh is 1e+30 Pa, more than 1e+09 times");
    material = good;
    material.law = LAR_LAW_COUNT;
    refused(material, "law");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_moduli_come_back),
        cmocka_unit_test(test_own_parameters),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
