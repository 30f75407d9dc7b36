/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A text file that a person wrote, read whole and checked to be UTF-8 text. Thread: any. */
#ifndef PLANT_INPUT_H
#define PLANT_INPUT_H
#include <stddef.h>

#include "base/diag.h"

#define INPUT_MAX_BYTES (64u * 1024 * 1024)

/* The file without a byte order mark, ended by one 0 byte. Bytes that are not text are reported, the first of each line in the first lines
   that have any, and replaced by '_', so that what follows can still be checked. NULL: reported (unreadable, empty, larger than
   INPUT_MAX_BYTES, UTF-16, or no text at all; `wanted` says what should stand there, such as "a plant file (YAML)"). Free with mem_free. */
char *input_read(const char *path, const char *wanted, struct diag *diag, size_t *bytes);

#endif
