/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks what another plant's server answers to a request for a picture. Pure. Thread: any. */
#ifndef VIEWS_OTHER_PICTURE_H
#define VIEWS_OTHER_PICTURE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { OTHER_NAME_BYTES = 257 };

struct other_picture {
    int64_t oldest_age_ms;       /* of the readings in it, when it was drawn; -1: there are none */
    char name[OTHER_NAME_BYTES]; /* of the plant; "": its server does not say */
};

/* Reads the header `Plantcast-Frame` of an answer. Returns false if it is none: then no picture of Plantcast came. */
bool other_picture_read_header(const char *header, struct other_picture *out);
/* Returns whether bytes are one whole PNG file of that size; what its pixels are is not looked at. */
bool other_picture_is_png(const uint8_t *bytes, size_t count, int width_px, int height_px);

#endif
