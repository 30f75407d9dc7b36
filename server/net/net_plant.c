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
        server->picture_signer = picture_signer_create(server->params.log, server->params.signing_key, wake, net);
    return !server->params.signing_key || server->picture_signer;
}

bool net_open_history(struct net *net)
{
    struct server_context *server = &net->server;
    const struct net_plant *plant = &server->params.plant;
    const struct history_loader_params history_loader = { .log = server->params.log,
                                                          .plant = plant->scene->plant,
                                                          .folder = plant->history_folder,
                                                          .core_link = plant->core_link,
                                                          .snapshot_cache = plant->snapshot_cache,
                                                          .notify = wake,
                                                          .notify_arg = net };
    /* a renderer has no history of its own: it queries the history of its core */
    bool any = plant->history_folder || (plant->core_link && !plant->scene->plant->history.off);
    server->session_context.snapshot_cache = any ? plant->snapshot_cache : NULL;
    if (!any)
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
    server->snapshot = snapshot_create(plant->tag_count);
    server->changes = mem_array(plant->tag_count, sizeof(*server->changes));
    server->links_up = mem_array(plant->source_count, sizeof(*server->links_up));
    if (server->tokens) {
        tokens_set_plant(server->tokens, plant->name);
        tokens_set_pairings(server->tokens, pairings_find, server->params.plant.pairings);
    }
    server->session_context.plant = plant;
    server->session_context.scene = server->params.plant.scene;
    server->session_context.snapshot = server->snapshot;
    server->session_context.baselines = server->params.plant.baselines;
    server->session_context.alarm_service = server->params.plant.alarm_service;
    server->session_context.placing = server->params.save && !server->params.plant.core_link ? server->params.plant.placing : NULL;
    server->session_context.loop_checks = server->params.plant.loop_checks;
    server->session_context.named_views = server->params.plant.named_views;
    server->session_context.notes = server->params.plant.notes;
    server->session_context.wall_remote = server->params.plant.wall_remote;
    server->session_context.pairings = server->params.plant.pairings;
    server->session_context.tag_list = server->params.plant.tag_list;
    server->session_context.links_up = server->links_up;
    core_end_bind(server);
    net_take_snapshot(server);
    net_check_links(server);
}
