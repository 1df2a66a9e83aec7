/* What must hold of every layout, on many meshes: bricks of all small sizes, holes, rings, twisted
 * rings, rows that cross themselves, several bodies, laws and ways of numbering an element's nodes.
 *
 * The meshes are made from a grid or from cross-sections; check_model then looks at the layout from
 * the outside only: blocks, corners and numbers. */
#include "layout_test.h"
#include "model/demo/demo.h"

static void check_layout(const lar_model *model, const lar_layout *layout) {
    const lar_mesh *mesh = &model->mesh;
    bool *seen = lar_calloc((size_t)mesh->element_count, sizeof *seen);
    check_nodes(mesh, layout, NULL);
    assert_int_equal(layout->thread_count, 1);
    for (lar_gid e = 0; e < mesh->element_count; e++)
        assert_true(is_turn(mesh->element[e], layout->corner[e]));
    for (int32_t b = 0; b < layout->block_count; b++)
        check_block(model, layout, &layout->block[b], seen);
    for (lar_gid e = 0; e < mesh->element_count; e++) assert_true(seen[e]);
    check_order(layout);
    free(seen);
}

static void assert_same_layout(const lar_mesh *mesh, const lar_layout *a, const lar_layout *b) {
    assert_int_equal(a->block_count, b->block_count);
    assert_int_equal(a->node_count, b->node_count);
    assert_memory_equal(a->block, b->block, (size_t)a->block_count * sizeof *a->block);
    assert_memory_equal(a->corner, b->corner, (size_t)mesh->element_count * sizeof *a->corner);
    assert_memory_equal(a->global, b->global, (size_t)a->node_padded * sizeof *a->global);
    assert_memory_equal(a->local, b->local, (size_t)mesh->node_count * sizeof *a->local);
}

/* The loose style has the same turned elements, all in loose general blocks. */
static void check_loose(const lar_model *model, const lar_layout *layout) {
    lar_layout loose;
    assert_int_equal(lar_layout_create_styled(model, LAR_LAYOUT_LOOSE, &loose, NULL), LAR_OK);
    check_layout(model, &loose);
    assert_memory_equal(layout->corner, loose.corner,
                        (size_t)model->mesh.element_count * sizeof *loose.corner);
    for (int32_t b = 0; b < loose.block_count; b++)
        assert_true(loose.block[b].rows == LAR_ROWS_NONE &&
                    loose.block[b].shape == LAR_SHAPE_GENERAL);
    lar_layout_destroy(&loose);
}

/* Creates and checks the layout of a model; for every fourth also that it comes out the same twice,
 * and the loose style. Returns what is in it. Destroys the model. */
static share check_model(lar_model *model) {
    static int models;
    lar_layout layout, again;
    lar_error error = {0};
    if (lar_model_check(model, &error)) fail_msg("%s", error.message);
    assert_int_equal(lar_layout_create(model, &layout, NULL), LAR_OK);
    check_layout(model, &layout);
    if (models++ % 4 == 0) {
        check_loose(model, &layout);
        assert_int_equal(lar_layout_create(model, &again, NULL), LAR_OK);
        assert_same_layout(&model->mesh, &layout, &again);
        lar_layout_destroy(&again);
    }
    share in = what_is_in(&layout, model->mesh.element_count);
    lar_layout_destroy(&layout);
    lar_layout_destroy(&layout); /* idempotent */
    lar_model_destroy(model);
    return in;
}

/* ---- tests ----------------------------------------------------------------------------------- */

static void bricks_of_all_sizes(void **unused) {
    (void)unused;
    for (int n = 0; n < 9 * 9 * 9; n += test_every(7)) {
        int c[3] = {1 + n % 9, 1 + n / 9 % 9, 1 + n / 81};
        share in = check_model(boxes(c[0], c[1], c[2], 0));
        assert_int_equal(in.boxes, in.elements);
        if (c[0] % 8 == 0 || c[1] % 8 == 0 || c[2] % 8 == 0) assert_int_equal(in.loose, 0);
        if (n % 5 == 0) assert_int_equal(check_model(boxes(c[0], c[1], c[2], 0.1)).boxes, 0);
    }
}

static void a_row_begins_even(void **unused) {
    (void)unused;
    for (int n = 4; n < 30; n++) {
        lar_model *model = boxes(n, 1, 1, 0);
        lar_layout layout;
        assert_int_equal(lar_layout_create(model, &layout, NULL), LAR_OK);
        for (int line = 0; line < 4; line++)
            assert_true(layout.local[layout.corner[0][lar_line_left[line]]] % 2 == 0);
        lar_layout_destroy(&layout);
        lar_model_destroy(model);
    }
}

static void elements_numbered_from_any_side(void **unused) {
    (void)unused;
    chance_state = 5;
    for (int n = 0; n < 60; n++) {
        lar_model *model = boxes(1 + chance(9), 1 + chance(9), 1 + chance(9), n % 2 ? 0.1 : 0);
        turn_elements(&model->mesh);
        check_model(model);
    }
    lar_model *model = boxes(8, 5, 4, 0.1);
    turn_elements(&model->mesh);
    assert_int_equal(check_model(model).loose, 0);
}

static void laws_do_not_mix(void **unused) {
    (void)unused;
    chance_state = 6;
    for (int n = 0; n < 40; n++) {
        lar_model *model = boxes(5 + chance(12), 1 + chance(6), 1 + chance(6), n % 3 ? 0 : 0.1);
        mix_laws(model, n % 2);
        if (n % 5 == 0) turn_elements(&model->mesh);
        check_model(model);
    }
}

