/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Helpers of the files that build the server's JSON messages. Private to reply*.c. Call only in the event loop. */
#ifndef SESSION_REPLY_REPLY_IMPL_H
#define SESSION_REPLY_REPLY_IMPL_H
#include <jansson.h>

#include "session/reply/reply.h"

enum { DIGITS = 9, EXACT_DIGITS = 17 };

static inline json_int_t us(int64_t ns)
{
    return ns / 1000;
}

/* --- reply_view.c --- */

/* Adds the parameters of a view to a JSON object. open: true: for clients without a token; omits the names of tags and baselines. */
void reply_set_params(json_t *object, const struct session_context *context, const struct view *view, bool open);
/* Returns the name of the environment (lighting) with that index in a view. The text is static or belongs to the plant. */
const char *reply_environment_name(const struct plant *plant, int environment);

/* --- reply_plant.c --- */

/* Returns a new JSON object with the constant properties of a tag: name, description, unit, source, group, asset and limits. */
json_t *reply_tag(const struct plant *plant, const struct plant_tag *t);

#endif
