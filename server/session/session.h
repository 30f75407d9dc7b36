/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One client's session: what it is shown and sent, and what it may have. Its state is in session_state.h. Pure: no socket, no clock, no GL;
   time is handed in. Thread: the loop. */
#ifndef SESSION_SESSION_H
#define SESSION_SESSION_H
#include <jansson.h>

#include "base/text/text.h"
#include "session/session_context.h"
#include "session/session_state.h"
#include "session/view/session_view.h"

#define SESSION_MAX_INPUT_BYTES (1024 * 1024) /* beyond that the connection is closed */

/* --- life ------------------------------------------------------------------------------------------------------------- */

/* Makes the session of a new connection. Never NULL. */
struct session *session_create(const struct session_context *context, uint64_t id, int64_t now_ns);
void session_destroy(struct session **session); /* &NULL is fine; leaves NULL */
/* Says who connected; copies it, but client->share must outlive the session. Without it the client may do anything. From then on the first
   frame waits for session_begin, for a second at most. */
void session_introduce(struct session *session, const struct session_client *client);
/* Notes that its connection is lost, before session_destroy: gives its pixels back, and has its leader told. keep: its view is kept for the
   client's return. */
void session_leave(struct session *session, bool keep, int64_t now_ns);
/* Records its end in the audit trail. why: static; NULL: the client went. */
void session_record_leave(const struct session *session, const char *why);
/* Queues answers to actions that are on disk by now, or cannot be kept. Returns whether it queued any. */
bool session_settle(struct session *session);
/* Has the connection closed once the texts owed are sent. text: static. The first reason stands. */
void session_close(struct session *session, int code, const char *text);
/* Returns whether nobody was at the page for longer than the server waits (--lock-after), with *error saying so. A person may be at another
   page of theirs, which openid/ knows: no person is locked here. */
bool session_left_alone(const struct session *session, int64_t now_ns, struct message_error *error);
/* Closes the session if its token was revoked or has expired; else updates its role. */
void session_check_token(struct session *session, int64_t now_ns, int64_t now_utc_ns);
/* Returns the last state of pacing: a client that takes nothing is first sent nothing, then to be disconnected. */
enum pacer_state session_state(const struct session *session, int64_t now_ns);

/* --- the plant is loaded anew ----------------------------------------------------------------------------------------- */

/* Releases all that belongs to the plant. Returns the parameters of its view, as text, for session_take_plant; mem_free. NULL: it has no
   view. */
char *session_carry(struct session *session);
/* Takes the plant that the context now has. carried: what session_carry returned; it is applied as far as its names still exist. */
void session_take_plant(struct session *session, const char *carried);
/* Writes the view that the session will have in the plant of another context. */
void session_view_in(const struct session *session, const struct session_context *context, struct view *out);

/* --- input ------------------------------------------------------------------------------------------------------------ */

/* Takes a text message of the client, acts on it, and queues answers. */
void session_on_message(struct session *session, const char *text, size_t count, int64_t now_ns, int64_t now_utc_ns);
/* Refuses a message of so many bytes, too long to be kept. */
void session_on_oversize(struct session *session, size_t count, int64_t now_ns);
/* Tells the client that it sends too much; the loop reads nothing more from it until this second is over. whose: "" or
   "of this address ". */
void session_too_fast(struct session *session, int64_t count, const char *whose);
/* Does what time alone brings. To be called every 100 ms or so, or once a second while all sessions rest. */
void session_on_tick(struct session *session, int64_t now_ns);
/* Returns since when, on the monotonic clock, the client may not show what is newest: now or a moment ago where it answers and nothing is
   owed to it, else when that was last so, or when the last picture was sent that it acknowledged, whichever is later. */
int64_t session_fresh_ns(const struct session *session);
/* Returns whether session_on_tick() has nothing to do within the next second: no frame is wanted or under way, and no text is due. */
bool session_rests(const struct session *session, int64_t now_ns);
/* Notes that a reading which it is shown changed at data_ns. */
void session_on_data(struct session *session, int64_t data_ns);
/* Notes that sources were connected or lost. */
void session_on_links(struct session *session);
/* Returns whether its client moved within the last second. */
bool session_moves(const struct session *session, int64_t now_ns);

/* --- frames ----------------------------------------------------------------------------------------------------------- */

/* Returns true if a frame is wanted now, with the request in *request. Then, if the render service takes it, call session_requested. */
bool session_next_request(const struct session *session, int64_t now_ns, struct frame_request *request);
/* Notes that the render service took the request; replaced: in place of an earlier one. */
void session_requested(struct session *session, const struct frame_request *request, bool replaced);
/* Has the client told, once, why a frame that it wants signed is not. */
void session_not_signed(struct session *session, const struct message_error *why);
/* Takes over an encoded frame, or the news that there is none. */
void session_on_frame(struct session *session, struct encoded_frame *encoded);
/* Returns whether session_next_frame would return one now. */
bool session_has_frame(const struct session *session);
/* Takes out the next frame to send, which the caller then owns, and writes its number. NULL: none is ready. To be followed by
   session_wrote for each part of it. */
