/* What every backend must do, the same bodies for all: comm.h and channel.h to the letter. */
#include "fleet.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include "comm/backend.h"

/* A word that only one place of one packet has. */
static uint64_t word_of(uint64_t from, uint64_t step, uint64_t slot, uint64_t i) {
    return (from << 56) ^ (step << 24) ^ (slot << 16) ^ i;
}

static const char *check_words(const void *payload, size_t words, uint64_t from, uint64_t step,
                               uint64_t slot, char text[FLEET_TEXT]) {
    const uint64_t *w = payload;
    for (size_t i = 0; i < words; i++)
        if (w[i] != word_of(from, step, slot, i))
            return fleet_say(text, "step %llu slot %llu word %zu is %llx", (unsigned long long)step,
                             (unsigned long long)slot, i, (unsigned long long)w[i]);
    return NULL;
}

static lar_status put_to_all(lar_comm *comm, uint64_t step, lar_error *error) {
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    lar_status status = LAR_OK;
    for (int32_t p = 0; p < count && !status; p++) {
        uint64_t words[32];
        size_t n = (size_t)(self + p) % 32;
        for (size_t i = 0; i < n; i++) words[i] = word_of((uint64_t)self, step, (uint64_t)p, i);
        status = lar_comm_put(comm, p, 512 * (size_t)self, words, 8 * n, step, error);
        memset(words, 0xee, sizeof words); /* may be used again */
    }
    return status;
}

/* Everyone to everyone, itself included, packets of 0, 8, 16, ... bytes in both halves. A packet
 * stays while its receiver is slow and the others are a step ahead: the halves are two. */
static const char *all_to_all(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context;
    lar_error error;
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    for (uint64_t step = 1; step <= 300; step++) {
        if (put_to_all(comm, step, &error)) return fleet_say(text, "%s", error.message);
        bool slow = step % 50 == (uint64_t)self;
        for (int pass = 0; pass <= slow; pass++) {
            if (pass) usleep(2000);
            for (int32_t p = 0; p < count; p++) {
                const void *payload;
                size_t n = (size_t)(self + p) % 32;
                if (lar_comm_wait(comm, p, 512 * (size_t)p, 8 * n, step, &payload, &error))
                    return fleet_say(text, "%s", error.message);
                if ((uintptr_t)payload % 8) return "a payload that is not aligned";
                if (check_words(payload, n, (uint64_t)p, step, (uint64_t)self, text)) return text;
            }
        }
    }
    return NULL;
}

static void everyone_reaches_everyone(void **state) {
    (void)state;
    fleet_everywhere("all to all", (fleet){.count = 1, .bytes = 512, .body = all_to_all});
    fleet_everywhere("all to all", (fleet){.count = 5, .bytes = 5 * 512, .body = all_to_all});
}

/* Local channels in both directions, several packets of odd sizes in order; a delay now and then.
 */
static const char *channels(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context;
    lar_error error;
    const size_t sizes[3] = {5, 424, 0};
    size_t region = 0;
    for (int i = 0; i < 3; i++) region += lar_comm_packet_bytes(sizes[i]);
    lar_channel_plan plan = {.peer = 1 - lar_comm_self(comm),
                             .send_offset = 64,
                             .send_bytes = region,
                             .receive_offset = 64,
                             .receive_bytes = region};
    lar_channel channel = {0};
    lar_status status = lar_channel_create(&channel, comm, &plan, &error);
    for (uint64_t step = 1; step <= 2000 && !status; step++) {
        status = lar_channel_reset(&channel, step, &error);
        if (step % 500 == (uint64_t)lar_comm_self(comm)) usleep(3000);
        for (int i = 0; i < 3; i++) {
            unsigned char bytes[424];
            memset(bytes, (int)(step + (uint64_t)i) & 255, sizeof bytes);
            size_t head = sizes[i] / 3;
            if (!status) status = lar_channel_queue(&channel, bytes, head, &error);
            if (!status) status = lar_channel_queue(&channel, bytes, sizes[i] - head, &error);
            if (!status) status = lar_channel_send(&channel, &error);
        }
        for (int i = 0; i < 3 && !status; i++) {
            const void *payload;
            status = lar_channel_receive(&channel, sizes[i], &payload, &error);
            for (size_t k = 0; k < sizes[i] && !status; k++)
                if (((const unsigned char *)payload)[k] != ((step + (uint64_t)i) & 255)) {
                    lar_channel_destroy(&channel);
                    return "a packet of another step or place";
                }
        }
    }
    lar_error full;
    if (!status && lar_channel_send(&channel, &full) != LAR_ERROR_ARGUMENT)
        return "a packet beyond the region";
    lar_channel_destroy(&channel);
    return status ? fleet_say(text, "%s", error.message) : NULL;
}

