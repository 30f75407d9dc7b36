/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The texts that the server sends: JSON messages of PROTOCOL.md and the bodies of /api. Each function returns the message it is named
   after; mem_free. Pure. Thread: the loop. */
#ifndef SESSION_REPLY_REPLY_H
#define SESSION_REPLY_REPLY_H
#include "session/session_context.h"

char *reply_welcome_text(const struct session *session, int64_t now_utc_ns);
/* open: for clients without a token, who are told no names of tags and baselines. */
char *reply_params_text(const struct session_context *context, const struct view *view, uint32_t seq, bool open);
/* Lists who follows a session; at most REPLY_FOLLOWERS of them by number. */
enum { REPLY_FOLLOWERS = 256 };
char *reply_followers_text(const uint64_t *sessions, size_t count);
/* Says whose view the session is shown, and whether that one has gone. */
char *reply_following_text(const struct session *session);
/* Lists all values, or those that changed since `sent` (reading.changes by tag), which is updated. */
char *reply_tags_text(const struct plant *plant, const struct snapshot *snapshot, uint32_t *sent, bool all);
char *reply_status_text(const struct session_context *context, int64_t now_utc_ns);
char *reply_pong_text(const struct snapshot *snapshot, double t, int64_t now_utc_ns);
char *reply_time_text(const struct session *session);
/* Says when a tile is to show the frame seq, which is the wall's picture of that number; which displays of its wall are there, by display
   from 0, since when some are left out, and which part of the picture is this one's. */
char *reply_present_text(uint32_t seq, uint64_t picture, int64_t at_us);
char *reply_tiles_text(const struct wall *wall, const struct wall_place *place, const struct tile_layout *layout, const bool *there,
                       const int64_t *late_us, bool leads);
/* Lists the views with names; id: also the earlier versions of that one (NULL: of none). */
char *reply_views_text(const struct session_context *context, const char *id);
/* Adds to a view with a name, as `wrong`, what its address names that this plant does not have, if there is something. */
void reply_add_wrong(const struct session_context *context, json_t *view, const char *address);
/* Answers a fit. */
char *reply_camera_text(const struct camera *camera, uint32_t seq);
/* Answers a pick; query.seq 0: without a number. */
char *reply_picked_text(const struct plant *plant, const struct pick_answer *answer);
char *reply_error_text(const struct message_error *error);
char *reply_api_plant_text(const struct session_context *context);
/* Lists `count` tags from index `first` on, or as many as there are. */
char *reply_api_tags_text(const struct session_context *context, size_t first, size_t count);

#endif
