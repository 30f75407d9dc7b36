/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models that are compressed in a ZIP or gzip file. Thread: any. */
#ifndef PREPROCESS_IMPORT_UNPACK_H
#define PREPROCESS_IMPORT_UNPACK_H
#include <stdbool.h>
#include <stddef.h>

/* Returns the ending that a packed model has once it is unpacked, such as ".ifc" for "a.ifczip"; NULL: the model is not packed. */
const char *unpack_ending(const char *path);
/* Writes what a packed model holds to `output`: of a ZIP file its first file with that ending. Returns false with the reason in why. */
bool unpack(const char *path, const char *output, char *why, size_t why_bytes);

#endif
