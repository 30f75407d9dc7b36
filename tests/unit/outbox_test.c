/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The outbox of alarm notifications: which recipients get which alarms, in alarm floods, by shift and area, with escalation,
   and after outages and restarts; also the text of the messages. */
#include "tests/support/test.h"
#include <time.h>

#include "base/text/text.h"
#include "notify/notify_text.h"
#include "notify/outbox.h"
#include "notify/shift.h"
#include "tests/support/plant_case.h"

#define S INT64_C(1000000)
#define MIN (60 * S)
#define T0 (INT64_C(1795000000) * S) /* Wednesday 2026-11-18 11:06:40 UTC */
enum { TAGS = 6000, OPS = 0, BOSS = 1, AM = 2 };

struct outbox_fixture {
    struct plant_case *c;
    struct outbox *outbox;
};

static void load(struct outbox_fixture *f, const char *rules)
{
    struct text *yaml = test_text(), *csv = test_text();
    text_add(yaml, "plant: { name: \"Werk Süd\", time_zone: Europe/Berlin }\n"
                    "assets: [{ id: E-1, model: m.glb, area: Tank farm }, { id: E-2, model: m.glb }]\n"
                    "groups: [{ id: t, unit: degC, min: 0, max: 1 }]\nsources: [{ id: a, type: modbus, host: h }]\ntags: tags.csv\n"
                    "notify:\n  gather_s: 3\n  pause_s: 60\n  link: https://p.example/\n"
                    "  mail: { server: \"smtps://m.example\", from: plant@p.example }\n  recipients:\n"
                    "  - { id: ops, email: [ops@p.example, b@p.example] }\n  - { id: boss, webhook: \"https://h.example/\" }\n"
                    "  - { id: am, alertmanager: \"http://127.0.0.1:9093\" }\n  rules:\n%s",
             rules);
    text_add(csv, "Tag Name,Address,Source,Group,Asset,X,Y,Z,Description\n");
    for (int i = 0; i < TAGS; i++)
        text_add(csv, "T%04d,%d,a,t,E-%d,0,0,0,%s\n", i, 40001 + i, 1 + i % 2, i == 0 ? "\"Kessel 1, heiß\"" : "");
    outbox_destroy(&f->outbox);
    plant_case_load(f->c, yaml->at, csv->at);
    if (!f->c->plant)
        diag_print(&f->c->diag, stderr);
    assert_non_null(f->c->plant);
    f->outbox = outbox_create(f->c->plant);
}

static int set_up(void **state)
{
    struct outbox_fixture *f = mem_new(sizeof(*f));
    setenv("TZ", "Europe/Berlin", 1);
    tzset();
    *state = f;
    return plant_case_set_up((void **)&f->c);
}

static int tear_down(void **state)
{
    struct outbox_fixture *f = *state;
    outbox_destroy(&f->outbox);
    plant_case_tear_down((void **)&f->c);
    mem_free(f);
    return 0;
}

#define CASE(name) TEST_ON(struct outbox_fixture *f, name, set_up, tear_down)

enum { LOCAL, DISPLAY };

static struct alarm alarm_of(const struct outbox_fixture *f, int tag, int mode, bool active, bool unacknowledged, int64_t raised_us)
{
    return (struct alarm){ .name = f->c->plant->tags[tag].name,
                           .tag = tag,
                           .kind = ALARM_HH,
                           .priority = 1 + tag % 4,
                           .limit = 90,
                           .value = 95.5,
                           .rule = { .acknowledges = mode == LOCAL },
                           .state = { .active = active, .unacknowledged = mode == LOCAL && unacknowledged },
                           .raised_utc_ns = raised_us * 1000 };
}

static void put(struct outbox_fixture *f, int tag, int mode, bool active, bool unacknowledged, int64_t raised_us, int64_t now_us)
{
    struct alarm alarm = alarm_of(f, tag, mode, active, unacknowledged, raised_us);
    outbox_put(f->outbox, &alarm, false, now_us);
}

/* Delivers the message that is due for a recipient, and returns the number of alarms in it; 0: no message is due. */
static size_t deliver(struct outbox_fixture *f, int recipient, int64_t now_us)
{
    struct outbox_message message;
    outbox_tick(f->outbox, now_us);
    if (!outbox_next(f->outbox, recipient, now_us, &message))
        return 0;
    size_t count = message.count;
    outbox_sent(f->outbox, recipient, now_us);
    return count;
}

