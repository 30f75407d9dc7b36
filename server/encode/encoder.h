/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Turns frames into packets. Thread: one at a time per encoder (a worker). */
#ifndef ENCODE_ENCODER_H
#define ENCODE_ENCODER_H
#include "base/log.h"
#include "base/workers.h"
#include "encode/packet.h"

#define ENCODER_H264_LIBRARY "libx264" /* the encoder of libavcodec that is taken unless another one is named */

struct encoder;
struct encoder_params {
    int quality;          /* 1..100, for codecs that have one */
    bool full_chroma;     /* 4:4:4 instead of 4:2:0, for codecs that have both */
    bool key;             /* the packet must stand alone */
    struct workers *workers; /* that may help; NULL: none */
    struct frame *before; /* what the peer shows, in this quality; NULL: unknown. What equals it need not be sent */
};

/* name: "jpeg", "png" or, unless it was left out of the build, "h264"; that one's packets build on one another: one encoder for each
   stream. library: of H.264, an encoder of libavcodec. NULL on failure, already logged. */
struct encoder *encoder_create(struct log *log, const char *name, const char *library);
void encoder_destroy(struct encoder **encoder); /* &NULL is fine; leaves NULL */
/* 0, or -EAGAIN: call encoder_receive() first. Other < 0: logged, this frame cannot be encoded. */
int encoder_send(struct encoder *encoder, struct frame *frame, const struct encoder_params *params);
/* 0: the caller owns *out (packet_unref). -EAGAIN: nothing ready, or the last frame differs in nothing from params.before. */
int encoder_receive(struct encoder *encoder, struct packet **out);
/* Each packet of it but those with `key` needs the one before. */
bool encoder_is_stream(const char *name);
/* Encodes a small picture, to know whether it works on this machine. Why not is logged, unless it is not in this build. */
bool encoder_works(struct log *log, const char *name, const char *library);

#endif
