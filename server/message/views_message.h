/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The messages `save_view` and `remove_view`: views with names. Thread: the loop. */
#ifndef MESSAGE_VIEWS_MESSAGE_H
#define MESSAGE_VIEWS_MESSAGE_H
#include "message/message.h"

/* Parse the messages into out->view_edit. Return false with *error saying what is wrong. */
bool save_view_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool remove_view_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
/* Saves or removes the view. who: the user's name; time_us: UTC. Returns the answer; mem_free. */
char *view_edit_do(struct named_views *views, const struct message *message, const char *who, int64_t time_us);
/* Returns the walls of the plant file as JSON; mem_free. */
char *walls_text(const struct plant *plant);

#endif
