/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serves the stream by RTSP. All clients share one GStreamer media pipeline. Call only in the thread of GLib's default main context. */
#ifndef VIDEO_RTSP_H
#define VIDEO_RTSP_H
#include "options.h"
#include "outputs.h"

struct rtsp;
/* Starts to listen for RTSP clients. Returns the RTSP server, which the caller destroys, or NULL with the reason printed. */
struct rtsp *rtsp_create(const struct video_options *options, struct outputs *outputs);
void rtsp_destroy(struct rtsp **rtsp);       /* &NULL is fine; leaves NULL */
guint rtsp_readers(const struct rtsp *rtsp); /* returns the number of client sessions; 0 for NULL */

#endif
