/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP to the identity provider, by libcurl. */
#include "access/openid/openid_http.h"

#include <curl/curl.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text.h"

enum { MOST_BYTES = 512 * 1024, SECRET_BYTES = 4096, CONNECT_S = 4, TIMEOUT_S = 7 };

struct transfer {
    CURL *handle;
    struct curl_slist *headers;
    struct text body;
    const _Atomic bool *stop;
    char why[CURL_ERROR_SIZE];
};

static size_t take(char *bytes, size_t size, size_t count, void *arg)
{
    struct transfer *transfer = arg;
    if (transfer->body.length + size * count > MOST_BYTES)
        return 0;
    text_add_bytes(&transfer->body, bytes, size * count);
    return size * count;
}

static int look(void *arg, curl_off_t a, curl_off_t b, curl_off_t c, curl_off_t d)
{
    const struct transfer *transfer = arg;
    (void)a, (void)b, (void)c, (void)d;
    return atomic_load(transfer->stop);
}

static void wipe(struct text *text)
{
    if (text->at)
        explicit_bzero(text->at, text->length);
    text_finish(text);
}

static bool begin(struct transfer *transfer, const struct openid_config *config, const char *url, const _Atomic bool *stop)
{
    CURL *handle = curl_easy_init();
    *transfer = (struct transfer){ .handle = handle, .stop = stop };
    if (!handle)
        return false;
    curl_easy_setopt(handle, CURLOPT_URL, url);
    curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, config->issuer[4] == 's' ? "https" : "http,https");
    curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(handle, CURLOPT_QUICK_EXIT, 1L);
    curl_easy_setopt(handle, CURLOPT_SSLVERSION, (long)CURL_SSLVERSION_TLSv1_2);
    curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
    curl_easy_setopt(handle, CURLOPT_TIMEOUT, (long)TIMEOUT_S);
    curl_easy_setopt(handle, CURLOPT_ERRORBUFFER, transfer->why);
    curl_easy_setopt(handle, CURLOPT_USERAGENT, "plantcastd");
    curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, take);
    curl_easy_setopt(handle, CURLOPT_WRITEDATA, transfer);
    curl_easy_setopt(handle, CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(handle, CURLOPT_XFERINFOFUNCTION, look);
    curl_easy_setopt(handle, CURLOPT_XFERINFODATA, transfer);
    if (config->ca_file)
        curl_easy_setopt(handle, CURLOPT_CAINFO, config->ca_file);
    transfer->headers = curl_slist_append(transfer->headers, "Accept: application/json");
    return true;
}

static bool finish(struct transfer *transfer, struct openid_reply *reply)
{
    long status = 0;
    *reply = (struct openid_reply){ 0 };
    CURLcode code = CURLE_OUT_OF_MEMORY;
    if (transfer->handle) {
        curl_easy_setopt(transfer->handle, CURLOPT_HTTPHEADER, transfer->headers);
        code = curl_easy_perform(transfer->handle);
        curl_easy_getinfo(transfer->handle, CURLINFO_RESPONSE_CODE, &status);
    }
    if (code != CURLE_OK)
        snprintf(reply->why, sizeof(reply->why), "%s", transfer->why[0] ? transfer->why : curl_easy_strerror(code));
    else
        reply->status = (int)status;
    if (code == CURLE_OK && transfer->body.at)
        reply->json = json_loadb(transfer->body.at, transfer->body.length, JSON_REJECT_DUPLICATES, NULL);
    curl_slist_free_all(transfer->headers);
    curl_easy_cleanup(transfer->handle);
    wipe(&transfer->body);
    return reply->status != 0;
}

bool openid_get(const struct openid_config *config, const char *url, const char *bearer, const _Atomic bool *stop,
                struct openid_reply *reply)
{
    struct transfer transfer;
    if (begin(&transfer, config, url, stop) && bearer) {
        char *header = mem_printf("Authorization: Bearer %s", bearer);
        transfer.headers = curl_slist_append(transfer.headers, header);
        explicit_bzero(header, strlen(header));
        mem_free(header);
    }
    return finish(&transfer, reply);
}

/* The first line of its file. NULL: *why. */
static char *read_secret(const char *path, char *why, size_t size)
{
    size_t count;
    char *secret = text_read_file(path, SECRET_BYTES, &count);
    if (secret)
        secret[strcspn(secret, "\r\n")] = 0;
    else
        snprintf(why, size, "%s: %s", path, strerror(errno));
    return secret;
}

static void set_client(struct transfer *transfer, const struct openid_config *config, const char *secret, bool in_form, struct text *form)
{
    if (!secret || in_form)
        openid_add_argument(form, "client_id", config->client_id);
    if (secret && in_form)
        openid_add_argument(form, "client_secret", secret);
    if (!secret || in_form)
        return;
    struct text user = { 0 }, password = { 0 }; /* RFC 6749, 2.3.1: both are encoded as in a form */
    openid_add_argument(&user, "", config->client_id);
    openid_add_argument(&password, "", secret);
    curl_easy_setopt(transfer->handle, CURLOPT_HTTPAUTH, (long)CURLAUTH_BASIC);
    curl_easy_setopt(transfer->handle, CURLOPT_USERNAME, user.at + 1);
    curl_easy_setopt(transfer->handle, CURLOPT_PASSWORD, password.at + 1);
    text_finish(&user);
    wipe(&password);
}

bool openid_post(const struct openid_config *config, const char *url, const char *form, bool in_form, const _Atomic bool *stop,
                 struct openid_reply *reply)
{
    struct transfer transfer;
    struct text body = { 0 };
    char *secret = NULL;
    *reply = (struct openid_reply){ 0 };
    if (config->client_secret_file && !(secret = read_secret(config->client_secret_file, reply->why, sizeof(reply->why))))
        return false;
    text_add(&body, "%s", form);
    if (begin(&transfer, config, url, stop)) {
        set_client(&transfer, config, secret, in_form, &body);
        curl_easy_setopt(transfer.handle, CURLOPT_POSTFIELDSIZE, (long)body.length);
        curl_easy_setopt(transfer.handle, CURLOPT_POSTFIELDS, body.at);
    }
    bool answered = finish(&transfer, reply);
    if (secret)
        explicit_bzero(secret, strlen(secret));
    mem_free(secret);
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
