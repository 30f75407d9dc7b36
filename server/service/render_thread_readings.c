/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides which readings the render thread draws: those that the event loop sends as text, unless they are old. */
#include "base/clock.h"
#include "service/render_thread_impl.h"

/* maximum age in nanoseconds of a snapshot of readings, and thus the maximum error of the clock and of the ages in a frame */
static const int64_t SNAPSHOT_MAX_AGE_NS = 100 * NS_PER_MS;

void render_thread_refresh(struct render_thread *thread)
{
    struct render_service *service = thread->service;
    int64_t now_ns = clock_mono_ns();
    pthread_mutex_lock(&service->lock);
    if (thread->stale || service->readings->taken_mono_ns > thread->snapshot->taken_mono_ns)
        snapshot_assign(thread->snapshot, service->readings);
    pthread_mutex_unlock(&service->lock);
    if (now_ns - thread->snapshot->taken_mono_ns > SNAPSHOT_MAX_AGE_NS)
        store_snapshot(service->params.store, now_ns, clock_plant_ns(service->params.clock), thread->snapshot);
    thread->stale = false;
}

const struct snapshot *render_thread_readings(struct render_thread *thread, const struct view *view,
                                              const struct historical_snapshot **historical)
{
    *historical = view->at_us ? snapshot_cache_take(thread->service->params.snapshot_cache, view->at_us) : NULL;
    if (view->at_us)
        return *historical ? &(*historical)->snapshot : NULL;
    render_thread_refresh(thread);
    return thread->snapshot;
}
