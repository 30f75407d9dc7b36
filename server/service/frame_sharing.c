/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One picture for all who want the same, whenever they ask. */
#include "base/clock.h"
#include "service/render_thread_impl.h"

struct content_of {
    struct render_service *painter;
    uint64_t content;
    int64_t cost_ns; /* each one's part */
};

/* Under lock: the client has this picture already. */
static bool has_it(const struct request_ticket *order, void *arg)
{
    const struct content_of *now = arg;
    const struct render_client *client = render_service_find(now->painter, order->client);
    return !order->wish.always && client && client->has_content && client->content == now->content;
}

/* Under lock: who is there remembers what it gets. */
static bool remember(const struct request_ticket *order, void *arg)
{
    const struct content_of *now = arg;
    struct render_client *client = render_service_find(now->painter, order->client);
    if (!client)
        return false;
    client->has_content = true;
    client->content = now->content;
    client->spent_ns[scheduler_share(order->wish.urgency)] += now->cost_ns;
    client->payer->spent_ns[scheduler_share(order->wish.urgency)] += now->cost_ns;
    return true;
}

/* Who left has no more part in any stream of packets: decided under the lock that render_service_forget takes. Who shares a picture shares its
   cost. */
void frame_sharing_submit(struct render_service *painter, struct frame *frame, struct request_group *batch, int64_t cost_ns)
{
    struct content_of now = { .painter = painter, .content = frame->content, .cost_ns = cost_ns / (int64_t)batch->count };
    struct request_group here = { 0 };
    pthread_mutex_lock(&painter->lock);
    request_group_split(batch, remember, &now, &here);
    encode_queue_submit(painter->encoding, frame, &here);
    pthread_mutex_unlock(&painter->lock);
    request_group_finish(&here);
    batch->count = 0;
}

/* To those who have that picture already: nothing new. */
static void answer_same(struct render_thread *drawing, struct request_group *batch, uint64_t content)
{
    struct render_service *painter = drawing->painter;
    struct content_of now = { .painter = painter, .content = content };
    pthread_mutex_lock(&painter->lock);
    request_group_split(batch, has_it, &now, &drawing->same);
    pthread_mutex_unlock(&painter->lock);
    counter_inc(painter->same, (int64_t)drawing->same.count);
    render_service_answer_without_frame(painter, &drawing->same, false);
}

static void answer_with(struct render_service *painter, struct frame *frame, struct request_group *batch)
{
    counter_inc(painter->shared, (int64_t)batch->count);
    if (batch->count > 0)
        frame_sharing_submit(painter, frame, batch, 0);
}

/* To those for whom it is drawn goes who asks for it meanwhile. */
static void join_flying(struct render_thread *drawing, struct request_group *batch, uint64_t content)
{
    struct awaited_frame *flying = awaited_frames_find(&drawing->flying, content);
    if (!flying)
        return;
    counter_inc(drawing->painter->shared, (int64_t)batch->count);
    for (size_t i = 0; i < batch->count; i++)
        request_group_add(&flying->batch, &batch->orders[i]);
    batch->count = 0;
}

uint64_t frame_sharing_answer_unchanged(struct render_thread *drawing, const struct snapshot *snapshot, struct request_group *batch)
{
    const struct frame_request *wish = &batch->orders[0].wish;
    uint64_t content = split_view_content(drawing->renderer, &wish->view, snapshot);
    bool overlay = wish->overlay;
    answer_same(drawing, batch, content);
    struct frame *frame = overlay ? NULL : recent_frames_find(&drawing->recent, content, clock_mono_ns());
    if (frame)
        answer_with(drawing->painter, frame, batch);
    else if (!overlay)
        join_flying(drawing, batch, content);
    return content;
}

void frame_sharing_answer_from_recent(struct render_thread *drawing, struct request_group *batch)
{
    const struct frame_request *wish = &batch->orders[0].wish;
    int64_t read_ns = 0;
    for (size_t i = 0; i < batch->count; i++)
        if (batch->orders[i].wish.read_ns > read_ns)
            read_ns = batch->orders[i].wish.read_ns;
    if (wish->view.tier != TIER_PREVIEW || wish->overlay)
        return;
    struct frame *frame = recent_frames_find_view(&drawing->recent, &wish->view, read_ns, clock_mono_ns());
    if (!frame)
        return;
    answer_same(drawing, batch, frame->content);
    answer_with(drawing->painter, frame, batch);
}
