/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP requests to a daemon, with libwebsockets. */
#include "daemon.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/secret.h"
#include "base/mem.h"

/* SILENCE_S: maximum time in seconds between two parts of an answer */
enum { MAX_BODY_BYTES = 256 * 1024 * 1024, RECEIVE_BYTES = 16 * 1024, SILENCE_S = 60 };

/* Reads the access token from the first line of the --token-file. Returns false with the reason printed. */
static bool read_token(struct daemon_access *access)
{
    size_t count;
    char *text = text_read_file(access->token_path, 4096, &count);
    int error = text ? 0 : errno;
    size_t n = text ? strcspn(text, " \t\r\n") : 0;
    bool good = n > 0 && n <= TOKEN_MAX_CHARS;
    if (good)
        snprintf(access->authorization, sizeof(access->authorization), "Bearer %.*s", (int)n, text);
    else
        fprintf(stderr, "plantcast: %s: %s\n", access->token_path,
                error ? strerror(error) : "the first line of this file must be a token (see `plantcast token`)");
    secret_forget(text);
    return good;
}

/* Returns the value of the option --NAME VALUE or --NAME=VALUE at argv[*i], and advances *i; NULL: argv[*i] is another option, or has no
   value. */
static const char *value_of(const char *name, int argc, char **argv, int *i)
{
    size_t n = strlen(name);
    if (strncmp(argv[*i], name, n) != 0)
        return NULL;
    if (argv[*i][n] == '=')
        return argv[*i] + n + 1;
    return argv[*i][n] == 0 && *i + 1 < argc ? argv[++*i] : NULL;
}

bool daemon_take_options(int *argc, char **argv, struct daemon_access *access)
{
    int kept = 0;
    *access = (struct daemon_access){ .token_path = NULL };
    for (int i = 0; i < *argc; i++) {
        const char *token = value_of("--token-file", *argc, argv, &i);
        const char *ca = token ? NULL : value_of("--ca", *argc, argv, &i);
        if (token)
            access->token_path = token;
        if (token && !read_token(access))
            return false;
        if (ca)
            access->ca_path = ca;
        if (!token && !ca)
            argv[kept++] = argv[i];
    }
    argv[kept] = NULL;
    *argc = kept;
    return true;
}

char **daemon_command_line(const struct daemon_access *access, int argc, char **argv)
{
    char **all = mem_array((size_t)argc + 5, sizeof(*all));
    int count = 0;
    all[count++] = argv[0];
    if (access->token_path) {
        all[count++] = "--token-file";
        all[count++] = (char *)access->token_path;
    }
    if (access->ca_path) {
        all[count++] = "--ca";
        all[count++] = (char *)access->ca_path;
    }
    for (int i = 1; i < argc; i++)
        all[count++] = argv[i];
    return all;
}

/* Stores the path prefix under which a proxy serves the daemon. path: the prefix without its leading slash. Returns false if it is too long
   or contains a query. */
static bool take_base(struct daemon_url *url, const char *path)
{
    size_t length = strlen(path);
    while (length > 0 && path[length - 1] == '/')
        length--;
    if (length + 2 > sizeof(url->base) || strpbrk(path, "?#"))
        return false;
    snprintf(url->base, sizeof(url->base), "%s%.*s", length ? "/" : "", (int)length, path);
    return true;
}

bool daemon_url_parse(const char *text, const struct daemon_access *access, struct daemon_url *url)
{
    const char *scheme, *host, *path;
    char *copy = mem_strdup(text);
    url->access = access;
    bool good =
        lws_parse_uri(copy, &scheme, &host, &url->port, &path) == 0 && host[0] && strlen(host) < sizeof(url->host) && take_base(url, path);
    url->tls = good && (!strcmp(scheme, "https") || !strcmp(scheme, "wss"));
    good = good && (url->tls || !strcmp(scheme, "http") || !strcmp(scheme, "ws"));
    if (good)
        strcpy(url->host, host);
    else
        fprintf(stderr, "plantcast: '%s' is not a URL such as https://HOST:PORT/, or https://HOST/PATH/ of a proxy\n",
                text);
    mem_free(copy);
    return good;
}

void daemon_prepare_context(const struct daemon_url *url, struct lws_context_creation_info *info)
{
    if (!url->tls)
        return;
    info->options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
    info->client_ssl_ca_filepath = url->access->ca_path;
}

void daemon_prepare_connection(const struct daemon_url *url, struct lws_client_connect_info *info)
{
    info->address = info->host = url->host;
    info->port = url->port;
    info->ssl_connection = url->tls ? LCCSCF_USE_SSL : 0;
    info->alpn = "http/1.1";
}

