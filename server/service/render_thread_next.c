/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the render thread does next. */
#include "base/clock.h"
#include "service/render_thread_impl.h"

static const int64_t OWN_DATA_NS = 1 * NS_PER_S; /* changed readings wait so long for a refinement of the same client */
enum { OVERTAKE_SMALLER = 4 }; /* times, in pixels, than what it overtakes: one more of that size may be in memory, not two */
static const int64_t SNAPSHOT_MAX_AGE_NS = 100 * NS_PER_MS; /* the clock in the picture, and ages, are no older than this */

static bool slow_is_for(const struct slow *slow, const struct render_client *client)
{
    for (size_t i = 0; slow->split && i < slow->batch.count; i++)
        if (slow->batch.orders[i].client == client->id)
            return true;
    return false;
}

/* Under lock. Its slow picture is under way and still good: what it wants besides can wait for it. */
static bool waits_for_slow(const struct render_thread *drawing, const struct render_client *client, int64_t now_ns)
{
    bool moving = client->wish.view.tier == TIER_PREVIEW || client->wish.or_moving;
    bool soon = client->wish.urgency == URGENCY_DATA && moving && now_ns - client->wish.asked_ns >= OWN_DATA_NS;
    if (client->left || client->wish.urgency == URGENCY_INPUT || soon)
        return false;
    return slow_is_for(&drawing->slow, client) || slow_is_for(&drawing->parked, client);
}

struct turn {
    bool step;                    /* of the slow picture; else */
    struct render_client *client; /* NULL: nobody before wait_until_ns */
    int64_t wait_until_ns;
};

bool render_thread_overtakes(const struct render_thread *drawing, const struct render_client *client)
{
    const struct slow *slow = &drawing->slow;
    int share = SCHEDULER_LONG;
    if (!slow->split || drawing->parked.split || slow->payer == client->wish.payer)
        return false;
    int64_t px = (int64_t)client->wish.view.width_px * client->wish.view.height_px;
    return px * OVERTAKE_SMALLER <= slow->px && client->payer->spent_ns[share] < slow->payer_spent_ns + slow->spent_ns;
}

/* Under lock. Addresses first, then their clients. */
static bool has_had_less(const struct render_client *client, const struct render_client *other, int share)
{
    const int64_t *a = client->payer->spent_ns, *b = other->payer->spent_ns;
    if (client->payer == other->payer)
        a = client->spent_ns, b = other->spent_ns;
    return scheduler_before(a[share], client->wish.asked_ns, b[share], other->wish.asked_ns);
}

/* Under lock. It can be drawn now, and before the other (NULL: nobody). */
static bool goes_before(const struct render_thread *drawing, const struct render_client *client, const struct render_client *other,
                        int64_t now_ns)
{
    enum urgency urgency = client->wish.urgency;
    if (!client->pending || waits_for_slow(drawing, client, now_ns))
        return false;
    if (drawing->slow.split && urgency >= URGENCY_REFINE && !render_thread_overtakes(drawing, client))
        return false;
    return !other || has_had_less(client, other, scheduler_share(urgency));
}

/* Under lock. */
static struct turn next_turn(const struct render_thread *drawing, const struct scheduler *schedule)
{
    const struct render_service *painter = drawing->painter;
    struct render_client *first[URGENCY_COUNT + 1] = { NULL };
    int64_t asked_ns[URGENCY_COUNT], now_ns = clock_mono_ns();
    bool busy = drawing->slow.split != NULL;
    struct turn turn = { 0 };
    for (size_t i = 0; i < painter->client_count; i++) {
        struct render_client *client = painter->clients[i];
        if (goes_before(drawing, client, first[client->wish.urgency], now_ns))
            first[client->wish.urgency] = client;
    }
    for (int i = 0; i < URGENCY_COUNT; i++)
        asked_ns[i] = busy && drawing->slow.urgency == (enum urgency)i ? drawing->slow.asked_ns
                      : first[i]                                       ? first[i]->wish.asked_ns
                                                                       : INT64_MAX;
    enum urgency urgency = scheduler_choose(schedule, asked_ns, now_ns, &turn.wait_until_ns);
    struct render_client *over = first[URGENCY_REFINE] ? first[URGENCY_REFINE] : first[URGENCY_SNAPSHOT];
    bool slow = urgency == URGENCY_REFINE || urgency == URGENCY_SNAPSHOT;
    turn.step = busy && slow && !over;
    turn.client = busy && slow ? over : first[urgency];
    return turn;
}

void render_thread_wait(struct render_service *painter, int64_t mono_ns)
{
    struct timespec until = { .tv_sec = mono_ns / NS_PER_S, .tv_nsec = mono_ns % NS_PER_S };
    if (mono_ns == INT64_MAX)
        pthread_cond_wait(&painter->wake, &painter->lock);
    else
        pthread_cond_timedwait(&painter->wake, &painter->lock, &until);
}

