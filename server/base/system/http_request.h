/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP requests to other servers through libcurl: setup and error texts that all callers share. Use each request in one thread only. */
#ifndef BASE_SYSTEM_HTTP_REQUEST_H
#define BASE_SYSTEM_HTTP_REQUEST_H
#include <curl/curl.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "base/text/text.h"

struct http_request { /* zero-initialise */
    CURL *handle;     /* libcurl handle, which keeps its connection open; callers set URL and options; NULL: not created yet */
    struct curl_slist *headers;
    struct text answer;       /* body of the response; the owner empties it with text_finish() */
    size_t most_bytes;        /* maximum length of `answer`; a longer response ends the request with CURLE_WRITE_ERROR */
    const _Atomic bool *stop; /* caller's flag; the request ends within a second after it becomes true; NULL: no flag */
    char error[CURL_ERROR_SIZE];
};

/* Creates the handle. It supports http, and https from TLS 1.2 on, and trusts the certificates in ca_file (NULL: the system's).
   Returns false when out of memory. */
bool http_request_make(struct http_request *request, const char *agent, const char *ca_file);
/* Replaces all request headers with `Authorization: SCHEME CREDENTIALS`; credentials NULL: removes all headers. Overwrites the
   credentials in headers that it frees. */
void http_request_authorize(struct http_request *request, const char *scheme, const char *credentials);
/* Returns libcurl's text for why a request failed; valid until the next request begins. */
const char *http_request_why(const struct http_request *request, CURLcode code);
/* Lets the transfers of a multi handle proceed until there is activity, for at most wait_ms. Removes each finished transfer
   from the multi handle and calls on_end with its CURLOPT_PRIVATE pointer. */
void http_requests_wait(CURLM *multi, int wait_ms, void (*on_end)(void *arg, void *request, CURLcode code), void *arg);
/* Frees the request's libcurl handle, headers and answer, and clears the struct. */
void http_request_finish(struct http_request *request);

#endif
