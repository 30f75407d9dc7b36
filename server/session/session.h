/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One client's session: the view it shows, the messages it gets and the resources it uses. Its state is in session_state.h.
   Pure: no socket, no clock, no GL; the caller passes the time. Call only in the event loop. */
#ifndef SESSION_SESSION_H
#define SESSION_SESSION_H
#include <jansson.h>

#include "base/text/text.h"
#include "render/depth_grid.h"
#include "session/session_context.h"
#include "session/session_state.h"
#include "session/view/session_view.h"

#define SESSION_MAX_INPUT_BYTES (1024 * 1024) /* largest size in bytes of a message from a client; a longer one closes the connection */

/* --- life cycle ------------------------------------------------------------------------------------------------------ */

/* Makes the session of a new connection. Never returns NULL. */
struct session *session_create(const struct session_context *context, uint64_t id, int64_t now_ns);
void session_destroy(struct session **session); /* destroys the session and sets *session to NULL; accepts a pointer to NULL */
/* Tells the session who connected. Copies `client`; client->share must outlive the session. Without this call, the session has
   all rights. After this call, the first frame waits for session_begin(), for a second at most. */
void session_introduce(struct session *session, const struct session_client *client);
/* Notes that the session's connection is lost; call it before session_destroy(). Returns the view's pixels to the admission
   budget and informs the leader. keep: true: keeps the view for the client's return. */
void session_leave(struct session *session, bool keep, int64_t now_ns);
/* Records in the audit trail that the session ended. why: reason (static text); NULL: the client left by itself. */
void session_record_leave(const struct session *session, const char *why);
/* Queues the answers to actions that have reached the disk (journal, files and audit trail) or could not be written. Returns
   whether it queued any. */
bool session_settle(struct session *session);
/* Destroys a session whose client has gone. First keeps it in the context's list `gone` until it is known whether all its
   actions reached the disk. A failure is thus still recorded in the audit trail. */
void session_retire(struct session **session);
/* For the sessions in the context's list `gone`: records in the audit trail which actions failed to reach the disk, and
   destroys sessions without pending actions. */
void session_settle_gone(struct kept_answers *answers);
/* Makes the event loop close the connection once all queued texts are sent. text: static. If called more than once, the first
   reason counts. */
void session_close(struct session *session, int code, const char *text);
/* Returns true, with the refusal in *error, if the user has been inactive for longer than --lock-after allows. Always false for
   tokens of walls and programs, which nobody attends, and for users who signed in with OpenID Connect: access/openid checks
   their inactivity over all their pages. */
bool session_left_alone(const struct session *session, int64_t now_ns, struct message_error *error);
/* Closes the session if its token was revoked or has expired, or if its user was inactive for too long; otherwise updates the session's
   role from the token. */
void session_check_token(struct session *session, int64_t now_ns, int64_t now_utc_ns);
/* Returns whether frames reach the client (pacer.h). A client that acknowledges nothing first gets no more frames
   (PACER_STALLS), and is then disconnected (PACER_DEAD). */
enum pacer_state session_state(const struct session *session, int64_t now_ns);

/* --- plant reload ---------------------------------------------------------------------------------------------------- */

/* Releases everything that belongs to the old plant. Returns the parameters of the session's view as text for session_take_plant(); the
   caller frees it with mem_free. NULL: the session has no view. */
char *session_carry(struct session *session);
/* Switches to the context's new plant. carried: the view's parameters from session_carry(), by names; names that the new plant
   lacks are skipped. */
void session_take_plant(struct session *session, const char *carried);
/* Writes into *out the view that the session will have after a reload to the plant of `context`. */
void session_view_in(const struct session *session, const struct session_context *context, struct view *out);

/* --- input ------------------------------------------------------------------------------------------------------------ */

/* Parses a text message of the client, acts on it, and queues answers. */
void session_on_message(struct session *session, const char *text, size_t count, int64_t now_ns, int64_t now_utc_ns);
/* Refuses a message of `count` bytes that was too long to be stored. */
void session_on_oversize(struct session *session, size_t count, int64_t now_ns);
/* Tells the client that it sent `count` messages, too many for one second; the event loop reads nothing more from it until this
   second is over. whose: "" if the limit is the client's, "of this address " if it is its address's. */
void session_too_fast(struct session *session, int64_t count, const char *whose);
/* Does the session's timed work, such as playback and the choice of the codec. Call it about every 100 ms, or once a second while
   session_rests() is true for all sessions. */
