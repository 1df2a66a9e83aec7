/* The calls of UCX, found when the first processor of the backend ucx starts: until then nothing
 * of it is loaded. UCX catches signals as soon as it is (those of crashes, and SIGHUP), and a
 * library that only might use it would take them from every program that loads it.
 */
#ifndef LAR_COMM_UCX_CALLS_H
#define LAR_COMM_UCX_CALLS_H

#include <ucp/api/ucp.h>
#include <ucs/config/global_opts.h>

#include "base/error.h"

#define UCX_CALLS(X)                                                                               \
    X(ucp_am_send_nbx)                                                                             \
    X(ucp_cleanup)                                                                                 \
    X(ucp_config_modify)                                                                           \
    X(ucp_config_read)                                                                             \
    X(ucp_config_release)                                                                          \
    X(ucp_ep_close_nbx)                                                                            \
    X(ucp_ep_create)                                                                               \
    X(ucp_ep_flush_nbx)                                                                            \
    X(ucp_ep_print_info)                                                                           \
    X(ucp_ep_rkey_unpack)                                                                          \
    X(ucp_init_version)                                                                            \
    X(ucp_mem_map)                                                                                 \
    X(ucp_mem_query)                                                                               \
    X(ucp_mem_unmap)                                                                               \
    X(ucp_put_nbx)                                                                                 \
    X(ucp_request_check_status)                                                                    \
    X(ucp_request_free)                                                                            \
    X(ucp_rkey_buffer_release)                                                                     \
    X(ucp_rkey_destroy)                                                                            \
    X(ucp_rkey_pack)                                                                               \
    X(ucp_rkey_ptr)                                                                                \
    X(ucp_worker_create)                                                                           \
    X(ucp_worker_destroy)                                                                          \
    X(ucp_worker_fence)                                                                            \
    X(ucp_worker_get_address)                                                                      \
    X(ucp_worker_progress)                                                                         \
    X(ucp_worker_release_address)                                                                  \
    X(ucp_worker_set_am_recv_handler)                                                              \
    X(ucs_global_opts_set_value)                                                                   \
    X(ucs_status_string)

#define UCX_MEMBER(call) __typeof__(call) *call;
typedef struct lar_ucx_calls {
    void *loaded;
    UCX_CALLS(UCX_MEMBER)
} lar_ucx_calls;
extern lar_ucx_calls lar_ucx;

/* Loads UCX if need be, for as long as the program runs, and leaves signals and terminal as they
 * are; what the environment says of that in UCX's own variables stands. */
lar_status lar_ucx_load(lar_error *error);

#endif
