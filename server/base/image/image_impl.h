/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the decoders and by image.c, which chooses the decoder of an image. Call from any thread. */
#ifndef BASE_IMAGE_IMAGE_IMPL_H
#define BASE_IMAGE_IMAGE_IMPL_H
#include "base/image/image.h"

#ifdef __cplusplus
extern "C" {
#endif

#define IMAGE_MAX_SIDE_PX (1u << 15)
#define IMAGE_MAX_PIXELS (1u << 26) /* largest number of pixels of an image: 8192 x 8192, because larger textures are never drawn */
/* Limits against decompression bombs. VALUES_PER_BYTE: maximum number of decoded values per byte of file; zlib compresses at
   most 1000:1, JPEG less. FREE_VALUES: number of values that a file of any size may decode to. */
#define IMAGE_VALUES_PER_BYTE 2000u
#define IMAGE_FREE_VALUES (1u << 20)

/* Allocates the pixels of an image, after checking that `bytes` bytes of file can contain that many pixels of `channels`
   channels. Returns false with the reason in `why`. */
bool image_allocate(struct image *image, uint32_t width_px, uint32_t height_px, int channels, size_t bytes, char why[IMAGE_WHY_BYTES]);
/* The functions decode a PNG file with libpng, and a JPEG file with libjpeg. On failure, the caller frees the pixels. */
bool image_read_png(struct image *image, const void *bytes, size_t size, char why[IMAGE_WHY_BYTES]);
bool image_read_jpeg(struct image *image, const void *bytes, size_t size, bool *cmyk, char why[IMAGE_WHY_BYTES]);

/* Functions of plantcast-images.so for formats other than PNG and JPEG; they work like image_decode(), image_load() and
   image_load_float(). */
bool images_decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char why[IMAGE_WHY_BYTES]);
bool images_load(struct image *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES]);
bool images_load_float(struct image_float *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES]);

#ifdef __cplusplus
}
#endif
#endif
