/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of colour ramps that the software renderer uses for previews: materials with equal ramps share a row, and the
   number of rows is limited. */
#include "tests/support/test.h"

#include "render/soft/ramp_rows.h"

enum { STEPS = 4, MOST = 100 };

struct ramp_rows_setup {
    size_t count;
    uint32_t *muted, *own, *was_muted, *was_own, *rows;
};

static void begin(struct ramp_rows_setup *s, size_t count)
{
    s->count = count;
    for (uint32_t **at = &s->muted; at <= &s->rows; at++)
        *at = mem_array(count * STEPS, sizeof(**at));
}

static size_t pack(struct ramp_rows_setup *s)
{
    memcpy(s->was_muted, s->muted, s->count * STEPS * sizeof(*s->muted));
    memcpy(s->was_own, s->own, s->count * STEPS * sizeof(*s->own));
    return ramp_rows_pack(s->muted, s->own, s->count, STEPS, MOST, s->rows);
}

static void end(struct ramp_rows_setup *s)
{
    for (uint32_t **at = &s->muted; at <= &s->rows; at++)
        mem_free(*at);
}

/* Gives a material a colour ramp from black to `color`. grey: end colour of its second ramp, used where the material is muted
   because it is only context. */
static void set(struct ramp_rows_setup *s, size_t material, uint32_t color, uint32_t grey)
{
    for (uint32_t i = 0; i < STEPS; i++) {
        uint32_t *own = &s->own[material * STEPS + i];
        *own = 0xff000000;
        for (int channel = 0; channel < 24; channel += 8)
            *own |= (color >> channel & 0xff) * i / (STEPS - 1) << channel;
        s->muted[material * STEPS + i] = grey;
    }
}

TEST(equal_ones_are_kept_once)
{
    struct ramp_rows_setup s;
    begin(&s, 5000);
    for (size_t i = 0; i < s.count; i++) {
        uint32_t shade = (uint32_t)(i * 7919 % 50);
        /* all have the same colours, but some have another grey when muted, so they need a row of their own */
        set(&s, i, 0x102030 + shade, 0x808080 + (shade == 7 && i > 2500));
    }
    assert_int_equal(pack(&s), 51);
    for (size_t i = 0; i < s.count; i++) {
        assert_true(s.rows[i] < 51);
        assert_memory_equal(s.own + s.rows[i] * STEPS, s.was_own + i * STEPS, STEPS * sizeof(uint32_t));
        assert_memory_equal(s.muted + s.rows[i] * STEPS, s.was_muted + i * STEPS, STEPS * sizeof(uint32_t));
    }
    end(&s);
}

TEST(too_many_share_those_that_are_near)
{
    struct ramp_rows_setup s;
    begin(&s, 20000);
    for (size_t i = 0; i < s.count; i++)
        set(&s, i, (uint32_t)i * 2654435761u & 0xffffff, 0x808080);
    size_t rows = pack(&s);
    assert_in_range(rows, 9, MOST); /* two bits of each channel */
    for (size_t i = 0; i < s.count; i++) {
        assert_true(s.rows[i] < rows);
        uint32_t got = s.own[(s.rows[i] + 1) * STEPS - 1], wanted = s.was_own[(i + 1) * STEPS - 1];
        assert_int_equal(got & 0xc0c0c0, wanted & 0xc0c0c0);
    }
    end(&s);
}

TEST(as_many_as_may_be_are_kept_apart)
{
    struct ramp_rows_setup s;
    begin(&s, MOST);
    for (size_t i = 0; i < s.count; i++)
        set(&s, i, (uint32_t)i, 0x808080);
    assert_int_equal(pack(&s), MOST);
    for (size_t i = 0; i < s.count; i++)
        assert_int_equal(s.rows[i], i);
    end(&s);
    assert_int_equal(ramp_rows_pack(NULL, NULL, 0, STEPS, MOST, NULL), 0);
}
