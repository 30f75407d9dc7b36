/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes H.264 into YUV planes with libavcodec. The command-line programs load this module only when they need it
   (h264_decoder_lazy.c). Call from one thread at a time per decoder. */
#ifndef LINK_H264_DECODER_H
#define LINK_H264_DECODER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define H264_DECODER_WHY_BYTES 320

struct h264_decoder;
struct h264_decoded { /* a picture in YUV 4:2:0 at full range; the decoder owns the planes, which are valid until its next call */
    const uint8_t *at[3];
    int pitches[3];
    int width_px, height_px;
};

struct h264_decoder_functions {
    /* Creates a decoder. Returns NULL, with the reason in `why`, if this libavcodec has no H.264 decoder. */
    struct h264_decoder *(*create)(char why[H264_DECODER_WHY_BYTES]);
    void (*destroy)(struct h264_decoder **decoder); /* &NULL is fine; leaves NULL */
    /* Decodes one access unit (encoded picture). Returns false if it is not valid. */
    bool (*decode)(struct h264_decoder *decoder, const uint8_t *bytes, size_t count, struct h264_decoded *out);
};

/* Returns the module's functions, valid for the life of the process; NULL, with the reason in `why`, if the module cannot be loaded. */
const struct h264_decoder_functions *h264_decoder_functions(char why[H264_DECODER_WHY_BYTES]);

#endif
