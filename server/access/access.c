/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Access rules: which listen addresses, host names, page origins and proxies are allowed. Also parses comma-separated header lists. */
#include "access/access.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "base/text/utf8.h"

enum { NOTICE_BYTES = 4096 };

bool access_allowed_at(const struct access_params *params, bool loopback, const char **why)
{
    bool tls = params->tls_cert_path && params->tls_key_path;
    if (params->behind_proxy && !params->tokens_path && !params->open_viewers)
        *why = "--behind-proxy needs --tokens FILE, so that users behind the proxy can sign in, or --open-viewers";
    else if (params->openid_path && !params->tokens_path)
        *why = "--openid needs --tokens FILE, so that users can sign in with a token while the identity provider does not answer";
    else if (params->lock_min && !params->tokens_path)
        *why = "--lock-after needs --tokens FILE, so that users who were signed out can sign in again with a token";
    else if (params->behind_proxy && params->host_count == 0)
        *why = "--behind-proxy needs --host NAME: the host name under which browsers reach the proxy";
    else if (params->behind_proxy && params->trust_local)
        *why = "--trust-local cannot be combined with --behind-proxy: requests from a proxy on this machine seem to come from local users";
    else if ((params->tls_cert_path != NULL) != (params->tls_key_path != NULL))
        *why = "give both --tls-cert and --tls-key, or neither";
    else if (!loopback && !params->open_viewers && !(tls && params->tokens_path))
        *why = "without TLS and tokens, anyone who can reach this address could use the plant and eavesdrop. Give\n--tls-cert, --tls-key "
               "and --tokens, or give --open-viewers, which serves only pictures, to anyone";
    else
        return true;
    return false;
}

/* --- host names and pages ------------------------------------------------------------------------------------------------------ */

bool access_host_name(const char *host, char *out, size_t size)
{
    bool six = host[0] == '[';
    const char *begin = host + six, *end = begin + strcspn(begin, six ? "]" : ":"), *rest = end + (six && *end == ']');
    size_t n = (size_t)(end - begin);
    bool port = *rest == ':';
    if (n == 0 || n >= size || (six && *end != ']') || (*rest && !port) || rest[port + strspn(rest + port, "0123456789")])
        return false;
    for (size_t i = 0; i < n; i++) {
        unsigned char c = (unsigned char)begin[i];
        if ((!isalnum(c) && !strchr(six ? ":." : "-._", c)) || (c == '.' && (i == 0 || begin[i - 1] == '.')))
            return false;
        out[i] = (char)tolower(c);
    }
    out[n] = 0;
    if (n > 1 && out[n - 1] == '.') /* removes the trailing dot of a fully qualified host name such as "host.example." */
        out[n - 1] = 0;
    return true;
}

bool access_name_is_local(const char *name)
{
    struct in_addr four;
    return !strcmp(name, "localhost") || !strcmp(name, "::1") || (inet_pton(AF_INET, name, &four) == 1 && ntohl(four.s_addr) >> 24 == 127);
}

bool access_name_is_address(const char *name)
{
    struct in6_addr any;
    return inet_pton(AF_INET, name, &any) == 1 || inet_pton(AF_INET6, name, &any) == 1;
}

/* Parses a numeric IP address into 16 bytes, IPv4 as ::ffff:a.b.c.d. Returns false if the text is not an address. */
static bool read_address(const char *text, uint8_t out[16])
{
    static const uint8_t mapped[12] = { [10] = 0xff, [11] = 0xff };
    if (inet_pton(AF_INET6, text, out) == 1)
        return true;
    memcpy(out, mapped, sizeof(mapped));
    return inet_pton(AF_INET, text, out + sizeof(mapped)) == 1;
}

bool access_add_proxy(struct access_params *params, const char *text)
{
    struct access_network *network = &params->proxies[params->proxy_count];
    size_t n = strcspn(text, "/");
    char address[64] = "", *end = NULL;
    bool four = memchr(text, ':', n) == NULL;
    if (params->proxy_count == ACCESS_MAX_NAMES || n >= sizeof(address))
        return false;
    memcpy(address, text, n);
    long most = four ? 32 : 128, bits = text[n] && isdigit((unsigned char)text[n + 1]) ? strtol(text + n + 1, &end, 10) : most;
    if (!read_address(address, network->address) || (text[n] && (!end || *end)) || bits < 1 || bits > most)
        return false;
    network->bits = (int)bits + (four ? 96 : 0);
    params->proxy_count++;
    params->behind_proxy |= access_is_proxy(params, "127.0.0.1") || access_is_proxy(params, "::1");
    return true;
}

