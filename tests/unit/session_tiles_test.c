/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tiles that together show one picture on a wall: which picture all of them present at the same time. No tile may wait for a
   frame that another tile will never get. */
#include "session/tiles/tile_sync.h"

#include "tests/support/test.h"

#include "base/clock.h"
#include "session/session_impl.h"

enum { TILES = 2 };
struct wall_case {
    struct session *members[TILES];
    struct session_tiles tiles;
};

static void set_up(struct wall_case *wall)
{
    for (int i = 0; i < TILES; i++)
        wall->members[i] = mem_new(sizeof(*wall->members[i]));
    wall->tiles = (struct session_tiles){ .members = wall->members, .count = TILES, .leader = wall->members[0] };
}

static void tear_down(struct wall_case *wall)
{
    for (int i = 0; i < TILES; i++) {
        for (int k = 0; k < wall->members[i]->owed.reply_count; k++)
            mem_free(wall->members[i]->owed.replies[k]);
        mem_free(wall->members[i]);
    }
}

/* Records that tile i has received and acknowledged its frame (number seq) of the wall's picture number `picture`. */
static void have(struct wall_case *wall, int i, uint64_t picture, uint32_t seq)
{
    session_tile_sent(wall->members[i], picture, seq);
    wall->members[i]->delivery.pacer.acked.seq = seq;
}

TEST(test_what_all_have_is_shown)
{
    struct wall_case wall;
    uint64_t presented = 5;
    set_up(&wall);
    have(&wall, 0, 6, 3);
    have(&wall, 1, 6, 4);
    have(&wall, 1, 7, 5);
    session_tiles_present(&wall.tiles, &presented, 0, 0);
    assert_int_equal(presented, 6);
    for (int i = 0; i < TILES; i++) {
        assert_int_equal(wall.members[i]->owed.reply_count, 1);
        assert_false(wall.members[i]->demand.any);
    }
    tear_down(&wall);
}

TEST(test_of_two_pictures_none_is_waited_for)
{
    struct wall_case wall;
    uint64_t presented = 5;
    set_up(&wall);
    have(&wall, 0, 6, 3);
    have(&wall, 1, 7, 3);
    /* a request of tile 0 is under way, so it may still get its frame of picture 7, which tile 1 already has */
    wall.members[0]->delivery.pacer.asked = 1;
    session_tiles_present(&wall.tiles, &presented, 0, 0);
    assert_false(wall.members[0]->demand.any || wall.members[1]->demand.any);
    wall.members[0]->delivery.pacer.asked = 0;
    session_tiles_present(&wall.tiles, &presented, 0, 0);
    assert_true(wall.members[0]->demand.any && wall.members[1]->demand.any);
    assert_int_equal(presented, 5);
    tear_down(&wall);
}

/* Tile 0's frame of picture 6 is still being encoded when the answer arrives that picture 7 equals it (unchanged). The tile
   must not count as showing picture 7 before it has the frame. */
TEST(test_an_answer_without_a_frame_overtakes_one)
{
    struct wall_case wall;
    uint64_t presented = 5;
    struct frame_request request = { .picture = 6 };
    set_up(&wall);
    have(&wall, 0, 5, 3);
    wall.members[0]->delivery.pacer.last_seq = 3;
    wall.members[0]->delivery.pacer.asked = 2;
    session_tile_unchanged(wall.members[0], 7);
    wall.members[0]->delivery.pacer.asked = 1;
    have(&wall, 1, 7, 4);
    session_tiles_present(&wall.tiles, &presented, 0, 0);
    assert_int_equal(presented, 5); /* the frame that tile 0 shows belongs to picture 5, so picture 7 must not be presented yet */
    session_tile_came(wall.members[0], &request, 0);
    assert_int_equal(request.picture, 7);
    wall.members[0]->delivery.pacer.asked = 0;
    have(&wall, 0, request.picture, 4);
    session_tiles_present(&wall.tiles, &presented, 0, 0);
    assert_int_equal(presented, 7);
    assert_int_equal(wall.members[0]->tile.presented_seq, 4);
    tear_down(&wall);
}

