/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the loop knows of one plant: its readings, its links, its history. */
#include "base/clock.h"
#include "base/mem.h"
#include "net/net.h"
#include "net/net_impl.h"
#include "value/quality.h"

/* A reading that went stale changed just now, whenever it came in. */
static int64_t changed_ns(const struct snapshot *snapshot, const struct reading *reading)
{
    bool usable = !quality_is_bad(reading->quality) && reading->age_ns < NS_PER_S;
    return snapshot->taken_mono_ns - (usable ? reading->age_ns : 0);
}

bool net_take_snapshot(struct server_context *server)
{
    bool changed = false;
    server->next_change_ns = store_take(server->params.plant.store, clock_mono_ns(), clock_utc_ns(), server->snapshot);
    server->data_ns = server->snapshot->taken_mono_ns;
    for (size_t i = 0; i < server->snapshot->count; i++) {
        const struct reading *reading = &server->snapshot->readings[i];
        if (server->changes[i] == reading->changes)
            continue;
        int64_t at_ns = changed_ns(server->snapshot, reading);
        server->data_ns = at_ns < server->data_ns ? at_ns : server->data_ns;
        server->changes[i] = reading->changes;
        changed = true;
    }
    return changed;
}

bool net_check_links(struct server_context *server)
{
    bool changed = false, any = false;
    for (size_t i = 0; i < server->session_context.plant->source_count; i++) {
        bool up = store_link_is_up(server->params.plant.store, (int)i);
        changed |= server->links_up[i] != up;
        server->links_up[i] = up;
        any |= up;
    }
    server->session_context.live = any;
    bool set = clock_utc_is_set();
    changed |= server->session_context.clock_is_set != set;
    server->session_context.clock_is_set = set;
    counter_set(server->counters.clock_set, set);
    return changed;
}

static void wake(void *arg)
{
    net_wake(arg);
}

bool net_open_history(struct net *net)
{
    struct server_context *server = &net->server;
    const struct net_plant *plant = &server->params.plant;
    const struct history_loader_params history_loader = { .log = server->params.log,
                                                          .plant = plant->scene->plant,
                                                          .folder = plant->history_folder,
                                                          .snapshot_cache = plant->snapshot_cache,
                                                          .notify = wake,
                                                          .notify_arg = net };
    server->session_context.snapshot_cache = plant->history_folder ? plant->snapshot_cache : NULL;
    if (!plant->history_folder)
        return true;
    server->history_queries = history_queries_create(server->params.log, plant->scene->plant, plant->history_folder, wake, net);
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
    server->session_context.plant = plant;
    server->session_context.scene = server->params.plant.scene;
    server->session_context.snapshot = server->snapshot;
    server->session_context.baselines = server->params.plant.baselines;
    server->session_context.alarm_service = server->params.plant.alarm_service;
    server->session_context.placing = server->params.save ? server->params.plant.placing : NULL;
    server->session_context.loop_checks = server->params.plant.loop_checks;
    server->session_context.tag_list = server->params.plant.tag_list;
    server->session_context.links_up = server->links_up;
    net_take_snapshot(server);
    net_check_links(server);
}
