/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A client's request for a frame: what to draw, how to encode it, and how urgent it is. Plain data. */
#ifndef SERVICE_FRAME_REQUEST_H
#define SERVICE_FRAME_REQUEST_H
#include "encode/encoder.h"
#include "render/frame.h"
#include "render/view.h"
#include "service/scheduler.h"

struct frame_request {
    struct view view;
    enum wire_codec codec;
    /* quality with which to encode the frame; only the members quality and full_chroma are used, all others are zero */
    struct encoder_params quality;
    enum urgency urgency;
    /* id of the account that is charged for drawing. Each client address has an account; 0: the account of all requests without
       an address */
    uint64_t account;
    int64_t asked_ns; /* monotonic time when the request was made */
    /* monotonic time of the newest change of readings that the client knows; frames with older readings do not answer the request */
    int64_t read_ns;
    int step;         /* step of the quality ladder (picture quality by bandwidth) with which previews are drawn and encoded */
    /* factor by which width and height of a preview are smaller than those of the client's view; 1 if or_moving is set */
    double scale;
    bool draft;       /* true: a draft: a refined frame encoded in low quality and sent before the final one */
    bool of_data;     /* true: the request was made because a reading changed, at the time view.input_ns */
    /* true: a refined frame is drawn only if it takes no longer than a preview; otherwise a preview with moving_quality is drawn */
    bool or_moving;
    struct encoder_params moving_quality;
    /* codec of a preview that may be drawn instead of a refined frame; that preview comes without the record of its inputs. 0:
       the preview has the codec and the record that the refined frame would have */
    enum wire_codec moving_codec;
    /* rectangle of the picture that the client gets; requests for different rectangles of one picture share one drawing */
    struct frame_part part;
    /* sequence number, from 1, of the wall's picture that all its tiles show together (session/tiles/tile_sync.h); 0: the
       client is not a tile */
    uint64_t picture;
    /* true: the client may have no more frames in flight, so the request may only replace an earlier one whose drawing has not begun */
    bool only_replace;
    bool always; /* true: the frame is drawn and sent even if the client already shows the content */
    bool alone;  /* true: the frame must be encoded so that it can be decoded without earlier packets */
    bool depth;  /* true: the client gets the frame's depth grid (render/depth_grid.h) */
    bool record; /* true: the frame includes the record of what it was drawn from (render/frame_record.h), for signing; PNG only */
    /* texts and signs drawn over the model. OVERLAY_NONE: none; FULL: legend, clock, sensors and alarms; BARE: only legend and
       clock */
    enum { OVERLAY_NONE, OVERLAY_FULL, OVERLAY_BARE } overlay;
};

#endif
