/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Alarms of a plant, driven by samples, time and operators, in all three alarm modes, and after a restart or a reload. */
#include "tests/support/test.h"

#include "alarm/alarms.h"
#include "alarm/devices.h"
#include "tests/support/plant_by_hand.h"
#include "value/quality.h"

#define S INT64_C(1000000000)
#define UTC (1000000 * S)

/* fixture. Limits: TT: LL 0, L 10, H 80, HH 90; PT: H 5 with a delay of 2 s; SD: a bit that suppresses PT; B1, B2: alarm
   bits of a DCS */
struct stage {
    struct plant *plant;
    struct alarms *alarms;
    struct snapshot *snapshot;
    char log[4000]; /* one line of text for each alarm event since the last check */
    int told[8];    /* by tag: kind of the most severe alarm in the last call of on_tag() */
};

static void on_change(void *arg, const struct alarm_change *change)
{
    struct stage *s = arg;
    size_t n = strlen(s->log);
    snprintf(s->log + n, sizeof(s->log) - n, "%d %s.%s %s: %s > %s%s%s\n", (int)((change->utc_ns - UTC) / S), change->alarm->name,
             alarm_kind_name(change->alarm->kind), alarm_event_name(change->event), alarm_status_name(change->before),
             alarm_status_name(change->after), change->who[0] ? " by " : "", change->who);
}

static void on_tag(void *arg, int tag, enum alarm_kind kind, enum alarm_status word)
{
    (void)word;
    ((struct stage *)arg)->told[tag] = (int)kind;
}

static void stage_destroy(void *resource)
{
    struct stage *s = resource;
    alarms_destroy(&s->alarms);
    alarms_destroy(&s->alarms);
    mem_free(s);
}

/* Returns a stage with a plant but no alarms yet. The stage is freed automatically after the test. */
static struct stage *stage_with_plant(enum alarm_mode mode)
{
    static const double tt[4] = { 0, 10, 80, 90 }, pt[4] = { NAN, NAN, 5, NAN }, none[4] = { NAN, NAN, NAN, NAN };
    static const char *const names[] = { "TT", "PT", "SD", "B1", "B2" };
    struct stage *s = mem_new(sizeof(*s));
    s->plant = plant_by_hand_create(8);
    plant_by_hand_source(s->plant, "a", 1);
    for (int i = 0; i < 5; i++) {
        struct plant_tag *tag = plant_by_hand_tag(s->plant, names[i], TABLE_HOLDING, i, i < 2 ? DATA_INT16 : DATA_BIT);
        memcpy(tag->alarms.limits, i == 0 ? tt : i == 1 ? pt : none, sizeof(tag->alarms.limits));
        tag->alarms.settings.deadband = i == 0 ? 2 : 0;
        tag->alarms.settings.on_delay_s = i == 1 ? 2 : 0;
    }
    s->plant->tags[1].alarms.suppressed_by = 2;
    if (mode == ALARMS_MIRROR) {
        s->plant->tags[3].alarms.mirror = (struct plant_mirror){ 0, LIMIT_HH, false };
        s->plant->tags[4].alarms.mirror = (struct plant_mirror){ 0, LIMIT_HH, true };
    }
    s->plant->alarms = mode;
    owned_add(stage_destroy, s);
    return s;
}

static void start(struct stage *s)
{
    s->alarms = alarms_create(s->plant, &(struct alarms_listener){ on_change, on_tag, s });
    s->snapshot = test_snapshot(5);
}

static struct stage *stage_create(enum alarm_mode mode)
{
    struct stage *s = stage_with_plant(mode);
    start(s);
    return s;
}

static void hear(struct stage *s, int second, int tag, double value, uint32_t quality)
{
    struct reading *reading = &s->snapshot->readings[tag];
    *reading = (struct reading){ .value = quality_is_bad(quality) ? 0 : value, .quality = quality };
    alarms_put(s->alarms, &(struct sample_event){ tag, quality_is_bad(quality) ? NAN : value, quality, second * S, UTC + second * S }, 1);
}

/* Gives all five tags this value and quality, in one call, as when a device is lost or comes back. */
static void hear_all(struct stage *s, int second, double value, uint32_t quality)
{
    struct sample_event heard[5];
    for (int tag = 0; tag < 5; tag++) {
        s->snapshot->readings[tag] = (struct reading){ .value = quality_is_bad(quality) ? 0 : value, .quality = quality };
        heard[tag] = (struct sample_event){ tag, quality_is_bad(quality) ? NAN : value, quality, second * S, UTC + second * S };
    }
    alarms_put(s->alarms, heard, 5);
}

static void set_all(struct stage *s, uint32_t quality)
{
    for (int tag = 0; tag < 5; tag++)
        s->snapshot->readings[tag].quality = quality;
}

static void tick(struct stage *s, int second)
{
    s->snapshot->taken_mono_ns = second * S;
    s->snapshot->taken_utc_ns = UTC + second * S;
    alarms_tick(s->alarms, s->snapshot);
}

static struct instant at(int second)
{
    return (struct instant){ second * S, UTC + second * S };
}

static const char *word(const struct stage *s, int tag, enum alarm_kind kind)
{
    return alarm_status_name(alarm_status_of(alarms_at(s->alarms, alarms_find(s->alarms, tag, kind))));
}

static enum refusal_code act(struct stage *s, int second, int tag, enum alarm_kind kind, enum alarm_event event, int for_s)
{
    const struct alarm_act wish = { event, for_s * S, "kim", event == ALARM_SHELVE ? "transmitter is being changed" : "" };
    return alarms_act(s->alarms, alarms_find(s->alarms, tag, kind), &wish, at(second));
}

/* Asserts that the alarm events since the last call, one line each, equal `wanted`. */
static void assert_told(struct stage *s, const char *wanted)
{
    assert_string_equal(s->log, wanted);
    s->log[0] = 0;
}

