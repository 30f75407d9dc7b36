/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the audit trail goes. */
#ifndef AUDIT_AUDIT_PARAMS_H
#define AUDIT_AUDIT_PARAMS_H
#include <stddef.h>

#include "base/log/log.h"
#include "base/metrics/counters.h"

struct audit_params {
    struct log *log;
    struct counters *counters;
    const char *path;                         /* of the trail's file */
    size_t most_bytes;                        /* a file that has so many is rotated; 0: 64 MB */
    const char *syslog;                       /* HOST[:PORT] of a server of syslog over TLS; NULL: none */
    const char *syslog_ca;                    /* certificates that are trusted with it, PEM; NULL: the machine's own */
    const char *syslog_cert, *syslog_key;     /* our certificate for it, PEM; NULL: none */
};

#endif
