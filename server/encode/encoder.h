/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Turns frames into packets. Thread: one at a time per encoder (a worker). */
#ifndef ENCODE_ENCODER_H
#define ENCODE_ENCODER_H
#include "base/log.h"
#include "encode/packet.h"

struct encoder;
struct encoder_params {
    int quality;      /* 1..100, for codecs that have one */
    bool full_chroma; /* 4:4:4 instead of 4:2:0 */
};

/* name: "jpeg", "png". NULL on failure, already logged. */
struct encoder *encoder_create(struct log *log, const char *name);
void encoder_destroy(struct encoder **encoder); /* &NULL is fine; leaves NULL */
/* Takes its own reference on frame. 0, or -EAGAIN: call encoder_receive() first. Other < 0: logged, this frame cannot be encoded. */
int encoder_send(struct encoder *encoder, struct frame *frame, const struct encoder_params *params);
/* 0: the caller owns *out (packet_unref). -EAGAIN: nothing ready. Other < 0: this encoder is dead. */
int encoder_receive(struct encoder *encoder, struct packet **out);

#endif
