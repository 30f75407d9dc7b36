/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes baseline JPEG with libjpeg and its own quantization tables for chroma. A field's colours differ in chroma, and the
   standard tables, made for photographs, lose most of the chroma within a few pixels. At quality 80, on areas a few pixels
   wide, values are misread by 3.9 % of the range with the standard tables. With these tables it is 2.3 %, for 8 % more bytes.
   From JPEG_READ_QUALITY up, the chroma tables allow at most a fifth of luma's error if chroma is subsampled, and half of
   luma's error if not. Private to jpeg.c. Call from one thread at a time per writer. */
#ifndef ENCODE_JPEG_WRITE_H
#define ENCODE_JPEG_WRITE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "encode/planes.h"

enum { JPEG_READ_QUALITY = 75 }; /* JPEG quality below which the standard quantization tables are used */

struct jpeg_writer;
struct jpeg_writer *jpeg_writer_create(void);          /* creates a JPEG writer; returns NULL when out of memory */
void jpeg_writer_destroy(struct jpeg_writer **writer); /* frees the writer and sets *writer to NULL; accepts a pointer to NULL */
/* The jpeg_write functions write to `to`, which has room for `capacity` bytes. They return the number of bytes written; 0 on
   failure, with the reason in jpeg_writer_why(). */
struct jpeg_pixels {
    const uint8_t *bgrx;
    int stride_bytes, width_px, height_px;
};
/* Encodes pixels with full chroma. */
size_t jpeg_write_whole(struct jpeg_writer *writer, const struct jpeg_pixels *pixels, int quality, unsigned char *to, size_t capacity);
/* Encodes planes with subsampled chroma. Luma rows must be padded to a multiple of JPEG_PAD_PX pixels, and chroma rows to half
   that, with copies of the edge pixel. */
enum { JPEG_PAD_PX = 16 };
size_t jpeg_write_halved(struct jpeg_writer *writer, const struct yuv_planes *planes, int quality, unsigned char *to, size_t capacity);
const char *jpeg_writer_why(const struct jpeg_writer *writer);

#endif
