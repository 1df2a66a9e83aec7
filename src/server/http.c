/* Connections that are no viewers: who is let in, and the viewer's files. */
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/text.h"
#include "server/state.h"

/* ---- who is let in --------------------------------------------------------------------------- */

static lar_server *server_of(struct lws *wsi) {
    return lws_context_user(lws_get_context(wsi));
}

/* A header that is there once and fits. */
static bool copy_header(struct lws *wsi, enum lws_token_indexes which, char *out, int size) {
    int length = lws_hdr_copy(wsi, out, size, which);
    return length > 0 && (size_t)length == strlen(out);
}

static bool is_host(const lar_server *server, const char *host, const char *name) {
    char wanted[LAR_HOST_BYTES + 8];
    snprintf(wanted, sizeof wanted, "%s:%d", name, server->port);
    return strcmp(host, wanted) == 0 || (server->port == 80 && strcmp(host, name) == 0);
}

/* Against DNS rebinding: a page of somebody else's whose name suddenly stands for this machine has
 * that name here. Where all addresses of the machine are listened at we cannot know what it is
 * called; there the token stands alone. */
static bool trusts_host(const lar_server *server, const char *host) {
    static const char *const own[] = {"localhost", "127.0.0.1", "[::1]"};
    if (server->any || is_host(server, host, server->host)) return true;
    for (int i = 0; server->loopback && i < 3; i++)
        if (is_host(server, host, own[i])) return true;
    return false;
}

/* Whether the Host and the Origin of a request are ours. */
static bool trusts(const lar_server *server, struct lws *wsi) {
    char host[LAR_HOST_BYTES + 8], origin[LAR_HOST_BYTES + 16];
    if (!copy_header(wsi, WSI_TOKEN_HOST, host, sizeof host) || !trusts_host(server, host))
        return false;
    if (lws_hdr_total_length(wsi, WSI_TOKEN_ORIGIN) == 0) return true;
    return copy_header(wsi, WSI_TOKEN_ORIGIN, origin, sizeof origin) &&
           strncmp(origin, "http://", 7) == 0 && strcmp(origin + 7, host) == 0;
}

/* ---- patience -------------------------------------------------------------------------------- */

/* A request takes a moment, and a page with its files and then the viewer some; libwebsockets' own
 * limits do not hold for everything that can be asked (a tunnel waits for ever). */
static const int64_t PATIENCE = 5 * LAR_SECOND_NS, LIFE = 30 * LAR_SECOND_NS;

/* A file of the viewer is on its way, which may take longer than a request; never more than LIFE
 * together. */
static void have_patience(lar_server *server, const struct lws *wsi, int64_t patience) {
    for (int i = 0; i < LAR_CONNECTIONS_MAX; i++) {
        if (server->connection[i].wsi != wsi) continue;
        int64_t end = server->connection[i].since + LIFE, until = lar_clock_ns() + patience;
        server->connection[i].until = until < end ? until : end;
    }
}

/* ---- answers --------------------------------------------------------------------------------- */

static int refuse(struct lws *wsi, unsigned code, const char *sentence) {
    if (lws_return_http_status(wsi, code, sentence) < 0) return -1;
    return lws_http_transaction_completed(wsi) ? -1 : 0;
}

static int add_header(struct lws *wsi, const char *name, const char *value, unsigned char **at,
                      unsigned char *end) {
    return lws_add_http_header_by_name(wsi, (const unsigned char *)name,
                                       (const unsigned char *)value, (int)strlen(value), at, end);
}

/* Nothing from elsewhere, no inline scripts, nobody may frame it. */
static const char *const header_table[][2] = {
    {"content-security-policy:",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
     "font-src "
     "'self'; connect-src 'self'; worker-src 'self' blob:; manifest-src 'self'; base-uri 'none'; "
     "form-action 'none'; frame-ancestors 'none'"},
    {"x-content-type-options:", "nosniff"},
    {"referrer-policy:", "no-referrer"},
    {"cross-origin-opener-policy:", "same-origin"},
    {"cross-origin-resource-policy:", "same-origin"}};

static int begin_file(struct lws *wsi, lar_download *download, const lar_file *file, bool body) {
    unsigned char buffer[LWS_PRE + 2048], *begin = buffer + LWS_PRE, *at = begin;
    unsigned char *end = buffer + sizeof buffer - 1;
    const char *cache = file->lasting ? "public, max-age=31536000, immutable" : "no-cache";
    int failed = lws_add_http_common_headers(wsi, HTTP_STATUS_OK, file->type, file->size, &at, end);
    failed = failed || add_header(wsi, "cache-control:", cache, &at, end);
    for (size_t i = 0; i < sizeof header_table / sizeof header_table[0] && !failed; i++)
        failed = add_header(wsi, header_table[i][0], header_table[i][1], &at, end);
    if (failed || lws_finalize_write_http_header(wsi, begin, &at, end)) return 1;
    if (!body) return lws_http_transaction_completed(wsi) ? -1 : 0;
    *download = (lar_download){.file = file};
    have_patience(server_of(wsi), wsi, LIFE);
    lws_callback_on_writable(wsi);
    return 0;
}

