/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds, adds and removes clients of the render service by their id. */
#include <string.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "service/render_service_impl.h"

/* Returns the client's index in the array sorted by id, or the index at which the client would be inserted. The caller holds the lock. */
static size_t place_of(const struct render_service *service, uint64_t id)
{
    size_t at;
    search_sorted(at, service->client_count, service->clients[at]->id < id);
    return at;
}

struct render_client *render_service_find(struct render_service *service, uint64_t id)
{
    size_t place = place_of(service, id);
    return place < service->client_count && service->clients[place]->id == id ? service->clients[place] : NULL;
}

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
