/* SPDX-License-Identifier: GPL-3.0-or-later */
/* LD_PRELOAD library: sockets of the peer with the IPv4 address LATE_PEER become writable only LATE_MS after poll() was first
   asked about it, as if the peer's network were slow. */
#undef _FORTIFY_SOURCE /* otherwise, glibc's header would define poll() inline, and this file could not replace it */
#include <arpa/inet.h>
#include <dlfcn.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#define EXPORTED __attribute__((visibility("default")))
#define FDS 4096

/* by socket number: time at which poll() was first asked, after the last write, whether the socket is writable; 0: not asked */
static atomic_llong asked_ms[FDS];

static long long now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000LL + now.tv_nsec / 1000000;
}

static bool is_late_peer(int fd)
{
    const char *peer = getenv("LATE_PEER");
    struct sockaddr_storage address = { 0 };
    struct sockaddr_in *ipv4 = (struct sockaddr_in *)&address;
    const struct sockaddr_in6 *ipv6 = (const struct sockaddr_in6 *)&address;
    socklen_t size = sizeof(address);
    uint32_t from = 0;
    if (!peer || fd < 0 || fd >= FDS || getpeername(fd, (struct sockaddr *)&address, &size) != 0)
        return false;
    if (address.ss_family == AF_INET)
        from = ipv4->sin_addr.s_addr;
    else if (address.ss_family == AF_INET6) /* an IPv4-mapped IPv6 address */
        memcpy(&from, ipv6->sin6_addr.s6_addr + 12, sizeof(from));
    return from == inet_addr(peer);
}

static long long late_ms(void)
{
    const char *text = getenv("LATE_MS");
    return text ? atoll(text) : 0;
}

/* Returns for how many more milliseconds the socket must be reported as not writable; 0 or less: it may be reported. */
static long long wait_ms(int fd)
{
    long long now = now_ms(), none = 0;
    atomic_compare_exchange_strong(&asked_ms[fd], &none, now);
    return asked_ms[fd] + late_ms() - now;
}

EXPORTED int poll(struct pollfd *fds, nfds_t count, int timeout_ms)
{
    static int (*real)(struct pollfd *, nfds_t, int);
    short *events = calloc(count + 1, sizeof(*events));
    if (!real)
        *(void **)&real = dlsym(RTLD_NEXT, "poll");
    for (nfds_t i = 0; i < count; i++) {
        events[i] = fds[i].events;
        if ((fds[i].events & POLLOUT) && is_late_peer(fds[i].fd)) {
            long long wait = wait_ms(fds[i].fd);
            if (wait > 0) {
                fds[i].events &= (short)~POLLOUT;
                timeout_ms = timeout_ms < 0 || timeout_ms > wait ? (int)wait : timeout_ms;
            }
        }
    }
    int result = real(fds, count, timeout_ms);
    for (nfds_t i = 0; i < count; i++) {
        fds[i].events = events[i];
        if (result > 0 && (fds[i].revents & (POLLOUT | POLLHUP)) && fds[i].fd >= 0 && fds[i].fd < FDS)
            asked_ms[fds[i].fd] = 0;
    }
    free(events);
    return result;
}
