/* SPDX-License-Identifier: GPL-3.0-or-later */
/* States of alarms: a table gives the expected next state for every state and event. Also tests limits, deadbands and delays.
   */
#include "tests/support/test.h"

#include "alarm/alarm_state.h"
#include "alarm/condition.h"

#define S INT64_C(1000000000)

/* --- the table -------------------------------------------------------------------------------------------------------------- */

/* Short names of the states of a local alarm: the status; "+a": the cause is active although the status does not show it; "+l":
   the alarm is latched; then further reasons why the alarm is set aside. */
static const struct {
    const char *name, *word;
    struct alarm_state state;
} states[] = {
    { "normal", "normal", { 0 } },
    { "unack", "unacknowledged", { .active = true, .unacknowledged = true } },
    { "acked", "acknowledged", { .active = true } },
    { "returned", "returned", { .unacknowledged = true } },
    { "unack+l", "unacknowledged", { .active = true, .unacknowledged = true, .latched = true } },
    { "acked+l", "acknowledged", { .active = true, .latched = true } },
    { "latched+u", "latched", { .unacknowledged = true, .latched = true } },
    { "latched", "latched", { .latched = true } },
    { "shelved", "shelved", { .aside = ALARM_ASIDE_SHELVED } },
    { "shelved+a", "shelved", { .active = true, .aside = ALARM_ASIDE_SHELVED } },
    { "suppr", "suppressed", { .aside = ALARM_ASIDE_SUPPRESSED } },
    { "suppr+a", "suppressed", { .active = true, .aside = ALARM_ASIDE_SUPPRESSED } },
    { "out", "out_of_service", { .aside = ALARM_ASIDE_OUT } },
    { "out+a", "out_of_service", { .active = true, .aside = ALARM_ASIDE_OUT } },
    { "suppr+s", "suppressed", { .aside = ALARM_ASIDE_SUPPRESSED | ALARM_ASIDE_SHELVED } },
    { "out+s", "out_of_service", { .aside = ALARM_ASIDE_OUT | ALARM_ASIDE_SHELVED } },
    { "out+d", "out_of_service", { .aside = ALARM_ASIDE_OUT | ALARM_ASIDE_SUPPRESSED } },
    { "shelved+l", "shelved", { .latched = true, .aside = ALARM_ASIDE_SHELVED } },
    { "carried", "suppressed", { .active = true, .aside = ALARM_ASIDE_CARRIED } },
};
enum { STATE_COUNT = sizeof(states) / sizeof(states[0]), ROWS = 18 };

/* Expected transitions of an alarm that does not latch. Each row begins with a state, followed by the next state for each event
   in the order of enum alarm_event. "=": no change; "-": the event is refused. */
static const char *const table[ROWS][1 + ALARM_EVENTS] = {
    /* columns: from state; raise, clear, acknowledge, reset, shelve, unshelve, suppress, unsuppress, take out of service, return to
       service, carry, call */
    { "normal", "unack", "=", "-", "-", "shelved", "=", "suppr", "=", "out", "=", "=", "=" },
    { "unack", "=", "returned", "acked", "-", "shelved+a", "=", "suppr+a", "=", "out+a", "=", "carried", "=" },
    { "acked", "=", "normal", "-", "-", "shelved+a", "=", "suppr+a", "=", "out+a", "=", "carried", "=" },
    { "returned", "unack", "=", "normal", "-", "shelved", "=", "suppr", "=", "out", "=", "=", "=" },
    { "unack+l", "=", "latched+u", "acked+l", "-", NULL, "=", NULL, "=", NULL, "=", NULL, "=" },
    { "acked+l", "=", "latched", "-", "-", NULL, "=", NULL, "=", NULL, "=", NULL, "=" },
    { "latched+u", NULL, "=", "latched", "-", "shelved+l", "=", NULL, "=", NULL, "=", "=", "=" },
    { "latched", NULL, "=", "-", "normal", "shelved+l", "=", NULL, "=", NULL, "=", "=", "=" },
    { "shelved", "shelved+a", "=", "-", "-", "shelved", "normal", "suppr+s", "=", "out+s", "=", "=", "=" },
    { "shelved+a", "=", "shelved", "-", "-", "shelved+a", "unack", NULL, "=", NULL, "=", NULL, "=" },
    { "suppr", "suppr+a", "=", "-", "-", "suppr+s", "=", "=", "normal", "out+d", "=", "=", "=" },
    { "suppr+a", "=", "suppr", "-", "-", NULL, "=", "=", "unack", NULL, "=", NULL, "=" },
    { "out", "out+a", "=", "-", "-", "out+s", "=", "out+d", "=", "=", "normal", "=", "=" },
    { "out+a", "=", "out", "-", "-", NULL, "=", NULL, "=", "=", "unack", NULL, "=" },
    { "suppr+s", NULL, "=", "-", "-", "suppr+s", "suppr", "=", "shelved", NULL, "=", "=", "=" },
    { "out+s", NULL, "=", "-", "-", "out+s", "out", NULL, "=", "=", "shelved", "=", "=" },
    { "shelved+l", NULL, "=", "-", "-", "shelved+l", "latched", NULL, "=", NULL, "=", "=", "=" },
    { "carried", "=", "normal", "-", "-", NULL, "=", NULL, "=", NULL, "=", "=", "unack" },
};

