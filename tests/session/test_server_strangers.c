/* Connections that are no viewers yet keep nobody out: silent ones, halves of requests, files,
 * wrong tokens, upgrades without one, hundreds of them from one address. */
#include "session/session_test.h"

#include <sys/resource.h>

#include "session/server_test.h"

enum { MANY = 600, STRANGERS = 16 };
static const char TOKEN[] = "a-secret_of_ours", OURS[] = "/socket?token=a-secret_of_ours";
static served s;

static int open_all(void **unused) {
    (void)unused;
    struct rlimit files;
    getrlimit(RLIMIT_NOFILE, &files);
    files.rlim_cur = files.rlim_max;
    setrlimit(RLIMIT_NOFILE, &files);
    s = serve_with(NULL, &(lar_server_options){.token = TOKEN});
    return 0;
}

static int close_all(void **unused) {
    (void)unused;
    end_serving(&s);
    return 0;
}

static int connect_from(const char *address) {
    struct sockaddr_in from = {.sin_family = AF_INET},
                       to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)s.port)};
    struct timeval patience = {10, 0};
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    inet_pton(AF_INET, address, &from.sin_addr);
    inet_pton(AF_INET, "127.0.0.1", &to.sin_addr);
    setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (bind(fd, (struct sockaddr *)&from, sizeof from) == 0 &&
        connect(fd, (struct sockaddr *)&to, sizeof to) == 0)
        return fd;
    close(fd);
    return -1;
}

/* Whether the other side has closed; what it has sent is passed over. */
static bool is_closed(int fd) {
    char bytes[4096];
    ssize_t got;
    while ((got = recv(fd, bytes, sizeof bytes, MSG_DONTWAIT)) > 0) continue;
    return got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
}

/* How long it takes until a viewer from there has its first status [s]; -1: it is not let in. */
static double let_in(const char *address) {
    int64_t begun = lar_clock_ns();
    client c = {.fd = connect_from(address), .port = s.port, .seed = 5};
    if (c.fd < 0) return -1;
    c.data = malloc(CLIENT_MAX);
    bool in = try_upgrade(c.fd, s.port, (upgrade){.path = OURS}) == 101, heard = false;
    while (in && !heard && next_frame(&c))
        heard = c.opcode == TEXT_FRAME && strncmp((char *)c.data, "{\"kind\":\"status\"", 16) == 0;
    double seconds = 1e-9 * (double)(lar_clock_ns() - begun);
    close_client(&c);
    return heard ? seconds : -1;
}

/* ---- the crowd ------------------------------------------------------------------------------- */

typedef enum kind { SILENT, HALF, FILES, WRONG, WITHOUT, KINDS } kind;
static const char *const kind_name[] = {"silent", "half a request", "GET", "a wrong token",
                                        "no token"};

/* Opens one and says what such a one says, without waiting for an answer. */
static int open_stranger(kind of) {
    int fd = connect_from("127.0.0.9");
    if (fd < 0) return -1;
    char text[512] = "";
    if (of == HALF) snprintf(text, sizeof text, "GET /socket HTTP/1.1\r\nHost: ");
    if (of == FILES)
        snprintf(text, sizeof text, "GET / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n", s.port);
    if (of >= WRONG)
        snprintf(text, sizeof text,
                 "GET /socket%s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nUpgrade: websocket\r\n"
                 "Connection: Upgrade\r\nSec-WebSocket-Protocol: lariat.1\r\n"
                 "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n",
                 of == WRONG ? "?token=a-secret_of_nobody" : "", s.port);
    put(fd, text, strlen(text));
    return fd;
}

typedef struct crowd {
    pthread_t thread;
    int kind; /* KINDS: all of them in turn */
    bool ends;
    int opened; /* atomic */
} crowd;

/* 600 at a time; whoever is closed comes again. */
static void *come(void *argument) {
    crowd *c = argument;
    static int fd[MANY];
    for (int i = 0; i < MANY; i++) fd[i] = -1;
    for (int round = 0; !__atomic_load_n(&c->ends, __ATOMIC_RELAXED); round++) {
        for (int i = 0; i < MANY && !__atomic_load_n(&c->ends, __ATOMIC_RELAXED); i++) {
            if (fd[i] >= 0 && !is_closed(fd[i])) continue;
            if (fd[i] >= 0) close(fd[i]);
            fd[i] = open_stranger(c->kind == KINDS ? (kind)(i % KINDS) : (kind)c->kind);
            __atomic_fetch_add(&c->opened, 1, __ATOMIC_RELAXED);
        }
        nap(0.02);
    }
    for (int i = 0; i < MANY; i++)
        if (fd[i] >= 0) close(fd[i]);
    return NULL;
}

/* Viewers of another address are in within a second (a busy machine gets three), those of the same
 * one within some seconds, with a second try where their turn was taken. */
