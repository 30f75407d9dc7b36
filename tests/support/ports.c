/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reserves port numbers for programs that cannot choose a free port themselves. */
#include "tests/support/ports.h"

#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

/* The same numbers as in tests/e2e/support/ports.mjs, so that C and JavaScript tests share the locks. The ports lie below
   32768, where the system's range for outgoing connections (net.ipv4.ip_local_port_range) begins. */
enum { FIRST = 20000, COUNT = 1500, EACH = 4, LOCKS = FIRST + COUNT * EACH };

static int listen_at(int port, in_addr_t address)
{
    struct sockaddr_in at = { .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(address) };
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd >= 0 && bind(fd, (struct sockaddr *)&at, sizeof(at)) == 0 && listen(fd, 1) == 0)
        return fd;
    if (fd >= 0)
        close(fd);
    return -1;
}

int free_port(void)
{
    for (int tries = 0; tries < COUNT; tries++) {
        unsigned chance = 0;
        if (getrandom(&chance, sizeof(chance), 0) != sizeof(chance))
            break;
        /* a listening socket serves as the lock of this group of ports; it is held until the process ends, however it ends */
        int n = (int)(chance % COUNT), lock = listen_at(LOCKS + n, INADDR_LOOPBACK);
        if (lock < 0)
            continue;
        /* also tries to listen on the port itself, because a program that does not use these locks may have it */
        int probe = listen_at(FIRST + n * EACH, INADDR_ANY);
        if (probe >= 0) {
            close(probe);
            return FIRST + n * EACH;
        }
        close(lock);
    }
    fprintf(stderr, "no port is free\n");
    abort();
}