/* Answers a tile's request for a picture with the message that there is no frame. absence: the reason, such as "skipped" or
   "unchanged". */
static void answer_without_frame(struct session *session, uint64_t picture, uint64_t number, enum frame_absence absence)
{
    struct encoded_frame *encoded = mem_new(sizeof(*encoded));
    *encoded = (struct encoded_frame){ .number = number, .absence = absence, .request.picture = picture };
    session_on_frame(session, encoded);
}

/* A request whose readings are older than those of a later request is skipped: the tile then does not show that picture. After
   the answer "unchanged" it does, because its present frame equals it. */
TEST(test_a_skipped_picture_is_not_one_that_the_tile_shows)
{
    for (int unchanged = 0; unchanged < 2; unchanged++) {
        struct wall_case wall;
        uint64_t presented = 5;
        set_up(&wall);
        have(&wall, 0, 5, 3);
        have(&wall, 1, 6, 4);
        struct session *tile = wall.members[0];
        tile->tile.place.display = 1;
        tile->delivery.pacer.last_seq = 3;
        tile->delivery.pacer.asked = 1;
        answer_without_frame(tile, 6, 8, unchanged ? FRAME_UNCHANGED : FRAME_SKIPPED);
        assert_int_equal(tile->delivery.pacer.asked, 0);
        session_tiles_present(&wall.tiles, &presented, 0, 0);
        assert_int_equal(presented, unchanged ? 6 : 5);
        assert_true(tile->demand.any == !unchanged); /* if the picture of one tile was skipped, all tiles need a new one */
        tear_down(&wall);
    }
}

/* For displays of this size, tries all shifts of the burn-in protection at some preview sizes. The drawn picture must extend
   beyond the tiles by the shift, so that no shifted tile shows an area outside the picture. */
static void check_moves(int width_px, int height_px)
{
    struct wall wall = { .inches = 10, .tile = { .columns = 3, .rows = 2, .bezel_mm = { 20, 0 } } };
    struct tile_layout full;
    tile_layout_init(&full, &wall, width_px, height_px, 1 << 24);
    for (int i = 0; i < 8 * 4; i++) {
        full.shift = burn_shift_at(i / 4 * 180 * NS_PER_S);
        struct tile_layout layout = tile_layout_scale(&full, 1 - 0.17 * (i % 4));
        struct frame_part first = tile_layout_part(&layout, 1), second = tile_layout_part(&layout, 2), last = tile_layout_part(&layout, 6);
        assert_true(first.x_px >= 0 && first.y_px >= 0);
        assert_true(last.x_px + last.width_px <= tile_layout_width(&layout));
        assert_true(last.y_px + last.height_px <= tile_layout_height(&layout));
        assert_int_equal(second.x_px - first.x_px, layout.width_px + layout.gap_px[0]);
        assert_int_equal(last.y_px - first.y_px, layout.height_px);
        if (i % 4 == 0 && layout.width_px == width_px) {
            assert_int_equal(first.x_px, BURN_SHIFT_PX - full.shift.x_px);
            assert_int_equal(first.y_px, BURN_SHIFT_PX - full.shift.y_px);
        }
    }
}

TEST(test_tiles_are_moved_within_the_picture)
{
    check_moves(320, 180);
    /* a picture for three such displays would exceed the largest one that the server draws, so it is drawn smaller */
    check_moves(4096, 2160);
    check_moves(8192, 8192);
}

/* Displays state their sizes themselves: a browser window may be a narrow strip, next to which the bezels are thousands of
   times as wide. The picture must not exceed its maximum size. */
TEST(test_a_picture_is_never_larger_than_one_may_be)
{
    for (int i = 0; i < WALL_DISPLAYS * 2 * 100; i++) {
        int count = i / 200 + 1, width_px = 16 << i % 10, height_px = 16 << i / 10 % 10;
        struct wall wall = { .inches = 10, .tile = { .columns = count, .rows = WALL_DISPLAYS / count, .bezel_mm = { 200, 200 } } };
        struct tile_layout layout;
        if (i / 100 % 2)
            wall.tile.columns = WALL_DISPLAYS / (wall.tile.rows = count);
        if (!view_size_valid(width_px, height_px))
            continue;
        tile_layout_init(&layout, &wall, width_px, height_px, VIEW_MAX_PIXELS);
        assert_true(view_size_valid(tile_layout_width(&layout), tile_layout_height(&layout)));
        struct frame_part last = tile_layout_part(&layout, wall.tile.columns * wall.tile.rows);
        assert_true(last.width_px >= 16 && last.x_px + last.width_px <= tile_layout_width(&layout));
        assert_true(last.height_px >= 16 && last.y_px + last.height_px <= tile_layout_height(&layout));
    }
}

