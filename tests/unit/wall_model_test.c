/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The player's idea of the server's clock. */
#include "clients/wall/model.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "base/clock.h"
#include "base/mem.h"
#include "session/reply.h"

static const int64_t HOUR_US = 3600000000LL;

/* The server answers at at_ns, by a clock that is off_us ahead of ours, after a way of half_ns in each direction. */
static void hear(struct model *model, int64_t at_ns, int64_t off_us, int64_t half_ns)
{
    const struct snapshot none = { .count = 0 };
    char *text = reply_pong_text(&none, (double)(at_ns - half_ns), at_ns + off_us * 1000);
    json_t *pong = json_loads(text, 0, NULL);
    model_pong(model, pong, at_ns + half_ns);
    json_decref(pong);
    mem_free(text);
}

static void expect(const struct model *model, int64_t off_us, int64_t within_us)
{
    int64_t off = model_now_us(model) - clock_mono_ns() / 1000 - off_us;
    assert_in_range(off + within_us, 0, 2 * within_us);
}

static void test_short_ways_count(void **state)
{
    struct model model;
    (void)state;
    model_init(&model);
    int64_t now_ns = clock_mono_ns();
    hear(&model, now_ns, HOUR_US, 2 * NS_PER_MS);
    expect(&model, HOUR_US, 1000);
    hear(&model, now_ns + NS_PER_S, HOUR_US + 40000, 50 * NS_PER_MS); /* it waited somewhere */
    expect(&model, HOUR_US, 1000);
    hear(&model, now_ns + 2 * NS_PER_S, HOUR_US + 300, 2 * NS_PER_MS);
    expect(&model, HOUR_US + 300, 200);
    model_finish(&model);
}

/* The link is slower from now on, and the server's clock was set: after a minute what was known before counts no more. */
static void test_a_clock_that_is_set_is_followed(void **state)
{
    struct model model;
    (void)state;
    model_init(&model);
    int64_t now_ns = clock_mono_ns();
    hear(&model, now_ns, 0, NS_PER_MS);
    for (int s = 1; s <= 61; s++)
        hear(&model, now_ns + s * NS_PER_S, HOUR_US, 20 * NS_PER_MS);
    expect(&model, HOUR_US, 1000);
    model_finish(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_short_ways_count),
        cmocka_unit_test(test_a_clock_that_is_set_is_followed),
    };
    cmocka_set_message_output(CM_OUTPUT_TAP);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