static void restart(struct outbox_fixture *f)
{
    json_t *saved = outbox_save(f->outbox);
    assert_non_null(saved);
    outbox_destroy(&f->outbox);
    f->outbox = outbox_create(f->c->plant);
    assert_true(outbox_restore(f->outbox, saved));
    json_decref(saved);
}

CASE(a_flood_is_one_message)
{
    load(f, "  - { id: all, to: ops }\n  - { id: too, priority: 2, to: ops }\n");
    for (int i = 0; i < 500; i++)
        put(f, i, LOCAL, true, true, T0, T0 + i * S / 500);
    assert_int_equal(deliver(f, OPS, T0 + 2 * S), 0);
    assert_int_equal(deliver(f, OPS, T0 + 4 * S), 500); /* 500 alarms in one message: each alarm once, even if two rules match it */
    for (int s = 5; s < 200; s++)
        assert_int_equal(deliver(f, OPS, T0 + s * S), 0);
    assert_int_equal(outbox_counts(f->outbox, OPS).waiting, 0);
}

CASE(what_is_more_urgent_does_not_wait_for_the_pause)
{
    load(f, "  - { id: all, to: ops }\n");
    put(f, 3, LOCAL, true, true, T0, T0); /* priority 4 */
    assert_int_equal(deliver(f, OPS, T0 + 3 * S), 1);
    put(f, 7, LOCAL, true, true, T0 + 5 * S, T0 + 5 * S);
    assert_int_equal(deliver(f, OPS, T0 + 10 * S), 0);
    put(f, 0, LOCAL, true, true, T0 + 10 * S, T0 + 10 * S); /* priority 1 */
    assert_int_equal(deliver(f, OPS, T0 + 13 * S), 2);
    put(f, 4, LOCAL, true, true, T0 + 14 * S, T0 + 14 * S); /* as urgent as the last */
    assert_int_equal(deliver(f, OPS, T0 + 72 * S), 0);
    assert_int_equal(deliver(f, OPS, T0 + 73 * S), 1);
}

CASE(rules_choose_by_priority_area_and_shift)
{
    load(f, "  - { id: urgent, priority: 1, to: ops }\n"
            "  - { id: tanks, areas: \"Tank*\", hours: \"06:00-14:00\", days: mon-fri, to: boss }\n");
    const struct plant *plant = f->c->plant;
    const int64_t noon = T0; /* 12:06 in Berlin */
    assert_int_equal(rules_for(plant, "T0000", 0, 1, noon), 3);
    /* this tag's asset E-2 is in another area, so only one of the rules applies */
    assert_int_equal(rules_for(plant, "T0001", 1, 1, noon), 1);
    assert_int_equal(rules_for(plant, "T0002", 2, 2, noon), 2);
    assert_int_equal(rules_for(plant, "T0002", 2, 2, noon + 2 * 3600 * S), 0);
    assert_int_equal(rules_for(plant, "T0002", 2, 2, noon + 3 * 86400 * S), 0); /* Saturday */
    assert_int_equal(rules_for(plant, "plc1", -1, 2, noon), 0);
    assert_int_equal(rules_for(plant, "Tank plc", -1, 2, noon), 2);
}

static bool on(const struct notify_shift *shift, const char *utc)
{
    struct tm tm = { 0 };
    assert_non_null(strptime(utc, "%Y-%m-%dT%H:%M", &tm));
    return shift_is_on(shift, (int64_t)timegm(&tm) * S);
}

CASE(shifts_keep_to_the_wall_clock)
{
    const struct notify_shift friday_night = { .days = 1 << 4, .from_min = 22 * 60, .to_min = 6 * 60 };
    assert_false(on(&friday_night, "2026-11-20T20:59")); /* Friday, 21:59 in Berlin */
    assert_true(on(&friday_night, "2026-11-20T21:00"));
    assert_true(on(&friday_night, "2026-11-21T04:59"));
    assert_false(on(&friday_night, "2026-11-21T05:00"));
    /* false: at 04:00 on Friday, the night shift that began on Thursday is on, not Friday's */
    assert_false(on(&friday_night, "2026-11-20T04:00"));
    const struct notify_shift sunday_night = { .days = 1 << 5, .from_min = 22 * 60, .to_min = 6 * 60 };
    /* true: the clocks were set back at 01:00 UTC in this night, so the shift until 06:00 local time is an hour longer */
    assert_true(on(&sunday_night, "2026-10-25T04:59"));
    assert_false(on(&sunday_night, "2026-10-25T05:00"));
    const struct notify_shift all_day = { .days = 1 << 6 };
    assert_true(on(&all_day, "2026-11-22T10:00"));
    assert_false(on(&all_day, "2026-11-23T10:00"));
}

