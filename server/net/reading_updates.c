/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Takes snapshots of the readings and tells streams and renderers what changed. While there are clients, a snapshot is taken when the store
   reports a change or a reading becomes stale; without clients, only when a request reads it (net_refresh_readings). */
#include "base/clock.h"
#include "net/net.h"
#include "net/net_impl.h"
#include "net/renderers.h"

/* delay in nanoseconds between a change of a reading and the next snapshot, so that readings that a device sends together
   appear in one frame */
static const int64_t GATHER_NS = 10 * NS_PER_MS;

static int64_t later(int64_t a_ns, int64_t b_ns)
{
    return a_ns > b_ns ? a_ns : b_ns;
}

/* Tells streams and renderers what changed in the last snapshots. */
static void tell_changes(struct server_context *server)
{
    bool data_changed = server->readings.data_changed, links_changed = server->readings.links_changed;
    server->readings.data_changed = server->readings.links_changed = false;
    if (data_changed || links_changed) {
        streams_on_readings(server, data_changed, links_changed);
        renderers_on_change(server);
    }
    render_service_wake(server->params.plant.render_service);
}

/* Returns the monotonic time at which the next snapshot is due even if no reading changes. */
static int64_t next_ns(const struct server_context *server)
{
    /* adds 1 ms to the time when a reading becomes stale (too old to be Good), because the event loop may wake up slightly
       early */
    int64_t stale_ns = server->readings.next_change_ns < INT64_MAX ? server->readings.next_change_ns + NS_PER_MS : INT64_MAX;
    return later(stale_ns, server->readings.snapshot->taken_mono_ns + READINGS_INTERVAL_NS);
}

static void take(struct net *net)
{
    net_note_changes(&net->server);
    tell_changes(&net->server);
    net->readings_ns = next_ns(&net->server);
}

static void on_change(void *arg)
{
    struct net *net = arg;
    atomic_store(&net->readings_changed, true);
    net_wake(net);
}

void net_watch_readings(struct net *net)
{
    store_watch(net->server.params.plant.store, on_change, net);
    take(net);
}

void net_unwatch_readings(struct net *net)
{
    store_watch(net->server.params.plant.store, NULL, NULL);
}

int64_t net_update_readings(struct net *net, int64_t now_ns)
{
    struct server_context *server = &net->server;
    if (atomic_exchange(&net->readings_changed, false))
        net->readings_ns = later(now_ns + GATHER_NS, server->session_context.readings.changed_ns + READINGS_INTERVAL_NS);
    if (server->streams.count == 0 && !server->core.renderers)
        return INT64_MAX;
    /* announces the changes in a snapshot that a request took since the last call */
    if (server->readings.data_changed || server->readings.links_changed) {
        int64_t due_ns = next_ns(server);
        tell_changes(server);
        net->readings_ns = due_ns < net->readings_ns ? due_ns : net->readings_ns;
    }
    if (now_ns >= net->readings_ns)
        take(net);
    return net->readings_ns;
}