static bool contains(const struct access_network *network, const uint8_t address[16])
{
    int bytes = network->bits / 8, rest = network->bits % 8;
    return !memcmp(network->address, address, (size_t)bytes) &&
           (rest == 0 || (network->address[bytes] ^ address[bytes]) >> (8 - rest) == 0);
}

static bool is_listed(const struct access_params *params, const char *text)
{
    uint8_t address[16];
    bool found = false;
    for (int i = 0; read_address(text, address) && i < params->proxy_count && !found; i++)
        found = contains(&params->proxies[i], address);
    return found;
}

bool access_is_proxy(const struct access_params *params, const char *address)
{
    const char *four = strncasecmp(address, "::ffff:", 7) ? address : address + 7;
    return (params->behind_proxy && access_name_is_local(four)) || is_listed(params, address);
}

bool access_origin(const struct access_params *params, const char *origin, const char *host, bool secure)
{
    const char *name = strstr(origin, "://");
    if (!origin[0])
        return true;
    for (int i = 0; i < params->origin_count; i++)
        if (!strcasecmp(params->origins[i], origin))
            return true;
    return name && !strcasecmp(name + 3, host) && (!secure || !strncasecmp(origin, "https://", 8));
}

char *access_notice_read(struct log *log, const char *path)
{
    size_t count;
    char *text = text_read_file(path, NOTICE_BYTES, &count);
    bool good = text && count > 0;
    for (size_t at = 0, n; good && at < count; at += n) {
        n = utf8_length(text + at, count - at);
        good = n > 0 && text[at];
    }
    if (!good) {
        log_err(log, "notice %s: %s", path, text ? "the file must contain UTF-8 text and must not be empty" : strerror(errno));
        mem_free(text);
        return NULL;
    }
    return text;
}

char *access_content_policy(const struct access_params *params)
{
    struct text text = { 0 };
    text_add(&text, "default-src 'self'; connect-src 'self'; img-src 'self' data: blob:; worker-src 'self' blob:; object-src 'none'; "
                    "base-uri 'none'; form-action 'none'; frame-ancestors 'self'");
    for (int i = 0; i < params->origin_count; i++)
        text_add(&text, " %s", params->origins[i]);
    return text.at;
}

/* --- lists in headers ---------------------------------------------------------------------------------------------------------- */

/* Returns the next word of a header's comma-separated list and moves *at past it; *n receives the word's length. NULL: there
   are no more words. */
static const char *next_word(const char **at, size_t *n)
{
    *at += strspn(*at, " ,\t");
    const char *word = *at;
    *n = strcspn(word, " ,\t");
    *at += *n;
    return *n ? word : NULL;
}

bool access_list_has(const char *list, const char *word)
{
    size_t n;
    for (const char *at; (at = next_word(&list, &n));)
        if (n == strlen(word) && !strncmp(at, word, n))
            return true;
    return false;
}

bool access_list_rest(const char *list, const char *prefix, char *out, size_t size)
{
    size_t n, skip = strlen(prefix);
    for (const char *at; (at = next_word(&list, &n));) {
        if (n <= skip || strncmp(at, prefix, skip) != 0 || n - skip >= size)
            continue;
        memcpy(out, at + skip, n - skip);
        out[n - skip] = 0;
        return true;
    }
    return false;
}

/* Parses one entry of X-Forwarded-For into `out`: an IPv6 address, possibly in brackets, or an IPv4 address, possibly with a
   port. Returns false if the entry is neither. */
static bool read_forwarded(const char *at, size_t n, char *out, size_t size)
{
    char word[64];
    if (n >= sizeof(word) || n >= size)
        return false;
    memcpy(word, at, n);
    word[n] = 0;
    if (access_name_is_address(word))
        strcpy(out, word);
    return access_name_is_address(word) || (access_host_name(word, out, size) && access_name_is_address(out));
}

bool access_forwarded(const struct access_params *params, const char *list, char *out, size_t size)
{
    size_t n;
    bool found = false;
    for (const char *at; (at = next_word(&list, &n));) {
        char address[64];
        bool good = read_forwarded(at, n, address, sizeof(address) < size ? sizeof(address) : size);
        if (good && (!found || !is_listed(params, address)))
            strcpy(out, address);
        found = good;
    }
    return found;
}

bool access_argument_is_token(const char *argument)
{
    static const char *const names[] = { "token", "access_token", "authorization", "bearer", "auth" };
    size_t n = strcspn(argument, "=");
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (strlen(names[i]) == n && !strncasecmp(names[i], argument, n))
            return true;
    return false;
}
