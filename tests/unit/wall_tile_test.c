/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A tile shows pictures when the server says so, however rarely it looks. */
#include <jansson.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/mem.h"
#include "clients/wall/view_tile.h"

enum { EARLY_US = 4000, PICTURES = 50 };

static void keep(struct view_tile *tile, uint32_t seq)
{
    const uint8_t pixel[4] = { (uint8_t)seq, 0, 0, 0 };
    const struct wire_frame frame = { .seq = seq, .full_width_px = 1, .full_height_px = 1 };
    view_tile_keep(tile, &frame, pixel);
}

static void order(struct view_tile *tile, uint32_t seq, int64_t at_us)
{
    json_t *message = json_pack("{s:i,s:I}", "seq", (int)seq, "at_us", (json_int_t)at_us);
    view_tile_hear(tile, "present", message);
    json_decref(message);
}

/* Returns the number of the picture that came, 0: none. */
static uint32_t look(struct view_tile *tile, int64_t now_us)
{
    struct tile_picture picture;
    if (!view_tile_take(tile, now_us, &picture))
        return 0;
    assert_int_equal(picture.pixels[0], picture.frame.seq & 255);
    mem_free(picture.pixels);
    return picture.frame.seq;
}

/* Pictures every `apart_us`, each to be shown `ahead_us` after it came, looked at every `look_us`. */
static void run(int apart_us, int ahead_us, int look_us)
{
    struct view_tile tile = { .display = 1 };
    uint32_t sent = 0, shown = 0;
    int looks = 0, found = 0;
    for (int64_t now_us = 0; now_us <= (int64_t)(PICTURES + 1) * apart_us + ahead_us + 2 * look_us; now_us += 1000) {
        if (now_us % apart_us == 0 && sent < PICTURES) {
            keep(&tile, ++sent);
            order(&tile, sent, now_us + ahead_us);
        }
        if (now_us % look_us)
            continue;
        uint32_t seq = look(&tile, now_us);
        looks += sent > 0 && sent < PICTURES && now_us > ahead_us + look_us;
        found += seq && sent < PICTURES && now_us > ahead_us + look_us;
        if (seq) {
            assert_true(seq > shown);
            assert_true((int64_t)(seq - 1) * apart_us + ahead_us <= now_us + EARLY_US); /* never before its time */
            shown = seq;
        }
    }
    if (look_us >= apart_us && ahead_us <= TILE_KEPT * apart_us)
        assert_int_equal(found, looks); /* each look finds a newer one */
    assert_true(found > 0);
    assert_int_equal(shown, PICTURES);
    view_tile_clear(&tile);
}

static void each_look_finds_what_is_due(void **state)
{
    (void)state;
    run(40000, 30000, 16000);
    run(40000, 60000, 100000);
    run(16000, 80000, 100000);
    run(20000, 30000, 200000);
    run(40000, 500000, 200000); /* a slow link: fewer than are sent, but not none */
}

/* What an answer without a frame orders anew is the picture that is there. */
static void an_order_for_what_is_shown_changes_nothing(void **state)
{
    (void)state;
    struct view_tile tile = { .display = 1 };
    keep(&tile, 7);
    assert_int_equal(look(&tile, 1000000), 0); /* nobody said when */
    order(&tile, 7, 1000000);
    assert_int_equal(look(&tile, 900000), 0);
    assert_int_equal(look(&tile, 1000000), 7);
    order(&tile, 7, 1100000);
    assert_int_equal(look(&tile, 1200000), 0);
    view_tile_clear(&tile);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_look_finds_what_is_due),
        cmocka_unit_test(an_order_for_what_is_shown_changes_nothing),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
