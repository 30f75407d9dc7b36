/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a URI of a model names: a file inside the model's folder, or bytes in the URI itself. Nothing else is opened. */
#ifndef PREPROCESS_MODEL_URI_H
#define PREPROCESS_MODEL_URI_H
#include <stddef.h>

#include "preprocess/model/refusal.h"

bool model_uri_is_data(const char *uri);

/* Free with mem_free. `folder` as realpath names it. NULL: why says what is wrong. */
unsigned char *model_uri_read(const char *folder, const char *uri, size_t *size, char why[MODEL_WHY_BYTES]);

#endif
