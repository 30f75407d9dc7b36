/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws a signed picture again from what it tells, and compares. Thread: one. */
#ifndef CLI_PICTURE_REDRAW_H
#define CLI_PICTURE_REDRAW_H
#include "provenance/signed_picture.h"

struct redraw_options {
    const char *plant;    /* plant file; NULL: nothing is drawn */
    const char *prepared; /* NULL: beside the plant file */
    const char *history;  /* folder; NULL: readings are not compared */
};

/* Draws the statement's view from its readings and compares pixels, configuration, asset files and, if asked to, readings; prints what
   agrees and what does not. rgb: the picture's pixels, of the verified statement's size: red, green, blue, rows from the top. Returns 0:
   all agrees; 1: something does not; 2: it could not be drawn. */
int redraw_compare(const struct redraw_options *options, const json_t *statement, const uint8_t *rgb);

#endif
