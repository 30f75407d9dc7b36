/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The message that goes before a frame: where its sensors are and what the picture shows of them; after the first one only what changed
   since the one before. Pure. */
#ifndef NET_MARKER_TEXT_H
#define NET_MARKER_TEXT_H
#include "render/frame.h"

struct marker_said { /* what a client knows; zero-initialise */
    bool any;
    struct frame_marker *markers;
    size_t marker_count, marker_capacity;
    struct frame_label *labels;
    size_t label_count, label_capacity;
};

struct marker_lists { /* of the last frame, as JSON, for all who get it; zero-initialise */
    struct frame *frame;
    char *markers, *labels;
};

/* NULL: all of it was said. Brings *said up to date. mem_free. */
char *marker_text(struct frame *frame, uint32_t seq, struct marker_said *said, struct marker_lists *lists);
void marker_lists_finish(struct marker_lists *lists);
void marker_said_finish(struct marker_said *said);

#endif
