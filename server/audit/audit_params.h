/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the audit trail is written: to a file, and optionally to a syslog server. */
#ifndef AUDIT_AUDIT_PARAMS_H
#define AUDIT_AUDIT_PARAMS_H
#include <stddef.h>

#include "base/log/log.h"
#include "base/metrics/counters.h"

struct audit_params {
    struct log *log;
    struct counters *counters;
    const char *path;                     /* path of the audit file */
    /* size in bytes at which the audit file is full: it is then renamed and a new one is started; 0: 64 MB */
    size_t most_bytes;
    const char *syslog;                   /* HOST[:PORT] of a syslog server over TLS; NULL: none */
    const char *syslog_ca;                /* PEM file of the CA certificates to trust for the syslog server; NULL: the operating system's */
    const char *syslog_cert, *syslog_key; /* PEM files of our client certificate and its private key for the syslog server; NULL: none */
};

#endif
