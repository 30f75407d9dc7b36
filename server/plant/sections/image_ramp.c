/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a colour map of 256 colours from an image of a colour bar: samples the colours along the middle of the image's longer
   side. */
#include "plant/sections/image_ramp.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"

enum { MAX_PX = 4096 };

/* Returns a pixel of the image's middle row (lying true), counted from the left, or of its middle column (lying false), counted
   from the bottom. place: index of the pixel, from 0. */
static const uint8_t *pixel_at(const struct image *image, bool lying, uint32_t place)
{
    uint32_t x = lying ? place : image->width_px / 2, y = lying ? image->height_px / 2 : image->height_px - 1 - place;
    return image->rgba + 4 * ((size_t)y * image->width_px + x);
}

bool image_ramp(const char *path, uint8_t rgb[256][3], char why[IMAGE_WHY_BYTES])
{
    struct image image;
    struct stat st;
    if (stat(path, &st) != 0 || !S_ISREG(st.st_mode)) {
        snprintf(why, IMAGE_WHY_BYTES, "%s", stat(path, &st) != 0 ? strerror(errno) : "not a file");
        return false;
    }
    if (!image_load(&image, path, MAX_PX, why))
        return false;
    bool lying = image.width_px >= image.height_px;
    uint32_t length = lying ? image.width_px : image.height_px;
    for (int i = 0; i < 256; i++) {
        double at = fmin(fmax((i + 0.5) / 256 * length - 0.5, 0), length - 1), part = at - floor(at);
        const uint8_t *a = pixel_at(&image, lying, (uint32_t)at);
        const uint8_t *b = pixel_at(&image, lying, (uint32_t)fmin(floor(at) + 1, length - 1));
        for (int c = 0; c < 3; c++)
            rgb[i][c] = (uint8_t)lround(a[c] + part * (b[c] - a[c]));
    }
    mem_free(image.rgba);
    if (length >= 2)
        return true;
    snprintf(why, IMAGE_WHY_BYTES, "the picture has only one pixel, but a colour map needs at least two");
    return false;
}
