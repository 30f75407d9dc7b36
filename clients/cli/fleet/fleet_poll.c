/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that asks the servers of a fleet for their metrics and pictures, and stores the responses. */
#include "fleet_poll.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/files/secret.h"
#include "base/mem.h"
#include "base/system/http_request.h"

enum { METRICS_BYTES = 4 << 20, PICTURE_BYTES = 2 << 20, TIMEOUT_S = 15, PICTURE_TIMEOUT_S = 60, AT_ONCE = 16 };
#define PICTURE_PATH "snapshot.png?width=320&height=180"

enum fleet_question { METRICS, PICTURE, KINDS };

struct fleet_request {
    struct http_request http; /* libcurl handle; its connection is reused for the next request to this server */
    int plant;
    enum fleet_question kind;
    int64_t due_ns;
    bool running;
};

struct picture {
    char *at;
    size_t bytes;
    uint64_t number; /* number of pictures received */
};

struct fleet_poll {
    const struct fleet_file *file;
    pthread_t thread;
    bool started;
    _Atomic bool stopping;
    CURLM *multi;
    struct fleet_request *requests; /* KINDS for each plant */
    int running;
    pthread_mutex_t lock;
    /* --- below: under lock */
    struct fleet_plant_state *states;
    struct picture *pictures;
};

/* --- one request ------------------------------------------------------------------------------------------------------------ */

static bool set_token(struct fleet_request *request, const struct fleet_plant *plant)
{
    char *why = NULL, *token = plant->token_file ? secret_read(plant->token_file, &why) : NULL;
    http_request_authorize(&request->http, "Bearer ", token);
    secret_forget(token);
    if (why)
        snprintf(request->http.error, sizeof(request->http.error), "%s", why);
    mem_free(why);
    return token || !plant->token_file;
}

static bool make_request(const struct fleet_plant *plant, struct fleet_request *request)
{
    bool metrics = request->kind == METRICS;
    request->http.most_bytes = metrics ? METRICS_BYTES : PICTURE_BYTES;
    if (!http_request_make(&request->http, "plantcast-fleet", plant->ca_file))
        return false;
    CURL *handle = request->http.handle;
    char *url = mem_printf("%s%s", plant->url, metrics ? "metrics" : PICTURE_PATH);
    curl_easy_setopt(handle, CURLOPT_URL, url);
    mem_free(url);
    curl_easy_setopt(handle, CURLOPT_CONNECTTIMEOUT, (long)TIMEOUT_S);
    curl_easy_setopt(handle, CURLOPT_TIMEOUT, (long)(metrics ? TIMEOUT_S : PICTURE_TIMEOUT_S));
    curl_easy_setopt(handle, CURLOPT_FAILONERROR, 1L);
    curl_easy_setopt(handle, CURLOPT_ACCEPT_ENCODING, "");
    curl_easy_setopt(handle, CURLOPT_PRIVATE, (void *)request);
    return true;
}

/* Stores a complete response: the state of the plant's server, or its picture. Returns NULL if the response is valid, else the fault. */
static const char *note_answer(struct fleet_poll *poll, struct fleet_request *request)
{
    struct fleet_plant_state *known = &poll->states[request->plant];
    struct picture *picture = &poll->pictures[request->plant];
    if (request->kind == PICTURE) {
        if (request->http.answer.length <= 8 || memcmp(request->http.answer.at, "\x89PNG\r\n\x1a\n", 8) != 0)
            return "the server's picture is not a PNG file";
        mem_free(picture->at);
        *picture = (struct picture){ request->http.answer.at, request->http.answer.length, picture->number + 1 };
        request->http.answer = (struct text){ 0 };
        known->picture = picture->number;
        return NULL;
    }
    struct fleet_state state;
    if (!fleet_state_read(request->http.answer.at ? request->http.answer.at : "", &state))
        return "the server at this address is not a Plantcast server";
    known->state = state;
    known->answers = true;
    known->answered_us = clock_utc_ns() / 1000;
    known->silent_us = 0;
    known->why[0] = 0;
    return NULL;
}

static void note_failure(struct fleet_poll *poll, const struct fleet_request *request, const char *why)
{
    struct fleet_plant_state *known = &poll->states[request->plant];
    struct picture *picture = &poll->pictures[request->plant];
    /* if the request for a picture failed, removes the old picture, because users would take it for the present state */
    if (request->kind == PICTURE) {
        mem_free(picture->at);
        picture->at = NULL;
        known->picture = 0;
        return;
    }
    known->answers = false;
    if (!known->silent_us)
        known->silent_us = clock_utc_ns() / 1000;
    snprintf(known->why, sizeof(known->why), "%s", why);
}

/* Returns the nanoseconds until the plant's server is next asked for the same thing (metrics or picture): the interval in the
   fleet file, or up to an hour if a busy server asked for more with a Retry-After header. */
static int64_t pause_ns(const struct fleet_poll *poll, const struct fleet_request *request)
{
    const struct fleet_plant *plant = &poll->file->plants[request->plant];
    curl_off_t later_s = 0;
    curl_easy_getinfo(request->http.handle, CURLINFO_RETRY_AFTER, &later_s);
    double s = request->kind == METRICS ? plant->poll_s : plant->picture_s;
    s = (double)later_s > s ? (double)(later_s < 3600 ? later_s : 3600) : s;
    return (int64_t)(s * 1e9);
}

static void on_end(void *arg, void *ended, CURLcode code)
{
    struct fleet_poll *poll = arg;
    struct fleet_request *request = ended;
    const char *why = code == CURLE_OK ? NULL : http_request_why(&request->http, code);
    pthread_mutex_lock(&poll->lock);
    if (!why)
        why = note_answer(poll, request);
    if (why)
        note_failure(poll, request, why);
    pthread_mutex_unlock(&poll->lock);
    text_finish(&request->http.answer);
    request->running = false;
    request->due_ns = clock_mono_ns() + pause_ns(poll, request);
    poll->running--;
}

