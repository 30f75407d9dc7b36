/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolves a host name on a thread of its own, because the system resolver has no timeout. All calls come from one thread. */
#ifndef VALUE_LOOKUP_H
#define VALUE_LOOKUP_H
#include <netdb.h>

struct lookup;

/* Starts a thread that resolves the host name `host`. Never returns NULL. */
struct lookup *lookup_start(const char *host, int port);
/* Waits for the addresses of the host until the deadline. Returns 0 with the list of addresses in *out, valid until
   lookup_destroy(). -ETIMEDOUT: not resolved yet, call again. -ECANCELED: stop_fd became readable. -EHOSTUNREACH: the host name
   does not resolve. */
int lookup_wait(struct lookup *lookup, int stop_fd, int64_t deadline_mono_ns, const struct addrinfo **out);
/* Frees the lookup without waiting for the system's resolver, and sets *lookup to NULL. *lookup may be NULL. */
void lookup_destroy(struct lookup **lookup);

/* Waits until the descriptor fd is ready for `events`. With fd -1, waits only for the deadline or stop_fd. Returns 0, -ETIMEDOUT at the
   deadline, or -ECANCELED if stop_fd became readable. */
int wait_for(int fd, short events, int stop_fd, int64_t deadline_mono_ns);

#endif
