/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of messages about hidden, isolated and ghosted assets, and about clipping. Pure. */
#ifndef MESSAGE_VISIBILITY_H
#define MESSAGE_VISIBILITY_H
#include "message/message.h"

/* Reads `hidden`, `isolate`, `ghost` and `clip` into the change. Returns false with *error naming the wrong member. */
bool visibility_parse(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error);
/* Applies a change of hidden, isolated and ghosted assets and of clipping to a view. */
void visibility_apply(const struct params_change *change, struct visibility *visibility);
/* Adds the members `hidden`, `isolate`, `ghost` and `clip` to an object. */
void visibility_print(const struct plant *plant, const struct visibility *visibility, json_t *into);

#endif
