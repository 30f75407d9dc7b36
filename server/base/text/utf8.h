/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Characters in UTF-8 text (Unicode 15, table 3-7). Call from any thread. */
#ifndef BASE_TEXT_UTF8_H
#define BASE_TEXT_UTF8_H
#include <stddef.h>

/* Returns the number of bytes of the first character of `text`, which has `left` bytes (at least 1); 0: invalid UTF-8, or the byte 0. */
size_t utf8_length(const char *text, size_t left);
/* Removes bytes that are not part of a complete character, for example after a format's precision ("%.60s") or a buffer has cut
   a character. */
void utf8_drop_invalid(char *text);

#endif
