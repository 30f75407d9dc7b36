/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One tile of a picture over many displays: its size, the pictures that its client has, and whether it delays other tiles. */
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "session/reply/reply.h"
#include "session/session_impl.h"

/* how long the other displays of the wall wait for a tile to acknowledge its frame before the tile is dropped */
static const int64_t MAX_LATE_NS = 3 * NS_PER_S;
/* OUT_NS: how long a slow tile (display) is dropped from the wall's picture; doubled each time up to MAX_OUT_NS */
static const int64_t OUT_NS = 10 * NS_PER_S, MAX_OUT_NS = 320 * NS_PER_S;
/* A tile that was dropped for a long time has this long to prove itself: if it keeps up for this time after its readmission,
   its next dropping lasts only OUT_NS again. */
static const int64_t KEPT_UP_NS = 60 * NS_PER_S;

bool session_is_tile(const struct session *session)
{
    return session->tile.place.display > 0;
}

bool session_tile_fit(const struct session *session, const struct wall_place *place, int width_px, int height_px, struct view *view,
                      struct tile_layout *layout)
{
    const struct wall *wall = wall_find(session->context->plant, place->wall);
    if (!wall || place->display > wall->tile.columns * wall->tile.rows)
        return false;
    struct burn_shift shift = layout->shift;
    tile_layout_init(layout, wall, width_px, height_px, session->context->quotas->at[QUOTA_SESSION_PIXELS]);
    layout->shift = shift;
    view->width_px = tile_layout_width(layout);
    view->height_px = tile_layout_height(layout);
    return true;
}

void session_tile_move(struct session *session, struct burn_shift shift, int64_t now_ns)
{
    struct burn_shift *mine = &session->tile.layout.shift;
    if (mine->x_px == shift.x_px && mine->y_px == shift.y_px)
        return;
    *mine = shift;
    session->tile.moved = true;
    if (!session->demand.data)
        session->demand.data_ns = now_ns;
    /* requests a picture even if its content is unchanged, because the burn-in shift has moved the part of the wall's picture
       that this display shows */
    session->demand.data = true;
}

void session_tile_sent(struct session *session, uint64_t picture, uint32_t seq)
{
    struct session_tile *tile = &session->tile;
    if (tile->held_count == TILE_HELD)
        memmove(tile->held, tile->held + 1, (size_t)--tile->held_count * sizeof(tile->held[0]));
    tile->held[tile->held_count++] = (struct tile_held){ picture, seq };
}

/* Records that the tile looks the same in this picture as in the previous frame, so no new frame is sent. The previous frame
   may still be on its way from the encoder, because an answer without a frame overtakes it. The picture number is then attached
   to that frame when it arrives. */
void session_tile_unchanged(struct session *session, uint64_t picture)
{
    struct session_tile *tile = &session->tile;
    struct encoded_frame *last = session->delivery.ready;
    int others = session->delivery.pacer.asked - 1;
    for (struct encoded_frame *ready = last; ready; last = ready, ready = ready->next)
        others--;
    if (others > 0) {
        tile->unchanged = picture;
        return;
    }
    tile->unchanged = 0;
    if (last)
        last->request.picture = picture;
    else
        session_tile_sent(session, picture, session->delivery.pacer.last_seq);
}

void session_tile_came(struct session *session, struct frame_request *request, int64_t made_ns)
{
    int64_t took_ns = made_ns - request->asked_ns, known_ns = session->tile.made_ns;
    if (request->view.tier == TIER_PREVIEW)
        session->tile.made_ns = known_ns ? known_ns + (took_ns - known_ns) / 4 : took_ns;
    if (request->picture < session->tile.unchanged)
        request->picture = session->tile.unchanged;
    session->tile.unchanged = 0;
}

/* --- dropping tiles that delay the others, and readmitting them ------------------------------------------------------------ */

bool session_tile_judge(struct session *session, int64_t now_ns, int64_t now_utc_ns)
{
    struct session_tile *tile = &session->tile;
    const struct pacer *pacer = &session->delivery.pacer;
    bool waits = pacer->flight_count > 0 && now_ns - pacer->flight[0].sent_ns > MAX_LATE_NS;
    if (tile->late_us == 0) {
        if (tile->out_ns && now_ns - tile->in_ns > KEPT_UP_NS)
            tile->out_ns = 0;
        if (!waits)
            return false;
        tile->late_us = now_utc_ns / 1000;
        tile->out_ns = !tile->out_ns ? OUT_NS : 2 * tile->out_ns < MAX_OUT_NS ? 2 * tile->out_ns : MAX_OUT_NS;
        tile->in_ns = now_ns + tile->out_ns;
        session_drop_ready(session);
        return true;
    }
    if (now_ns < tile->in_ns || pacer->flight_count > 0 || pacer->asked > 0)
        return false;
    tile->late_us = 0;
    tile->in_ns = now_ns;
    tile->held_count = 0;
    session->demand.any = true;
    return true;
}

void session_tile_tell(struct session *session, const bool *there, const int64_t *late_us, bool leads)
{
    const struct wall *wall = wall_find(session->context->plant, session->tile.place.wall);
    if (!wall || !session->hello || session->owed.welcome)
        return;
    char *text = reply_tiles_text(wall, &session->tile.place, &session->tile.layout, there, late_us, leads);
    if (session->tile.told && !strcmp(session->tile.told, text)) {
        mem_free(text);
        return;
    }
    mem_free(session->tile.told);
    session->tile.told = mem_strdup(text);
    session_reply(session, text);
}
