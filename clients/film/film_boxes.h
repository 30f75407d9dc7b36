/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks that a film's file makes players show its pictures unchanged: parses MP4 boxes (ISO/IEC 14496-12) and H.264 NAL units (ITU-T
   H.264, 7.3). */
#ifndef FILM_BOXES_H
#define FILM_BOXES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FILM_BOXES_WHY_BYTES = 160 };

struct film_size { /* display size of a film in pixels, from the MP4 sample entry */
    int width_px, height_px;
};

/* Returns true if the file has only the boxes that `plantcast clip --signed` writes, with the same colours, matrices, sizes and edit
   list, and one sequence and one picture parameter set. *size receives the display size. If false, `why` receives the reason with the
   name of the box. */
bool film_boxes_plain(const char *path, struct film_size *size, char why[FILM_BOXES_WHY_BYTES]);
/* Returns true if an H.264 sample has only picture slices and messages that do not change the picture. If false, `why` receives the
   reason. */
bool film_units_plain(const uint8_t *sample, size_t count, char why[FILM_BOXES_WHY_BYTES]);

#endif
