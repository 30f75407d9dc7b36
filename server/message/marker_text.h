/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The message that goes before a frame: where its sensors are and what the picture shows of them; after the first one only what changed
   since the one before. Pure. */
#ifndef MESSAGE_MARKER_TEXT_H
#define MESSAGE_MARKER_TEXT_H
#include "render/frame.h"

struct known_markers { /* what a client knows; zero-initialise */
    bool any;
    struct frame_marker *markers;
    size_t marker_count, marker_capacity;
    struct frame_label *labels;
    size_t label_count, label_capacity;
};

struct marker_text_cache { /* of the last frame, as JSON, for all who get it; zero-initialise */
    struct frame *frame;
    char *markers, *labels;
};

/* NULL: all of it was said. Brings *said up to date. mem_free. */
char *marker_text(struct frame *frame, uint32_t seq, struct known_markers *said, struct marker_text_cache *lists);
void marker_text_cache_finish(struct marker_text_cache *lists);
void known_markers_finish(struct known_markers *said);

#endif
