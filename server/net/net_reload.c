/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop while the plant is loaded anew: sessions and requests let go of the old one and take the new one. */
#include <pthread.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/net_impl.h"
#include "net/stream.h"

/* --- calls into the loop ---------------------------------------------------------------------------------------------------- */

void net_calls_init(struct net *net)
{
    pthread_mutex_init(&net->call.lock, NULL);
    pthread_cond_init(&net->call.done, NULL);
}

void net_calls_finish(struct net *net)
{
    pthread_cond_destroy(&net->call.done);
    pthread_mutex_destroy(&net->call.lock);
}

bool net_call(struct net *net, void (*what)(void *arg), void *arg)
{
    pthread_mutex_lock(&net->call.lock);
    bool open = !net->call.closed;
    net->call.what = what;
    net->call.arg = arg;
    net_wake(net);
    while (net->call.what && !net->call.closed)
        pthread_cond_wait(&net->call.done, &net->call.lock);
    open = open && !net->call.what;
    net->call.what = NULL;
    pthread_mutex_unlock(&net->call.lock);
    return open;
}

void net_calls_run(struct net *net)
{
    pthread_mutex_lock(&net->call.lock);
    void (*what)(void *arg) = net->call.what;
    void *arg = net->call.arg;
    pthread_mutex_unlock(&net->call.lock);
    if (!what)
        return;
    what(arg); /* who asked waits, and so changes nothing */
    pthread_mutex_lock(&net->call.lock);
    net->call.what = NULL;
    pthread_cond_signal(&net->call.done);
    pthread_mutex_unlock(&net->call.lock);
}

void net_calls_close(struct net *net)
{
    pthread_mutex_lock(&net->call.lock);
    net->call.closed = true;
    pthread_cond_signal(&net->call.done);
    pthread_mutex_unlock(&net->call.lock);
}

/* --- what will be looked at ------------------------------------------------------------------------------------------------- */

static bool is_new(const struct view *view, const struct view *others, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (view_equal(view, &others[i]))
            return false;
    return true;
}

size_t net_views(struct net *net, const struct net_plant *next, struct view *out, size_t most)
{
    struct snapshot *snapshot = snapshot_create(next->scene->plant->tag_count);
    struct session_context world = net->hub.world;
    size_t count = 0;
    store_snapshot(next->store, clock_mono_ns(), clock_utc_ns(), snapshot);
    world.plant = next->scene->plant;
    world.scene = next->scene;
    world.snapshot = snapshot;
    world.baselines = next->baselines;
    for (const struct stream *stream = net->hub.streams; stream && count < most; stream = stream->next)
        if (stream->session->hello && !stream->session->hidden) {
            session_view_in(stream->session, &world, &out[count]);
            count += is_new(&out[count], out, count);
        }
    snapshot_destroy(&snapshot);
    return count;
}

/* --- the old one, the new one ----------------------------------------------------------------------------------------------- */

void net_release_plant(struct net *net)
{
    struct server_context *hub = &net->hub;
    for (struct stream *stream = hub->streams; stream; stream = stream->next)
        stream->carried = session_carry(stream->session);
    http_release_plant(hub);
    history_queries_destroy(&hub->recall);
    history_loader_destroy(&hub->past);
    resumes_forget_gone(hub->world.resumes);
    tag_text_cache_finish(&hub->tags_said);
    alarm_text_cache_finish(&hub->alarms_said);
    for (int i = 0; i < 2; i++) {
        mem_free(hub->lists_said[i]);
        hub->lists_said[i] = NULL;
    }
    marker_text_cache_finish(&hub->marker_lists);
    hub->marker_lists = (struct marker_text_cache){ .frame = NULL };
    snapshot_destroy(&hub->snapshot);
    mem_free(hub->changes);
    mem_free(hub->links_up);
}

bool net_take_plant(struct net *net, const struct net_plant *plant)
{
    struct server_context *hub = &net->hub;
    hub->params.plant = *plant;
    hub->alarms_number = 0;
    net_bind_plant(net);
    bool good = net_open_history(net);
    for (struct stream *stream = hub->streams; stream; stream = stream->next) {
        session_take_plant(stream->session, stream->carried);
        mem_free(stream->carried);
        stream->carried = NULL;
        known_markers_finish(&stream->said);
        stream->said = (struct known_markers){ 0 };
    }
    streams_on_alarms(hub);
    net_wake_render_service(hub);
    return good;
}

void net_report_reload(struct net *net, bool good, const char *text)
{
    http_on_reloaded(&net->hub, good, text);
}

void net_report_save(struct net *net, uint64_t client, const char *text)
{
    net->hub.world.saving = false;
    stream_say(&net->hub, client, text);
    net_wake_render_service(&net->hub);
}
