/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses what the render thread does next: which client's request it draws, or whether it draws a step of a frame that takes
   long. */
#include "base/clock.h"
#include "service/render_thread_impl.h"

/* OWN_DATA_NS: how long a client's changed readings wait for the refined frame that is being drawn for the client. Then that
   frame is given up for a preview with the new readings. Each time, the wait doubles, up to OWN_DATA_MAX_NS, so that a refined
   frame is finished eventually. */
static const int64_t OWN_DATA_NS = 1 * NS_PER_S, OWN_DATA_MAX_NS = 16 * NS_PER_S;
/* minimum ratio of pixels between a long job (a frame drawn in steps) and a frame that may overtake it: memory suffices for a
   large and a small frame, but not for two large ones */
enum { OVERTAKE_SMALLER = 4 };

static bool long_job_is_for(const struct long_job *long_job, const struct render_client *client)
{
    for (size_t i = 0; long_job->split && i < long_job->group.count; i++)
        if (long_job->group.tickets[i].client == client->id)
            return true;
    return false;
}

/* Returns whether the client's long job (a frame drawn in steps) is running and still wanted, so that its other requests can wait for it.
   The caller holds the lock. */
static bool waits_for_long_job(const struct render_thread *thread, const struct render_client *client, int64_t now_ns)
{
    bool moving = client->request.view.tier == TIER_PREVIEW || client->request.or_moving;
    int64_t patience_ns = client->patience_ns ? client->patience_ns : OWN_DATA_NS;
    bool soon = client->request.urgency == URGENCY_DATA && moving && now_ns - client->request.asked_ns >= patience_ns;
    if (client->left || client->request.urgency == URGENCY_INPUT || soon)
        return false;
    return long_job_is_for(&thread->long_job, client) || long_job_is_for(&thread->parked, client);
}

struct render_turn {
    bool step;                    /* true: draw a step of the long job (a frame drawn in steps); false: serve `client` */
    struct render_client *client; /* client whose request is drawn next; NULL: no request may be drawn before wait_until_ns */
    int64_t wait_until_ns;
};

bool render_thread_overtakes(const struct render_thread *thread, const struct render_client *client)
{
    const struct long_job *long_job = &thread->long_job;
    int kind = SCHEDULER_LONG;
    if (!long_job->split || thread->parked.split || long_job->account == client->request.account)
        return false;
    int64_t px = (int64_t)client->request.view.width_px * client->request.view.height_px;
    return px * OVERTAKE_SMALLER <= long_job->px && client->account->spent_ns[kind] < long_job->account_spent_ns + long_job->spent_ns;
}

/* Returns whether the client is served before the other client, because it was charged less drawing time. kind: kind of frames
   to compare (scheduler_share()). The caller holds the lock. */
static bool has_had_less(const struct render_client *client, const struct render_client *other, int kind)
{
    return time_claim_before(&(struct time_claim){ client->account, client->spent_ns[kind], client->request.asked_ns },
                             &(struct time_claim){ other->account, other->spent_ns[kind], other->request.asked_ns }, kind);
}

/* Returns whether the client's request can be drawn now, and is served before the request of `other` (NULL: there is no other). The caller
   holds the lock. */
static bool goes_before(const struct render_thread *thread, const struct render_client *client, const struct render_client *other,
                        int64_t now_ns)
{
    enum urgency urgency = client->request.urgency;
    if (!client->pending || waits_for_long_job(thread, client, now_ns))
        return false;
    if (thread->long_job.split && urgency >= URGENCY_REFINE && !render_thread_overtakes(thread, client))
        return false;
    return !other || has_had_less(client, other, scheduler_share(urgency));
}

/* Refined frames and snapshots over HTTP share one account of drawing time. If one client waits for a refined frame and another
   for a snapshot, removes from `first` the client that was charged more. Otherwise, an address that requests refined frames
   without a pause would always delay its own snapshots by another address's large frame. The caller holds the lock. */
static void choose_long(struct render_client **first)
{
    struct render_client **refined = &first[URGENCY_REFINE], **snapshot = &first[URGENCY_SNAPSHOT];
    if (*refined && *snapshot)
        *(has_had_less(*snapshot, *refined, SCHEDULER_LONG) ? refined : snapshot) = NULL;
}

/* Chooses what the render thread does in its next turn: draw a step of the long job (a frame drawn in steps), or serve a client. The caller
   holds the lock. */
static struct render_turn next_turn(const struct render_thread *thread, const struct scheduler *scheduler)
{
    const struct render_service *service = thread->service;
    struct render_client *first[URGENCY_COUNT + 1] = { NULL };
    int64_t asked_ns[URGENCY_COUNT], now_ns = clock_mono_ns();
    bool busy = thread->long_job.split != NULL;
    struct render_turn turn = { 0 };
    for (size_t i = 0; i < service->client_count; i++) {
        struct render_client *client = service->clients[i];
        if (goes_before(thread, client, first[client->request.urgency], now_ns))
            first[client->request.urgency] = client;
    }
    choose_long(first);
    for (int i = 0; i < URGENCY_COUNT; i++)
        asked_ns[i] = busy && thread->long_job.urgency == (enum urgency)i ? thread->long_job.asked_ns
                      : first[i]                                          ? first[i]->request.asked_ns
                                                                          : INT64_MAX;
    enum urgency urgency = scheduler_choose(scheduler, asked_ns, now_ns, &turn.wait_until_ns);
    struct render_client *over = first[URGENCY_REFINE] ? first[URGENCY_REFINE] : first[URGENCY_SNAPSHOT];
    bool long_job = urgency == URGENCY_REFINE || urgency == URGENCY_SNAPSHOT;
    turn.step = busy && long_job && !over;
    turn.client = busy && long_job ? over : first[urgency];
    return turn;
}

