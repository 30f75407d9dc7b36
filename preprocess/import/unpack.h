/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unpacks models that are compressed in a ZIP or gzip file. Call from any thread. */
#ifndef PREPROCESS_IMPORT_UNPACK_H
#define PREPROCESS_IMPORT_UNPACK_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text/text.h"

/* Returns the ending of a compressed model's file after unpacking, such as ".ifc" for "a.ifczip"; the caller frees it
 * (mem_free). NULL: the file's name and first bytes show that it is not compressed. */
char *unpack_ending(const char *path);
/* Unpacks the model into the file `output`. From a ZIP file, takes the file named in its manifest (COLLADA), else the first
 * file with the ending of `output`; appends a line to `said` if there are more. Returns false with the reason in why. */
bool unpack(const char *path, const char *output, struct text *said, char *why, size_t why_bytes);

#endif
