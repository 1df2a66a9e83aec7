/* Abaqus and CalculiX decks made of pieces: two cubes in a row, and what may stand around them. */
#ifndef LAR_TESTS_INP_DECK_H
#define LAR_TESTS_INP_DECK_H

#include "model/model.h"
#include "testing.h"

/* Two cubes in a row along x, lines 1 to 28. */
#define MESH                                                                                       \
    "*NODE, NSET=ALL\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n"    \
    "7, 1, 1, 1\n8, 0, 1, 1\n9, 2, 0, 0\n10, 2, 1, 0\n11, 2, 0, 1\n12, 2, 1, 1\n99, 9, 9, 9\n"     \
    "*ELEMENT, TYPE=C3D8R, ELSET=LEFT\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"                                \
    "*ELEMENT, TYPE=C3D8R, ELSET=RIGHT\n2, 2, 9, 10, 3, 6, 11, 12, 7\n"                            \
    "*ELSET, ELSET=BOTH\nLEFT, RIGHT\n"                                                            \
    "*NSET, NSET=Wall\n1, 4, 5, 8\n*NSET, NSET=Tip\n9, 10, 11, 12\n"                               \
    "*SURFACE, NAME=End\n2, S4\n*SURFACE, NAME=Inside, TYPE=NODE\nWALL\n"
#define SOFT                                                                                       \
    "*MATERIAL, NAME=Soft\n*HYPERELASTIC, NEO HOOKE\n500, 1e-4\n*DENSITY\n1000,\n"                 \
    "*SOLID SECTION, ELSET=BOTH, MATERIAL=soft\n"
enum { AFTER_MESH = 29, AFTER_SOFT = 35 };
#define STATIC  "*STEP, NLGEOM\n*STATIC\n0.1, 2\n"
#define DYNAMIC "*STEP, NLGEOM\n*DYNAMIC\n0.1, 2\n"
#define END     "*END STEP\n"

TEST_UNUSED static lar_status parse(const char *text, lar_model **model, lar_error *error) {
    /* A copy of the exact size, so that the address sanitizer sees reads beyond it. */
    size_t size = strlen(text);
    lar_bytes bytes = {malloc(size + 1), size};
    assert_non_null(bytes.data);
    memcpy(bytes.data, text, size + 1);
    lar_status status = lar_inp_deck_parse("deck.inp", &bytes, model, error);
    free(bytes.data);
    return status;
}

TEST_UNUSED static lar_model *read_deck(const char *text) {
    lar_model *model = NULL;
    lar_error error;
    if (parse(text, &model, &error)) fail_msg("%s", error.message);
    return model;
}

/* The deck must fail with a message that begins with deck.inp:LINE: and has `words`. */
TEST_UNUSED static void refused(const char *text, lar_status status, int line, const char *words) {
    lar_model *model = NULL;
    lar_error error;
    char start[32];
    snprintf(start, sizeof start, "deck.inp:%d: ", line);
    lar_status got = parse(text, &model, &error);
    if (!got) lar_model_destroy(model);
    if (got != status || strncmp(error.message, start, strlen(start)) != 0 ||
        !strstr(error.message, words))
        fail_msg("status %d, \"%s\" instead of %d, \"%s...%s\"", (int)got, got ? error.message : "",
                 (int)status, start, words);
}

TEST_UNUSED static int notices_with(const lar_model *model, const char *words) {
    int count = 0;
    for (int i = 0; i < model->notice_count; i++) count += strstr(model->notice[i], words) != NULL;
    return count;
}

TEST_UNUSED static void near(double value, double wanted) {
    if (fabs(value - wanted) > 1e-12 * fabs(wanted)) fail_msg("%.17g, not %.17g", value, wanted);
}

TEST_UNUSED static double at(const lar_model *model, int curve, double time) {
    return lar_curve_value(&model->curve[curve], time);
}

#endif
