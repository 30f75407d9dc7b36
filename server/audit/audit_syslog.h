/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends lines to a syslog server: RFC 5424 over TLS (RFC 5425), on a thread of its own. While the server is away, lines wait in memory, up
   to a limit; what does not fit is counted and said. */
#ifndef AUDIT_AUDIT_SYSLOG_H
#define AUDIT_AUDIT_SYSLOG_H
#include "audit/audit_params.h"
#include "base/text/text.h"

struct audit_syslog;
/* Returns NULL if there is no thread, already logged. */
struct audit_syslog *audit_syslog_start(const struct audit_params *params);
/* Sends what waits, for a few seconds at most, and ends. &NULL is fine; leaves NULL. */
void audit_syslog_stop(struct audit_syslog **syslog);
/* Hands over a line, which is copied. Any thread. */
void audit_syslog_send(struct audit_syslog *syslog, const char *event, bool good, int64_t utc_us, const char *line, size_t count);

/* Appends a message with its length in front, as a server reads it from a stream. host: "-" if it is not known. Pure. */
void audit_syslog_frame(struct text *out, const char *host, int pid, const char *event, bool good, int64_t utc_us, const char *line,
                        size_t count);

#endif
