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
/* Who reads of walls: all of them, or only what a narrowed token is good for. */
struct walls_reader {
    const char *wall; /* of a paired device: its wall, and of that its display; NULL: all */
    int display;
    bool (*sees)(const void *arg, const char *view); /* of a token of some views: panes of these alone, and clocks and texts; NULL: all */
    const void *arg;
};
/* Returns the walls of the plant file, as far as the reader (NULL: anyone) may know them, as JSON; mem_free. */
char *walls_text(const struct plant *plant, const struct walls_reader *reader);

#endif
