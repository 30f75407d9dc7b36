/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks the answer of another plant's server to a request for a picture. No side effects. Call from any thread. */
#ifndef VIEWS_OTHER_PICTURE_H
#define VIEWS_OTHER_PICTURE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { OTHER_NAME_BYTES = 257 };

struct other_picture {
    /* age of the oldest reading in the picture at the time when the picture was drawn; -1: the picture shows no readings */
    int64_t oldest_age_ms;
    bool past;                   /* true: the picture shows a time in the past */
    char name[OTHER_NAME_BYTES]; /* name of the other plant; empty: its server states none */
};

/* Parses the header `Plantcast-Frame` of an answer. Returns false if the header is invalid; the answer then does not come from a Plantcast
 * server. */
bool other_picture_read_header(const char *header, struct other_picture *out);
/* Returns whether the bytes are one complete PNG file of this size; does not decode its pixels. */
bool other_picture_is_png(const uint8_t *bytes, size_t count, int width_px, int height_px);

#endif
