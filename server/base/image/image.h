/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes image files into pixels. Only the implementation includes OpenImageIO. Call from any thread. */
#ifndef BASE_IMAGE_IMAGE_H
#define BASE_IMAGE_IMAGE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define IMAGE_WHY_BYTES 200

struct image {
    uint8_t *rgba; /* pixels in rows from the top; colours in sRGB or in the file's space; alpha not premultiplied; free with mem_free() */
    uint32_t width_px, height_px;
};
struct image_float {
    float *rgba; /* pixels in rows from the top; colours in linear light, converted if the file has sRGB; free with mem_free() */
    uint32_t width_px, height_px;
};

/* Decodes a PNG, JPEG or WebP file in memory, from an untrusted source. Scales the image down until no side exceeds max_px.
   Returns false on failure, with the reason in `why`. */
bool image_decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char why[IMAGE_WHY_BYTES]);
/* Like image_decode(), but for any format that OpenImageIO reads, and only for trusted files: those named in the plant file or
   on the command line. */
bool image_load(struct image *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES]);
bool image_load_float(struct image_float *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES]);

#ifdef __cplusplus
}
#endif
#endif
