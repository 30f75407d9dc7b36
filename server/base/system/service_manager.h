/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a service says to the service manager that started it: its state (the protocol of sd_notify) and entries of the journal (its native
   protocol). Both are documented and stable, and need no library. Without a service manager, nothing is sent. Thread: any. */
#ifndef BASE_SYSTEM_SERVICE_MANAGER_H
#define BASE_SYSTEM_SERVICE_MANAGER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Sends lines such as "READY=1\nSTATUS=..." to the socket that NOTIFY_SOCKET names. Returns whether somebody got them. */
bool service_notify(const char *fmt, ...) __attribute__((format(printf, 1, 2)));
/* Returns within what time the manager wants a sign of life again and again (WATCHDOG_USEC, if meant for this process); 0: it does not. */
int64_t service_watchdog_ns(void);
/* Starts a thread that asks the manager every few seconds to wait longer, for what takes long before the service is ready, and has it
   show that status. It stops asking while neither this process nor those of its session use a processor, and once one status has lasted
   longer than limit_s, so that a manager ends a start that hangs. Returns NULL if nobody is there to be asked; service_patience_end() takes
   that too. status is copied. */
struct service_patience;
struct service_patience *service_patience_begin(const char *status, int limit_s);
void service_patience_status(struct service_patience *patience, const char *status); /* from now on; NULL patience is fine */
void service_patience_end(struct service_patience **patience);                       /* leaves NULL */

/* Returns the listening socket that the manager has opened and handed over (LISTEN_FDS, if meant for this process), which is the caller's
   from now on; -1: none; -EINVAL: more than one. */
int service_take_socket(void);

/* Returns whether that descriptor is the journal's (JOURNAL_STREAM). */
bool service_is_journal(int fd);
struct service_field {
    const char *name, *value; /* NAME in capitals; value NULL: left out */
};
#define SERVICE_JOURNAL_SOCKET "/run/systemd/journal/socket"
/* Sends one entry to the journal's socket at that path. Returns false if it was not taken. */
bool service_journal_send(const char *socket_path, const struct service_field *fields, size_t count);

#endif
