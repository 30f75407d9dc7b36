/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of texts share. Private to reply*.c. Thread: the loop. */
#ifndef SESSION_REPLY_REPLY_IMPL_H
#define SESSION_REPLY_REPLY_IMPL_H
#include <jansson.h>

#include "session/reply/reply.h"

enum { VALUE_DIGITS = 7, DIGITS = 9, EXACT_DIGITS = 17 };

static inline json_int_t us(int64_t ns)
{
    return ns / 1000;
}

/* --- reply_view.c --- */

/* Sets the parameters of a view in an object. open: for clients without a token, without names of tags and baselines. */
void reply_set_params(json_t *object, const struct session_context *context, const struct view *view, bool open);
/* Returns the name of an environment, by its number in a view; static, or of the plant. */
const char *reply_environment_name(const struct plant *plant, int environment);

/* --- reply_plant.c --- */

/* Returns what never changes about a tag, as a new object. */
json_t *reply_tag(const struct plant *plant, const struct plant_tag *t);

#endif
