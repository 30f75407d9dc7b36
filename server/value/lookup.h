/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A host name turned into addresses on a thread of its own, because the system's resolver knows no deadline. Thread: one. */
#ifndef VALUE_LOOKUP_H
#define VALUE_LOOKUP_H
#include <netdb.h>

struct lookup;

/* Never NULL. */
struct lookup *lookup_start(const char *host, int port);
/* 0: *out is the list of addresses, valid until lookup_destroy. -ETIMEDOUT: not yet, ask again. -ECANCELED: stop_fd became
   readable. -EHOSTUNREACH: there is no such host. */
int lookup_wait(struct lookup *lookup, int stop_fd, int64_t deadline_mono_ns, const struct addrinfo **out);
/* Does not wait for the resolver. &NULL is fine; leaves NULL. */
void lookup_destroy(struct lookup **lookup);

/* Waits until fd can do `events` (fd -1: just waits). 0, -ETIMEDOUT, or -ECANCELED when stop_fd became readable. */
int wait_for(int fd, short events, int stop_fd, int64_t deadline_mono_ns);

#endif
