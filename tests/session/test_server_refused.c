/* Who is not let in, and what is not served. */
#include "session/session_test.h"

#include "session/server_test.h"

static int upgrade_status(int port, upgrade u) {
    int fd = connect_to(port), status = try_upgrade(fd, port, u);
    close(fd);
    return status;
}

static void only_our_own_page_may_connect(void **unused) {
    (void)unused;
    served s = serve(NULL);
    char own[64], local[64], other_port[64], own_origin[64], local_origin[64];
    snprintf(own, sizeof own, "127.0.0.1:%d", s.port);
    snprintf(local, sizeof local, "localhost:%d", s.port);
    snprintf(other_port, sizeof other_port, "127.0.0.1:%d", s.port + 1);
    snprintf(own_origin, sizeof own_origin, "http://127.0.0.1:%d", s.port);
    snprintf(local_origin, sizeof local_origin, "http://localhost:%d", s.port);
    const struct {
        int status;
        upgrade u;
    } cases[] = {{101, {0}}, /* no browser: no origin */
                 {101, {.origin = own_origin}},
                 {101, {.host = local, .origin = local_origin}},
                 {403, {.host = local, .origin = own_origin}},
                 {403, {.origin = "http://evil.example"}},
                 {403, {.origin = "null"}},
                 {403, {.origin = "https://127.0.0.1"}},
                 {403, {.origin = "http://127.0.0.1"}},
                 {403, {.host = "evil.example"}},
                 {403, {.host = "evil.example", .origin = "http://evil.example"}},
                 {403, {.host = other_port}},
                 {403, {.host = "127.0.0.1"}},
                 {403, {.path = "/"}},
                 {403, {.path = "/socket/"}},
                 {101, {.protocol = "chat, lariat.1"}},
                 {101, {.protocol = "http,lariat.1 ,lariat.2"}},
                 {403, {.protocol = "chat"}},
                 {403, {.protocol = "chat, lariat.10"}},
                 {403, {.protocol = "lariat.2"}},
                 {403, {.protocol = "http"}},
                 {403, {.protocol = ""}}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        int status = upgrade_status(s.port, cases[i].u);
        if (status != cases[i].status) fail_msg("case %zu: %d", i, status);
    }
    /* Without a Host, or with two. */
    assert_int_not_equal(upgrade_status(s.port, (upgrade){.host = ""}), 101);
    char twice[160];
    snprintf(twice, sizeof twice, "%s\r\nHost: evil.example", own);
    assert_int_not_equal(upgrade_status(s.port, (upgrade){.host = twice}), 101);
    end_serving(&s);
}

static void tokens_are_asked_for(void **unused) {
    (void)unused;
    static const char token[] = "a-secret_of_ours";
    served s = serve_with(NULL, &(lar_server_options){.token = token});
    assert_non_null(strstr(lar_server_url(s.server), "/#token=a-secret_of_ours"));
    static const char *const wrong[] = {"/socket",
                                        "/socket?token=",
                                        "/socket?token=a-secret_of_our",
                                        "/socket?token=a-secret_of_ourss",
                                        "/socket?token=A-secret_of_ours",
                                        "/socket?other=a-secret_of_ours",
                                        "/socket?tokena-secret_of_ours"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        client c = open_client_at(s.port, wrong[i]);
        int code = await_close(&c);
        if (code != 4001) fail_msg("%s: %d", wrong[i], code);
        close_client(&c);
    }
    client c = open_client_at(s.port, "/socket?token=a-secret_of_ours");
    await_text(&c, "hello");
    close_client(&c);
    end_serving(&s);
}

static void say_and_expect_note(client *c, const char *command) {
    say(c, command);
    assert_non_null(strstr(await_text(c, "note"), "may only watch"));
}

