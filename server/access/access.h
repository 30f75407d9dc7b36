/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who may do what: roles, and what a message, a host or a page must be. Pure. PROTOCOL.md holds the table for readers. */
#ifndef ACCESS_ACCESS_H
#define ACCESS_ACCESS_H
#include "access/quota.h"
#include "message/role.h"

enum { ACCESS_MAX_NAMES = 16 };

struct access_params {
    bool open_viewers;                        /* who has no token gets pictures */
    bool behind_proxy;                        /* a proxy on this machine speaks for others: no connection is trusted for being local */
    bool trust_local;                         /* who is on this machine needs no token, though others do */
    const char *tokens_path;                  /* NULL: there are none */
    const char *tls_cert_path, *tls_key_path; /* NULL: no TLS */
    const char *hosts[ACCESS_MAX_NAMES];      /* names under which the daemon may be asked for, beside those it knows */
    const char *origins[ACCESS_MAX_NAMES];    /* pages of other hosts that may connect, as SCHEME://HOST[:PORT] */
    int host_count, origin_count;
    struct quotas quotas;
};

/* False: *why (static) says which rule of the bind address is not kept. */
bool access_allowed_at(const struct access_params *params, bool loopback, const char **why);

/* "name", "name:80", "[::1]:80" -> the name, lower case, without brackets. False: it is none. */
bool access_host_name(const char *host, char *out, size_t size);
bool access_name_is_local(const char *name); /* localhost, 127.x, ::1 */
bool access_name_is_address(const char *name);
/* Whether a page of `origin` may use who asks `host`: the same host by the same kind of line, or one of those named. "": no browser. */
bool access_origin(const struct access_params *params, const char *origin, const char *host, bool secure);
/* What a page of ours may load, and who may show it in a frame: it, and those named; mem_free. */
char *access_content_policy(const struct access_params *params);
/* Finds a name in a header's list with commas; *rest (may be NULL) is what follows `prefix` in the word that begins with it. */
bool access_list_has(const char *list, const char *word);
bool access_list_rest(const char *list, const char *prefix, char *out, size_t size);
/* The last address in X-Forwarded-For, which the nearest proxy wrote. False: there is none. */
bool access_forwarded(const char *list, char *out, size_t size);
/* A token in a query, where logs and histories keep it. */
bool access_argument_is_token(const char *argument);

#endif
