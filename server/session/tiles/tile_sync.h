/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sessions that are tiles of one picture over many displays (`tile` of the plant file). One of them leads: the others follow it. The
   picture is asked for by all at once, drawn once, cut, and shown once all have it, at one instant: no tile is ever ahead of the others.
   Who takes too long is left out for a while, and told so. Pure; time is handed in. Thread: the loop. */
#ifndef SESSION_TILES_TILE_SYNC_H
#define SESSION_TILES_TILE_SYNC_H
#include "session/session.h"

/* Returns whether a tile takes part now: it is on a screen, and keeps up. */
bool session_tile_takes_part(const struct session *session, int64_t now_ns);

struct session_tiles { /* of one wall: those that take part, and one that leads */
    struct session *const *members;
    size_t count;
    const struct session *leader;
    struct quality_ladder *made; /* of the wall: its size follows how long the server takes for pictures of it */
};

/* Returns whether all may be sent another picture, or another in place of one under way, and one of them wants it; then with everyone's
   request: equal views, in the quality that the slowest can take, the
   server among them. number: of that picture, larger than before. Once the service takes
   them, session_requested() is to be called. */
bool session_tiles_next_request(const struct session_tiles *tiles, uint64_t number, int64_t now_ns, struct frame_request requests[]);
/* Has all show the newest picture that all have, if that is newer than *presented, at one instant. Where nothing is under way and some have
   pictures that others have not, all want another one. */
void session_tiles_present(const struct session_tiles *tiles, uint64_t *presented, int64_t now_ns, int64_t now_utc_ns);

#endif
