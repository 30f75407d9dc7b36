/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a URI of a model names: a file inside the model's folder, or bytes in the URI itself. Nothing else is opened. */
#ifndef PREPROCESS_MODEL_URI_H
#define PREPROCESS_MODEL_URI_H
#include <stddef.h>

#include "preprocess/model/refusal.h"

#define MODEL_MAX_BYTES ((size_t)4 << 30) /* of a model file, and of each file that it names */

/* Returns whether a URI contains the bytes itself ("data:"). */
bool model_uri_is_data(const char *uri);

/* Returns the bytes that a URI stands for; free with mem_free(). folder: of the model, as realpath() returns it. Returns NULL on failure,
   with the reason in why. */
unsigned char *model_uri_read(const char *folder, const char *uri, size_t *size, char why[MODEL_WHY_BYTES]);

#endif
