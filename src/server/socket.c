/* Viewers: their connections, and what comes in. */
#include <netinet/in.h>
#include <linux/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "server/state.h"

/* For the end of whoever does not listen [s]. */
enum { CLOSE_SECONDS = 2 };

void lar_viewer_wants(lar_viewer *viewer, unsigned due) {
    viewer->due |= due;
    if (!viewer->writable_since) viewer->writable_since = lar_clock_ns();
    lws_callback_on_writable(viewer->wsi);
}

void lar_viewer_close(lar_viewer *viewer, lar_close code, const char *reason) {
    if (viewer->closing != LAR_CLOSE_NOT) return;
    viewer->closing = code;
    snprintf(viewer->reason, sizeof viewer->reason, "%s", reason);
    lws_set_timeout(viewer->wsi, PENDING_TIMEOUT_USER_REASON_BASE, CLOSE_SECONDS);
    lar_viewer_wants(viewer, 0);
}

/* ---- the beginning and the end --------------------------------------------------------------- */

/* Takes the same time whatever is wrong, so that nobody can find a token letter by letter. */
static bool same_secret(const char *given, const char *secret) {
    size_t length = strlen(secret), got = strlen(given);
    unsigned difference = (unsigned)(length ^ got);
    for (size_t i = 0; i < length; i++)
        difference |= (unsigned char)(secret[i] ^ (i < got ? given[i] : 0));
    return difference == 0;
}

/* Whether it may look, and whether it may do more: who shows the watch token, or asks for no more,
 * may not. */
static void read_rights(const lar_server *server, lar_viewer *viewer, struct lws *wsi) {
    char given[160], asked[32];
    const char *token = lws_get_urlarg_by_name(wsi, "token=", given, sizeof given);
    const char *watch = lws_get_urlarg_by_name(wsi, "watch=", asked, sizeof asked);
    bool full = !server->token || (token && same_secret(token, server->token));
    bool part = token && server->watch_token && same_secret(token, server->watch_token);
    viewer->token_is_right = full || part;
    viewer->watches = !full || (watch && strcmp(watch, "1") == 0);
}

static void welcome(lar_server *server, lar_viewer *viewer) {
    unsigned embedded = server->embedded.length > 0 ? LAR_DUE_EMBEDDED : 0;
    lar_viewer_wants(viewer, LAR_DUE_HELLO | LAR_DUE_SURFACE | embedded | LAR_DUE_STATUS);
    lar_server_take_status(server); /* while nobody was there none was taken */
    if (!lar_embedded_is_too_large(server->model)) return;
    char sentence[160];
    snprintf(
        sentence, sizeof sentence,
        "The scene's embedded surface is not drawn: it has more than %d triangles or vertices.",
        LAR_EMBEDDED_MAX);
    lar_viewer_note(server, viewer, sentence);
}

static void begin(lar_server *server, lar_viewer *viewer, struct lws *wsi) {
    int32_t others = __atomic_load_n(&server->viewers, __ATOMIC_RELAXED);
    int64_t now = lar_clock_ns();
    *viewer = (lar_viewer){.wsi = wsi,
                           .next = server->first,
                           .number = ++server->last_number,
                           .token_is_right = viewer->token_is_right,
                           .watches = viewer->watches,
                           .painted_step = UINT64_MAX,
                           .allowance = LAR_MESSAGES_A_SECOND,
                           .allowed_at = now};
    server->first = viewer;
    if (!viewer->token_is_right) {
        lar_viewer_close(viewer, LAR_CLOSE_TOKEN,
                         "the token is missing or wrong; open the address that the engine printed");
    } else if (others >= LAR_VIEWERS_MAX) {
        lar_viewer_close(viewer, LAR_CLOSE_FULL, "too many viewers; close another one first");
    } else {
        viewer->counted = true;
        __atomic_fetch_add(&server->viewers, 1, __ATOMIC_RELAXED);
        lar_server_promote(server, wsi);
        welcome(server, viewer);
    }
}

static void end(lar_server *server, lar_viewer *viewer) {
    lar_viewer **link = &server->first;
    while (*link && *link != viewer) link = &(*link)->next;
    if (!*link) return;
    *link = viewer->next;
    if (viewer->counted) __atomic_fetch_sub(&server->viewers, 1, __ATOMIC_RELAXED);
    lar_hands_leave(&server->hands, viewer->number);
    for (int i = 0; i < viewer->notes; i++) free(viewer->note[i]);
    viewer->notes = 0;
}

/* ---- what comes in --------------------------------------------------------------------------- */

/* So many messages a second, and as many at once after a rest. */
static bool may_speak(lar_viewer *viewer) {
    int64_t now = lar_clock_ns();
    viewer->allowance +=
        (double)(now - viewer->allowed_at) * LAR_MESSAGES_A_SECOND / (double)LAR_SECOND_NS;
    viewer->allowed_at = now;
    if (viewer->allowance > LAR_MESSAGES_A_SECOND) viewer->allowance = LAR_MESSAGES_A_SECOND;
    viewer->allowance -= 1;
    return viewer->allowance >= 0;
}

static void hear(lar_server *server, lar_viewer *viewer) {
    lar_command command;
    char reason[LAR_REASON_BYTES];
    lar_close wrong =
        lar_command_read(viewer->in, viewer->in_length, server->tools, &command, reason);
    if (wrong)
        lar_viewer_close(viewer, wrong, reason);
    else
        lar_server_act(server, viewer, &command);
}

/* A part of a message; they come in pieces, however they were sent. */
static void receive(lar_server *server, lar_viewer *viewer, const char *data, size_t length) {
    if (viewer->closing != LAR_CLOSE_NOT) return;
    if (lws_frame_is_binary(viewer->wsi)) {
        lar_viewer_close(viewer, LAR_CLOSE_BINARY, "viewers send text, never binary messages");
        return;
    }
    size_t more = length + lws_remaining_packet_payload(viewer->wsi);
    if (viewer->in_length + more > LAR_MESSAGE_MAX) {
        lar_viewer_close(viewer, LAR_CLOSE_SIZE, "a message has at most 1024 bytes");
        return;
    }
    if (length > 0) memcpy(viewer->in + viewer->in_length, data, length);
    viewer->in_length += length;
    if (lws_remaining_packet_payload(viewer->wsi) > 0 || !lws_is_final_fragment(viewer->wsi))
        return;
    if (!may_speak(viewer)) {
        lar_viewer_close(viewer, LAR_CLOSE_POLICY, "more than 300 messages in a second");
        return;
    }
    hear(server, viewer);
    viewer->in_length = 0;
}

int lar_server_socket(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                      size_t length) {
    lar_server *server = lws_context_user(lws_get_context(wsi));
    lar_viewer *viewer = user;
    switch (reason) {
    /* The only moment at which the address is still known. */
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
        read_rights(server, viewer, wsi);
        return 0;
    case LWS_CALLBACK_ESTABLISHED:
        begin(server, viewer, wsi);
        return 0;
    case LWS_CALLBACK_CLOSED:
        end(server, viewer);
        return 0;
    case LWS_CALLBACK_RECEIVE:
        receive(server, viewer, in, length);
        return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE:
        viewer->writable_since = 0;
        return lar_viewer_send(server, viewer);
    default:
        return 0;
    }
}
