/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures as luma and halved chroma (BT.601, full range), as JPEG and H.264 take them. Where a colour ends, it keeps to its rim: the plain
   mean of four pixels mixes a field's colour with the grey beside it, which reads as another value. So pixels weigh as much as they are
   coloured. Thread: any; bands of one picture at once. */
#ifndef ENCODE_PLANES_H
#define ENCODE_PLANES_H
#include <stddef.h>
#include <stdint.h>

struct planes {
    const uint8_t *bgrx;
    int stride_bytes, width_px, height_px;
    uint8_t *plane[3]; /* the two of chroma have half the width and height, rounded up */
    int pitch[3];
};

enum { PLANES_BAND_PX = 16 }; /* rows of one band */
size_t planes_bands(int height_px);
void planes_convert(const struct planes *planes, size_t begin, size_t end); /* bands */

#endif
