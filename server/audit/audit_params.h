/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the audit trail is written: file and syslog server. */
#ifndef AUDIT_AUDIT_PARAMS_H
#define AUDIT_AUDIT_PARAMS_H
#include <stddef.h>

#include "base/log/log.h"
#include "base/metrics/counters.h"

struct audit_params {
    struct log *log;
    struct counters *counters;
    const char *path;                     /* path of the trail's file */
    size_t most_bytes;                    /* bytes at which the file is rotated; 0: 64 MB */
    const char *syslog;                   /* HOST[:PORT] of a syslog server over TLS; NULL: none */
    const char *syslog_ca;                /* PEM file of certificates to trust for the syslog server; NULL: those of the operating system */
    const char *syslog_cert, *syslog_key; /* PEM files of our client certificate for the syslog server; NULL: none */
};

#endif
