/* Who does not belong to the others is refused before the first step, and everyone is told why, in
 * the same words: another model or schedule, version, protocol, backend or number of processors. */
#include "fleet.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

static bool other_version; /* in this process */

/* The program is linked so that all ask here. */
const char *__wrap_lar_version(void);
const char *__real_lar_version(void);
const char *__wrap_lar_version(void) {
    return other_version ? "0.0.0" : __real_lar_version();
}

static void one_is_older(void *context, int32_t self, bool closed) {
    (void)context, (void)closed;
    other_version = self == 1;
}

static const char *nothing(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)comm, (void)context, (void)text;
    return NULL;
}

static void expect_all_say(const char *what, char texts[3][FLEET_TEXT]) {
    for (int p = 0; p < 3; p++) {
        if (!strstr(texts[p], what)) print_error("processor %d says: %s\n", p, texts[p]);
        assert_non_null(strstr(texts[p], what));
        assert_string_equal(texts[p], texts[0]);
    }
}

static void another_model_or_schedule_is_refused(void **state) {
    (void)state;
    lar_comm_backend_info info;
    for (int i = 0; fleet_backend(i, &info); i++) {
        char texts[3][FLEET_TEXT];
        fleet f = {.backend = info.name, .count = 3, .bytes = 64, .body = nothing};
        f.odd_identity = 7;
        if (info.start == LAR_COMM_BY_TEAM)
            fleet_threads(f, texts);
        else
            fleet_fork(f, texts);
        expect_all_say("processor 1 has another model or schedule", texts);
    }
}

static void another_version_is_refused(void **state) {
    (void)state;
    lar_comm_backend_info info;
    for (int i = 0; fleet_backend(i, &info); i++) {
        char texts[3][FLEET_TEXT];
        fleet f = {.backend = info.name, .count = 3, .bytes = 64, .body = nothing};
        f.around = one_is_older;
        if (info.start == LAR_COMM_BY_TEAM) continue; /* one process has one version */
        fleet_fork(f, texts);
        expect_all_say("processor 1 runs another version of Lariat (0.0.0)", texts);
    }
}

/* Processor 1 thinks that it belongs to `odd`. */
static void mix(fleet f, fleet odd, const char *what) {
    fleet_member members[3];
    char texts[3][FLEET_TEXT];
    fleet_prepare(&f);
    memcpy(odd.master, f.master, sizeof f.master);
    odd.listener = -1;
    for (int32_t p = 0; p < 3; p++) {
        members[p] = (fleet_member){.of = p == 1 ? &odd : &f, .self = p};
        assert_int_equal(pthread_create(&members[p].thread, NULL, fleet_thread, &members[p]), 0);
    }
    for (int p = 0; p < 3; p++) {
        pthread_join(members[p].thread, NULL);
        memcpy(texts[p], members[p].text, FLEET_TEXT);
    }
    expect_all_say(what, texts);
}

static void another_backend_or_number_is_refused(void **state) {
    (void)state;
    fleet f = {.backend = "tcp", .count = 3, .bytes = 64, .body = nothing}, odd = f;
    odd.backend = "shm";
    mix(f, odd, "processor 1 communicates by shm, processor 0 by tcp");
    odd = f;
    odd.count = 4;
    mix(f, odd, "a processor says that it is number 1 of 4, processor 0 expects 1 to 2 of 3");
}

/* Before it has met anybody: the others of the team do not wait for it until their time is over. */
static void nobody_waits_for_one_that_cannot_open(void **state) {
    (void)state;
    fleet f = {
        .backend = "threads", .count = 2, .bytes = 64, .start_timeout = 600, .body = nothing};
    fleet_prepare(&f);
    fleet odd = f;
    odd.bytes = 4; /* no multiple of 8 */
    fleet_member members[2] = {{.of = &f, .self = 0}, {.of = &odd, .self = 1}};
    for (int p = 0; p < 2; p++)
        assert_int_equal(pthread_create(&members[p].thread, NULL, fleet_thread, &members[p]), 0);
    for (int p = 0; p < 2; p++) pthread_join(members[p].thread, NULL);
    lar_comm_team_destroy(f.team);
    assert_non_null(strstr(members[1].text, "a receive buffer of 4 bytes"));
    assert_non_null(strstr(members[0].text, "processor 1"));
    assert_null(strstr(members[0].text, "did not start"));
}

/* A version whose first words were other: what follows them is not read. */
static void another_protocol_is_refused(void **state) {
    (void)state;
    fleet f = {.backend = "tcp", .count = 2, .bytes = 64, .body = nothing};
    fleet_prepare(&f);
    fleet_member zero = {.of = &f, .self = 0};
    assert_int_equal(pthread_create(&zero.thread, NULL, fleet_thread, &zero), 0);
    int other = socket(AF_INET, SOCK_STREAM, 0);
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_port = htons((uint16_t)atoi(strrchr(f.master, ':') + 1)),
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    assert_int_equal(connect(other, (struct sockaddr *)&to, sizeof to), 0);
    const uint64_t magic = 0x4c6172696174ffffu;
    assert_int_equal(write(other, &magic, sizeof magic), sizeof magic);
    pthread_join(zero.thread, NULL);
    close(other);
    assert_non_null(strstr(zero.text, "a processor runs another version of Lariat"));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(another_model_or_schedule_is_refused),
                                       cmocka_unit_test(another_version_is_refused),
                                       cmocka_unit_test(another_backend_or_number_is_refused),
                                       cmocka_unit_test(nobody_waits_for_one_that_cannot_open),
                                       cmocka_unit_test(another_protocol_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