CASE(it_escalates_until_acknowledged)
{
    load(f, "  - { id: all, to: ops, escalate: [{ after_min: 10, to: boss }, { after_min: 20, to: [ops, boss] }] }\n");
    put(f, 0, LOCAL, true, true, T0, T0);
    put(f, 1, LOCAL, true, true, T0, T0);
    assert_int_equal(deliver(f, OPS, T0 + 3 * S), 2);
    put(f, 1, LOCAL, true, false, T0, T0 + 5 * MIN);  /* acknowledged */
    /* alarm 0 has returned to normal but is not acknowledged, so it must still be escalated */
    put(f, 0, LOCAL, false, true, T0, T0 + 6 * MIN);
    assert_int_equal(deliver(f, BOSS, T0 + 10 * MIN - S), 0);
    restart(f);
    assert_int_equal(deliver(f, BOSS, T0 + 10 * MIN), 0);
    assert_int_equal(deliver(f, BOSS, T0 + 10 * MIN + 3 * S), 1);
    assert_int_equal(deliver(f, OPS, T0 + 20 * MIN), 0);
    assert_int_equal(deliver(f, OPS, T0 + 20 * MIN + 3 * S), 1);
    put(f, 0, LOCAL, false, false, T0, T0 + 21 * MIN);
    assert_int_equal(deliver(f, OPS, T0 + 60 * MIN), 0);
    /* the second escalation, due at 20 minutes, had waited until it is taken here */
    assert_int_equal(deliver(f, BOSS, T0 + 60 * MIN), 1);
    assert_int_equal(deliver(f, BOSS, T0 + 90 * MIN), 0);
    put(f, 0, LOCAL, true, true, T0 + 91 * MIN, T0 + 91 * MIN); /* the alarm is raised again */
    assert_int_equal(deliver(f, OPS, T0 + 91 * MIN + 3 * S), 1);
}

CASE(nobody_is_told_twice_after_a_restart)
{
    load(f, "  - { id: all, to: [ops, boss] }\n");
    put(f, 0, LOCAL, true, true, T0, T0);
    assert_int_equal(deliver(f, OPS, T0 + 3 * S), 1);
    struct outbox_message message;
    /* takes a message and does not report its result, as if the daemon were killed while sending it */
    assert_true(outbox_next(f->outbox, BOSS, T0 + 3 * S, &message));
    char id[OUTBOX_ID_BYTES];
    memcpy(id, message.id, sizeof(id));
    restart(f);
    struct alarm old = alarm_of(f, 0, LOCAL, true, true, T0), settled = alarm_of(f, 1, LOCAL, true, false, T0 - S);
    struct alarm missed = alarm_of(f, 2, LOCAL, true, true, T0 + 4 * S);
    outbox_put(f->outbox, &old, true, T0 + 10 * S);
    /* `settled` was acknowledged before its notification was due, so none must be sent */
    outbox_put(f->outbox, &settled, true, T0 + 10 * S);
    /* `missed` was raised just before the daemon ended: it is in the journal, but not in the outbox's file */
    outbox_put(f->outbox, &missed, true, T0 + 10 * S);
    assert_true(outbox_next(f->outbox, BOSS, T0 + 10 * S, &message));
    assert_int_equal(message.count, 1);
    /* the message that was being sent is sent again with the same id, so that receivers can recognise the repetition */
    assert_string_equal(message.id, id);
    outbox_sent(f->outbox, BOSS, T0 + 10 * S);
    assert_int_equal(deliver(f, OPS, T0 + 70 * S), 1);
    assert_int_equal(deliver(f, BOSS, T0 + 70 * S), 1);
    assert_int_equal(deliver(f, OPS, T0 + 300 * S), 0);
}

