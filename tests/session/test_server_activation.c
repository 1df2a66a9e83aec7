/* Muscles that a viewer activates, and along what fibres run. */
#include "session/session_test.h"

#include "session/server_test.h"

/* Muscle is as active as one viewer says; status names it only where there is some. */
static void muscle_is_activated(void **unused) {
    (void)unused;
    lar_model *model = unchecked_model();
    model->material[0].fibre = (lar_fibre){.along = 500};
    model->mesh.fibre = lar_calloc((size_t)model->mesh.element_count, sizeof *model->mesh.fibre);
    for (lar_gid e = 0; e < model->mesh.element_count; e++) model->mesh.fibre[e][0] = 1;
    DONE(lar_model_check(model, &failure));
    served s = serve_model(model, NULL, NULL);
    client c = open_client(s.port), other = open_client(s.port);
    assert_non_null(strstr(await_text(&c, "hello"), "\"active\":true}]"));
    await_status(&other, "\"stiffness\":[1],\"activation\":[1]}");
    say(&c, "{\"do\":\"activate\",\"value\":0.25,\"material\":0}");
    await_status(&other, "\"activation\":[0.25]");
    say(&c, "{\"do\":\"activate\",\"value\":1.5}");
    assert_non_null(strstr(await_text(&c, "note"), "from 0, nothing is active, to 1"));
    say(&c, "{\"do\":\"activate\",\"value\":1,\"material\":7}");
    assert_non_null(strstr(await_text(&c, "note"), "no material 7"));
    say(&c, "{\"do\":\"activate\"}");
    await_status(&other, "\"activation\":[1]");
    close_client(&c);
    close_client(&other);
    end_serving(&s);
    s = serve(NULL);
    c = open_client(s.port);
    say(&c, "{\"do\":\"activate\",\"value\":0.5}");
    assert_non_null(strstr(await_text(&c, "note"), "no material has"));
    close_client(&c);
    end_serving(&s);
}

static float float_at(const client *c, size_t offset) {
    float value;
    memcpy(&value, c->data + offset, sizeof value);
    return value;
}

/* Surfaces of models with fibres have directions behind them, and others are as they always were.
 */
static void fibres_are_told_once(void **unused) {
    (void)unused;
    for (uint32_t families = 0; families < 3; families++) {
        lar_model *model = unchecked_model();
        size_t elements = (size_t)model->mesh.element_count;
        if (families > 0)
            model->material[0].fibre = (lar_fibre){.law = LAR_FIBRE_HGO,
                                                   .isochoric = true,
                                                   .paired = families == 2,
                                                   .parameter = {1e3, 0.5, 0}};
        model->mesh.fibre = lar_calloc(elements, sizeof *model->mesh.fibre);
        model->mesh.second = lar_calloc(elements, sizeof *model->mesh.second);
        for (size_t e = 0; e < elements; e++) {
            model->mesh.fibre[e][e % 3] = 2; /* any length: models make it 1 */
            model->mesh.second[e][(e + 1) % 3] = 1;
        }
        DONE(lar_model_check(model, &failure));
        served s = serve_model(model, NULL, NULL);
        client c = open_client(s.port);
        await_binary(&c, 1);
        size_t n = word_at(&c, 4), faces = word_at(&c, 8), at = 16 + 20 * n + 24 * faces;
        lar_surface_info surface;
        lar_model_surface(model, &surface);
        assert_int_equal(word_at(&c, 12), families);
        assert_int_equal(c.length, at + 12 * families * faces);
        for (size_t f = 0; f < faces; f++)
            for (int32_t k = 0; k < (int32_t)families; k++)
                for (int32_t i = 0; i < 3; i++, at += 4)
                    assert_true(float_at(&c, at) == (float)((surface.element[f] + k) % 3 == i));
        double fibre[2][3];
        assert_int_equal(lar_model_element_fibres(model, 1, fibre), families);
        assert_true(fibre[0][1] == (families > 0) && fibre[1][2] == (families > 1));
        assert_int_equal(lar_model_element_fibres(model, -1, fibre), 0);
        assert_int_equal(lar_model_element_fibres(model, 0, NULL), families);
        close_client(&c);
        end_serving(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(muscle_is_activated),
                                       cmocka_unit_test(fibres_are_told_once)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
