/* SPDX-License-Identifier: GPL-3.0-or-later */
/* H.264 with libavcodec: planar frames in, access units (encoded frames) out. No other encoding code uses libavcodec, so that
   h264_lazy.c can load this module and libavcodec together on first use. Call from one thread at a time per codec. */
#ifndef ENCODE_H264_CODEC_H
#define ENCODE_H264_CODEC_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define H264_WHY_BYTES 320

struct h264_codec;
struct h264_planes { /* planes of a full-range YUV 4:2:0 frame, filled by the caller; width and height are even */
    uint8_t *at[3];
    int pitches[3];
    int width_px, height_px;
};
struct h264_access_unit {
    const uint8_t *bytes; /* bytes of the access unit (encoded frame); owned by the codec, valid until its next call */
    size_t count;
    bool key;
};

struct h264_codec_functions {
    /* Creates a codec. library: name of the libavcodec encoder. Returns NULL, with the reason in `why`, if libavcodec has no
       H.264 encoder with that name. */
    struct h264_codec *(*create)(const char *library, char why[H264_WHY_BYTES]);
    void (*destroy)(struct h264_codec **codec); /* frees the codec and sets *codec to NULL; accepts a pointer to NULL */
    /* Begins a frame of this size: *planes receives the planes that the caller must fill. Changing the size restarts the
       stream. Returns 0; negative: failed, with the reason in `why`. */
    int (*begin)(struct h264_codec *codec, int width_px, int height_px, struct h264_planes *planes, char why[H264_WHY_BYTES]);
    /* Encodes the frame begun. quality: 1..100. key: make a key frame. Returns 0; negative: failed, with the reason in `why`. */
    int (*encode)(struct h264_codec *codec, int quality, bool key, struct h264_access_unit *out, char why[H264_WHY_BYTES]);
};

/* Returns the module's functions, valid forever. NULL, with the reason in `why`, if the module cannot be loaded. */
const struct h264_codec_functions *h264_codec_functions(char why[H264_WHY_BYTES]);

#endif