CASE(an_outage_delays_and_does_not_multiply)
{
    load(f, "  - { id: all, to: ops }\n");
    struct outbox_message message;
    int tries = 0;
    put(f, 0, LOCAL, true, true, T0, T0);
    for (int s = 3; s < 600; s++) {
        if (s % 10 == 0)
            put(f, s, LOCAL, true, true, T0 + s * S, T0 + s * S);
        outbox_tick(f->outbox, T0 + s * S);
        if (!outbox_next(f->outbox, OPS, T0 + s * S, &message))
            continue;
        tries++;
        assert_int_equal(message.count, 1);
        outbox_failed(f->outbox, OPS, false, T0 + s * S);
        if (tries % 8 == 0)
            restart(f);
    }
    assert_in_range(tries, 10, 40);
    assert_int_equal(deliver(f, OPS, T0 + 660 * S), 1);
    assert_int_equal(deliver(f, OPS, T0 + 720 * S), 59);
    assert_int_equal(deliver(f, OPS, T0 + 900 * S), 0);
    assert_int_equal(outbox_counts(f->outbox, OPS).lost, 0);
}

/* A receiver that refuses a message for good, for example because of its size, must not hold up later alarms. */
CASE(a_refused_message_is_shortened_and_then_dropped)
{
    struct outbox_message message;
    char id[OUTBOX_ID_BYTES];
    load(f, "  - { id: all, to: ops }\n");
    for (int i = 0; i < 400; i++)
        put(f, i, LOCAL, true, true, T0, T0);
    assert_true(outbox_next(f->outbox, OPS, T0 + 4 * S, &message));
    assert_int_equal(message.count, 400);
    memcpy(id, message.id, sizeof(id));
    assert_int_equal(outbox_failed(f->outbox, OPS, true, T0 + 4 * S), OUTBOX_SHORTENED);
    restart(f);
    assert_true(outbox_next(f->outbox, OPS, T0 + 4 * S, &message)); /* the shortened message is due at once */
    assert_int_equal(message.count, OUTBOX_SHORT);
    assert_int_equal(message.left_out, 400 - OUTBOX_SHORT);
    assert_int_equal(message.items[OUTBOX_SHORT - 1].priority, 1); /* the most urgent alarms stay */
    assert_string_not_equal(message.id, id);
    assert_int_equal(outbox_failed(f->outbox, OPS, true, T0 + 5 * S), OUTBOX_DROPPED);
    assert_int_equal(outbox_counts(f->outbox, OPS).waiting, 0);
    assert_int_equal(outbox_counts(f->outbox, OPS).lost, OUTBOX_SHORT); /* counted since the restart */
    put(f, 400, LOCAL, true, true, T0 + 6 * S, T0 + 6 * S);
    outbox_tick(f->outbox, T0 + 10 * S);
    assert_true(outbox_next(f->outbox, OPS, T0 + 10 * S, &message));
    assert_int_equal(message.count, 1);
    assert_int_equal(message.left_out, 400);
    outbox_sent(f->outbox, OPS, T0 + 10 * S);
    assert_int_equal(deliver(f, OPS, T0 + 200 * S), 0);
}

CASE(what_waits_is_bounded_and_said)
{
    load(f, "  - { id: all, to: ops }\n");
    struct outbox_message message;
    put(f, 5999, LOCAL, true, true, T0, T0);
    assert_true(outbox_next(f->outbox, OPS, T0 + 3 * S, &message));
    outbox_failed(f->outbox, OPS, false, T0 + 3 * S);
    for (int i = 0; i < 5998; i++)
        put(f, i, LOCAL, true, true, T0 + 4 * S, T0 + 4 * S);
    assert_int_equal(outbox_counts(f->outbox, OPS).waiting, OUTBOX_ITEMS);
    assert_int_equal(outbox_counts(f->outbox, OPS).lost, 999);
    assert_true(outbox_next(f->outbox, OPS, T0 + 60 * S, &message));
    assert_int_equal(message.left_out, 999);
    outbox_sent(f->outbox, OPS, T0 + 60 * S);
    assert_int_equal(deliver(f, OPS, T0 + 200 * S), OUTBOX_ITEMS - 1);
    /* the delivery of this alarm fails for longer than OUTBOX_KEEP_US, so it must be dropped and counted as lost */
    put(f, 5998, LOCAL, true, true, T0 + 300 * S, T0 + 300 * S);
    assert_true(outbox_next(f->outbox, OPS, T0 + 303 * S, &message));
    outbox_failed(f->outbox, OPS, false, T0 + 303 * S);
    outbox_tick(f->outbox, T0 + 303 * S + OUTBOX_KEEP_US + S);
    assert_int_equal(outbox_counts(f->outbox, OPS).waiting, 0);
    assert_int_equal(outbox_counts(f->outbox, OPS).lost, 1000);
}

