/* SPDX-License-Identifier: GPL-3.0-or-later */
/* H.264 by libavcodec: planar pictures in, access units out. All that programs which encode have of libavcodec, and so what is loaded when
   it is needed (h264_lazy.c). Thread: one at a time per codec. */
#ifndef ENCODE_H264_CODEC_H
#define ENCODE_H264_CODEC_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define H264_WHY_BYTES 320

struct h264_codec;
struct h264_planes { /* YUV 4:2:0 at full range, to be filled; both sides are even */
    uint8_t *at[3];
    int pitches[3];
    int width_px, height_px;
};
struct h264_access_unit {
    const uint8_t *bytes; /* the codec's own, until its next call */
    size_t count;
    bool key;
};

struct h264_codec_functions {
    /* library: the encoder of libavcodec. Returns NULL, with the reason, if there is none of that name for H.264. */
    struct h264_codec *(*create)(const char *library, char why[H264_WHY_BYTES]);
    void (*destroy)(struct h264_codec **codec); /* &NULL is fine; leaves NULL */
    /* Begins a picture of that size, whose planes the caller fills; where the one before had another size, all begins anew. Returns 0; < 0:
       the codec cannot, and says why. */
    int (*begin)(struct h264_codec *codec, int width_px, int height_px, struct h264_planes *planes, char why[H264_WHY_BYTES]);
    /* Encodes it. quality: 1..100. key: make a key frame. Likewise. */
    int (*encode)(struct h264_codec *codec, int quality, bool key, struct h264_access_unit *out, char why[H264_WHY_BYTES]);
};

/* Returns the functions, for good; NULL, with the reason, where the module that has them cannot be loaded. */
const struct h264_codec_functions *h264_codec_functions(char why[H264_WHY_BYTES]);

#endif
