/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds out the encoding of a text file and converts it to UTF-8: UTF-8, UTF-16 (with a byte order mark, or by its zeros), Korean (cp949),
 * Western (cp1252). Thread: any. */
#ifndef PREPROCESS_MATCH_CHARSET_H
#define PREPROCESS_MATCH_CHARSET_H
#include <stddef.h>

struct charset_text {
    char *utf8; /* ends in 0 */
    size_t length;
    const char *encoding; /* static: "UTF-8", "UTF-16LE", "cp949", ... */
    size_t damaged;       /* characters that are U+FFFD, since the bytes mean nothing in that encoding; and bytes 0, which are left out */
};

/* Converts a whole file. The caller frees out->utf8 (mem_free). */
void charset_decode(const char *bytes, size_t count, struct charset_text *out);

#endif
