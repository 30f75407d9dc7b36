/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of JSON messages that hide, isolate or ghost assets, or clip the model. Pure. */
#ifndef MESSAGE_VISIBILITY_H
#define MESSAGE_VISIBILITY_H
#include "message/message.h"

/* Parses `hidden`, `isolate`, `ghost` and `clip` into the change. Returns false with *error naming the wrong member. */
bool visibility_parse(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error);
/* Applies a change to a view's hidden, isolated and ghosted assets and to its clipping planes. */
void visibility_apply(const struct params_change *change, struct visibility *visibility);
/* Adds the members `hidden`, `isolate`, `ghost` and `clip` to the JSON object `into`. */
void visibility_print(const struct plant *plant, const struct visibility *visibility, json_t *into);

#endif
