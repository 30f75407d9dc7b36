/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The message `markers` that precedes a frame: where its sensors and labels are and what the frame shows of them; after the first, only
   what changed. Pure. Thread: the loop. */
#ifndef MESSAGE_MARKER_TEXT_H
#define MESSAGE_MARKER_TEXT_H
#include "render/frame.h"

struct known_markers { /* as a client was last told; zero-initialise; known_markers_finish */
    bool any;
    struct frame_marker *markers;
    size_t marker_count, marker_capacity;
    struct frame_label *labels;
    size_t label_count, label_capacity;
    double drawn_error;
};

struct marker_text_cache { /* JSON lists of the last frame, for all who get it; zero-initialise; marker_text_cache_finish */
    struct frame *frame;
    char *markers, *labels, *arrows;
};

/* Returns the message for the frame of number seq; mem_free. Returns NULL if the client knows all of it. Updates *known. */
char *marker_text(struct frame *frame, uint32_t seq, struct known_markers *known, struct marker_text_cache *lists);
void marker_text_cache_finish(struct marker_text_cache *lists);
void known_markers_finish(struct known_markers *known);

#endif