void session_on_tick(struct session *session, int64_t now_ns);
/* Returns the monotonic time up to which the client's display is known to be current. A client lacks a picture if its view or a
   reading has changed since the picture that it shows. If it lacks none, the result is the time when its last message arrived.
   Otherwise it is the later of two times: when it last lacked no picture, and when its last acknowledged picture was sent. */
int64_t session_fresh_ns(const struct session *session);
/* Returns whether session_on_tick() has nothing to do within the next second: no frame is wanted or in flight, and no text is due. */
bool session_rests(const struct session *session, int64_t now_ns);
/* Notes that a reading that this session shows changed at data_ns (monotonic), which makes a new frame due. */
void session_on_data(struct session *session, int64_t data_ns);
/* Notes that connections to data sources were made or lost. */
void session_on_links(struct session *session);
/* Returns whether the client moved its camera within the last second. */
bool session_moves(const struct session *session, int64_t now_ns);

/* --- frames ----------------------------------------------------------------------------------------------------------- */

/* Returns true if a frame is wanted now, with the request in *request. If the render service accepts that request, call
   session_requested(). */
bool session_next_request(const struct session *session, int64_t now_ns, struct frame_request *request);
/* Notes that the render service accepted a frame request of this session. replaced: it replaced an earlier request of this session. */
void session_requested(struct session *session, const struct frame_request *request, bool replaced);
/* Tells the client once why its frame, which it wants signed, comes unsigned. */
void session_not_signed(struct session *session, const struct message_error *why);
/* Takes ownership of an encoded frame, or of the answer that there is no frame (nothing new, or failed). */
void session_on_frame(struct session *session, struct encoded_frame *encoded);
/* Returns true if a frame is ready to be sent, so that session_next_frame() would return it. */
bool session_has_frame(const struct session *session);
/* Returns whether the client gets depth grids (coarse depth for warping pictures); the message `welcome` tells it so. */
bool session_gets_depth(const struct session *session);
/* depth grids of a frame: none; those that the client already has; new ones, to be sent before the frame */
enum session_depth { SESSION_DEPTH_NONE, SESSION_DEPTH_SENT, SESSION_DEPTH_NEW };
/* Takes the next frame to send out of the session and writes its sequence number to *seq. The caller owns the frame. NULL: none
   is ready. Call session_wrote() after each part of the frame is written. */
struct encoded_frame *session_next_frame(struct session *session, int64_t now_ns, uint32_t *seq, enum session_depth *depth);
/* Notes that the socket accepted a part of the frame being sent. all: true: this was the frame's last part. */
void session_wrote(struct session *session, bool all, int64_t now_ns);
/* Returns whether the rest of the frame being sent is not worth sending: the view of a refined frame has changed, the page is hidden, or
   the client acknowledges nothing at all. Always false for an H.264 frame. */
bool session_gives_up(const struct session *session, const struct encoded_frame *sending, size_t bytes_left, int64_t now_ns);
/* Notes that the frame being sent was cut short. */
void session_gave_up(struct session *session);
/* Records the first bandwidth measurement: `bytes` bytes of texts had arrived took_ns after they were sent. Chooses the quality
   of the first frame from this measurement. */
void session_begin(struct session *session, size_t bytes, int64_t took_ns);
/* Returns the pacer, with the frame in pacer->acked, if the client acknowledged a frame since the last call; otherwise NULL. */
const struct pacer *session_take_shown(struct session *session);
/* Records a measured round-trip time between server and client. */
void session_on_pong(struct session *session, int64_t rtt_ns, int64_t now_ns);

/* Returns the address of the view `id`, a view of the plant file or one that a user saved, if the user may see it. The address
   is valid until the saved views change. Returns NULL with *error, which names the member `about`, if there is no such view. */
const char *session_scope_find_view(const struct plant_services *services, enum role role, const struct token_holder *holder,
                                    const char *id, const char *about, struct message_error *error);
/* Returns, as a JSON array of {id, title}, those views of the plant file that the user's narrowed token allows (a token that
   allows only some views). The caller owns the array. */
json_t *session_scope_views(const struct session *session);

/* --- texts ------------------------------------------------------------------------------------------------------------ */

