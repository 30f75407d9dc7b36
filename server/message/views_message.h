/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The messages `save_view` and `remove_view` for named views. Thread: the loop. */
#ifndef MESSAGE_VIEWS_MESSAGE_H
#define MESSAGE_VIEWS_MESSAGE_H
#include "message/message.h"

/* Parse the messages into out->view_edit. Return false with *error saying what is wrong. */
bool save_view_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool remove_view_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
/* Saves or removes the view. who: the user's name; time_us: UTC. Returns the answer; free with mem_free(). */
char *view_edit_do(struct named_views *views, const struct message *message, const char *who, int64_t time_us);
/* Limits of a client's token on the walls that the client may read. */
struct walls_reader {
    const char *wall; /* wall of a paired device, and its display; NULL: all walls */
    int display;
    /* for a token limited to some views: returns whether a pane may show that view; clocks and texts are always allowed. NULL: no limit */
    bool (*sees)(const void *arg, const char *view);
    const void *arg;
};
/* Returns the walls of the plant file that the reader may see (NULL: all), as JSON; free with mem_free(). */
char *walls_text(const struct plant *plant, const struct walls_reader *reader);

#endif