static void channels_keep_order(void **state) {
    (void)state;
    fleet_everywhere("channels", (fleet){.count = 2, .bytes = 1024, .body = channels});
}

/* Data one way only, the receiver slow: without the empty packets of the other direction the
 * sender would run ahead and write into a half that is being read. */
static const char *one_way(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context;
    lar_error error;
    bool sends = lar_comm_self(comm) == 0;
    size_t region = lar_comm_packet_bytes(400);
    lar_channel_plan plan = {.peer = sends ? 1 : 0};
    if (sends)
        plan.send_bytes = region;
    else
        plan.receive_bytes = region;
    lar_channel channel = {0};
    lar_status status = lar_channel_create(&channel, comm, &plan, &error);
    const char *wrong = NULL;
    for (uint64_t step = 1; step <= 400 && !status && !wrong; step++) {
        uint64_t words[50];
        const void *payload;
        status = lar_channel_reset(&channel, step, &error);
        for (size_t i = 0; i < 50; i++) words[i] = word_of(0, step, 0, i);
        if (sends && !status) status = lar_channel_queue(&channel, words, 400, &error);
        if (sends && !status) status = lar_channel_send(&channel, &error);
        if (sends || status) continue;
        status = lar_channel_receive(&channel, 400, &payload, &error);
        if (step % 20 == 0) usleep(2000);
        if (!status) wrong = check_words(payload, 50, 0, step, 0, text);
    }
    lar_channel_destroy(&channel);
    return status ? fleet_say(text, "%s", error.message) : wrong;
}

static void one_way_edges_are_safe(void **state) {
    (void)state;
    fleet_everywhere("one way", (fleet){.count = 2, .bytes = 512, .body = one_way});
}

/* Global packets, gathered in two parts, from all to processor 0 and an empty one back. */
static const char *packets(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context;
    lar_error error;
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    for (uint64_t step = 1; step <= 300; step++) {
        uint64_t words[30], gather[30];
        lar_packet packet;
        for (size_t i = 0; i < 30; i++) words[i] = word_of((uint64_t)self, step, 0, i);
        lar_status status = LAR_OK;
        if (self > 0) {
            status =
                lar_packet_start(&packet, comm, 0, 256 * (size_t)self, 240, step, gather, &error);
            if (!status) status = lar_packet_queue(&packet, words, 80, &error);
            if (!status && lar_packet_send(&packet, NULL) != LAR_ERROR_ARGUMENT)
                return "a packet that is not full was sent";
            if (!status) status = lar_packet_queue(&packet, words + 10, 160, &error);
            if (!status) status = lar_packet_send(&packet, &error);
            if (!status) status = lar_packet_receive(comm, 0, 0, 0, step, NULL, &error);
        }
        for (int32_t p = 1; self == 0 && p < count && !status; p++) {
            const void *payload;
            status = lar_packet_receive(comm, p, 256 * (size_t)p, 240, step, &payload, &error);
            if (!status && check_words(payload, 30, (uint64_t)p, step, 0, text)) return text;
            if (!status) status = lar_packet_start(&packet, comm, p, 0, 0, step, NULL, &error);
            if (!status) status = lar_packet_send(&packet, &error);
        }
        if (status) return fleet_say(text, "%s", error.message);
    }
    return NULL;
}

