/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws one picture of a plant without a daemon, from files made by plantcast-prep. */
#include <stdio.h>

#include "base/mem.h"
#include "session/reply/reply.h"
#include "offline_renderer.h"

static bool draw(struct offline_renderer *offline, const struct snapshot_options *options, struct view *view)
{
    struct frame *frame = offline_renderer_draw(offline, options, view);
    if (!frame)
        return false;
    log_info(offline->log, "%s: %dx%d pixels, %d triangles; computed the field in %.1f ms, rendered in %.1f ms", options->out,
             frame->width_px, frame->height_px, frame->triangles, frame->field_ns / 1e6, frame->render_ns / 1e6);
    bool good = offline_renderer_save(offline, frame, options->out);
    frame_unref(&frame);
    return good;
}

static void print_pick(struct offline_renderer *offline, const struct snapshot_options *options, const struct view *view)
{
    struct pick_answer *answer = mem_new(sizeof(*answer));
    answer->query = (struct pick_query){ .view = *view, .x_px = options->place_px[0], .y_px = options->place_px[1] };
    pick_at(offline->scene, offline->field, view, offline->snapshot, answer->query.x_px, answer->query.y_px, &answer->pick);
    char *text = reply_picked_text(offline->plant, answer);
    puts(text);
    mem_free(text);
    mem_free(answer);
}

/* If the options have an instant but no values file, reads the values recorded at that instant. Returns false on failure (printed). */
static bool go_back(struct offline_renderer *offline, const struct snapshot_options *options, struct view *view)
{
    return !options->at || options->value_count > 0 ||
           (offline_renderer_open_history(offline, options) && offline_renderer_seek(offline, options->at_us, view));
}

int snapshot_offline(struct snapshot_options *options)
{
    struct offline_renderer offline;
    struct view view;
    int code = offline_renderer_open(&offline, options, &view);
    if (code == 0 && !go_back(&offline, options, &view))
        code = 1;
    if (code == 0 && options->pick)
        print_pick(&offline, options, &view);
    if (code == 0 && options->out && !(offline_renderer_open_gl(&offline, options) && draw(&offline, options, &view)))
        code = 1;
    offline_renderer_close(&offline);
    return code;
}