TEST(a_life_of_local_alarms)
{
    struct stage *s = stage_create(ALARMS_LOCAL);
    hear(s, 1, 0, 85, QUALITY_GOOD);
    hear(s, 2, 0, 91, QUALITY_GOOD);
    assert_told(s, "1 TT.H raise: normal > unacknowledged\n2 TT.HH raise: normal > unacknowledged\n");
    assert_int_equal(s->told[0], ALARM_HH);
    assert_int_equal(act(s, 3, 0, ALARM_H, ALARM_ACKNOWLEDGE, 0), REFUSAL_NONE);
    assert_int_equal(act(s, 3, 0, ALARM_H, ALARM_ACKNOWLEDGE, 0), REFUSAL_QUIET);
    hear(s, 4, 0, 88, QUALITY_GOOD); /* within the deadband of HH */
    hear(s, 5, 0, 87.9, QUALITY_GOOD);
    hear(s, 6, 0, 50, QUALITY_GOOD);
    assert_told(s, "3 TT.H acknowledge: unacknowledged > acknowledged by kim\n"
                   "5 TT.HH clear: unacknowledged > returned\n6 TT.H clear: acknowledged > normal\n");
    assert_int_equal(s->told[0], ALARM_HH); /* HH is still unacknowledged */
    assert_int_equal(act(s, 7, 0, ALARM_HH, ALARM_ACKNOWLEDGE, 0), REFUSAL_NONE);
    assert_told(s, "7 TT.HH acknowledge: returned > normal by kim\n");
    assert_int_equal(s->told[0], ALARM_NONE);
}

TEST(delays_are_monotonic_and_exact)
{
    struct stage *s = stage_create(ALARMS_LOCAL);
    hear(s, 9, 0, 50, QUALITY_GOOD);
    hear(s, 10, 1, 6, QUALITY_GOOD);
    /* the wall clock jumps ahead by an hour, while the monotonic clock goes on by a second: PT's delay of 2 s is not over */
    s->snapshot->taken_utc_ns = UTC + 4000 * S;
    s->snapshot->taken_mono_ns = 11 * S;
    alarms_tick(s->alarms, s->snapshot);
    assert_told(s, "");
    /* the next tick comes 18 s late: the alarm's time is the end of its delay of 2 s (second 12), not the time of the tick */
    tick(s, 30);
    assert_told(s, "12 PT.H raise: normal > unacknowledged\n");
}