static void packets_go_anywhere(void **state) {
    (void)state;
    fleet_everywhere("packets", (fleet){.count = 4, .bytes = 1024, .body = packets});
}

/* More processors than cores: pure polling would need a time slice for every hop. */
static const char *ring(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    uint64_t steps = *(const uint64_t *)context;
    lar_error error;
    int32_t count = lar_comm_count(comm), self = lar_comm_self(comm);
    int32_t next = (self + 1) % count, last = (self + count - 1) % count;
    uint64_t words[53];
    for (uint64_t step = 1; step <= steps; step++) {
        const void *left, *right;
        for (size_t i = 0; i < 53; i++) words[i] = word_of((uint64_t)self, step, 0, i);
        if (lar_comm_put(comm, next, 0, words, 424, step, &error) ||
            lar_comm_put(comm, last, 512, words, 424, step, &error) ||
            lar_comm_wait(comm, last, 0, 424, step, &left, &error) ||
            lar_comm_wait(comm, next, 512, 424, step, &right, &error))
            return fleet_say(text, "%s", error.message);
        if (check_words(left, 53, (uint64_t)last, step, 0, text) ||
            check_words(right, 53, (uint64_t)next, step, 0, text))
            return text;
    }
    return NULL;
}

static void twelve_on_two_cores_progress(void **state) {
    (void)state;
    uint64_t steps = 2000;
    fleet_everywhere("ring", (fleet){.count = 12, .bytes = 1024, .body = ring, .context = &steps});
}

static const char *nonsense(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)context;
    (void)text;
    lar_error e;
    char bytes[64] = {0};
    if (lar_comm_put(comm, 1, 4, bytes, 8, 1, &e) != LAR_ERROR_ARGUMENT) return "crooked offset";
    if (lar_comm_put(comm, 1, 0, bytes, 64, 1, &e) != LAR_ERROR_ARGUMENT) return "no room for tail";
    if (lar_comm_put(comm, 1, SIZE_MAX - 7, bytes, 8, 1, &e) != LAR_ERROR_ARGUMENT) return "far";
    if (lar_comm_put(comm, 1, 8, bytes, SIZE_MAX - 3, 1, &e) != LAR_ERROR_ARGUMENT) return "huge";
    if (lar_comm_put(comm, 2, 0, bytes, 8, 1, &e) != LAR_ERROR_ARGUMENT) return "nobody";
    if (lar_comm_put(comm, 1, 0, bytes, 8, 0, &e) != LAR_ERROR_ARGUMENT) return "step 0";
    if (lar_comm_wait(comm, -1, 0, 8, 1, NULL, &e) != LAR_ERROR_ARGUMENT) return "from nobody";
    if (lar_comm_room(comm, 1, 0, 64, 1)) return "room beyond the buffer";
    return NULL;
}

static void nonsense_is_refused(void **state) {
    (void)state;
    fleet_everywhere("nonsense", (fleet){.count = 2, .bytes = 64, .body = nonsense});
    lar_comm_options o = lar_comm_options_default();
    lar_comm *comm;
    lar_error error;
    assert_int_equal(lar_comm_open(&o, &comm, &error), LAR_ERROR_ARGUMENT); /* no team */
    lar_comm_backend_info info;
    int rows = 0;
    for (; lar_comm_backend_list(rows, &info); rows++) {
        if (!info.missing) continue;
        o.backend = info.name;
        assert_int_equal(lar_comm_open(&o, &comm, &error), LAR_ERROR_UNSUPPORTED);
        assert_non_null(strstr(error.message, info.missing));
    }
    assert_int_equal(rows, 5);
    o.backend = "pigeons";
    assert_int_equal(lar_comm_open(&o, &comm, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "take one of these: threads, shm"));
    o.backend = "tcp";
    o.count = 2;
    o.master = "nowhere";
    o.self = 1;
    assert_int_equal(lar_comm_open(&o, &comm, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "host:port"));
    static const char *const ports[] = {"localhost:99999", "localhost:-1", "localhost:80x",
                                        "localhost:0", "localhost:65536"};
    for (size_t i = 0; i < 2 * sizeof ports / sizeof *ports; i++) {
        o.master = ports[i / 2];
        o.self = i % 2;
        assert_int_equal(lar_comm_open(&o, &comm, &error), LAR_ERROR_ARGUMENT);
        assert_non_null(strstr(error.message, "a port is a number from 1 to 65535"));
    }
}

