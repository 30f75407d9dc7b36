/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queries the core for recorded data over HTTP. */
#include "corelink/core_history.h"

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "corelink/core_instant.h"
#include "corelink/core_request.h"

enum { MAX_ANSWER_BYTES = 64 << 20 };

struct core_history {
    struct log *log;
    struct core_link *link;
    const _Atomic bool *stop;
    struct http_request request;
    /* text of the last logged error, so that a repeated error is not logged again; empty: the last query succeeded */
    char said[CURL_ERROR_SIZE + 100];
};

struct core_history *core_history_create(struct log *log, struct core_link *link, const _Atomic bool *stop)
{
    struct core_history *history = mem_new(sizeof(*history));
    *history = (struct core_history){ .log = log, .link = link, .stop = stop, .request = { .stop = stop } };
    if (!core_request_make(&history->request)) {
        log_err(log, "history: cannot start the HTTP client that reads the core's history");
        core_history_destroy(&history);
        return NULL;
    }
    return history;
}

void core_history_destroy(struct core_history **pointer)
{
    struct core_history *history = *pointer;
    if (!history)
        return;
    http_request_finish(&history->request);
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
        log_err(history->log, "history: cannot read from the core: %s", said);
    memcpy(history->said, said, sizeof(said));
    return false;
}

bool core_history_get(struct core_history *history, const char *path, struct text *out)
{
    struct core_peer peer;
    struct http_request *request = &history->request;
    if (!core_link_peer(history->link, &peer))
        return fail(history, path, "not connected to the core");
    core_request_address(request, &peer, path);
    size_t begin = out->length; /* the HTTP answer is appended to the text that *out already contains */
    request->answer = *out;
    request->most_bytes = begin + MAX_ANSWER_BYTES;
    char *why = core_request_send(request);
    *out = request->answer;
    request->answer = (struct text){ 0 };
    bool good = !why;
    if (good)
        history->said[0] = 0;
    else
        fail(history, path, why);
    if (!good && out->at)
        out->at[out->length = begin] = 0;
    mem_free(why);
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
