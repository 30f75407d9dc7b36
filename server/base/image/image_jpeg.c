/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes JPEG with libjpeg. Its errors end the call with longjmp. */
#include <setjmp.h>
#include <stdio.h>

#include <jpeglib.h>

#include <jerror.h>

#include "base/image/image_impl.h"

struct jpeg_reader {
    struct jpeg_decompress_struct codec;
    struct jpeg_error_mgr errors;
    jmp_buf failed;
    char why[JMSG_LENGTH_MAX];
};

static void fail(j_common_ptr codec)
{
    struct jpeg_reader *reader = codec->client_data;
    codec->err->format_message(codec, reader->why);
    longjmp(reader->failed, 1);
}

/* Turns libjpeg's warning of a truncated file into a failure: libjpeg would fill the missing rows with grey. Other warnings are ignored. */
static void warn(j_common_ptr codec, int level)
{
    if (level < 0 && codec->err->msg_code == JWRN_JPEG_EOF)
        fail(codec);
}

static bool read_all(struct jpeg_reader *reader, struct image *image, size_t size, bool *cmyk, char *why)
{
    struct jpeg_decompress_struct *codec = &reader->codec;
    jpeg_read_header(codec, TRUE);
    *cmyk = codec->jpeg_color_space == JCS_CMYK || codec->jpeg_color_space == JCS_YCCK;
    if (*cmyk || !image_allocate(image, codec->image_width, codec->image_height, codec->num_components, size, why))
        return false;
    codec->out_color_space = JCS_EXT_RGBA; /* libjpeg fills the alpha channel with 255 */
    jpeg_start_decompress(codec);
    while (codec->output_scanline < codec->output_height)
        jpeg_read_scanlines(codec, &(JSAMPROW){ image->rgba + 4 * (size_t)codec->output_scanline * image->width_px }, 1);
    return jpeg_finish_decompress(codec);
}

bool image_read_jpeg(struct image *image, const void *bytes, size_t size, bool *cmyk, char why[IMAGE_WHY_BYTES])
{
    struct jpeg_reader reader = { .codec = { .err = jpeg_std_error(&reader.errors), .client_data = &reader } };
    volatile bool good = false;
    reader.errors.error_exit = fail;
    reader.errors.emit_message = warn;
    if (setjmp(reader.failed))
        snprintf(why, IMAGE_WHY_BYTES, "jpeg: %.*s", IMAGE_WHY_BYTES - 7, reader.why);
    else {
        jpeg_create_decompress(&reader.codec);
        jpeg_mem_src(&reader.codec, bytes, size);
        good = read_all(&reader, image, size, cmyk, why);
    }
    jpeg_destroy_decompress(&reader.codec);
    return good;
}
