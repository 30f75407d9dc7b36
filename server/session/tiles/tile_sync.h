/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Synchronises sessions that are tiles of one picture over many displays (`tile` of the plant file). One session leads and the
   others follow it. All request a picture together. It is drawn once, cut into tiles, and shown at one instant once every
   client has it, so no tile is ahead of the others. A tile that delays the rest is dropped for a while, and its client is
   informed. Pure; the caller passes the time. Call only in the event loop. */
#ifndef SESSION_TILES_TILE_SYNC_H
#define SESSION_TILES_TILE_SYNC_H
#include "session/session.h"

/* Returns whether a tile (display with a part of the wall's picture) takes part now: its page is visible, and it acknowledges
   pictures fast enough. */
bool session_tile_takes_part(const struct session *session, int64_t now_ns);

struct session_tiles { /* tiles that take part in a wall's picture (neither dropped nor hidden), and the session that leads them */
    struct session *const *members;
    size_t count;
    const struct session *leader;
    struct picture_size *made; /* size of the wall's picture; depends on how long the server takes to make the pictures */
};

/* If a member wants a new picture of the wall, and one may be requested now (or may replace one in flight), fills requests[]
   with one request per member and returns true. All requests have the same view, and a quality that even the slowest client and
   the server can keep up with. number: sequence number of the new picture, larger than the last. Call session_requested() once
   the render service accepts the requests. */
bool session_tiles_next_request(const struct session_tiles *tiles, uint64_t number, int64_t now_ns, struct frame_request requests[]);
/* Makes all members show, at one instant, the newest picture that every member has, if its number exceeds *presented. If nothing is in
   flight and some members have pictures that others lack, requests another picture for all. */
void session_tiles_present(const struct session_tiles *tiles, uint64_t *presented, int64_t now_ns, int64_t now_utc_ns);

#endif