int daemon_add_token(const struct daemon_access *access, struct lws *wsi, void *in, size_t len)
{
    unsigned char **at = in, *end = *at + len;
    const char *value = access->authorization;
    if (!*value)
        return 0;
    int failed = lws_add_http_header_by_token(wsi, WSI_TOKEN_HTTP_AUTHORIZATION, (const unsigned char *)value, (int)strlen(value), at, end);
    return failed ? -1 : 0;
}

struct exchange {
    const struct daemon_access *access;
    int status;
    bool done;
    long long length; /* length of the body in bytes, as the answer states it; -1: the answer states none */
    struct text *body;
    size_t body_begin; /* number of bytes in `body` before the answer */
    char why[200];
};

static void await_more(struct lws *wsi)
{
    lws_set_timer_usecs(wsi, SILENCE_S * LWS_US_PER_SEC);
}

static void read_head(struct exchange *exchange, struct lws *wsi)
{
    char length[24] = "";
    exchange->status = (int)lws_http_client_http_response(wsi);
    exchange->length = lws_hdr_copy(wsi, length, sizeof(length), WSI_TOKEN_HTTP_CONTENT_LENGTH) > 0 ? strtoll(length, NULL, 10) : -1;
    await_more(wsi);
}

/* Returns whether the body has the length that the answer states. An answer that states none, such as a chunked one, counts as whole. */
static bool is_whole(const struct exchange *exchange)
{
    return exchange->length < 0 || exchange->body->length - exchange->body_begin == (size_t)exchange->length;
}

static int end_with(struct exchange *exchange, const char *why)
{
    snprintf(exchange->why, sizeof(exchange->why), "%s", why);
    return -1;
}

static int on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct exchange *exchange = user;
    char buffer[LWS_PRE + RECEIVE_BYTES], *at = buffer + LWS_PRE;
    int room = RECEIVE_BYTES;
    switch (reason) {
    case LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER: return daemon_add_token(exchange->access, wsi, in, len);
    case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
        snprintf(exchange->why, sizeof(exchange->why), "%s", in ? (const char *)in : "no connection");
        exchange->done = true;
        break;
    case LWS_CALLBACK_ESTABLISHED_CLIENT_HTTP: read_head(exchange, wsi); break;
    case LWS_CALLBACK_TIMER: return end_with(exchange, "the answer is incomplete: the server has stopped sending");
    /* lws_http_client_read() fills `buffer` with part of the response body and calls this function again with
       LWS_CALLBACK_RECEIVE_CLIENT_HTTP_READ */
    case LWS_CALLBACK_RECEIVE_CLIENT_HTTP:
        return lws_http_client_read(wsi, &at, &room) < 0 ? -1 : 0;
    case LWS_CALLBACK_RECEIVE_CLIENT_HTTP_READ:
        if (exchange->body->length + len > MAX_BODY_BYTES)
            return end_with(exchange, "the answer is too large");
        text_add_bytes(exchange->body, in, len);
        await_more(wsi);
        break;
    case LWS_CALLBACK_COMPLETED_CLIENT_HTTP:
    case LWS_CALLBACK_CLOSED_CLIENT_HTTP: exchange->done = true; break;
    default: break;
    }
    return 0;
}

int daemon_get(const struct daemon_url *url, const char *path, struct text *body)
{
    static const struct lws_protocols protocols[] = { { .name = "http", .callback = on_event }, { 0 } };
    struct exchange exchange = { .access = url->access, .body = body, .body_begin = body->length };
    struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN,
        .protocols = protocols,
        .gid = -1,
        .uid = -1,
        .timeout_secs = 70,
    };
    lws_set_log_level(0, NULL);
    daemon_prepare_context(url, &info);
    struct lws_context *context = lws_create_context(&info);
    char *whole = mem_printf("%s%s", url->base, path);
    struct lws_client_connect_info connect = {
        .context = context,
        .path = whole,
        .method = "GET",
        .userdata = &exchange,
        .protocol = "http",
    };
    daemon_prepare_connection(url, &connect);
    if (!context || !lws_client_connect_via_info(&connect))
        exchange.done = true;
    while (!exchange.done)
        lws_service(context, 0);
    if (exchange.status && (exchange.why[0] || !is_whole(&exchange))) {
        if (!exchange.why[0])
            end_with(&exchange, "the answer is incomplete: the connection ended too early");
        exchange.status = 0;
    }
    if (!exchange.status)
        fprintf(stderr, "plantcast: http%s://%s:%d%s: %s%s\n", url->tls ? "s" : "", url->host, url->port, whole,
                exchange.why[0] ? exchange.why : "the server at this address does not answer",
                strstr(exchange.why, "SSL") ? "; pass the certificate of the daemon or of its authority with --ca FILE" : "");
    if (context)
        lws_context_destroy(context);
    mem_free(whole);
    return exchange.status;
}
