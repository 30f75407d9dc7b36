/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes the one H.264 stream that all outputs carry. Thread: one; what it makes comes from a thread of its own. */
#ifndef VIDEO_ENCODER_H
#define VIDEO_ENCODER_H
#include "options.h"
#include "outputs.h"

struct video_encoder;
/* Begins a stream into outputs, which have to stay. Returns NULL with the reason printed. The caller destroys it. */
struct video_encoder *encoder_create(const struct video_options *options, struct outputs *outputs);
void encoder_destroy(struct video_encoder **encoder); /* &NULL is fine; leaves NULL */
/* Returns whether the encoder takes another frame now; else it is behind. */
bool encoder_is_ready(const struct video_encoder *encoder);
/* Encodes frame number `index` of a stream of fps frames a second. Takes the pixels (BGRX). */
void encoder_add(struct video_encoder *encoder, GstBuffer *pixels, guint64 index);
/* Returns false, with the reason printed, once the encoder has failed. */
bool encoder_is_good(struct video_encoder *encoder);

#endif
