/* The viewers' server: its life, its thread, and its timer. */
#include "server/state.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <fcntl.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/file/folder.h"
#include "base/pin.h"
#include "base/socket.h"
#include "base/thread.h"

/* How often the thread looks around: while somebody watches, and while a hand is on its way [us].
 */
static const lws_usec_t INTERVAL = 5000, QUICK_INTERVAL = 2000, IDLE_INTERVAL = 100000;
static const int64_t STATUS_EVERY = LAR_SECOND_NS / 10, CHECK_EVERY = LAR_SECOND_NS / 2;
/* A picture that would show the same again is held back for so long. */
static const int64_t STILL = LAR_SECOND_NS / 4;
/* Pictures: not more often than this, and only every PAINT_SHARE times the time that the last one
 * took both threads, so that they leave most of a core to others. */
static const int64_t PAINT_EVERY = LAR_SECOND_NS / 125;
enum { PAINT_SHARE = 4 };
static const double SAVE_MAX = 4e9; /* [bytes] */
/* A viewer that takes nothing for so long is closed. */
static const int64_t SLOW = 10 * LAR_SECOND_NS;
/* Bytes that may come in a second, control frames and all: so many messages of full length. */
static const double BYTES_A_SECOND = LAR_MESSAGES_A_SECOND * (LAR_MESSAGE_MAX + 8.0);

/* ---- the timer ------------------------------------------------------------------------------- */

void lar_server_take_status(lar_server *server) {
    lar_session_status_get(server->session, &server->status);
    for (int32_t i = 0; i < server->tools; i++) {
        lar_session_tool_info(server->session, i, &server->tool[i].info, NULL);
        lar_session_tool_force(server->session, i, &server->tool[i].pose, &server->tool[i].force,
                               NULL);
    }
    for (lar_viewer *viewer = server->first; viewer; viewer = viewer->next)
        if (viewer->closing == LAR_CLOSE_NOT) lar_viewer_wants(viewer, LAR_DUE_STATUS);
}

/* Whether a viewer's request for a picture is answered now. */
static bool wants_picture(const lar_viewer *viewer, const lar_session_status *status, int64_t now) {
    if (!viewer->asks || viewer->closing != LAR_CLOSE_NOT || (viewer->due & LAR_DUE_PICTURE))
        return false;
    bool same = viewer->painted_step == status->step && viewer->painted_field == viewer->field;
    return !same || now - viewer->painted_at >= STILL;
}

static void ask_pictures(lar_server *server, int64_t now) {
    int64_t pause = PAINT_SHARE * server->paint_cost;
    if (pause < PAINT_EVERY) pause = PAINT_EVERY;
    if (now - server->paint_begun < pause) return;
    lar_session_status status;
    unsigned wanted = 0;
    lar_session_status_get(server->session, &status);
    for (lar_viewer *viewer = server->first; viewer; viewer = viewer->next)
        if (wants_picture(viewer, &status, now)) wanted |= 1u << viewer->field;
    if (wanted && lar_work_want(&server->work, wanted)) server->paint_begun = now;
}

static void refuse_pictures(lar_server *server, const lar_error *error) {
    lar_json *json = &server->json;
    for (lar_viewer *viewer = server->first; viewer; viewer = viewer->next) {
        if (!viewer->asks) continue;
        viewer->asks = false;
        lar_message_begin(json, "no_frame");
        lar_json_text(json, "text", error->message);
        lar_viewer_tell(viewer, json);
    }
}

void lar_server_collect(lar_server *server) {
    lar_error error;
    lar_job_end ended;
    if (!server->working) return;
    while (lar_work_next_end(&server->work, &ended)) lar_server_job_ended(server, &ended);
    if (!lar_work_collect(&server->work, &server->picture, &error)) return;
    if (error.status) {
        refuse_pictures(server, &error);
        return;
    }
    for (lar_viewer *viewer = server->first; viewer; viewer = viewer->next)
        if (viewer->asks && server->picture.frame[viewer->field].length > 0)
            lar_viewer_wants(viewer, LAR_DUE_PICTURE);
}

/* Bytes that a connection has brought in, as the system counts them; 0: it does not. */
static uint64_t bytes_received(struct lws *wsi) {
    struct tcp_info info = {0};
    socklen_t size = sizeof info;
    if (getsockopt(lws_get_socket_fd(wsi), IPPROTO_TCP, TCP_INFO, &info, &size)) return 0;
    return info.tcpi_bytes_received;
}