CASE(what_chatters_is_told_once_in_ten_minutes)
{
    load(f, "  - { id: all, to: ops }\n");
    size_t told = 0;
    for (int s = 0; s < 1500; s++) {
        put(f, 0, DISPLAY, s % 20 < 10, false, T0 + s / 20 * 20 * S, T0 + s * S);
        told += deliver(f, OPS, T0 + s * S);
    }
    assert_int_equal(told, 3);
}

CASE(what_came_and_went_between_two_looks_is_told)
{
    load(f, "  - { id: all, to: ops }\n");
    put(f, 0, DISPLAY, false, false, T0, T0 + S / 2);
    struct outbox_message message;
    assert_true(outbox_next(f->outbox, OPS, T0 + 4 * S, &message));
    assert_int_equal(message.count, 1);
    assert_true(message.items[0].ended_us > 0);
}

TEST_WITH(what_is_set_aside_is_not_told, set_up, tear_down)
{
    struct outbox_fixture *f = *state;
    load(f, "  - { id: all, to: ops }\n");
    struct alarm alarm = alarm_of(f, 0, LOCAL, true, true, T0);
    outbox_put(f->outbox, &alarm, false, T0);
    alarm.state.unacknowledged = false;
    /* the tag's device is lost, which is notified once for the device, so the alarm of this tag must not be sent */
    alarm.state.aside = ALARM_ASIDE_CARRIED;
    outbox_put(f->outbox, &alarm, false, T0 + S);
    assert_int_equal(deliver(f, OPS, T0 + 4 * S), 0);
    assert_int_equal(outbox_counts(f->outbox, OPS).waiting, 0);
}

CASE(alertmanager_hears_what_stands_and_what_has_ended)
{
    load(f, "  - { id: all, to: am }\n");
    struct outbox_message message;
    put(f, 0, LOCAL, true, true, T0, T0);
    put(f, 1, LOCAL, true, true, T0, T0);
    assert_int_equal(deliver(f, AM, T0 + 3 * S), 2);
    put(f, 1, LOCAL, true, false, T0, T0 + 10 * S); /* acknowledged, but still active */
    assert_int_equal(deliver(f, AM, T0 + 13 * S), 2);
    put(f, 1, LOCAL, false, false, T0, T0 + 20 * S);
    assert_true(outbox_next(f->outbox, AM, T0 + 23 * S, &message));
    char *text = test_memory(notify_alerts_text(f->c->plant, &message, T0 + 23 * S));
    json_t *alerts = test_json(json_loads(text, 0, NULL));
    assert_int_equal(json_array_size(alerts), 2);
    const json_t *one = json_array_get(alerts, 0), *two = json_array_get(alerts, 1);
    assert_string_equal(json_string_value(json_object_get(json_object_get(one, "labels"), "tag")), "T0000");
    assert_string_equal(json_string_value(json_object_get(json_object_get(one, "labels"), "area")), "Tank farm");
    assert_string_equal(json_string_value(json_object_get(one, "startsAt")), "2026-11-18T11:06:40.000Z");
    /* time at which Alertmanager ends the alert unless it gets an update */
    assert_string_equal(json_string_value(json_object_get(one, "endsAt")), "2026-11-18T11:12:03.000Z");
    assert_string_equal(json_string_value(json_object_get(two, "endsAt")), "2026-11-18T11:07:00.000Z");
    outbox_sent(f->outbox, AM, T0 + 23 * S);
    assert_int_equal(deliver(f, AM, T0 + 60 * S), 0);
    assert_int_equal(deliver(f, AM, T0 + 83 * S), 1);
}

CASE(what_ended_while_nobody_looked_is_over)
{
    load(f, "  - { id: all, to: [ops, am], escalate: [{ after_min: 10, to: boss }] }\n");
    put(f, 0, LOCAL, true, true, T0, T0);
    put(f, 1, LOCAL, true, true, T0, T0);
    assert_int_equal(deliver(f, OPS, T0 + 3 * S), 2);
    assert_int_equal(deliver(f, AM, T0 + 3 * S), 2);
    restart(f);
    struct alarm stands = alarm_of(f, 1, LOCAL, true, true, T0);
    /* after the restart alarm 0 is not reported to the outbox, as happens if its limit was removed from the plant */
    outbox_put(f->outbox, &stands, true, T0 + 60 * S);
    outbox_end_unseen(f->outbox, T0 + 60 * S);
    assert_int_equal(deliver(f, BOSS, T0 + 10 * MIN), 0);
    assert_int_equal(deliver(f, BOSS, T0 + 10 * MIN + 3 * S), 1);
    /* two alarms: the one that is still active, and alarm 0, which Alertmanager must learn has ended */
    assert_int_equal(deliver(f, AM, T0 + 10 * MIN + 3 * S), 2);
    assert_int_equal(deliver(f, AM, T0 + 30 * MIN), 1);
}

