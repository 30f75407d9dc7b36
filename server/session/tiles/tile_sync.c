/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "session/tiles/tile_sync.h"

#include "base/clock.h"
#include "session/reply/reply.h"
#include "session/session_impl.h"

/* Nanoseconds. All tiles of a wall show a picture at one instant: the slowest client's round trip plus FLIP_NS, but at most
   MAX_FLIP_NS, after the server has told the clients to show it. */
static const int64_t FLIP_NS = 25 * NS_PER_MS, MAX_FLIP_NS = NS_PER_S;
/* Time in nanoseconds for making a picture above which the wall's pictures get smaller. The server makes two pictures at a time,
   so this is the limit for 15 pictures a second. */
static const int64_t SLOW_MADE_NS = 130 * NS_PER_MS, FAST_MADE_NS = 90 * NS_PER_MS;

bool session_tile_takes_part(const struct session *session, int64_t now_ns)
{
    return session->hello && !session->hidden && !session->close.code && session->tile.late_us == 0 && session_has_pixels(session) &&
           session_begun(session, now_ns);
}

/* --- requests --------------------------------------------------------------------------------------------------------------- */

/* Returns whether request a is more urgent than request b. A preview goes before a refined picture: it means that a user moves
   the camera, or that a tile has just connected. */
static bool goes_first(const struct frame_request *a, const struct frame_request *b)
{
    if (a->view.tier != b->view.tier)
        return a->view.tier == TIER_PREVIEW;
    return a->urgency < b->urgency;
}

/* Returns the worst encoding quality that any of the wall's displays needs. All get this quality, because parts of different
   quality would not look like one picture. */
static struct rung worst_rung(const struct session_tiles *tiles, int *step)
{
    struct quality_ladder worst = tiles->members[0]->delivery.pacer.ladder;
    for (size_t i = 1; i < tiles->count; i++) {
        const struct quality_ladder *ladder = &tiles->members[i]->delivery.pacer.ladder;
        worst.step = ladder->step > worst.step ? ladder->step : worst.step;
        worst.decoded.index = ladder->decoded.index > worst.decoded.index ? ladder->decoded.index : worst.decoded.index;
    }
    worst.made = *tiles->made;
    *step = worst.step;
    return quality_ladder_rung(&worst, worst.step);
}

/* Adjusts the size of the wall's picture to the server's speed, but only while the view moves: a still picture measures nothing. */
static void follow_server(const struct session_tiles *tiles, bool moving, int64_t now_ns)
{
    int64_t made_ns = 0;
    for (size_t i = 0; i < tiles->count; i++)
        made_ns = tiles->members[i]->tile.made_ns > made_ns ? tiles->members[i]->tile.made_ns : made_ns;
    if (moving && made_ns)
        picture_size_follow(tiles->made, &(struct picture_cost){ .cost_ns = made_ns, .hard_ns = SLOW_MADE_NS, .easy_ns = FAST_MADE_NS },
                            now_ns);
    else
        picture_size_pause(tiles->made);
}

bool session_tiles_next_request(const struct session_tiles *tiles, uint64_t number, int64_t now_ns, struct frame_request requests[])
{
    struct frame_request first = { 0 };
    bool any = false, always = false, may_add = true, may_replace = true;
    for (size_t i = 0; i < tiles->count; i++) {
        const struct frame_delivery *delivery = &tiles->members[i]->delivery;
        may_add &= !delivery->ready && pacer_may_ask(&delivery->pacer, now_ns);
        may_replace &= delivery->pacer.asked > 0;
    }
    if (!may_add && !may_replace)
        return false;
    for (size_t i = 0; i < tiles->count; i++) {
        struct frame_request *request = &requests[i];
        bool wants = session_wants(tiles->members[i], now_ns, request);
        if (wants && (!any || goes_first(request, &first)))
            first = *request;
        any |= wants;
        always |= (wants && request->always) || tiles->members[i]->tile.moved;
    }
    if (!any)
        return false;
    bool moving = first.view.tier == TIER_PREVIEW;
    follow_server(tiles, moving, now_ns);
    int step;
    struct rung rung = worst_rung(tiles, &step);
    struct tile_layout layout = tiles->leader->tile.layout;
    if (moving) {
        layout = tile_layout_scale(&layout, rung.scale);
        first.quality = (struct encoder_params){ .quality = rung.quality };
    }
    /* A preview drawn in place of a refined picture has the layout's full size, but the quality of this step. */
    first.step = step;
    first.scale = moving ? rung.scale : 1;
    first.moving_quality.quality = rung.quality;
    first.view.width_px = tile_layout_width(&layout);
    first.view.height_px = tile_layout_height(&layout);
    first.always = always;
    /* if `only_replace` is set, the request adds no picture to those in flight; it may only replace one, such as a refined
       picture whose view has changed */
    first.only_replace = !may_add;
    first.picture = number;
    for (size_t i = 0; i < tiles->count; i++) {
        const struct session *member = tiles->members[i];
        bool alone = member->demand.any;
        requests[i] = first;
        requests[i].alone = alone;
        requests[i].codec = member->codec.current;
        requests[i].account = member->room.share ? member->room.share->account : 0;
        requests[i].view.camera_seq = member->view.camera_seq;
        /* All displays of the wall show the leader's parameters. Their frames therefore have the leader's sequence number of
           parameters (params_seq), which the client knows from the message `following`. */
        requests[i].view.params_seq = tiles->leader->view.params_seq;
        requests[i].part = tile_layout_part(&layout, member->tile.place.display);
    }
    return true;
}