static void viewers_get_in(void **unused) {
    (void)unused;
    for (int k = 0; k <= KINDS; k++) {
        crowd c = {.kind = k};
        double longest = 0, same = 0;
        assert_int_equal(pthread_create(&c.thread, NULL, come, &c), 0);
        for (int i = 0; i < 1000 && __atomic_load_n(&c.opened, __ATOMIC_RELAXED) < MANY; i++)
            nap(0.01);
        int in = 0;
        for (int i = 0; i < 25; i++) {
            double seconds = let_in("127.0.0.5");
            in += seconds >= 0;
            longest = fmax(longest, seconds);
        }
        bool own = false;
        int64_t begun = lar_clock_ns();
        for (int i = 0; i < 200 && !own; i++) own = let_in("127.0.0.9") >= 0;
        same = 1e-9 * (double)(lar_clock_ns() - begun);
        __atomic_store_n(&c.ends, true, __ATOMIC_RELAXED);
        pthread_join(c.thread, NULL);
        printf("%s: %d came, %d of 25 viewers in, the longest took %.3f s; own address %.3f s\n",
               k == KINDS ? "all kinds" : kind_name[k], c.opened, in, longest, same);
        assert_int_equal(in, 25);
        assert_true(longest < 3);
        assert_true(own && same < 10);
    }
}

/* ---- limits ---------------------------------------------------------------------------------- */

static int count_open(const int *fd, int count) {
    int open = 0;
    for (int i = 0; i < count; i++) open += !is_closed(fd[i]);
    return open;
}

/* So many of one address are kept, and the others of that address made room for them; no other
 * address had to. */
static void so_many_of_an_address(void **unused) {
    (void)unused;
    int fd[3 * STRANGERS], other[4];
    for (int i = 0; i < 4; i++) assert_true((other[i] = connect_from("127.0.0.7")) >= 0);
    for (int i = 0; i < 3 * STRANGERS; i++) assert_true((fd[i] = connect_from("127.0.0.8")) >= 0);
    nap(0.3);
    for (int i = 0; i < 60 && count_open(fd, 3 * STRANGERS) > STRANGERS; i++) nap(0.05);
    assert_int_equal(count_open(fd, 3 * STRANGERS), STRANGERS);
    assert_int_equal(count_open(fd + 2 * STRANGERS, STRANGERS), STRANGERS); /* the latest */
    assert_int_equal(count_open(other, 4), 4);
    /* Patience: five seconds for all of them. */
    nap(6);
    assert_int_equal(count_open(fd, 3 * STRANGERS) + count_open(other, 4), 0);
    for (int i = 0; i < 3 * STRANGERS; i++) close(fd[i]);
    for (int i = 0; i < 4; i++) close(other[i]);
}

/* Many addresses with few each: the one with the most makes room. */
static void many_addresses(void **unused) {
    (void)unused;
    enum { ADDRESSES = 40, EACH = 4 };
    int fd[ADDRESSES * EACH], one = connect_from("127.0.0.6");
    for (int i = 0; i < ADDRESSES * EACH; i++) {
        char address[32];
        snprintf(address, sizeof address, "127.0.1.%d", 1 + i / EACH);
        assert_true((fd[i] = connect_from(address)) >= 0);
    }
    nap(0.3);
    for (int i = 0; i < 60 && count_open(fd, ADDRESSES * EACH) > 64; i++) nap(0.05);
    int open = count_open(fd, ADDRESSES * EACH);
    assert_true(open <= 64 && open >= 48);
    assert_false(is_closed(one));
    assert_true(let_in("127.0.0.5") >= 0);
    for (int i = 0; i < ADDRESSES * EACH; i++) close(fd[i]);
    close(one);
}

/* A wrong token is told so and closed at once, and is nobody: it takes no viewer's place. */
static void wrong_tokens_are_nobody(void **unused) {
    (void)unused;
    client c[8];
    int64_t begun = lar_clock_ns();
    for (int i = 0; i < 8; i++) c[i] = open_client_at(s.port, "/socket?token=of-nobody");
    for (int i = 0; i < 8; i++) {
        assert_non_null(strstr(await_text(&c[i], "error"), "the token is missing or wrong"));
        assert_int_equal(await_close(&c[i]), 4001);
    }
    assert_true(lar_clock_ns() - begun < 3000000000);
    assert_int_equal(lar_server_viewers(s.server), 0);
    /* It need not answer: the connection ends all the same. */
    for (int i = 0; i < 300 && !is_closed(c[0].fd); i++) nap(0.01);
    assert_true(is_closed(c[0].fd));
    for (int i = 0; i < 8; i++) close_client(&c[i]);
}

/* A page takes several requests one after the other over one connection, then comes its viewer. */
static void a_page_takes_its_time(void **unused) {
    (void)unused;
    char request[128], head[4096];
    int fd = connect_from("127.0.0.5");
    snprintf(request, sizeof request, "GET /none HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n", s.port);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(ask_http(fd, request, head, sizeof head), 404);
        char *length = strstr(head, "content-length:"), body[4096];
        if (length) assert_true(get(fd, body, (size_t)atoi(length + 15)));
        nap(0.3);
    }
    close(fd);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(viewers_get_in), cmocka_unit_test(so_many_of_an_address),
        cmocka_unit_test(many_addresses), cmocka_unit_test(wrong_tokens_are_nobody),
        cmocka_unit_test(a_page_takes_its_time)};
    return cmocka_run_group_tests(tests, open_all, close_all);
}
