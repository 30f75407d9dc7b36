/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Accepts clients' requests for frames and gives them the encoded frames; render_thread.c draws the frames. */
#include "service/render_service.h"

#include "base/clock.h"
#include "base/mem.h"
#include "service/render_service_impl.h"

/* STUCK_NS: time without an answer to a check after which the render thread counts as stuck; REBUILDING_NS: the same while the
   thread rebuilds a lost GL context */
static const int64_t STUCK_NS = 12 * NS_PER_S, REBUILDING_NS = 120 * NS_PER_S;

/* --- requests, from any thread ---------------------------------------------------------------------------------------- */

/* Replaces a client's waiting request by a newer one. The result has the newer view and the higher urgency of the two. */
static void replace(struct frame_request *old, const struct frame_request *request)
{
    struct frame_request merged = *request;
    merged.always |= old->always;
    merged.alone |= old->alone;
    if (old->urgency < merged.urgency)
        merged.urgency = old->urgency;
    if (old->asked_ns < merged.asked_ns)
        merged.asked_ns = old->asked_ns;
    *old = merged;
}

/* Queues a client's frame request. The caller holds the lock. */
static enum request_outcome put(struct render_service *service, uint64_t id, const struct frame_request *request)
{
    struct render_client *client = render_service_find(service, id);
    service->has_news = true;
    if (client && client->pending) {
        replace(&client->request, request);
        return REQUEST_REPLACED;
    }
    if (request->only_replace) {
        if (client)
            client->left |= request->urgency == URGENCY_INPUT;
        return REQUEST_REFUSED;
    }
    int kind = scheduler_share(request->urgency);
    client = client ? client : render_service_add_client(service, id, request->account);
    client->request = *request;
    client->pending = true;
    client->spent_ns[kind] = scheduler_asked(client->spent_ns[kind], service->spent_ns[kind]);
    time_accounts_asked(&service->accounts, client->account, kind);
    return REQUEST_ADDED;
}

enum request_outcome render_service_request(struct render_service *service, uint64_t id, const struct frame_request *request)
{
    pthread_mutex_lock(&service->lock);
    enum request_outcome answer = put(service, id, request);
    pthread_mutex_unlock(&service->lock);
    return answer;
}

void render_service_request_all(struct render_service *service, size_t count, const uint64_t *clients, const struct frame_request *requests,
                                enum request_outcome *outcomes)
{
    pthread_mutex_lock(&service->lock);
    for (size_t i = 0; i < count; i++)
        outcomes[i] = put(service, clients[i], &requests[i]);
    pthread_mutex_unlock(&service->lock);
}

void render_service_wake(struct render_service *service)
{
    pthread_mutex_lock(&service->lock);
    if (service->has_news)
        pthread_cond_broadcast(&service->wake);
    service->has_news = false;
    pthread_mutex_unlock(&service->lock);
}

void render_service_pick(struct render_service *service, const struct pick_query *query)
{
    pick_queue_ask(service->picks, query);
    pthread_mutex_lock(&service->lock);
    pthread_cond_broadcast(&service->wake);
    pthread_mutex_unlock(&service->lock);
}

struct pick_answer *render_service_collect_picks(struct render_service *service)
{
    return pick_queue_collect(service->picks);
}

void render_service_withdraw(struct render_service *service, uint64_t id)
{
    struct request_group group = { 0 };
    pthread_mutex_lock(&service->lock);
    struct render_client *client = render_service_find(service, id);
    if (client)
        client->left = true;
    if (client && client->pending) {
        client->pending = false;
        request_group_add(&group, &(struct request_ticket){ .client = id, .number = ++client->number, .request = client->request });
    }
    pthread_mutex_unlock(&service->lock);
    if (group.count > 0)
        render_service_answer_without_frame(service, &group, FRAME_SKIPPED);
    request_group_finish(&group);
}

void render_service_forget(struct render_service *service, uint64_t id)
{
    pick_queue_forget(service->picks, id);
    pthread_mutex_lock(&service->lock);
    render_service_remove_client(service, id);
    encode_queue_forget(service->queue, id);
    if (service->client_count == 0)
        /* wakes the render thread: without clients, it may have to release its caches soon */
        pthread_cond_broadcast(&service->wake);
    pthread_mutex_unlock(&service->lock);
    encode_queue_sweep(service->queue);
}

void render_service_set_loop_checks(struct render_service *service, const struct loop_checks *loop_checks)
{
    pthread_mutex_lock(&service->lock);
    service->loop_checks = loop_checks;
    pthread_mutex_unlock(&service->lock);
}

void render_service_set_readings(struct render_service *service, const struct snapshot *readings)
{
    pthread_mutex_lock(&service->lock);
    snapshot_assign(service->readings, readings);
    pthread_mutex_unlock(&service->lock);
}

