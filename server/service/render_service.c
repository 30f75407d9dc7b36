/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wishes come in, pictures go out; the render thread in between is drawing.c. */
#include "service/render_service.h"

#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "service/render_service_impl.h"

/* Under lock. Where it is, or would be. */
static size_t place_of(const struct render_service *painter, uint64_t id)
{
    size_t low = 0, high = painter->client_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (painter->clients[middle]->id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

struct render_client *render_service_find(struct render_service *painter, uint64_t id)
{
    size_t place = place_of(painter, id);
    return place < painter->client_count && painter->clients[place]->id == id ? painter->clients[place] : NULL;
}

/* Under lock. */
static struct render_client *add_client(struct render_service *painter, uint64_t id, uint64_t payer)
{
    size_t place = place_of(painter, id);
    mem_grow(&painter->clients, &painter->client_capacity, painter->client_count + 1, sizeof(struct render_client *));
    memmove(painter->clients + place + 1, painter->clients + place, (painter->client_count - place) * sizeof(struct render_client *));
    painter->client_count++;
    painter->clients[place] = mem_new(sizeof(struct render_client));
    painter->clients[place]->id = id;
    painter->clients[place]->payer = time_accounts_join(&painter->payers, payer);
    return painter->clients[place];
}

/* --- pictures on their way back ------------------------------------------------------------------------------------------ */

static struct encoded_frame *encoded_frame_create(const struct request_ticket *order, bool failed)
{
    struct encoded_frame *picture = mem_new(sizeof(*picture));
    *picture = (struct encoded_frame){
        .client = order->client,
        .number = order->number,
        .failed = failed,
        .wish = order->wish,
        .wait_ns = order->wait_ns,
        .made_ns = clock_mono_ns(),
    };
    return picture;
}

/* Takes it; who gives several says so once, after the last: announce(). */
static void give_back(struct render_service *painter, struct encoded_frame *picture)
{
    pthread_mutex_lock(&painter->lock);
    *painter->done_last = picture;
    painter->done_last = &picture->next;
    pthread_mutex_unlock(&painter->lock);
}

static void announce(void *arg)
{
    struct render_service *painter = arg;
    pthread_mutex_lock(&painter->lock);
    bool news = painter->done && !painter->announced;
    painter->announced |= news;
    pthread_mutex_unlock(&painter->lock);
    if (news)
        painter->params.notify(painter->params.notify_arg);
}

void render_service_answer_without_frame(struct render_service *painter, const struct request_group *batch, bool failed)
{
    for (size_t i = 0; i < batch->count; i++)
        give_back(painter, encoded_frame_create(&batch->orders[i], failed));
    announce(painter);
}

/* What could not be encoded was not shown: the next that asks for it is not told that it has it. */
static void forget_content(struct render_service *painter, uint64_t id)
{
    pthread_mutex_lock(&painter->lock);
    struct render_client *client = render_service_find(painter, id);
    if (client)
        client->has_content = false;
    pthread_mutex_unlock(&painter->lock);
}

static void on_encoded(void *arg, const struct request_ticket *order, struct packet *const *packets, int count, bool failed)
{
    struct encoded_frame *picture = encoded_frame_create(order, failed);
    if (failed)
        forget_content(arg, order->client);
    if (count > 0)
        picture->packet = packet_ref(packets[count - 1]);
    if (count > 1)
        picture->earlier = mem_array((size_t)count - 1, sizeof(struct packet *));
    for (; picture->earlier_count < count - 1; picture->earlier_count++)
        picture->earlier[picture->earlier_count] = packet_ref(packets[picture->earlier_count]);
    give_back(arg, picture);
}

struct encoded_frame *render_service_collect(struct render_service *painter)
{
    pthread_mutex_lock(&painter->lock);
    struct encoded_frame *done = painter->done;
    painter->done = NULL;
    painter->done_last = &painter->done;
    painter->announced = false;
    pthread_mutex_unlock(&painter->lock);
    return done;
}

/* --- wishes, from any thread ----------------------------------------------------------------------------------------------- */

/* The newer view stands; what made the older one urgent stays. */
static void replace(struct frame_request *old, const struct frame_request *wish)
{
    struct frame_request merged = *wish;
    merged.always |= old->always;
    merged.alone |= old->alone;
    if (old->urgency < merged.urgency)
        merged.urgency = old->urgency;
    if (old->asked_ns < merged.asked_ns)
        merged.asked_ns = old->asked_ns;
    *old = merged;
}

enum request_outcome render_service_request(struct render_service *painter, uint64_t id, const struct frame_request *wish)
{
    enum request_outcome answer = REQUEST_ADDED;
    pthread_mutex_lock(&painter->lock);
    struct render_client *client = render_service_find(painter, id);
    if (client && client->pending) {
        replace(&client->wish, wish);
        answer = REQUEST_REPLACED;
    } else if (wish->only_replace) {
        if (client)
            client->left |= wish->urgency == URGENCY_INPUT;
        answer = REQUEST_REFUSED;
    } else {
        int share = scheduler_share(wish->urgency);
        client = client ? client : add_client(painter, id, wish->payer);
        client->wish = *wish;
        client->pending = true;
        client->spent_ns[share] = scheduler_asked(client->spent_ns[share], painter->spent_ns[share]);
        time_accounts_asked(&painter->payers, client->payer, share);
    }
    pthread_mutex_unlock(&painter->lock);
    return answer;
}

void render_service_wake(struct render_service *painter)
{
    pthread_mutex_lock(&painter->lock);
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
}

void render_service_pick(struct render_service *painter, const struct pick_query *order)
{
    pick_queue_ask(painter->picks, order);
    render_service_wake(painter);
}

struct pick_answer *render_service_collect_picks(struct render_service *painter)
{
    return pick_queue_collect(painter->picks);
}

void render_service_forget(struct render_service *painter, uint64_t id)
{
    pick_queue_forget(painter->picks, id);
    pthread_mutex_lock(&painter->lock);
    size_t place = place_of(painter, id);
    if (place < painter->client_count && painter->clients[place]->id == id) {
        time_accounts_leave(&painter->payers, &painter->clients[place]->payer);
        mem_free(painter->clients[place]);
        painter->client_count--;
        memmove(painter->clients + place, painter->clients + place + 1, (painter->client_count - place) * sizeof(struct render_client *));
    }
    encode_queue_forget(painter->encoding, id);
    if (painter->client_count == 0)
        pthread_cond_broadcast(&painter->wake); /* it may rest soon */
    pthread_mutex_unlock(&painter->lock);
    encode_queue_sweep(painter->encoding);
}

void render_service_set_loop_checks(struct render_service *painter, const struct loop_checks *loop_checks)
{
    pthread_mutex_lock(&painter->lock);
    painter->loop_checks = loop_checks;
    pthread_mutex_unlock(&painter->lock);
}

void render_service_on_data(struct render_service *painter)
{
    pthread_mutex_lock(&painter->lock);
    painter->new_data = true;
    pthread_mutex_unlock(&painter->lock);
}

bool render_service_ready(struct render_service *painter)
{
    pthread_mutex_lock(&painter->lock);
    bool ready = painter->state == RUNNING && !painter->lost;
    pthread_mutex_unlock(&painter->lock);
    return ready;
}

void render_service_lose_context(struct render_service *painter)
{
    pthread_mutex_lock(&painter->lock);
    painter->lose = true;
    pthread_mutex_unlock(&painter->lock);
}

/* --- life ------------------------------------------------------------------------------------------------------------------ */

static bool thread_start(struct render_service *painter)
{
    if (pthread_create(&painter->thread, NULL, render_thread_main, painter) != 0) {
        log_err(painter->params.log, "painter: no thread could be started");
        return false;
    }
    painter->has_thread = true;
    pthread_mutex_lock(&painter->lock);
    while (painter->state == STARTING)
        pthread_cond_wait(&painter->wake, &painter->lock);
    bool good = painter->state == RUNNING;
    pthread_mutex_unlock(&painter->lock);
    return good;
}

static void thread_stop(struct render_service *painter)
{
    pthread_mutex_lock(&painter->lock);
    painter->state = STOPPING;
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
    if (painter->has_thread)
        pthread_join(painter->thread, NULL);
}

static void add_counters(struct render_service *painter, struct counters *counters)
{
    painter->renders = counters_add(counters, "plantcast_renders_total", "counter", "Pictures drawn.");
    painter->render_us = counters_add(counters, "plantcast_render_us_total", "counter", "Microseconds spent drawing.");
    painter->same = counters_add(counters, "plantcast_renders_saved_total", "counter", "Pictures not drawn: nothing had changed.");
    painter->shared = counters_add(counters, "plantcast_renders_shared_total", "counter", "Pictures that had just been drawn for another.");
    painter->failures = counters_add(counters, "plantcast_render_failures_total", "counter", "Pictures that could not be drawn.");
    painter->steps = counters_add(counters, "plantcast_render_steps_total", "counter", "Parts of pictures that take long.");
    painter->abandoned = counters_add(counters, "plantcast_renders_abandoned_total", "counter", "Pictures given up: nobody wanted them.");
    painter->picked = counters_add(counters, "plantcast_picks_total", "counter", "Questions about a pixel that were answered.");
    painter->pick_us = counters_add(counters, "plantcast_pick_us_total", "counter", "Microseconds spent answering them.");
    painter->losses = counters_add(counters, "plantcast_gl_losses_total", "counter", "GL contexts that were lost and made again.");
}

struct render_service *render_service_create(const struct render_service_params *params)
{
    struct render_service *painter = mem_new(sizeof(*painter));
    painter->params = *params;
    painter->done_last = &painter->done;
    painter->picks = pick_queue_create();
    pthread_mutex_init(&painter->lock, NULL);
    clock_cond_init(&painter->wake);
    add_counters(painter, params->counters);
    painter->encoding = encode_queue_create(&(struct encode_queue_params){
        .log = params->log,
        .workers = params->workers,
        .counters = params->counters,
        .h264_library = params->h264_library ? params->h264_library : ENCODER_H264_LIBRARY,
        .done = on_encoded,
        .all_done = announce,
        .done_arg = painter,
    });
    if (!thread_start(painter))
        render_service_destroy(&painter);
    return painter;
}

void render_service_destroy(struct render_service **render_service_ptr)
{
    struct render_service *painter = *render_service_ptr;
    if (!painter)
        return;
    thread_stop(painter);
    encode_queue_destroy(&painter->encoding);
    pick_queue_destroy(&painter->picks);
    for (struct encoded_frame *picture = render_service_collect(painter), *next; picture; picture = next) {
        next = picture->next;
        encoded_frame_destroy(&picture);
    }
    for (size_t i = 0; i < painter->client_count; i++)
        mem_free(painter->clients[i]);
    mem_free(painter->clients);
    time_accounts_finish(&painter->payers);
    pthread_cond_destroy(&painter->wake);
    pthread_mutex_destroy(&painter->lock);
    mem_free(painter);
    *render_service_ptr = NULL;
}
