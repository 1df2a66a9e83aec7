/* Muscles that a viewer activates. */
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

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(muscle_is_activated)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
