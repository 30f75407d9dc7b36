/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interface between encoder.c, which has the table of codecs, and the codecs. Private to encode/. */
#ifndef ENCODE_ENCODER_IMPL_H
#define ENCODE_ENCODER_IMPL_H
#include "encode/dirty_rects.h"
#include "encode/encoder.h"

struct encoder_impl {
    const char *name;
    bool is_stream;
    struct encoder *(*create)(struct log *log, const char *library);
    /* Encodes a frame and stores the packet in encoder->ready. count 0: encodes the whole frame. Otherwise `rects` cover
       everything that differs from params->before, and the codec must encode at least these rectangles. */
    int (*send)(struct encoder *encoder, struct frame *frame, const struct encoder_params *params, const struct dirty_rect *rects,
                int count);
    void (*destroy)(struct encoder *encoder);
};

struct encoder { /* the members that all codecs have; each codec's own struct begins with this struct */
    const struct encoder_impl *impl;
    struct log *log;
    struct packet *ready; /* packet from send() that encoder_receive() has not returned yet; NULL: none */
};

extern const struct encoder_impl jpeg_impl, png_impl;
#ifdef PLANTCAST_H264
extern const struct encoder_impl h264_impl;
#endif

#endif
