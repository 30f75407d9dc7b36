/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A display of a wall, drawn by the code of plantcast-wall (clients/wall), and what may be shown of it: what it draws now, or a card.
   Thread: that of the default main context; connections have one of their own. */
#ifndef VIDEO_WALL_SOURCE_H
#define VIDEO_WALL_SOURCE_H
#include "canvas.h"
#include "options.h"

struct wall_source;
/* Begins to connect. options have to stay. Returns NULL with the reason printed. The caller destroys it. */
struct wall_source *wall_source_create(const struct options *options);
void wall_source_destroy(struct wall_source **source); /* &NULL is fine; leaves NULL */
/* Draws what has changed, and says what is to be seen. Call it for each frame. What *out points to belongs to the source until the next
   call. */
void wall_source_look(struct wall_source *source, struct shown *out);
guint64 wall_source_pictures(const struct wall_source *source); /* how many its panes got */

#endif
