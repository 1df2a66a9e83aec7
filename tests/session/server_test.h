/* What the tests of the viewers' server share: a session that is served, and a viewer that can also
 * misbehave. The client is written from RFC 6455, byte by byte, so that it can send what no library
 * would.
 *
 * Include session_test.h first. */
#ifndef LAR_TESTS_SERVER_TEST_H
#define LAR_TESTS_SERVER_TEST_H

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include "engine/tools_test.h"

enum {
    CLIENT_MAX = 1 << 20,
    TEXT_FRAME = 1,
    BINARY_FRAME = 2,
    CLOSE_FRAME = 8,
    PING = 9,
    PONG = 10
};

/* ---- a served session ------------------------------------------------------------------------ */

typedef struct served {
    bench b;
    lar_server *server;
    int port;
} served;

enum { SERVED_BALL = 0, SERVED_GRASPER, SERVED_HANDS };

/* A small body that hangs, and beside it a ball and a grasper that touch nothing. */
static lar_model *unchecked_model(void) {
    lar_model *model = brick_model(&soft_brick);
    fix_nodes(model, brick_side(&soft_brick, 0, 0), 7);
    model->gravity[2] = -9.81;
    model->damping = 20;
    add_tool(model, "ball", LAR_TOOL_SPHERE, 0.2, 0, 0);
    add_tool(model, "grasper", LAR_TOOL_GRASPER, 0.2, 0, 0.2);
    return model;
}

TEST_UNUSED static lar_model *served_model(void) {
    lar_model *model = unchecked_model();
    DONE(lar_model_check(model, &failure));
    assert_true(model->surface.face_count > 0);
    return model;
}

TEST_UNUSED static lar_simulation *served_simulation(const lar_model *model, const char *grid) {
    lar_simulation *simulation = NULL;
    lar_options options = lar_options_default();
    options.time_step = 1e-4;
    options.grid = grid;
    options.hands = 2;
    DONE(lar_simulation_create(model, &options, &simulation, &failure));
    return simulation;
}

TEST_UNUSED static int port_of(const lar_server *server) {
    const char *url = lar_server_url(server);
    return atoi(strrchr(url, ':') + 1);
}

TEST_UNUSED static served serve_model(lar_model *model, const char *grid,
                                      const lar_server_options *options) {
    served s = {.b = {.model = model}};
    s.b.simulation = served_simulation(s.b.model, grid);
    DONE(lar_session_open(s.b.simulation, NULL, &s.b.session, &failure));
    DONE(lar_server_open(s.b.session, s.b.model, options, &s.server, &failure));
    DONE(lar_session_start(s.b.session, &failure));
    s.port = port_of(s.server);
    assert_true(s.port > 0);
    return s;
}

TEST_UNUSED static served serve_with(const char *grid, const lar_server_options *options) {
    return serve_model(served_model(), grid, options);
}

TEST_UNUSED static served serve(const char *grid) {
    return serve_with(grid, NULL);
}

TEST_UNUSED static void end_serving(served *s) {
    lar_server_close(s->server);
    close_bench(&s->b);
}

/* ---- connections ----------------------------------------------------------------------------- */

typedef struct client {
    int fd;
    int port;
    unsigned char *data; /* CLIENT_MAX bytes: the payload of the last frame */
    size_t length;
    int opcode;
    uint32_t seed; /* of masks */
} client;

TEST_UNUSED static int connect_to(int port) {
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_port = htons((uint16_t)port),
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    struct timeval patience = {20, 0};
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (connect(fd, (struct sockaddr *)&to, sizeof to) == 0) return fd;
    close(fd);
    return -1;
}

/* False when the other side has closed. */
TEST_UNUSED static bool put(int fd, const void *data, size_t length) {
    for (const char *at = data; length > 0;) {
        ssize_t sent = send(fd, at, length, MSG_NOSIGNAL);
        if (sent <= 0) return false;
        at += sent;
        length -= (size_t)sent;
    }
    return true;
}

