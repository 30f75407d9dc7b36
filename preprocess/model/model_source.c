/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and hashes model files. */
#include "preprocess/model/model_source.h"

#include <errno.h>
#include <libgen.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "preprocess/model/model_json.h"
#include "preprocess/model/model_uri.h"

static bool hash_uri(const struct model_source *source, const char *what, size_t number, const char *uri, XXH3_state_t *hash, char *why)
{
    size_t size;
    char uri_why[MODEL_WHY_BYTES];
    /* skip data inside the URI: it is part of the model file's bytes, which have already been hashed */
    if (!uri || model_uri_is_data(uri))
        return true;
    unsigned char *bytes = model_uri_read(source->folder, uri, &size, uri_why);
    /* a missing image is not an error, because the model can be drawn without it; the hash changes if the image is added later */
    if (!bytes && strcmp(what, "image") == 0)
        return true;
    if (!bytes)
        return wrong(why, "%s %zu: %s", what, number, uri_why);
    XXH3_64bits_update(hash, bytes, size);
    mem_free(bytes);
    return true;
}

static bool hash_all(struct model_source *source, const json_t *root, char *why)
{
    const char *const lists[] = { "buffers", "images" }, *const names[] = { "buffer", "image" };
    XXH3_state_t *hash = XXH3_createState();
    bool good = hash != NULL;
    if (!good)
        return wrong(why, "out of memory");
    XXH3_64bits_reset(hash);
    XXH3_64bits_update(hash, source->bytes, source->size);
    for (int l = 0; l < 2 && good; l++) {
        const json_t *list = json_object_get(root, lists[l]);
        for (size_t i = 0; good && i < json_array_size(list); i++)
            good = hash_uri(source, names[l], i, json_string_value(json_object_get(json_array_get(list, i), "uri")), hash, why);
    }
    source->hash = XXH3_64bits_digest(hash);
    XXH3_freeState(hash);
    return good;
}

bool model_source_open(struct model_source *source, const char *path, char why[MODEL_WHY_BYTES])
{
    struct model_bytes binary;
    *source = (struct model_source){ .path = mem_strdup(path) };
    char *copy = mem_strdup(path);
    source->folder = realpath(dirname(copy), NULL);
    mem_free(copy);
    if (source->folder)
        source->bytes = (unsigned char *)text_read_file(path, MODEL_MAX_BYTES, &source->size);
    if (!source->bytes) {
        wrong(why, "%s", strerror(errno));
        goto error;
    }
    json_t *root = model_json_load((struct model_bytes){ source->bytes, source->size }, &binary, why);
    bool good = root && hash_all(source, root, why);
    json_decref(root);
    if (!good)
        goto error;
    return true;
error:
    model_source_finish(source);
    return false;
}

void model_source_finish(struct model_source *source)
{
    mem_free(source->path);
    free(source->folder);
    mem_free(source->bytes);
    *source = (struct model_source){ 0 };
}
