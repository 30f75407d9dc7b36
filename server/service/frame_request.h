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
    struct encoder_params quality; /* only quality and full_chroma are used; the rest is zero */
    enum urgency urgency;
    /* id of the account to which drawing time is charged: the client's address; 0: one account for all requests without an address */
    uint64_t account;
    int64_t asked_ns; /* monotonic: when the request was made */
    int64_t read_ns;  /* monotonic: the client knows the readings up to this time; later changes of readings cause another request */
    int step;         /* step of the quality ladder, for previews */
    bool draft;       /* true: a refined draft, of lower quality than the final refined frame */
    bool of_data;     /* true: the request was made because a reading changed, at view.input_ns */
    /* true: a refined frame is drawn only if that is as quick as a preview; otherwise a preview with moving_quality is drawn */
    bool or_moving;
    struct encoder_params moving_quality;
    /* codec of the preview that may be drawn in place of a refined frame, without a record of inputs; 0: codec and record as requested */
    enum wire_codec moving_codec;
    struct frame_part part; /* rectangle of the picture that the client gets; one drawing serves the requests for all rectangles */
    uint64_t picture; /* sequence number of the wall's picture that all its tiles share (session/tiles/tile_sync.h), from 1; 0: no tile */
    /* true: the request is valid only in place of an earlier one whose drawing has not begun, because the client may have no more frames in
       flight */
    bool only_replace;
    bool always; /* true: the frame is drawn and sent even if the client already shows the content */
    bool alone;  /* true: the frame must decode without any packet sent before */
    bool depth;  /* true: the client gets the frame's depth grid (render/depth_grid.h) */
    bool record; /* true: the frame includes the record of its inputs (render/frame_record.h), for signing; PNG only */
    /* overlay on top of the scene: FULL: legend, clock, sensors and alarms; BARE: legend and clock */
    enum { OVERLAY_NONE, OVERLAY_FULL, OVERLAY_BARE } overlay;
};

#endif
