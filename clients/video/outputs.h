/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Passes encoded frames to the pipelines of all outputs. Outputs do not block each other: if an output cannot take a frame, it
   misses all frames up to the next key frame. Call from any thread. */
#ifndef VIDEO_OUTPUTS_H
#define VIDEO_OUTPUTS_H
#include <gst/app/gstappsrc.h>
#include <stdbool.h>

#define OUTPUTS_CAPS "video/x-h264,stream-format=byte-stream,alignment=au"
/* Beginning of an output's pipeline description, in GStreamer's notation; the element named `in` receives the encoded frames. */
#define OUTPUTS_SOURCE                                                                                                                     \
    "appsrc name=in is-live=true format=time block=false max-bytes=0 caps=" OUTPUTS_CAPS " ! h264parse config-interval=-1"

struct outputs;
struct outputs *outputs_create(void);
/* Frees the outputs and sets *outputs to NULL; accepts a pointer to NULL. All threads that call outputs_push() must have ended
   before. */
void outputs_destroy(struct outputs **outputs);
/* Adds an output's pipeline; takes a reference on src, its source element. From the next key frame on, src receives encoded
   frames, timed by the running time of its own pipeline. */
void outputs_add(struct outputs *outputs, GstAppSrc *src);
void outputs_remove(struct outputs *outputs, GstAppSrc *src);
void outputs_push(struct outputs *outputs, GstBuffer *unit);

struct outputs_counts {
    guint64 units, key_units, bytes; /* produced by the encoder */
    guint64 dropped;                 /* sum over all outputs */
    guint outputs;
};
void outputs_count(struct outputs *outputs, struct outputs_counts *out);

#endif
