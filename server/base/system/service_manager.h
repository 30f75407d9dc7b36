/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages to the service manager that started this service: its state (sd_notify protocol) and journal entries (native journal
   protocol). Both protocols are documented and stable, and need no library. Without a service manager nothing is sent. Call
   from any thread. */
#ifndef BASE_SYSTEM_SERVICE_MANAGER_H
#define BASE_SYSTEM_SERVICE_MANAGER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Sends lines such as "READY=1 STATUS=..." to the socket in NOTIFY_SOCKET. Returns true if the message was delivered. */
bool service_notify(const char *fmt, ...) __attribute__((format(printf, 1, 2)));
/* Returns the interval in nanoseconds within which the manager expects the next watchdog message (WATCHDOG_USEC, if meant for
   this process); 0: no watchdog. */
int64_t service_watchdog_ns(void);
/* Starts a thread that covers long work before the service is ready: every few seconds it asks the manager to wait longer and
   shows `status`. So that the manager kills a hanging start, it stops asking while no process of this session uses CPU time,
   and once a status is older than limit_s. Returns NULL if there is no service manager; service_patience_end() accepts that.
   `status` is copied. */
struct service_patience;
struct service_patience *service_patience_begin(const char *status, int limit_s);
/* Changes the status text that the thread of service_patience_begin() shows; a NULL patience is a no-op. */
void service_patience_status(struct service_patience *patience, const char *status);
void service_patience_end(struct service_patience **patience); /* Ends the thread and sets *patience to NULL. */

/* Returns the listening socket that the manager has opened and passed on (LISTEN_FDS, if meant for this process); the caller
   owns it now. -1: none; -EINVAL: more than one. */
int service_take_socket(void);

/* Returns true if the descriptor is connected to the journal (JOURNAL_STREAM). */
bool service_is_journal(int fd);
struct service_field {
    const char *name, *value; /* name: field name in capitals, such as MESSAGE_ID; value NULL: the field is omitted */
};
#define SERVICE_JOURNAL_SOCKET "/run/systemd/journal/socket"
/* Sends one entry to the journal's socket at socket_path. Returns false if the entry could not be delivered. */
bool service_journal_send(const char *socket_path, const struct service_field *fields, size_t count);

#endif