/* Everything that acts on the run, by the watch token and by one's own choice. */
static void who_may_only_watch_does_nothing_else(void **unused) {
    (void)unused;
    static const char *const acts[] = {"{\"do\":\"pause\"}",
                                       "{\"do\":\"play\"}",
                                       "{\"do\":\"step\",\"steps\":5}",
                                       "{\"do\":\"reset\"}",
                                       "{\"do\":\"pace\",\"value\":0.1}",
                                       "{\"do\":\"record\",\"on\":true}",
                                       "{\"do\":\"save\"}",
                                       "{\"do\":\"load\"}",
                                       "{\"do\":\"replay\"}",
                                       "{\"do\":\"seek\",\"time\":0}",
                                       "{\"do\":\"gravity\"}",
                                       "{\"do\":\"damping\",\"value\":1}",
                                       "{\"do\":\"stiffness\",\"value\":1}",
                                       "{\"do\":\"activate\",\"value\":0}",
                                       "{\"do\":\"add_tool\",\"shape\":\"sphere\",\"radius\":0.01}",
                                       "{\"do\":\"remove_tool\",\"tool\":0}",
                                       "{\"do\":\"tool\",\"tool\":0,\"position\":[5,5,5]}",
                                       "{\"do\":\"grab\",\"hand\":0,\"point\":[0,0,0]}"};
    static const char *const paths[] = {"/socket?token=for-the-public",
                                        "/socket?token=a-secret_of_ours&watch=1"};
    served s = serve_with(
        NULL, &(lar_server_options){.token = "a-secret_of_ours", .watch_token = "for-the-public"});
    assert_non_null(strstr(lar_server_url(s.server), "/#token=a-secret_of_ours"));
    assert_non_null(strstr(lar_server_watch_url(s.server), "/#token=for-the-public"));
    for (size_t p = 0; p < sizeof paths / sizeof paths[0]; p++) {
        client c = open_client_at(s.port, paths[p]);
        assert_non_null(strstr(await_text(&c, "hello"), "\"watches\":true"));
        for (size_t i = 0; i < sizeof acts / sizeof acts[0]; i++) say_and_expect_note(&c, acts[i]);
        assert_non_null(strstr(await_text(&c, "hand"), "missed"));
        say(&c, "{\"do\":\"pull\",\"hand\":0,\"to\":[5,5,5]}");
        ask_frame(&c, "von_mises");
        say(&c, "{\"do\":\"forces\",\"tool\":0,\"after\":0}");
        await_binary(&c, 3);
        close_client(&c);
    }
    client c = open_client_at(s.port, "/socket?token=a-secret_of_ours");
    assert_non_null(strstr(await_text(&c, "hello"), "\"watches\":false"));
    await_status(&c, "\"state\":\"playing\"");
    assert_true(number_of((char *)c.data, "pace") == 1);
    say(&c, "{\"do\":\"pause\"}");
    await_status(&c, "\"state\":\"paused\"");
    close_client(&c);
    c = open_client_at(s.port, "/socket?token=for-the-publik");
    assert_int_equal(await_close(&c), 4001);
    close_client(&c);
    end_serving(&s);
}

static void expect_note(client *c, const char *command, const char *words) {
    say(c, command);
    const char *note = await_text(c, "note");
    if (!strstr(note, words)) fail_msg("%s: %s", command, note);
}

/* What there is nothing of gets an answer, and 1 alone makes a watcher. */
static void what_is_not_there_is_said(void **unused) {
    (void)unused;
    served s = serve_with(NULL, &(lar_server_options){.save_folder = LAR_TEST_BUILD});
    static const char *const paths[] = {"/socket?watch=0", "/socket?watch=", "/socket?watch=11"};
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        client c = open_client_at(s.port, paths[i]);
        assert_non_null(strstr(await_text(&c, "hello"), "\"watches\":false"));
        close_client(&c);
    }
    client c = open_client(s.port);
    expect_note(&c, "{\"do\":\"seek\",\"time\":0.5}", "no recording is being played");
    expect_note(&c, "{\"do\":\"record\",\"on\":false}", "nothing is being recorded");
    expect_note(&c, "{\"do\":\"stiffness\",\"value\":1,\"material\":7}",
                "there is no material 7; there are 1, counted from 0, and without material all");
    expect_note(&c, "{\"do\":\"activate\",\"value\":1,\"material\":7}", "without material all");
    close_client(&c);
    end_serving(&s);
}

