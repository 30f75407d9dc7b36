/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions that the session's source files share. Private to session_*.c. Call only in the event loop. */
#ifndef SESSION_SESSION_IMPL_H
#define SESSION_SESSION_IMPL_H
#include "base/files/settling.h"
#include "session/session.h"

/* --- session_answers.c ------------------------------------------------------------------------------------------------ */

/* Queues a text to be sent to the client; takes ownership of the text (mem_free). */
void session_reply(struct session *session, char *text);
/* Counts an error in the session's statistics, and queues its message for the client. */
void session_reply_error(struct session *session, const struct message_error *error);
/* Frees the frames of this session that are encoded but not sent yet. */
void session_drop_ready(struct session *session);
/* Returns whether a request is for a preview of a moving camera, whose time the pacer measures. */
static inline bool session_times(const struct frame_request *request)
{
    return request->view.tier == TIER_PREVIEW && request->urgency == URGENCY_INPUT && !request->of_data;
}
/* Notes that an input changed the view: a preview is due now, and a refined (detailed) frame once the camera rests. */
void session_on_input(struct session *session, int64_t now_ns);
/* Returns the user's name for journals and lists; "local" without a token. */
const char *session_who(const struct session *session);

/* --- session_audit.c: entries for the audit trail ----------------------------------------------------------------------- */

/* Each function describes an action in words, for the audit trail; the caller frees the text with mem_free. answer: the
   server's answer to the client. */
char *session_alarm_what(const struct session *session, const struct message *message);
char *session_loop_check_what(const struct session *session, const struct message *message, const char *answer);
char *session_view_what(const struct message *message);
char *session_note_what(const struct session *session, const struct message *message);
char *session_wall_what(const struct message *message);
/* Records an action in the audit trail. event: "alarm", "view", "note", "wall", "device" or "proof". */
void session_record_action(const struct session *session, const char *event, const char *what, const char *answer);
/* Records that a tag list is being activated: by save_tags with `moved` moved sensors, by accept_places or by restore_tags. */
void session_record_save(const struct session *session, const struct message *message, size_t moved);
/* If the message's parameters save or remove baselines (stored readings that differences are shown against) for all users,
   records that in the audit trail. */
void session_record_params(const struct session *session, const struct message *message);
/* Records in the audit trail that an action could not be written to disk. */
void session_record_not_kept(const struct session *session, const char *event, const char *what, const char *why);
/* Records an error in the audit trail if the client lacked the right to do what it requested. */
void session_record_refusal(const struct session *session, const struct message_error *error);

/* --- session_kept.c: answers that wait for the disk ---------------------------------------------------------------------- */

struct kept_action {
    struct settling_ticket journal, file, audit;
};
/* Notes how many rows the alarm journal, the saved files (views, notes) and the audit trail have before an action is carried
   out. Pass the result to session_kept_reply(), which answers once the rows that the action added are on disk. */
struct kept_action session_kept_begin(const struct session *session);
/* Records the action in the audit trail, and queues the answer once journal, file and audit trail have the action on disk. If
   that fails or takes more than a second, the answer says so: `not_kept` for an action on alarms, otherwise `kept` false, and
   `unaudited`. Takes ownership of `answer` and `what`. event: as in session_record_action(); static. */
void session_kept_reply(struct session *session, const struct kept_action *action, const char *event, char *what, char *answer);
/* Returns whether an action is still pending: not known yet to be on disk, or to have failed. */
bool session_kept_waits(const struct session *session);
/* Frees all answers that still wait for the disk, without sending them. */
void session_kept_drop(struct session *session);

/* --- session_hello.c -------------------------------------------------------------------------------------------------- */

/* Acts on `hello`: checks the token, admits the session and sets its first view. If the session is refused, returns false with *error, and
   sets session->close unless the client may send another hello. */
