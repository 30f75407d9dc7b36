/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The precision of readings in messages to people and programs. Call from any thread. */
#ifndef BASE_MATH_ROUND_READING_H
#define BASE_MATH_ROUND_READING_H

enum { READING_DIGITS = 15 }; /* number of significant digits with which to print a value returned by round_reading() */
/* Rounds a finite reading to seven significant digits, but to no fewer than three decimals: large numbers such as counters keep
   all digits that pages show. Never returns -0.0. */
double round_reading(double value);

#endif
