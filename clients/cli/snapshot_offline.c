/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One picture of a prepared plant, without a daemon. */
#include <stdio.h>

#include "base/mem.h"
#include "net/message/reply.h"
#include "studio.h"

static bool draw(struct studio *studio, const struct snapshot_options *options, struct view *view)
{
    struct frame *frame = studio_draw(studio, options, view);
    if (!frame)
        return false;
    log_info(studio->log, "%s: %dx%d, %d triangles, field %.1f ms, render %.1f ms", options->out, frame->width_px, frame->height_px,
             frame->triangles, frame->field_ns / 1e6, frame->render_ns / 1e6);
    bool good = studio_save(studio, frame, options->out);
    frame_unref(&frame);
    return good;
}

static void print_pick(struct studio *studio, const struct snapshot_options *options, const struct view *view)
{
    struct pick_answer *answer = mem_new(sizeof(*answer));
    answer->order = (struct pick_order){ .view = *view, .x_px = options->place_px[0], .y_px = options->place_px[1] };
    pick_at(studio->scene, studio->field, view, studio->snapshot, answer->order.x_px, answer->order.y_px, &answer->pick);
    char *text = reply_picked_text(studio->plant, answer);
    puts(text);
    mem_free(text);
    mem_free(answer);
}

/* The past, unless the values are told. */
static bool go_back(struct studio *studio, const struct snapshot_options *options, struct view *view)
{
    return !options->at || options->value_count > 0 ||
           (studio_open_history(studio, options) && studio_travel(studio, options->at_us, view));
}

int snapshot_offline(struct snapshot_options *options)
{
    struct studio studio;
    struct view view;
    int code = studio_open(&studio, options, &view);
    if (code == 0 && !go_back(&studio, options, &view))
        code = 1;
    if (code == 0 && options->pick)
        print_pick(&studio, options, &view);
    if (code == 0 && options->out && !(studio_open_gl(&studio, options) && draw(&studio, options, &view)))
        code = 1;
    studio_close(&studio);
    return code;
}
