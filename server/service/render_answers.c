/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the answers of the render thread and of the encode queue until the event loop collects them. */
#include "base/clock.h"
#include "base/mem.h"
#include "service/render_service_impl.h"

static struct encoded_frame *encoded_frame_create(const struct request_ticket *ticket, enum frame_absence absence)
{
    struct encoded_frame *encoded = mem_new(sizeof(*encoded));
    *encoded = (struct encoded_frame){
        .client = ticket->client,
        .number = ticket->number,
        .absence = absence,
        .request = ticket->request,
        .wait_ns = ticket->wait_ns,
        .made_ns = clock_mono_ns(),
    };
    return encoded;
}

/* Takes ownership of an encoded frame and queues it for collection. Call render_service_announce() once after the last frame. */
static void give_back(struct render_service *service, struct encoded_frame *encoded)
{
    pthread_mutex_lock(&service->lock);
    *service->done_last = encoded;
    service->done_last = &encoded->next;
    pthread_mutex_unlock(&service->lock);
}

void render_service_announce(void *arg)
{
    struct render_service *service = arg;
    pthread_mutex_lock(&service->lock);
    bool news = service->done && !service->announced;
    service->announced |= news;
    pthread_mutex_unlock(&service->lock);
    if (news)
        service->params.notify(service->params.notify_arg);
}

void render_service_answer_without_frame(struct render_service *service, const struct request_group *group, enum frame_absence absence)
{
    for (size_t i = 0; i < group->count; i++)
        give_back(service, encoded_frame_create(&group->tickets[i], absence));
    render_service_announce(service);
}

/* Records that the client does not show the newest frame drawn for it, because encoding failed. The client's next request is
   then drawn even if its content is the same. */
static void forget_content(struct render_service *service, uint64_t id)
{
    pthread_mutex_lock(&service->lock);
    struct render_client *client = render_service_find(service, id);
    if (client)
        client->has_content = false;
    pthread_mutex_unlock(&service->lock);
}

void render_service_on_encoded(void *arg, const struct request_ticket *ticket, struct packet *const *packets, int count, bool failed)
{
    struct encoded_frame *encoded = encoded_frame_create(ticket, failed ? FRAME_FAILED : FRAME_UNCHANGED);
    if (failed)
        forget_content(arg, ticket->client);
    if (count > 0)
        encoded->packet = packet_ref(packets[count - 1]);
    if (count > 1)
        encoded->earlier = mem_array((size_t)count - 1, sizeof(struct packet *));
    for (; encoded->earlier_count < count - 1; encoded->earlier_count++)
        encoded->earlier[encoded->earlier_count] = packet_ref(packets[encoded->earlier_count]);
    give_back(arg, encoded);
}

struct encoded_frame *render_service_collect(struct render_service *service)
{
    pthread_mutex_lock(&service->lock);
    struct encoded_frame *done = service->done;
    service->done = NULL;
    service->done_last = &service->done;
    service->announced = false;
    pthread_mutex_unlock(&service->lock);
    return done;
}
