/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Questions to the core, by libcurl. */
#include "corelink/core_history.h"

#include <curl/curl.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "corelink/core_instant.h"

enum { MOST_BYTES = 64 << 20, CONNECT_S = 4, SLOW_S = 10 /* without a byte */, STATUS_GOOD = 200 };

struct core_history {
    struct log *log;
    struct core_link *link;
    const _Atomic bool *stop;
    CURL *handle; /* keeps its connection */
    struct curl_slist *headers;
    struct text *out; /* of the question that is being asked */
    size_t begin;
    char error[CURL_ERROR_SIZE], said[CURL_ERROR_SIZE + 100]; /* said: as logged last; "": the last one was answered */
};

static size_t take(char *bytes, size_t size, size_t count, void *arg)
{
    struct core_history *history = arg;
    if (history->out->length - history->begin + size * count > MOST_BYTES)
        return 0;
    text_add_bytes(history->out, bytes, size * count);
    return size * count;
}

static int look(void *arg, curl_off_t a, curl_off_t b, curl_off_t c, curl_off_t d)
{
    const struct core_history *history = arg;
    (void)a, (void)b, (void)c, (void)d;
    return atomic_load(history->stop);
}

struct core_history *core_history_create(struct log *log, struct core_link *link, const _Atomic bool *stop)
{
    struct core_history *history = mem_new(sizeof(*history));
    CURL *handle = curl_easy_init();
    *history = (struct core_history){ .log = log, .link = link, .stop = stop, .handle = handle };
    if (!handle) {
        log_err(log, "history: no client for HTTP");
        core_history_destroy(&history);
        return NULL;
    }
    curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(handle, CURLOPT_PROXY, "");
    curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(handle, CURLOPT_QUICK_EXIT, 1L);
    curl_easy_setopt(handle, CURLOPT_SSLVERSION, (long)CURL_SSLVERSION_TLSv1_2);
    curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
    curl_easy_setopt(handle, CURLOPT_LOW_SPEED_LIMIT, 1L);
    curl_easy_setopt(handle, CURLOPT_LOW_SPEED_TIME, (long)SLOW_S);
    curl_easy_setopt(handle, CURLOPT_ERRORBUFFER, history->error);
    curl_easy_setopt(handle, CURLOPT_USERAGENT, "plantcastd");
    curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, take);
    curl_easy_setopt(handle, CURLOPT_WRITEDATA, history);
    curl_easy_setopt(handle, CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(handle, CURLOPT_XFERINFOFUNCTION, look);
    curl_easy_setopt(handle, CURLOPT_XFERINFODATA, history);
    return history;
}

void core_history_destroy(struct core_history **pointer)
{
    struct core_history *history = *pointer;
    if (!history)
        return;
    curl_easy_cleanup(history->handle);
    curl_slist_free_all(history->headers);
    mem_free(history);
    *pointer = NULL;
}

void core_history_add(struct text *path, const char *name, const char *value)
{
    text_add(path, "%c%s=", path->at && strchr(path->at, '?') ? '&' : '?', name);
    text_add_escaped(path, value);
}

static bool fail(struct core_history *history, const char *path, const char *why)
{
    char said[sizeof(history->said)];
    snprintf(said, sizeof(said), "%.*s: %s", (int)strcspn(path, "?"), path, why);
    if (strcmp(said, history->said) != 0 && !atomic_load(history->stop))
        log_err(history->log, "history: the core: %s", said);
    memcpy(history->said, said, sizeof(said));
    return false;
}

/* What it says in place of what it was asked for: its first line. */
static bool refused(struct core_history *history, const char *path, long status)
{
    char why[120];
    const char *text = history->out->at ? history->out->at + history->begin : "";
    snprintf(why, sizeof(why), "it answers %ld: %.*s", status, (int)strcspn(text, "\r\n"), text);
    return fail(history, path, why);
}

bool core_history_get(struct core_history *history, const char *path, struct text *out)
{
    struct core_peer peer;
    long status = 0;
    if (!core_link_peer(history->link, &peer))
        return fail(history, path, "there is no connection to it");
    char *url = mem_printf("%s%s", peer.url, path);
    CURL *handle = history->handle;
    curl_slist_free_all(history->headers);
    history->headers = NULL;
    if (peer.authorization[0]) {
        char *header = mem_printf("Authorization: %s", peer.authorization);
        history->headers = curl_slist_append(NULL, header);
        mem_free(header);
    }
    curl_easy_setopt(handle, CURLOPT_HTTPHEADER, history->headers);
    curl_easy_setopt(handle, CURLOPT_URL, url);
    if (peer.ca_path)
        curl_easy_setopt(handle, CURLOPT_CAINFO, peer.ca_path);
    history->out = out;
    history->begin = out->length;
    history->error[0] = 0;
    CURLcode code = curl_easy_perform(handle);
    curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &status);
    mem_free(url);
    bool good = code == CURLE_OK && status == STATUS_GOOD;
    if (good)
        history->said[0] = 0;
    else if (code != CURLE_OK)
        fail(history, path, history->error[0] ? history->error : curl_easy_strerror(code));
    else
        refused(history, path, status);
    if (!good && out->at)
        out->at[out->length = history->begin] = 0;
    return good;
}

bool core_history_instant(struct core_history *history, int64_t at_us, struct snapshot *snapshot, int64_t *first_us)
{
    struct text text = { 0 };
    char *path = mem_printf(CORE_INSTANT_PATH "?at_us=%lld", (long long)at_us);
    bool good = core_history_get(history, path, &text);
    const char *why = good ? core_instant_read(text.at, text.length, first_us, snapshot) : NULL;
    if (why)
        good = fail(history, path, why);
    mem_free(path);
    text_finish(&text);
    return good;
}
