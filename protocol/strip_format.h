/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The legend strip: rows of cells along a picture's lower edge, from which programs read which value a colour means, also after JPEG
   compression or from a screenshot. Layout and code: PROTOCOL.md, *Legend strip*. Pure. Thread: any. */
#ifndef PROTOCOL_STRIP_FORMAT_H
#define PROTOCOL_STRIP_FORMAT_H
#include <stdbool.h>
#include <stdint.h>

/* Sizes in cells. At the left and right is a finder of dark and light columns (1, 1, 3, 1, 1 between light ones). Between them are three
   rows of the colours, each two cells high and in a different brightness, then the rows of the code. A light row is above and below. */
enum { STRIP_COLUMNS = 200, STRIP_FINDER = 9, STRIP_INNER = STRIP_COLUMNS - 2 * STRIP_FINDER };
enum { STRIP_SHADES = 3, STRIP_SHADE_CELLS = 2, STRIP_CODE_ROWS = 3, STRIP_ROWS = 2 + STRIP_SHADES * STRIP_SHADE_CELLS + STRIP_CODE_ROWS };
enum { STRIP_BEYOND = 4, STRIP_RAMP = STRIP_INNER - 2 * STRIP_BEYOND }; /* colour columns beyond each end of the range, and within it */
enum { STRIP_LEAST_PX = 3 };                                            /* smallest size of a cell */
/* The code: STRIP_DATA bytes of contents, then STRIP_PARITY bytes of Reed-Solomon, which correct half as many wrong bytes. */
enum { STRIP_DATA = 44, STRIP_PARITY = 24, STRIP_BYTES = STRIP_DATA + STRIP_PARITY };
enum { STRIP_GROUP = 22, STRIP_UNIT = 10 };

struct strip {
    float min, max;
    bool log;
    uint8_t show;                                      /* enum field_show */
    char group[STRIP_GROUP + 1], unit[STRIP_UNIT + 1]; /* truncated between characters if longer */
};

/* Returns whether a column of the finder is dark; column: 0..STRIP_FINDER - 1 (the right finder is mirrored). */
bool strip_finder_dark(int column);
/* Writes contents and parity. */
void strip_encode(const struct strip *strip, uint8_t code[STRIP_BYTES]);
/* Reads a code and corrects errors. *mended: number of wrong bytes. Returns false if there are too many errors, the version differs, or the
   contents are invalid. */
bool strip_decode(const uint8_t code[STRIP_BYTES], struct strip *strip, int *mended);
/* Returns whether a cell of the code is dark; row: 0..STRIP_CODE_ROWS - 1, column: 0..STRIP_INNER - 1. */
bool strip_cell_dark(const uint8_t code[STRIP_BYTES], int row, int column);
/* Sets a cell's bit in a code that was zeroed before. */
void strip_set_cell(uint8_t code[STRIP_BYTES], int row, int column, bool dark);

#endif
