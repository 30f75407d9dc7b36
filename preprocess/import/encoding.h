/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text of unknown encoding as UTF-8. Thread: any. */
#ifndef PREPROCESS_IMPORT_ENCODING_H
#define PREPROCESS_IMPORT_ENCODING_H
#include <stdbool.h>
#include <stddef.h>

/* Returns the text as UTF-8: as it is if it is valid UTF-8, else read as Latin-1 (`latin1`) or with U+FFFD for what is not valid. Control
 * characters, tabs and line ends among them, become blanks; those of Latin-1 from 0x80 on become U+FFFD. The caller frees it (mem_free). */
char *encoding_to_utf8(const char *text, size_t length, bool latin1);

#endif
