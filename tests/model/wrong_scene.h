/* Scenes that are refused: the place and the words of their messages. */
#ifndef LAR_TESTS_WRONG_SCENE_H
#define LAR_TESTS_WRONG_SCENE_H

#include "brick.h"
#include "model/scene/scene.h"
#include "testing.h"

#define BASE                                                                                       \
    "lariat: 1\nmesh: brick.vtu\n"                                                                 \
    "materials: [{cells: all, law: neo-hookean, density: 1050, shear_modulus: 4.0e3, "             \
    "bulk_modulus: 4.0e5}]\n"

typedef struct wrong_scene {
    const char *text;
    const char *place; /* "LINE:COLUMN" */
    const char *words; /* part of the message */
} wrong_scene;

TEST_UNUSED static lar_status parse(const char *text, size_t size, lar_error *error) {
    lar_bytes bytes = {(unsigned char *)lar_strndup(text, size), size};
    lar_model *model = NULL;
    lar_status status = lar_scene_parse_with("s.yaml", &bytes, brick_read, &model, error);
    assert_true((status == LAR_OK) == (model != NULL));
    lar_model_destroy(model);
    lar_bytes_free(&bytes);
    return status;
}

TEST_UNUSED static void refuses(const wrong_scene *wrong, size_t count, const char *before) {
    for (size_t i = 0; i < count; i++) {
        char text[4000], start[40];
        lar_error error = {0};
        snprintf(text, sizeof text, "%s%s", before, wrong[i].text);
        snprintf(start, sizeof start, "s.yaml:%s: ", wrong[i].place);
        lar_status status = parse(text, strlen(text), &error);
        if (status == LAR_OK) fail_msg("accepted: %s", wrong[i].text);
        assert_int_equal(status, error.status);
        if (strncmp(error.message, start, strlen(start)) != 0 ||
            !strstr(error.message, wrong[i].words))
            fail_msg("%s\ngives \"%s\"\nwanted \"%s...%s\"", wrong[i].text, error.message, start,
                     wrong[i].words);
    }
}
#define REFUSES(table, before) refuses(table, sizeof table / sizeof table[0], before)

#endif
