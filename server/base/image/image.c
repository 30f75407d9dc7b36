/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes images: PNG and JPEG here, all other formats in plantcast-images.so, with OpenImageIO. That module depends on some
   170 packages and is packaged separately, because most plants do not need it. */
#include "base/image/image.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/image/image_impl.h"
#include "base/image/srgb.h"
#include "base/mem.h"
#include "base/system/module.h"
#include "base/text/text.h"

#define MAX_FILE_BYTES ((size_t)1 << 30)

enum image_format { PNG, JPEG, WEBP, OTHER };

static struct module images = MODULE("plantcast-images.so"); /* implemented by image_shim.cc */

/* Returns the format according to the first bytes, regardless of the file name. */
static enum image_format format_of(const unsigned char *bytes, size_t size)
{
    if (size >= 8 && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0)
        return PNG;
    if (size >= 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0)
        return JPEG;
    return size >= 12 && memcmp(bytes, "RIFF", 4) == 0 && memcmp(bytes + 8, "WEBP", 4) == 0 ? WEBP : OTHER;
}

/* Scales down one row or column of RGBA pixels. Each new pixel is the mean of the old pixels that it covers. steps: distances
   in pixels between neighbours. */
static void shrink_line(const uint8_t *from, uint32_t count, size_t step, uint8_t *to, uint32_t to_count, size_t to_step)
{
    double ratio = (double)count / to_count;
    for (uint32_t i = 0; i < to_count; i++) {
        double begin = i * ratio, end = fmin((i + 1) * ratio, count), sum[4] = { 0 };
        for (uint32_t at = (uint32_t)begin; at < end; at++) {
            double part = fmin(at + 1, end) - fmax(at, begin);
            for (int c = 0; c < 4; c++)
                sum[c] += part * from[4 * at * step + (size_t)c];
        }
        for (int c = 0; c < 4; c++)
            to[4 * i * to_step + (size_t)c] = (uint8_t)lround(sum[c] / (end - begin));
    }
}

/* Scales an image down until no side exceeds max_px. */
static bool shrink(struct image *image, uint32_t max_px, char *why)
{
    uint32_t width = image->width_px, height = image->height_px, longest = width > height ? width : height;
    if (longest <= max_px)
        return true;
    uint32_t to_width = (uint32_t)((uint64_t)width * max_px / longest), to_height = (uint32_t)((uint64_t)height * max_px / longest);
    to_width = to_width ? to_width : 1;
    to_height = to_height ? to_height : 1;
    uint8_t *narrow = mem_try_array((size_t)to_width * height, 4), *small = mem_try_array((size_t)to_width * to_height, 4);
    for (uint32_t y = 0; narrow && small && y < height; y++)
        shrink_line(image->rgba + 4 * (size_t)y * width, width, 1, narrow + 4 * (size_t)y * to_width, to_width, 1);
    for (uint32_t x = 0; narrow && small && x < to_width; x++)
        shrink_line(narrow + 4 * (size_t)x, height, to_width, small + 4 * (size_t)x, to_height, to_width);
    bool good = narrow && small;
    if (good) {
        mem_free(image->rgba);
        *image = (struct image){ .rgba = small, .width_px = to_width, .height_px = to_height };
    } else {
        mem_free(small);
        snprintf(why, IMAGE_WHY_BYTES, "out of memory");
    }
    mem_free(narrow);
    return good;
}

/* Decodes an image in plantcast-images.so. If the module cannot be loaded, `why` begins with the image's format. */
static bool decode_by_module(struct image *image, const void *bytes, size_t size, uint32_t max_px, const char *format, char *why)
{
    bool (*decode)(struct image *, const void *, size_t, uint32_t, char[IMAGE_WHY_BYTES]);
    char reason[IMAGE_WHY_BYTES - 18];
    *image = (struct image){ 0 };
    if (module_find(&images, "images_decode", &decode, reason, sizeof(reason)))
        return decode(image, bytes, size, max_px, why);
    snprintf(why, IMAGE_WHY_BYTES, "%.16s: %s", format, reason);
    return false;
}

bool image_decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    enum image_format format = format_of(bytes, size);
    bool cmyk = false;
    *image = (struct image){ 0 };
    if (format == OTHER) {
        snprintf(why, IMAGE_WHY_BYTES, "the picture of %zu bytes is not in the format PNG, JPEG or WebP", size);
        return false;
    }
    if (format == WEBP)
        return decode_by_module(image, bytes, size, max_px, "webp", why);
    bool good = format == PNG ? image_read_png(image, bytes, size, why) : image_read_jpeg(image, bytes, size, &cmyk, why);
    if (good && shrink(image, max_px, why))
        return true;
    mem_free(image->rgba);
    *image = (struct image){ 0 };
    return cmyk && decode_by_module(image, bytes, size, max_px, "jpeg in CMYK", why);
}

/* Reads a PNG or JPEG file. Returns false with an empty `why` for other formats, which only plantcast-images.so can read. */
static bool load_here(struct image *image, const char *path, uint32_t max_px, char *why)
{
    unsigned char head[12];
    FILE *file = fopen(path, "rb");
    size_t size = file ? fread(head, 1, sizeof(head), file) : 0;
    *image = (struct image){ 0 };
    why[0] = 0;
    if (!file)
        snprintf(why, IMAGE_WHY_BYTES, "%s", strerror(errno));
    else
        fclose(file);
    if (format_of(head, size) > JPEG)
        return false;
    char *bytes = text_read_file(path, MAX_FILE_BYTES, &size);
    bool good = bytes && image_decode(image, bytes, size, max_px, why);
    if (!bytes)
        snprintf(why, IMAGE_WHY_BYTES, "%s", strerror(errno));
    mem_free(bytes);
    return good;
}

/* Finds the module's function that loads files in formats other than PNG and JPEG. */
static bool find_loader(const char *name, void *function, char *why)
{
    char reason[IMAGE_WHY_BYTES - 24];
    if (module_find(&images, name, function, reason, sizeof(reason)))
        return true;
    snprintf(why, IMAGE_WHY_BYTES, "not a PNG or JPEG file: %s", reason);
    return false;
}

bool image_load(struct image *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    bool (*load)(struct image *, const char *, uint32_t, char[IMAGE_WHY_BYTES]);
    if (load_here(image, path, max_px, why))
        return true;
    return !why[0] && find_loader("images_load", &load, why) && load(image, path, max_px, why);
}

bool image_load_float(struct image_float *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    bool (*load)(struct image_float *, const char *, uint32_t, char[IMAGE_WHY_BYTES]);
    struct image colors;
    *image = (struct image_float){ 0 };
    if (!load_here(&colors, path, max_px, why))
        return !why[0] && find_loader("images_load_float", &load, why) && load(image, path, max_px, why);
    size_t values = 4 * (size_t)colors.width_px * colors.height_px;
    *image = (struct image_float){ mem_try_array(values, sizeof(float)), colors.width_px, colors.height_px };
    for (size_t i = 0; image->rgba && i < values; i++)
        image->rgba[i] = i % 4 == 3 ? (float)colors.rgba[i] / 255 : linear_from_srgbf((float)colors.rgba[i] / 255);
    mem_free(colors.rgba);
    if (!image->rgba)
        snprintf(why, IMAGE_WHY_BYTES, "out of memory");
    return image->rgba != NULL;
}