/* libwebsockets answers pings before it sends what we say: who goes on may never be told. */
static void stop_flood(lar_viewer *viewer) {
    if (viewer->closing == LAR_CLOSE_NOT)
        lar_viewer_close(viewer, LAR_CLOSE_POLICY, "more than 300 messages in a second");
    else
        lws_set_timeout(viewer->wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
}

/* Who takes nothing, and who floods us with what is no message (pings). */
static void check_session(lar_server *server, int64_t now) {
    double seconds = (double)(now - server->checked_at) / (double)LAR_SECOND_NS;
    server->checked_at = now;
    lar_server_sweep(server, now);
    lar_server_watch_recording(server);
    for (lar_viewer *viewer = server->first; viewer; viewer = viewer->next) {
        uint64_t bytes = bytes_received(viewer->wsi), before = viewer->bytes_in;
        viewer->bytes_in = bytes;
        if (viewer->writable_since && now - viewer->writable_since > SLOW)
            lar_viewer_close(viewer, LAR_CLOSE_SLOW, "nothing could be sent for 10 s");
        else if (before > 0 && (double)(bytes - before) > BYTES_A_SECOND * seconds)
            stop_flood(viewer);
    }
}

static void on_timer(lws_sorted_usec_list_t *sul) {
    lar_server *server = lws_container_of(sul, lar_server, timer);
    int64_t now = lar_clock_ns();
    lar_server_collect(server);
    if (now - server->checked_at >= CHECK_EVERY) check_session(server, now);
    if (server->first && now - server->status_at >= STATUS_EVERY) {
        server->status_at = now;
        lar_server_take_status(server);
    }
    lar_hands_look(&server->hands, now);
    ask_pictures(server, now);
    lar_server_ask_readings(server);
    lws_usec_t pause = !server->first                   ? IDLE_INTERVAL
                       : lar_hands_busy(&server->hands) ? QUICK_INTERVAL
                                                        : INTERVAL;
    lws_sul_schedule(server->context, 0, &server->timer, on_timer, pause);
}

/* ---- the thread ------------------------------------------------------------------------------ */

static void wake(void *context) {
    lws_cancel_service(((lar_server *)context)->context);
}

/* Farewell: viewers are told, as far as they listen. */
static void part(lar_server *server) {
    int64_t until = lar_clock_ns() + LAR_SECOND_NS / 2;
    for (lar_viewer *viewer = server->first; viewer; viewer = viewer->next)
        lar_viewer_close(viewer, LAR_CLOSE_AWAY, "the engine has ended");
    while (server->first && lar_clock_ns() < until) lws_service(server->context, 0);
}

static void *run(void *argument) {
    lar_server *server = argument;
    lar_pin_nowhere(); /* not where a processor computes, whose thread may have started this one */
    setpriority(PRIO_PROCESS, 0, LAR_SERVER_NICE); /* of this thread only, on Linux */
    lws_sul_schedule(server->context, 0, &server->timer, on_timer, 1);
    int64_t spent = lar_clock_thread_ns(), begun = server->paint_begun;
    while (!__atomic_load_n(&server->ending, __ATOMIC_ACQUIRE)) {
        lws_service(server->context, 0);
        if (begun == server->paint_begun) continue;
        /* Since the last picture was begun; what the worker takes is about as much again. */
        int64_t now = lar_clock_thread_ns();
        server->paint_cost = now - spent;
        spent = now;
        begun = server->paint_begun;
    }
    part(server);
    lws_sul_cancel(&server->timer);
    return NULL;
}

/* ---- opening --------------------------------------------------------------------------------- */

static const lws_retry_bo_t idle_policy = {.secs_since_valid_ping = 5,
                                           .secs_since_valid_hangup = 15};

/* The first one is of what is no WebSocket: with a name that no viewer can ask for. */
static const struct lws_protocols protocol_table[] = {
    {"no protocol", lar_server_http, sizeof(lar_download), 0, 0, NULL, 0},
    {LAR_PROTOCOL, lar_server_socket, sizeof(lar_viewer), LAR_MESSAGE_MAX + 1, 0, NULL, 0},
    {NULL, NULL, 0, 0, 0, NULL, 0}};

static lar_status make_context(lar_server *server, lar_error *error) {
    struct lws_context_creation_info info = {.port = CONTEXT_PORT_NO_LISTEN_SERVER,
                                             .protocols = protocol_table,
                                             .server_string = "lariat",
                                             .timeout_secs = 5,
                                             .keepalive_timeout = 5,
                                             .retry_and_idle_policy = &idle_policy,
                                             .fd_limit_per_thread = LAR_CONNECTIONS_MAX + 64,
                                             .options = LWS_SERVER_OPTION_NO_LWS_SYSTEM_STATES,
                                             .user = server};
    info.gid = (gid_t)-1;
    info.uid = (uid_t)-1;
    lws_set_log_level(0, NULL); /* a library does not print */
    server->context = lws_create_context(&info);
    if (!server->context)
        return lar_fail(error, LAR_ERROR_MEMORY, "libwebsockets cannot start: %s",
                        access("/dev/urandom", R_OK) == 0
                            ? "memory or open files are short; raise the limits (ulimit -n)"
                            : "it needs /dev/urandom; mount /dev");
    server->vhost = lws_get_vhost_by_name(server->context, "default");
    lws_sock_file_fd_type fd = {.filefd = server->listener};
    if (!lws_adopt_descriptor_vhost(server->vhost, LWS_ADOPT_RAW_FILE_DESC, fd,
                                    protocol_table[0].name, NULL)) {
        server->listener = -1; /* closed by it */
        return lar_fail(error, LAR_ERROR_MEMORY,
                        "libwebsockets does not take the socket: memory or open files are short");
    }
    return LAR_OK;
}

static bool is_token(const char *token) {
    size_t length = strlen(token);
    for (const char *c = token; *c; c++)
        if (!isalnum((unsigned char)*c) && *c != '-' && *c != '_') return false;
    return length >= 8 && length <= 128;
}

/* Which address, and whether anybody else can reach it. */
static lar_status choose_address(lar_server *server, const lar_server_options *options,
                                 lar_error *error) {
    const char *address = options->address ? options->address : "127.0.0.1";
    struct in6_addr six;
    struct in_addr four;
    bool is_six = inet_pton(AF_INET6, address, &six) == 1;
    bool is_four = inet_pton(AF_INET, address, &four) == 1;
    server->loopback = strcmp(address, "localhost") == 0 ||
                       (is_six && IN6_IS_ADDR_LOOPBACK(&six)) ||
                       (is_four && ntohl(four.s_addr) >> 24 == 127);
    server->any =
        (is_six && IN6_IS_ADDR_UNSPECIFIED(&six)) || (is_four && four.s_addr == INADDR_ANY);
    if (options->port < 0 || options->port > 65535)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "port %d does not exist; take 0 to 65535",
                        options->port);
    if (options->token && !is_token(options->token))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "the token must be 8 to 128 letters, digits, - and _");
    if (options->watch_token && !is_token(options->watch_token))
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "the watch token must be 8 to 128 letters, digits, - and _");
    if (options->watch_token && !options->token)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "a watch token needs a token beside it: without one everybody may do "
                        "everything");
    if (options->watch_token && strcmp(options->watch_token, options->token) == 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "the token and the watch token are the same; take two different ones");
    if (!server->loopback && !options->token)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "others can reach %s: whoever listens there must give a token (8 to 128 "
                        "letters, digits, - and _), which viewers must show",
                        address);
    int length = snprintf(server->host, sizeof server->host, is_six ? "[%s]" : "%s", address);
    if (length < 0 || (size_t)length >= sizeof server->host || address[0] == '\0')
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s is no address of this machine", address);
    return LAR_OK;
}

