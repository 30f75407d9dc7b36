/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes PNG files with libpng. */
#include "provenance/png_pixels.h"

#include <png.h>
#include <stdio.h>

#include "base/mem.h"

uint8_t *png_pixels(const uint8_t *png, size_t count, int64_t width_px, int64_t height_px, char why[PNG_WHY_BYTES])
{
    png_image image = { .version = PNG_IMAGE_VERSION };
    uint8_t *pixels = NULL;
    if (!png_image_begin_read_from_memory(&image, png, count)) {
        snprintf(why, PNG_WHY_BYTES, "the picture cannot be read: %.80s", image.message);
        return NULL;
    }
    image.format = PNG_FORMAT_RGB;
    if (image.width != width_px || image.height != height_px) {
        snprintf(why, PNG_WHY_BYTES, "the picture has %ux%u pixels, but its signed statement says %lldx%lld", (unsigned)image.width,
                 (unsigned)image.height, (long long)width_px, (long long)height_px);
    } else if (!(pixels = mem_try_array(PNG_IMAGE_SIZE(image), 1))) {
        snprintf(why, PNG_WHY_BYTES, "the picture cannot be read: out of memory");
    } else if (!png_image_finish_read(&image, NULL, pixels, 0, NULL)) {
        snprintf(why, PNG_WHY_BYTES, "the picture cannot be read: %.80s", image.message);
        mem_free(pixels);
        pixels = NULL;
    }
    png_image_free(&image);
    return pixels;
}
