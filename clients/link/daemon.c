/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP requests to a daemon, with libcurl. Its WebSocket clients use libwebsockets. */
#include "daemon.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/secret.h"
#include "base/mem.h"
#include "base/system/http_request.h"

/* SILENCE_S: maximum time in seconds until the answer begins, and between two parts of an answer */
enum { MAX_BODY_BYTES = 256 * 1024 * 1024, MAX_REDIRECTS = 5, SILENCE_S = 60 };

/* Reads the access token from the first line of the --token-file. Returns false with the reason printed. */
static bool read_token(struct daemon_access *access)
{
    const char *why = secret_read_bearer(access->token_path, access->authorization, sizeof(access->authorization));
    if (why)
        fprintf(stderr, "plantcast: %s: %s\n", access->token_path, why);
    return !why;
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

/* Returns what made a request fail. status: HTTP status of its answer; 0: none arrived. */
static const char *why_of(const struct http_request *request, CURLcode code, long status)
{
    if (status && code == CURLE_WRITE_ERROR)
        return "the answer is too large";
    if (status && code == CURLE_OPERATION_TIMEDOUT)
        return "the answer is incomplete: the server has stopped sending";
    if (status && (code == CURLE_PARTIAL_FILE || code == CURLE_RECV_ERROR))
        return "the answer is incomplete: the connection ended too early";
    return http_request_why(request, code);
}

static long send_request(struct http_request *request, const struct daemon_url *url, const char *address)
{
    long status = 0, redirects = 0;
    char *last_url = NULL;
    CURL *handle = request->handle;
    http_request_authorize(request, "", url->access->authorization[0] ? url->access->authorization : NULL);
    curl_easy_setopt(handle, CURLOPT_URL, address);
    curl_easy_setopt(handle, CURLOPT_HTTP_VERSION, (long)CURL_HTTP_VERSION_1_1);
    curl_easy_setopt(handle, CURLOPT_FOLLOWLOCATION, 1L);
    curl_easy_setopt(handle, CURLOPT_MAXREDIRS, (long)MAX_REDIRECTS);
    curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, (long)SILENCE_S);
    curl_easy_setopt(handle, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(handle, CURLOPT_LOW_SPEED_TIME, (long)SILENCE_S);
    CURLcode code = curl_easy_perform(handle);
    curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &status);
    curl_easy_getinfo(handle, CURLINFO_REDIRECT_COUNT, &redirects);
    curl_easy_getinfo(handle, CURLINFO_EFFECTIVE_URL, &last_url);
    if (code == CURLE_OK && status == 401 && redirects > 0 && url->access->authorization[0])
        fprintf(stderr, "plantcast: %s: the server redirects to %s, and the token is not sent to another server: use that server's URL\n",
                address, last_url);
    if (code == CURLE_OK)
        return status;
    fprintf(stderr, "plantcast: %s: %s%s\n", address, why_of(request, code, status),
            code == CURLE_PEER_FAILED_VERIFICATION ? "; pass the certificate of the daemon or of its authority with --ca FILE" : "");
    return 0;
}

int daemon_get(const struct daemon_url *url, const char *path, struct text *body)
{
    bool is_ipv6 = strchr(url->host, ':');
    char *address = mem_printf("http%s://%s%s%s:%d%s%s", url->tls ? "s" : "", is_ipv6 ? "[" : "", url->host, is_ipv6 ? "]" : "", url->port,
                               url->base, path);
    struct http_request request = { .answer = *body, .most_bytes = body->length + MAX_BODY_BYTES };
    long status = 0;
    if (http_request_make(&request, "plantcast", url->access->ca_path))
        status = send_request(&request, url, address);
    else
        fprintf(stderr, "plantcast: %s: out of memory\n", address);
    *body = request.answer;
    request.answer = (struct text){ 0 };
    http_request_finish(&request);
    mem_free(address);
    return (int)status;
}
