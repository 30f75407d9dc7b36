/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The JSON of a model file, and the binary chunk beside it. */
#ifndef PREPROCESS_MODEL_JSON_H
#define PREPROCESS_MODEL_JSON_H
#include <jansson.h>
#include <stdint.h>

#include "preprocess/model/refusal.h"

struct model_bytes { /* in somebody else's memory */
    const unsigned char *at;
    size_t size;
};

/* Parses the JSON of a model file and returns the object, to be released with json_decref(); *binary is the binary chunk, NULL if there is
   none. Returns NULL if the chunks, the syntax or the depth are wrong, with the reason in why. */
json_t *model_json_load(struct model_bytes file, struct model_bytes *binary, char why[MODEL_WHY_BYTES]);

/* Returns for each buffer whether it only stands in for one that EXT_meshopt_compression compresses, for programs that cannot read that:
 * such a buffer may have no bytes. The file says so, or each view of it is compressed. Free with mem_free(). */
bool *model_json_standins(const json_t *root);

#endif