CASE(it_escalates_after_the_clock_was_set_back)
{
    int64_t before = T0 - 24 * 60 * MIN;
    load(f, "  - { id: all, to: ops, escalate: [{ after_min: 10, to: boss }] }\n");
    put(f, 0, LOCAL, true, true, T0, T0);
    assert_int_equal(deliver(f, OPS, T0 + 3 * S), 1);
    assert_int_equal(deliver(f, BOSS, before), 0);
    assert_int_equal(deliver(f, BOSS, before + 10 * MIN), 0);
    assert_int_equal(deliver(f, BOSS, before + 10 * MIN + 3 * S), 1);
}

CASE(an_alarm_that_returns_after_the_clock_was_set_back_is_told)
{
    int64_t before = T0 - 24 * 60 * MIN;
    load(f, "  - { id: all, to: ops }\n");
    put(f, 0, DISPLAY, true, false, T0, T0);
    assert_int_equal(deliver(f, OPS, T0 + 3 * S), 1);
    put(f, 0, DISPLAY, false, false, T0, T0 + 10 * S);
    put(f, 0, DISPLAY, true, false, before, before);
    assert_int_equal(deliver(f, OPS, before + 3 * S), 1);
}

CASE(alertmanager_gets_alerts_after_the_clock_was_set_back)
{
    struct outbox_message message;
    int64_t before = T0 - 60 * MIN;
    load(f, "  - { id: all, to: am }\n");
    put(f, 0, LOCAL, true, true, T0, T0);
    assert_true(outbox_next(f->outbox, AM, T0 + 3 * S, &message));
    /* a message to Alertmanager is retried even if it is refused; the retry is due 1 s later */
    assert_int_equal(outbox_failed(f->outbox, AM, true, T0 + 3 * S), OUTBOX_RETRIED);
    assert_false(outbox_next(f->outbox, AM, T0 + 3 * S, &message));
    assert_int_equal(deliver(f, AM, before), 1);
    put(f, 1, LOCAL, true, true, before + 10 * S, before + 10 * S);
    assert_int_equal(deliver(f, AM, before + 13 * S), 2);
    /* alarm 2 ends before a second step, alarm 1 afterwards, before the next message */
    put(f, 2, LOCAL, true, false, before + 20 * S, before + 20 * S);
    put(f, 2, LOCAL, false, false, before + 20 * S, before + 21 * S);
    assert_int_equal(deliver(f, AM, before + 24 * S), 3);
    before -= 60 * MIN;
    put(f, 1, LOCAL, false, false, before + 10 * S, before);
    outbox_tick(f->outbox, before + MIN);
    assert_true(outbox_next(f->outbox, AM, before + MIN, &message));
    assert_int_equal(message.count, 3);
    json_t *alerts = test_json(json_loads(test_memory(notify_alerts_text(f->c->plant, &message, before + MIN)), 0, NULL));
    const char *now = "2026-11-18T09:07:40.000Z";
    int ended = 0;
    for (size_t i = 0; i < 3; i++) {
        const json_t *alert = json_array_get(alerts, i);
        const char *start = json_string_value(json_object_get(alert, "startsAt"));
        const char *end = json_string_value(json_object_get(alert, "endsAt"));
        assert_true(strcmp(start, end) <= 0); /* Alertmanager refuses an alert that starts after it ends */
        ended += strcmp(end, now) <= 0;
    }
    assert_int_equal(ended, 2); /* an alert whose end is in the future is active */
}

