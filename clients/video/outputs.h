/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hands encoded units to all outputs. Outputs do not block each other: units that an output cannot take are dropped up to the next key
   frame. Thread: any. */
#ifndef VIDEO_OUTPUTS_H
#define VIDEO_OUTPUTS_H
#include <gst/app/gstappsrc.h>
#include <stdbool.h>

#define OUTPUTS_CAPS "video/x-h264,stream-format=byte-stream,alignment=au"
/* First elements of an output's pipeline; the source is named `in`. */
#define OUTPUTS_SOURCE                                                                                                                     \
    "appsrc name=in is-live=true format=time block=false max-bytes=0 caps=" OUTPUTS_CAPS " ! h264parse config-interval=-1"

struct outputs;
struct outputs *outputs_create(void);
void outputs_destroy(struct outputs **outputs); /* &NULL is fine; leaves NULL. All threads that push must have stopped */
/* Takes a reference on src. From the next key frame on, src receives access units, timed by its own pipeline's running time. */
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
