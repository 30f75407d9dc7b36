/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The audit trail: a thread writes entries to the trail's file, the log and a syslog server. Only audit_settle() waits for the file. While
   the file cannot be written, entries wait in memory, and the log and the metrics say so. */
#ifndef AUDIT_AUDIT_H
#define AUDIT_AUDIT_H
#include "audit/audit_chain.h"
#include "audit/audit_params.h"

struct audit;
/* Opens the file and starts the thread. Returns NULL if that fails, already logged. */
struct audit *audit_start(const struct audit_params *params);
/* Writes what waits, if it can be written, and ends. &NULL is fine; leaves NULL. */
void audit_stop(struct audit **audit);
/* Waits up to a second until all recorded entries are on disk. Returns 0 or -errno; audit NULL: 0. Any thread. */
int audit_settle(struct audit *audit);
/* Records an entry, which is copied. audit NULL: does nothing. Any thread. */
void audit_say(struct audit *audit, const struct audit_entry *entry);

#endif
