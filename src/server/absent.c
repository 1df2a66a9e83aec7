/* The viewers' server of a build without libwebsockets. */
#include "base/error.h"

lar_status lar_server_open(lar_session *session, const lar_model *model,
                           const lar_server_options *options, lar_server **server,
                           lar_error *error) {
    (void)session, (void)model, (void)options, (void)server;
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "this build has no server for viewers: install libwebsockets-dev (with Debian: "
                    "apt-get install libwebsockets-dev), configure and build Lariat again");
}

const char *lar_server_url(const lar_server *server) {
    (void)server;
    return "";
}

const char *lar_server_watch_url(const lar_server *server) {
    (void)server;
    return "";
}

int32_t lar_server_viewers(const lar_server *server) {
    (void)server;
    return 0;
}

void lar_server_close(lar_server *server) {
    (void)server;
}

int lar_server_has_page(void) {
    return 0;
}
