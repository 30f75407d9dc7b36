/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends HTTP requests to the core with libcurl. */
#include "corelink/core_request.h"

#include <string.h>

#include "base/mem.h"

/* SLOW_S: seconds without a received byte after which a request fails; LINE: maximum number of characters of the core's answer in
   an error text */
enum { CONNECT_S = 4, SLOW_S = 10, STATUS_GOOD = 200, LINE = 80 };

bool core_request_make(struct http_request *request)
{
    if (!http_request_make(request, "plantcastd", NULL))
        return false;
    curl_easy_setopt(request->handle, CURLOPT_PROXY, "");
    curl_easy_setopt(request->handle, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
    curl_easy_setopt(request->handle, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(request->handle, CURLOPT_LOW_SPEED_TIME, (long)SLOW_S);
    return true;
}

void core_request_address(struct http_request *request, const struct core_peer *peer, const char *path)
{
    char *url = mem_printf("%s%s", peer->url, path);
    http_request_authorize(request, "", peer->authorization[0] ? peer->authorization : NULL);
    curl_easy_setopt(request->handle, CURLOPT_URL, url);
    if (peer->ca_path)
        curl_easy_setopt(request->handle, CURLOPT_CAINFO, peer->ca_path);
    mem_free(url);
}

char *core_request_send(struct http_request *request)
{
    long status = 0;
    size_t begin = request->answer.length;
    request->error[0] = 0;
    CURLcode code = curl_easy_perform(request->handle);
    curl_easy_getinfo(request->handle, CURLINFO_RESPONSE_CODE, &status);
    if (code != CURLE_OK)
        return mem_strdup(http_request_why(request, code));
    if (status == STATUS_GOOD)
        return NULL;
    const char *text = request->answer.at ? request->answer.at + begin : "";
    size_t line = strcspn(text, "\r\n");
    return mem_printf("the core answered with HTTP status %ld: %.*s", status, (int)(line < LINE ? line : LINE), text);
}
