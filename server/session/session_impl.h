/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions that the files of a session share. Private to session_*.c. Thread: the loop. */
#ifndef SESSION_SESSION_IMPL_H
#define SESSION_SESSION_IMPL_H
#include "base/files/settling.h"
#include "session/session.h"

/* --- session_state.c -------------------------------------------------------------------------------------------------- */

/* Queues a text for the client; takes it (mem_free). */
void session_reply(struct session *session, char *text);
/* Counts an error and queues its text. */
void session_reply_error(struct session *session, const struct message_error *error);
/* Notes that what is shown changed by an input: a preview is due, and later a refined frame. */
void session_on_input(struct session *session, int64_t now_ns);
/* Returns the user's name, for journals and lists; "local" without a token. */
const char *session_who(const struct session *session);

/* --- session_audit.c: the audit trail is told --------------------------------------------------------------------------- */

/* Record what was done to alarms, a loop check, a view with a name, a note, or a wall. answer: the message that the client is sent. */
void session_record_alarm(const struct session *session, const char *what, const char *answer);
/* Describes an action on alarms for the audit trail; mem_free. */
char *session_alarm_what(const struct session *session, const struct message *message);
void session_record_loop_check(const struct session *session, const struct message *message, const char *answer);
void session_record_view(const struct session *session, const struct message *message, const char *answer);
void session_record_note(const struct session *session, const struct message *message, const char *answer);
void session_record_pair(const struct session *session, const struct message *message, const char *id, const char *answer);
void session_record_wall(const struct session *session, const struct message *message, const char *answer);
/* Records that a tag list is to be put in force: by save_tags with so many moved sensors, by accept_places or by restore_tags. */
void session_record_save(const struct session *session, const struct message *message, size_t moved);
/* Records baselines that were kept or forgotten for all, if the message's parameters do that. */
void session_record_params(const struct session *session, const struct message *message);
/* Records that an action on alarms, which is in force, is not on disk. */
void session_record_not_kept(const struct session *session, const char *what, const char *why);
/* Records an error, if it says that the client may not do what it asked for. */
void session_record_refusal(const struct session *session, const struct message_error *error);

/* --- session_kept.c: answers that wait for the disk ---------------------------------------------------------------------- */

struct kept_action {
    struct settling_ticket journal, audit;
};
/* Call it before an action is done and recorded. */
struct kept_action session_kept_begin(const struct session *session);
/* Queues the answer, once journal and audit trail have the action on disk. After a second, or where they cannot be written, the answer says
   so in `not_kept` and `unaudited`. Takes the answer. alarm_what: what was done to alarms, also taken; NULL: something else was done. */
void session_kept_reply(struct session *session, const struct kept_action *action, char *answer, char *alarm_what);
/* Frees answers that still wait. */
void session_kept_drop(struct session *session);

/* --- session_hello.c -------------------------------------------------------------------------------------------------- */

/* Acts on `hello`: checks the token, admits the session and sets its first view. Returns false with *error, and session->close set if it is
   not let in. */
bool session_hello(struct session *session, const struct message *message, int64_t now_ns, int64_t now_utc_ns, struct message_error *error);
/* Applies the parameters of a message to a view: all, or none with *error and false. */
bool session_apply_params(const struct session *session, const struct message *message, struct view *view, struct message_error *error);

/* --- session_scope.c: tokens that are narrowed to views of the plant file, or to a wall's display ------------------------- */

/* Returns whether the token lets the client send that message. If not, *error says why. */
bool session_scope_allows(const struct session *session, const struct message *message, struct message_error *error);
/* Begins with what the plant's display shows, for a device that was paired; again where the plant was loaded anew. */
void session_scope_begin(struct session *session);
void session_scope_end(struct session *session);
/* Has the view be that of the plant file with this id, at its own size. Returns false, with *error, if the token is not for it, or it
   cannot be shown. */
bool session_look(struct session *session, const char *id, struct view *view, struct message_error *error);
/* Likewise, for a token of some views; id "": the first of them. The session is closed where it cannot. */
bool session_scope_view(struct session *session, const char *id, struct view *view, struct message_error *error);
/* Cuts the view of a display that has no pane of pictures. */
void session_scope_fit(const struct session *session, struct view *view);
/* Takes a text that is to be sent (mem_free), and returns what of it the client may read. */
char *session_scope_text(const struct session *session, char *text);

/* --- session.c --------------------------------------------------------------------------------------------------------- */

/* Keeps the client's token where what people do is handed on: the core verifies it. */
void session_keep_token(struct session *session, const char *token);

/* Returns whether the session may be that display: a device that was paired is the display that it was paired as. Else *error is set and
   the session closes. */
