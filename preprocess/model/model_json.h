/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The JSON of a model file, and the binary chunk beside it. */
#ifndef PREPROCESS_MODEL_JSON_H
#define PREPROCESS_MODEL_JSON_H
#include <jansson.h>

#include "preprocess/model/model_source.h"

struct model_bytes { /* in somebody else's memory */
    const unsigned char *at;
    size_t size;
};

/* An object, to be released with json_decref. binary->at is NULL where there is no binary chunk. NULL: why says what is wrong with the
   chunks, the syntax, or the depth. */
json_t *model_json_load(const struct model_source *source, struct model_bytes *binary, char why[MODEL_WHY_BYTES]);

#endif
