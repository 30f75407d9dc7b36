/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warm-up: what only the first frames cost is paid before anyone waits for them. */
#include "base/clock.h"
#include "service/render_thread_impl.h"

static const int64_t IDLE_NS = 5 * NS_PER_MS; /* of warm-up, before looking whether somebody waits */

/* For what it costs. */
static void draw_for_nobody(struct render_thread *thread, const struct view *view)
{
    render_thread_refresh(thread);
    struct frame *frame = split_view_draw_now(thread->renderer, view, thread->snapshot);
    if (frame)
        frame_unref(&frame);
}

/* What only the first frame of a tier costs (shaders) is paid before anyone asks. */
void render_thread_warm_tier(struct render_thread *thread, enum tier tier)
{
    struct view view;
    view_default(thread->service->params.scene, 64, 36, &view);
    view.tier = tier;
    draw_for_nobody(thread, &view);
}

/* Frames that somebody waits for: the next ones find their fields, buffers and shaders. */
void render_thread_draw_first(struct render_thread *thread)
{
    const struct render_service_params *params = &thread->service->params;
    for (size_t i = 0; i < params->first_count; i++) {
        struct view view = params->first[i];
        view.tier = TIER_PREVIEW;
        draw_for_nobody(thread, &view);
    }
}

void render_thread_warm_up(struct render_thread *thread)
{
    thread->warm = renderer_bake_idle(thread->renderer, IDLE_NS);
    render_thread_note_work(thread);
    if (thread->warm)
        render_thread_warm_tier(thread, TIER_REFINED);
}