TEST(what_is_bad_is_held_and_says_so)
{
    struct stage *s = stage_create(ALARMS_LOCAL);
    hear(s, 1, 0, 95, QUALITY_GOOD);
    act(s, 1, 0, ALARM_H, ALARM_ACKNOWLEDGE, 0);
    s->log[0] = 0;
    hear(s, 2, 0, 0, QUALITY_BAD_SENSOR_FAILURE);
    assert_told(s, "2 TT.BAD raise: normal > unacknowledged\n");
    /* The device still delivers another tag's reading, so the fault is the sensor's: the tag gets a BAD alarm of its own, and
       its limit alarm is held in its last state. */
    hear(s, 2, 2, 0, QUALITY_GOOD);
    assert_string_equal(word(s, 0, ALARM_H), "acknowledged");
    assert_true(alarms_at(s->alarms, alarms_find(s->alarms, 0, ALARM_H))->held);
    hear(s, 3, 0, 50, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    assert_false(alarms_at(s->alarms, alarms_find(s->alarms, 0, ALARM_H))->held);
    assert_told(s, "3 TT.H clear: acknowledged > normal\n3 TT.HH clear: unacknowledged > returned\n"
                   "3 TT.BAD clear: unacknowledged > returned\n");
    /* the reading goes stale: the store changes its quality, but the alarms get no event for that */
    s->snapshot->readings[0].quality = QUALITY_BAD_COMMUNICATION_ERROR;
    tick(s, 9);
    assert_told(s, "9 TT.BAD raise: returned > unacknowledged\n");
    /* A tag that never had a reading has no alarm at first. It gets one when its stale time has passed. */
    tick(s, 10);
    assert_told(s, "");
    tick(s, 14);
    tick(s, 16);
    assert_told(s, "16 PT.BAD raise: normal > unacknowledged\n");
}

TEST(shelves_end_and_come_back)
{
    struct stage *s = stage_create(ALARMS_LOCAL);
    hear(s, 1, 0, 85, QUALITY_GOOD);
    assert_int_not_equal(act(s, 2, 0, ALARM_H, ALARM_SHELVE, 0), REFUSAL_NONE);
    assert_int_not_equal(act(s, 2, 0, ALARM_H, ALARM_SHELVE, 8 * 86400), REFUSAL_NONE);
    assert_int_equal(act(s, 2, 0, ALARM_H, ALARM_SHELVE, 60), REFUSAL_NONE);
    assert_int_equal(s->told[0], ALARM_NONE);
    const struct alarm *alarm = alarms_at(s->alarms, alarms_find(s->alarms, 0, ALARM_H));
    assert_string_equal(alarm->reason, "transmitter is being changed");
    assert_true(alarm->until.utc_ns == UTC + 62 * S);
    /* the alarm is shelved already; shelving again extends the time */
    assert_int_equal(act(s, 30, 0, ALARM_H, ALARM_SHELVE, 60), REFUSAL_NONE);
    tick(s, 61);
    s->log[0] = 0;
    tick(s, 90);
    assert_told(s, "90 TT.H unshelve: shelved > unacknowledged\n");
    assert_string_equal(alarm->reason, "");
    assert_int_equal(act(s, 91, 0, ALARM_H, ALARM_TAKE_OUT, 0), REFUSAL_NONE);
    hear(s, 92, 0, 50, QUALITY_GOOD);
    assert_int_equal(act(s, 93, 0, ALARM_H, ALARM_PUT_BACK, 0), REFUSAL_NONE);
    assert_told(s, "91 TT.H out_of_service: unacknowledged > out_of_service by kim\n92 TT.H clear: out_of_service > out_of_service\n"
                   "93 TT.H in_service: out_of_service > normal by kim\n");
}

TEST(design_suppresses)
{
    struct stage *s = stage_create(ALARMS_DISPLAY);
    hear(s, 1, 2, 1, QUALITY_GOOD);
    hear(s, 2, 1, 9, QUALITY_GOOD);
    tick(s, 5);
    assert_string_equal(word(s, 1, ALARM_H), "suppressed");
    assert_int_equal(s->told[1], ALARM_NONE);
    /* SD, the bit that suppresses PT's alarms, becomes Bad: its last good state still counts */
    hear(s, 6, 2, 1, QUALITY_BAD_SENSOR_FAILURE);
    assert_string_equal(word(s, 1, ALARM_H), "suppressed");
    hear(s, 7, 2, 0, QUALITY_GOOD);
    assert_string_equal(word(s, 1, ALARM_H), "active");
    assert_int_equal(s->told[1], ALARM_H);
}

TEST(display_acknowledges_nothing)
{
    struct stage *s = stage_create(ALARMS_DISPLAY);
    hear(s, 1, 0, 95, QUALITY_GOOD);
    assert_int_equal(act(s, 2, 0, ALARM_HH, ALARM_ACKNOWLEDGE, 0), REFUSAL_ELSEWHERE);
    assert_int_not_equal(act(s, 2, 0, ALARM_HH, ALARM_SHELVE, 60), REFUSAL_NONE);
    hear(s, 3, 0, 50, QUALITY_GOOD);
    assert_told(s, "1 TT.H raise: normal > active\n1 TT.HH raise: normal > active\n3 TT.H clear: active > normal\n"
                   "3 TT.HH clear: active > normal\n");
}

static int count_of(const struct stage *s)
{
    struct alarm_counts counts;
    int count = 0;
    alarms_counts(s->alarms, 0, &counts);
    for (int i = 0; i < ALARM_STATUSES; i++)
        count += counts.statuses[i];
    return count;
}

TEST(a_mirror_shows_what_the_other_system_says)
{
    struct stage *s = stage_create(ALARMS_MIRROR);
    /* count: TT's limit H, whose state the DCS reports; one for each of two bits that may turn bad; and the device's link */
    assert_int_equal(count_of(s), 4);
    hear(s, 1, 0, 95, QUALITY_GOOD); /* TT exceeds its limit, but in mirror mode only the DCS's bits raise alarms */
    assert_told(s, "");
    hear(s, 2, 3, 1, QUALITY_GOOD);
    hear(s, 3, 4, 1, QUALITY_GOOD);
    hear(s, 4, 3, 0, QUALITY_GOOD);
    assert_told(s, "2 TT.HH raise: normal > unacknowledged\n3 TT.HH acknowledge: unacknowledged > acknowledged\n"
                   "4 TT.HH clear: acknowledged > normal\n");
    hear(s, 5, 4, 0, QUALITY_GOOD);
    hear(s, 5, 3, 1, QUALITY_GOOD);
    hear(s, 6, 3, 1, QUALITY_BAD_COMMUNICATION_ERROR);
    assert_told(s, "5 TT.HH raise: normal > unacknowledged\n6 B1.BAD raise: normal > active\n");
    assert_true(alarms_at(s->alarms, alarms_find(s->alarms, 0, ALARM_HH))->held);
    assert_string_equal(word(s, 0, ALARM_HH), "unacknowledged");
    /* the acknowledgement bit turns Bad while it is 1. That acknowledgement does not apply to a new alarm */
    hear(s, 7, 4, 1, QUALITY_GOOD);
    hear(s, 8, 4, 0, QUALITY_BAD_CONFIGURATION);
    hear(s, 9, 3, 1, QUALITY_GOOD);
    assert_string_equal(word(s, 0, ALARM_HH), "acknowledged");
    s->log[0] = 0;
    hear(s, 10, 3, 0, QUALITY_GOOD);
    hear(s, 11, 3, 1, QUALITY_GOOD);
    assert_told(s, "10 TT.HH clear: acknowledged > normal\n11 TT.HH raise: normal > unacknowledged\n");
    hear(s, 12, 4, 1, QUALITY_GOOD);
    assert_told(s, "12 TT.HH acknowledge: unacknowledged > acknowledged\n12 B2.BAD clear: active > normal\n");
    /* after a reload and after a restart, an acknowledged alarm stays acknowledged although the acknowledgement bit is Bad */
    hear(s, 13, 4, 0, QUALITY_BAD_CONFIGURATION);
    for (int restart = 0; restart < 2; restart++) {
        struct stage *next = stage_create(ALARMS_MIRROR);
        int index = alarms_find(s->alarms, 0, ALARM_HH);
        if (restart)
            alarms_restore(next->alarms, index, alarms_at(s->alarms, index), at(14));
        else
            alarms_adopt(next->alarms, s->alarms);
        hear(next, 15, 3, 1, QUALITY_GOOD);
        hear(next, 15, 4, 0, QUALITY_BAD_CONFIGURATION);
        assert_string_equal(word(next, 0, ALARM_HH), "acknowledged");
    }
    /* after a restart, a new alarm is unacknowledged although the acknowledgement bit has not been read yet */
    struct stage *next = stage_create(ALARMS_MIRROR);
    int index = alarms_find(s->alarms, 0, ALARM_HH);
    alarms_restore(next->alarms, index, alarms_at(s->alarms, index), at(14));
    hear(next, 15, 3, 0, QUALITY_GOOD);
    hear(next, 16, 3, 1, QUALITY_GOOD);
    assert_string_equal(word(next, 0, ALARM_HH), "unacknowledged");
}

TEST(what_was_kept_is_taken_up)
{
    struct stage *s = stage_create(ALARMS_LOCAL), *next;
    hear(s, 1, 0, 95, QUALITY_GOOD);
    act(s, 2, 0, ALARM_H, ALARM_SHELVE, 60);
    next = stage_create(ALARMS_LOCAL);
    for (int kind = ALARM_H; kind <= ALARM_HH; kind++)
        alarms_restore(next->alarms, alarms_find(next->alarms, 0, (enum alarm_kind)kind),
                       alarms_at(s->alarms, alarms_find(s->alarms, 0, (enum alarm_kind)kind)), (struct instant){ 5 * S, UTC + 40 * S });
    assert_told(next, ""); /* restoring alarms after a restart reports no transition: what happened between the two runs is unknown */
    assert_string_equal(word(next, 0, ALARM_HH), "unacknowledged");
    assert_string_equal(word(next, 0, ALARM_H), "shelved");
    assert_true(alarms_at(next->alarms, alarms_find(next->alarms, 0, ALARM_HH))->held);
    hear(next, 6, 0, 95, QUALITY_GOOD);
    assert_told(next, "");                  /* the alarm is still active and is not raised again */
    next->snapshot->taken_mono_ns = 27 * S; /* at this time the 22 s have passed that were left of the shelving when it was restored */
    next->snapshot->taken_utc_ns = UTC + 62 * S;
    alarms_tick(next->alarms, next->snapshot);
    assert_told(next, "62 TT.H unshelve: shelved > unacknowledged\n");
    next = stage_create(ALARMS_DISPLAY); /* the site changed its alarm mode between the two runs */
    for (int kind = ALARM_H; kind <= ALARM_HH; kind++)
        alarms_restore(next->alarms, alarms_find(next->alarms, 0, (enum alarm_kind)kind),
                       alarms_at(s->alarms, alarms_find(s->alarms, 0, (enum alarm_kind)kind)), at(5));
    assert_string_equal(word(next, 0, ALARM_HH), "active");
    /* display mode knows no shelving, so a restored shelved alarm becomes active again */
    assert_string_equal(word(next, 0, ALARM_H), "active");
}

/* The clock is wrong at the start, as on a machine without a clock chip, and is corrected later. */
TEST(a_restored_shelf_ends_although_the_clock_was_wrong)
{
    struct stage *s = stage_create(ALARMS_LOCAL), *next;
    const int64_t year_ns = 365 * 86400 * S;
    int index = alarms_find(s->alarms, 0, ALARM_H);
    hear(s, 1, 0, 85, QUALITY_GOOD);
    assert_int_equal(act(s, 2, 0, ALARM_H, ALARM_SHELVE, 60), REFUSAL_NONE);
    for (int corrected = 0; corrected < 2; corrected++) {
        next = stage_create(ALARMS_LOCAL);
        hear(next, 1, 0, 85, QUALITY_GOOD);
        alarms_restore(next->alarms, index, alarms_at(s->alarms, index), (struct instant){ 5 * S, UTC + 40 * S - year_ns });
        next->snapshot->taken_mono_ns = corrected ? 27 * S : 5 * S + ALARM_LONGEST_SHELF_NS;
        next->snapshot->taken_utc_ns = corrected ? UTC + 62 * S : UTC + 40 * S - year_ns + ALARM_LONGEST_SHELF_NS;
        next->snapshot->taken_mono_ns--, next->snapshot->taken_utc_ns--;
        alarms_tick(next->alarms, next->snapshot);
        assert_string_equal(word(next, 0, ALARM_H), "shelved");
        next->snapshot->taken_mono_ns++, next->snapshot->taken_utc_ns++;
        alarms_tick(next->alarms, next->snapshot);
        assert_string_equal(word(next, 0, ALARM_H), "unacknowledged");
    }
    /* if the clock was wrong when the operator shelved the alarm, its correction does not end the shelving early */
    assert_int_equal(act(next, 30, 0, ALARM_H, ALARM_SHELVE, 60), REFUSAL_NONE);
    next->snapshot->taken_mono_ns = 31 * S;
    next->snapshot->taken_utc_ns = UTC + year_ns;
    alarms_tick(next->alarms, next->snapshot);
    assert_string_equal(word(next, 0, ALARM_H), "shelved");
}

static void set_unit(struct stage *s, const char *unit)
{
    mem_free(s->plant->tags[0].unit);
    s->plant->tags[0].unit = mem_strdup(unit);
}

TEST(a_reload_keeps_what_stays)
{
    struct stage *s = stage_create(ALARMS_LOCAL), *next;
    hear(s, 1, 0, 95, QUALITY_GOOD);
    hear(s, 9, 1, 9, QUALITY_GOOD); /* PT has just exceeded its limit: its delay of 2 s is running when the plant is reloaded */
    next = stage_create(ALARMS_LOCAL);
    set_unit(s, "°C");
    set_unit(next, "°F");
    alarms_adopt(next->alarms, s->alarms);
    assert_told(next, "");
    assert_int_equal(next->told[0], ALARM_HH);
    assert_string_equal(word(next, 0, ALARM_HH), "unacknowledged");
    assert_true(fabs(alarms_at(next->alarms, alarms_find(next->alarms, 0, ALARM_HH))->value - 203) < 1e-9);
    memcpy(next->snapshot->readings, s->snapshot->readings, 5 * sizeof(struct reading));
    tick(next, 11);
    assert_told(next, "11 PT.H raise: normal > unacknowledged\n");
}

static struct plant_tag *tag_of(struct stage *s, int tag)
{
    return &s->plant->tags[tag];
}

/* Starts the alarms of `next` as after a reload: they take over the states of `s`, and the store has the same readings. */
static void reload(struct stage *next, struct stage *s)
{
    start(next);
    alarms_adopt(next->alarms, s->alarms);
    memcpy(next->snapshot->readings, s->snapshot->readings, 5 * sizeof(struct reading));
}

/* After a reload, new and changed limits and bits apply to present readings, although no new samples arrive. */
TEST(a_reload_checks_present_readings)
{
    struct stage *s = stage_create(ALARMS_LOCAL), *next = stage_with_plant(ALARMS_LOCAL);
    hear(s, 1, 0, 85, QUALITY_GOOD);
    hear(s, 1, 1, 3, QUALITY_GOOD);
    hear(s, 1, 3, 1, QUALITY_GOOD);
    assert_told(s, "1 TT.H raise: normal > unacknowledged\n");
    tag_of(next, 0)->alarms.limits[LIMIT_H] = 95;  /* TT is at 85 and below its changed limit */
    tag_of(next, 0)->alarms.limits[LIMIT_LL] = 86; /* and beyond this one, but TT is now also suppressed by B1 */
    tag_of(next, 0)->alarms.suppressed_by = 3;
    tag_of(next, 1)->alarms.limits[LIMIT_H] = 2; /* PT is at 3, beyond its changed limit. Its on delay of 2 s begins */
    reload(next, s);
    tick(next, 9);
    assert_told(next, "9 TT.LL raise: normal > unacknowledged\n9 TT.H clear: unacknowledged > returned\n"
                      "9 TT.LL suppress: unacknowledged > suppressed\n9 TT.L suppress: normal > suppressed\n"
                      "9 TT.H suppress: returned > suppressed\n9 TT.HH suppress: normal > suppressed\n"
                      "9 TT.BAD suppress: normal > suppressed\n");
    tick(next, 12);
    assert_told(next, "11 PT.H raise: normal > unacknowledged\n");
    tick(next, 20);
    assert_told(next, "");
}

/* Tags that are new after a reload, or whose readings the reload discarded, are Bad only after their stale time. */
TEST(a_reload_gives_new_tags_time)
{
    struct stage *s = stage_with_plant(ALARMS_LOCAL), *next = stage_with_plant(ALARMS_LOCAL);
    mem_free(s->plant->tags[1].name);
    s->plant->tags[1].name = mem_strdup("PT-before");
    start(s);
    hear_all(s, 1, 3, QUALITY_GOOD);
    tick(s, 1);
    reload(next, s);
    next->snapshot->readings[0].quality = next->snapshot->readings[1].quality = QUALITY_BAD_WAITING;
    hear(next, 900, 2, 0, QUALITY_GOOD);
    tick(next, 1000);
    tick(next, 1004);
    assert_string_equal(word(next, 0, ALARM_BAD), "normal");
    tick(next, 1005);
    tick(next, 1008);
    assert_string_equal(word(next, 0, ALARM_BAD), "unacknowledged");
    assert_string_equal(word(next, 1, ALARM_BAD), "unacknowledged");
    next->log[0] = 0;
    tick(next, 1009);
    assert_told(next, "");
}

/* A reload discards the reading of a tag while the off delay of its alarm is running. The alarm must not clear before the tag's new
   value has been inside the limit for the whole delay. */
TEST(a_discarded_reading_suspends_delays)
{
    struct stage *s = stage_with_plant(ALARMS_LOCAL), *next = stage_with_plant(ALARMS_LOCAL);
    tag_of(s, 0)->alarms.settings.off_delay_s = tag_of(next, 0)->alarms.settings.off_delay_s = 5;
    start(s);
    hear(s, 1, 0, 85, QUALITY_GOOD);
    hear(s, 2, 0, 50, QUALITY_GOOD);
    reload(next, s);
    next->snapshot->readings[0].quality = QUALITY_BAD_WAITING;
    tick(next, 4);
    tick(next, 8);
    assert_told(next, "");
    assert_true(alarms_at(next->alarms, alarms_find(next->alarms, 0, ALARM_H))->held);
    hear(next, 8, 0, 50, QUALITY_GOOD);
    tick(next, 14);
    assert_told(next, "13 TT.H clear: unacknowledged > returned\n");
}

/* A source is lost, and a reload moves one of its tags to another source. This must not make the other source count as lost. */
TEST(a_tag_moves_to_another_source)
{
    struct stage *s = stage_with_plant(ALARMS_LOCAL), *next = stage_with_plant(ALARMS_LOCAL);
    plant_by_hand_source(next->plant, "b", 2);
    tag_of(next, 0)->source = 1;
    start(s);
    hear_all(s, 1, 50, QUALITY_GOOD);
    hear_all(s, 2, 50, QUALITY_BAD_COMMUNICATION_ERROR);
    reload(next, s);
    next->snapshot->readings[0].quality = QUALITY_BAD_WAITING;
    tick(next, 3);
    hear(next, 4, 0, 50, QUALITY_GOOD);
    assert_null(strstr(next->log, "b.LINK"));
}

/* When a standby takes over, all readings are Bad, because the connection to the former leader is lost. No alarm is raised until its
   own sources have had time to read the tags: the stale time, but at most 60 s. A derived tag repeats the quality of its inputs. */
TEST(a_takeover_gives_sources_time)
{
    static const double stale_s[] = { 5, 3600, PLANT_NEVER_STALE_S };
    for (int i = 0; i < 3; i++) {
        struct stage *s = stage_with_plant(ALARMS_LOCAL);
        int wait_s = i == 0 ? 5 : 60, on_s = i == 2 ? 10 : 0;
        for (int tag = 0; tag < 5; tag++)
            tag_of(s, tag)->validity.stale_s = stale_s[i];
        tag_of(s, 4)->source = -1;
        tag_of(s, 4)->alarms.limits[LIMIT_H] = 5;
        start(s);
        assert_true(alarms_mirror(s->alarms, NULL, 0, true));
        set_all(s, QUALITY_BAD_COMMUNICATION_ERROR);
        alarms_lead(s->alarms, at(100));
        hear(s, 100, 4, 0, QUALITY_BAD_COMMUNICATION_ERROR);
        tick(s, 100);
        tick(s, 100 + wait_s - 1);
        assert_told(s, "");
        tick(s, 100 + wait_s);
        tick(s, 100 + wait_s + on_s);
        assert_non_null(strstr(s->log, test_printf("%d a.LINK raise: normal > unacknowledged\n", 100 + wait_s + on_s)));
        assert_non_null(strstr(s->log, test_printf("%d B2.BAD raise: normal > unacknowledged\n", 100 + wait_s)));
    }
}

TEST(changes_come_newest_first)
{
    struct stage *s = stage_create(ALARMS_LOCAL);
    hear(s, 1, 0, 95, QUALITY_GOOD);
    uint64_t before = alarms_number(s->alarms);
    act(s, 2, 0, ALARM_H, ALARM_ACKNOWLEDGE, 0);
    int newest = alarms_newest(s->alarms), second = alarms_at(s->alarms, newest)->older;
    assert_int_equal(alarms_at(s->alarms, newest)->kind, ALARM_H);
    assert_true(alarms_at(s->alarms, newest)->number > before && alarms_at(s->alarms, second)->number <= before);
    assert_int_equal(alarms_at(s->alarms, second)->older, -1);
}

TEST(counts_are_what_there_is)
{
    struct stage *s = stage_create(ALARMS_LOCAL);
    struct alarm_counts counts;
    for (int i = 0; i < 3; i++) {
        hear(s, 10 + 2 * i, 0, 85, QUALITY_GOOD);
        hear(s, 11 + 2 * i, 0, 50, QUALITY_GOOD);
    }
    hear(s, 20, 0, 5, QUALITY_GOOD);
    alarms_counts(s->alarms, 21 * S, &counts);
    assert_int_equal(counts.statuses[ALARM_UNACKNOWLEDGED], 1);
    assert_int_equal(counts.statuses[ALARM_RETURNED], 1);
    assert_int_equal(counts.statuses[ALARM_NORMAL], count_of(s) - 2);
    assert_int_equal(counts.active, 1); /* counts alarms whose cause persists: one; the returned one is not counted */
    assert_int_equal(counts.chattering, 1);
    assert_int_equal(counts.priorities[0] + counts.priorities[1] + counts.priorities[2] + counts.priorities[3], 2);
    assert_int_equal(counts.priorities[alarms_at(s->alarms, alarms_find(s->alarms, 0, ALARM_L))->priority - 1], 2); /* H and L */
    assert_int_equal(counts.standing, 0);
    alarms_counts(s->alarms, 20 * S + ALARM_STANDING_NS, &counts);
    assert_int_equal(counts.standing, 1);
    assert_int_equal(counts.chattering, 0);
}

/* TT has the limits LL 0 and L 10, with a deadband of 2. */
TEST(what_is_there_stands_before_what_has_gone)
{
    struct stage *s = stage_create(ALARMS_LOCAL);
    hear(s, 1, 0, -5, QUALITY_GOOD);
    assert_int_equal(s->told[0], ALARM_LL);
    act(s, 2, 0, ALARM_L, ALARM_ACKNOWLEDGE, 0);
    hear(s, 3, 0, 5, QUALITY_GOOD); /* LL's cause has gone, but nobody has acknowledged LL; L is still active and was acknowledged */
    assert_string_equal(word(s, 0, ALARM_LL), "returned");
    assert_int_equal(s->told[0], ALARM_L);
    hear(s, 4, 0, 50, QUALITY_GOOD);
    assert_int_equal(s->told[0], ALARM_LL);
    const struct alarm_grade high = { 4, ALARM_H, ALARM_UNACKNOWLEDGED }, highest = { 4, ALARM_HH, ALARM_ACKNOWLEDGED };
    /* with equal priority, the outer limit is graver */
    assert_true(alarm_graver(&highest, &high) && !alarm_graver(&high, &highest));
}

/* Feeds random sequences of events. Each reported transition must start in the state in which the alarm's previous one ended,
   and the alarm reported as a tag's most severe one must be just that. */
TEST(no_sequence_tells_a_contradiction)
{
    static const uint32_t bad[12] = {
        [9] = QUALITY_BAD_SENSOR_FAILURE, [10] = QUALITY_BAD_COMMUNICATION_ERROR, [11] = QUALITY_BAD_DEVICE_FAILURE
    };
    unsigned seed = 42;
    for (int mode = ALARMS_DISPLAY; mode <= ALARMS_LOCAL; mode++) {
        struct stage *s = stage_create((enum alarm_mode)mode);
        const int count = count_of(s);
        for (int i = 0; i < 20000; i++) {
            int tag = rand_r(&seed) % 5, kind = ALARM_LL + rand_r(&seed) % (ALARM_KINDS - 1);
            double value = tag > 1 ? rand_r(&seed) % 2 : rand_r(&seed) % 110 - 5;
            s->log[0] = 0;
            if (rand_r(&seed) % 50 == 0)
                hear_all(s, i, 0, rand_r(&seed) % 2 ? QUALITY_BAD_COMMUNICATION_ERROR : QUALITY_BAD_DEVICE_FAILURE);
            hear(s, i, tag, value, bad[rand_r(&seed) % 12]);
            if (rand_r(&seed) % 4 == 0 && alarms_find(s->alarms, tag, (enum alarm_kind)kind) >= 0)
                act(s, i, tag, (enum alarm_kind)kind, (enum alarm_event)(ALARM_ACKNOWLEDGE + rand_r(&seed) % 8), 1 + rand_r(&seed) % 20);
            tick(s, i);
            for (int k = 0; k < count; k++) {
                const struct alarm *alarm = alarms_at(s->alarms, k);
                bool calls = alarm_status_is_annunciated(alarm_status_of(alarm));
                assert_false(calls && alarm->tag >= 0 && s->told[alarm->tag] == ALARM_NONE);
                assert_true(alarm->kind == ALARM_BAD || !(alarm->state.aside & ALARM_ASIDE_CARRIED));
                assert_true(alarm->state.active || !(alarm->state.aside & ALARM_ASIDE_CARRIED));
                assert_int_equal(alarm->until.mono_ns != 0, (alarm->state.aside & ALARM_ASIDE_SHELVED) != 0);
                assert_true(alarm->until.mono_ns == 0 || alarm->until.mono_ns > i * S);
                assert_false(mode == ALARMS_DISPLAY && alarm->state.unacknowledged);
            }
        }
    }
}

/* --- devices ---------------------------------------------------------------------------------------------------------------- */

static enum refusal_code act_on_link(struct stage *s, int second, const char *name, enum alarm_event event)
{
    int index = alarms_find_named(s->alarms, name, ALARM_LINK);
    assert_true(index >= 0);
    return alarms_act(s->alarms, index, &(struct alarm_act){ event, 0, "kim", "" }, at(second));
}

static int active_count(struct stage *s)
{
    struct alarm_counts counts;
    alarms_counts(s->alarms, 0, &counts);
    return counts.active;
}

TEST(a_lost_device_is_one_alarm)
{
    struct stage *s = stage_create(ALARMS_LOCAL);
    hear_all(s, 1, 50, QUALITY_GOOD);
    hear(s, 1, 1, 1, QUALITY_GOOD);
    s->log[0] = 0;
    hear(s, 1, 2, 0, QUALITY_GOOD); /* SD is 0, so it does not suppress PT's alarms */
    s->log[0] = 0;
    hear_all(s, 10, 50, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    hear(s, 10, 1, 1, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    hear(s, 10, 2, 0, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    tick(s, 12);
    s->log[0] = 0;
    set_all(s, QUALITY_BAD_COMMUNICATION_ERROR); /* stale: nobody told */
    tick(s, 15);
    tick(s, 18);
    assert_told(s, "15 a.LINK raise: normal > unacknowledged\n15 TT.BAD raise: normal > suppressed\n"
                   "17 PT.BAD raise: normal > suppressed\n");
    assert_int_equal(active_count(s), 1);
    /* the marker of a tag covered by its device's alarm shows the bad quality, so no alarm is reported for the tag itself */
    assert_int_equal(s->told[0], ALARM_NONE);
    assert_int_equal(act_on_link(s, 19, "a", ALARM_ACKNOWLEDGE), REFUSAL_NONE);
    assert_int_equal(alarms_find_named(s->alarms, "b", ALARM_LINK), -1);
    hear(s, 20, 0, 50, QUALITY_GOOD);
    assert_told(s, "19 a.LINK acknowledge: unacknowledged > acknowledged by kim\n20 a.LINK clear: acknowledged > normal\n"
                   "20 TT.BAD clear: suppressed > normal\n");
    tick(s, 24);
    assert_told(s, "");
    /* the device answers again, so its alarm no longer covers PT's; PT has had no reading within its stale time and gets an
       alarm of its own */
    tick(s, 25);
    assert_told(s, "25 PT.BAD call: suppressed > unacknowledged\n");
    assert_int_equal(s->told[1], ALARM_BAD);
}

/* A lost device returns, but answers every request with an error. Its LINK alarm ends, so each tag gets an alarm of its own. */
TEST(a_device_that_returns_with_errors_only_is_not_silent)
{
    struct stage *s = stage_create(ALARMS_LOCAL);
    hear_all(s, 1, 50, QUALITY_GOOD);
    hear(s, 2, 2, 0, QUALITY_GOOD); /* SD is 0, so it does not suppress PT's alarms */
    hear_all(s, 10, 0, QUALITY_BAD_COMMUNICATION_ERROR);
    tick(s, 12);
    assert_string_equal(word(s, 0, ALARM_BAD), "suppressed");
    assert_string_equal(word(s, 1, ALARM_BAD), "suppressed");
    s->log[0] = 0;
    hear_all(s, 20, 0, QUALITY_BAD_CONFIGURATION);
    tick(s, 24);
    assert_told(s, "20 a.LINK clear: unacknowledged > returned\n");
    tick(s, 25);
    assert_told(s, "25 TT.BAD call: suppressed > unacknowledged\n25 PT.BAD call: suppressed > unacknowledged\n");
}

/* A device's tags go stale one after another. The first tag's own alarm is merged into the device's alarm that follows, unless
   somebody has acknowledged the tag's alarm before. */
TEST(those_that_went_before_are_carried_too)
{
    for (int seen = 0; seen < 2; seen++) {
        struct stage *s = stage_create(ALARMS_LOCAL);
        hear_all(s, 1, 0, QUALITY_GOOD);
        hear(s, 2, 0, 50, QUALITY_GOOD);
        hear(s, 3, 0, 0, QUALITY_BAD_COMMUNICATION_ERROR);
        if (seen)
            assert_int_equal(act(s, 3, 0, ALARM_BAD, ALARM_ACKNOWLEDGE, 0), REFUSAL_NONE);
        s->log[0] = 0;
        hear_all(s, 4, 0, QUALITY_BAD_COMMUNICATION_ERROR);
        assert_told(s, seen ? "4 a.LINK raise: normal > unacknowledged\n"
                            : "4 a.LINK raise: normal > unacknowledged\n4 TT.BAD carry: unacknowledged > suppressed\n");
        assert_string_equal(word(s, 0, ALARM_BAD), seen ? "acknowledged" : "suppressed");
    }
}

/* If a gateway answers, but the controller behind it has stopped (all readings Bad), one alarm for the device suffices. If one
   sensor fails while the others are read, it has an alarm of its own, which stays. */
TEST(a_stopped_controller_is_one_and_a_failed_sensor_its_own)
{
    struct stage *s = stage_create(ALARMS_DISPLAY);
    hear_all(s, 1, 0, QUALITY_GOOD);
    hear(s, 2, 0, 50, QUALITY_GOOD);
    hear(s, 3, 0, 0, QUALITY_BAD_SENSOR_FAILURE);
    s->log[0] = 0;
    set_all(s, QUALITY_BAD_DEVICE_FAILURE);
    /* this sensor had failed before its controller stopped: its quality still says so */
    s->snapshot->readings[0].quality = QUALITY_BAD_SENSOR_FAILURE;
    tick(s, 4);
    tick(s, 9);
    assert_told(s, "4 a.LINK raise: normal > active\n6 PT.BAD raise: normal > suppressed\n");
    assert_string_equal(word(s, 0, ALARM_BAD), "active");
    assert_int_equal(active_count(s), 2);
}

/* TT and PT belong to different units behind one gateway: if one unit fails, only that unit gets an alarm. */
TEST(units_are_devices_of_their_own)
{
    struct stage *s = stage_with_plant(ALARMS_LOCAL);
    s->plant->tags[1].signal.modbus_unit = 7;
    s->plant->tags[1].alarms.settings.on_delay_s = 0;
    s->plant->tags[1].alarms.suppressed_by = -1;
    start(s);
    hear_all(s, 1, 3, QUALITY_GOOD);
    s->log[0] = 0;
    hear(s, 2, 1, 0, QUALITY_BAD_COMMUNICATION_ERROR);
    assert_told(s, "2 a/7.LINK raise: normal > unacknowledged\n2 PT.BAD raise: normal > suppressed\n");
    tick(s, 100);
    assert_told(s, "");
}

/* Restart and reload while a device is lost: the device's alarm must not be raised again, and must still cover the alarms of
   its tags. */
TEST(what_a_device_carries_outlives_us)
{
    struct stage *s = stage_create(ALARMS_LOCAL), *next;
    hear_all(s, 1, 50, QUALITY_GOOD);
    hear_all(s, 2, 0, QUALITY_BAD_COMMUNICATION_ERROR);
    for (int restart = 0; restart < 2; restart++) {
        next = stage_create(ALARMS_LOCAL);
        if (restart) {
            int link = alarms_find_named(s->alarms, "a", ALARM_LINK);
            alarms_restore(next->alarms, alarms_find_named(next->alarms, "a", ALARM_LINK), alarms_at(s->alarms, link), at(3));
            alarms_restore(next->alarms, alarms_find(next->alarms, 0, ALARM_BAD),
                           alarms_at(s->alarms, alarms_find(s->alarms, 0, ALARM_BAD)), at(3));
        } else {
            alarms_adopt(next->alarms, s->alarms);
        }
        assert_told(next, "");
        assert_string_equal(word(next, 0, ALARM_BAD), "suppressed");
        assert_int_equal(active_count(next), 1);
        memcpy(next->snapshot->readings, s->snapshot->readings, 5 * sizeof(struct reading));
        hear_all(next, 4, 0, QUALITY_BAD_COMMUNICATION_ERROR);
        tick(next, 5);
        assert_string_equal(word(next, 0, ALARM_BAD), "suppressed");
        next->log[0] = 0;
        hear_all(next, 8, 50, QUALITY_GOOD);
        assert_string_equal(word(next, 0, ALARM_BAD), "normal");
        assert_non_null(strstr(next->log, "8 a.LINK clear: unacknowledged > returned\n"));
    }
}

/* OPC UA servers may set info bits in a status code, such as `limit reached`: names and meanings of qualities must not depend
   on them. */
TEST(info_bits_do_not_hide_a_quality)
{
    assert_string_equal(quality_name(QUALITY_UNCERTAIN_UNITS_EXCEEDED | 0x0500), "Uncertain_EngineeringUnitsExceeded");
    assert_string_equal(quality_name(0x0480), "Good");
    assert_int_equal(device_status_of(QUALITY_BAD_NO_COMMUNICATION | 0x0400), DEVICE_GONE);
    assert_int_equal(device_status_of(QUALITY_UNCERTAIN_UNITS_EXCEEDED | 0x0500), DEVICE_USABLE);
}

/* Losing a device raises an alarm even if its tags have no limits: nothing else would report the loss. */
TEST(a_device_without_limits_has_an_alarm)
{
    struct stage *s = stage_with_plant(ALARMS_LOCAL);
    for (int tag = 0; tag < 5; tag++)
        for (int i = 0; i < LIMIT_COUNT; i++)
            s->plant->tags[tag].alarms.limits[i] = NAN;
    start(s);
    hear_all(s, 1, 50, QUALITY_GOOD);
    /* after one missed poll the readings keep their values but are Uncertain */
    hear_all(s, 10, 50, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    tick(s, 14);
    hear_all(s, 15, 50, QUALITY_BAD_COMMUNICATION_ERROR);
    tick(s, 24);
    hear_all(s, 24, 50, QUALITY_GOOD);
    tick(s, 26);
    assert_told(s, "");
    hear_all(s, 30, 50, QUALITY_BAD_COMMUNICATION_ERROR);
    tick(s, 41);
    assert_told(s, "40 a.LINK raise: normal > unacknowledged\n");
    assert_int_equal(act_on_link(s, 42, "a", ALARM_ACKNOWLEDGE), REFUSAL_NONE);
    hear(s, 43, 4, 1, QUALITY_GOOD);
    assert_told(s, "42 a.LINK acknowledge: unacknowledged > acknowledged by kim\n43 a.LINK clear: acknowledged > normal\n");
}

/* If a source sends only changes, its tags do not become stale and keep their last values while it is lost. Therefore the
   source itself must have an alarm. */
TEST(a_lost_source_that_never_gets_stale_has_an_alarm)
{
    struct stage *s = stage_with_plant(ALARMS_LOCAL);
    for (int tag = 0; tag < 5; tag++)
        s->plant->tags[tag].validity.stale_s = PLANT_NEVER_STALE_S;
    start(s);
    hear_all(s, 1, 50, QUALITY_GOOD);
    s->log[0] = 0;
    hear_all(s, 10, 50, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    tick(s, 19);
    s->log[0] = 0;
    tick(s, 21);
    assert_told(s, "20 a.LINK raise: normal > unacknowledged\n");
    hear_all(s, 25, 50, QUALITY_GOOD);
    assert_told(s, "25 a.LINK clear: unacknowledged > returned\n");
}
