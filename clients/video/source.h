/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests pictures of one view from a daemon forever, and decides what to show: a picture younger than 3 s, or a text card.
   Call only in the thread of GLib's default main context. */
#ifndef VIDEO_SOURCE_H
#define VIDEO_SOURCE_H
#include "canvas.h"
#include "options.h"

struct video_source;
/* Creates a source of pictures and starts its requests. `options` must outlive the source. Returns NULL with the reason
   printed. The caller destroys the source. */
struct video_source *source_create(const struct video_options *options);
void source_destroy(struct video_source **source); /* &NULL is fine; leaves NULL */
/* Cancels overdue requests, starts requests that are due, and sets *out to what must be shown now. Call it once per frame. The source
   owns the data that *out points to; valid until the next call. */
void source_look(struct video_source *source, struct shown *out);
guint64 source_pictures(const struct video_source *source); /* number of pictures received */

#endif