/* What the program records from the start is its own: no viewer ends it or puts another one in its
 * place. A viewer's own recording anybody may end. */
static void the_programs_recording_is_its_own(void **unused) {
    (void)unused;
    char folder[256], path[300], replay[128];
    lar_session_status now;
    snprintf(folder, sizeof folder, "%s/server-own-%d", LAR_TEST_BUILD, (int)getpid());
    snprintf(path, sizeof path, "%s/all.recording", folder);
    served s = serve_with(NULL, &(lar_server_options){.save_folder = folder});
    DONE(lar_session_record(s.b.session, path, &failure));
    client c = open_client(s.port);
    await_status(&c, "\"recording\":true,\"recording_by\":\"program\"");
    static const char words[] = "the program itself records";
    expect_note(&c, "{\"do\":\"record\",\"on\":false}", words);
    expect_note(&c, "{\"do\":\"record\",\"on\":true}", words);
    lar_session_status_get(s.b.session, &now);
    assert_int_equal(now.recording, 1);
    DONE(lar_session_record(s.b.session, NULL, &failure));
    await_status(&c, "\"recording\":false,\"recording_by\":\"\"");
    nap(0.6);
    say(&c, "{\"do\":\"record\",\"on\":true}");
    await_status(&c, "\"recording\":true,\"recording_by\":\"viewer\"");
    client other = open_client(s.port);
    say(&other, "{\"do\":\"record\",\"on\":false}");
    const char *name = strstr(await_text(&other, "saved"), "\"name\"");
    assert_non_null(name);
    snprintf(replay, sizeof replay, "{\"do\":\"replay\",%s", name);
    /* The next one is the program's again. */
    DONE(lar_session_record(s.b.session, path, &failure));
    expect_note(&other, "{\"do\":\"record\",\"on\":false}", words);
    expect_note(&other, replay, words);
    close_client(&other);
    close_client(&c);
    end_serving(&s);
    lar_recording_info info;
    DONE(lar_recording_inspect(path, &info, &failure));
}

/* ---- files ----------------------------------------------------------------------------------- */

static void write_file(const char *folder, const char *name, const char *text) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static int fetch_with(int port, const char *method, const char *path, char *head, char *body,
                      size_t size) {
    char request[4096];
    int fd = connect_to(port);
    snprintf(request, sizeof request,
             "%s %s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nConnection: close\r\n\r\n", method, path,
             port);
    head[0] = body[0] = '\0';
    int status = ask_http(fd, request, head, 4096);
    size_t length = 0;
    while (length + 1 < size && get(fd, body + length, 1)) body[++length] = '\0';
    close(fd);
    return status;
}

