/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP requests to the identity provider, using libcurl. */
#include "access/openid/openid_http.h"

#include <stdio.h>
#include <string.h>

#include "base/files/secret.h"
#include "base/mem.h"
#include "base/system/http_request.h"

enum { MAX_BYTES = 512 * 1024, CONNECT_S = 4, TIMEOUT_S = 7 };

static void wipe(struct text *text)
{
    if (text->at)
        explicit_bzero(text->at, text->length);
    text_finish(text);
}

static bool begin(struct http_request *request, const struct openid_config *config, const char *url, const char *bearer,
                  const _Atomic bool *stop)
{
    *request = (struct http_request){ .most_bytes = MAX_BYTES, .stop = stop };
    if (!http_request_make(request, "plantcastd", config->ca_file))
        return false;
    curl_easy_setopt(request->handle, CURLOPT_URL, url);
    curl_easy_setopt(request->handle, CURLOPT_PROTOCOLS_STR, config->issuer[4] == 's' ? "https" : "http,https");
    curl_easy_setopt(request->handle, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
    curl_easy_setopt(request->handle, CURLOPT_TIMEOUT, (long)TIMEOUT_S);
    http_request_authorize(request, "Bearer ", bearer);
    request->headers = curl_slist_append(request->headers, "Accept: application/json");
    curl_easy_setopt(request->handle, CURLOPT_HTTPHEADER, request->headers);
    return true;
}

static bool finish(struct http_request *request, struct openid_reply *reply)
{
    long status = 0;
    *reply = (struct openid_reply){ 0 };
    CURLcode code = CURLE_OUT_OF_MEMORY;
    if (request->handle) {
        code = curl_easy_perform(request->handle);
        curl_easy_getinfo(request->handle, CURLINFO_RESPONSE_CODE, &status);
    }
    if (code != CURLE_OK)
        snprintf(reply->why, sizeof(reply->why), "%s", http_request_why(request, code));
    else
        reply->status = (int)status;
    if (code == CURLE_OK && request->answer.at)
        reply->json = json_loadb(request->answer.at, request->answer.length, JSON_REJECT_DUPLICATES, NULL);
    wipe(&request->answer);
    http_request_finish(request);
    return reply->status != 0;
}

bool openid_get(const struct openid_config *config, const char *url, const char *bearer, const _Atomic bool *stop,
                struct openid_reply *reply)
{
    struct http_request request;
    begin(&request, config, url, bearer, stop);
    return finish(&request, reply);
}

static void set_client(struct http_request *request, const struct openid_config *config, const char *secret, bool in_form,
                       struct text *form)
{
    if (!secret || in_form)
        openid_add_argument(form, "client_id", config->client_id);
    if (secret && in_form)
        openid_add_argument(form, "client_secret", secret);
    if (!secret || in_form)
        return;
    struct text user = { 0 }, password = { 0 }; /* form-encodes client id and secret before Base64-encoding them (RFC 6749, 2.3.1) */
    openid_add_argument(&user, "", config->client_id);
    openid_add_argument(&password, "", secret);
    curl_easy_setopt(request->handle, CURLOPT_HTTPAUTH, (long)CURLAUTH_BASIC);
    curl_easy_setopt(request->handle, CURLOPT_USERNAME, user.at + 1);
    curl_easy_setopt(request->handle, CURLOPT_PASSWORD, password.at + 1);
    text_finish(&user);
    wipe(&password);
}

bool openid_post(const struct openid_config *config, const char *url, const char *form, bool in_form, const _Atomic bool *stop,
                 struct openid_reply *reply)
{
    struct http_request request;
    struct text body = { 0 };
    char *why = NULL, *secret = config->client_secret_file ? secret_read(config->client_secret_file, &why) : NULL;
    *reply = (struct openid_reply){ 0 };
    if (why) {
        snprintf(reply->why, sizeof(reply->why), "%s", why);
        mem_free(why);
        return false;
    }
    text_add(&body, "%s", form);
    if (begin(&request, config, url, NULL, stop)) {
        set_client(&request, config, secret, in_form, &body);
        curl_easy_setopt(request.handle, CURLOPT_POSTFIELDSIZE, (long)body.length);
        curl_easy_setopt(request.handle, CURLOPT_POSTFIELDS, body.at);
    }
    bool answered = finish(&request, reply);
    secret_forget(secret);
    wipe(&body);
    return answered;
}

void openid_reply_finish(struct openid_reply *reply)
{
    json_decref(reply->json);
    reply->json = NULL;
}

void openid_add_argument(struct text *out, const char *name, const char *value)
{
    char *encoded = curl_easy_escape(NULL, value, 0);
    text_add(out, "%s%s=%s", out->length ? "&" : "", name, encoded ? encoded : "");
    curl_free(encoded);
}
