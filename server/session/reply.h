/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the server says in text: JSON messages of PROTOCOL.md and the bodies of /api. Pure. Every result is freed with mem_free. */
#ifndef SESSION_REPLY_H
#define SESSION_REPLY_H
#include "message/message.h"
#include "session/session.h"

char *reply_welcome_text(const struct session *session, int64_t now_utc_ns);
/* open: for anyone who looks on, without names of tags and of baselines. */
char *reply_params_text(const struct session_context *world, const struct view *view, uint32_t seq, bool open);
/* Who follows; at most REPLY_FOLLOWERS of them by number. */
enum { REPLY_FOLLOWERS = 256 };
char *reply_followers_text(const uint64_t *sessions, size_t count);
/* Whose view it is shown; where that one has gone, so it says. */
char *reply_following_text(const struct session *session);
/* All values, or those that differ from `sent` (reading.changes by tag index), which is brought up to date. */
char *reply_tags_text(const struct plant *plant, const struct snapshot *snapshot, uint32_t *sent, bool all);
char *reply_status_text(const struct session_context *world, int64_t now_utc_ns);
char *reply_pong_text(const struct snapshot *snapshot, double t, int64_t now_utc_ns);
char *reply_time_text(const struct session *session);
char *reply_camera_text(const struct camera *camera, uint32_t seq);                   /* of a fit */
char *reply_picked_text(const struct plant *plant, const struct pick_answer *answer); /* order.seq 0: of nobody's */
char *reply_error_text(const struct message_error *error);
char *reply_api_plant_text(const struct session_context *world);
/* count tags from index `first` on, fewer where there are no more. */
char *reply_api_tags_text(const struct session_context *world, size_t first, size_t count);

#endif
