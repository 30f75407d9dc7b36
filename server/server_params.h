/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters of the daemon, from its command line. */
#ifndef SERVER_SERVER_PARAMS_H
#define SERVER_SERVER_PARAMS_H
#include <stdbool.h>
#include <stddef.h>

#include "access/access.h"
#include "audit/audit.h"
#include "base/log/log.h"
#include "corelink/core_link.h"
#include "gpu/gl.h"

/* Tasks of the daemon: SERVER_ALL reads field devices and draws for users. SERVER_CORE does the same, but also accepts
   renderers (daemons that draw for users). SERVER_RENDER is such a renderer. */
enum server_role { SERVER_ALL, SERVER_CORE, SERVER_RENDER };

struct server_params {
    const char *plant_path;
    const char *address; /* numeric address to listen on */
    int port;            /* TCP port on which the daemon listens; 0: any free port */
    int socket_fd;       /* listening socket that the service manager opened and passed on; -1: none */
    enum gl_kind gl;
    struct gl_device gl_device;
    bool has_gl_device;
    const char *prepared; /* folder of the prepared assets; NULL: next to the plant file */
    const char *history;  /* folder of the history; NULL: the folder named in the plant file, or its default */
    const char *web;      /* folder of the web client's files; NULL: found relative to the program */
    enum log_level log_level;
    enum log_format log_format;
    const char *h264;    /* name of a libavcodec encoder for H.264, or "off"; NULL: the default one */
    size_t memory_bytes; /* limit in bytes for all caches together; 0: chosen to suit the machine */
    struct access_params access;
    const char *signing_key;   /* PEM file of the key that signs pictures; NULL: pictures are not signed */
    struct audit_params audit; /* settings of the audit trail; its path NULL: nothing is recorded */
    /* imports: true: engineers may import plants; imports_now: true: imports the exports folder at the daemon's start */
    bool imports, imports_now;
    enum server_role role;
    const char *cores[CORE_URLS]; /* for SERVER_RENDER: URLs of a core, or of both cores of a pair; the renderer uses one at a time */
    int core_count;
    /* core_token: file of the token required by the core, NULL: none; core_ca: file of trusted certificates, NULL: the system's */
    const char *core_token, *core_ca;
    int agent_port;    /* port for the agent checks of load balancers; 0: none */
    const char *node;  /* name of this daemon among several; the host name unless --node is given */
    bool per_fragment; /* true: computes the field at each fragment, for comparison with the field at vertices */
};

#endif
