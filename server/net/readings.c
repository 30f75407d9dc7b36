/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The event loop's snapshot of the readings. While there are clients, it is taken when the store reports a change or a reading becomes
   stale; without clients, only when a request reads it. */
#include "base/clock.h"
#include "net/net.h"
#include "net/net_impl.h"
#include "net/renderers.h"
#include "value/quality.h"

static const int64_t MIN_INTERVAL_NS = 100 * NS_PER_MS; /* minimum time between two snapshots, however often readings change */
/* delay of a snapshot after a change, so that one frame shows all readings of one device message */
static const int64_t GATHER_NS = 10 * NS_PER_MS;

static int64_t later(int64_t a_ns, int64_t b_ns)
{
    return a_ns > b_ns ? a_ns : b_ns;
}

/* Returns when a reading changed. A reading that has just become stale changed now, whenever it was received. */
static int64_t changed_ns(const struct snapshot *snapshot, const struct reading *reading)
{
    bool usable = !quality_is_bad(reading->quality) && reading->age_ns < NS_PER_S;
    return snapshot->taken_mono_ns - (usable ? reading->age_ns : 0);
}

bool net_take_snapshot(struct server_context *server)
{
    bool changed = false;
    const struct plant_services *plant = &server->params.plant;
    server->readings.next_change_ns = store_take(plant->store, clock_mono_ns(), clock_plant_ns(plant->clock), server->readings.snapshot);
    render_service_set_readings(plant->render_service, server->readings.snapshot);
    server->readings.data_ns = server->readings.snapshot->taken_mono_ns;
    for (size_t i = 0; i < server->readings.snapshot->count; i++) {
        const struct reading *reading = &server->readings.snapshot->readings[i];
        if (server->readings.changes[i] == reading->changes)
            continue;
        int64_t at_ns = changed_ns(server->readings.snapshot, reading);
        server->readings.data_ns = at_ns < server->readings.data_ns ? at_ns : server->readings.data_ns;
        server->readings.changes[i] = reading->changes;
        changed = true;
    }
    return changed;
}

bool net_check_links(struct server_context *server)
{
    bool changed = false, any = false;
    for (size_t i = 0; i < server->session_context.plant->source_count; i++) {
        bool up = store_link_is_up(server->params.plant.store, (int)i);
        changed |= server->readings.links_up[i] != up;
        server->readings.links_up[i] = up;
        any |= up;
    }
    struct core_link *core_link = server->params.plant.core_link;
    bool core_up = core_link && core_link_is_up(core_link);
    changed |= server->session_context.core_up != core_up;
    server->session_context.core_up = core_up;
    server->session_context.live = any;
    struct clock_state clock = clock_state_read(), *known = &server->session_context.clock;
    changed |= known->set != clock.set || known->leap_s != clock.leap_s || clock_state_error_ms(known) != clock_state_error_ms(&clock);
    *known = clock;
    counter_set(server->counters.clock_set, clock.set);
    counter_set(server->counters.clock_error, (int64_t)(clock.error_s * 1e6));
    counter_set(server->counters.clock_leap, clock.leap_s);
    return changed;
}

static void take(struct net *net)
{
    struct server_context *server = &net->server;
    bool data_changed = net_take_snapshot(server), links_changed = net_check_links(server);
    if (data_changed)
        server->session_context.changed_ns = server->readings.snapshot->taken_mono_ns;
    if (data_changed || links_changed)
        streams_on_readings(server, data_changed, links_changed);
    if (data_changed || links_changed)
        renderers_on_change(server);
    render_service_wake(server->params.plant.render_service);
    /* 1 ms after the reading becomes stale, because the event loop may wake a little early */
    int64_t stale_ns = server->readings.next_change_ns < INT64_MAX ? server->readings.next_change_ns + NS_PER_MS : INT64_MAX;
    net->readings_ns = later(stale_ns, server->readings.snapshot->taken_mono_ns + MIN_INTERVAL_NS);
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
    if (atomic_exchange(&net->readings_changed, false))
        net->readings_ns = later(now_ns + GATHER_NS, net->server.session_context.changed_ns + MIN_INTERVAL_NS);
    if (net->server.streams.count == 0 && !net->server.core.renderers)
        return INT64_MAX;
    if (now_ns >= net->readings_ns)
        take(net);
    return net->readings_ns;
}

void net_refresh_readings(struct server_context *server)
{
    if (clock_mono_ns() - server->readings.snapshot->taken_mono_ns > MIN_INTERVAL_NS)
        take(lws_container_of(server, struct net, server));
}
