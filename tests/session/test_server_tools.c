/* Viewers add and remove tools: all see them, whoever may steer moves them as the scene's, and what
 * cannot be is answered with a sentence. */
#include "session/session_test.h"

#include "session/server_test.h"

enum { FIRST = SERVED_HANDS + 2 };

static served serve_spares(int32_t spares, const lar_server_options *options) {
    served s = {.b = {.model = served_model()}};
    lar_options of = lar_options_default();
    of.time_step = 1e-4;
    of.hands = 2;
    of.spares = spares;
    DONE(lar_simulation_create(s.b.model, &of, &s.b.simulation, &failure));
    DONE(lar_session_open(s.b.simulation, NULL, &s.b.session, &failure));
    DONE(lar_server_open(s.b.session, s.b.model, options, &s.server, &failure));
    DONE(lar_session_start(s.b.session, &failure));
    s.port = port_of(s.server);
    return s;
}

static const char SPHERE[] = "{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":0.006}";

static void everybody_sees_them(void **unused) {
    (void)unused;
    served s = serve_spares(2, NULL);
    client one = open_client(s.port), other = open_client(s.port);
    const char *hello = await_text(&one, "hello");
    assert_non_null(strstr(hello, "\"spares\":[4,5]"));
    assert_non_null(strstr(hello, "\"hands\":[2,3]"));
    assert_non_null(strstr(hello, "{\"name\":\"\",\"shape\":\"none\",\"radius\":0,"));
    await_text(&other, "hello");
    await_status(&other, "\"shape\":\"none\"");
    say(&one, SPHERE);
    assert_true(number_of(await_text(&one, "added"), "tool") == FIRST);
    await_status(&other, "\"name\":\"sphere 1\",\"shape\":\"sphere\",\"radius\":0.006,");
    say(&one, "{\"do\":\"add_tool\",\"shape\":\"grasper\",\"radius\":0.004,\"length\":0.02}");
    assert_true(number_of(await_text(&one, "added"), "tool") == FIRST + 1);
    /* Pictures have all of them, also those that are not there. */
    ask_frame(&other, "none");
    assert_int_equal(word_at(&other, 64), FIRST + 2);
    /* The other one moves it, as any tool of the scene, and may do so alone. */
    say(&other, "{\"do\":\"tool\",\"tool\":4,\"position\":[0.2,0.1,0.3]}");
    await_status(&other, "\"by\":\"you\"");
    say(&one, "{\"do\":\"remove_tool\",\"tool\":4}");
    assert_non_null(strstr(await_text(&one, "note"), "sphere 1 is moved by another viewer"));
    lar_tool_pose pose = {.opening = 0};
    for (int i = 0; i < 10000 && !(fabs(pose.position[2] - 0.3) < 1e-4); i++) {
        nap(0.001);
        DONE(lar_session_tool_force(s.b.session, FIRST, &pose, NULL, &failure));
    }
    assert_true(fabs(pose.position[0] - 0.2) < 1e-4 && fabs(pose.position[2] - 0.3) < 1e-4);
    say(&other, "{\"do\":\"remove_tool\",\"tool\":4}");
    await_status(&one, "\"name\":\"\",\"shape\":\"none\"");
    /* A late move of it is answered. Another one in its place belongs to nobody. */
    say(&other, "{\"do\":\"tool\",\"tool\":4,\"position\":[0.2,0.1,0.3]}");
    assert_non_null(strstr(await_text(&other, "note"), "place 4 has no tool"));
    say(&one, SPHERE);
    assert_true(number_of(await_text(&one, "added"), "tool") == FIRST);
    await_status(&one, "\"name\":\"sphere 1\"");
    assert_null(strstr((char *)one.data, "\"by\":\"other\""));
    close_client(&one);
    close_client(&other);
    end_serving(&s);
}