/* --- which tile has received which picture of the wall ----------------------------------------------------------------------- */

/* Returns the sequence number of the session's frame for the wall's picture with the id `picture`, once the client has
   acknowledged the frame; otherwise 0. */
static uint32_t seq_of(const struct session *session, uint64_t picture)
{
    for (int i = session->tile.held_count - 1; i >= 0; i--)
        if (session->tile.held[i].picture == picture)
            return session->tile.held[i].seq <= session->delivery.pacer.acked.seq ? session->tile.held[i].seq : 0;
    return 0;
}

static void drop_to(struct session_tile *tile, uint64_t picture)
{
    int kept = 0;
    for (int i = 0; i < tile->held_count; i++)
        if (tile->held[i].picture > picture)
            tile->held[kept++] = tile->held[i];
    tile->held_count = kept;
}

/* Returns the id of the newest picture after `presented` that the clients of all members (displays of the wall that take part)
   have received; 0: none. */
static uint64_t common(const struct session_tiles *tiles, uint64_t presented)
{
    const struct session_tile *first = tiles->count > 0 ? &tiles->members[0]->tile : NULL;
    for (int i = first ? first->held_count - 1 : -1; i >= 0; i--) {
        uint64_t picture = first->held[i].picture;
        size_t have = 0;
        while (have < tiles->count && seq_of(tiles->members[have], picture))
            have++;
        if (have == tiles->count && picture > presented)
            return picture;
    }
    return 0;
}

/* If no frame is in flight, but a member has a frame that it could not present, requests another picture for all members. Such
   a frame is left over when other members lack a frame of the same picture, because a newer request replaced theirs before it
   was drawn. */
static void ask_anew(const struct session_tiles *tiles)
{
    bool any = false;
    for (size_t i = 0; i < tiles->count; i++) {
        const struct session *member = tiles->members[i];
        if (member->delivery.ready || member->delivery.pacer.asked > 0 || member->delivery.pacer.flight_count > 0)
            return;
        any |= member->delivery.pacer.acked.seq > member->tile.presented_seq;
    }
    for (size_t i = 0; i < tiles->count && any; i++)
        tiles->members[i]->demand.any = true;
}

void session_tiles_present(const struct session_tiles *tiles, uint64_t *presented, int64_t now_ns, int64_t now_utc_ns)
{
    uint64_t picture = common(tiles, *presented);
    int64_t wait_ns = 0;
    (void)now_ns;
    if (!picture) {
        ask_anew(tiles);
        return;
    }
    for (size_t i = 0; i < tiles->count; i++) {
        int64_t rtt_ns = channel_rtt_ns(&tiles->members[i]->delivery.pacer.channel);
        wait_ns = rtt_ns > wait_ns ? rtt_ns : wait_ns;
    }
    wait_ns = wait_ns + FLIP_NS < MAX_FLIP_NS ? wait_ns + FLIP_NS : MAX_FLIP_NS;
    for (size_t i = 0; i < tiles->count; i++) {
        struct session *member = tiles->members[i];
        uint32_t seq = seq_of(member, picture);
        if (seq != member->tile.presented_seq)
            session_reply(member, reply_present_text(seq, picture, (now_utc_ns + wait_ns) / 1000));
        member->tile.presented_seq = seq;
        drop_to(&member->tile, picture);
    }
    *presented = picture;
}