/* Whoever started the others knows that one will not come; processor zero does not wait for it. */
static void the_start_is_called_off(void **state) {
    (void)state;
    char master[LAR_COMM_ADDRESS_TEXT];
    lar_error error;
    lar_comm *comm = NULL;
    lar_comm_options o = lar_comm_options_default();
    o.backend = "tcp";
    o.count = 2;
    o.master = master;
    assert_int_equal(lar_comm_listen("127.0.0.1:0", &o.listener, master, &error), LAR_OK);
    int kept = dup(o.listener);
    shutdown(kept, SHUT_RDWR);
    double begin = lar_comm_now();
    assert_int_equal(lar_comm_open(&o, &comm, &error), LAR_ERROR_PEER);
    assert_string_equal(error.message, lar_comm_called_off);
    assert_true(lar_comm_now() - begin < o.start_timeout);
    close(kept);
    begin = lar_comm_now();
    o.listener = open("/dev/null", O_RDONLY); /* as of options that were set to zero */
    assert_int_equal(lar_comm_open(&o, &comm, &error), LAR_ERROR_ARGUMENT);
    assert_non_null(strstr(error.message, "no socket that listens"));
    assert_true(lar_comm_now() - begin < o.start_timeout);
}

/* Without numbers for sockets nobody can come: that is not the others' fault. */
static void too_many_open_files(void **state) {
    (void)state;
    if (lar_comm_job_launched()) skip(); /* launchers leave numbers free here and there */
    char master[LAR_COMM_ADDRESS_TEXT];
    lar_error error;
    lar_comm *comm = NULL;
    struct rlimit before, none;
    lar_comm_options o = lar_comm_options_default();
    o.backend = "shm";
    o.count = 2;
    o.master = master;
    assert_int_equal(lar_comm_listen("127.0.0.1:0", &o.listener, master, &error), LAR_OK);
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
                             .sin_port = htons((uint16_t)atoi(strrchr(master, ':') + 1))};
    int guest = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(connect(guest, (const struct sockaddr *)&to, sizeof to), 0);
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
    /* What is open stays open; shm needs one number for its memory. */
    none = before;
    none.rlim_cur = (rlim_t)guest + 2;
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
    lar_status status = lar_comm_open(&o, &comm, &error);
    setrlimit(RLIMIT_NOFILE, &before);
    close(guest);
    assert_int_equal(status, LAR_ERROR_IO);
    assert_non_null(strstr(error.message, "ulimit -n"));
}

static const char *nothing(lar_comm *comm, void *context, char text[FLEET_TEXT]) {
    (void)comm, (void)context, (void)text;
    return NULL;
}

/* A processor with other files is refused before the first step, and all say the same. */
static void other_models_are_refused(void **state) {
    (void)state;
    if (lar_comm_job_launched()) skip();
    lar_comm_backend_info info;
    for (int i = 0; fleet_backend(i, &info); i++) {
        char texts[3][FLEET_TEXT];
        fleet f = {.backend = info.name,
                   .count = 3,
                   .bytes = 64,
                   .body = nothing,
                   .odd_identity = 7,
                   .start_timeout = 20};
        fleet_threads(f, texts);
        assert_non_null(strstr(texts[0], "processor 1 has another model or schedule"));
        assert_string_equal(texts[0], texts[1]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everyone_reaches_everyone),    cmocka_unit_test(channels_keep_order),
        cmocka_unit_test(one_way_edges_are_safe),       cmocka_unit_test(packets_go_anywhere),
        cmocka_unit_test(twelve_on_two_cores_progress), cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(the_start_is_called_off),      cmocka_unit_test(too_many_open_files),
        cmocka_unit_test(other_models_are_refused)};
    return fleet_end(cmocka_run_group_tests(tests, NULL, NULL));
}
