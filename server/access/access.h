/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Access rules of the daemon: where it may listen, which host names and web pages may use it, and what its own pages may load.
   message/role.h says what each role may do. No input or output except in access_notice_read(). Call from any thread. */
#ifndef ACCESS_ACCESS_H
#define ACCESS_ACCESS_H
#include "access/quota.h"
#include "base/log/log.h"
#include "message/role.h"

enum { ACCESS_MAX_NAMES = 16 };

struct access_network {
    uint8_t address[16]; /* address of the network; bits after the prefix do not count; an IPv4 address is stored as ::ffff:a.b.c.d */
    int bits;            /* length in bits of the network's prefix (the part that all its addresses share), 1..128 */
};

struct access_params {
    bool open_viewers; /* true: clients without a token may view pictures, but nothing else */
    /* true: a proxy on this machine forwards connections, so a loopback peer is not necessarily a local client */
    bool behind_proxy;
    struct access_network proxies[ACCESS_MAX_NAMES]; /* reverse proxies on other machines, whose X-Forwarded-For header is trusted */
    int proxy_count;
    bool trust_local;                         /* true: clients on this machine need no token, even if remote clients do */
    const char *tokens_path;                  /* path of the token file; NULL: tokens are not used */
    const char *openid_path;                  /* path of the configuration file of --openid; NULL: no sign-in with OpenID Connect */
    const char *tls_cert_path, *tls_key_path; /* paths of the certificate and its private key; NULL: no TLS */
    const char *hosts[ACCESS_MAX_NAMES];      /* host names that clients may use in the Host header, in addition to this machine's own */
    const char *origins[ACCESS_MAX_NAMES];    /* origins (SCHEME://HOST[:PORT]) of web pages on other hosts that may connect */
    int host_count, origin_count;
    const char *notice_path; /* path of the --notice text file, whose text users see before they sign in; NULL: none */
    double lock_min;         /* minutes of inactivity after which the user must sign in again; 0: never */
    struct quotas quotas;
};

/* Returns true if the daemon may listen with these parameters. loopback: the daemon would listen on a loopback address only. On
   false, *why (static text) names the violated rule. */
bool access_allowed_at(const struct access_params *params, bool loopback, const char **why);

/* Writes the host name in a request's Host header ("name", "name:80", "[::1]:80") to `out`, in lower case and without port and brackets.
   Returns false if the header has no valid host name. */
bool access_host_name(const char *host, char *out, size_t size);
/* Returns true if the host name is localhost, 127.x.x.x or ::1, which mean this machine. */
bool access_name_is_local(const char *name);
/* Returns true if the host name is a numeric IP address instead of a name. */
bool access_name_is_address(const char *name);
/* Returns true if a web page of that origin may connect to that host: either it comes from the same host and scheme, or
   params->origins lists its origin. An empty origin is allowed, because such a request does not come from a browser. secure:
   the connection uses TLS. */
bool access_origin(const struct access_params *params, const char *origin, const char *host, bool secure);
/* Reads the --notice text file: UTF-8, 4 kB at most. The caller frees the text with mem_free. Returns NULL on failure, already logged. */
char *access_notice_read(struct log *log, const char *path);
/* Returns the Content-Security-Policy header of the daemon's pages: they load from this server only, and only pages of
   params->origins may embed them in a frame. The caller frees the text with mem_free. */
char *access_content_policy(const struct access_params *params);
/* Returns true if a header's comma-separated list contains that word. */
bool access_list_has(const char *list, const char *word);
/* Finds the first word of a header's comma-separated list that begins with `prefix`, and writes the rest of the word to `out`.
   Returns false if there is none. */
bool access_list_rest(const char *list, const char *prefix, char *out, size_t size);
/* Parses ADDRESS or ADDRESS/BITS (option --trusted-proxy) and adds the network to params->proxies. A network that contains a loopback
   address also sets behind_proxy. Returns false if the text is invalid, if BITS is 0, or if there are too many networks. */
bool access_add_proxy(struct access_params *params, const char *text);
/* Returns true if the peer with this numeric address is a known proxy, so that its X-Forwarded-For header is trusted. */
bool access_is_proxy(const struct access_params *params, const char *address);
/* Writes the client's address from an X-Forwarded-For header to `out`: the last address in the list that is not in
   params->proxies, because each proxy appends the address of its peer. Returns false if there is none. */
bool access_forwarded(const struct access_params *params, const char *list, char *out, size_t size);
/* Returns true if an argument of a URL's query would pass an access token. Such requests are refused, because logs and browser
   histories keep URLs. */
bool access_argument_is_token(const char *argument);

#endif
