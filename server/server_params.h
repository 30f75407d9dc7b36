/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the command line of the daemon says. */
#ifndef SERVER_SERVER_PARAMS_H
#define SERVER_SERVER_PARAMS_H
#include <stdbool.h>
#include <stddef.h>

#include "access/access.h"
#include "audit/audit.h"
#include "base/log/log.h"
#include "corelink/core_link.h"
#include "gpu/gl.h"

/* Who reads field devices, and who draws for operators. */
enum server_role { SERVER_ALL, SERVER_CORE /* renderers may connect, too */, SERVER_RENDER };

struct server_params {
    const char *plant_path;
    const char *address; /* to listen on; numeric */
    int port;            /* 0: any that is free */
    int socket_fd;       /* of the service manager, which listens there already; -1: none */
    enum gl_kind gl;
    struct gl_device gl_device;
    bool has_gl_device;
    const char *prepared; /* NULL: beside the plant file */
    const char *history;  /* NULL: as the plant file says */
    const char *web;      /* NULL: found from where the program is */
    enum log_level log_level;
    enum log_format log_format;
    const char *h264;    /* an encoder of libavcodec, or "off"; NULL: the usual one */
    size_t memory_bytes; /* 0: what suits the machine */
    int threads;         /* workers; 0: one per core */
    struct access_params access;
    const char *signing_key;   /* PEM file of the key that signs pictures; NULL: none is signed */
    struct audit_params audit; /* path NULL: nothing is recorded */
    bool imports, imports_now; /* engineers may bring plants in; what was exported is brought in at once */
    enum server_role role;
    const char *cores[CORE_URLS]; /* SERVER_RENDER: URLs where the core may be; one at a time is */
    int core_count;
    const char *core_token, *core_ca; /* file of the token; of certificates that are trusted. NULL: none; the system's */
    int agent_port;                   /* where load balancers ask; 0: nowhere */
    const char *node;                 /* this daemon's name among others; without --node the machine's */
    bool per_fragment; /* the field anew at each fragment; for comparison */
};

#endif
