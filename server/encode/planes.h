/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts frames to luma and subsampled chroma (4:2:0, BT.601, full range) for JPEG and H.264. The mean chroma of four pixels
   is weighted by saturation. A plain mean would mix a field's colour at its edge with the adjacent grey, and the result would
   read as another value. Call from any thread; horizontal bands of one frame may be converted in parallel. */
#ifndef ENCODE_PLANES_H
#define ENCODE_PLANES_H
#include <stddef.h>
#include <stdint.h>

struct yuv_planes {
    const uint8_t *bgrx;
    int stride_bytes, width_px, height_px;
    uint8_t *plane[3]; /* luma plane, then two chroma planes of half its width and height, rounded up */
    int pitch[3];
};

/* height in pixel rows of a band, that is, of the part of a frame that one worker converts */
enum { PLANES_BAND_PX = 16 };
size_t planes_bands(int height_px);                                             /* returns the number of bands */
void planes_convert(const struct yuv_planes *planes, size_t begin, size_t end); /* converts the bands [begin, end) */

#endif
