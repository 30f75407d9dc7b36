/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A client's request for a frame: what to draw, how to encode it, how urgent it is. A plain value. */
#ifndef SERVICE_FRAME_REQUEST_H
#define SERVICE_FRAME_REQUEST_H
#include "encode/encoder.h"
#include "render/frame.h"
#include "render/view.h"
#include "service/scheduler.h"

struct frame_request {
    struct view view;
    enum wire_codec codec;
    struct encoder_params quality; /* quality and full_chroma; the rest is zero */
    enum urgency urgency;
    uint64_t account; /* whose share of drawing time it uses: the client's address; 0: one account for all such */
    int64_t asked_ns; /* monotonic: when it was made */
    int64_t read_ns;  /* likewise: readings up to then are known to the client; later changes bring another request */
    int step;         /* of the quality ladder, in a preview */
    bool draft;       /* refined, but of less quality than the client gets in the end */
    bool of_data;     /* made for a reading that changed at view.input_ns */
    bool or_moving;   /* refined only if that is as quick as a preview; else a preview of moving_quality */
    struct encoder_params moving_quality;
    enum wire_codec moving_codec; /* of that preview, which has no record then; 0: that of the frame, with what it has */
    struct frame_part part; /* what of the picture the client gets; the picture itself is drawn once for all parts */
    uint64_t picture;       /* number of the tiles' common picture (session/tiles/tile_sync.h), from 1; else 0 */
    bool only_replace; /* good only in place of a request that is not begun: the client may have no more frames under way */
    bool always;       /* draw and send even if the client shows the same already */
    bool alone;        /* must be decodable without anything sent before */
    bool record;       /* comes with what it was drawn from (render/frame_record.h), for whoever signs it; PNG only */
    enum { OVERLAY_NONE, OVERLAY_FULL, OVERLAY_BARE } overlay; /* draw legend and clock into it, and, when full, sensors and alarms */
};

#endif
