/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a core and a renderer tell each other first, and why they may not belong together. Pure. Thread: any. */
#ifndef CORELINK_CORE_IDENTITY_H
#define CORELINK_CORE_IDENTITY_H
#include <jansson.h>

#define CORE_SUBPROTOCOL "plantcast.core.v1"
#define CORE_PATH "/core"

struct core_identity {
    const char *version, *plant, *configuration; /* of the program; the plant's name; the hash of plant file and tag list */
};

/* Returns the message that tells it, as JSON; the caller owns it. type: "core" or "renderer". */
json_t *core_identity_message(const char *type, const struct core_identity *own);
/* Returns what differs between `own` and what the other one, peer ("core" or "renderer"), told, in words for the log; mem_free. NULL: they
   belong together. */
char *core_identity_difference(const json_t *told, const char *peer, const struct core_identity *own);

#endif
