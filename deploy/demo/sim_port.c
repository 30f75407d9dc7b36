/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serves several listeners and their clients with one poll(). */
#include "sim_port.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"

int sim_port_open(struct sim_port *port, const char *address, int number, sim_take *take, void *arg)
{
    struct sockaddr_in at = { .sin_family = AF_INET, .sin_port = htons((uint16_t)number) };
    int on = 1, status = 0;
    *port = (struct sim_port){ .fd = -1, .take = take, .arg = arg };
    if (inet_pton(AF_INET, address, &at.sin_addr) != 1)
        return -EINVAL;
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0)
        return -errno;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
    if (bind(fd, (struct sockaddr *)&at, sizeof(at)) != 0 || listen(fd, SIM_PORT_CLIENTS) != 0) {
        status = -errno;
        close(fd);
    } else {
        port->fd = fd;
    }
    return status;
}

void sim_port_close(struct sim_port *port)
{
    while (port->client_count)
        close(port->clients[--port->client_count].fd);
    if (port->fd >= 0)
        close(port->fd);
    port->fd = -1;
}

static void admit(struct sim_port *port)
{
    int on = 1, fd = accept4(port->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0)
        return;
    if (port->client_count == SIM_PORT_CLIENTS) {
        close(fd);
        return;
    }
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    struct sim_client *client = &port->clients[port->client_count++];
    client->fd = fd;
    client->count = 0;
}

/* Handles the bytes of a client. Returns false if the connection has ended. */
static int serve_client(struct sim_port *port, struct sim_client *client)
{
    ssize_t got = recv(client->fd, client->bytes + client->count, SIM_PORT_BYTES - client->count, 0), used;
    if (got <= 0)
        return got < 0 && (errno == EAGAIN || errno == EINTR);
    client->count += (size_t)got;
    while ((used = port->take(port->arg, client->fd, client->bytes, client->count)) > 0) {
        client->count -= (size_t)used;
        memmove(client->bytes, client->bytes + used, client->count);
    }
    return used == 0 && client->count < SIM_PORT_BYTES;
}

static void serve_port(struct sim_port *port, const struct pollfd *fds)
{
    for (size_t i = port->client_count; i-- > 0;)
        if (fds[1 + i].revents && !serve_client(port, &port->clients[i])) {
            close(port->clients[i].fd);
            port->clients[i] = port->clients[--port->client_count];
        }
    if (fds[0].revents)
        admit(port);
}

static size_t gather(const struct sim_port *port, struct pollfd *fds)
{
    fds[0] = (struct pollfd){ .fd = port->fd, .events = POLLIN };
    for (size_t i = 0; i < port->client_count; i++)
        fds[1 + i] = (struct pollfd){ .fd = port->clients[i].fd, .events = POLLIN };
    return 1 + port->client_count;
}

int sim_ports_serve(struct sim_port *ports, size_t count, int extra_fd, int timeout_ms)
{
    int64_t end_ns = clock_mono_ns() + timeout_ms * NS_PER_MS;
    struct pollfd *fds = mem_array(1 + count * (1 + SIM_PORT_CLIENTS), sizeof(*fds));
    int extra = 0;
    for (int64_t left_ns = end_ns - clock_mono_ns(); !extra && left_ns > 0; left_ns = end_ns - clock_mono_ns()) {
        size_t used = 1;
        fds[0] = (struct pollfd){ .fd = extra_fd, .events = POLLIN };
        for (size_t i = 0; i < count; i++)
            used += gather(&ports[i], fds + used);
        if (poll(fds, (nfds_t)used, (int)((left_ns + NS_PER_MS - 1) / NS_PER_MS)) <= 0)
            continue;
        extra = fds[0].revents != 0;
        used = 1;
        for (size_t i = 0; i < count; i++) {
            size_t of_port = 1 + ports[i].client_count;
            serve_port(&ports[i], fds + used);
            used += of_port;
        }
    }
    mem_free(fds);
    return extra;
}