static int send_part(struct lws *wsi, lar_download *download) {
    enum { PART = 16384 };
    unsigned char buffer[LWS_PRE + PART];
    if (!download || !download->file) return 0;
    size_t left = download->file->size - download->sent, part = left < PART ? left : PART;
    memcpy(buffer + LWS_PRE, download->file->data + download->sent, part);
    enum lws_write_protocol kind = part == left ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP;
    if (lws_write(wsi, buffer + LWS_PRE, part, kind) != (int)part) return -1;
    download->sent += part;
    if (part < left) {
        lws_callback_on_writable(wsi);
        return 0;
    }
    download->file = NULL;
    have_patience(server_of(wsi), wsi, PATIENCE);
    return lws_http_transaction_completed(wsi) ? -1 : 0;
}

static int answer(lar_server *server, struct lws *wsi, lar_download *download, const char *path) {
    bool get = lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) > 0;
    bool head = lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) > 0;
    if (!download) return -1;
    download->file = NULL;
    if (!trusts(server, wsi))
        return refuse(wsi, HTTP_STATUS_FORBIDDEN, "This address is not the server's own.");
    if (!get && !head) return refuse(wsi, HTTP_STATUS_METHOD_NOT_ALLOWED, "Only GET and HEAD.");
    const lar_file *file = path ? lar_files_find(&server->files, path) : NULL;
    if (!file) return refuse(wsi, HTTP_STATUS_NOT_FOUND, "There is no such file.");
    return begin_file(wsi, download, file, get);
}

/* Whether ours is among the protocols that a viewer speaks: then libwebsockets takes it. */
static bool speaks_ours(const char *list) {
    lar_span rest = {list, strlen(list)}, one;
    for (bool more = true; more;) {
        more = lar_span_split(rest, ',', &one, &rest);
        if (lar_span_equal(lar_span_trim(one), LAR_PROTOCOL)) return true;
    }
    return false;
}

/* An upgrade is a viewer's: to a WebSocket, at its path, in our protocol. */
static int check_upgrade(lar_server *server, struct lws *wsi, const char *to) {
    char path[16], protocols[128];
    bool good =
        to && strcasecmp(to, "websocket") == 0 && trusts(server, wsi) &&
        copy_header(wsi, WSI_TOKEN_GET_URI, path, sizeof path) && strcmp(path, "/socket") == 0 &&
        copy_header(wsi, WSI_TOKEN_PROTOCOL, protocols, sizeof protocols) && speaks_ours(protocols);
    if (good) return 0;
    int sent = lws_return_http_status(wsi, HTTP_STATUS_FORBIDDEN,
                                      "This is not the address, origin or protocol of a viewer.");
    return sent < 0 ? -1 : 1;
}

/* ---- connections ----------------------------------------------------------------------------- */

/* The same number for who is the same: all of IPv4, of IPv6 the network, which one person may have
 * all of. */
static uint64_t number_of(const struct sockaddr_storage *address) {
    uint64_t number = 0;
    if (address->ss_family != AF_INET6)
        return ((const struct sockaddr_in *)(const void *)address)->sin_addr.s_addr;
    const struct in6_addr *six = &((const struct sockaddr_in6 *)(const void *)address)->sin6_addr;
    memcpy(&number, six->s6_addr + (IN6_IS_ADDR_V4MAPPED(six) ? 8 : 0), sizeof number);
    return number;
}

static void add_connection(lar_server *server, struct lws *wsi, uint64_t from) {
    for (int i = 0; i < LAR_CONNECTIONS_MAX; i++) {
        if (server->connection[i].wsi) continue;
        int64_t now = lar_clock_ns();
        server->connection[i].wsi = wsi;
        server->connection[i].from = from;
        server->connection[i].since = now;
        server->connection[i].until = now + PATIENCE;
        server->connection[i].viewer = false;
        server->connections++;
        return;
    }
}

static void drop_connection(lar_server *server, const struct lws *wsi) {
    for (int i = 0; i < LAR_CONNECTIONS_MAX; i++) {
        if (server->connection[i].wsi != wsi) continue;
        server->connection[i].wsi = NULL;
        server->connections--;
    }
}

