/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Redraws a signed picture from its signed statement (plant, time, view, readings) and compares the result with the picture.
   Call from one thread only. */
#ifndef CLI_PICTURE_REDRAW_H
#define CLI_PICTURE_REDRAW_H
#include "provenance/signed_picture.h"

struct redraw_options {
    const char *plant;    /* plant file; NULL: no redraw */
    const char *prepared; /* folder of the files that plantcast-prep made for the plant; NULL: next to the plant file */
    const char *history;  /* history folder; NULL: the statement's readings are not compared with recorded ones */
};

/* Draws the statement's view with the statement's readings. Compares the pixels, the configuration, the asset files and, if
   options->history is set, the readings, and prints the result of each comparison. rgb: pixels of the verified picture, in the statement's
   size: red, green, blue, rows from the top. Returns 0 if all agree, 1 if something differs, 2 if the view could not be drawn. */
int redraw_compare(const struct redraw_options *options, const json_t *statement, const uint8_t *rgb);

#endif
