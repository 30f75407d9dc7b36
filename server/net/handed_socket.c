/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Accepts connections from a listening socket that systemd passed. libwebsockets 4.1 can only listen on its own sockets, so this one is
   registered as a plain file, and each accepted connection is adopted. */
#include "net/handed_socket.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "net/connection.h"

enum { ACCEPTED_AT_ONCE = 16 };

bool handed_socket_find(int fd, char address[HANDED_ADDRESS_BYTES], int *port)
{
    struct sockaddr_storage at;
    socklen_t length = sizeof(at), size = sizeof(int);
    int listens = 0;
    if (getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &size) != 0 || !listens ||
        getsockname(fd, (struct sockaddr *)&at, &length) != 0)
        return false;
    const struct sockaddr_in *four = (const struct sockaddr_in *)&at;
    const struct sockaddr_in6 *six = (const struct sockaddr_in6 *)&at;
    bool is_six = at.ss_family == AF_INET6;
    *port = ntohs(is_six ? six->sin6_port : four->sin_port);
    return (is_six || at.ss_family == AF_INET) &&
           inet_ntop(at.ss_family, is_six ? (const void *)&six->sin6_addr : &four->sin_addr, address, HANDED_ADDRESS_BYTES) != NULL;
}

bool handed_socket_listen(struct net *net)
{
    int fd = net->server.params.socket_fd;
    lws_sock_file_fd_type file = { .filefd = fd };
    bool good = fcntl(fd, F_SETFL, O_NONBLOCK) == 0 &&
                lws_adopt_descriptor_vhost(net->vhost, LWS_ADOPT_RAW_FILE_DESC, file, HANDED_PROTOCOL, NULL) != NULL;
    if (!good)
        log_err(net->server.params.log, "the socket passed by the service manager cannot be used: %s", strerror(errno));
    return good;
}

int handed_socket_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    (void)user, (void)in, (void)len;
    if (reason != LWS_CALLBACK_RAW_RX_FILE)
        return 0;
    struct server_context *server = server_context_of(wsi);
    if (atomic_load(&lws_container_of(server, struct net, server)->stopping)) {
        /* stops accepting connections while the daemon stops: new ones wait in the listening socket until the next start */
        lws_rx_flow_control(wsi, 0);
        return 0;
    }
    for (int i = 0; i < ACCEPTED_AT_ONCE; i++) {
        int fd = accept4(server->params.socket_fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
        if (fd < 0)
            break;
        if (connection_may_open(server, fd))
            lws_adopt_socket_vhost(lws_get_vhost(wsi), fd); /* libwebsockets closes the accepted socket itself if adopting it fails */
        else
            close(fd);
    }
    return 0;
}
