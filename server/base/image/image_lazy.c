/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads images through a module that is loaded on first use: loading OpenImageIO with its 260 libraries takes a fifth of a second, more
   than the whole run of many a program. */
#include "base/image/image.h"
#include "base/system/module.h"

static struct module images = MODULE("plantcast-images.so"); /* implemented by server/base/image/image_shim.cc */

bool image_decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    bool (*decode)(struct image *, const void *, size_t, uint32_t, char[IMAGE_WHY_BYTES]);
    *image = (struct image){ 0 };
    return module_find(&images, "image_decode", &decode, why, IMAGE_WHY_BYTES) && decode(image, bytes, size, max_px, why);
}

bool image_load(struct image *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    bool (*read)(struct image *, const char *, uint32_t, char[IMAGE_WHY_BYTES]);
    *image = (struct image){ 0 };
    return module_find(&images, "image_load", &read, why, IMAGE_WHY_BYTES) && read(image, path, max_px, why);
}

bool image_load_float(struct image_float *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    bool (*read)(struct image_float *, const char *, uint32_t, char[IMAGE_WHY_BYTES]);
    *image = (struct image_float){ 0 };
    return module_find(&images, "image_load_float", &read, why, IMAGE_WHY_BYTES) && read(image, path, max_px, why);
}
