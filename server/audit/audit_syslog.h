/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends audit lines to a syslog server: RFC 5424 over TLS (RFC 5425), on a thread of its own. While the server is unreachable,
   lines wait in memory up to a limit; further lines are counted and reported as lost. */
#ifndef AUDIT_AUDIT_SYSLOG_H
#define AUDIT_AUDIT_SYSLOG_H
#include "audit/audit_params.h"
#include "base/text/text.h"

struct audit_syslog;
/* Starts the thread that sends audit lines. Returns NULL if it cannot start, already logged. */
struct audit_syslog *audit_syslog_start(const struct audit_params *params);
/* Sends the queued lines, for a few seconds at most, then ends the thread. Accepts a pointer to NULL; sets *syslog to NULL. */
void audit_syslog_stop(struct audit_syslog **syslog);
/* Queues a copy of an audit line for sending. good: the audited action was done, not refused or failed. Call from any thread. */
void audit_syslog_send(struct audit_syslog *syslog, const char *event, bool good, int64_t utc_us, const char *line, size_t count);

struct syslog_message {
    const char *host; /* host name of this machine; "-" if unknown */
    int pid;
    const char *event;
    bool good; /* true: the audited action was done; false: it was refused or failed */
    int64_t utc_us;
    const char *line; /* the audit line to send: `count` bytes, not 0-terminated */
    size_t count;
};
/* Appends a syslog message to `out`, preceded by its length (octet counting, RFC 5425). No input or output. */
void audit_syslog_frame(struct text *out, const struct syslog_message *message);

#endif
