/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests over HTTP to other servers, by libcurl: what all of them share. Thread: one per request. */
#ifndef BASE_SYSTEM_HTTP_REQUEST_H
#define BASE_SYSTEM_HTTP_REQUEST_H
#include <curl/curl.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "base/text/text.h"

struct http_request { /* zero-initialise */
    CURL *handle; /* keeps its connection; what is asked for is set on it. NULL: not made yet */
    struct curl_slist *headers;
    struct text answer;       /* the body that came; the owner empties it with text_finish() */
    size_t most_bytes;        /* what `answer` may hold; a longer one ends the request with CURLE_WRITE_ERROR */
    const _Atomic bool *stop; /* ends the request within a second once it is set; NULL: nothing does */
    char error[CURL_ERROR_SIZE];
};

/* Makes the handle. It speaks http and https, from TLS 1.2 on, and trusts ca_file (NULL: what the system trusts). Returns false
   without memory. */
bool http_request_make(struct http_request *request, const char *agent, const char *ca_file);
/* Replaces all headers by `Authorization: SCHEME` `CREDENTIALS`; credentials NULL: by none. Credentials are wiped from what it frees. */
void http_request_authorize(struct http_request *request, const char *scheme, const char *credentials);
/* Returns why a request failed, in words of libcurl; valid until the next one begins. */
const char *http_request_why(const struct http_request *request, CURLcode code);
/* Frees handle, headers and answer; leaves it empty. */
void http_request_finish(struct http_request *request);

#endif
