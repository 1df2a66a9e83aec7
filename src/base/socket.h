/* Stream sockets with deadlines. All sockets are non-blocking, closed on exec, and never raise
 * SIGPIPE; times are those of lar_clock_seconds. */
#ifndef LAR_BASE_SOCKET_H
#define LAR_BASE_SOCKET_H

#include <stdbool.h>

#include "base/error.h"

enum { LAR_SOCKET_HOST_BYTES = 64 }; /* of a numeric address of a host */

typedef enum lar_socket_end {
    LAR_SOCKET_DONE,
    LAR_SOCKET_CLOSED, /* by the other side, or broken */
    LAR_SOCKET_LATE    /* the deadline has passed */
} lar_socket_end;

/* Whether an address has the form host:port, with a port of at least `min`. */
lar_status lar_socket_check(const char *address, int min, lar_error *error);
/* Listens at host:port; port 0 takes a free one. */
lar_status lar_socket_listen(const char *address, int *listener, lar_error *error);
/* The port that a listener got. */
int lar_socket_port(int listener);
/* Host of the other side, numeric, into host[LAR_SOCKET_HOST_BYTES]; "" when unknown. */
void lar_socket_peer_host(int socket, char *host);
/* An address of this machine that other machines can reach, numeric, into
 * host[LAR_SOCKET_HOST_BYTES]: what LARIAT_HOST says, what the machine's name stands for, or the
 * first network that is not the loopback. */
lar_status lar_socket_own_host(char *host, lar_error *error);

/* Connects, again and again while nobody listens there, until the deadline. */
lar_status lar_socket_connect(const char *address, double deadline, int *socket, lar_error *error);
/* Next connection; LAR_SOCKET_NOBODY at the deadline; -EINVAL when the listener was shut down, by
 * whoever else has it; -EBADF or -ENOTSOCK when it is none; -EMFILE or -ENFILE when there are no
 * numbers for sockets left. */
enum { LAR_SOCKET_NOBODY = -1 };
int lar_socket_accept(int listener, double deadline);

lar_socket_end lar_socket_send(int socket, const void *data, size_t bytes, double deadline);
lar_socket_end lar_socket_receive(int socket, void *data, size_t bytes, double deadline);

/* Whether the other side has ended the connection and everything it sent has been read. */
bool lar_socket_ended(int socket);

/* Waits until the socket can be read or written (POLLIN, POLLOUT) or the deadline. */
void lar_socket_poll(int socket, short events, double deadline);

#endif
