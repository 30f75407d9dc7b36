/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/system/http_request.h"

#include "base/files/secret.h"
#include "base/mem.h"

static size_t take(char *bytes, size_t size, size_t count, void *arg)
{
    struct http_request *request = arg;
    if (request->answer.length + size * count > request->most_bytes)
        return 0;
    text_add_bytes(&request->answer, bytes, size * count);
    return size * count;
}

static int is_stopped(void *arg, curl_off_t a, curl_off_t b, curl_off_t c, curl_off_t d)
{
    const struct http_request *request = arg;
    (void)a, (void)b, (void)c, (void)d;
    return atomic_load(request->stop);
}

bool http_request_make(struct http_request *request, const char *agent, const char *ca_file)
{
    CURL *handle = request->handle = curl_easy_init();
    if (!handle)
        return false;
    curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(handle, CURLOPT_SSLVERSION, (long)CURL_SSLVERSION_TLSv1_2);
    curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(handle, CURLOPT_QUICK_EXIT, 1L); /* keeps libcurl from waiting for a hanging name server when the program ends */
    curl_easy_setopt(handle, CURLOPT_USERAGENT, agent);
    curl_easy_setopt(handle, CURLOPT_ERRORBUFFER, request->error);
    curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, take);
    curl_easy_setopt(handle, CURLOPT_WRITEDATA, request);
    if (request->stop) {
        curl_easy_setopt(handle, CURLOPT_NOPROGRESS, 0L);
        curl_easy_setopt(handle, CURLOPT_XFERINFOFUNCTION, is_stopped);
        curl_easy_setopt(handle, CURLOPT_XFERINFODATA, request);
    }
    if (ca_file)
        curl_easy_setopt(handle, CURLOPT_CAINFO, ca_file);
    return true;
}

void http_request_authorize(struct http_request *request, const char *scheme, const char *credentials)
{
    curl_slist_free_all(request->headers);
    request->headers = NULL;
    if (credentials) {
        char *header = mem_printf("Authorization: %s%s", scheme, credentials);
        request->headers = curl_slist_append(NULL, header);
        secret_forget(header);
    }
    curl_easy_setopt(request->handle, CURLOPT_HTTPHEADER, request->headers);
}

const char *http_request_why(const struct http_request *request, CURLcode code)
{
    return request->error[0] ? request->error : curl_easy_strerror(code);
}

void http_requests_wait(CURLM *multi, int wait_ms, void (*on_end)(void *arg, void *request, CURLcode code), void *arg)
{
    int running, left;
    curl_multi_perform(multi, &running);
    curl_multi_poll(multi, NULL, 0, wait_ms, NULL);
    curl_multi_perform(multi, &running);
    for (CURLMsg *message; (message = curl_multi_info_read(multi, &left));) {
        void *request = NULL;
        if (message->msg != CURLMSG_DONE)
            continue;
        CURLcode code = message->data.result;
        curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, (char **)&request);
        curl_multi_remove_handle(multi, message->easy_handle);
        on_end(arg, request, code);
    }
}

void http_request_finish(struct http_request *request)
{
    curl_easy_cleanup(request->handle);
    curl_slist_free_all(request->headers);
    text_finish(&request->answer);
    *request = (struct http_request){ 0 };
}