static int find_state(const char *name)
{
    int i = 0;
    while (i < STATE_COUNT && strcmp(states[i].name, name) != 0)
        i++;
    if (i == STATE_COUNT)
        fail_msg("no state %s", name);
    return i;
}

TEST(every_event_leads_where_the_table_says)
{
    static const struct alarm_rule rule = { .acknowledges = true };
    int said = 0;
    for (int row = 0; row < ROWS; row++)
        for (int event = 0; event < ALARM_EVENTS; event++) {
            const char *wanted = table[row][1 + event];
            int from = find_state(table[row][0]);
            struct alarm_state reached = states[from].state;
            enum alarm_outcome outcome = alarm_state_step(&reached, &rule, (enum alarm_event)event);
            if (!wanted)
                continue; /* no expectation: the next state has no short name, but check_invariants() tests it as well */
            said++;
            enum alarm_outcome meant = !strcmp(wanted, "=") ? ALARM_AS_IT_WAS : !strcmp(wanted, "-") ? ALARM_REFUSED : ALARM_CHANGED;
            int to = meant == ALARM_CHANGED ? find_state(wanted) : from;
            if (outcome != meant || memcmp(&reached, &states[to].state, sizeof(reached)) != 0)
                fail_msg("%s, %s: outcome %d, wanted %s", table[row][0], alarm_event_name((enum alarm_event)event), (int)outcome, wanted);
        }
    assert_true(said > 140);
}

TEST(every_state_has_its_word)
{
    static const struct alarm_rule rule = { .acknowledges = true };
    for (int i = 0; i < STATE_COUNT; i++)
        assert_string_equal(alarm_status_name(alarm_state_status(&states[i].state, &rule)), states[i].word);
    for (int i = 0; i < ALARM_STATUSES; i++)
        assert_int_equal(alarm_status_find(alarm_status_name((enum alarm_status)i)), i);
    for (int i = 1; i < ALARM_KINDS; i++)
        assert_int_equal(alarm_kind_find(alarm_kind_name((enum alarm_kind)i)), i);
    assert_int_equal(alarm_kind_find("XX"), ALARM_NONE);
}

/* Asserts what must hold in every state that can be reached, whatever rule (which events latch, which can be acknowledged)
   applies. */
static void check_invariants(const struct alarm_state *state, const struct alarm_rule *rule)
{
    enum alarm_status word = alarm_state_status(state, rule);
    assert_false(state->unacknowledged && state->aside);
    assert_false(state->unacknowledged && !rule->acknowledges);
    assert_false(state->latched && !(rule->acknowledges && rule->latches));
    assert_int_equal(alarm_status_is_annunciated(word), !state->aside && (state->active || state->unacknowledged || state->latched));
    assert_false(word == ALARM_NORMAL && state->active);
    assert_false(rule->forgets && !state->active && state->unacknowledged);
    if (rule->latches && rule->acknowledges && state->active && !state->aside)
        assert_true(state->latched); /* the alarm must stay latched, and so visible, until somebody resets it */
}

