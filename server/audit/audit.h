/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The audit trail: a thread writes entries to the trail's file, the log and a syslog server. Only audit_wait() waits for the file. While
   the file cannot be written, entries wait in memory, and the log and the metrics say so. */
#ifndef AUDIT_AUDIT_H
#define AUDIT_AUDIT_H
#include "audit/audit_chain.h"
#include "audit/audit_params.h"
#include "base/files/settling.h"

struct audit;
/* Opens the file and starts the thread. Returns NULL if that fails, already logged. */
struct audit *audit_start(const struct audit_params *params);
/* Writes what waits, if it can be written, and ends. &NULL is fine; leaves NULL. */
void audit_stop(struct audit **audit);
/* Tell whether entries that are recorded between begin and end are on disk (base/files/settling.h); none waits. audit NULL: they are. */
struct settling_ticket audit_begin(struct audit *audit);
void audit_end(struct audit *audit, struct settling_ticket *ticket);
int audit_settled(struct audit *audit, const struct settling_ticket *ticket);
/* Waits until audit_settled() knows, a second at most, and returns the same. Any thread but the loop. */
int audit_wait(struct audit *audit, const struct settling_ticket *ticket);
/* Records an entry, which is copied. audit NULL: does nothing. Any thread. */
void audit_say(struct audit *audit, const struct audit_entry *entry);

#endif
