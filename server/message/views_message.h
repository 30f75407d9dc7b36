/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The messages `save_view` and `remove_view`, by which users edit named views, and `share_view`, which makes a short link. Call
   only in the event loop. */
#ifndef MESSAGE_VIEWS_MESSAGE_H
#define MESSAGE_VIEWS_MESSAGE_H
#include "message/message.h"
#include "views/short_links.h"

/* save_view_parse() and the functions below parse the messages into out->view_edit. They return false with *error saying what is wrong. */
bool save_view_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool remove_view_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
bool share_view_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
/* Saves or removes the view. who: the user's name; time_us: UTC. Returns the answer; free with mem_free(). */
char *view_edit_do(struct named_views *views, const struct message *message, const char *who, int64_t time_us);
/* Shares a view through a short link. time_us: UTC. added: receives the id of the link if it is new, else "". Returns the
   answer; free with mem_free(). */
char *share_view_do(struct short_links *links, const struct message *message, int64_t time_us, char added[SHORT_LINK_ID_BYTES]);
/* The part of the plant's display walls that a client's token allows it to see. */
struct walls_reader {
    /* wall and display to which a paired device is restricted; NULL: the client may see all walls */
    const char *wall;
    int display;
    /* returns true if a client whose token is restricted to some views may see that view in a pane; panes with clocks and texts
       are always allowed. NULL: the token is not restricted */
    bool (*sees)(const void *arg, const char *view);
    const void *arg;
};
/* Returns the walls of the plant file that the reader may see (NULL: all), as JSON; free with mem_free(). */
char *walls_text(const struct plant *plant, const struct walls_reader *reader);

#endif