static void begin(struct fleet_poll *poll, struct fleet_request *request)
{
    const struct fleet_plant *plant = &poll->file->plants[request->plant];
    request->http.error[0] = 0;
    request->running = true;
    poll->running++;
    pthread_mutex_lock(&poll->lock);
    poll->states[request->plant].asked++;
    pthread_mutex_unlock(&poll->lock);
    if (!request->http.handle && !make_request(plant, request))
        on_end(poll, request, CURLE_OUT_OF_MEMORY);
    else if (!set_token(request, plant))
        on_end(poll, request, CURLE_READ_ERROR);
    else
        curl_multi_add_handle(poll->multi, request->http.handle);
}

/* --- the thread ------------------------------------------------------------------------------------------------------------- */

/* Starts the requests that are due. Requests pictures only from servers that answer. Returns when the next request is due. */
static int64_t begin_due(struct fleet_poll *poll, int64_t now_ns)
{
    int64_t next_ns = now_ns + NS_PER_S;
    for (size_t i = 0; i < poll->file->count * KINDS; i++) {
        struct fleet_request *request = &poll->requests[i];
        if (request->running || (request->kind == PICTURE && !poll->file->plants[request->plant].picture_s))
            continue;
        if (request->kind == PICTURE && !poll->states[request->plant].answers)
            continue;
        if (request->due_ns <= now_ns && poll->running < AT_ONCE)
            begin(poll, request);
        else if (request->due_ns > now_ns && request->due_ns < next_ns)
            next_ns = request->due_ns;
    }
    return next_ns;
}

static void *fleet_poll_main(void *arg)
{
    struct fleet_poll *poll = arg;
    while (!atomic_load(&poll->stopping)) {
        int64_t now_ns = clock_mono_ns(), next_ns = begin_due(poll, now_ns);
        http_requests_wait(poll->multi, (int)((next_ns - now_ns) / NS_PER_MS) + 1, on_end, poll);
    }
    return NULL;
}

/* --- start and stop --------------------------------------------------------------------------------------------------------- */

struct fleet_poll *fleet_poll_start(const struct fleet_file *file)
{
    struct fleet_poll *poll = mem_new(sizeof(*poll));
    int64_t now_ns = clock_mono_ns();
    poll->file = file;
    pthread_mutex_init(&poll->lock, NULL);
    poll->states = mem_array(file->count, sizeof(*poll->states));
    poll->pictures = mem_array(file->count, sizeof(*poll->pictures));
    poll->requests = mem_array(file->count * KINDS, sizeof(*poll->requests));
    for (size_t i = 0; i < file->count * KINDS; i++) {
        struct fleet_request *request = &poll->requests[i];
        request->plant = (int)(i / KINDS);
        request->kind = (enum fleet_question)(i % KINDS);
        /* spreads the first requests over 5 s, because otherwise all servers would always be asked at the same time */
        request->due_ns = now_ns + (int64_t)(i / KINDS) * 5 * NS_PER_S / (int64_t)file->count;
    }
    curl_global_init(CURL_GLOBAL_DEFAULT);
    poll->multi = curl_multi_init();
    curl_multi_setopt(poll->multi, CURLMOPT_MAXCONNECTS, (long)(file->count + AT_ONCE));
    poll->started = pthread_create(&poll->thread, NULL, fleet_poll_main, poll) == 0;
    if (!poll->started) {
        fprintf(stderr, "plantcast: cannot start the thread that polls the plants' servers\n");
        fleet_poll_stop(&poll);
    }
    return poll;
}

void fleet_poll_stop(struct fleet_poll **pointer)
{
    struct fleet_poll *poll = *pointer;
    if (!poll)
        return;
    atomic_store(&poll->stopping, true);
    if (poll->started) {
        curl_multi_wakeup(poll->multi);
        pthread_join(poll->thread, NULL);
    }
    for (size_t i = 0; i < poll->file->count * KINDS; i++) {
        struct fleet_request *request = &poll->requests[i];
        if (request->running)
            curl_multi_remove_handle(poll->multi, request->http.handle);
        http_request_finish(&request->http);
    }
    curl_multi_cleanup(poll->multi);
    for (size_t i = 0; i < poll->file->count; i++)
        mem_free(poll->pictures[i].at);
    mem_free(poll->pictures);
    mem_free(poll->states);
    mem_free(poll->requests);
    pthread_mutex_destroy(&poll->lock);
    mem_free(poll);
    *pointer = NULL;
}

struct fleet_plant_state *fleet_poll_states(struct fleet_poll *poll)
{
    struct fleet_plant_state *copy = mem_array(poll->file->count, sizeof(*copy));
    pthread_mutex_lock(&poll->lock);
    memcpy(copy, poll->states, poll->file->count * sizeof(*copy));
    pthread_mutex_unlock(&poll->lock);
    return copy;
}

char *fleet_poll_picture(struct fleet_poll *poll, const char *id, size_t *bytes)
{
    char *copy = NULL;
    pthread_mutex_lock(&poll->lock);
    for (size_t i = 0; i < poll->file->count; i++) {
        const struct picture *picture = &poll->pictures[i];
        if (strcmp(poll->file->plants[i].id, id) != 0 || !picture->at)
            continue;
        *bytes = picture->bytes;
        copy = mem_array(picture->bytes, 1);
        memcpy(copy, picture->at, picture->bytes);
    }
    pthread_mutex_unlock(&poll->lock);
    return copy;
}
