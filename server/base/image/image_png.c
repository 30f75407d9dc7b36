/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes PNG with libpng. Its errors end the call with longjmp. Colour profiles and gamma are ignored, as glTF requires. */
#include <png.h>
#include <stdio.h>
#include <string.h>

#include "base/image/image_impl.h"

struct png_reader {
    const unsigned char *at;
    size_t left;
    char *why;
};

static void fail(png_structp png, png_const_charp message)
{
    struct png_reader *reader = png_get_error_ptr(png);
    snprintf(reader->why, IMAGE_WHY_BYTES, "png: %s", message);
    png_longjmp(png, 1);
}

static void ignore(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void read_bytes(png_structp png, png_bytep to, size_t count)
{
    struct png_reader *reader = png_get_io_ptr(png);
    if (count > reader->left)
        png_error(png, "truncated");
    memcpy(to, reader->at, count);
    reader->at += count;
    reader->left -= count;
}

/* Reads the header and the pixels (RGBA, 8 bits each). Returns false if the size is refused; libpng's errors do not return. */
static bool read_all(png_structp png, png_infop info, struct image *image, size_t size, char *why)
{
    png_read_info(png, info);
    if (!image_allocate(image, png_get_image_width(png, info), png_get_image_height(png, info), png_get_channels(png, info), size, why))
        return false;
    png_set_expand(png);
    png_set_scale_16(png);
    png_set_gray_to_rgb(png);
    png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
    int passes = png_set_interlace_handling(png);
    png_read_update_info(png, info);
    if (png_get_rowbytes(png, info) != 4 * (size_t)image->width_px)
        png_error(png, "the PNG picture has another number of bytes in a row than its header states");
    for (int pass = 0; pass < passes; pass++)
        for (uint32_t y = 0; y < image->height_px; y++)
            png_read_row(png, image->rgba + 4 * (size_t)y * image->width_px, NULL);
    png_read_end(png, NULL);
    return true;
}

bool image_read_png(struct image *image, const void *bytes, size_t size, char why[IMAGE_WHY_BYTES])
{
    struct png_reader reader = { .at = bytes, .left = size, .why = why };
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, fail, ignore);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    volatile bool good = false;
    if (!info)
        snprintf(why, IMAGE_WHY_BYTES, "out of memory");
    else if (!setjmp(png_jmpbuf(png))) {
        png_set_read_fn(png, &reader, read_bytes);
        good = read_all(png, info, image, size, why);
    }
    png_destroy_read_struct(&png, &info, NULL);
    return good;
}
