/* The viewers' server from inside.
 *
 *     listener --accept--> connection --+--> GET: http.c, from memory
 *                        (checked: Host,|
 *                         Origin, path) '--> upgrade: socket.c, a viewer
 *
 *     viewers -commands-> hands, session, work        socket.c: what comes in
 *     viewers <-- hello, surface, status, frames --   send.c: what goes out
 *
 * One thread serves all connections (libwebsockets' loop); work.h has the second one, for
 * what takes time. Nothing is queued for a viewer but its newest picture and some notes: a slow one
 * misses pictures, and is closed when it takes nothing for a while.
 */
#ifndef LAR_SERVER_STATE_H
#define LAR_SERVER_STATE_H

#include <libwebsockets.h>

#include "base/clock.h"
#include "base/thread.h"
#include "server/files.h"
#include "server/hands.h"
#include "base/json/write.h"
#include "server/scan.h"
#include "server/work.h"

_Static_assert(LWS_PRE <= LAR_HEADROOM, "the headers of libwebsockets fit before a message");

enum {
    LAR_VIEWERS_MAX = 64,
    LAR_CONNECTIONS_MAX = 192, /* viewers and others, also half open ones */
    LAR_STRANGERS_MAX = 64,    /* of them: those that are no viewers */
    LAR_STRANGERS_EACH = 16,   /* of one address */
    LAR_NOTES_MAX = 8,         /* that wait for a viewer */
    LAR_SAVE_NUMBERS = 1000,
    LAR_SAVES_MAX = 64, /* of a kind, that can be named */
    LAR_HOST_BYTES = 96,
    LAR_MESSAGES_A_SECOND = 300
};

#define LAR_PROTOCOL  "lariat.1"
#define LAR_SECOND_NS 1000000000LL

/* Names of files in the folder for saved states, oldest first. */
typedef struct lar_saved_list {
    char name[LAR_SAVES_MAX][LAR_NAME_MAX + 1];
    int count;
} lar_saved_list;

/* One viewer. What waits to be sent are bits, so that it can wait once only. */
enum {
    LAR_DUE_HELLO = 1,
    LAR_DUE_SURFACE = 2,
    LAR_DUE_EMBEDDED = 4,
    LAR_DUE_NOTES = 8,
    LAR_DUE_FORCES = 16,
    LAR_DUE_PICTURE = 32, /* the server's picture has what it asked for */
    LAR_DUE_STATUS = 64,
    LAR_DUE_SLICE = 128
};

typedef struct lar_viewer {
    struct lws *wsi;
    struct lar_viewer *next;
    uint64_t number;
    unsigned due;
    bool token_is_right;
    bool watches; /* and may do nothing else */
    lar_close closing;
    bool told;    /* why */
    bool counted; /* in `viewers`: who is not let in is none */
    char reason[LAR_REASON_BYTES];

    bool asks; /* for a picture */
    int field; /* index into the table */
    int64_t asked_at, painted_at;
    uint64_t painted_step; /* of the last frame; UINT64_MAX: none */
    int painted_field;

    int32_t slice_axis, slice_index; /* of the scan, as asked for last */
    bool inspects;                   /* `question` waits for its turn */
    int64_t inspects_since;
    lar_question question;

    int32_t forces_tool;
    uint64_t forces_after;

    char *note[LAR_NOTES_MAX]; /* JSON */
    int notes;

    char in[LAR_MESSAGE_MAX + 1];
    size_t in_length;
    double allowance; /* messages that it may send now */
    int64_t allowed_at;
    uint64_t bytes_in;      /* until `bytes_at` */
    int64_t writable_since; /* when it was last asked whether it can take more; 0: it is not */
} lar_viewer;

struct lar_server {
    lar_session *session;
    const lar_model *model;
    lar_session_info about;        /* of the session */
    lar_simulation_info simulated; /* of its simulation */
    int32_t tools;                 /* of it, spares included */
    char host[LAR_HOST_BYTES];     /* as in addresses: "[::1]" */
    int port;
    bool loopback, any;
    char *token, *watch_token, *save_folder, *url, *watch_url;
    char *stem; /* of names of files that are saved */
    lar_files files;

