/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes the H.264 stream that all outputs carry. Call from one thread only; encoded data arrives on the encoder's own thread. */
#ifndef VIDEO_ENCODER_H
#define VIDEO_ENCODER_H
#include "options.h"
#include "outputs.h"

struct video_encoder;
/* Starts an H.264 stream that goes to `outputs`, which must outlive the encoder. Returns NULL with the reason printed. The caller destroys
   the encoder. */
struct video_encoder *encoder_create(const struct video_options *options, struct outputs *outputs);
void encoder_destroy(struct video_encoder **encoder); /* &NULL is fine; leaves NULL */
/* Returns true if the encoder accepts another frame now; false if it has not finished earlier ones. */
bool encoder_is_ready(const struct video_encoder *encoder);
/* Encodes the frame number `index` of a stream with a fixed frame rate. Takes ownership of the pixels (BGRX). */
void encoder_add(struct video_encoder *encoder, GstBuffer *pixels, guint64 index);
/* Returns true while the encoder works; false, with the reason printed, after it has failed. */
bool encoder_is_good(struct video_encoder *encoder);

#endif
