/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gets planar pictures into the form that an encoder of libavcodec takes: as they are, with interleaved chroma, or on its device. */
#ifndef ENCODE_H264_UPLOAD_H
#define ENCODE_H264_UPLOAD_H
#include <libavcodec/avcodec.h>

struct h264_upload;
/* Sets the context's pixel format, and its device if it needs one; before it is opened. 0, or an AVERROR. *out: h264_upload_destroy. */
int h264_upload_create(AVCodecContext *context, struct h264_upload **out);
void h264_upload_destroy(struct h264_upload **upload); /* &NULL is fine; leaves NULL */
/* picture: YUV 4:2:0, with its time and type. 0, or an AVERROR. */
int h264_upload_send(struct h264_upload *upload, AVCodecContext *context, AVFrame *picture);

#endif
