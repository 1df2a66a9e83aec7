#include "base/socket.h"

#include <errno.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"

enum { BACKLOG = 4096 }; /* who may wait to be accepted; the system has a limit of its own */

/* A number that is no port would be cut to 16 bits, and be another one. Names are looked up. */
static bool is_port(const char *text, int min) {
    char *rest;
    long port = strtol(text, &rest, 10);
    if (rest == text) return true;
    return *rest == '\0' && *text != '+' && port >= min && port <= 65535;
}

lar_status lar_socket_check(const char *address, int min, lar_error *error) {
    const char *colon = strrchr(address, ':');
    if (!colon || !colon[1])
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s is no address; write host:port, as in localhost:7077", address);
    if (is_port(colon + 1, min)) return LAR_OK;
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "%s is no address: a port is a number from %d to 65535, as in localhost:7077",
                    address, min);
}

/* "host:port" or "[v6]:port" to addresses; the caller frees with freeaddrinfo. */
static lar_status look_up(const char *address, bool passive, struct addrinfo **found,
                          lar_error *error) {
    char host[256];
    lar_status status = lar_socket_check(address, passive ? 0 : 1, error);
    if (status) return status;
    const char *colon = strrchr(address, ':');
    size_t length = (size_t)(colon - address);
    const char *begin = address;
    if (length >= 2 && begin[0] == '[' && begin[length - 1] == ']') begin++, length -= 2;
    if (length == 0 || length >= sizeof host)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s is no address; write host:port, as in localhost:7077", address);
    memcpy(host, begin, length);
    host[length] = '\0';
    struct addrinfo hints = {.ai_socktype = SOCK_STREAM, .ai_flags = passive ? AI_PASSIVE : 0};
    int failed = getaddrinfo(host, colon + 1, &hints, found);
    if (failed)
        return lar_fail(error, LAR_ERROR_IO,
                        "the address %s cannot be found: %s; check host and port", address,
                        gai_strerror(failed));
    return LAR_OK;
}