static void files_and_nothing_else_are_served(void **unused) {
    (void)unused;
    char base[256], folder[300], assets[340], outside[300], link[340];
    snprintf(base, sizeof base, "%s/server-files-%d", LAR_TEST_BUILD, (int)getpid());
    snprintf(folder, sizeof folder, "%s/viewer", base);
    snprintf(assets, sizeof assets, "%s/assets", folder);
    snprintf(outside, sizeof outside, "%s/secret.txt", base);
    snprintf(link, sizeof link, "%s/link.txt", folder);
    mkdir(base, 0700);
    mkdir(folder, 0700);
    mkdir(assets, 0700);
    char *big = malloc(100001);
    for (int i = 0; i < 100000; i++) big[i] = (char)('a' + i % 26);
    big[100000] = '\0';
    write_file(folder, "index.html", "<!doctype html><title>x</title>");
    write_file(assets, "main-1a2b.js", big);
    write_file(assets, "main.css", "body{}");
    write_file(folder, "icon.svg", "<svg/>");
    write_file(folder, ".hidden", "hidden");
    write_file(base, "secret.txt", "secret");
    unlink(link);
    assert_int_equal(symlink(outside, link), 0);

    served s = serve_with(NULL, &(lar_server_options){.folder = folder});
    char head[4096], *body = malloc(200000);
    assert_int_equal(fetch_with(s.port, "GET", "/", head, body, 200000), 200);
    assert_string_equal(body, "<!doctype html><title>x</title>");
    assert_non_null(strstr(head, "content-type: text/html; charset=utf-8"));
    assert_non_null(strstr(head, "cache-control: no-cache"));
    assert_non_null(
        strstr(head, "content-security-policy: default-src 'none'; script-src 'self';"));
    assert_non_null(strstr(head, "x-content-type-options: nosniff"));
    assert_int_equal(fetch_with(s.port, "GET", "/assets/main-1a2b.js", head, body, 200000), 200);
    assert_string_equal(body, big);
    assert_non_null(strstr(head, "content-type: text/javascript"));
    assert_non_null(strstr(head, "immutable"));
    assert_int_equal(fetch_with(s.port, "GET", "/assets/main.css?x=1", head, body, 200000), 200);
    assert_non_null(strstr(head, "content-type: text/css"));
    assert_int_equal(fetch_with(s.port, "GET", "/icon.svg", head, body, 200000), 200);
    assert_non_null(strstr(head, "content-type: image/svg+xml"));
    assert_int_equal(fetch_with(s.port, "HEAD", "/index.html", head, body, 200000), 200);
    assert_string_equal(body, "");
    assert_non_null(strstr(head, "content-length: 31"));

    static const char *const paths[] = {"/none.html",
                                        "/assets",
                                        "/assets/",
                                        "/.hidden",
                                        "/link.txt",
                                        "/../secret.txt",
                                        "/assets/../../secret.txt",
                                        "/%2e%2e/secret.txt",
                                        "/..%2fsecret.txt",
                                        "/assets/..%2f..%2fsecret.txt",
                                        "/%2e%2e%2fsecret.txt",
                                        "/..\\secret.txt",
                                        "/....//secret.txt",
                                        "//etc/passwd",
                                        "/etc/passwd",
                                        "/index.html%00.txt",
                                        "/socket"};
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        int status = fetch_with(s.port, "GET", paths[i], head, body, 200000);
        if (status == 200 || strstr(body, "secret") || strstr(body, "root:"))
            fail_msg("%s is served: %d %s", paths[i], status, body);
    }
    static const char *const methods[] = {"POST", "PUT", "DELETE", "OPTIONS", "PATCH"};
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++)
        assert_int_not_equal(fetch_with(s.port, methods[i], "/", head, body, 200000), 200);
    free(body);
    free(big);
    end_serving(&s);
}

/* ---- opening --------------------------------------------------------------------------------- */

static void expect_refusal(const lar_server_options *options, lar_status status, const char *word) {
    bench b = {.model = served_model()};
    lar_server *server = NULL;
    lar_error error = {LAR_OK, ""};
    b.simulation = served_simulation(b.model, NULL);
    DONE(lar_session_open(b.simulation, NULL, &b.session, &failure));
    lar_status got = lar_server_open(b.session, b.model, options, &server, &error);
    if (got != status || !strstr(error.message, word))
        fail_msg("%d instead of %d, %s", got, status, error.message);
    assert_null(server);
    close_bench(&b);
}

