/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frame sharing: one drawing serves all clients that request the same content, even at slightly different times. */
#include "base/clock.h"
#include "service/render_thread_impl.h"

struct content_of {
    struct render_service *service;
    uint64_t content;
    bool gives_depth; /* true: the shared frame has a depth grid (coarse depth for clients) */
    int64_t cost_ns; /* drawing time in nanoseconds that each client with a share in the frame is charged */
};

/* Returns whether the ticket's client already shows the shared picture, and has its depth grid if it wants one. The caller
   holds the lock. */
static bool has_it(const struct request_ticket *ticket, void *arg)
{
    const struct content_of *now = arg;
    struct render_client *client = render_service_find(now->service, ticket->client);
    bool has = !ticket->request.always && client && client->has_content && client->content == now->content &&
               (client->has_depth || !ticket->request.depth);
    if (has && ticket->number > client->content_number)
        client->content_number = ticket->number;
    return has;
}

/* Returns whether a later request of the ticket's client has already gone to the encoders. That happens if this frame was drawn
   late: it was deferred, or a long job in steps. The client would never show this older frame, so its encode stream must not
   count the frame as shown. The caller holds the lock. */
static bool is_overtaken(const struct request_ticket *ticket, void *arg)
{
    const struct content_of *now = arg;
    const struct render_client *client = render_service_find(now->service, ticket->client);
    return client && client->has_content && ticket->number < client->content_number;
}

/* Stores the frame's content hash as that of the client's newest frame, and charges the client for drawing. Returns false if
   the client has gone. The caller holds the lock. */
static bool remember(const struct request_ticket *ticket, void *arg)
{
    const struct content_of *now = arg;
    struct render_client *client = render_service_find(now->service, ticket->client);
    if (!client)
        return false;
    client->has_content = true;
    client->has_depth = ticket->request.depth && now->gives_depth;
    client->content = now->content;
    client->content_number = ticket->number;
    client->spent_ns[scheduler_share(ticket->request.urgency)] += now->cost_ns;
    client->account->spent_ns[scheduler_share(ticket->request.urgency)] += now->cost_ns;
    return true;
}

/* Submits a frame for encoding. The function holds the lock that render_service_forget() takes, so that clients that have gone
   get no packets. The drawing time is divided among the clients that share the frame. */
void frame_sharing_submit(struct render_service *service, struct frame *frame, struct request_group *group, int64_t cost_ns)
{
    struct content_of now = { .service = service, .content = frame->content, .gives_depth = frame->depth[0] != NULL };
    now.cost_ns = cost_ns / (int64_t)group->count;
    struct request_group here = { 0 }, overtaken = { 0 };
    pthread_mutex_lock(&service->lock);
    request_group_split(group, is_overtaken, &now, &overtaken);
    request_group_split(group, remember, &now, &here);
    encode_queue_submit(service->queue, frame, &here);
    pthread_mutex_unlock(&service->lock);
    request_group_finish(&here);
    group->count = 0;
    if (overtaken.count > 0)
        render_service_answer_without_frame(service, &overtaken, FRAME_SKIPPED);
    request_group_finish(&overtaken);
}

/* Answers "nothing new" to those clients of the group that already show the picture with this content hash, and removes them
   from the group. */
static void answer_same(struct render_thread *thread, struct request_group *group, uint64_t content)
{
    struct render_service *service = thread->service;
    struct content_of now = { .service = service, .content = content };
    pthread_mutex_lock(&service->lock);
    request_group_split(group, has_it, &now, &thread->same);
    pthread_mutex_unlock(&service->lock);
    counter_inc(service->same, (int64_t)thread->same.count);
    render_service_answer_without_frame(service, &thread->same, FRAME_UNCHANGED);
}

/* Returns whether a frame that was drawn for other clients can answer the requests of the group. It cannot if a request wants
   the depth grid, or the record of what the frame was drawn from, and the frame has none. */
static bool answers(const struct frame *frame, const struct request_group *group)
{
    return frame && (frame->record || !request_group_wants_record(group)) && (frame->depth[0] || !request_group_wants_depth(group));
}

static void answer_with(struct render_service *service, struct frame *frame, struct request_group *group)
{
    counter_inc(service->shared, (int64_t)group->count);
    if (group->count > 0)
        frame_sharing_submit(service, frame, group, 0);
}

/* Adds the group's requests to a frame with the same content hash that was submitted to the GPU, if there is one. The record of
   what such a frame was drawn from can still be added, but no depth grid. */
static void join_awaited(struct render_thread *thread, struct request_group *group, uint64_t content)
{
    struct pending_readback *flight = pending_readbacks_find(&thread->in_flight, content, request_group_wants_depth(group));
    if (!flight)
        return;
    counter_inc(thread->service->shared, (int64_t)group->count);
    for (size_t i = 0; i < group->count; i++)
        request_group_add(&flight->group, &group->tickets[i]);
    group->count = 0;
}

void frame_sharing_answer_unchanged(struct render_thread *thread, uint64_t content, struct request_group *group)
{
    bool overlay = group->tickets[0].request.overlay;
    answer_same(thread, group, content);
    struct frame *frame = overlay ? NULL : recent_frames_find(&thread->recent, content, clock_mono_ns());
    if (answers(frame, group))
        answer_with(thread->service, frame, group);
    else if (!overlay)
        join_awaited(thread, group, content);
}

void frame_sharing_answer_from_recent(struct render_thread *thread, struct request_group *group)
{
    const struct frame_request *request = &group->tickets[0].request;
    int64_t read_ns = 0;
    for (size_t i = 0; i < group->count; i++)
        if (group->tickets[i].request.read_ns > read_ns)
            read_ns = group->tickets[i].request.read_ns;
    if (request->view.tier != TIER_PREVIEW || request->overlay)
        return;
    struct frame *frame = recent_frames_find_view(&thread->recent, &request->view, read_ns, clock_mono_ns());
    if (!answers(frame, group))
        return;
    answer_same(thread, group, frame->content);
    answer_with(thread->service, frame, group);
}
