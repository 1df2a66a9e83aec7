/* Fifty viewers at once, and viewers that come and go: every picture that any of them gets is
 * right, and what a step takes meanwhile is printed beside what it takes without them. How much
 * slower the engine may become is a benchmark's affair (tools/bench_viewers.sh), not a test's. */
#include "session/session_test.h"

#include "session/server_test.h"

enum { VIEWERS = 50 };
static const double SECONDS = 3;

typedef struct crowd {
    int port;
    bool ending; /* atomic */
    uint64_t frames, wrong, lost;
    struct {
        uint64_t step, hash;
        uint32_t positions[2];
    } seen[4096];
} crowd;

/* Two pictures of the same step are the same. */
static void keep(crowd *all, const client *c) {
    int slot = (int)(long_at(c, 8) / 10 % 4096);
    all->frames++;
    bool same = all->seen[slot].step == long_at(c, 8) && all->seen[slot].hash != 0;
    if (same)
        all->wrong += all->seen[slot].hash != long_at(c, 24) ||
                      all->seen[slot].positions[0] != word_at(c, 32) ||
                      all->seen[slot].positions[1] != word_at(c, 36);
    all->seen[slot].step = long_at(c, 8);
    all->seen[slot].hash = long_at(c, 24);
    all->seen[slot].positions[0] = word_at(c, 32);
    all->seen[slot].positions[1] = word_at(c, 36);
}

static const char ASK[] = "{\"do\":\"frame\",\"field\":\"von_mises\"}";

/* One thread looks through all of them: sixty times a second each, as far as it gets. */
static void *look(void *context) {
    crowd *all = context;
    client c[VIEWERS];
    struct pollfd ready[VIEWERS];
    for (int i = 0; i < VIEWERS; i++) {
        c[i] = open_client(all->port);
        ready[i] = (struct pollfd){.fd = c[i].fd, .events = POLLIN};
        say(&c[i], ASK);
    }
    while (!__atomic_load_n(&all->ending, __ATOMIC_ACQUIRE)) {
        poll(ready, VIEWERS, 20);
        for (int i = 0; i < VIEWERS; i++) {
            if (!(ready[i].revents & POLLIN)) continue;
            if (!next_frame(&c[i])) {
                ready[i].fd = -1; /* polled no more */
                all->lost++;
                continue;
            }
            if (c[i].opcode != BINARY_FRAME || word_at(&c[i], 0) != 2) continue;
            keep(all, &c[i]);
            say(&c[i], ASK);
        }
    }
    for (int i = 0; i < VIEWERS; i++) close_client(&c[i]);
    return NULL;
}

static void tell(const char *when, const lar_session_status *s) {
    print_message("%-22s a step: median %.2f us, 99 %% below %.2f; ticks missed %llu of %llu\n",
                  when, 1e6 * s->step_p50, 1e6 * s->step_p99, (unsigned long long)s->misses,
                  (unsigned long long)s->ticks);
}

/* What the sessions' state is in the end, a run without anybody has too. */
static void compare_end(served *s) {
    lar_model *model = served_model();
    lar_simulation *plain = served_simulation(model, NULL);
    lar_server_close(s->server);
    s->server = NULL;
    DONE(lar_session_close(s->b.session, &failure));
    s->b.session = NULL;
    DONE(lar_simulation_advance(plain, lar_simulation_steps(s->b.simulation), &failure));
    assert_true(lar_simulation_hash(plain) == lar_simulation_hash(s->b.simulation));
    lar_simulation_destroy(s->b.simulation);
    lar_model_destroy(s->b.model);
    lar_simulation_destroy(plain);
    lar_model_destroy(model);
}

static void fifty_at_once(void **unused) {
    (void)unused;
    served s = serve("2x1x1");
    crowd *all = calloc(1, sizeof *all);
    pthread_t thread;
    all->port = s.port;
    nap(1.5);
    lar_session_status status = status_of(&s.b);
    tell("nobody looks:", &status);
    assert_int_equal(pthread_create(&thread, NULL, look, all), 0);
    nap(SECONDS);
    status = status_of(&s.b);
    tell("fifty look:", &status);
    print_message("%llu pictures, %.0f a second and viewer\n", (unsigned long long)all->frames,
                  (double)all->frames / SECONDS / VIEWERS);
    __atomic_store_n(&all->ending, true, __ATOMIC_RELEASE);
    pthread_join(thread, NULL);
    assert_true(all->frames > 10 * VIEWERS);
    assert_true(all->wrong == 0 && all->lost == 0);
    assert_int_equal(status.state, LAR_SESSION_PLAYING);
    free(all);
    compare_end(&s);
}

/* As many as ten minutes bring when somebody reloads the page every second. */
static void viewers_come_and_go(void **unused) {
    (void)unused;
    enum { TIMES = 600 };
    served s = serve(NULL);
    for (int i = 0; i < TIMES; i++) {
        client c = open_client(s.port);
        if (i % 3 == 0) await_text(&c, "hello");
        if (i % 7 == 0) ask_frame(&c, "pressure");
        if (i % 5 == 0) say(&c, "{\"do\":\"grab\",\"hand\":0,\"point\":[5,5,5]}");
        close_client(&c);
    }
    for (int i = 0; i < 2000 && lar_server_viewers(s.server) > 0; i++) nap(0.005);
    assert_int_equal(lar_server_viewers(s.server), 0);
    lar_session_status status = status_of(&s.b);
    tell("six hundred came:", &status);
    end_serving(&s);
}

/* Two sessions with one folder: each state has a name of its own. */
static void two_save_into_one_folder(void **unused) {
    (void)unused;
    enum { TIMES = 3 };
    char folder[256], name[2][64];
    snprintf(folder, sizeof folder, "%s/server-both-%d", LAR_TEST_BUILD, (int)getpid());
    served s[2];
    client c[2];
    for (int i = 0; i < 2; i++) {
        s[i] = serve_with(NULL, &(lar_server_options){.save_folder = folder});
        c[i] = open_client(s[i].port);
        await_text(&c[i], "hello");
    }
    for (int k = 0; k < TIMES; k++) {
        for (int i = 0; i < 2; i++) say(&c[i], "{\"do\":\"save\"}");
        for (int i = 0; i < 2; i++) {
            const char *found = strstr(await_text(&c[i], "saved"), "\"name\":");
            assert_non_null(found);
            snprintf(name[i], sizeof name[i], "%.40s", found);
        }
        assert_string_not_equal(name[0], name[1]);
        nap(0.6);
    }
    for (int i = 0; i < 2; i++) {
        close_client(&c[i]);
        end_serving(&s[i]);
    }
}

/* For tools/bench_viewers.sh: fifty viewers of a server that runs already. */
static int look_from_outside(int port, double seconds) {
    crowd *all = calloc(1, sizeof *all);
    pthread_t thread;
    all->port = port;
    if (pthread_create(&thread, NULL, look, all)) return 1;
    nap(seconds);
    __atomic_store_n(&all->ending, true, __ATOMIC_RELEASE);
    pthread_join(thread, NULL);
    printf("%.1f\n", (double)all->frames / seconds / VIEWERS);
    int failed = all->wrong > 0;
    free(all);
    return failed;
}

int main(int argc, char **argv) {
    if (argc == 4 && strcmp(argv[1], "look") == 0)
        return look_from_outside(atoi(argv[2]), atof(argv[3]));
    const struct CMUnitTest tests[] = {cmocka_unit_test(fifty_at_once),
                                       cmocka_unit_test(viewers_come_and_go),
                                       cmocka_unit_test(two_save_into_one_folder)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