TEST(no_sequence_breaks_what_must_hold)
{
    unsigned seed = 20261120;
    for (int rules = 0; rules < 16; rules++) {
        const struct alarm_rule rule = { .acknowledges = rules & 1, .latches = rules & 2, .forgets = rules & 4, .carried = rules & 8 };
        struct alarm_state now = { 0 };
        for (int i = 0; i < 20000; i++) {
            enum alarm_event event = (enum alarm_event)(rand_r(&seed) % ALARM_EVENTS);
            struct alarm_state before = now;
            enum alarm_outcome outcome = alarm_state_step(&now, &rule, event);
            if (outcome != ALARM_CHANGED)
                assert_memory_equal(&before, &now, sizeof(now));
            check_invariants(&now, &rule);
        }
    }
}

/* --- limits and delays ------------------------------------------------------------------------------------------------------ */

TEST(a_deadband_lies_inside_its_limit)
{
    assert_int_equal(condition_side(ALARM_H, 85, 2, 85), CONDITION_BEYOND); /* a value that equals the limit counts as beyond it */
    assert_int_equal(condition_side(ALARM_H, 85, 2, 83), CONDITION_BETWEEN);
    assert_int_equal(condition_side(ALARM_H, 85, 2, 82.999), CONDITION_CLEAR);
    assert_int_equal(condition_side(ALARM_HH, 85, 0, 84.999), CONDITION_CLEAR);
    assert_int_equal(condition_side(ALARM_L, 0, 1, 0), CONDITION_BEYOND); /* 0 must work both as a limit and as a reading */
    assert_int_equal(condition_side(ALARM_L, 0, 1, 1), CONDITION_BETWEEN);
    assert_int_equal(condition_side(ALARM_LL, 0, 1, 1.001), CONDITION_CLEAR);
    assert_int_equal(condition_side(ALARM_LL, -5, 0, -4.999), CONDITION_CLEAR);
    /* values that equal the limit in the device, but not as a double: one is stored as a 32-bit float, the other is a count
       times a factor */
    assert_int_equal(condition_side(ALARM_H, 0.7, 0, (double)0.7F), CONDITION_BEYOND);
    assert_int_equal(condition_side(ALARM_L, 55.5, 0, 0.555 * 100), CONDITION_BEYOND);
    assert_int_equal(condition_side(ALARM_H, 0.7, 0, 0.699999), CONDITION_CLEAR);
    /* limit 60 °F, deadband 10 °F and value 50 °F: in °C the value must also count as exactly at the end of the deadband,
       despite rounding */
    const double factor = 5 / 9.0, offset = 459.67 * 5 / 9 - 273.15;
    assert_int_equal(condition_side(ALARM_H, 60 * factor + offset, 10 * factor, 50 * factor + offset), CONDITION_BETWEEN);
}

TEST(delays_run_whole)
{
    const struct condition_delays delays = { 3 * S, 5 * S };
    struct condition c = { 0 };
    int64_t at = 0;
    assert_false(condition_put(&c, &delays, CONDITION_BEYOND, 10 * S));
    assert_false(condition_advance(&c, &delays, 13 * S - 1, &at));
    /* the value returns into the deadband before the delay is over, so the delay must start again from zero */
    condition_put(&c, &delays, CONDITION_BETWEEN, 13 * S - 1);
    assert_false(condition_advance(&c, &delays, 20 * S, &at));
    assert_false(condition_put(&c, &delays, CONDITION_BEYOND, 20 * S));
    assert_false(condition_put(&c, &delays, CONDITION_BEYOND, 22 * S));
    assert_true(condition_advance(&c, &delays, 99 * S, &at));
    /* the alarm is dated 23 s, when the delay ended, although the condition was evaluated at 99 s */
    assert_true(c.active && at == 23 * S);
    assert_false(condition_put(&c, &delays, CONDITION_CLEAR, 100 * S));
    condition_hold(&c, 101 * S);
    assert_false(condition_advance(&c, &delays, 200 * S, &at)); /* nothing is known: nothing goes */
    condition_put(&c, &delays, CONDITION_CLEAR, 200 * S);
    assert_true(condition_advance(&c, &delays, 205 * S, &at));
    assert_false(c.active);
}