static void holes_and_corners(void **unused) {
    (void)unused;
    chance_state = 7;
    for (int n = 0; n < 60; n += test_every(5)) {
        int c[3] = {2 + chance(9), 2 + chance(9), 2 + chance(6)}, percent = 30 + chance(70);
        lar_model *model = boxes(c[0], c[1], c[2], n % 2 ? 0.1 : 0);
        bool *keep = lar_calloc((size_t)model->mesh.element_count, sizeof *keep);
        for (int32_t e = 0; e < model->mesh.element_count; e++) {
            int i = e % c[0], j = e / c[0] % c[1];
            keep[e] = n % 3 ? chance(100) < percent : i < c[0] / 2 || j < c[1] / 2; /* an L */
        }
        keep[0] = true;
        keep_elements(&model->mesh, keep);
        if (n % 4 == 0) turn_elements(&model->mesh);
        if (n % 7 == 0) mix_laws(model, false);
        free(keep);
        check_model(model);
    }
}

static void two_bodies(void **unused) {
    (void)unused;
    for (int gap = 0; gap < 12; gap++) {
        lar_model *model = boxes(12, 4, 3, 0);
        bool keep[12 * 4 * 3];
        for (int e = 0; e < 12 * 4 * 3; e++) keep[e] = e % 12 != gap;
        keep_elements(&model->mesh, keep);
        check_model(model);
    }
}

static void discs(void **unused) {
    (void)unused;
    for (int width = 1; width < 6; width++)
        for (int rings = 1; rings < 7; rings += test_every(2)) {
            check_model(disc(width, rings, 1 + (width + rings) % 3));
            lar_model *model = disc(width, rings, 2);
            turn_elements(&model->mesh);
            check_model(model);
        }
}

static void rings(void **unused) {
    (void)unused;
    for (int around = 3; around < 24; around += around < 10 ? 1 : 3)
        for (int width = 1; width <= 4; width += test_every(3)) {
            share in = check_model(ring(around, width, 0));
            if (around > 8 && width == 1) assert_true(in.loose < in.elements);
            for (int quarters = 1; around > 8 && quarters < 5; quarters++) {
                check_model(ring(around, width, quarters));
                lar_model *model = ring(around, width, quarters);
                turn_elements(&model->mesh);
                check_model(model);
            }
        }
}

static void a_row_that_crosses_itself(void **unused) {
    (void)unused;
    share in = check_model(loop());
    assert_int_equal(in.elements, 40);
    assert_in_range(in.loose, 1, 8);
}

/* Four elements in a row, and four more that lie over them, fastened to the same last face: valid
 * one by one, but no row leads round the fold. */
static void a_fold_ends_a_row(void **unused) {
    (void)unused;
    for (int from = 0; from < 2; from++) {
        lar_model *model = boxes(8, 1, 1, 0);
        lar_mesh *mesh = &model->mesh;
        for (int32_t n = 0; n < mesh->node_count; n++) {
            double *x = mesh->position[n];
            if (x[0] > 0.0401) *x = 0.08 - *x + 0.001;
        }
        for (int e = 4; e < 8; e++) { /* mirrored, so numbered the other way */
            int32_t was[8];
            memcpy(was, mesh->element[e], sizeof was);
            for (int a = 0; a < 8; a++) mesh->element[e][a] = was[a % 2 ? a - 1 : a + 1];
        }
        if (from) turn_elements(mesh);
        assert_int_equal(check_model(model).elements, 8);
    }
}

static void the_organ_is_nearly_all_rows(void **unused) {
    (void)unused;
    for (int mixed = 0; mixed < 2; mixed++) {
        lar_model *model = boxes(1, 1, 1, 0);
        lar_mesh_clear(&model->mesh);
        assert_int_equal(lar_demo_mesh(&model->mesh, NULL), LAR_OK);
        free(model->element_material);
        model->element_material = lar_calloc(LAR_DEMO_ELEMENTS, sizeof(int32_t));
        chance_state = 8;
        if (mixed) turn_elements(&model->mesh);
        share in = check_model(model);
        assert_int_equal(in.elements, LAR_DEMO_ELEMENTS);
        assert_in_range(in.loose, 0, LAR_DEMO_ELEMENTS / (mixed ? 6 : 10));
    }
}

/* Numbers that 32 bits could not hold are refused before anything is made of them. */
static void too_many_to_number(void **unused) {
    (void)unused;
    lar_model *model = boxes(1, 1, 1, 0);
    int32_t nodes = model->mesh.node_count, elements = model->mesh.element_count;
    for (int over = 0; over < 2; over++) {
        lar_layout layout;
        lar_error error;
        model->mesh.node_count = over ? nodes : (1 << 28) + 1;
        model->mesh.element_count = over ? INT32_MAX / 6 + 1 : elements;
        assert_int_equal(lar_layout_create(model, &layout, &error), LAR_ERROR_UNSUPPORTED);
        assert_non_null(strstr(error.message, "use a coarser mesh"));
        lar_layout_destroy(&layout);
    }
    model->mesh.node_count = nodes;
    model->mesh.element_count = elements;
    lar_model_destroy(model);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bricks_of_all_sizes),
        cmocka_unit_test(a_row_begins_even),
        cmocka_unit_test(elements_numbered_from_any_side),
        cmocka_unit_test(laws_do_not_mix),
        cmocka_unit_test(holes_and_corners),
        cmocka_unit_test(two_bodies),
        cmocka_unit_test(rings),
        cmocka_unit_test(discs),
        cmocka_unit_test(a_row_that_crosses_itself),
        cmocka_unit_test(a_fold_ends_a_row),
        cmocka_unit_test(the_organ_is_nearly_all_rows),
        cmocka_unit_test(too_many_to_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
