/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The event loop's state for one plant: the sessions' context and the history readers. */
#include "access/tokens.h"
#include "base/mem.h"
#include "net/core_end.h"
#include "net/net.h"
#include "net/net_impl.h"

static void wake(void *arg)
{
    net_wake(arg);
}

bool net_open_signer(struct net *net)
{
    struct server_context *server = &net->server;
    if (server->params.signing_key)
        server->signing.signer = picture_signer_create(server->params.log, server->params.signing_key, wake, net);
    return !server->params.signing_key || server->signing.signer;
}

void net_limit_services(struct server_context *server)
{
    struct plant_services *services = &server->params.plant;
    /* true: recorded history can be read, in this machine's folder or from the core; a renderer has no history of its own */
    bool recorded = services->history_folder || (services->core_link && !services->scene->plant->history.off);
    if (!recorded)
        services->snapshot_cache = NULL;
    if (!server->params.save || services->core_link)
        services->placing = NULL;
}

bool net_open_history(struct net *net)
{
    struct server_context *server = &net->server;
    const struct plant_services *plant = &server->params.plant;
    const struct history_loader_params history_loader = { .log = server->params.log,
                                                          .plant = plant->scene->plant,
                                                          .folder = plant->history_folder,
                                                          .core_link = plant->core_link,
                                                          .snapshot_cache = plant->snapshot_cache,
                                                          .notify = wake,
                                                          .notify_arg = net };
    if (!plant->snapshot_cache)
        return true;
    server->history_queries =
        history_queries_create(server->params.log, plant->scene->plant, plant->scene, plant->history_folder, plant->core_link, wake, net);
    server->history_loader = history_loader_create(&history_loader);
    return server->history_queries && server->history_loader;
}

void net_bind_plant(struct net *net)
{
    struct server_context *server = &net->server;
    const struct plant *plant = server->params.plant.scene->plant;
    net_limit_services(server);
    server->readings.snapshot = snapshot_create(plant->tag_count);
    server->readings.changes = mem_array(plant->tag_count, sizeof(*server->readings.changes));
    server->readings.links_up = mem_array(plant->source_count, sizeof(*server->readings.links_up));
    if (server->logins.tokens) {
        tokens_set_plant(server->logins.tokens, plant->name);
        tokens_set_pairings(server->logins.tokens, pairings_find, server->params.plant.pairings);
    }
    server->session_context.plant = plant;
    server->session_context.services = &server->params.plant;
    server->session_context.readings.snapshot = server->readings.snapshot;
    server->session_context.readings.links_up = server->readings.links_up;
    core_end_bind(server);
    net_take_snapshot(server);
    net_check_links(server);
}