/* While a tag is Bad, its on delay is suspended: otherwise a tag that is Bad now and then would never raise its alarms. */
TEST(an_on_delay_continues_after_bad_samples)
{
    const struct condition_delays delays = { 3 * S, 5 * S };
    struct condition c = { 0 };
    int64_t at = 0;
    condition_put(&c, &delays, CONDITION_BEYOND, 10 * S);
    condition_hold(&c, 12 * S);
    condition_hold(&c, 13 * S);
    assert_false(condition_is_timed(&c));
    assert_false(condition_advance(&c, &delays, 50 * S, &at));
    condition_put(&c, &delays, CONDITION_BEYOND, 60 * S);
    assert_false(condition_advance(&c, &delays, 61 * S - 1, &at));
    assert_true(condition_advance(&c, &delays, 62 * S, &at));
    assert_true(c.active && at == 61 * S);
    c = (struct condition){ 0 };
    condition_put(&c, &delays, CONDITION_BEYOND, 10 * S);
    condition_hold(&c, 12 * S);
    condition_put(&c, &delays, CONDITION_CLEAR, 13 * S); /* the value is inside the limit again, so the delay starts from zero */
    condition_put(&c, &delays, CONDITION_BEYOND, 14 * S);
    assert_false(condition_advance(&c, &delays, 17 * S - 1, &at));
}

static bool turns(int side, bool active)
{
    return side == (active ? CONDITION_CLEAR : CONDITION_BEYOND);
}

/* Slow reference for the delays: at each second, counts for how many seconds the value has been on the same side, and switches
   the alarm if that is long enough. */
static bool slow_active(const int *sides, int now, const struct condition_delays *delays)
{
    bool active = false;
    for (int t = 0, begin = 0; t <= now; t++) {
        int held = 0;
        while (t - 1 - held >= begin && turns(sides[t - 1 - held], active))
            held++;
        if (held > 0 && held * S >= (active ? delays->off_ns : delays->on_ns)) {
            active = !active;
            begin = t;
        }
        if ((active ? delays->off_ns : delays->on_ns) == 0 && turns(sides[t], active)) {
            active = !active;
            begin = t + 1;
        }
    }
    return active;
}

TEST(what_comes_does_not_depend_on_who_looks)
{
    enum { LENGTH = 60 };
    unsigned seed = 7;
    for (int run = 0; run < 3000; run++) {
        const struct condition_delays delays = { rand_r(&seed) % 5 * S, rand_r(&seed) % 5 * S };
        struct condition seldom = { 0 }, often = { 0 };
        int sides[LENGTH];
        int64_t at;
        for (int t = 0; t < LENGTH; t++)
            sides[t] = rand_r(&seed) % 3 ? t > 0 ? sides[t - 1] : CONDITION_CLEAR : rand_r(&seed) % 3;
        for (int t = 0; t < LENGTH; t++) {
            condition_advance(&seldom, &delays, t * S, &at);
            condition_put(&seldom, &delays, (enum condition_side)sides[t], t * S);
            for (int k = 0; k < 7; k++)
                condition_advance(&often, &delays, t * S - (6 - k) * S / 10, &at);
            condition_put(&often, &delays, (enum condition_side)sides[t], t * S);
            assert_memory_equal(&seldom.active, &often.active, sizeof(bool));
            if (seldom.active != slow_active(sides, t, &delays))
                fail_msg("run %d: at %d s %d, delays %d and %d s", run, t, seldom.active, (int)(delays.on_ns / S),
                         (int)(delays.off_ns / S));
        }
    }
}
