/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first message between a core and a renderer, with version, plant and configuration, and the check that these are equal.
   Pure. Call from any thread. */
#ifndef CORELINK_CORE_IDENTITY_H
#define CORELINK_CORE_IDENTITY_H
#include <jansson.h>
#include <stdbool.h>

#define CORE_SUBPROTOCOL "plantcast.core.v1"
#define CORE_PATH "/core"

struct core_identity {
    /* version: version of the program; plant: name of the plant; configuration: hash of plant file and tag list */
    const char *version, *plant, *configuration;
};

/* Returns the identity message as JSON; the caller owns it. type: "core" or "renderer". */
json_t *core_identity_message(const char *type, const struct core_identity *own);
/* Returns how the peer's identity message (peer: "core" or "renderer") differs from `own`, as text for the log; free with
   mem_free(). NULL: nothing differs. */
char *core_identity_difference(const json_t *told, const char *peer, const struct core_identity *own);

/* Returns true if the peer differs from `own` only in its configuration: it can be accepted once both have loaded the same
   plant file and tag list. */
bool core_identity_is_other_configuration(const json_t *told, const struct core_identity *own);

#endif
