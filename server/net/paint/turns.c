/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the render thread does next. */
#include "base/clock.h"
#include "net/paint/drawing_impl.h"

static const int64_t OWN_DATA_NS = 1 * NS_PER_S;            /* changed readings wait so long for a refinement of the same client */
enum { OVERTAKE_SMALLER = 4 }; /* times, in pixels, than what it overtakes: one more of that size may be in memory, not two */
static const int64_t SNAPSHOT_MAX_AGE_NS = 100 * NS_PER_MS; /* the clock in the picture, and ages, are no older than this */

static bool slow_is_for(const struct slow *slow, const struct client *client)
{
    for (size_t i = 0; slow->canvas && i < slow->batch.count; i++)
        if (slow->batch.orders[i].client == client->id)
            return true;
    return false;
}

/* Under lock. Its slow picture is under way and still good: what it wants besides can wait for it. */
static bool waits_for_slow(const struct drawing *drawing, const struct client *client, int64_t now_ns)
{
    bool moving = client->wish.view.tier == TIER_MOVING || client->wish.or_moving;
    bool soon = client->wish.urgency == URGENCY_DATA && moving && now_ns - client->wish.asked_ns >= OWN_DATA_NS;
    if (client->left || client->wish.urgency == URGENCY_INPUT || soon)
        return false;
    return slow_is_for(&drawing->slow, client) || slow_is_for(&drawing->parked, client);
}

struct turn {
    bool step;             /* of the slow picture; else */
    struct client *client; /* NULL: nobody before wait_until_ns */
    int64_t wait_until_ns;
};

bool drawing_overtakes(const struct drawing *drawing, const struct client *client)
{
    const struct slow *slow = &drawing->slow;
    int share = SCHEDULE_LONG;
    if (!slow->canvas || drawing->parked.canvas || slow->payer == client->wish.payer)
        return false;
    int64_t px = (int64_t)client->wish.view.width_px * client->wish.view.height_px;
    return px * OVERTAKE_SMALLER <= slow->px && client->payer->spent_ns[share] < slow->payer_spent_ns + slow->spent_ns;
}

/* Under lock. Addresses first, then their clients. */
static bool has_had_less(const struct client *client, const struct client *other, int share)
{
    const int64_t *a = client->payer->spent_ns, *b = other->payer->spent_ns;
    if (client->payer == other->payer)
        a = client->spent_ns, b = other->spent_ns;
    return schedule_before(a[share], client->wish.asked_ns, b[share], other->wish.asked_ns);
}

/* Under lock. It can be drawn now, and before the other (NULL: nobody). */
static bool goes_before(const struct drawing *drawing, const struct client *client, const struct client *other, int64_t now_ns)
{
    enum urgency urgency = client->wish.urgency;
    if (!client->pending || waits_for_slow(drawing, client, now_ns))
        return false;
    if (drawing->slow.canvas && urgency >= URGENCY_REFINE && !drawing_overtakes(drawing, client))
        return false;
    return !other || has_had_less(client, other, schedule_share(urgency));
}

/* Under lock. */
static struct turn next_turn(const struct drawing *drawing, const struct schedule *schedule)
{
    const struct painter *painter = drawing->painter;
    struct client *first[URGENCY_COUNT + 1] = { NULL };
    int64_t asked_ns[URGENCY_COUNT], now_ns = clock_mono_ns();
    bool busy = drawing->slow.canvas != NULL;
    struct turn turn = { 0 };
    for (size_t i = 0; i < painter->client_count; i++) {
        struct client *client = painter->clients[i];
        if (goes_before(drawing, client, first[client->wish.urgency], now_ns))
            first[client->wish.urgency] = client;
    }
    for (int i = 0; i < URGENCY_COUNT; i++)
        asked_ns[i] = busy && drawing->slow.urgency == (enum urgency)i ? drawing->slow.asked_ns
                      : first[i]                                      ? first[i]->wish.asked_ns
                                                                      : INT64_MAX;
    enum urgency urgency = schedule_choose(schedule, asked_ns, now_ns, &turn.wait_until_ns);
    struct client *over = first[URGENCY_REFINE] ? first[URGENCY_REFINE] : first[URGENCY_SNAPSHOT];
    bool slow = urgency == URGENCY_REFINE || urgency == URGENCY_SNAPSHOT;
    turn.step = busy && slow && !over;
    turn.client = busy && slow ? over : first[urgency];
    return turn;
}

void drawing_wait(struct painter *painter, int64_t mono_ns)
{
    struct timespec until = { .tv_sec = mono_ns / NS_PER_S, .tv_nsec = mono_ns % NS_PER_S };
    if (mono_ns == INT64_MAX)
        pthread_cond_wait(&painter->wake, &painter->lock);
    else
        pthread_cond_timedwait(&painter->wake, &painter->lock, &until);
}

