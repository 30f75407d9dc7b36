/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fetches pictures of one view from a daemon, again and again for ever, and says what may be shown of them: a picture younger than
   3 s, or a card. Thread: that of the default main context. */
#ifndef VIDEO_SOURCE_H
#define VIDEO_SOURCE_H
#include "canvas.h"
#include "options.h"

struct video_source;
/* Begins to fetch. options have to stay. Returns NULL with the reason printed. The caller destroys it. */
struct video_source *source_create(const struct video_options *options);
void source_destroy(struct video_source **source); /* &NULL is fine; leaves NULL */
/* Looks after requests that take too long, begins those that are due, and says what is to be seen. Call it for each frame. What *out points
   to belongs to the source until the next call. */
void source_look(struct video_source *source, struct shown *out);
guint64 source_pictures(const struct video_source *source); /* how many it got */

#endif
