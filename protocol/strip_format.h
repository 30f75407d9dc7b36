/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The legend strip: rows of coloured cells along a picture's lower edge. Programs read from them which value a colour means,
   even after JPEG compression or from a screenshot. Layout and code: HTTP.md, *Legend strip*. Pure. Call from any thread. */
#ifndef PROTOCOL_STRIP_FORMAT_H
#define PROTOCOL_STRIP_FORMAT_H
#include <stdbool.h>
#include <stdint.h>

/* Sizes in cells. Programs find the strip by a finder at each end, a pattern of columns: dark, light, dark, light, dark columns
   1, 1, 3, 1, 1 cells wide, between light ones. Between the finders are three rows of colours, each two cells high and in a
   different brightness, then the rows of dark and light cells that contain the code. A light row is above all these rows and
   one is below. */
enum { STRIP_COLUMNS = 200, STRIP_FINDER = 9, STRIP_INNER = STRIP_COLUMNS - 2 * STRIP_FINDER };
enum { STRIP_SHADES = 3, STRIP_SHADE_CELLS = 2, STRIP_CODE_ROWS = 3, STRIP_ROWS = 2 + STRIP_SHADES * STRIP_SHADE_CELLS + STRIP_CODE_ROWS };
/* Columns of the legend strip between its finders. STRIP_BEYOND: number at each end with the colour of values beyond the colour scale;
   STRIP_RAMP: number with the colours of the scale. */
enum { STRIP_BEYOND = 4, STRIP_RAMP = STRIP_INNER - 2 * STRIP_BEYOND };
enum { STRIP_LEAST_PX = 3 }; /* minimum size of a cell */
/* Sizes of the strip's code in bytes: STRIP_DATA of contents, then STRIP_PARITY of Reed-Solomon parity, which can correct up to
   STRIP_PARITY / 2 wrong bytes. */
enum { STRIP_DATA = 44, STRIP_PARITY = 24, STRIP_BYTES = STRIP_DATA + STRIP_PARITY };
enum { STRIP_GROUP = 22, STRIP_UNIT = 10 };

struct strip {
    float min, max;
    bool log;
    uint8_t show;                                      /* enum field_show */
    char group[STRIP_GROUP + 1], unit[STRIP_UNIT + 1]; /* truncated between characters if longer */
};

/* Returns true if a column of the left finder is dark; column: 0..STRIP_FINDER - 1. The right finder is its mirror image. */
bool strip_finder_dark(int column);
/* Writes contents and parity. */
void strip_encode(const struct strip *strip, uint8_t code[STRIP_BYTES]);
/* Decodes the strip's code and corrects errors in it. *mended receives the number of corrected bytes. Returns false if there are too many
   errors, the version differs, or the contents are invalid. */
bool strip_decode(const uint8_t code[STRIP_BYTES], struct strip *strip, int *mended);
/* Returns true if the cell of the strip's code at row 0..STRIP_CODE_ROWS - 1 and column 0..STRIP_INNER - 1 is dark. */
bool strip_cell_dark(const uint8_t code[STRIP_BYTES], int row, int column);
/* Sets the bit of the strip's code that belongs to a cell. The code must be zeroed before the first call. */
void strip_set_cell(uint8_t code[STRIP_BYTES], int row, int column, bool dark);

#endif