static lar_status listen_there(lar_server *server, int port, lar_error *error) {
    char at[LAR_HOST_BYTES + 8];
    snprintf(at, sizeof at, "%s:%d", server->host, port);
    lar_status status = lar_socket_listen(at, &server->listener, error);
    if (status) return status;
    server->port = lar_socket_port(server->listener);
    server->spare = fcntl(server->listener, F_DUPFD_CLOEXEC, 0);
    return LAR_OK;
}

/* Names of saved files begin with that of the scene's file, without what a shell would mind. */
static char *make_stem(const lar_model *model) {
    const char *source = lar_model_source(model), *slash = strrchr(source, '/');
    char *stem = lar_strdup(slash ? slash + 1 : source);
    if (!stem) return NULL;
    char *dot = strrchr(stem, '.');
    if (dot && dot != stem) *dot = '\0';
    for (char *c = stem; *c; c++)
        if (!isalnum((unsigned char)*c) && *c != '-') *c = '_';
    enum { LONGEST = 40 };
    if (strlen(stem) > LONGEST) stem[LONGEST] = '\0';
    return stem;
}

static char *make_url(const lar_server *server, const char *token) {
    char url[LAR_HOST_BYTES + 176];
    snprintf(url, sizeof url, "http://%s:%d/%s%s", server->any ? "127.0.0.1" : server->host,
             server->port, token ? "#token=" : "", token ? token : "");
    return lar_strdup(url);
}

static lar_status copy_texts(lar_server *server, const lar_server_options *options,
                             lar_error *error) {
    const char *watch = options->watch_token;
    server->url = make_url(server, options->token);
    server->watch_url = watch ? make_url(server, watch) : lar_strdup("");
    server->stem = make_stem(server->model);
    if (options->token) server->token = lar_strdup(options->token);
    if (watch) server->watch_token = lar_strdup(watch);
    if (options->save_folder) server->save_folder = lar_strdup(options->save_folder);
    if (!server->url || !server->watch_url || !server->stem || (options->token && !server->token) ||
        (watch && !server->watch_token) || (options->save_folder && !server->save_folder))
        return lar_fail_memory(error, LAR_HOST_BYTES, "the viewers' server");
    return LAR_OK;
}

