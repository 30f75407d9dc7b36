/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads the JSON of a model file and finds its binary chunk. */
#ifndef PREPROCESS_MODEL_JSON_H
#define PREPROCESS_MODEL_JSON_H
#include <jansson.h>
#include <stdint.h>

#include "plant/models/model_refusal.h"

struct model_bytes { /* a range of bytes owned by another object */
    const unsigned char *at;
    size_t size;
};

/* Parses the JSON of a model file. Returns the root object, which the caller releases with json_decref(); *binary receives the
 * binary chunk, or NULL if there is none. Returns NULL with the reason in why if chunks, syntax or nesting depth are invalid.
 * */
json_t *model_json_load(struct model_bytes file, struct model_bytes *binary, char why[MODEL_WHY_BYTES]);

/* Returns an array by buffer: true if the buffer is only a fallback for programs that do not support EXT_meshopt_compression.
 * Such a buffer may have no bytes. A buffer is a fallback if the file says so, or if all its views are compressed. The caller
 * frees the array with mem_free(). */
bool *model_json_standins(const json_t *root);

#endif