void lar_server_promote(lar_server *server, const struct lws *wsi) {
    for (int i = 0; i < LAR_CONNECTIONS_MAX; i++)
        if (server->connection[i].wsi == wsi) server->connection[i].viewer = true;
}

static bool is_stranger(const lar_server *server, int i) {
    return server->connection[i].wsi && !server->connection[i].viewer;
}

/* At once: its place is free then. Never for a connection from within its own callback. */
static void show_out(lar_server *server, int i) {
    lws_set_timeout(server->connection[i].wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_SYNC);
}

void lar_server_sweep(lar_server *server, int64_t now) {
    for (int i = 0; i < LAR_CONNECTIONS_MAX; i++)
        if (is_stranger(server, i) && now > server->connection[i].until) show_out(server, i);
}

/* Strangers of connection i's address, and the oldest of them. */
static int count_strangers(const lar_server *server, uint64_t from, int *oldest) {
    int count = 0;
    *oldest = -1;
    for (int i = 0; i < LAR_CONNECTIONS_MAX; i++) {
        if (!is_stranger(server, i) || server->connection[i].from != from) continue;
        count++;
        if (*oldest < 0 || server->connection[i].since < server->connection[*oldest].since)
            *oldest = i;
    }
    return count;
}

/* Who opens many connections and says nothing keeps nobody out: of those that have not become
 * viewers the oldest of the same address makes room for one that comes; where there are too many of
 * too many addresses, the oldest of the address that has the most. */
static void make_room(lar_server *server, uint64_t from) {
    int all = 0, most = 0, oldest, victim = -1;
    if (count_strangers(server, from, &oldest) >= LAR_STRANGERS_EACH) {
        show_out(server, oldest);
        return;
    }
    for (int i = 0; i < LAR_CONNECTIONS_MAX; i++) all += is_stranger(server, i);
    if (all < LAR_STRANGERS_MAX) return;
    for (int i = 0; i < LAR_CONNECTIONS_MAX; i++) {
        if (!is_stranger(server, i)) continue;
        int count = count_strangers(server, server->connection[i].from, &oldest);
        if (count <= most) continue;
        most = count;
        victim = oldest;
    }
    show_out(server, victim);
}

/* The next that has come; -1: nobody. When the process has no numbers for sockets left, the spare
 * one takes the connection and drops it: it would wait at the door, and wake us, forever. */
static int accept_next(lar_server *server, struct sockaddr_storage *from) {
    for (;;) {
        socklen_t size = sizeof *from;
        *from = (struct sockaddr_storage){0};
        int fd =
            accept4(server->listener, (struct sockaddr *)from, &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (fd >= 0 || (errno != EMFILE && errno != ENFILE) || server->spare < 0) return fd;
        close(server->spare);
        fd = accept4(server->listener, NULL, NULL, SOCK_CLOEXEC);
        if (fd >= 0) close(fd);
        server->spare = fcntl(server->listener, F_DUPFD_CLOEXEC, 0);
        if (fd < 0) return -1;
    }
}

/* Those that have come, some at a time: between them others have their turn, also to say what they
 * want before they have to make room. */
static void accept_some(lar_server *server) {
    enum { SOME = LAR_STRANGERS_EACH / 2 };
    struct sockaddr_storage from;
    for (int i = 0; i < SOME; i++) {
        int on = 1, fd = accept_next(server, &from);
        if (fd < 0) return;
        uint64_t number = number_of(&from);
        make_room(server, number);
        if (server->connections >= LAR_CONNECTIONS_MAX) {
            close(fd);
            continue;
        }
        setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        struct lws *wsi = lws_adopt_descriptor_vhost(
            server->vhost, LWS_ADOPT_SOCKET | LWS_ADOPT_HTTP | LWS_ADOPT_ALLOW_SSL,
            (lws_sock_file_fd_type){.sockfd = fd}, NULL, NULL);
        if (wsi) add_connection(server, wsi, number);
    }
}

int lar_server_http(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                    size_t length) {
    lar_server *server = server_of(wsi);
    (void)length;
    switch (reason) {
    case LWS_CALLBACK_RAW_RX_FILE:
        accept_some(server);
        return 0;
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
        lar_server_collect(server);
        return 0;
    case LWS_CALLBACK_WSI_DESTROY:
        drop_connection(server, wsi);
        return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
        return check_upgrade(server, wsi, in);
    /* Upgrades in another protocol end here. */
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
        return -1;
    case LWS_CALLBACK_HTTP:
        return answer(server, wsi, user, in);
    case LWS_CALLBACK_HTTP_WRITEABLE:
        return send_part(wsi, user);
    case LWS_CALLBACK_HTTP_BODY:
        return -1;
    default:
        return 0;
    }
}