/* Under lock. What it had under way is not wanted any more, unless it will show new readings too. */
static void begin(const struct drawing *drawing, struct client *client, struct batch *batch, int64_t now_ns)
{
    enum urgency urgency = client->wish.urgency;
    client->pending = false;
    client->left = urgency == URGENCY_INPUT || (urgency == URGENCY_DATA && !drawing->slow.keeps);
    batch_add(batch,
              &(struct order){
                  .client = client->id, .number = ++client->number, .wish = client->wish, .wait_ns = now_ns - client->wish.view.input_ns });
}

/* Under lock. The client's wish, and all that the same picture answers. */
static void begin_all(const struct drawing *drawing, struct client *first, struct batch *batch)
{
    struct painter *painter = drawing->painter;
    int64_t now_ns = clock_mono_ns();
    int share = schedule_share(first->wish.urgency);
    painter->spent_ns[share] = schedule_asked(first->spent_ns[share], painter->spent_ns[share]);
    payers_served(&painter->payers, first->payer, share);
    begin(drawing, first, batch, now_ns);
    struct wish wish = batch->orders[0].wish;
    for (size_t i = 0; i < painter->client_count && !wish.overlay; i++) {
        struct client *other = painter->clients[i];
        if (other->pending && !other->wish.overlay && view_equal(&other->wish.view, &wish.view))
            begin(drawing, other, batch, now_ns);
    }
}

void drawing_refresh(struct drawing *drawing)
{
    struct painter *painter = drawing->painter;
    int64_t now_ns = clock_mono_ns();
    pthread_mutex_lock(&painter->lock);
    bool new_data = painter->new_data;
    painter->new_data = false;
    pthread_mutex_unlock(&painter->lock);
    if (new_data || now_ns - drawing->snapshot->taken_mono_ns > SNAPSHOT_MAX_AGE_NS)
        store_snapshot(painter->params.store, now_ns, clock_utc_ns(), drawing->snapshot);
}

const struct snapshot *drawing_readings(struct drawing *drawing, const struct view *view, const struct moment **moment)
{
    *moment = view->at_us ? moments_take(drawing->painter->params.moments, view->at_us) : NULL;
    if (view->at_us)
        return *moment ? &(*moment)->snapshot : NULL;
    drawing_refresh(drawing);
    return drawing->snapshot;
}

/* One question about a pixel. */
static void answer_pick(struct drawing *drawing)
{
    struct painter *painter = drawing->painter;
    struct pick_order order;
    struct pick pick;
    const struct moment *moment;
    int64_t start_ns = clock_mono_ns();
    if (!picks_take(painter->picks, &order))
        return;
    const struct snapshot *snapshot = drawing_readings(drawing, &order.view, &moment);
    if (!snapshot)
        return;
    pick_at(painter->params.scene, drawing->field, &order.view, snapshot, order.x_px, order.y_px, &pick);
    if (moment)
        moments_give(painter->params.moments, &moment);
    drawing_stir(drawing);
    counter_inc(painter->picked, 1);
    counter_inc(painter->pick_us, (clock_mono_ns() - start_ns) / 1000);
    if (picks_give(painter->picks, &order, &pick))
        painter->params.notify(painter->params.notify_arg);
}

bool drawing_next(struct drawing *drawing, const struct schedule *schedule, struct batch *batch)
{
    struct painter *painter = drawing->painter;
    struct turn turn = { 0 };
    batch->count = 0;
    pthread_mutex_lock(&painter->lock);
    while (painter->state == RUNNING) {
        if (picks_wait(painter->picks)) {
            pthread_mutex_unlock(&painter->lock);
            answer_pick(drawing);
            pthread_mutex_lock(&painter->lock);
        }
        turn = next_turn(drawing, schedule);
        if (turn.step || turn.client || drawing->held.count > 0)
            break;
        if (picks_wait(painter->picks))
            continue;
        if (drawing->flying.count > 0)
            break;
        if (!drawing->warm) {
            pthread_mutex_unlock(&painter->lock);
            drawing_idle(drawing);
            pthread_mutex_lock(&painter->lock);
            continue;
        }
        if (!drawing->slow.canvas && drawing_may_rest(drawing, &turn.wait_until_ns)) {
            pthread_mutex_unlock(&painter->lock);
            drawing_rest(drawing);
            pthread_mutex_lock(&painter->lock);
            continue;
        }
        drawing_wait(painter, turn.wait_until_ns);
    }
    bool running = painter->state == RUNNING;
    bool held = held_due(&drawing->held, turn.step || turn.client);
    if (running && held)
        held_pop(&drawing->held, batch);
    else if (running && turn.client && !turn.step)
        begin_all(drawing, turn.client, batch);
    pthread_mutex_unlock(&painter->lock);
    return running;
}
