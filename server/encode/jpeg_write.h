/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes baseline JPEG by libjpeg, with its own chroma quantization tables: the colours of a field differ by chroma, and the standard
   tables, made for photographs, lose most of it within a few pixels. Measured at quality 80 on parts a few pixels wide: 3.9 % of
   the range misread, 4.7 % by deuteranopes; with these 2.3 and 2.7 %, for 8 % more bytes of the demo plant at 1920x1080 (up to 30 % of one
   vessel close to). So from JPEG_READ_QUALITY up, chroma loses at most a fifth of what luma may if it is subsampled, and half if it
   is not. Private to jpeg.c. Thread: one at a time per writer. */
#ifndef ENCODE_JPEG_WRITE_H
#define ENCODE_JPEG_WRITE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "encode/planes.h"

enum { JPEG_READ_QUALITY = 75 }; /* below, all tables are the standard ones: the picture is a draft */

struct jpeg_writer;
struct jpeg_writer *jpeg_writer_create(void); /* NULL: out of memory */
void jpeg_writer_destroy(struct jpeg_writer **writer); /* &NULL is fine; leaves NULL */
/* Both functions write to `to`, which has room for `capacity` bytes, and return how many were written; 0 on failure, and jpeg_writer_why()
   says why. */
/* Encodes pixels with full chroma. */
size_t jpeg_write_whole(struct jpeg_writer *writer, const uint8_t *bgrx, int stride_bytes, int width_px, int height_px, int quality,
                        unsigned char *to, size_t capacity);
/* Encodes planes with subsampled chroma. Their rows are padded to JPEG_PAD_PX (chroma: half of that) with the pixels of the edge. */
enum { JPEG_PAD_PX = 16 };
size_t jpeg_write_halved(struct jpeg_writer *writer, const struct yuv_planes *planes, int quality, unsigned char *to, size_t capacity);
const char *jpeg_writer_why(const struct jpeg_writer *writer);

#endif
