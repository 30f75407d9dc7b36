/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads text files: a plant's files, which are UTF-8, and files of other programs, in any encoding. Call from any thread. */
#ifndef PLANT_PARSE_INPUT_H
#define PLANT_PARSE_INPUT_H
#include <stddef.h>

#include "base/text/charset.h"
#include "base/text/diag.h"

#define INPUT_MAX_BYTES (64u * 1024 * 1024)

/* Returns the content of a file without a byte order mark, followed by a 0 byte; free with mem_free(). Invalid bytes are reported to
   diag, one for each of the first lines that have any, and replaced by '_', so that the rest can still be checked. Returns NULL,
   reported, if the file is unreadable, empty, larger than INPUT_MAX_BYTES, UTF-16, or not text at all; `wanted` names what was expected,
   such as "a plant file (YAML)". */
char *input_read(const char *path, const char *wanted, struct diag *diag, size_t *bytes);
/* Reads a text file of another program, in any encoding, and returns its content like input_read(). `encoding`: a name that
   charset_resolve() knows; NULL: detected from the bytes. *choice receives the encoding. */
char *input_read_foreign(const char *path, const char *wanted, const char *encoding, struct diag *diag, size_t *bytes,
                         struct charset_choice *choice);

#endif
