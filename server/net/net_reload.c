/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The event loop during a plant reload: sessions and requests release the old plant and take the new one. */

#include "base/clock.h"
#include "base/mem.h"
#include "net/core_end.h"
#include "net/net.h"
#include "net/net_impl.h"
#include "net/renderers.h"
#include "net/stream.h"
#include "session/view/resume.h"

/* --- views in the new plant ------------------------------------------------------------------------------------------ */

static bool is_new(const struct view *view, const struct view *others, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (view_equal(view, &others[i]))
            return false;
    return true;
}

size_t net_views(struct net *net, const struct plant_services *next, struct view *out, size_t most)
{
    struct snapshot *snapshot = snapshot_create(next->scene->plant->tag_count);
    struct session_context session_context = net->server.session_context;
    size_t count = 0;
    store_snapshot(next->store, clock_mono_ns(), clock_plant_ns(next->clock), snapshot);
    session_context.plant = next->scene->plant;
    session_context.services = next;
    session_context.readings.snapshot = snapshot;
    for (const struct stream *stream = net->server.streams.first; stream && count < most; stream = stream->next)
        if (stream->session->hello && !stream->session->hidden) {
            session_view_in(stream->session, &session_context, &out[count]);
            count += is_new(&out[count], out, count);
        }
    snapshot_destroy(&snapshot);
    return count;
}

/* --- from the old plant to the new one ------------------------------------------------------------------------------- */

void net_release_historian(struct net *net)
{
    net->server.params.plant.historian = NULL;
}

void net_release_recording(struct net *net)
{
    net_release_historian(net);
    net->server.params.plant.notifier = NULL;
}

void net_announce_reload(struct net *net, const char *configuration)
{
    renderers_announce_reload(&net->server, configuration);
}

void net_release_plant(struct net *net)
{
    struct server_context *server = &net->server;
    /* answers users whose actions waited for the disk: by now, the old plant's journal has written them */
    net_settle_answers(net);
    for (struct stream *stream = server->streams.first; stream; stream = stream->next)
        stream->carried = session_carry(stream->session);
    http_release_plant(server);
    if (server->signing.signer)
        picture_signer_settle(server->signing.signer);
    core_end_collect(server); /* handles the last messages that the core (daemon that reads the devices) sent about the old plant */
    renderers_close(server, "the core has changed its configuration");
    net_unwatch_readings(net);
    history_queries_destroy(&server->history_queries);
    history_loader_destroy(&server->history_loader);
    resumes_forget_gone(server->session_context.resumes);
    tag_text_cache_finish(&server->texts.tags);
    alarm_text_cache_finish(&server->texts.alarms);
    for (int i = 0; i < LISTS; i++) {
        mem_free(server->texts.lists[i]);
        server->texts.lists[i] = NULL;
    }
    marker_text_cache_finish(&server->texts.markers);
    server->texts.markers = (struct marker_text_cache){ .frame = NULL };
    neighbour_text_cache_finish(&server->texts.neighbours);
    snapshot_destroy(&server->readings.snapshot);
    mem_free(server->readings.changes);
    mem_free(server->readings.links_up);
}

void net_lead(struct net *net, const struct plant_services *plant)
{
    struct server_context *server = &net->server;
    core_end_collect(server);
    server->params.plant = *plant;
    server->params.plant.core_link = NULL;
    net_limit_services(server);
    core_end_bind(server);
    net_check_links(server);
    streams_on_readings(server, false, true);
}

bool net_take_plant(struct net *net, const struct plant_services *plant)
{
    struct server_context *server = &net->server;
    server->params.plant = *plant;
    server->core.listed = false;
    server->texts.alarms_number = 0;
    net_bind_plant(net);
    bool good = net_open_history(net);
    for (struct stream *stream = server->streams.first; stream; stream = stream->next) {
        session_take_plant(stream->session, stream->carried);
        mem_free(stream->carried);
        stream->carried = NULL;
        known_markers_finish(&stream->known);
        stream->known = (struct known_markers){ 0 };
    }
    net_watch_readings(net);
    streams_on_alarms(server);
    render_service_wake(server->params.plant.render_service);
    return good;
}

void net_report_reload(struct net *net, uint64_t number, bool good, const char *text)
{
    http_on_reloaded(&net->server, number, good, text);
}

void net_report_save(struct net *net, uint64_t client, const char *text)
{
    net->server.session_context.records.saving = false;
    stream_say(&net->server, client, text);
    render_service_wake(net->server.params.plant.render_service);
}