    int listener, spare; /* `spare`: a number for a socket, kept for when there are none left */
    struct lws_context *context;
    struct lws_vhost *vhost;
    lar_thread thread;
    bool started;
    bool ending;     /* atomic */
    int32_t viewers; /* atomic */
    int connections;
    struct {
        struct lws *wsi;      /* NULL: free */
        uint64_t from;        /* the address */
        int64_t since, until; /* it came; it has to have become a viewer */
        bool viewer;
    } connection[LAR_CONNECTIONS_MAX];

    /* The server's thread's. */
    lar_viewer *first;
    uint64_t last_number;
    lar_work work;
    bool working;
    lar_hands hands;
    lar_blob surface, embedded;
    lar_scan scan;
    lar_picture picture;
    lar_json hello; /* all but its beginning */
    lar_json json;  /* what is being sent */
    lar_blob forces;
    lar_session_status status;
    struct {
        lar_tool_info info;
        lar_tool_pose pose;
        lar_tool_force force;
    } tool[LAR_TOOLS_MAX];
    double pace;
    lar_saved_list states, recordings;
    int saved_number;
    int64_t saved_at;
    double save_max;                  /* [bytes] */
    bool recording_ends;              /* it is asked for */
    char recording[LAR_NAME_MAX + 1]; /* that is being made, and that is played */
    char played[LAR_NAME_MAX + 1];
    lws_sorted_usec_list_t timer;
    bool reading; /* a viewer's values are being read */
    int64_t status_at, checked_at, paint_begun, paint_cost;
};

/* ---- server.c ---- */

/* What the worker has done. */
void lar_server_collect(lar_server *server);

/* ---- server.c ---------- */

/* What the session says now; due to all viewers. */
void lar_server_take_status(lar_server *server);

/* ---- http.c ----------- */

typedef struct lar_download {
    const lar_file *file;
    size_t sent;
} lar_download;

/* Closes those that have not become viewers in time. */
void lar_server_sweep(lar_server *server, int64_t now);
/* A connection has become a viewer. */
void lar_server_promote(lar_server *server, const struct lws *wsi);
/* For connections that are not viewers yet; libwebsockets calls it. */
int lar_server_http(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                    size_t length);

/* ---- socket.c ----------- */

int lar_server_socket(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                      size_t length);
/* Ends a connection, with a reason that the viewer is told. */
void lar_viewer_close(lar_viewer *viewer, lar_close code, const char *reason);
void lar_viewer_wants(lar_viewer *viewer, unsigned due);

/* ---- send.c ----------- */

/* The first words of every text. */
void lar_message_begin(lar_json *json, const char *kind);
/* The part of `hello` that is the same for all viewers. */
lar_status lar_server_make_hello(lar_server *server, lar_error *error);
/* Sends one message that is due; not 0: the connection is broken or ends. */
int lar_viewer_send(lar_server *server, lar_viewer *viewer);
/* A note of kind "note" with a sentence. */
void lar_viewer_note(lar_server *server, lar_viewer *viewer, const char *sentence);
/* Ends the text and sends it later. When too many wait, the oldest goes. */
void lar_viewer_tell(lar_viewer *viewer, lar_json *json);
/* For lar_hands. */
void lar_server_tell_hand(void *server, uint64_t viewer, int32_t number, int32_t tool,
                          const char *state);

/* ---- saved.c ----------- */

/* What lies in the folder for saved states, and can be taken up or played here. */
void lar_server_list_saved(lar_server *server);
/* Whether what lies there has reached server->save_max. Looks at the disk. */
bool lar_server_saves_full(const lar_server *server);
void lar_saved_add(lar_saved_list *list, const char *name);
/* The name, or the last one for ""; NULL: it is not in the list. */
const char *lar_saved_find(const lar_saved_list *list, const char *name);

/* ---- act.c ----------- */

/* Ends a viewer's recording that has grown as large as may be. */
void lar_server_watch_recording(lar_server *server);

void lar_server_act(lar_server *server, lar_viewer *viewer, const lar_command *command);
void lar_server_job_ended(lar_server *server, const lar_job_end *end);
lar_viewer *lar_server_find(const lar_server *server, uint64_t number);

/* ---- inspect.c ----------- */

/* A viewer's question for values, answered when its turn comes; it replaces one that waits. */
void lar_server_inspect(lar_server *server, lar_viewer *viewer, const lar_command *command);
void lar_server_ask_readings(lar_server *server);
void lar_server_tell_reading(lar_server *server, const lar_job_end *end);

#endif
