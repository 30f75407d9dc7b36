/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The clients of the render service, and the frames on their way back to them. */
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "service/render_service_impl.h"

/* Under lock. Where it is, or would be. */
static size_t place_of(const struct render_service *service, uint64_t id)
{
    size_t low = 0, high = service->client_count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (service->clients[middle]->id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

struct render_client *render_service_find(struct render_service *service, uint64_t id)
{
    size_t place = place_of(service, id);
    return place < service->client_count && service->clients[place]->id == id ? service->clients[place] : NULL;
}

/* Under lock. */
struct render_client *render_service_add_client(struct render_service *service, uint64_t id, uint64_t account)
{
    size_t place = place_of(service, id);
    mem_grow(&service->clients, &service->client_capacity, service->client_count + 1, sizeof(struct render_client *));
    memmove(service->clients + place + 1, service->clients + place, (service->client_count - place) * sizeof(struct render_client *));
    service->client_count++;
    service->clients[place] = mem_new(sizeof(struct render_client));
    service->clients[place]->id = id;
    service->clients[place]->account = time_accounts_join(&service->accounts, account);
    return service->clients[place];
}

static struct encoded_frame *encoded_frame_create(const struct request_ticket *ticket, bool failed)
{
    struct encoded_frame *encoded = mem_new(sizeof(*encoded));
    *encoded = (struct encoded_frame){
        .client = ticket->client,
        .number = ticket->number,
        .failed = failed,
        .request = ticket->request,
        .wait_ns = ticket->wait_ns,
        .made_ns = clock_mono_ns(),
    };
    return encoded;
}

/* Takes it; who gives several says so once, after the last: announce(). */
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

void render_service_answer_without_frame(struct render_service *service, const struct request_group *group, bool failed)
{
    for (size_t i = 0; i < group->count; i++)
        give_back(service, encoded_frame_create(&group->tickets[i], failed));
    render_service_announce(service);
}

/* What could not be encoded was not shown: the client's next request is drawn, whatever it shows. */
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
    struct encoded_frame *encoded = encoded_frame_create(ticket, failed);
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

void render_service_remove_client(struct render_service *service, uint64_t id)
{
    size_t place = place_of(service, id);
    if (place == service->client_count || service->clients[place]->id != id)
        return;
    time_accounts_leave(&service->accounts, &service->clients[place]->account);
    mem_free(service->clients[place]);
    service->client_count--;
    memmove(service->clients + place, service->clients + place + 1, (service->client_count - place) * sizeof(struct render_client *));
}
