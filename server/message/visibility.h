/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hidden, isolated and ghosted assets, and clipping, as JSON. */
#ifndef MESSAGE_VISIBILITY_H
#define MESSAGE_VISIBILITY_H
#include "message/message.h"

/* Reads `hidden`, `isolate`, `ghost` and `clip`. False: *error names the field. */
bool visibility_parse(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error);
void visibility_apply(const struct params_change *change, struct visibility *visibility);
void visibility_print(const struct plant *plant, const struct visibility *visibility, json_t *into);

#endif