/* Returns whether session_next_text() has a message to send now. */
bool session_has_text(const struct session *session, int64_t now_ns);
/* Returns whether the next text may list readings; the caller then refreshes the context's snapshot first. */
bool session_tags_due(const struct session *session, int64_t now_ns);
/* Appends the next text message to send to `out`. Returns false if none is due. */
bool session_next_text(struct session *session, int64_t now_ns, int64_t now_utc_ns, struct text *out);
/* Queues a copy of a text that answers a request of the client. */
void session_say(struct session *session, const char *text);

/* --- picks (what is at a pixel) -------------------------------------------------------------------------------------- */

/* Returns true if a pick (query for what is at a pixel) waits to be sent to the render service, and writes it to *query. */
bool session_next_pick(struct session *session, struct pick_query *query);
/* Queues the answer to a pick (what is at a pixel) for the client. */
void session_on_pick(struct session *session, const struct pick_answer *answer);

/* --- time travel ------------------------------------------------------------------------------------------------------ */

/* Returns true if the readings of an instant should be loaded now, with the instant in *at_us. Advances playback, which may end in the
   present. */
bool session_wants_historical_snapshot(struct session *session, int64_t now_ns, int64_t now_utc_ns, int64_t *at_us);
/* Call it when loading the readings of at_us has ended. If the session waits for an instant, it now shows at_us, even if the
   client has since requested another instant. Otherwise does nothing. If `good` is false (loading failed) or the snapshot is no
   longer in the cache, replies with the error no_history, stops playback and leaves the view unchanged. */
void session_on_historical_snapshot(struct session *session, int64_t at_us, bool good, int64_t now_ns);

/* --- following -------------------------------------------------------------------------------------------------------- */

/* Shows the leader's view from now on; leader NULL: shows the session's own view. */
void session_follow(struct session *session, struct session *leader, int64_t now_ns);
/* Replies that the session to follow does not exist. */
void session_follow_nobody(struct session *session);
/* Call it when the view of the leader that this session follows has changed: tells the client so and requests a new frame. */
void session_on_leader(struct session *session, int64_t now_ns);
/* Notes that the leader is about to be destroyed. The session keeps showing the leader's last view until the client follows
   another session or nobody. */
void session_leader_gone(struct session *session, int64_t now_ns);
/* Copies the view of `session` to the session `heir`, which becomes the leader whose view others follow. The heir keeps its own
   picture size. */
void session_inherit(struct session *heir, const struct session *session);
/* Replies that the lead cannot be handed over, because the requested heir does not follow this session. */
void session_lead_nobody(struct session *session);
/* Returns the client's request about following (follow or hand over the lead) and clears it. */
struct follow_request session_take_follow_request(struct session *session);
/* Three functions that give all sessions of one view a common step of the quality ladder. Call the first for all sessions, then
   the second, then the third: clear, count, choose. */
void session_clear_steps(struct session *session);
void session_count_step(struct session *session);
void session_choose_step(struct session *session);
/* Queues the list of the session's followers for the client. */
void session_say_followers(struct session *session, const struct session *const *followers, size_t count, int64_t now_ns);

/* --- tiles of a picture over many displays (tile_sync.h) -------------------------------------------------------------- */

bool session_is_tile(const struct session *session);
/* Shifts the part of the picture that this display shows, as burn-in protection. Requests a new picture, with which the shift
   takes effect. */
void session_tile_move(struct session *session, struct burn_shift shift, int64_t now_ns);
/* Drops the tile (one display's part of a wall's picture) from its wall if it has delayed the others for too long, and readmits
   it after a pause. Returns true if it did either. */
bool session_tile_judge(struct session *session, int64_t now_ns, int64_t now_utc_ns);
/* Tells the client which displays of its wall are connected, if that changed. there: [display - 1]: true: connected. late_us:
   [display - 1]: UTC microseconds when that display's tile was dropped; 0: it takes part. leads: this session leads the wall. */
void session_tile_tell(struct session *session, const bool *there, const int64_t *late_us, bool leads);

/* --- placing sensors -------------------------------------------------------------------------------------------------- */

/* Requests a new picture, because the geodesic distances of the sensors that the engineer is trying out at other positions are
   now computed. */
void session_on_placed(struct session *session, int64_t now_ns);
/* Removes from the session a tag list that is to be activated by a reload, and returns it; the caller owns it. NULL: there is none. */
struct tag_save *session_take_save(struct session *session);
/* Queues the answer to the client's message `gaps`, which asks for the surface areas that are far from every sensor or have no
   data. */
void session_on_coverage(struct session *session, const struct sensor_coverage_answer *answer);

#endif
