/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first message between a core and a renderer, with version, plant, configuration and the hashes of the plant's files, and
   the check that these are equal. Pure. Call from any thread. */
#ifndef CORELINK_CORE_IDENTITY_H
#define CORELINK_CORE_IDENTITY_H
#include <jansson.h>
#include <stdbool.h>

#include "plant/plant.h"

#define CORE_SUBPROTOCOL "plantcast.core.v1"
#define CORE_PATH "/core"

/* Files that must be equal on all nodes of a plant. The values are bits of a mask of files that differ. The table in
   core_identity.c names these files in messages and in the log. */
enum core_file { CORE_PLANT_FILE = 1, CORE_TAG_LIST = 2, CORE_MODELS = 4 };
enum { CORE_HASH_BYTES = 17 /* 16 hexadecimal digits and the terminator */ };

struct core_files {
    /* hashes in hexadecimal: plant: of the plant file; tags: of the tag list; models: of all models together, with
       all other files that affect the pictures (scene.models_hash) */
    char plant[CORE_HASH_BYTES], tags[CORE_HASH_BYTES], models[CORE_HASH_BYTES];
};

struct core_identity {
    /* version: version of the program; plant: name of the plant; configuration: hash of plant file and tag list */
    const char *version, *plant, *configuration;
    struct core_files files;
};

/* An order to load the plant because the core loads or has loaded it. */
struct core_follow {
    /* number of the connection (core_link_session()) that the core ends once it uses its new plant; 0: it uses it already */
    uint64_t session;
    const char *expects; /* hash that this node's configuration must have afterwards; NULL: any */
    const char *loads;   /* hash of the configuration that the core loads; NULL: not known */
};

/* Returns the hashes of a loaded plant. models_hash: scene.models_hash. */
struct core_files core_files_of(const struct plant *plant, uint64_t models_hash);
/* Returns the hashes as JSON; the caller owns it. */
json_t *core_files_json(const struct core_files *files);
/* Reads the member `files` of a message. Returns false if the message has no valid one. */
bool core_files_read(const json_t *told, struct core_files *out);
/* Returns the files of which the other node has another version, as a mask of enum core_file. */
unsigned core_files_differing(const struct core_files *own, const struct core_files *other);
/* Returns the names of the files in the mask, such as "tag list, models"; free with mem_free(). */
char *core_files_text(unsigned files);
/* Returns the JSON array of the keys of the files in the mask, such as ["tags","models"]; the caller owns it. */
json_t *core_files_keys(unsigned files);

/* Returns the identity message as JSON; the caller owns it. type: "core" or "renderer". */
json_t *core_identity_message(const char *type, const struct core_identity *own);
/* Returns how the peer's identity message (peer: "core" or "renderer") differs from `own`, as text for the log; free with
   mem_free(). NULL: nothing differs, except perhaps the models, because nodes with other models can exchange readings. */
char *core_identity_difference(const json_t *told, const char *peer, const struct core_identity *own);

/* Returns true if the peer differs from `own` only in its configuration: it can be accepted once both have loaded the same
   plant file and tag list. */
bool core_identity_is_other_configuration(const json_t *told, const struct core_identity *own);

#endif