CASE(an_undeliverable_message_is_given_up_after_the_clock_was_set_back)
{
    struct outbox_message message;
    int64_t before = T0 - INT64_C(365) * 24 * 60 * MIN;
    load(f, "  - { id: all, to: ops }\n");
    put(f, 0, LOCAL, true, true, T0, T0);
    assert_true(outbox_next(f->outbox, OPS, T0 + 3 * S, &message));
    outbox_failed(f->outbox, OPS, false, T0 + 4 * S);
    outbox_tick(f->outbox, before);
    restart(f);
    outbox_tick(f->outbox, before + 24 * 60 * MIN);
    assert_int_equal(outbox_counts(f->outbox, OPS).lost, 0);
    outbox_tick(f->outbox, before + 24 * 60 * MIN + S);
    assert_int_equal(outbox_counts(f->outbox, OPS).lost, 1);
}

CASE(a_clock_that_jumps_ahead_loses_nothing_later)
{
    struct outbox_message message;
    int64_t later = T0 + 48 * 60 * MIN;
    load(f, "  - { id: all, to: [ops, am] }\n");
    put(f, 0, LOCAL, true, true, T0, T0);
    assert_int_equal(deliver(f, OPS, T0 + 3 * S), 1);
    assert_true(outbox_next(f->outbox, AM, T0 + 3 * S, &message));
    outbox_failed(f->outbox, AM, false, T0 + 4 * S);
    assert_true(outbox_next(f->outbox, AM, T0 + 2 * MIN, &message));
    outbox_tick(f->outbox, later); /* while the message is being sent again, the clock jumps to `later` */
    put(f, 1, LOCAL, true, true, later, later);
    assert_int_equal(deliver(f, OPS, later + 3 * S), 1);
    assert_int_equal(outbox_counts(f->outbox, OPS).lost, 0);
}

static char *decoded(const char *base64)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    struct text out = { 0 };
    unsigned bits = 0;
    int count = 0;
    for (; *base64; base64++) {
        const char *digit = strchr(digits, *base64);
        if (!digit)
            continue;
        bits = bits << 6 | (unsigned)(digit - digits);
        if ((count += 6) >= 8)
            text_add_bytes(&out, &(char){ (char)(bits >> (count -= 8)) }, 1);
    }
    return out.at;
}

CASE(a_mail_says_what_and_since_when)
{
    load(f, "  - { id: all, to: [ops, boss] }\n");
    struct outbox_message message;
    struct text *mail = test_text();
    put(f, 0, LOCAL, true, true, T0, T0);
    assert_true(outbox_next(f->outbox, OPS, T0 + 3 * S, &message));
    notify_mail_text(mail, f->c->plant, &f->c->plant->notify->recipients[OPS], &message, T0 + 3 * S);
    assert_non_null(strstr(mail->at, "From: plant@p.example\r\nTo: ops@p.example,\r\n b@p.example\r\nSubject: =?UTF-8?B?"));
    assert_non_null(strstr(mail->at, "\r\nDate: Wed, 18 Nov 2026 11:06:43 +0000\r\nMessage-ID: <"));
    for (const char *line = mail->at, *end; (end = strstr(line, "\r\n")); line = end + 2)
        assert_true(end - line <= 78);
    char *subject = test_memory(decoded(strstr(mail->at, "?B?") + 3)), *body = test_memory(decoded(strstr(mail->at, "\r\n\r\n")));
    assert_int_equal(strncmp(subject, "[Werk Süd] P1 T0000 high high", strlen("[Werk Süd] P1 T0000 high high")), 0);
    assert_non_null(strstr(body, "P1  2026-11-18 12:06:40  T0000 high high, Kessel 1, heiß: raised at 95.5 degC (limit 90 degC); E-1, "
                                 "Tank farm\r\n"));
    assert_non_null(strstr(body, "Time zone of all times: Europe/Berlin. https://p.example/\r\n"));
    char *json = test_memory(notify_webhook_text(f->c->plant, &f->c->plant->notify->recipients[BOSS], &message));
    assert_non_null(strstr(json, "\"plant\":\"Werk Süd\""));
    assert_non_null(strstr(json, "\"raised\":\"2026-11-18T11:06:40.000Z\",\"value\":95.5,\"limit\":90.0,\"unit\":\"degC\""));
}

/* The text of an escalation. If alarms are acknowledged in the control system instead of in Plantcast, Plantcast does not know
   whether that has happened, so the mail must say "Still present" instead of "Not acknowledged". */
