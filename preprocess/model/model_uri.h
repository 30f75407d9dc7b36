/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolves a model's URIs, each a file inside the model's folder or data in the URI itself. Never opens files outside the folder. */
#ifndef PREPROCESS_MODEL_URI_H
#define PREPROCESS_MODEL_URI_H
#include <stddef.h>

#include "plant/models/model_refusal.h"

#define MODEL_MAX_BYTES ((size_t)4 << 30) /* maximum size of a model file, and of each file it refers to */

/* Returns whether a URI contains its data itself ("data:..."). */
bool model_uri_is_data(const char *uri);

/* Returns the bytes that a URI refers to, which the caller frees with mem_free(). folder: the model's folder, as returned by
 * realpath(). Returns NULL with the reason in why on failure. */
unsigned char *model_uri_read(const char *folder, const char *uri, size_t *size, char why[MODEL_WHY_BYTES]);

#endif
