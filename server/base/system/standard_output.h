/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks at the end of a program whether its standard output was written. */
#ifndef BASE_SYSTEM_STANDARD_OUTPUT_H
#define BASE_SYSTEM_STANDARD_OUTPUT_H

/* Flushes standard output. Returns the exit code for main(): `code`, or 1 instead of 0 if any output could not be written, for example
   because the disk is full. Then prints the reason to standard error, after `program`. */
int standard_output_end(const char *program, int code);

#endif
