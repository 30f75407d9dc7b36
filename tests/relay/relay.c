/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simulates a slow link: forwards TCP connections to a port of this machine, limits the bytes per second that come from that
   port, and delays both directions. Its socket buffers are small, so that data beyond the limit waits at the sender, as on a
   real link. Runs until its standard input ends. usage: relay PORT BYTES_PER_S DELAY_MS (prints "relay: listening PORT") */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"

enum { MAX_LINKS = 64, CHUNK_BYTES = 1024, CHUNKS = 4096, SOCKET_BYTES = 8192 };

struct relay_chunk {
    int64_t due_ns;
    int count, sent;
    char bytes[CHUNK_BYTES];
};

struct relay_direction { /* one direction of a forwarded connection, with a ring buffer of chunks that wait for their delay */
    int from, to;
    double bytes_per_s; /* maximum number of bytes per second; 0: no limit */
    int64_t free_ns;    /* monotonic time in nanoseconds before which no further byte is read, to keep the limit */
    unsigned first, count;
    struct relay_chunk *chunks;
};

struct relay_link {
    bool open;
    struct relay_direction down, up;
};

static int64_t delay_ns;

static void make_small(int fd)
{
    int bytes = SOCKET_BYTES;
    setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof(bytes));
    setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof(bytes));
}

static struct sockaddr_in local(int port)
{
    return (struct sockaddr_in){ .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
}

static int listen_on_any(int *port)
{
    struct sockaddr_in address = local(0);
    socklen_t size = sizeof(address);
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    make_small(fd);
    if (bind(fd, (struct sockaddr *)&address, size) != 0 || listen(fd, MAX_LINKS) != 0 ||
        getsockname(fd, (struct sockaddr *)&address, &size) != 0)
        return -1;
    *port = ntohs(address.sin_port);
    return fd;
}

static bool way_open(struct relay_direction *way, int from, int to, double bytes_per_s)
{
    *way =
        (struct relay_direction){ .from = from, .to = to, .bytes_per_s = bytes_per_s, .chunks = mem_array(CHUNKS, sizeof(*way->chunks)) };
    return fcntl(from, F_SETFL, O_NONBLOCK) == 0;
}

static void link_close(struct relay_link *link)
{
    close(link->down.from);
    close(link->up.from);
    mem_free(link->down.chunks);
    mem_free(link->up.chunks);
    link->open = false;
}

static void link_open(struct relay_link *link, int client, int port, double bytes_per_s)
{
    struct sockaddr_in address = local(port);
    int server = socket(AF_INET, SOCK_STREAM, 0);
    make_small(server);
    make_small(client);
    link->open = connect(server, (struct sockaddr *)&address, sizeof(address)) == 0;
    link->open = way_open(&link->down, server, client, bytes_per_s) && way_open(&link->up, client, server, 0) && link->open;
    if (!link->open)
        link_close(link);
}

/* Reads chunks from the sender as far as the limit and the buffer allow. Returns false if the sender has closed the connection.
   */
static bool take(struct relay_direction *way, int64_t now_ns)
{
    while (way->count < CHUNKS && now_ns >= way->free_ns) {
        struct relay_chunk *chunk = &way->chunks[(way->first + way->count) % CHUNKS];
        ssize_t n = recv(way->from, chunk->bytes, CHUNK_BYTES, 0);
        if (n <= 0)
            return n < 0 && (errno == EAGAIN || errno == EINTR);
        int64_t begin_ns = way->free_ns > now_ns - NS_PER_MS ? way->free_ns : now_ns;
        way->free_ns = begin_ns + (way->bytes_per_s > 0 ? (int64_t)((double)n / way->bytes_per_s * 1e9) : 0);
        chunk->count = (int)n;
        chunk->sent = 0;
        chunk->due_ns = way->free_ns + delay_ns;
        way->count++;
    }
    return true;
}

/* Sends the chunks whose delay is over. Returns false if the receiver has closed the connection. */
static bool give(struct relay_direction *way, int64_t now_ns)
{
    while (way->count > 0) {
        struct relay_chunk *chunk = &way->chunks[way->first];
        if (chunk->due_ns > now_ns)
            return true;
        ssize_t n = send(way->to, chunk->bytes + chunk->sent, (size_t)(chunk->count - chunk->sent), MSG_NOSIGNAL | MSG_DONTWAIT);
        if (n < 0)
            return errno == EAGAIN || errno == EINTR;
        chunk->sent += (int)n;
        if (chunk->sent < chunk->count)
            return true;
        way->first = (way->first + 1) % CHUNKS;
        way->count--;
    }
    return true;
}

static bool serve(struct relay_link *link)
{
    int64_t now_ns = clock_mono_ns();
    return take(&link->down, now_ns) && take(&link->up, now_ns) && give(&link->down, now_ns) && give(&link->up, now_ns);
}

static void accept_one(int listener, struct relay_link *links, int port, double bytes_per_s)
{
    int client = accept(listener, NULL, NULL);
    for (int i = 0; client >= 0 && i < MAX_LINKS; i++) {
        if (links[i].open)
            continue;
        link_open(&links[i], client, port, bytes_per_s);
        return;
    }
    if (client >= 0)
        close(client);
}

int main(int argc, char **argv)
{
    static struct relay_link links[MAX_LINKS];
    int port = 0, listener = argc == 4 ? listen_on_any(&port) : -1;
    if (listener < 0) {
        fprintf(stderr, "usage: relay PORT BYTES_PER_S DELAY_MS\n");
        return 2;
    }
    delay_ns = atoll(argv[3]) * NS_PER_MS;
    printf("relay: listening %d\n", port);
    fflush(stdout);
    for (char byte = 1; byte;) {
        struct pollfd waits[2] = { { .fd = listener, .events = POLLIN }, { .fd = STDIN_FILENO, .events = POLLIN } };
        poll(waits, 2, 1); /* a timeout of 1 ms is fine enough for the delays and limits of all tests */
        if (waits[0].revents)
            accept_one(listener, links, atoi(argv[1]), atof(argv[2]));
        if (waits[1].revents && read(STDIN_FILENO, &byte, 1) <= 0)
            byte = 0;
        for (int i = 0; i < MAX_LINKS; i++)
            if (links[i].open && !serve(&links[i]))
                link_close(&links[i]);
    }
    return 0;
}
