/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a colour map from an image: from the middle row of pixels along the image's longer side, left to right or bottom to
   top. Colours are used and interpolated as they are in the file (sRGB), as with a texture. Call from any thread. */
#ifndef PLANT_SECTIONS_IMAGE_RAMP_H
#define PLANT_SECTIONS_IMAGE_RAMP_H
#include <stdbool.h>
#include <stdint.h>

#include "base/image/image.h"

/* Reads a colour map from an image. Returns false with the reason in `why` on failure. */
bool image_ramp(const char *path, uint8_t rgb[256][3], char why[IMAGE_WHY_BYTES]);

#endif