/* When a tile that was hidden is shown again, it must reserve the pixels of its own display, as when it joined, and not those
   of the whole picture. */
TEST(test_a_tile_seen_again_takes_its_own_pixels)
{
    const struct wall wall = { .inches = 10, .tile = { .columns = 3, .rows = 2 } };
    const int64_t own = 1920 * 1080;
    const struct quotas quotas = { .at = { [QUOTA_PIXELS] = 2 * own } };
    struct admission admission = { .quotas = &quotas };
    const struct session_context context = { .quotas = &quotas, .admission = &admission };
    struct session *session = mem_new(sizeof(*session));
    session->context = &context;
    session->hidden = true;
    session->tile.place.display = 2;
    tile_layout_init(&session->tile.layout, &wall, 1920, 1080, VIEW_MAX_PIXELS);
    session->view.width_px = tile_layout_width(&session->tile.layout);
    session->view.height_px = tile_layout_height(&session->tile.layout);
    session_on_visible(session, true, 1);
    assert_int_equal(admission.pixels, own);
    assert_int_equal(session->owed.reply_count, 0);
    mem_free(session);
}

/* While the server is overloaded, a preview may be drawn in place of the wall's refined picture. It has full size, and the
   quality that the tile with the slowest network needs, so the request must name the step of that tile. */
TEST(test_a_preview_in_place_of_a_refined_picture_has_the_worst_step)
{
    const struct wall plan = { .inches = 10, .tile = { .columns = 2, .rows = 1 } };
    const struct session_context context = { .load.overloaded = true };
    static const int STEPS[TILES] = { 1, 5 };
    struct picture_size made = { 0 };
    struct frame_request requests[TILES];
    struct wall_case wall;
    set_up(&wall);
    wall.tiles.made = &made;
    for (int i = 0; i < TILES; i++) {
        struct session *member = wall.members[i];
        member->context = &context;
        member->hello = true;
        member->tile.place.display = i + 1;
        tile_layout_init(&member->tile.layout, &plan, 1920, 1080, VIEW_MAX_PIXELS);
        member->delivery.pacer.ladder.step = STEPS[i];
        member->delivery.common_step = -1;
        member->demand.refined = REFINED_FULL;
        member->demand.data = true;
    }
    assert_true(session_tiles_next_request(&wall.tiles, 1, NS_PER_S, requests));
    for (int i = 0; i < TILES; i++) {
        assert_true(requests[i].view.tier == TIER_REFINED && requests[i].or_moving);
        assert_int_equal(requests[i].view.width_px, tile_layout_width(&wall.members[0]->tile.layout));
        assert_int_equal(requests[i].moving_quality.quality, quality_ladder_rung(&wall.members[1]->delivery.pacer.ladder, 5).quality);
        assert_int_equal(requests[i].step, 5);
        assert_true(requests[i].scale == 1);
    }
    tear_down(&wall);
}

TEST(test_a_move_is_sent_once)
{
    struct wall_case wall;
    struct frame_request request = { .view.tier = TIER_REFINED };
    struct session *first;
    set_up(&wall);
    first = wall.members[0];
    session_tile_move(first, (struct burn_shift){ 0 }, 5);
    assert_false(first->tile.moved || first->demand.data);
    session_tile_move(first, (struct burn_shift){ 2, 1 }, 6);
    assert_true(first->tile.moved && first->demand.data);
    assert_int_equal(first->demand.data_ns, 6);
    session_requested(first, &request, true);
    session_tile_move(first, (struct burn_shift){ 2, 1 }, 7);
    assert_false(first->tile.moved || first->demand.data);
    tear_down(&wall);
}
