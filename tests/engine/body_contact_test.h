/* Bodies that meet: several bricks in one mesh, and who touches whom. */
#ifndef LAR_TESTS_BODY_CONTACT_TEST_H
#define LAR_TESTS_BODY_CONTACT_TEST_H

#include "engine/engine_test.h"

/* Adds a brick to a model's mesh, its lowest corner at `at`. Returns its first node. */
TEST_UNUSED static int32_t add_brick(lar_model *model, const brick *b, const double at[3]) {
    lar_mesh part = {0}, *mesh = &model->mesh, joined = {.source = lar_strdup("bricks")};
    brick_mesh(b, &part);
    int32_t nodes = mesh->node_count, elements = mesh->element_count;
    joined.node_count = nodes + part.node_count;
    joined.element_count = elements + part.element_count;
    joined.position = lar_calloc((size_t)joined.node_count, sizeof *joined.position);
    joined.node_id = lar_calloc((size_t)joined.node_count, sizeof *joined.node_id);
    joined.element = lar_calloc((size_t)joined.element_count, sizeof *joined.element);
    joined.element_id = lar_calloc((size_t)joined.element_count, sizeof *joined.element_id);
    joined.element_tag = lar_calloc((size_t)joined.element_count, sizeof *joined.element_tag);
    for (int32_t n = 0; n < joined.node_count; n++) {
        joined.node_id[n] = n + 1;
        for (int i = 0; i < 3; i++)
            joined.position[n][i] =
                n < nodes ? mesh->position[n][i] : part.position[n - nodes][i] + at[i];
    }
    for (int32_t e = 0; e < joined.element_count; e++) {
        joined.element_id[e] = e + 1;
        for (int a = 0; a < 8; a++)
            joined.element[e][a] =
                e < elements ? mesh->element[e][a] : part.element[e - elements][a] + nodes;
    }
    lar_mesh_clear(mesh);
    lar_mesh_clear(&part);
    *mesh = joined;
    free(model->element_material);
    model->element_material = lar_calloc((size_t)joined.element_count, sizeof(int32_t));
    return nodes;
}

TEST_UNUSED static lar_model *empty_model(const brick *b) {
    lar_model *model = lar_model_create();
    assert_non_null(model);
    lar_material *material = LAR_MODEL_APPEND(model, material);
    material->law = b->law;
    material->density = b->density;
    lar_material_from_shear_bulk(material, b->shear, b->bulk);
    return model;
}

/* The boundary faces of elements first .. end - 1. */
TEST_UNUSED static int32_t *outer_faces(const lar_model *model, int32_t first, int32_t end,
                                        int32_t *count) {
    int32_t *faces, all, kept = 0;
    assert_int_equal(lar_mesh_boundary(&model->mesh, &faces, &all, NULL), LAR_OK);
    for (int32_t i = 0; i < all; i++)
        if (faces[i] / 6 >= first && faces[i] / 6 < end) faces[kept++] = faces[i];
    *count = kept;
    return faces;
}

/* Instead of all others. */
TEST_UNUSED static void touch_self(lar_model *model) {
    for (int i = 0; i < model->contact_count; i++) {
        free(model->contact[i].face);
        free(model->contact[i].against);
    }
    model->contact_count = 0;
    lar_contact *contact = LAR_MODEL_APPEND(model, contact);
    contact->kind = LAR_CONTACT_SELF;
    contact->face = outer_faces(model, 0, model->mesh.element_count, &contact->face_count);
}

/* The bodies of elements before `split` and from there on. */
TEST_UNUSED static void touch_between(lar_model *model, int32_t split) {
    lar_contact *contact = LAR_MODEL_APPEND(model, contact);
    contact->kind = LAR_CONTACT_BETWEEN;
    contact->face = outer_faces(model, 0, split, &contact->face_count);
    contact->against =
        outer_faces(model, split, model->mesh.element_count, &contact->against_count);
}

TEST_UNUSED static void throw_nodes(lar_model *model, int32_t first, int32_t end,
                                    const double velocity[3]) {
    lar_initial_velocity *initial = LAR_MODEL_APPEND(model, initial);
    initial->nodes = (lar_node_list){end - first, lar_calloc((size_t)(end - first), 4)};
    for (int32_t n = first; n < end; n++) initial->nodes.node[n - first] = n;
    memcpy(initial->velocity, velocity, sizeof initial->velocity);
}

/* A small brick above a larger one, which stands on its fixed lowest nodes when `held`. */
TEST_UNUSED static lar_model *two_bricks(const brick *lower, const brick *upper, double gap,
                                         bool held) {
    lar_model *model = empty_model(lower);
    add_brick(model, lower, (double[]){0, 0, 0});
    int32_t split = model->mesh.element_count;
    double top = lower->edge * lower->cells[2] + gap;
    add_brick(model, upper, (double[]){0.013, 0.0071, top});
    if (held) fix_nodes(model, brick_side(lower, 2, 0), LAR_AXIS_ALL);
    touch_between(model, split);
    return model;
}

#endif
