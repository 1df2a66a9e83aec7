/* Scenes around the brick of brick.h, from text. */
#ifndef LAR_TESTS_SCENE_TEST_H
#define LAR_TESTS_SCENE_TEST_H

#include "brick.h"
#include "model/scene/scene.h"
#include "testing.h"

#define HEAD "lariat: 1\nmesh: brick.vtu\n"
#define MATERIAL                                                                                   \
    "materials: [{cells: all, law: neo-hookean, density: 1050, shear_modulus: 4.0e3, "             \
    "bulk_modulus: 4.0e5}]\n"

TEST_UNUSED static lar_model *scene(const char *text) {
    lar_bytes bytes = {(unsigned char *)lar_strdup(text), strlen(text)};
    lar_model *model = NULL;
    lar_error error = {0};
    lar_status status = lar_scene_parse_with("s.yaml", &bytes, brick_read, &model, &error);
    lar_bytes_free(&bytes);
    if (status) fail_msg("%s", error.message);
    return model;
}

TEST_UNUSED static void same(double a, double b) {
    if (!(fabs(a - b) <= 1e-12 * (1.0 + fabs(b)))) fail_msg("%.17g instead of %.17g", a, b);
}

/* A selection as text: the indices, separated by blanks. */
TEST_UNUSED static void indices(const int32_t *index, int32_t count, char *text, size_t size) {
    size_t used = 0;
    text[0] = '\0';
    for (int32_t i = 0; i < count && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%d", i ? " " : "", (int)index[i]);
}

TEST_UNUSED static void selects(const char *kind, const char *selector, const char *expected) {
    char text[600], found[400];
    snprintf(text, sizeof text,
             HEAD
             "sets:\n  - {name: edge, nodes: {list: [1, 2, 3]}}\n  - {name: it, %s: %s}\n" MATERIAL,
             kind, selector);
    lar_model *model = scene(text);
    const lar_set *set = &model->mesh.set[model->mesh.set_count - 1];
    assert_string_equal(set->name, "it");
    indices(set->index, set->count, found, sizeof found);
    if (strcmp(found, expected) != 0)
        fail_msg("%s: %s gives \"%s\" instead of \"%s\"", kind, selector, found, expected);
    lar_model_destroy(model);
}

#endif