static void what_cannot_be_is_said(void **unused) {
    (void)unused;
    static const struct {
        const char *command, *because;
    } wrong[] = {
        {"{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":0}", "more than zero"},
        {"{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":-1}", "more than zero"},
        {"{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":10}", "too large for a body"},
        {"{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":2000}", "too large for a body"},
        {"{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":-1e300}", "more than zero"},
        {"{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":1e300}", "below 1e6 m"},
        {"{\"do\":\"add_tool\",\"shape\":\"capsule\",\"radius\":0.005,\"length\":1e6}",
         "too large for a body"},
        {"{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":1e-9}", "too thin"},
        {"{\"do\":\"add_tool\",\"shape\":\"capsule\",\"radius\":0.005}", "the length must be"},
        {"{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":0.005,\"length\":1}", "no length"},
        {"{\"do\":\"remove_tool\",\"tool\":0}", "ball belongs to the scene"},
        {"{\"do\":\"remove_tool\",\"tool\":4}", "is not there"},
    };
    served s = serve_spares(1, NULL);
    client c = open_client(s.port);
    await_text(&c, "hello");
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        say(&c, wrong[i].command);
        if (!strstr(await_text(&c, "note"), wrong[i].because))
            fail_msg("%s: %s", wrong[i].command, (char *)c.data);
    }
    say(&c, SPHERE);
    await_text(&c, "added");
    say(&c, SPHERE);
    assert_non_null(strstr(await_text(&c, "note"), "no place is left"));
    close_client(&c);
    end_serving(&s);
    s = serve_spares(0, NULL);
    c = open_client(s.port);
    assert_non_null(strstr(await_text(&c, "hello"), "\"spares\":[]"));
    say(&c, SPHERE);
    assert_non_null(strstr(await_text(&c, "note"), "no tool can be added here"));
    close_client(&c);
    end_serving(&s);
}

static void who_may_only_watch_adds_and_removes_none(void **unused) {
    (void)unused;
    served s = serve_spares(
        2, &(lar_server_options){.token = "a-secret_of_ours", .watch_token = "for-the-public"});
    client own = open_client_at(s.port, "/socket?token=a-secret_of_ours");
    say(&own, SPHERE);
    await_text(&own, "added");
    static const char *const paths[] = {"/socket?token=for-the-public",
                                        "/socket?token=a-secret_of_ours&watch=1"};
    for (int i = 0; i < 2; i++) {
        client c = open_client_at(s.port, paths[i]);
        await_status(&c, "\"name\":\"sphere 1\"");
        say(&c, SPHERE);
        assert_non_null(strstr(await_text(&c, "note"), "may only watch"));
        say(&c, "{\"do\":\"remove_tool\",\"tool\":4}");
        assert_non_null(strstr(await_text(&c, "note"), "may only watch"));
        for (int k = 0; k < 3; k++) await_text(&c, "status");
        assert_non_null(strstr((char *)c.data, "\"name\":\"sphere 1\""));
        assert_null(strstr((char *)c.data, "\"name\":\"sphere 2\""));
        close_client(&c);
    }
    close_client(&own);
    end_serving(&s);
}

/* The first point of the surface, where it is now; true when it is held. */
static bool grab_first(client *c) {
    char text[160];
    ask_frame(c, "none");
    const float *at = positions_of(c);
    snprintf(text, sizeof text, "{\"do\":\"grab\",\"hand\":0,\"point\":[%.6f,%.6f,%.6f]}",
             (double)at[0], (double)at[1], (double)at[2]);
    say(c, text);
    return strstr(await_text(c, "hand"), "\"state\":\"holding\"") != NULL;
}

/* A state that was saved in the middle of a hold is taken up, by whom holds in it and by another
 * one: hands let go, each time. */
static void loading_lets_go(void **unused) {
    (void)unused;
    char folder[256];
    snprintf(folder, sizeof folder, "%s/server-holds-%d", LAR_TEST_BUILD, (int)getpid());
    served s = serve_spares(0, &(lar_server_options){.save_folder = folder});
    client one = open_client(s.port), other = open_client(s.port);
    assert_true(grab_first(&one));
    say(&one, "{\"do\":\"save\"}");
    await_text(&one, "saved");
    for (int i = 0; i < 8; i++) {
        if (i > 0) assert_true(grab_first(&one));
        say(i % 2 ? &other : &one, "{\"do\":\"load\"}");
        assert_non_null(strstr(await_text(&one, "hand"), "\"state\":\"lost\""));
    }
    close_client(&one);
    close_client(&other);
    end_serving(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everybody_sees_them),
        cmocka_unit_test(what_cannot_be_is_said),
        cmocka_unit_test(who_may_only_watch_adds_and_removes_none),
        cmocka_unit_test(loading_lets_go),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
