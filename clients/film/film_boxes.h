/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks that a film's file shows its pictures unchanged: boxes of MP4 (ISO/IEC 14496-12) and units of H.264 (ITU-T H.264, 7.3). */
#ifndef FILM_BOXES_H
#define FILM_BOXES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FILM_BOXES_WHY_BYTES = 160 };

struct film_size { /* as the sample entry says */
    int width_px, height_px;
};

/* Returns whether the file has only the boxes that `plantcast clip --signed` writes, with the same colours, matrices, sizes and edit list,
   and one sequence and one picture parameter set. Writes the size at which it is shown; if not plain, the reason, with the name of the
   box, to `why`. */
bool film_boxes_plain(const char *path, struct film_size *size, char why[FILM_BOXES_WHY_BYTES]);
/* Returns whether a sample has only slices of pictures and messages that change nothing shown. If not, writes the reason to `why`. */
bool film_units_plain(const uint8_t *sample, size_t count, char why[FILM_BOXES_WHY_BYTES]);

#endif
