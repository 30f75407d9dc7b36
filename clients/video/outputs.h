/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hands what the encoder made to all that carry it on. None of them can hold up another: what one does not take is dropped, up to the next
   key frame. Thread: any. */
#ifndef VIDEO_OUTPUTS_H
#define VIDEO_OUTPUTS_H
#include <gst/app/gstappsrc.h>
#include <stdbool.h>

#define OUTPUTS_CAPS "video/x-h264,stream-format=byte-stream,alignment=au"
/* Begins the pipeline of an output: its element `in`. */
#define OUTPUTS_SOURCE                                                                                                                     \
    "appsrc name=in is-live=true format=time block=false max-bytes=0 caps=" OUTPUTS_CAPS " ! h264parse config-interval=-1"

struct outputs;
struct outputs *outputs_create(void);
void outputs_destroy(struct outputs **outputs); /* &NULL is fine; leaves NULL. After all that add to it are gone */
/* Takes a reference on src, which gets access units from the next key frame on, timed by the running time of its own pipeline. */
void outputs_add(struct outputs *outputs, GstAppSrc *src);
void outputs_remove(struct outputs *outputs, GstAppSrc *src);
void outputs_push(struct outputs *outputs, GstBuffer *unit);

struct outputs_counts {
    guint64 units, key_units, bytes; /* that the encoder made */
    guint64 dropped;                 /* of all outputs */
    guint outputs;
};
void outputs_count(struct outputs *outputs, struct outputs_counts *out);

#endif