static void prepare(int socket) {
    int on = 1;
    fcntl(socket, F_SETFL, fcntl(socket, F_GETFL) | O_NONBLOCK);
    fcntl(socket, F_SETFD, FD_CLOEXEC);
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

lar_status lar_socket_listen(const char *address, int *listener, lar_error *error) {
    struct addrinfo *found;
    lar_status status = look_up(address, true, &found, error);
    if (status) return status;
    int fd = socket(found->ai_family, found->ai_socktype, found->ai_protocol), on = 1;
    bool good = fd >= 0;
    if (good) {
        prepare(fd);
        setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
        good = bind(fd, found->ai_addr, found->ai_addrlen) == 0 && listen(fd, BACKLOG) == 0;
    }
    freeaddrinfo(found);
    if (good) {
        *listener = fd;
        return LAR_OK;
    }
    status = lar_fail(error, LAR_ERROR_IO,
                      "cannot listen at %s: %s; take another port or an address of "
                      "this machine",
                      address, strerror(errno));
    if (fd >= 0) close(fd);
    return status;
}

int lar_socket_port(int listener) {
    struct sockaddr_storage at;
    socklen_t length = sizeof at;
    if (getsockname(listener, (struct sockaddr *)&at, &length)) return 0;
    if (at.ss_family == AF_INET6)
        return ntohs(((const struct sockaddr_in6 *)(const void *)&at)->sin6_port);
    return ntohs(((const struct sockaddr_in *)(const void *)&at)->sin_port);
}

void lar_socket_peer_host(int socket, char *host) {
    struct sockaddr_storage at;
    socklen_t length = sizeof at;
    host[0] = '\0';
    if (getpeername(socket, (struct sockaddr *)&at, &length) == 0 &&
        getnameinfo((struct sockaddr *)&at, length, host, LAR_SOCKET_HOST_BYTES, NULL, 0,
                    NI_NUMERICHOST) != 0)
        host[0] = '\0';
}

/* Numeric, when it is an address that others can reach: no loopback, none of one wire only. */
static bool reachable(const struct sockaddr *at, char *host) {
    socklen_t length = sizeof(struct sockaddr_in);
    if (at->sa_family == AF_INET6) {
        const struct in6_addr *six = &((const struct sockaddr_in6 *)(const void *)at)->sin6_addr;
        if (IN6_IS_ADDR_LOOPBACK(six) || IN6_IS_ADDR_LINKLOCAL(six)) return false;
        length = sizeof(struct sockaddr_in6);
    } else if (at->sa_family != AF_INET ||
               ntohl(((const struct sockaddr_in *)(const void *)at)->sin_addr.s_addr) >> 24 ==
                   127) {
        return false;
    }
    return getnameinfo(at, length, host, LAR_SOCKET_HOST_BYTES, NULL, 0, NI_NUMERICHOST) == 0;
}

lar_status lar_socket_own_host(char *host, lar_error *error) {
    const char *said = getenv("LARIAT_HOST");
    if (said && *said && strlen(said) < LAR_SOCKET_HOST_BYTES) {
        memcpy(host, said, strlen(said) + 1);
        return LAR_OK;
    }
    char name[256];
    bool found = false;
    struct addrinfo hints = {.ai_socktype = SOCK_STREAM}, *named = NULL;
    if (gethostname(name, sizeof name - 1) == 0) getaddrinfo(name, NULL, &hints, &named);
    for (const struct addrinfo *a = named; a && !found; a = a->ai_next)
        found = reachable(a->ai_addr, host);
    if (named) freeaddrinfo(named);
    struct ifaddrs *all = NULL;
    if (!found && getifaddrs(&all)) all = NULL;
    static const int families[] = {AF_INET, AF_INET6};
    for (int i = 0; i < 2; i++)
        for (const struct ifaddrs *a = all; a && !found; a = a->ifa_next)
            found = a->ifa_addr && a->ifa_addr->sa_family == families[i] &&
                    (a->ifa_flags & IFF_UP) && reachable(a->ifa_addr, host);
    if (all) freeifaddrs(all);
    if (found) return LAR_OK;
    return lar_fail(error, LAR_ERROR_IO,
                    "this machine has no address that others can reach; set LARIAT_HOST to one");
}

void lar_socket_poll(int socket, short events, double deadline) {
    double left = deadline - lar_clock_seconds();
    struct pollfd one = {.fd = socket, .events = events};
    if (left > 0) poll(&one, 1, left > 60 ? 60000 : (int)(1e3 * left) + 1);
}

/* One attempt at one address. */
static int connect_once(const struct addrinfo *to, double deadline) {
    int fd = socket(to->ai_family, to->ai_socktype, to->ai_protocol);
    if (fd < 0) return -1;
    prepare(fd);
    int broken = 0;
    socklen_t length = sizeof broken;
    if (connect(fd, to->ai_addr, to->ai_addrlen) != 0) {
        if (errno != EINPROGRESS) {
            broken = errno;
        } else {
            lar_socket_poll(fd, POLLOUT, deadline);
            struct pollfd one = {.fd = fd, .events = POLLOUT};
            if (poll(&one, 1, 0) != 1)
                broken = ETIMEDOUT;
            else
                getsockopt(fd, SOL_SOCKET, SO_ERROR, &broken, &length);
        }
    }
    if (!broken) return fd;
    close(fd);
    errno = broken;
    return -1;
}

lar_status lar_socket_connect(const char *address, double deadline, int *connected,
                              lar_error *error) {
    struct addrinfo *found;
    lar_status status = look_up(address, false, &found, error);
    if (status) return status;
    int fd = -1, reason = 0;
    while (fd < 0) {
        for (const struct addrinfo *to = found; to && fd < 0; to = to->ai_next)
            if ((fd = connect_once(to, deadline)) < 0) reason = errno;
        if (fd >= 0 || lar_clock_seconds() > deadline) break;
        nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    }
    freeaddrinfo(found);
    if (fd < 0)
        return lar_fail(error, LAR_ERROR_PEER,
                        "nobody answers at %s: %s; see that the program there runs, and check the "
                        "address",
                        address, strerror(reason));
    *connected = fd;
    return LAR_OK;
}

int lar_socket_accept(int listener, double deadline) {
    for (;;) {
        int fd = accept(listener, NULL, NULL);
        if (fd >= 0) {
            prepare(fd);
            return fd;
        }
        int reason = errno;
        bool broken = reason == EINVAL || reason == EBADF || reason == ENOTSOCK;
        if (broken || reason == EMFILE || reason == ENFILE) return -reason;
        if (lar_clock_seconds() > deadline) return LAR_SOCKET_NOBODY;
        if (reason == EAGAIN || reason == EWOULDBLOCK)
            lar_socket_poll(listener, POLLIN, deadline);
        else if (reason != EINTR && reason != ECONNABORTED)
            nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
}

lar_socket_end lar_socket_send(int socket, const void *data, size_t bytes, double deadline) {
    const char *at = data;
    while (bytes > 0) {
        ssize_t sent = send(socket, at, bytes, MSG_NOSIGNAL);
        if (sent > 0) {
            at += sent;
            bytes -= (size_t)sent;
            continue;
        }
        if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)
            return LAR_SOCKET_CLOSED;
        if (lar_clock_seconds() > deadline) return LAR_SOCKET_LATE;
        lar_socket_poll(socket, POLLOUT, deadline);
    }
    return LAR_SOCKET_DONE;
}

lar_socket_end lar_socket_receive(int socket, void *data, size_t bytes, double deadline) {
    char *at = data;
    while (bytes > 0) {
        ssize_t got = recv(socket, at, bytes, 0);
        if (got > 0) {
            at += got;
            bytes -= (size_t)got;
            continue;
        }
        if (got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR))
            return LAR_SOCKET_CLOSED;
        if (lar_clock_seconds() > deadline) return LAR_SOCKET_LATE;
        lar_socket_poll(socket, POLLIN, deadline);
    }
    return LAR_SOCKET_DONE;
}

bool lar_socket_ended(int socket) {
    char byte;
    ssize_t got = recv(socket, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    return got == 0 || (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}
