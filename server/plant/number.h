/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers as people write them in files: with a decimal point, whatever the locale. Thread: any. */
#ifndef PLANT_NUMBER_H
#define PLANT_NUMBER_H

enum number_result { NUMBER_GOOD, NUMBER_NOT_A_NUMBER, NUMBER_NOT_FINITE };

/* The whole text must be one decimal number (`-1.5e3`). `inf`, `.nan` and what overflows are NUMBER_NOT_FINITE.
   *out is written only when NUMBER_GOOD. */
enum number_result number_parse(const char *text, double *out);

#endif
