/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An encoded image to RGBA8. OpenImageIO stays behind this header. */
#ifndef PREPROCESS_IMAGE_SHIM_H
#define PREPROCESS_IMAGE_SHIM_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define IMAGE_WHY_BYTES 200

struct image {
    uint8_t *rgba; /* rows from the top; free with mem_free */
    uint32_t width_px, height_px;
};

/* Larger sides than max_px are scaled down. False: why says what is wrong. Thread: any. */
bool image_decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char why[IMAGE_WHY_BYTES]);

#ifdef __cplusplus
}
#endif
#endif
