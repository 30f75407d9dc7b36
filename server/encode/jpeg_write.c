/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes JPEG with libjpeg. Its errors end the call with longjmp. */
#include "encode/jpeg_write.h"

#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include <jpeglib.h>

#include "base/mem.h"

enum { ROWS = JPEG_PAD_PX };

struct jpeg_writer {
    struct jpeg_compress_struct codec;
    struct jpeg_error_mgr errors;
    struct jpeg_destination_mgr to;
    jmp_buf failed;
    char why[JMSG_LENGTH_MAX];
};

static void fail(j_common_ptr codec)
{
    struct jpeg_writer *writer = codec->client_data;
    codec->err->format_message(codec, writer->why);
    longjmp(writer->failed, 1);
}

/* called by libjpeg before it writes; does nothing, because set_room() has already set the output buffer */
static void start(j_compress_ptr codec)
{
    (void)codec;
}

static boolean need_room(j_compress_ptr codec)
{
    struct jpeg_writer *writer = codec->client_data;
    snprintf(writer->why, sizeof(writer->why), "the compressed picture does not fit into its buffer");
    longjmp(writer->failed, 1);
}

static void say_nothing(j_common_ptr codec)
{
    (void)codec;
}

struct jpeg_writer *jpeg_writer_create(void)
{
    struct jpeg_writer *writer = mem_new(sizeof(*writer));
    writer->codec.err = jpeg_std_error(&writer->errors);
    writer->codec.client_data = writer;
    writer->errors.error_exit = fail;
    writer->errors.output_message = say_nothing;
    if (setjmp(writer->failed)) {
        mem_free(writer);
        return NULL;
    }
    /* initialises the compressor; jpeg_create_compress() keeps the members err and client_data, which are set already */
    jpeg_create_compress(&writer->codec);
    writer->to = (struct jpeg_destination_mgr){ .init_destination = start, .empty_output_buffer = need_room, .term_destination = start };
    writer->codec.dest = &writer->to;
    return writer;
}

void jpeg_writer_destroy(struct jpeg_writer **writer)
{
    if (!*writer)
        return;
    jpeg_destroy_compress(&(*writer)->codec);
    mem_free(*writer);
    *writer = NULL;
}

const char *jpeg_writer_why(const struct jpeg_writer *writer)
{
    return writer->why;
}

static void set_tables(struct jpeg_compress_struct *codec, int quality, bool halved)
{
    JQUANT_TBL luma;
    jpeg_set_quality(codec, quality, TRUE);
    if (quality < JPEG_READ_QUALITY)
        return;
    luma = *codec->quant_tbl_ptrs[0];
    jpeg_set_quality(codec, 100 - (100 - quality) / (halved ? 5 : 2), TRUE);
    *codec->quant_tbl_ptrs[0] = luma;
}

static void begin(struct jpeg_compress_struct *codec, int width_px, int height_px, J_COLOR_SPACE from, int quality, bool halved)
{
    codec->image_width = (JDIMENSION)width_px;
    codec->image_height = (JDIMENSION)height_px;
    codec->in_color_space = from;
    codec->input_components = from == JCS_YCbCr ? 3 : 4;
    jpeg_set_defaults(codec);
    set_tables(codec, quality, halved);
    codec->raw_data_in = halved;
    codec->comp_info[0].h_samp_factor = codec->comp_info[0].v_samp_factor = halved ? 2 : 1;
    jpeg_start_compress(codec, TRUE);
}

static void write_halved(struct jpeg_compress_struct *codec, const struct yuv_planes *planes, int quality)
{
    JSAMPROW rows[3][ROWS];
    JSAMPARRAY all[3] = { rows[0], rows[1], rows[2] };
    begin(codec, planes->width_px, planes->height_px, JCS_YCbCr, quality, true);
    while (codec->next_scanline < codec->image_height) {
        for (int c = 0; c < 3; c++)
            for (int j = 0; j < (c ? ROWS / 2 : ROWS); j++) { /* rows below the picture's lower edge are copies of its last row */
                int height = c ? (planes->height_px + 1) / 2 : planes->height_px;
                int y = (int)codec->next_scanline / (c ? 2 : 1) + j;
                rows[c][j] = planes->plane[c] + (ptrdiff_t)(y < height ? y : height - 1) * planes->pitch[c];
            }
        jpeg_write_raw_data(codec, all, ROWS);
    }
}

static void write_whole(struct jpeg_compress_struct *codec, const struct jpeg_pixels *pixels, int quality)
{
    begin(codec, pixels->width_px, pixels->height_px, JCS_EXT_BGRX, quality, false);
    while (codec->next_scanline < codec->image_height) {
        JSAMPROW row = (JSAMPROW)(uintptr_t)(pixels->bgrx + (ptrdiff_t)codec->next_scanline * pixels->stride_bytes);
        jpeg_write_scanlines(codec, &row, 1);
    }
}

static void set_room(struct jpeg_writer *writer, unsigned char *to, size_t capacity)
{
    writer->to.next_output_byte = to;
    writer->to.free_in_buffer = capacity;
}

size_t jpeg_write_whole(struct jpeg_writer *writer, const struct jpeg_pixels *pixels, int quality, unsigned char *to, size_t capacity)
{
    set_room(writer, to, capacity);
    if (setjmp(writer->failed)) {
        jpeg_abort_compress(&writer->codec);
        return 0;
    }
    write_whole(&writer->codec, pixels, quality);
    jpeg_finish_compress(&writer->codec);
    return capacity - writer->to.free_in_buffer;
}

size_t jpeg_write_halved(struct jpeg_writer *writer, const struct yuv_planes *planes, int quality, unsigned char *to, size_t capacity)
{
    set_room(writer, to, capacity);
    if (setjmp(writer->failed)) {
        jpeg_abort_compress(&writer->codec);
        return 0;
    }
    write_halved(&writer->codec, planes, quality);
    jpeg_finish_compress(&writer->codec);
    return capacity - writer->to.free_in_buffer;
}
