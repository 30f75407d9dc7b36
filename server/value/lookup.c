/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolves a host name with getaddrinfo() on a detached thread. The caller and that thread share the struct lookup; the last of
   the two to finish frees it. */
#include "value/lookup.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"

struct lookup {
    char *host, port[12];
    int done_fd; /* eventfd that becomes readable once the host name is resolved or cannot be */
    struct addrinfo *found;
    _Atomic int failed; /* result code of getaddrinfo(); written before done_fd becomes readable */
    _Atomic int users;
};

static void lookup_unref(struct lookup *lookup)
{
    if (atomic_fetch_sub(&lookup->users, 1) != 1)
        return;
    if (lookup->found)
        freeaddrinfo(lookup->found);
    close(lookup->done_fd);
    mem_free(lookup->host);
    mem_free(lookup);
}

static void *resolve(void *arg)
{
    struct lookup *lookup = arg;
    struct addrinfo hints = { .ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICSERV };
    lookup->failed = getaddrinfo(lookup->host, lookup->port, &hints, &lookup->found);
    eventfd_write(lookup->done_fd, 1);
    lookup_unref(lookup);
    return NULL;
}

struct lookup *lookup_start(const char *host, int port)
{
    pthread_t thread;
    struct lookup *lookup = mem_new(sizeof(*lookup));
    lookup->host = mem_strdup(host);
    snprintf(lookup->port, sizeof(lookup->port), "%d", port);
    lookup->done_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    lookup->users = 2;
    if (pthread_create(&thread, NULL, resolve, lookup) == 0)
        pthread_detach(thread);
    else
        resolve(lookup);
    return lookup;
}

void lookup_destroy(struct lookup **lookup)
{
    if (*lookup)
        lookup_unref(*lookup);
    *lookup = NULL;
}

int lookup_wait(struct lookup *lookup, int stop_fd, int64_t deadline_mono_ns, const struct addrinfo **out)
{
    int status = wait_for(lookup->done_fd, POLLIN, stop_fd, deadline_mono_ns);
    if (status)
        return status;
    if (lookup->failed)
        return -EHOSTUNREACH;
    *out = lookup->found;
    return 0;
}

int wait_for(int fd, short events, int stop_fd, int64_t deadline_mono_ns)
{
    for (;;) {
        struct pollfd fds[2] = { { .fd = stop_fd, .events = POLLIN }, { .fd = fd, .events = events } };
        int64_t left_ns = deadline_mono_ns - clock_mono_ns();
        int64_t left_ms = left_ns > 0 ? (left_ns + NS_PER_MS - 1) / NS_PER_MS : 0;
        int ready = poll(fds, 2, left_ms < 3600000 ? (int)left_ms : 3600000);
        if (ready > 0 && fds[0].revents)
            return -ECANCELED;
        if (ready > 0)
            return 0;
        if (left_ms == 0)
            return -ETIMEDOUT;
    }
}