bool session_may_be(struct session *session, const struct wall_place *place, struct message_error *error);

/* --- session_frames.c ------------------------------------------------------------------------------------------------- */

/* Returns whether it does not wait for the first measure of the bandwidth, or for readings of an instant. */
bool session_begun(const struct session *session, int64_t now_ns);
/* Returns whether a frame is wanted now, and which, whatever may be under way. */
bool session_wants(const struct session *session, int64_t now_ns, struct frame_request *request);
/* Drops the frames that were not sent yet. */
void session_drop_ready(struct session *session);
/* Drops them, to be drawn anew, while the client takes nothing. */
void session_pause(struct session *session);
/* Notes that delivery.pacer.acked is on the client's screen. */
void session_on_shown(struct session *session);
/* Takes the client's list of codecs and uses the first that works here. Returns false with *error if none does. */
bool session_choose_codec(struct session *session, const struct codec_list *codecs, struct message_error *error);
/* Has frames come signed from now on. Returns false with *error if they cannot. */
bool session_choose_signed(struct session *session, enum signed_frames frames, struct message_error *error);
/* Chooses again by bandwidth and processors, where the client lets the server choose. */
void session_choose_again(struct session *session, int64_t now_ns);

/* --- session_admission.c ---------------------------------------------------------------------------------------------- */

/* Counts a view of that size in place of the last one. Returns false with *error if that is more than the limits allow. */
bool session_reserve_pixels(struct session *session, int width_px, int height_px, struct message_error *error);
/* Gives its pixels back. */
void session_release_pixels(struct session *session);
/* Returns whether its view is counted, so that frames may be drawn. */
bool session_has_pixels(const struct session *session);
/* Acts on the message `visible`, which says whether the client's page is on a screen: a hidden one gets no frames. */
void session_on_visible(struct session *session, bool visible, int64_t now_ns);
/* Gives pixels back while the page is hidden, and takes them again. Every tick. */
void session_keep_pixels(struct session *session, int64_t now_ns);

/* --- session_time.c --------------------------------------------------------------------------------------------------- */

/* Acts on `time`: goes to an instant, plays, or comes back to now. Returns false with *error if it cannot. */
bool session_on_time(struct session *session, const struct time_request *request, int64_t now_ns, int64_t now_utc_ns,
                     struct message_error *error);
/* Has a new session begin at an instant. */
void session_time_begin(struct session *session, int64_t at_us, double speed);
/* Gives the reference on historical readings back. */
void session_time_end(struct session *session);
/* Comes back to now at once. */
void session_time_leave(struct session *session);
/* Gives the heir the instant, and the play, of the session. */
void session_time_inherit(struct session *heir, const struct session *session);
/* Has the client told which instant it is shown. */
void session_tell_time(struct session *session);

/* --- session_follow.c ------------------------------------------------------------------------------------------------- */

/* Note what `follow` and `lead` ask for; the loop resolves it. */
void session_ask_follow(struct session *session, const struct message *message);
void session_ask_lead(struct session *session, const struct message *message);

/* --- session_plant.c -------------------------------------------------------------------------------------------------- */

/* Returns what is seen, by names, for session_look_again(); mem_free. */
char *session_carried_text(const struct session_context *context, const struct view *view);
/* Gives a session the size and camera of `before` and what was carried, as far as its plant has that. */
void session_look_again(struct session *session, const struct view *before, const char *carried);

/* --- tile_session.c --------------------------------------------------------------------------------------------------- */

/* Sets the size of the view by that of the display: all of the picture. Returns false if the plant has no such tile (any more). */
bool session_tile_fit(const struct session *session, const struct wall_place *place, int width_px, int height_px, struct view *view,
                      struct tile_layout *layout);
/* Note that the answer to a request came without a picture, as the client shows that already; that a frame goes out. */
void session_tile_unchanged(struct session *session, uint64_t picture);
void session_tile_sent(struct session *session, uint64_t picture, uint32_t seq);
/* Notes that a frame came, which is also what an answer without one was the same as. */
void session_tile_came(struct session *session, struct frame_request *request, int64_t made_ns);

/* --- session_place.c -------------------------------------------------------------------------------------------------- */

/* Act on `place`, `gaps`, `save_tags` (also accept_places and restore_tags) and `prove`. Return false with *error if they are refused. */
bool session_on_place(struct session *session, const struct message *message, int64_t now_ns, struct message_error *error);
bool session_ask_coverage(struct session *session, const struct message *message, struct message_error *error);
bool session_save_tags(struct session *session, const struct message *message, struct message_error *error);
bool session_check_loop(struct session *session, const struct message *message, struct message_error *error);
/* Drops sensors moved on trial; nothing of the plant is used any more. */
void session_place_leave(struct session *session);

#endif
