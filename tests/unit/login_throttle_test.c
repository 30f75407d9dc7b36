/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The login throttle: when an address is slowed and for how long, and that other addresses are unaffected. */
#include "access/login_throttle.h"

#include "tests/support/test.h"

#include "base/clock.h"

static const uint8_t HERE[16] = { [10] = 0xff, 0xff, 203, 0, 113, 7 }, THERE[16] = { [10] = 0xff, 0xff, 203, 0, 113, 8 };
static const uint8_t WALL[TOKEN_HASH_BYTES] = { 1 }, DESK[TOKEN_HASH_BYTES] = { 2 };
static const int64_t S = NS_PER_S;

static int set_up(void **state)
{
    *state = login_throttle_create();
    return 0;
}

static int tear_down(void **state)
{
    struct login_throttle *throttle = *state;
    login_throttle_destroy(&throttle);
    return 0;
}

#define CASE(name) TEST_ON(struct login_throttle *throttle, name, set_up, tear_down)

CASE(ten_wrong_tokens_within_a_minute_slow_an_address)
{
    for (int i = 0; i < 9; i++)
        assert_int_equal(login_throttle_judge(throttle, HERE, NULL, i * 6 * S), LOGIN_WRONG);
    assert_int_equal(login_throttle_failures(throttle, HERE, 49 * S), 9);
    assert_int_equal(login_throttle_slowed(throttle, 49 * S), 0);
    assert_int_equal(login_throttle_judge(throttle, HERE, NULL, 54 * S), LOGIN_WRONG_SLOWS);
    assert_int_equal(login_throttle_slowed(throttle, 54 * S), 1);
    assert_int_equal(login_throttle_judge(throttle, HERE, NULL, 55 * S), LOGIN_HELD);
    /* while an address is slowed, most attempts are not judged at all: a valid token gets the same answer as a wrong one */
    assert_int_equal(login_throttle_judge(throttle, HERE, DESK, 58 * S), LOGIN_HELD);
    assert_int_equal(login_throttle_judge(throttle, HERE, NULL, 59 * S), LOGIN_WRONG); /* every five seconds one attempt is judged */
    assert_int_equal(login_throttle_judge(throttle, HERE, NULL, 60 * S), LOGIN_HELD);
    assert_int_equal(login_throttle_judge(throttle, THERE, NULL, 60 * S), LOGIN_WRONG);
    assert_int_equal(login_throttle_judge(throttle, HERE, DESK, 64 * S), LOGIN_GOOD_NEW);
    /* the address stays slowed until a minute after its last wrong token, at 59 s */
    assert_int_equal(login_throttle_slowed(throttle, 118 * S), 1);
    assert_int_equal(login_throttle_slowed(throttle, 119 * S), 0);
    assert_int_equal(login_throttle_judge(throttle, HERE, NULL, 119 * S), LOGIN_WRONG);
}

CASE(ten_in_more_than_a_minute_do_not)
{
    for (int i = 0; i < 100; i++)
        assert_int_equal(login_throttle_judge(throttle, HERE, NULL, i * 7 * S), LOGIN_WRONG);
}

CASE(who_was_let_in_before_is_not_held_up)
{
    assert_int_equal(login_throttle_judge(throttle, HERE, WALL, 0), LOGIN_GOOD_NEW);
    for (int i = 0; i < 12; i++)
        login_throttle_judge(throttle, HERE, NULL, S);
    assert_int_equal(login_throttle_judge(throttle, HERE, WALL, 2 * S), LOGIN_GOOD);
    assert_int_equal(login_throttle_judge(throttle, HERE, DESK, 2 * S), LOGIN_HELD);
    assert_int_equal(login_throttle_judge(throttle, THERE, DESK, 2 * S), LOGIN_GOOD_NEW);
}

/* Many token holders share one address, for example behind a proxy or NAT. */
CASE(many_holders_of_one_address_are_not_held_up)
{
    uint8_t hash[TOKEN_HASH_BYTES] = { 0 };
    for (int i = 0; i < 300; i++) {
        hash[1] = (uint8_t)i;
        hash[2] = (uint8_t)(1 + i / 256);
        assert_int_equal(login_throttle_judge(throttle, HERE, hash, i), LOGIN_GOOD_NEW);
        assert_int_equal(login_throttle_judge(throttle, HERE, WALL, S + i), i == 0 ? LOGIN_GOOD_NEW : LOGIN_GOOD);
    }
    for (int i = 0; i < 12; i++)
        login_throttle_judge(throttle, HERE, NULL, 2 * S);
    for (int i = 0; i < 300; i++) {
        hash[1] = (uint8_t)i;
        hash[2] = (uint8_t)(1 + i / 256);
        assert_int_equal(login_throttle_judge(throttle, HERE, hash, 3 * S), i < 45 ? LOGIN_HELD : LOGIN_GOOD);
    }
    assert_int_equal(login_throttle_judge(throttle, HERE, WALL, 3 * S), LOGIN_GOOD); /* it was used last */
}

CASE(a_login_is_news_every_ten_minutes)
{
    assert_int_equal(login_throttle_judge(throttle, HERE, WALL, 0), LOGIN_GOOD_NEW);
    assert_int_equal(login_throttle_judge(throttle, HERE, DESK, S), LOGIN_GOOD_NEW);
    assert_int_equal(login_throttle_judge(throttle, HERE, WALL, 599 * S), LOGIN_GOOD);
    assert_int_equal(login_throttle_judge(throttle, HERE, WALL, 600 * S), LOGIN_GOOD_NEW);
    assert_int_equal(login_throttle_judge(throttle, HERE, WALL, 601 * S), LOGIN_GOOD);
}

/* Memory is bounded, and old addresses are evicted before recent offenders. */
CASE(as_many_addresses_as_there_is_room_for)
{
    uint8_t other[16] = { 0x20, 0x01 };
    for (int i = 0; i < 3 * LOGIN_ADDRESSES; i++) {
        other[6] = (uint8_t)(i >> 8);
        other[7] = (uint8_t)i;
        assert_int_equal(login_throttle_judge(throttle, other, NULL, i * S / 1000), LOGIN_WRONG);
        if (i % 300 == 0)
            login_throttle_judge(throttle, HERE, NULL, i * S / 1000);
    }
    assert_int_equal(login_throttle_slowed(throttle, 4 * S), 1);
}

/* Logins that an identity provider refuses count like wrong tokens. */
CASE(what_is_judged_elsewhere_counts_alike)
{
    assert_int_equal(login_throttle_begin(throttle, HERE, 0), LOGIN_NONE);
    for (int i = 0; i < 9; i++)
        assert_int_equal(login_throttle_fail(throttle, HERE, i * S), LOGIN_WRONG);
    assert_int_equal(login_throttle_begin(throttle, HERE, 9 * S), LOGIN_NONE); /* asking alone counts nothing */
    assert_int_equal(login_throttle_fail(throttle, HERE, 9 * S), LOGIN_WRONG_SLOWS);
    assert_int_equal(login_throttle_begin(throttle, HERE, 10 * S), LOGIN_HELD);
    /* a wrong login at an identity provider has slowed the address, so its tokens are not judged either: both share one
       throttle */
    assert_int_equal(login_throttle_judge(throttle, HERE, DESK, 10 * S), LOGIN_HELD);
    assert_int_equal(login_throttle_begin(throttle, THERE, 10 * S), LOGIN_NONE);
    assert_int_equal(login_throttle_begin(throttle, HERE, 14 * S), LOGIN_NONE);
    assert_int_equal(login_throttle_begin(throttle, HERE, 15 * S), LOGIN_HELD);
}