bool session_hello(struct session *session, const struct message *message, int64_t now_ns, int64_t now_utc_ns, struct message_error *error);
/* Returns whether the session may act as display `place`; a paired device may act only as the display that it was paired for.
   If not, sets *error and closes the session. */
bool session_may_be(struct session *session, const struct wall_place *place, struct message_error *error);

/* --- session_scope.c: tokens limited to views of the plant file, or to a display of a wall --- */

/* Returns whether the token allows the client to send that message. If not, *error says why. */
bool session_scope_allows(const struct session *session, const struct message *message, struct message_error *error);
/* For a paired device: limits the session to what the plant file has its display show. Call it at hello, and again after a plant reload. */
void session_scope_begin(struct session *session);
void session_scope_end(struct session *session);
/* Sets the view to the named view with this id, keeping the view's size. Returns false with *error if the token does not allow
   the named view, or it cannot be shown. */
bool session_look(struct session *session, const char *id, struct view *view, struct message_error *error);
/* Sets the view to a new view of the plant, keeping the view's size and backdrop. */
void session_look_new(const struct session *session, struct view *view);
/* Sets the view with this id, for a token that permits only some views; id "": the first view that the token allows. Closes the
   session if the view cannot be set. */
bool session_scope_view(struct session *session, const char *id, struct view *view, struct message_error *error);
/* Gives the smallest allowed picture size to a paired display that shows only trends or alarms, no picture of the plant. */
void session_scope_fit(const struct session *session, struct view *view);
/* Takes ownership of a JSON message that is about to be sent (mem_free). Returns it without the list items that a narrowed
   token may not see. */
char *session_scope_text(const struct session *session, char *text);

/* --- session_life.c ---------------------------------------------------------------------------------------------------- */

/* Frees everything of the plant that the session holds. Afterwards only the session's answers and identity may be used. */
void session_let_go(struct session *session);
/* Stores the client's token if this daemon is a renderer: a renderer forwards actions to its core, which verifies the token itself. */
void session_keep_token(struct session *session, const char *token);
/* Forgets which depth grids the client has, so that the next frame's grids are sent in any case. */
void session_forget_depth(struct session *session);

/* --- session_frames.c ------------------------------------------------------------------------------------------------- */

/* Returns whether drawing may begin: the session no longer waits for the first bandwidth measurement or for the recorded readings of a past
   instant. */
bool session_begun(const struct session *session, int64_t now_ns);
/* Returns whether a frame is wanted now, with the request in *request. Ignores how many frames are in flight. */
bool session_wants(const struct session *session, int64_t now_ns, struct frame_request *request);
/* Drops the frames that are encoded and not sent yet, because the client acknowledges nothing. They are requested again once it does. */
void session_pause(struct session *session);
/* Notes that the frame delivery.pacer.acked is on the client's screen. */
void session_on_shown(struct session *session);
/* Stores the list of codecs that the client decodes, and uses the first one that this server can encode. Returns false with
   *error if there is no such codec. */
bool session_choose_codec(struct session *session, const struct codec_list *codecs, struct message_error *error);
/* Makes the server sign the session's frames from now on, as the message asks. Returns false with *error if this server cannot sign. */
bool session_choose_signed(struct session *session, enum signed_frames frames, struct message_error *error);
/* Chooses the codec again from bandwidth and processor load, if the client leaves the choice to the server. */
void session_choose_again(struct session *session, int64_t now_ns);

/* --- session_admission.c ---------------------------------------------------------------------------------------------- */

/* Reserves a view of that size in the admission budget, replacing the session's last reservation. Returns false with *error if
   that exceeds a limit. */
bool session_reserve_pixels(struct session *session, int width_px, int height_px, struct message_error *error);
/* Gives the pixels reserved by the session back to the admission budget. */
void session_release_pixels(struct session *session);
/* Returns whether the session holds pixels for its view, so that frames may be drawn. */
bool session_has_pixels(const struct session *session);
/* Acts on the message `visible`, which says whether the client's page is on screen. A hidden page gets no frames. */
void session_on_visible(struct session *session, bool visible, int64_t now_ns);
/* Returns the session's pixels to the admission budget once the page has been hidden for a while, and reserves them again when it is shown.
   Call it every tick. */