TEST_UNUSED static bool get(int fd, void *data, size_t length) {
    for (char *at = data; length > 0;) {
        ssize_t got = recv(fd, at, length, 0);
        if (got <= 0) return false;
        at += got;
        length -= (size_t)got;
    }
    return true;
}

/* Sends a request and reads the head of the answer; returns its status, 0: closed without one. */
TEST_UNUSED static int ask_http(int fd, const char *request, char *head, size_t size) {
    size_t length = 0;
    if (!put(fd, request, strlen(request))) return 0;
    while (length + 1 < size && get(fd, head + length, 1)) {
        head[++length] = '\0';
        if (length >= 4 && strcmp(head + length - 4, "\r\n\r\n") == 0) break;
    }
    return length > 12 ? atoi(head + 9) : 0;
}

/* The request of an upgrade; what is NULL is as it should be, "" leaves a header out. */
typedef struct upgrade {
    const char *path, *host, *origin, *protocol;
} upgrade;

TEST_UNUSED static int try_upgrade(int fd, int port, upgrade u) {
    char request[2048], head[4096] = "", host[128], line[1024] = "";
    snprintf(host, sizeof host, "127.0.0.1:%d", port);
    if (!u.host) u.host = host;
    if (*u.host) snprintf(line, sizeof line, "Host: %s\r\n", u.host);
    if (u.origin)
        snprintf(line + strlen(line), sizeof line - strlen(line), "Origin: %s\r\n", u.origin);
    if (!u.protocol) u.protocol = "lariat.1";
    if (*u.protocol)
        snprintf(line + strlen(line), sizeof line - strlen(line), "Sec-WebSocket-Protocol: %s\r\n",
                 u.protocol);
    snprintf(request, sizeof request,
             "GET %s HTTP/1.1\r\n%sUpgrade: websocket\r\nConnection: Upgrade\r\n"
             "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n",
             u.path ? u.path : "/socket", line);
    int status = ask_http(fd, request, head, sizeof head);
    if (status == 101) {
        /* The example of RFC 6455, 1.3. */
        assert_non_null(strstr(head, "s3pPLMBiTxaQ9kYGzzhZRbK+xOo="));
        assert_non_null(strstr(head, "lariat.1"));
    }
    return status;
}

TEST_UNUSED static client open_client_at(int port, const char *path) {
    client c = {.fd = connect_to(port), .port = port, .seed = 12345};
    assert_true(c.fd >= 0);
    c.data = malloc(CLIENT_MAX);
    assert_int_equal(try_upgrade(c.fd, port, (upgrade){.path = path}), 101);
    return c;
}

TEST_UNUSED static client open_client(int port) {
    return open_client_at(port, "/socket");
}

