/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The audit trail: a thread writes entries to the trail's file, the log and a syslog server. Only audit_wait() blocks on the
   file. While the file cannot be written, entries wait in memory, and the log and the metrics report the failure. */
#ifndef AUDIT_AUDIT_H
#define AUDIT_AUDIT_H
#include "audit/audit_chain.h"
#include "audit/audit_params.h"
#include "base/files/settling.h"

struct audit;
/* Opens the audit file and starts the thread. Returns NULL if that fails, already logged. */
struct audit *audit_start(const struct audit_params *params);
/* Writes the queued entries, if possible, and ends the thread. Accepts a pointer to NULL; sets *audit to NULL. */
void audit_stop(struct audit **audit);
/* This function and the next two tell whether the audit entries queued between audit_begin() and audit_end() are on disk
   (base/files/settling.h). None of the three functions blocks. audit NULL: the entries count as on disk. */
struct settling_ticket audit_begin(struct audit *audit);
void audit_end(struct audit *audit, struct settling_ticket *ticket);
int audit_settled(struct audit *audit, const struct settling_ticket *ticket);
/* Waits up to a second until audit_settled() knows the result, and returns that result. Call from any thread except the event
   loop, which must not block. */
int audit_wait(struct audit *audit, const struct settling_ticket *ticket);
/* Returns 0 if the last attempt to write the audit file succeeded, otherwise -errno. audit NULL: 0. */
int audit_error(const struct audit *audit);
/* Queues a copy of an entry for the audit trail. audit NULL: no-op. Call from any thread. */
void audit_say(struct audit *audit, const struct audit_entry *entry);

#endif