static lar_status prepare(lar_server *server, lar_error *error) {
    size_t bytes = LAR_HEADROOM + 32 + LAR_HISTORY_TICKS * 3 * sizeof(float);
    lar_session *session = server->session;
    server->hello.headroom = 0;
    server->json.headroom = LAR_HEADROOM;
    server->forces.memory = lar_calloc_aligned(bytes, 1);
    if (!server->forces.memory) return lar_fail_memory(error, bytes, "forces for viewers");
    server->pace = server->about.options.pace;
    lar_server_list_saved(server);
    lar_server_take_status(server);
    lar_hands_create(&server->hands, session, lar_server_tell_hand, server);
    lar_status status = lar_server_make_hello(server, error);
    if (!status)
        status = lar_surface_messages(server->about.simulation, server->model, &server->surface,
                                      &server->embedded, error);
    if (!status) status = make_context(server, error);
    if (status) return status;
    status = lar_work_start(&server->work, session, server->model, wake, server, error);
    server->working = !status;
    if (!status) status = lar_picture_create(&server->work.painter, &server->picture, error);
    return status;
}

lar_status lar_server_open(lar_session *session, const lar_model *model,
                           const lar_server_options *options, lar_server **out, lar_error *error) {
    if (!session || !model || !out)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "lar_server_open needs a session, its model and a place for the server");
    lar_server_options asked = options ? *options : (lar_server_options){0};
    lar_server *server = lar_calloc(1, sizeof *server);
    if (!server) return lar_fail_memory(error, sizeof *server, "the viewers' server");
    server->session = session;
    server->model = model;
    lar_session_inspect(session, &server->about);
    lar_simulation_inspect(server->about.simulation, &server->simulated);
    server->tools = server->simulated.tools + server->simulated.spares;
    server->listener = server->spare = -1;
    server->save_max = asked.save_max > 0 ? asked.save_max : SAVE_MAX;
    lar_status status = choose_address(server, &asked, error);
    if (!status && server->simulated.model != model)
        status = lar_fail(error, LAR_ERROR_ARGUMENT,
                          "the session's simulation is of another model; give that one");
    if (!status) status = lar_files_read(asked.folder, &server->files, error);
    if (!status) status = lar_scan_read(asked.scan, &server->scan, error);
    if (!status && asked.save_folder) status = lar_folder_make(asked.save_folder, error);
    if (!status) status = listen_there(server, asked.port, error);
    if (!status) status = copy_texts(server, &asked, error);
    if (!status) status = prepare(server, error);
    if (!status) {
        int cause = lar_thread_start(&server->thread, run, server);
        server->started = cause == 0;
        if (cause) status = lar_fail_thread(error, cause, "the viewers' server");
    }
    if (status)
        lar_server_close(server);
    else
        *out = server;
    return status;
}

/* ---- the rest -------------------------------------------------------------------------------- */

const char *lar_server_url(const lar_server *server) {
    return server ? server->url : "";
}

const char *lar_server_watch_url(const lar_server *server) {
    return server ? server->watch_url : "";
}

int32_t lar_server_viewers(const lar_server *server) {
    return server ? __atomic_load_n(&server->viewers, __ATOMIC_RELAXED) : 0;
}

/* In a forked child, where closing a viewer's connection would end it for the parent, too: memory
 * and connections stay until the child ends, the address does not. */
static void forget(lar_server *server) {
    if (server->listener >= 0) close(server->listener);
    if (server->spare >= 0) close(server->spare);
    server->listener = server->spare = -1;
}

void lar_server_close(lar_server *server) {
    if (!server) return;
    if (server->started && !lar_thread_is_here(&server->thread)) {
        forget(server);
        return;
    }
    if (server->started) {
        __atomic_store_n(&server->ending, true, __ATOMIC_RELEASE);
        lws_cancel_service(server->context);
        lar_thread_join(&server->thread);
    }
    if (server->working) lar_work_stop(&server->work);
    if (server->context)
        lws_context_destroy(server->context); /* closes the listener too */
    else if (server->listener >= 0)
        close(server->listener);
    if (server->spare >= 0) close(server->spare);
    lar_picture_destroy(&server->picture);
    lar_files_clear(&server->files);
    lar_scan_clear(&server->scan);
    lar_json_clear(&server->hello);
    lar_json_clear(&server->json);
    free(server->surface.memory);
    free(server->embedded.memory);
    free(server->forces.memory);
    free(server->token);
    free(server->watch_token);
    free(server->save_folder);
    free(server->url);
    free(server->watch_url);
    free(server->stem);
    free(server);
}
