/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Allocates the pixels of an image, if its width, height and number of pixels are within limits. */
#include <stdio.h>

#include "base/image/image_impl.h"
#include "base/mem.h"

bool image_allocate(struct image *image, uint32_t width_px, uint32_t height_px, int channels, size_t bytes, char why[IMAGE_WHY_BYTES])
{
    uint64_t pixels = (uint64_t)width_px * height_px;
    if (width_px < 1 || height_px < 1 || width_px > IMAGE_MAX_SIDE_PX || height_px > IMAGE_MAX_SIDE_PX || pixels > IMAGE_MAX_PIXELS)
        snprintf(why, IMAGE_WHY_BYTES, "the picture has %u x %u pixels; supported are 1 to %u on each side, and %u in total", width_px,
                 height_px, IMAGE_MAX_SIDE_PX, IMAGE_MAX_PIXELS);
    else if (pixels * (uint64_t)channels > IMAGE_FREE_VALUES + (uint64_t)IMAGE_VALUES_PER_BYTE * bytes)
        snprintf(why, IMAGE_WHY_BYTES, "the picture file is truncated or damaged: %zu bytes cannot hold %u x %u pixels", bytes, width_px,
                 height_px);
    else if (!(image->rgba = mem_try_array((size_t)pixels, 4)))
        snprintf(why, IMAGE_WHY_BYTES, "out of memory");
    image->width_px = width_px;
    image->height_px = height_px;
    return image->rgba != NULL;
}