TEST_UNUSED static void close_client(client *c) {
    if (c->fd >= 0) close(c->fd);
    free(c->data);
    *c = (client){.fd = -1};
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* One frame with any first byte; masked as clients must, unless told otherwise. */
TEST_UNUSED static bool put_frame(client *c, int first, const void *payload, size_t length,
                                  bool masked) {
    unsigned char head[14];
    size_t size = 2;
    head[0] = (unsigned char)first;
    if (length < 126) {
        head[1] = (unsigned char)length;
    } else if (length < 65536) {
        head[1] = 126;
        head[2] = (unsigned char)(length >> 8);
        head[3] = (unsigned char)length;
        size = 4;
    } else {
        head[1] = 127;
        for (int i = 0; i < 8; i++) head[2 + i] = (unsigned char)(length >> (56 - 8 * i));
        size = 10;
    }
    unsigned char mask[4] = {0};
    if (masked) {
        head[1] |= 0x80;
        c->seed = c->seed * 1664525u + 1013904223u;
        memcpy(mask, &c->seed, 4);
        memcpy(head + size, mask, 4);
        size += 4;
    }
    unsigned char *body = malloc(length + 1);
    for (size_t i = 0; i < length; i++) body[i] = ((const unsigned char *)payload)[i] ^ mask[i % 4];
    bool good = put(c->fd, head, size) && put(c->fd, body, length);
    free(body);
    return good;
}

TEST_UNUSED static void say(client *c, const char *text) {
    assert_true(put_frame(c, 0x80 | TEXT_FRAME, text, strlen(text), true));
}

/* The next frame; false: the connection has ended, or nothing came for 20 s. Text is terminated. */
TEST_UNUSED static bool next_frame(client *c) {
    unsigned char head[10];
    if (!get(c->fd, head, 2)) return false;
    uint64_t length = head[1] & 0x7f;
    int more = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (more && !get(c->fd, head + 2, (size_t)more)) return false;
    if (more) length = 0;
    for (int i = 0; i < more; i++) length = length << 8 | head[2 + i];
    assert_true(length < CLIENT_MAX);
    assert_int_equal(head[0] & 0x80, 0x80); /* never in pieces */
    assert_int_equal(head[1] & 0x80, 0);    /* never masked */
    c->opcode = head[0] & 0x0f;
    c->length = (size_t)length;
    if (!get(c->fd, c->data, c->length)) return false;
    c->data[c->length] = '\0';
    if (c->opcode == PING) put_frame(c, 0x80 | PONG, c->data, c->length, true);
    return true;
}

TEST_UNUSED static uint32_t word_at(const client *c, size_t offset) {
    uint32_t word;
    memcpy(&word, c->data + offset, sizeof word);
    return word;
}

TEST_UNUSED static uint64_t long_at(const client *c, size_t offset) {
    uint64_t word;
    memcpy(&word, c->data + offset, sizeof word);
    return word;
}

TEST_UNUSED static double double_at(const client *c, size_t offset) {
    double value;
    memcpy(&value, c->data + offset, sizeof value);
    return value;
}

/* Nothing takes longer than this, however busy the machine [ns]. */
static const int64_t TOO_LONG = 30000000000;

/* Waits for a text of a kind, passing over others. */
TEST_UNUSED static const char *await_text(client *c, const char *kind) {
    char begin[64];
    int64_t limit = lar_clock_ns() + TOO_LONG;
    snprintf(begin, sizeof begin, "{\"kind\":\"%s\"", kind);
    while (lar_clock_ns() < limit && next_frame(c))
        if (c->opcode == TEXT_FRAME && strncmp((char *)c->data, begin, strlen(begin)) == 0)
            return (char *)c->data;
    fail_msg("there was no message of kind %s", kind);
    return NULL;
}

TEST_UNUSED static void await_binary(client *c, uint32_t kind) {
    int64_t limit = lar_clock_ns() + TOO_LONG;
    while (lar_clock_ns() < limit && next_frame(c))
        if (c->opcode == BINARY_FRAME && word_at(c, 0) == kind) return;
    fail_msg("there was no binary message %u", kind);
}

/* Waits for a status in which this text occurs. */
TEST_UNUSED static void await_status(client *c, const char *wanted) {
    for (int i = 0; i < 100; i++)
        if (strstr(await_text(c, "status"), wanted)) return;
    fail_msg("no status says %s; the last one: %s", wanted, (char *)c->data);
}

/* Waits for the end; returns the code of the close frame, 0 when there was none. The sentence is in
 * c->data + 2. */
TEST_UNUSED static int await_close(client *c) {
    int code = 0;
    while (code == 0 && next_frame(c))
        if (c->opcode == CLOSE_FRAME && c->length >= 2) code = c->data[0] << 8 | c->data[1];
    return code;
}

/* A number behind a key, the first that occurs. */
TEST_UNUSED static double number_of(const char *json, const char *key) {
    char name[64];
    snprintf(name, sizeof name, "\"%s\":", key);
    const char *found = strstr(json, name);
    if (!found) fail_msg("there is no %s in %s", key, json);
    return strtod(found + strlen(name), NULL);
}

TEST_UNUSED static void ask_frame(client *c, const char *field) {
    char text[64];
    snprintf(text, sizeof text, "{\"do\":\"frame\",\"field\":\"%s\"}", field);
    say(c, text);
    await_binary(c, 2);
}

TEST_UNUSED static const float *positions_of(const client *c) {
    return (const float *)(const void *)(c->data + 72);
}

#endif
