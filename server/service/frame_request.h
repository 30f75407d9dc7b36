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
    struct encoder_params quality; /* quality of encoding; only the members quality and full_chroma are used, the others are zero */
    enum urgency urgency;
    /* id of the account to which drawing time is charged: the client's address; 0: one account for all requests without an address */
    uint64_t account;
    int64_t asked_ns; /* monotonic time when the request was made */
    int64_t read_ns;  /* monotonic time up to which the client knows the readings; if readings change later, another request is made */
    int step;         /* step of the quality ladder at which a preview is drawn */
    bool draft;       /* true: a refined draft, of lower quality than the final refined frame */
    bool of_data;     /* true: the request was made because a reading changed, at the time view.input_ns */
    /* true: a refined frame is drawn only if that is as quick as a preview; otherwise a preview with moving_quality is drawn */
    bool or_moving;
    struct encoder_params moving_quality;
    /* codec of a preview that may be drawn instead of a refined frame; such a preview has no record of its inputs; 0: the codec and record
       requested for the refined frame */
    enum wire_codec moving_codec;
    struct frame_part part; /* part of the picture that the client gets; requests for different parts of one picture share one drawing */
    /* sequence number, from 1, of the wall's picture that all its tiles show together (session/tiles/tile_sync.h); 0: the client is no
       tile */
    uint64_t picture;
    /* true: the request may only replace an earlier request whose drawing has not begun, because the client may have no more frames in
       flight */
    bool only_replace;
    bool always; /* true: the frame is drawn and sent even if the client already shows the content */
    bool alone;  /* true: the frame must decode without any packet sent before */
    bool depth;  /* true: the client gets the frame's depth grid (render/depth_grid.h) */
    bool record; /* true: the frame includes the record of its inputs (render/frame_record.h), for signing; PNG only */
    /* parts of the overlay that are drawn over the scene. FULL: legend, clock, sensors and alarms; BARE: legend and clock */
    enum { OVERLAY_NONE, OVERLAY_FULL, OVERLAY_BARE } overlay;
};

#endif
