/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a file is that somebody named by mistake, by how it begins. Pure. Thread: any. */
#ifndef PLANT_FILE_KIND_H
#define PLANT_FILE_KIND_H
#include <stdbool.h>
#include <stddef.h>

enum { FILE_KIND_BYTES = 512 }; /* more is not looked at */

/* "a STEP file", "a model (GLB)", ...; NULL: nothing that begins so is known, text for instance. */
const char *file_kind(const void *bytes, size_t count);
/* Likewise of a file; NULL too where it cannot be read. */
const char *file_kind_of(const char *path);

#endif
