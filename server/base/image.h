/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Images to plain pixels. OpenImageIO stays behind this header. Thread: any. */
#ifndef BASE_IMAGE_H
#define BASE_IMAGE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define IMAGE_WHY_BYTES 200

struct image {
    uint8_t *rgba; /* rows from the top, sRGB or as the file has them; alpha not multiplied in; free with mem_free */
    uint32_t width_px, height_px;
};
struct image_float {
    float *rgba; /* rows from the top, linear light: of files that hold sRGB, it is made so */
    uint32_t width_px, height_px;
};

/* PNG, JPEG or WebP in memory, from anywhere. Larger sides than max_px are scaled down. False: why says what is wrong. */
bool image_decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char why[IMAGE_WHY_BYTES]);
/* Any file that OpenImageIO reads, from people we trust: a plant file or a command line names it. Otherwise as above. */
bool image_load(struct image *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES]);
bool image_load_float(struct image_float *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES]);

#ifdef __cplusplus
}
#endif
#endif
