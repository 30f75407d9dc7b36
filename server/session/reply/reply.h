/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the texts that the server sends: JSON messages of PROTOCOL.md, and bodies of /api answers (HTTP.md). Each function
   returns the message in its name; the caller frees the text with mem_free. Pure. Call only in the event loop. */
#ifndef SESSION_REPLY_REPLY_H
#define SESSION_REPLY_REPLY_H
#include "session/session_context.h"

char *reply_welcome_text(const struct session *session, int64_t now_utc_ns);
/* Returns the parameters of a view as a JSON message: quantity, colour range, hidden assets and so on. open: true: for clients
   without a token; omits names of tags and baselines. */
char *reply_params_text(const struct session_context *context, const struct view *view, uint32_t seq, bool open);
/* Lists the followers of a session, at most REPLY_FOLLOWERS. open: true: for clients without a token; omits names of users. */
enum { REPLY_FOLLOWERS = 256 };
char *reply_followers_text(const struct session *const *followers, size_t count, bool open);
/* Returns the leader, that is, the user whose view this session follows, and whether the leader has left. */
char *reply_following_text(const struct session *session);
/* Lists all readings or, if `all` is false, only those that the client does not have yet (reading.changes differs from `sent`,
   an array by tag). Updates `sent`. */
char *reply_tags_text(const struct plant *plant, const struct snapshot *snapshot, uint32_t *sent, bool all);
/* role: operators and engineers also get what is not recorded, and engineers the state of the standby, if this core leads one. */
char *reply_status_text(const struct session_context *context, enum role role, int64_t now_utc_ns);
char *reply_pong_text(const struct snapshot *snapshot, double t, int64_t now_utc_ns);
char *reply_time_text(const struct session *session);
/* reply_present_text() tells a tile (one display of a wall's picture) at which instant, UTC microseconds, to show its frame
   `seq`; `picture`: id of the wall's picture. reply_tiles_text() lists which displays of the wall are connected, since when
   some are dropped, and which part of the picture this display shows. there, late_us: arrays indexed by display - 1; there: the
   display is connected; late_us: UTC microseconds when it was dropped, 0: not dropped. */
char *reply_present_text(uint32_t seq, uint64_t picture, int64_t at_us);
char *reply_tiles_text(const struct wall *wall, const struct wall_place *place, const struct tile_layout *layout, const bool *there,
                       const int64_t *late_us, bool leads);
/* Lists the named views. id: the view whose earlier versions are listed too; NULL: no earlier versions. */
char *reply_views_text(const struct session_context *context, const char *id);
/* Adds an error to the JSON of a named view whose address is not valid in this plant, for example because of an unknown tag.
   The member `wrong` gets the error's text, `refusal` its code. */
void reply_add_wrong(const struct session_context *context, json_t *view, const char *address);
/* Returns the answer to the message `fit`: the camera that shows the requested object as a whole. */
char *reply_camera_text(const struct camera *camera, uint32_t seq);
/* Returns the answer to a pick (a click on the picture): what is at that pixel. query.seq 0: the answer has no member `seq`. */
char *reply_picked_text(const struct plant *plant, const struct pick_answer *answer);
char *reply_error_text(const struct message_error *error);
char *reply_api_plant_text(const struct session_context *context);
/* Lists `count` tags starting at index `first`, or fewer at the end of the list. */
char *reply_api_tags_text(const struct session_context *context, size_t first, size_t count);

#endif
