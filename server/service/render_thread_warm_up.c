/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warm-up: pays the costs of the first frames before clients wait for them. */
#include "base/clock.h"
#include "service/render_thread_impl.h"

static const int64_t IDLE_NS = 5 * NS_PER_MS; /* duration of one piece of the warm-up, after which the thread checks for requests */

/* Draws a frame and discards it, to fill caches and compile shaders. */
static void draw_for_nobody(struct render_thread *thread, const struct view *view)
{
    render_thread_refresh(thread);
    struct frame *frame = split_view_draw_now(thread->renderer, view, thread->snapshot);
    if (frame)
        frame_unref(&frame);
}

/* Compiles the shaders for previews or refined frames (`tier`) by drawing a small frame. */
void render_thread_warm_tier(struct render_thread *thread, enum tier tier)
{
    struct view view;
    view_default(thread->service->params.scene, 64, 36, &view);
    view.tier = tier;
    draw_for_nobody(thread, &view);
}

/* Draws the views that clients will request first, so that their fields, buffers and shaders exist. */
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
