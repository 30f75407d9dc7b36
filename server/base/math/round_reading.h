/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The digits with which messages to people and programs state a reading. Thread: any. */
#ifndef BASE_MATH_ROUND_READING_H
#define BASE_MATH_ROUND_READING_H

enum { READING_DIGITS = 15 }; /* significant digits with which the numbers of round_reading() are printed */
/* Returns a finite reading with seven significant digits and at least three decimals, so that large numbers such as counters keep all
   digits that pages show. Never -0.0. */
double round_reading(double value);

#endif