static void what_makes_no_sense_is_refused(void **unused) {
    (void)unused;
    expect_refusal(&(lar_server_options){.address = "0.0.0.0"}, LAR_ERROR_ARGUMENT, "token");
    expect_refusal(&(lar_server_options){.address = "::"}, LAR_ERROR_ARGUMENT, "token");
    expect_refusal(&(lar_server_options){.address = "10.0.0.1"}, LAR_ERROR_ARGUMENT, "token");
    expect_refusal(&(lar_server_options){.address = ""}, LAR_ERROR_ARGUMENT, "token");
    expect_refusal(&(lar_server_options){.token = "short"}, LAR_ERROR_ARGUMENT, "8 to 128");
    expect_refusal(&(lar_server_options){.token = "with a space"}, LAR_ERROR_ARGUMENT, "8 to 128");
    expect_refusal(&(lar_server_options){.watch_token = "for-the-public"}, LAR_ERROR_ARGUMENT,
                   "needs a token");
    expect_refusal(&(lar_server_options){.token = "a-long-token", .watch_token = "a-long-token"},
                   LAR_ERROR_ARGUMENT, "two different");
    expect_refusal(&(lar_server_options){.token = "a-long-token", .watch_token = "short"},
                   LAR_ERROR_ARGUMENT, "8 to 128");
    expect_refusal(&(lar_server_options){.port = 65536}, LAR_ERROR_ARGUMENT, "65535");
    expect_refusal(&(lar_server_options){.folder = "/nonexistent"}, LAR_ERROR_IO, "/nonexistent");
    expect_refusal(&(lar_server_options){.folder = LAR_TEST_BUILD "/session"}, LAR_ERROR_IO, "");
    expect_refusal(&(lar_server_options){.save_folder = "/dev/null/x"}, LAR_ERROR_IO, "/dev/null");
    expect_refusal(&(lar_server_options){.address = "198.51.100.7", .token = "a-long-token"},
                   LAR_ERROR_IO, "198.51.100.7");
    served s = serve(NULL);
    expect_refusal(&(lar_server_options){.port = s.port}, LAR_ERROR_IO, "cannot listen");
    end_serving(&s);
    assert_string_equal(lar_server_url(NULL), "");
    assert_int_equal(lar_server_viewers(NULL), 0);
    lar_server_close(NULL);
}

/* Its nodes would be read where there are none. */
static void another_model_is_refused(void **unused) {
    (void)unused;
    bench b = open_bench(NULL, 0, NULL);
    lar_model *other = hanging_block();
    lar_server *server = NULL;
    assert_int_equal(lar_server_open(b.session, other, NULL, &server, &failure),
                     LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(failure.message, "another model"));
    assert_null(server);
    lar_model_destroy(other);
    close_bench(&b);
}

static void there_are_sixty_four_viewers(void **unused) {
    (void)unused;
    enum { MAX = 64 };
    served s = serve(NULL);
    client c[MAX];
    for (int i = 0; i < MAX; i++) {
        c[i] = open_client(s.port);
        await_text(&c[i], "hello");
    }
    assert_int_equal(lar_server_viewers(s.server), MAX);
    client more = open_client(s.port);
    assert_int_equal(await_close(&more), 4003);
    close_client(&more);
    close_client(&c[0]);
    for (int i = 0; i < 1000 && lar_server_viewers(s.server) == MAX; i++) nap(0.005);
    c[0] = open_client(s.port);
    await_text(&c[0], "hello");
    for (int i = 0; i < MAX; i++) close_client(&c[i]);
    end_serving(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(only_our_own_page_may_connect),
                                       cmocka_unit_test(tokens_are_asked_for),
                                       cmocka_unit_test(who_may_only_watch_does_nothing_else),
                                       cmocka_unit_test(what_is_not_there_is_said),
                                       cmocka_unit_test(the_programs_recording_is_its_own),
                                       cmocka_unit_test(files_and_nothing_else_are_served),
                                       cmocka_unit_test(what_makes_no_sense_is_refused),
                                       cmocka_unit_test(another_model_is_refused),
                                       cmocka_unit_test(there_are_sixty_four_viewers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