struct encoded_frame *session_next_frame(struct session *session, int64_t now_ns, uint32_t *seq);
/* Notes that the socket took a part of that frame; all: its end. */
void session_wrote(struct session *session, bool all, int64_t now_ns);
/* Returns whether the frame that is being sent is not worth its remaining bytes: the view of a refined frame has changed, or nothing is
   taken at all. */
bool session_gives_up(const struct session *session, const struct encoded_frame *sending, size_t bytes_left, int64_t now_ns);
/* Notes that the frame was cut short. */
void session_gave_up(struct session *session);
/* Takes the first measure of the bandwidth: so many bytes of texts had arrived after took_ns. The first frame is made accordingly. */
void session_begin(struct session *session, size_t bytes, int64_t took_ns);
/* Returns the pacer if its `acked` is a frame that the client has shown since the last call; else NULL. */
const struct pacer *session_take_shown(struct session *session);
/* Takes a measured round trip. */
void session_on_pong(struct session *session, int64_t rtt_ns, int64_t now_ns);

/* Returns the views that a token of some views is for, as [{id, title}]. */
json_t *session_scope_views(const struct session *session);

/* --- texts ------------------------------------------------------------------------------------------------------------ */

/* Returns whether session_next_text would return one now. */
bool session_has_text(const struct session *session, int64_t now_ns);
/* Returns whether that text may list readings: the context's snapshot should be up to date. */
bool session_tags_due(const struct session *session, int64_t now_ns);
/* Appends the next text message to send to `out`. Returns false if none is due. */
bool session_next_text(struct session *session, int64_t now_ns, int64_t now_utc_ns, struct text *out);
/* Queues a text about something that the client asked for. */
void session_say(struct session *session, const char *text);

/* --- picks ------------------------------------------------------------------------------------------------------------ */

/* Returns true if a pixel is to be asked about now, with the question in *query. */
bool session_next_pick(struct session *session, struct pick_query *query);
/* Queues the answer. */
void session_on_pick(struct session *session, const struct pick_answer *answer);

/* --- time travel ------------------------------------------------------------------------------------------------------ */

/* Returns true if readings of an instant are to be loaded now, with it in *at_us. Advances play, which may end in the present. */
bool session_wants_historical_snapshot(struct session *session, int64_t now_ns, int64_t now_utc_ns, int64_t *at_us);
/* Shows the instant, whose readings are in the cache now, if the session waits for any instant: for this one, or for another that it
   travels to. Does nothing if it waits for none. good false (they could not be read), or no longer in the cache: replies with the error
   no_history, stops playing and goes on showing what it showed. */
void session_on_historical_snapshot(struct session *session, int64_t at_us, bool good, int64_t now_ns);

/* --- following -------------------------------------------------------------------------------------------------------- */

/* Shows the leader's view from now on; NULL: its own. */
void session_follow(struct session *session, struct session *leader, int64_t now_ns);
/* Refuses to follow: there is no such session. */
void session_follow_nobody(struct session *session);
/* Notes that the leader's view changed. */
void session_on_leader(struct session *session, int64_t now_ns);
/* Notes that the leader is being destroyed: its last view stays, until the client follows another, or nobody. */
void session_leader_gone(struct session *session, int64_t now_ns);
/* Gives the heir the view of the session, at the heir's own size. */
void session_inherit(struct session *heir, const struct session *session);
/* Refuses to hand over the lead to `heir`: that session does not follow this one. */
void session_lead_nobody(struct session *session, uint64_t heir);
/* Takes out what the client asked about following since the last call. */
struct follow_request session_take_follow_request(struct session *session);
/* Three steps by which all who see one view take the same step of the quality ladder: each of them is to be called for all sessions before
   the next one is. */
void session_clear_steps(struct session *session);
void session_count_step(struct session *session);
void session_choose_step(struct session *session);
/* Has the client told who follows it, by numbers. */
void session_say_followers(struct session *session, const uint64_t *sessions, size_t count, int64_t now_ns);

/* --- tiles of one picture (tile_sync.h) ---------------------------------------------------------------------------- */

bool session_is_tile(const struct session *session);
/* Moves what the display shows of the picture, with the next one, which is sent for that. */
void session_tile_move(struct session *session, struct burn_shift shift, int64_t now_ns);
/* Leaves the session out if it has held up the others for too long, and lets it in again after a while. Returns whether that changed. */
bool session_tile_judge(struct session *session, int64_t now_ns, int64_t now_utc_ns);
/* Tells the session which displays of its wall are there, if that changed. there, late_us: by display, from 0; late_us: since when it is
   left out, UTC, 0: it is not. */
void session_tile_tell(struct session *session, const bool *there, const int64_t *late_us, bool leads);

/* --- placing sensors -------------------------------------------------------------------------------------------------- */

/* Shows new places of its sensors, if distances for them were computed. */
void session_on_placed(struct session *session, int64_t now_ns);
/* Takes out the tag list that is to be put in force; the caller then owns it. NULL: none. */
struct tag_save *session_take_save(struct session *session);
/* Queues the answer to `gaps`. */
void session_on_coverage(struct session *session, const struct sensor_coverage_answer *answer);

#endif
