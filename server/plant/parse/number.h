/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses numbers and flags of plant files and tag lists. Numbers have a decimal point whatever the user's locale. Call from any thread. */
#ifndef PLANT_PARSE_NUMBER_H
#define PLANT_PARSE_NUMBER_H
#include <stdbool.h>

enum number_result { NUMBER_GOOD, NUMBER_NOT_A_NUMBER, NUMBER_NOT_FINITE };

/* Parses text that must be one decimal number (`-1.5e3`) and nothing else. `inf`, `.nan` and numbers that overflow give
   NUMBER_NOT_FINITE. Writes *out only if the result is NUMBER_GOOD. */
enum number_result number_parse(const char *text, double *out);
/* Parses 1, true or yes, and 0, false or no, ignoring case. Returns false if the text is none of these. */
bool flag_parse(const char *text, bool *out);

#endif