/* Adjusts how long changed readings wait for the refined frame that is being drawn for the client. A user's input resets this
   time to its initial value; giving up a refined frame for readings doubles it. The caller holds the lock. */
static void change_patience(const struct render_thread *thread, struct render_client *client)
{
    int64_t twice_ns = 2 * (client->patience_ns ? client->patience_ns : OWN_DATA_NS);
    if (client->request.urgency == URGENCY_INPUT)
        client->patience_ns = 0;
    else if (client->left && (long_job_is_for(&thread->long_job, client) || long_job_is_for(&thread->parked, client)))
        client->patience_ns = twice_ns < OWN_DATA_MAX_NS ? twice_ns : OWN_DATA_MAX_NS;
}

/* Moves the client's request to the group of requests that are drawn now. The client then no longer wants the long job (a frame
   drawn in steps) that runs for it, unless that frame will show the new readings too. The caller holds the lock. */
static void begin(const struct render_thread *thread, struct render_client *client, struct request_group *group, int64_t now_ns)
{
    enum urgency urgency = client->request.urgency;
    client->pending = false;
    client->left = urgency == URGENCY_INPUT || (urgency == URGENCY_DATA && !thread->long_job.keeps);
    change_patience(thread, client);
    request_group_add(group, &(struct request_ticket){ .client = client->id,
                                                       .number = ++client->number,
                                                       .request = client->request,
                                                       .wait_ns = now_ns - client->request.view.input_ns });
}

/* Moves the client's request, and all other requests that can share its frame, to the group of requests that are drawn now. The
   caller holds the lock. */
static void begin_all(const struct render_thread *thread, struct render_client *first, struct request_group *group)
{
    struct render_service *service = thread->service;
    int64_t now_ns = clock_mono_ns();
    int kind = scheduler_share(first->request.urgency);
    service->spent_ns[kind] = scheduler_asked(first->spent_ns[kind], service->spent_ns[kind]);
    time_accounts_served(&service->accounts, first->account, kind);
    begin(thread, first, group, now_ns);
    struct frame_request request = group->tickets[0].request;
    for (size_t i = 0; i < service->client_count && !request.overlay; i++) {
        struct render_client *other = service->clients[i];
        if (other->pending && !other->request.overlay && view_equal(&other->request.view, &request.view))
            begin(thread, other, group, now_ns);
    }
}

/* Answers one pick query. */
static void answer_pick(struct render_thread *thread)
{
    struct render_service *service = thread->service;
    struct pick_query query;
    struct pick pick;
    const struct historical_snapshot *historical;
    int64_t start_ns = clock_mono_ns();
    if (!pick_queue_take(service->picks, &query))
        return;
    const struct snapshot *snapshot = render_thread_readings(thread, &query.view, &historical);
    if (!snapshot)
        return;
    pick_at(service->params.scene, thread->field, &query.view, snapshot, query.x_px, query.y_px, &pick);
    if (historical)
        snapshot_cache_give(service->params.snapshot_cache, &historical);
    render_thread_note_work(thread);
    counter_inc(service->picked, 1);
    thread->turn_began_ns = clock_mono_ns();
    counter_inc(service->pick_us, (thread->turn_began_ns - start_ns) / 1000);
    if (pick_queue_answer(service->picks, &query, &pick))
        service->params.notify(service->params.notify_arg);
}

bool render_thread_next(struct render_thread *thread, const struct scheduler *scheduler, struct request_group *group)
{
    struct render_service *service = thread->service;
    struct render_turn turn = { 0 };
    group->count = 0;
    pthread_mutex_lock(&service->lock);
    while (service->state == RUNNING) {
        service->asked_ns = 0;
        if (pick_queue_has_query(service->picks)) {
            pthread_mutex_unlock(&service->lock);
            answer_pick(thread);
            pthread_mutex_lock(&service->lock);
            /* checks again whether the service is stopping: that may have happened while the lock was released, and nothing
               would wake this thread again */
            if (service->state != RUNNING)
                break;
        }
        turn = next_turn(thread, scheduler);
        if (turn.step || turn.client || thread->deferred.count > 0)
            break;
        if (pick_queue_has_query(service->picks))
            continue;
        if (thread->in_flight.count > 0)
            break;
        if (!thread->warm) {
            pthread_mutex_unlock(&service->lock);
            render_thread_warm_up(thread);
            thread->turn_began_ns = clock_mono_ns();
            pthread_mutex_lock(&service->lock);
            continue;
        }
        if (!thread->long_job.split && render_thread_may_release_memory(thread, &turn.wait_until_ns)) {
            pthread_mutex_unlock(&service->lock);
            render_thread_release_memory(thread);
            pthread_mutex_lock(&service->lock);
            continue;
        }
        clock_cond_wait(&service->wake, &service->lock, turn.wait_until_ns);
        thread->turn_began_ns = clock_mono_ns();
    }
    bool running = service->state == RUNNING;
    bool deferred = deferred_requests_due(&thread->deferred, turn.step || turn.client);
    if (running && deferred)
        deferred_requests_pop(&thread->deferred, group);
    else if (running && turn.client && !turn.step)
        begin_all(thread, turn.client, group);
    pthread_mutex_unlock(&service->lock);
    return running;
}
