/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The message `markers`, which precedes a frame: positions and values of the frame's markers and labels. A client's first
   message has all markers and labels, later ones only changes. Pure. Call only in the event loop. */
#ifndef MESSAGE_MARKER_TEXT_H
#define MESSAGE_MARKER_TEXT_H
#include "render/frame.h"

struct known_markers { /* sensor markers and labels already sent to a client; zero-initialise; end with known_markers_finish() */
    bool any;
    struct frame_marker *markers;
    size_t marker_count, marker_capacity;
    struct frame_label *labels;
    size_t label_count, label_capacity;
    double drawn_error[2]; /* by half of a split view */
};

/* JSON lists of the newest frame's markers and labels, built once for all its clients; zero-initialise; end with
   marker_text_cache_finish() */
struct marker_text_cache {
    struct frame *frame;
    char *markers, *labels, *arrows;
};

/* Returns the message `markers` for the frame with sequence number seq; free with mem_free(). Returns NULL if nothing changed for the
   client. Updates `known`. */
char *marker_text(struct frame *frame, uint32_t seq, struct known_markers *known, struct marker_text_cache *lists);
void marker_text_cache_finish(struct marker_text_cache *lists);
void known_markers_finish(struct known_markers *known);

#endif
