/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wishes come in, pictures go out; the render thread in between is drawing.c. */
#include "net/paint/painter.h"

#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/paint/painter_impl.h"

/* Under lock. Where it is, or would be. */
static size_t place_of(const struct painter *painter, uint64_t id)
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

struct client *painter_find(struct painter *painter, uint64_t id)
{
    size_t place = place_of(painter, id);
    return place < painter->client_count && painter->clients[place]->id == id ? painter->clients[place] : NULL;
}

/* Under lock. */
static struct client *add_client(struct painter *painter, uint64_t id, uint64_t payer)
{
    size_t place = place_of(painter, id);
    mem_grow(&painter->clients, &painter->client_capacity, painter->client_count + 1, sizeof(struct client *));
    memmove(painter->clients + place + 1, painter->clients + place, (painter->client_count - place) * sizeof(struct client *));
    painter->client_count++;
    painter->clients[place] = mem_new(sizeof(struct client));
    painter->clients[place]->id = id;
    painter->clients[place]->payer = payers_join(&painter->payers, payer);
    return painter->clients[place];
}

/* --- pictures on their way back ------------------------------------------------------------------------------------------ */

static struct picture *picture_create(const struct order *order, bool failed)
{
    struct picture *picture = mem_new(sizeof(*picture));
    *picture = (struct picture){
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
static void give_back(struct painter *painter, struct picture *picture)
{
    pthread_mutex_lock(&painter->lock);
    *painter->done_last = picture;
    painter->done_last = &picture->next;
    pthread_mutex_unlock(&painter->lock);
}

static void announce(void *arg)
{
    struct painter *painter = arg;
    pthread_mutex_lock(&painter->lock);
    bool news = painter->done && !painter->announced;
    painter->announced |= news;
    pthread_mutex_unlock(&painter->lock);
    if (news)
        painter->params.notify(painter->params.notify_arg);
}

void painter_post_none(struct painter *painter, const struct batch *batch, bool failed)
{
    for (size_t i = 0; i < batch->count; i++)
        give_back(painter, picture_create(&batch->orders[i], failed));
    announce(painter);
}

static void on_encoded(void *arg, const struct order *order, struct packet *const *packets, int count, bool failed)
{
    struct picture *picture = picture_create(order, failed);
    if (count > 0)
        picture->packet = packet_ref(packets[count - 1]);
    if (count > 1)
        picture->earlier = mem_array((size_t)count - 1, sizeof(struct packet *));
    for (; picture->earlier_count < count - 1; picture->earlier_count++)
        picture->earlier[picture->earlier_count] = packet_ref(packets[picture->earlier_count]);
    give_back(arg, picture);
}

struct picture *painter_collect(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    struct picture *done = painter->done;
    painter->done = NULL;
    painter->done_last = &painter->done;
    painter->announced = false;
    pthread_mutex_unlock(&painter->lock);
    return done;
}

/* --- wishes, from any thread ----------------------------------------------------------------------------------------------- */

/* The newer view stands; what made the older one urgent stays. */
static void replace(struct wish *old, const struct wish *wish)
{
    struct wish merged = *wish;
    merged.always |= old->always;
    merged.alone |= old->alone;
    if (old->urgency < merged.urgency)
        merged.urgency = old->urgency;
    if (old->asked_ns < merged.asked_ns)
        merged.asked_ns = old->asked_ns;
    *old = merged;
}

enum painter_answer painter_ask(struct painter *painter, uint64_t id, const struct wish *wish)
{
    enum painter_answer answer = PAINTER_ADDED;
    pthread_mutex_lock(&painter->lock);
    struct client *client = painter_find(painter, id);
    if (client && client->pending) {
        replace(&client->wish, wish);
        answer = PAINTER_REPLACED;
    } else if (wish->only_replace) {
        if (client)
            client->left |= wish->urgency == URGENCY_INPUT;
        answer = PAINTER_REFUSED;
    } else {
        int share = schedule_share(wish->urgency);
        client = client ? client : add_client(painter, id, wish->payer);
        client->wish = *wish;
        client->pending = true;
        client->spent_ns[share] = schedule_asked(client->spent_ns[share], painter->spent_ns[share]);
        payers_asked(&painter->payers, client->payer, share);
    }
    pthread_mutex_unlock(&painter->lock);
    return answer;
}

void painter_go(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
}

void painter_pick(struct painter *painter, const struct pick_order *order)
{
    picks_ask(painter->picks, order);
    painter_go(painter);
}

struct pick_answer *painter_collect_picks(struct painter *painter)
{
    return picks_collect(painter->picks);
}

void painter_forget(struct painter *painter, uint64_t id)
{
    picks_forget(painter->picks, id);
    pthread_mutex_lock(&painter->lock);
    size_t place = place_of(painter, id);
    if (place < painter->client_count && painter->clients[place]->id == id) {
        payers_leave(&painter->payers, &painter->clients[place]->payer);
        mem_free(painter->clients[place]);
        painter->client_count--;
        memmove(painter->clients + place, painter->clients + place + 1, (painter->client_count - place) * sizeof(struct client *));
    }
    encoding_forget(painter->encoding, id);
    if (painter->client_count == 0)
        pthread_cond_broadcast(&painter->wake); /* it may rest soon */
    pthread_mutex_unlock(&painter->lock);
    encoding_sweep(painter->encoding);
}

void painter_set_proofs(struct painter *painter, const struct proofs *proofs)
{
    pthread_mutex_lock(&painter->lock);
    painter->proofs = proofs;
    pthread_mutex_unlock(&painter->lock);
}

void painter_new_data(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    painter->new_data = true;
    pthread_mutex_unlock(&painter->lock);
}

bool painter_ready(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    bool ready = painter->state == RUNNING && !painter->lost;
    pthread_mutex_unlock(&painter->lock);
    return ready;
}

void painter_lose_context(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    painter->lose = true;
    pthread_mutex_unlock(&painter->lock);
}

/* --- life ------------------------------------------------------------------------------------------------------------------ */

static bool thread_start(struct painter *painter)
{
    if (pthread_create(&painter->thread, NULL, drawing_main, painter) != 0) {
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

static void thread_stop(struct painter *painter)
{
    pthread_mutex_lock(&painter->lock);
    painter->state = STOPPING;
    pthread_cond_broadcast(&painter->wake);
    pthread_mutex_unlock(&painter->lock);
    if (painter->has_thread)
        pthread_join(painter->thread, NULL);
}

static void add_counters(struct painter *painter, struct counters *counters)
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

struct painter *painter_create(const struct painter_params *params)
{
    struct painter *painter = mem_new(sizeof(*painter));
    painter->params = *params;
    painter->done_last = &painter->done;
    painter->picks = picks_create();
    pthread_mutex_init(&painter->lock, NULL);
    clock_cond_init(&painter->wake);
    add_counters(painter, params->counters);
    painter->encoding = encoding_create(&(struct encoding_params){
        .log = params->log,
        .workers = params->workers,
        .counters = params->counters,
        .h264_library = params->h264_library ? params->h264_library : ENCODER_H264_LIBRARY,
        .done = on_encoded,
        .all_done = announce,
        .done_arg = painter,
    });
    if (!thread_start(painter))
        painter_destroy(&painter);
    return painter;
}

void painter_destroy(struct painter **painter_ptr)
{
    struct painter *painter = *painter_ptr;
    if (!painter)
        return;
    thread_stop(painter);
    encoding_destroy(&painter->encoding);
    picks_destroy(&painter->picks);
    for (struct picture *picture = painter_collect(painter), *next; picture; picture = next) {
        next = picture->next;
        picture_destroy(&picture);
    }
    for (size_t i = 0; i < painter->client_count; i++)
        mem_free(painter->clients[i]);
    mem_free(painter->clients);
    payers_finish(&painter->payers);
    pthread_cond_destroy(&painter->wake);
    pthread_mutex_destroy(&painter->lock);
    mem_free(painter);
    *painter_ptr = NULL;
}