bool render_service_ready(struct render_service *service)
{
    pthread_mutex_lock(&service->lock);
    bool ready = service->state == RUNNING && !service->lost;
    pthread_mutex_unlock(&service->lock);
    return ready;
}

bool render_service_is_stuck(struct render_service *service, int64_t now_ns)
{
    pthread_mutex_lock(&service->lock);
    bool stuck = service->asked_ns && now_ns - service->asked_ns > (service->lost ? REBUILDING_NS : STUCK_NS);
    if (!service->asked_ns)
        service->asked_ns = now_ns;
    pthread_cond_broadcast(&service->wake);
    pthread_mutex_unlock(&service->lock);
    return stuck;
}

void render_service_lose_context(struct render_service *service)
{
    pthread_mutex_lock(&service->lock);
    service->lose = true;
    pthread_mutex_unlock(&service->lock);
}

/* --- life cycle ------------------------------------------------------------------------------------------------------- */

static bool thread_start(struct render_service *service)
{
    if (pthread_create(&service->thread, NULL, render_thread_main, service) != 0) {
        log_err(service->params.log, "render service: the render thread could not be started");
        return false;
    }
    service->has_thread = true;
    pthread_mutex_lock(&service->lock);
    while (service->state == STARTING)
        pthread_cond_wait(&service->wake, &service->lock);
    bool good = service->state == RUNNING;
    pthread_mutex_unlock(&service->lock);
    return good;
}

static void thread_stop(struct render_service *service)
{
    pthread_mutex_lock(&service->lock);
    service->state = STOPPING;
    pthread_cond_broadcast(&service->wake);
    pthread_mutex_unlock(&service->lock);
    if (service->has_thread)
        pthread_join(service->thread, NULL);
}

static void add_counters(struct render_service *service, struct counters *counters)
{
    service->renders = counters_add(counters, "plantcast_renders_total", "counter", "Pictures drawn.");
    service->render_us = counters_add_seconds(counters, "plantcast_render_seconds_total", "counter", "Seconds spent drawing pictures.");
    service->same =
        counters_add(counters, "plantcast_renders_saved_total", "counter", "Pictures not drawn because nothing visible had changed.");
    service->shared = counters_add(counters, "plantcast_renders_shared_total", "counter",
                                   "Pictures that were drawn for another client's request and reused.");
    service->failures = counters_add(counters, "plantcast_render_failures_total", "counter", "Pictures that could not be drawn.");
    service->steps = counters_add(counters, "plantcast_render_steps_total", "counter",
                                  "Steps in which refined pictures were drawn; a refined picture takes several steps.");
    service->abandoned = counters_add(counters, "plantcast_renders_abandoned_total", "counter",
                                      "Refined pictures abandoned before they were complete, because no client needed them any longer.");
    service->picked = counters_add(counters, "plantcast_picks_total", "counter", "Queries for the value at a pixel that were answered.");
    service->pick_us =
        counters_add_seconds(counters, "plantcast_pick_seconds_total", "counter", "Seconds spent on queries for the value at a pixel.");
    service->losses =
        counters_add(counters, "plantcast_gl_losses_total", "counter", "OpenGL contexts that were lost (GPU reset) and created again.");
}

struct render_service *render_service_create(const struct render_service_params *params)
{
    struct render_service *service = mem_new(sizeof(*service));
    service->params = *params;
    service->done_last = &service->done;
    service->picks = pick_queue_create();
    service->readings = snapshot_create(params->scene->plant->tag_count);
    pthread_mutex_init(&service->lock, NULL);
    clock_cond_init(&service->wake);
    add_counters(service, params->counters);
    service->queue = encode_queue_create(&(struct encode_queue_params){
        .log = params->log,
        .workers = params->workers,
        .counters = params->counters,
        .h264_library = params->h264_library ? params->h264_library : ENCODER_H264_LIBRARY,
        .done = render_service_on_encoded,
        .all_done = render_service_announce,
        .done_arg = service,
    });
    if (!thread_start(service))
        render_service_destroy(&service);
    return service;
}

void render_service_destroy(struct render_service **render_service_ptr)
{
    struct render_service *service = *render_service_ptr;
    if (!service)
        return;
    thread_stop(service);
    encode_queue_destroy(&service->queue);
    pick_queue_destroy(&service->picks);
    snapshot_destroy(&service->readings);
    for (struct encoded_frame *encoded = render_service_collect(service), *next; encoded; encoded = next) {
        next = encoded->next;
        encoded_frame_destroy(&encoded);
    }
    for (size_t i = 0; i < service->client_count; i++)
        mem_free(service->clients[i]);
    mem_free(service->clients);
    time_accounts_finish(&service->accounts);
    pthread_cond_destroy(&service->wake);
    pthread_mutex_destroy(&service->lock);
    mem_free(service);
    *render_service_ptr = NULL;
}
