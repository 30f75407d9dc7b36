/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts planar frames to a pixel format that a libavcodec encoder accepts: planar, with interleaved chroma, or in its
   device's memory. Call from one thread only. */
#ifndef ENCODE_H264_UPLOAD_H
#define ENCODE_H264_UPLOAD_H
#include <libavcodec/avcodec.h>

struct h264_upload;
/* Sets the pixel format of a context that is not open yet, and its device if needed. Returns 0 or an AVERROR. Free *out with
   h264_upload_destroy(). */
int h264_upload_create(AVCodecContext *context, struct h264_upload **out);
void h264_upload_destroy(struct h264_upload **upload); /* frees *upload and sets it to NULL; accepts a pointer to NULL */
/* Converts a frame (YUV 4:2:0, with its timestamp and picture type) and sends it to the encoder. Returns 0 or an AVERROR. */
int h264_upload_send(struct h264_upload *upload, AVCodecContext *context, AVFrame *picture);

#endif
