/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of a session share: input (session.c), its first message (session_hello.c),
   pictures (session_wishes.c), words (session_texts.c). Private to them. */
#ifndef SESSION_SESSION_IMPL_H
#define SESSION_SESSION_IMPL_H
#include "session/session.h"

void session_reply(struct session *session, char *text); /* takes it */
void session_drop_ready(struct session *session);        /* what was not sent yet */
/* Takes the list, and the first of it that there is. False: there is none. */
bool session_choose_codec(struct session *session, const struct codec_list *codecs, struct message_error *error);
void session_choose_again(struct session *session, int64_t now_ns); /* as bandwidth and processors are by now */
void session_reply_error(struct session *session, const struct message_error *error);
/* session_hello.c: who it is, whether there is room, what it looks at. False: *error, and session->close_code if it is not let in. */
bool session_hello(struct session *session, const struct message *message, int64_t now_ns, int64_t now_utc_ns, struct message_error *error);
/* session_room.c: whether its view may have this size; if so it is counted. */
bool session_reserve_pixels(struct session *session, int width_px, int height_px, struct message_error *error);
void session_release_pixels(struct session *session);
bool session_has_pixels(const struct session *session);
void session_on_visible(struct session *session, bool visible, int64_t now_ns);
void session_keep_pixels(struct session *session, int64_t now_ns); /* every tick */
bool session_apply_params(const struct session *session, const struct message *message, struct view *view, struct message_error *error);

void session_on_input(struct session *session, int64_t now_ns); /* what it is shown changes */
/* session_time.c: it goes to an instant, plays, or comes back. */
bool session_on_time(struct session *session, const struct time_request *wish, int64_t now_ns, int64_t now_utc_ns,
                     struct message_error *error);
void session_time_begin(struct session *session, int64_t at_us, double speed); /* it begins there, not now */
void session_time_end(struct session *session);
void session_time_inherit(struct session *heir, const struct session *session); /* its view is that one's: likewise when */
void session_tell_time(struct session *session);                                /* what it is shown may be of another time than it was */
void session_ask_follow(struct session *session, const struct message *message);
void session_ask_lead(struct session *session, const struct message *message);
void session_pause(struct session *session);    /* nothing moves: keep no picture for it */
void session_on_shown(struct session *session); /* session->pacer.acked is on the client's screen */

/* session_follow.c: what is drawn for it. What a leader tries out is the leader's own affair. */
struct view session_shown(const struct session *session);
/* session_place.c */
bool session_on_place(struct session *session, const struct message *message, int64_t now_ns, struct message_error *error);
bool session_ask_gaps(struct session *session, const struct message *message, struct message_error *error);
bool session_save_tags(struct session *session, const struct message *message, struct message_error *error);
bool session_prove(struct session *session, const struct message *message, struct message_error *error);
void session_place_leave(struct session *session); /* nothing of the plant's is used any more */
const char *session_who(const struct session *session);

void session_time_leave(struct session *session); /* at once, to now; nothing of its moment is used any more */

#endif
