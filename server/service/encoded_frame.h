/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What goes between the loop and the render thread: a wish for a picture, and the picture. */
#ifndef SERVICE_ENCODED_FRAME_H
#define SERVICE_ENCODED_FRAME_H
#include "encode/encoder.h"
#include "service/scheduler.h"
#include "render/view.h"

struct frame_request {
    struct view view;
    enum wire_codec codec;
    struct encoder_params quality; /* quality and full_chroma; the rest is zero */
    enum urgency urgency;
    uint64_t payer;   /* whose share of time it takes: the client's address; 0: there are none apart */
    int64_t asked_ns; /* monotonic */
    int64_t read_ns;  /* likewise: readings that changed later will be asked for when they are noticed */
    int step;         /* of the ladder, where it moves */
    bool draft;       /* refined, but of less quality than the client shall have in the end */
    bool of_data;     /* for a reading that changed: view.input_ns is when */
    bool or_moving;   /* a refined picture if it takes no longer than one that moves, with new readings; else one that moves */
    struct encoder_params moving_quality; /* of that */
    bool only_replace;                    /* the client may have no more pictures: good only in place of a wish that is not begun */
    bool always;                          /* draw and send even if the picture would be the same as the last one of this client */
    bool alone;                           /* it must need nothing that was sent before */
    enum { OVERLAY_NONE, OVERLAY_FULL, OVERLAY_BARE } overlay; /* legend and clock drawn in, and, when full, sensors and alarms */
};

struct encoded_frame { /* belongs to whoever collected it: encoded_frame_destroy */
    uint64_t client;
    uint64_t number;         /* counts the client's wishes as they were begun: a larger one shows a newer state */
    struct packet *packet;   /* NULL: the picture would be the same as before, or could not be made */
    struct packet **earlier; /* to be decoded before it, oldest first: what the client missed of a stream that it shares */
    int earlier_count;
    bool failed;
    struct frame_request wish;
    int64_t wait_ns; /* from input to the start of drawing */
    int64_t made_ns; /* monotonic: it was encoded */
    struct encoded_frame *next;
};

void encoded_frame_destroy(struct encoded_frame **picture); /* &NULL is fine; leaves NULL */
size_t encoded_frame_bytes(const struct encoded_frame *picture);
/* It needs nothing that the client got before. */
bool encoded_frame_stands_alone(const struct encoded_frame *picture);

#endif
