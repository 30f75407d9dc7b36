/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes the pixels of a PNG file. No input or output. Call from any thread. */
#ifndef PROVENANCE_PNG_PIXELS_H
#define PROVENANCE_PNG_PIXELS_H
#include <stddef.h>
#include <stdint.h>

enum { PNG_WHY_BYTES = 128 };
/* Returns the pixels of a PNG file that must have the given size: red, green, blue, rows from the top; the caller frees them
   (mem_free). Returns NULL with the reason in `why` if the picture has another size or cannot be read. */
uint8_t *png_pixels(const uint8_t *png, size_t count, int64_t width_px, int64_t height_px, char why[PNG_WHY_BYTES]);

#endif