void session_keep_pixels(struct session *session, int64_t now_ns);

/* --- session_time.c --------------------------------------------------------------------------------------------------- */

/* Acts on the message `time`: goes to an instant, plays, or returns to the present. Returns false with *error if that is not possible. */
bool session_on_time(struct session *session, const struct time_request *request, int64_t now_ns, int64_t now_utc_ns,
                     struct message_error *error);
/* Makes a new session start at an instant of the past. at_us 0 or in the future: does nothing. If no history is
   recorded, only replies with an error. */
void session_time_begin(struct session *session, int64_t at_us, double speed, int64_t now_utc_ns);
/* Releases the recorded readings of the past instant that the session shows. */
void session_time_end(struct session *session);
/* Returns to the present immediately, even while an instant is being loaded. */
void session_time_leave(struct session *session);
/* Copies the past instant and the playback of `session` to the session that takes over its lead. */
void session_time_inherit(struct session *heir, const struct session *session);
/* Queues the message that tells the client which instant is shown. */
void session_tell_time(struct session *session);

/* --- session_follow.c ------------------------------------------------------------------------------------------------- */

/* Each function stores a request of the client: to follow a session, or to hand over the lead. The event loop carries it out. */
void session_ask_follow(struct session *session, const struct message *message);
void session_ask_lead(struct session *session, const struct message *message);
/* Ends the display of the last view of a leader who has gone, and returns to the session's own view. */
void session_come_to_own(struct session *session);

/* --- session_plant.c -------------------------------------------------------------------------------------------------- */

/* Describes a view as text, by names of tags and assets, for session_look_again(). Omits parameters that have their default value. The
   caller frees the text with mem_free. */
char *session_carried_text(const struct session_context *context, const struct view *view);
/* Restores a view after a plant reload: size and camera from `before`, everything else from the text `carried`, skipping what
   the new plant lacks. */
void session_look_again(struct session *session, const struct view *before, const char *carried);

/* --- tile_session.c --------------------------------------------------------------------------------------------------- */

/* Sets the view of a tile (one display's part of a wall's picture) to the size of the whole picture, computed from the size of
   one display. Returns false if the plant no longer has such a tile. */
bool session_tile_fit(const struct session *session, const struct wall_place *place, int width_px, int height_px, struct view *view,
                      struct tile_layout *layout);
/* For tiles (displays that show parts of one picture). session_tile_unchanged(): call it when a request was answered without a frame
   because the client already shows the content. session_tile_sent(): call it when a frame is being sent. */
void session_tile_unchanged(struct session *session, uint64_t picture);
void session_tile_sent(struct session *session, uint64_t picture, uint32_t seq);
/* For tiles (displays that show parts of one picture): call it when a frame arrived from the render service. If an earlier
   answer "unchanged" referred to this frame, the frame also gets the picture id of that answer. */
void session_tile_came(struct session *session, struct frame_request *request, int64_t made_ns);

/* --- session_place.c -------------------------------------------------------------------------------------------------- */

/* Each function carries out a message: `place`, `gaps`, `save_tags` (also accept_places and restore_tags) or `prove` (loop
   checks). Returns false with *error if the request is refused. */
bool session_on_place(struct session *session, const struct message *message, int64_t now_ns, struct message_error *error);
bool session_ask_coverage(struct session *session, const struct message *message, struct message_error *error);
bool session_save_tags(struct session *session, const struct message *message, struct message_error *error);
bool session_check_loop(struct session *session, const struct message *message, struct message_error *error);
/* Forgets the sensors that the engineer moved to try out other positions; afterwards session->placement has no pointer into the
   plant. */
void session_place_leave(struct session *session);

#endif