/* Under lock. What it had under way is not wanted any more, unless it will show new readings too. */
static void begin(const struct render_thread *drawing, struct render_client *client, struct request_group *batch, int64_t now_ns)
{
    enum urgency urgency = client->wish.urgency;
    client->pending = false;
    client->left = urgency == URGENCY_INPUT || (urgency == URGENCY_DATA && !drawing->slow.keeps);
    request_group_add(batch, &(struct request_ticket){ .client = client->id,
                                                       .number = ++client->number,
                                                       .wish = client->wish,
                                                       .wait_ns = now_ns - client->wish.view.input_ns });
}

/* Under lock. The client's wish, and all that the same picture answers. */
static void begin_all(const struct render_thread *drawing, struct render_client *first, struct request_group *batch)
{
    struct render_service *painter = drawing->painter;
    int64_t now_ns = clock_mono_ns();
    int share = scheduler_share(first->wish.urgency);
    painter->spent_ns[share] = scheduler_asked(first->spent_ns[share], painter->spent_ns[share]);
    time_accounts_served(&painter->payers, first->payer, share);
    begin(drawing, first, batch, now_ns);
    struct frame_request wish = batch->orders[0].wish;
    for (size_t i = 0; i < painter->client_count && !wish.overlay; i++) {
        struct render_client *other = painter->clients[i];
        if (other->pending && !other->wish.overlay && view_equal(&other->wish.view, &wish.view))
            begin(drawing, other, batch, now_ns);
    }
}

void render_thread_refresh(struct render_thread *drawing)
{
    struct render_service *painter = drawing->painter;
    int64_t now_ns = clock_mono_ns();
    pthread_mutex_lock(&painter->lock);
    bool new_data = painter->new_data;
    painter->new_data = false;
    pthread_mutex_unlock(&painter->lock);
    if (new_data || now_ns - drawing->snapshot->taken_mono_ns > SNAPSHOT_MAX_AGE_NS)
        store_snapshot(painter->params.store, now_ns, clock_utc_ns(), drawing->snapshot);
}

const struct snapshot *render_thread_readings(struct render_thread *drawing, const struct view *view,
                                              const struct historical_snapshot **historical)
{
    *historical = view->at_us ? snapshot_cache_take(drawing->painter->params.snapshot_cache, view->at_us) : NULL;
    if (view->at_us)
        return *historical ? &(*historical)->snapshot : NULL;
    render_thread_refresh(drawing);
    return drawing->snapshot;
}

/* One question about a pixel. */
static void answer_pick(struct render_thread *drawing)
{
    struct render_service *painter = drawing->painter;
    struct pick_query order;
    struct pick pick;
    const struct historical_snapshot *historical;
    int64_t start_ns = clock_mono_ns();
    if (!pick_queue_take(painter->picks, &order))
        return;
    const struct snapshot *snapshot = render_thread_readings(drawing, &order.view, &historical);
    if (!snapshot)
        return;
    pick_at(painter->params.scene, drawing->field, &order.view, snapshot, order.x_px, order.y_px, &pick);
    if (historical)
        snapshot_cache_give(painter->params.snapshot_cache, &historical);
    render_thread_note_work(drawing);
    counter_inc(painter->picked, 1);
    counter_inc(painter->pick_us, (clock_mono_ns() - start_ns) / 1000);
    if (pick_queue_answer(painter->picks, &order, &pick))
        painter->params.notify(painter->params.notify_arg);
}

bool render_thread_next(struct render_thread *drawing, const struct scheduler *schedule, struct request_group *batch)
{
    struct render_service *painter = drawing->painter;
    struct turn turn = { 0 };
    batch->count = 0;
    pthread_mutex_lock(&painter->lock);
    while (painter->state == RUNNING) {
        if (pick_queue_has_query(painter->picks)) {
            pthread_mutex_unlock(&painter->lock);
            answer_pick(drawing);
            pthread_mutex_lock(&painter->lock);
        }
        turn = next_turn(drawing, schedule);
        if (turn.step || turn.client || drawing->held.count > 0)
            break;
        if (pick_queue_has_query(painter->picks))
            continue;
        if (drawing->flying.count > 0)
            break;
        if (!drawing->warm) {
            pthread_mutex_unlock(&painter->lock);
            render_thread_warm_up(drawing);
            pthread_mutex_lock(&painter->lock);
            continue;
        }
        if (!drawing->slow.split && render_thread_may_release_memory(drawing, &turn.wait_until_ns)) {
            pthread_mutex_unlock(&painter->lock);
            render_thread_release_memory(drawing);
            pthread_mutex_lock(&painter->lock);
            continue;
        }
        render_thread_wait(painter, turn.wait_until_ns);
    }
    bool running = painter->state == RUNNING;
    bool held = deferred_requests_due(&drawing->held, turn.step || turn.client);
    if (running && held)
        deferred_requests_pop(&drawing->held, batch);
    else if (running && turn.client && !turn.step)
        begin_all(drawing, turn.client, batch);
    pthread_mutex_unlock(&painter->lock);
    return running;
}
