/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unpacks models that are compressed in a ZIP or gzip file. Thread: any. */
#ifndef PREPROCESS_IMPORT_UNPACK_H
#define PREPROCESS_IMPORT_UNPACK_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text/text.h"

/* Returns the ending that a compressed model has after unpacking, such as ".ifc" for "a.ifczip"; the caller frees it (mem_free). NULL: the
 * file is not compressed, as its name and its first bytes show. */
char *unpack_ending(const char *path);
/* Unpacks the model into the file `output`. Of a ZIP file, takes the file that its manifest names (COLLADA), else the first file with the
 * ending of `output`; adds a line to `said` if it holds more. Returns false with the reason in why. */
bool unpack(const char *path, const char *output, struct text *said, char *why, size_t why_bytes);

#endif