CASE(an_escalated_mail_says_only_what_is_known)
{
    load(f, "  - { id: all, to: boss, escalate: [{ after_min: 10, to: ops }] }\n");
    static const char *const said[] = { [LOCAL] = "Not acknowledged", [DISPLAY] = "Still present" };
    for (int mode = LOCAL; mode <= DISPLAY; mode++) {
        struct outbox_message message;
        struct text mail = { 0 };
        int64_t raised_us = T0 + mode * 60 * MIN;
        put(f, mode, mode, true, true, raised_us, raised_us);
        outbox_tick(f->outbox, raised_us + 10 * MIN);
        assert_true(outbox_next(f->outbox, OPS, raised_us + 10 * MIN + 3 * S, &message));
        notify_mail_text(&mail, f->c->plant, &f->c->plant->notify->recipients[OPS], &message, raised_us + 11 * MIN);
        char *subject = test_memory(decoded(strstr(mail.at, "?B?") + 3)), *body = test_memory(decoded(strstr(mail.at, "\r\n\r\n")));
        assert_non_null(strstr(subject, said[mode]));
        assert_non_null(strstr(body, said[mode]));
        assert_null(strstr(body, said[1 - mode]));
        outbox_sent(f->outbox, OPS, raised_us + 11 * MIN);
        put(f, mode, mode, false, false, raised_us, raised_us + 12 * MIN);
        text_finish(&mail);
    }
}

/* The tag's unit changes while a message waits: value and limit in the message must be converted to the new unit, or left out
   if that is impossible. */
CASE(a_message_that_waits_has_the_present_unit)
{
    static const struct {
        const char *unit;
        double value, limit;
    } cases[] = { { "degF", 203.9, 194 }, { "bar", NAN, NAN } };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct outbox_message message;
        load(f, "  - { id: all, to: ops }\n");
        put(f, 0, LOCAL, true, true, T0, T0);
        json_t *saved = test_json(outbox_save(f->outbox));
        outbox_tick(f->outbox, T0 + 4 * S);
        mem_free(f->c->plant->tags[0].unit);
        f->c->plant->tags[0].unit = mem_strdup(cases[i].unit);
        outbox_destroy(&f->outbox);
        f->outbox = outbox_create(f->c->plant);
        assert_true(outbox_restore(f->outbox, saved));
        outbox_tick(f->outbox, T0 + 4 * S);
        assert_true(outbox_next(f->outbox, OPS, T0 + 4 * S, &message));
        const struct outbox_item *item = &message.items[0];
        assert_true(isnan(cases[i].value) ? isnan(item->value) && isnan(item->limit)
                                          : fabs(item->value - cases[i].value) < 1e-9 && fabs(item->limit - cases[i].limit) < 1e-9);
    }
}

CASE(a_damaged_file_is_refused)
{
    load(f, "  - { id: all, to: ops }\n");
    static const char *const texts[] = { "{}", "[]", "{\"version\":2}",
                                         "{\"version\":1,\"alarms\":[1,{\"name\":\"T0000\",\"kind\":\"XX\"},{\"name\":\"T0000\",\"kind\":"
                                         "\"HH\",\"priority\":99,\"steps\":{\"all\":-7}}],\"recipients\":{\"ops\":{\"waiting\":[{}],"
                                         "\"message\":[[]],\"last_priority\":-5}}}" };
    for (int i = 0; i < 4; i++) {
        json_t *saved = test_json(json_loads(texts[i], 0, NULL));
        assert_non_null(saved);
        assert_int_equal(outbox_restore(f->outbox, saved), i == 3);
    }
    put(f, 0, LOCAL, true, true, T0, T0);
    deliver(f, OPS, T0 + 4 * S);
}

/* outbox_rests() tells the notifier that it may sleep until the next change of an alarm; that is allowed only if nothing is due
   later. */
CASE(it_rests_when_time_changes_nothing)
{
    load(f, "  - { id: all, to: [ops, am] }\n");
    outbox_tick(f->outbox, T0);
    assert_true(outbox_rests(f->outbox));
    put(f, 0, LOCAL, true, true, T0, T0);
    assert_false(outbox_rests(f->outbox));
    deliver(f, OPS, T0 + 4 * S);
    assert_false(outbox_rests(f->outbox)); /* the alarm may still escalate */
    put(f, 0, LOCAL, false, false, T0, T0 + 5 * S);
    assert_false(outbox_rests(f->outbox)); /* not at rest: an update to Alertmanager is due later */
    deliver(f, AM, T0 + 9 * S);
    outbox_tick(f->outbox, T0 + 24 * 60 * MIN);
    assert_true(outbox_rests(f->outbox));
}
