/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters from the daemon's command line. */
#ifndef SERVER_SERVER_PARAMS_H
#define SERVER_SERVER_PARAMS_H
#include <stdbool.h>
#include <stddef.h>

#include "access/access.h"
#include "audit/audit.h"
#include "base/log/log.h"
#include "corelink/core_link.h"
#include "gpu/gl.h"

/* Whether the daemon reads field devices, draws for users, or both. */
/* like SERVER_ALL, but renderers (daemons that draw for users) may connect, too */
enum server_role { SERVER_ALL, SERVER_CORE, SERVER_RENDER };

struct server_params {
    const char *plant_path;
    const char *address; /* numeric address to listen on */
    int port;            /* port to listen on; 0: any free one */
    int socket_fd;       /* socket that the service manager opened and that listens already; -1: none */
    enum gl_kind gl;
    struct gl_device gl_device;
    bool has_gl_device;
    const char *prepared; /* folder of prepared assets; NULL: next to the plant file */
    const char *history;  /* folder of the history; NULL: as the plant file says */
    const char *web;      /* folder of the web client's files; NULL: found relative to the program */
    enum log_level log_level;
    enum log_format log_format;
    const char *h264;    /* name of a libavcodec encoder, or "off"; NULL: the default one */
    size_t memory_bytes; /* limit on memory; 0: chosen for the machine */
    int threads;         /* number of worker threads; 0: one per core */
    struct access_params access;
    const char *signing_key;   /* PEM file of the key that signs pictures; NULL: pictures are not signed */
    struct audit_params audit; /* audit trail; path NULL: nothing is recorded */
    bool imports, imports_now; /* imports: engineers may import plants; imports_now: import the exported files at start */
    enum server_role role;
    const char *cores[CORE_URLS]; /* for SERVER_RENDER: URLs of the cores of a pair; the renderer connects to one URL at a time */
    int core_count;
    /* core_token: file of the token for the core, NULL: none; core_ca: file of trusted certificates, NULL: the system's */
    const char *core_token, *core_ca;
    int agent_port;    /* port for load balancers' agent checks; 0: none */
    const char *node;  /* this daemon's name among others; without --node the host name */
    bool per_fragment; /* compute the field for each fragment; for comparison */
};

#endif
