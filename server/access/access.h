/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules of access: where the daemon may listen, which host names and pages may use it, what a page of ours may load. What each role may
   do is in message/role.h. Pure; any thread. */
#ifndef ACCESS_ACCESS_H
#define ACCESS_ACCESS_H
#include "access/quota.h"
#include "base/log/log.h"
#include "message/role.h"

enum { ACCESS_MAX_NAMES = 16 };

struct access_params {
    bool open_viewers;                        /* clients without a token get pictures, and nothing else */
    bool behind_proxy;                        /* a proxy on this machine forwards the connections of others: being local proves nothing */
    bool trust_local;                         /* clients on this machine need no token, though others do */
    const char *tokens_path;                  /* NULL: no tokens */
    const char *openid_path;                  /* of the file that says how people sign in; NULL: they do not */
    const char *tls_cert_path, *tls_key_path; /* NULL: no TLS */
    const char *hosts[ACCESS_MAX_NAMES];      /* host names by which clients may ask for the daemon, beside those it knows */
    const char *origins[ACCESS_MAX_NAMES];    /* pages of other hosts that may connect, as SCHEME://HOST[:PORT] */
    int host_count, origin_count;
    const char *notice_path;                  /* of a text that is shown before somebody signs in; NULL: none */
    double lock_min;                          /* who was not at the page for so long has to sign in again; 0: nobody has to */
    struct quotas quotas;
};

/* Returns whether the daemon may listen with these parameters on a loopback address, or on another. If not, *why (static) says which rule
   is broken. */
bool access_allowed_at(const struct access_params *params, bool loopback, const char **why);

/* Writes the host name of a Host header ("name", "name:80", "[::1]:80") into out, in lower case, without brackets. Returns false if it is
   not a host name. */
bool access_host_name(const char *host, char *out, size_t size);
/* Returns whether the name is localhost, 127.x or ::1. */
bool access_name_is_local(const char *name);
/* Returns whether the name is a numeric IP address. */
bool access_name_is_address(const char *name);
/* Returns whether a page of that origin may connect to that host: it is the same host with the same scheme, or named in params. An empty
   origin may: no browser sent it. secure: the connection has TLS. */
bool access_origin(const struct access_params *params, const char *origin, const char *host, bool secure);
/* Reads the text of --notice: UTF-8, 4 kB at most. Returns it, for mem_free; NULL after an error, already logged. */
char *access_notice_read(struct log *log, const char *path);
/* Returns the Content-Security-Policy of our pages: they load from here only, and the origins named may show them in a frame; mem_free. */
char *access_content_policy(const struct access_params *params);
/* Returns whether a header's comma-separated list has that word. */
bool access_list_has(const char *list, const char *word);
/* Finds the word of such a list that begins with the prefix and writes what follows that into out. Returns false if there is none. */
bool access_list_rest(const char *list, const char *prefix, char *out, size_t size);
/* Writes the last address of an X-Forwarded-For header, which the nearest proxy added, into out. Returns false if there is none. */
bool access_forwarded(const char *list, char *out, size_t size);
/* Returns whether an argument of a query is a token, which must not stand where logs and browser histories keep it. */
bool access_argument_is_token(const char *argument);

#endif
