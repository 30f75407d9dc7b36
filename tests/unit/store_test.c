/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The store of the newest readings. Special cases: readings that are exactly zero, not a number, old, or whose source is lost.
   */
#include "tests/support/test.h"

#include "tests/support/plant_by_hand.h"
#include "tests/support/plant_case.h"
#include "value/alarm.h"
#include "value/quality.h"
#include "value/store.h"

#define S INT64_C(1000000000)

struct store_setup {
    struct plant *plant; /* plant of the tests: tags 0 and 1 belong to source 0, tag 2 to source 1; readings become stale after 5 s */
    struct store *store;
    struct snapshot *snapshot;
};

static void begin(struct store_setup *s)
{
    s->plant = plant_by_hand_create(3);
    plant_by_hand_source(s->plant, "a", 1);
    plant_by_hand_tag(s->plant, "a0", TABLE_HOLDING, 0, DATA_INT16);
    plant_by_hand_tag(s->plant, "a1", TABLE_HOLDING, 1, DATA_INT16);
    plant_by_hand_source(s->plant, "b", 2);
    plant_by_hand_tag(s->plant, "b0", TABLE_HOLDING, 0, DATA_INT16);
    s->store = test_store(s->plant);
    s->snapshot = test_snapshot(s->plant->tag_count);
}

TEST_FIXTURE(struct store_setup, begin, NULL)

#define CASE(name) TEST_ON(struct store_setup *s, name, set_up, tear_down)

static void write_one(struct store_setup *s, int tag, double value, uint32_t quality, int64_t now_ns)
{
    store_write(s->store, &(struct sample){ tag, value, quality }, 1, now_ns, now_ns + 1000 * S);
}

static const struct reading *look(struct store_setup *s, int tag, int64_t now_ns)
{
    store_snapshot(s->store, now_ns, now_ns + 1000 * S, s->snapshot);
    return &s->snapshot->readings[tag];
}

static void set_up_again(struct store_setup *s)
{
    s->store = test_store(s->plant);
}

static int64_t take(struct store_setup *s, int64_t now_ns)
{
    return store_take(s->store, now_ns, now_ns + 1000 * S, s->snapshot);
}

#define assert_quality(q, wanted) assert_string_equal(quality_name(q), quality_name(wanted))

CASE(waits_for_the_first_value)
{
    const struct reading *r = look(s, 0, 10 * S);
    assert_quality(r->quality, QUALITY_BAD_WAITING);
    assert_true(r->age_ns == INT64_MAX);
    assert_true(r->received_utc_ns == 0);
    assert_int_equal(r->changes, 0);
    assert_quality(look(s, 0, 10000 * S)->quality, QUALITY_BAD_WAITING);
}

CASE(zero_is_a_reading)
{
    write_one(s, 0, 0.0, QUALITY_GOOD, 10 * S);
    const struct reading *r = look(s, 0, 12 * S);
    assert_quality(r->quality, QUALITY_GOOD);
    assert_true(r->value == 0.0);
    assert_true(r->age_ns == 2 * S);
    assert_true(r->received_utc_ns == 1010 * S);
    assert_int_equal(r->changes, 1);
}

CASE(not_a_number_is_a_sensor_failure)
{
    const double none[] = { NAN, INFINITY, -INFINITY };
    for (int i = 0; i < 3; i++) {
        write_one(s, 0, 7, QUALITY_GOOD, (10 + i) * S);
        write_one(s, 0, none[i], QUALITY_GOOD, (10 + i) * S);
        const struct reading *r = look(s, 0, (11 + i) * S);
        assert_quality(r->quality, QUALITY_BAD_SENSOR_FAILURE);
        assert_true(isfinite(r->value));
    }
}

CASE(a_bad_sample_does_not_make_the_value_younger)
{
    write_one(s, 0, 7, QUALITY_GOOD, 10 * S);
    write_one(s, 0, 99, QUALITY_BAD_CONFIGURATION, 12 * S);
    const struct reading *r = look(s, 0, 13 * S);
    assert_quality(r->quality, QUALITY_BAD_CONFIGURATION);
    assert_true(r->age_ns == 3 * S);
    assert_true(r->value == 7);
    /* an old reading keeps the reason (quality) that it was given */
    assert_quality(look(s, 0, 100 * S)->quality, QUALITY_BAD_CONFIGURATION);
}

CASE(goes_stale)
{
    write_one(s, 0, 7, QUALITY_GOOD, 10 * S);
    assert_quality(look(s, 0, 15 * S - 1)->quality, QUALITY_GOOD);
    uint32_t before = look(s, 0, 15 * S - 1)->changes;
    assert_quality(look(s, 0, 15 * S)->quality, QUALITY_BAD_COMMUNICATION_ERROR);
    assert_int_equal(look(s, 0, 16 * S)->changes, before + 1); /* becoming stale counts as one change, however many snapshots are taken */
    write_one(s, 0, 7, QUALITY_GOOD, 20 * S);
    const struct reading *r = look(s, 0, 20 * S);
    assert_quality(r->quality, QUALITY_GOOD);
    assert_int_equal(r->changes, before + 2); /* the same value again counts as a change, because the reading is usable again */
}

CASE(uncertain_stays_uncertain)
{
    write_one(s, 0, 700, QUALITY_UNCERTAIN_UNITS_EXCEEDED, 10 * S);
    assert_quality(look(s, 0, 11 * S)->quality, QUALITY_UNCERTAIN_UNITS_EXCEEDED);
    assert_true(look(s, 0, 11 * S)->value == 700);
    assert_quality(look(s, 0, 15 * S)->quality, QUALITY_BAD_COMMUNICATION_ERROR);
}

CASE(link_lost_keeps_the_value_until_stale)
{
    write_one(s, 0, 7, QUALITY_GOOD, 10 * S);
    write_one(s, 2, 8, QUALITY_GOOD, 10 * S);
    store_link_up(s->store, 0, 10 * S);
    assert_true(store_link_is_up(s->store, 0));
    store_link_lost(s->store, 0, 11 * S);
    assert_false(store_link_is_up(s->store, 0));
    assert_quality(look(s, 0, 11 * S)->quality, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    assert_true(look(s, 0, 11 * S)->value == 7);
    assert_quality(look(s, 1, 11 * S)->quality, QUALITY_BAD_NO_COMMUNICATION); /* never had one */
    assert_quality(look(s, 2, 11 * S)->quality, QUALITY_GOOD);                 /* another source */
    assert_quality(look(s, 0, 15 * S - 1)->quality, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    assert_quality(look(s, 0, 15 * S)->quality, QUALITY_BAD_COMMUNICATION_ERROR);
    assert_quality(look(s, 1, 100 * S)->quality, QUALITY_BAD_NO_COMMUNICATION);
}

CASE(link_back_is_not_yet_a_reading)
{
    write_one(s, 0, 7, QUALITY_GOOD, 10 * S);
    store_link_lost(s->store, 0, 11 * S);
    store_link_up(s->store, 0, 12 * S);
    assert_true(store_link_is_up(s->store, 0));
    assert_quality(look(s, 0, 12 * S)->quality, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    assert_quality(look(s, 1, 12 * S)->quality, QUALITY_BAD_NO_COMMUNICATION);
    write_one(s, 0, 7, QUALITY_GOOD, 13 * S);
    write_one(s, 1, 3, QUALITY_GOOD, 13 * S);
    assert_quality(look(s, 0, 13 * S)->quality, QUALITY_GOOD);
    assert_quality(look(s, 1, 13 * S)->quality, QUALITY_GOOD);
    assert_true(look(s, 1, 13 * S)->age_ns == 0);
}

CASE(a_refused_tag_that_is_cut_off_says_so)
{
    write_one(s, 0, 7, QUALITY_GOOD, 10 * S);
    write_one(s, 0, 0, QUALITY_BAD_CONFIGURATION, 11 * S);
    store_link_lost(s->store, 0, 12 * S);
    /* after the refusal and the loss of the link, the value from before must not appear as current */
    assert_quality(look(s, 0, 12 * S)->quality, QUALITY_BAD_COMMUNICATION_ERROR);
}

CASE(some_tags_can_be_lost)
{
    write_one(s, 0, 7, QUALITY_GOOD, 10 * S);
    write_one(s, 1, 8, QUALITY_GOOD, 10 * S);
    store_link_up(s->store, 0, 10 * S);
    store_tags_lost(s->store, (int[]){ 1 }, 1, 11 * S);
    assert_quality(look(s, 0, 11 * S)->quality, QUALITY_GOOD);
    assert_quality(look(s, 1, 11 * S)->quality, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    assert_true(store_link_is_up(s->store, 0));
}

CASE(what_is_dead_is_bad_at_once)
{
    write_one(s, 0, 7, QUALITY_GOOD, 10 * S);
    store_tags_dead(s->store, (int[]){ 0, 1 }, 2, 12 * S);
    assert_quality(look(s, 0, 12 * S)->quality, QUALITY_BAD_COMMUNICATION_ERROR);
    assert_quality(look(s, 1, 12 * S)->quality, QUALITY_BAD_NO_COMMUNICATION); /* never had a value */
    write_one(s, 0, 8, QUALITY_GOOD, 11 * S); /* this sample is dated before the loss of the link */
    assert_quality(look(s, 0, 12 * S)->quality, QUALITY_GOOD);
    store_tags_lost(s->store, (int[]){ 0 }, 1, 13 * S);
    assert_quality(look(s, 0, 13 * S)->quality, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
}

CASE(counts_every_change)
{
    uint32_t wanted = 0;
    write_one(s, 0, 7, QUALITY_GOOD, 10 * S);
    assert_int_equal(look(s, 0, 10 * S)->changes, ++wanted);
    write_one(s, 0, 7, QUALITY_GOOD, 11 * S); /* the same again */
    assert_int_equal(look(s, 0, 11 * S)->changes, wanted);
    write_one(s, 0, 7.5, QUALITY_GOOD, 12 * S);
    assert_int_equal(look(s, 0, 12 * S)->changes, ++wanted);
    write_one(s, 0, 7.5, QUALITY_UNCERTAIN_UNITS_EXCEEDED, 12 * S);
    assert_int_equal(look(s, 0, 12 * S)->changes, ++wanted);
    write_one(s, 0, 8, QUALITY_GOOD, 12 * S);
    write_one(s, 0, 9, QUALITY_GOOD, 12 * S); /* the two changes of value must count as two, although no snapshot was taken in between */
    wanted += 2;
    assert_int_equal(look(s, 0, 12 * S)->changes, wanted);
    store_link_lost(s->store, 0, 13 * S);
    store_link_lost(s->store, 0, 13 * S);
    assert_int_equal(look(s, 0, 13 * S)->changes, ++wanted);
    /* without any sample the reading gets too old and goes from Uncertain to Bad, which counts as a change */
    assert_int_equal(look(s, 0, 17 * S)->changes, ++wanted);
    write_one(s, 0, 0, QUALITY_BAD_DEVICE_FAILURE, 18 * S);
    assert_int_equal(look(s, 0, 18 * S)->changes, ++wanted);
    write_one(s, 0, 5, QUALITY_BAD_DEVICE_FAILURE, 19 * S); /* a sample with Bad quality: its value 5 must be ignored */
    assert_int_equal(look(s, 0, 19 * S)->changes, wanted);
}

CASE(the_newest_sample_wins)
{
    write_one(s, 0, 7, QUALITY_GOOD, 12 * S);
    write_one(s, 0, 6, QUALITY_GOOD, 11 * S);
    assert_true(look(s, 0, 12 * S)->value == 7);
    store_link_lost(((struct store_setup *)s)->store, 0, 11 * S); /* known before the sample came */
    assert_quality(look(s, 0, 12 * S)->quality, QUALITY_GOOD);
}

CASE(the_snapshot_says_when)
{
    look(s, 0, 12 * S);
    assert_true(s->snapshot->taken_mono_ns == 12 * S);
    assert_true(s->snapshot->taken_utc_ns == 1012 * S);
    assert_int_equal(s->snapshot->count, 3);
}

static void count_events(void *arg, const struct sample_event *event)
{
    *(int64_t *)arg += event->mono_ns;
}

/* After a reload, readings are carried over to the new plant. One tag is in both plants, with another index and another stale
   time; another tag is new. */
CASE(readings_go_on_in_another_plant)
{
    struct plant *plant = plant_by_hand_create(2);
    plant_by_hand_source(plant, "a", 1);
    plant_by_hand_tag(plant, "new", TABLE_HOLDING, 0, DATA_INT16);
    plant_by_hand_tag(plant, "a1", TABLE_HOLDING, 1, DATA_INT16)->validity.stale_s = 60;
    write_one(s, 1, 42, QUALITY_GOOD, 10 * S);
    store_set_alarm(s->store, 1, ALARM_HH, ALARM_UNACKNOWLEDGED);
    store_link_up(s->store, 0, 10 * S);
    struct store *store = test_store(plant);
    struct snapshot *snapshot = test_snapshot(2);
    store_adopt(store, s->store);
    store_snapshot(store, 30 * S, 1030 * S, snapshot);
    assert_true(snapshot->readings[1].value == 42);
    /* alarms are not carried over: the alarm service of the new plant has not evaluated any yet */
    assert_int_equal(snapshot->readings[1].alarm, ALARM_NONE);
    assert_quality(snapshot->readings[1].quality, QUALITY_GOOD); /* Good again, because the stale time in the new plant is longer */
    assert_true(snapshot->readings[1].age_ns == 20 * S);
    assert_quality(snapshot->readings[0].quality, QUALITY_BAD_WAITING);
    assert_true(store_link_is_up(store, 0));
}

static const struct reading *look_in(struct store_setup *s, struct store *store, int tag, int64_t now_ns)
{
    store_snapshot(store, now_ns, now_ns + 1000 * S, s->snapshot);
    return &s->snapshot->readings[tag];
}

/* After a reload, a tag's first sample replaces the reading from before, although the sample has an earlier source time. The next
   samples are compared with it as usual. */
CASE(the_first_sample_after_a_reload_wins)
{
    write_one(s, 0, 42, QUALITY_GOOD, 20 * S);
    write_one(s, 1, 0, QUALITY_BAD_CONFIGURATION, 20 * S); /* refused, and never had a value */
    struct store *store = test_store(s->plant);
    store_adopt(store, s->store);
    assert_true(look_in(s, store, 0, 21 * S)->value == 42);
    assert_quality(look_in(s, store, 0, 21 * S)->quality, QUALITY_GOOD);
    const struct sample first[] = { { 0, 7, QUALITY_GOOD }, { 1, 8, QUALITY_GOOD } }, older = { 0, 6, QUALITY_GOOD };
    store_write(store, first, 2, 19 * S, 1019 * S);
    store_write(store, &older, 1, 18 * S, 1018 * S);
    assert_true(look_in(s, store, 0, 21 * S)->value == 7);
    assert_true(s->snapshot->readings[0].age_ns == 2 * S);
    assert_quality(look_in(s, store, 1, 21 * S)->quality, QUALITY_GOOD);
}

#define ADOPTED_PLANT(source, base)                                                                                                        \
    "plant: { name: P }\nassets:\n  - { id: A, model: m.glb }\ngroups:\n  - { id: g, unit: bar, min: 0, max: 9 }\n"                        \
    "sources:\n  - { id: " source ", type: modbus, host: h, address_base: " base " }\ntags: tags.csv\n"
#define ADOPTED_TAGS(address, scaled_high, sentinel, formula)                                                                              \
    "Tag Name,Address,Data Type,Eng Units,Scaling,Raw Low,Raw High,Scaled Low,Scaled High,Open Circuit\n"                                  \
    "T," address ",,bar,Linear,0,100,0," scaled_high "," sentinel "\nSAME,hr:9,,bar,,,,,,\nSUM,= " formula ",,bar,,,,,,\n"

/* A reload that changes how a tag gets its value does not keep the tag's old reading: that is the reading of another node, or has
   the wrong scaling. Tags computed from this tag do not keep theirs either. */
TEST_WITH(a_corrected_tag_waits_for_its_first_value, plant_case_set_up, plant_case_tear_down)
{
    static const struct {
        const char *yaml, *tags;
        bool keeps[3]; /* of T, SAME and SUM */
    } cases[] = { { ADOPTED_PLANT("a", "1"), ADOPTED_TAGS("40001", "10", "", "[T] + [T]"), { true, true, true } },
                  { ADOPTED_PLANT("a", "1"), ADOPTED_TAGS("40002", "10", "", "[T] + [T]"), { false, true, false } },
                  { ADOPTED_PLANT("a", "1"), ADOPTED_TAGS("40001", "20", "", "[T] + [T]"), { false, true, false } },
                  { ADOPTED_PLANT("a", "1"), ADOPTED_TAGS("40001", "10", "32767", "[T] + [T]"), { false, true, false } },
                  { ADOPTED_PLANT("a", "0"), ADOPTED_TAGS("40001", "10", "", "[T] + [T]"), { false, true, false } },
                  { ADOPTED_PLANT("b", "1"), ADOPTED_TAGS("40001", "10", "", "[T] + [T]"), { false, false, false } },
                  { ADOPTED_PLANT("a", "1"), ADOPTED_TAGS("40001", "10", "", "[T] + [SAME]"), { true, true, false } } };
    const struct sample samples[] = { { 0, 42, QUALITY_GOOD }, { 1, 43, QUALITY_GOOD }, { 2, 44, QUALITY_GOOD } };
    struct plant_case *c = *state;
    plant_case_load(c, cases[0].yaml, cases[0].tags);
    plant_case_assert_loaded(c, 0);
    struct store *before = test_store(c->plant);
    store_write(before, samples, 3, 10 * S, 1010 * S);
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct plant_case other = { .folder = c->folder, .path = c->path };
        plant_case_load(&other, cases[i].yaml, cases[i].tags);
        plant_case_assert_loaded(&other, 0);
        struct store *after = test_store(other.plant);
        struct snapshot *snapshot = test_snapshot(3);
        store_adopt(after, before);
        store_snapshot(after, 11 * S, 1011 * S, snapshot);
        for (int tag = 0; tag < 3; tag++) {
            assert_quality(snapshot->readings[tag].quality, cases[i].keeps[tag] ? QUALITY_GOOD : QUALITY_BAD_WAITING);
            assert_true(snapshot->readings[tag].age_ns == (cases[i].keeps[tag] ? S : INT64_MAX));
        }
        plant_case_forget(&other);
    }
}

static void mirror_one(struct store_setup *s, int tag, double value, uint32_t quality, int64_t now_ns)
{
    const struct mirrored reading = {
        .tag = tag, .quality = quality, .value = value, .has_value = true, .received_mono_ns = now_ns, .received_utc_ns = now_ns + 1000 * S
    };
    store_mirror(s->store, &reading, 1, now_ns);
}

/* A standby takes over: its store then has its core's readings, and gets samples from its own sources. These must become stale,
   lost and flat as on a daemon that never was a standby, and the first one must count even if it is older. */
CASE(readings_become_stale_again_after_a_take_over)
{
    s->plant->tags[1].validity.flatline_s = 3;
    set_up_again(s);
    for (int tag = 0; tag < 3; tag++)
        mirror_one(s, tag, 42, tag == 2 ? QUALITY_BAD_CONFIGURATION : QUALITY_GOOD, 10 * S);
    assert_quality(look(s, 0, 1000 * S)->quality, QUALITY_GOOD); /* the core decides */
    store_tags_dead(s->store, (int[]){ 0, 1 }, 2, 11 * S);       /* the link to the core ends */
    write_one(s, 0, 42, QUALITY_GOOD, 12 * S);
    assert_quality(look(s, 0, 17 * S - 1)->quality, QUALITY_GOOD);
    assert_true(take(s, 12 * S) == 17 * S);
    assert_quality(look(s, 0, 17 * S)->quality, QUALITY_BAD_COMMUNICATION_ERROR);
    write_one(s, 0, 42, QUALITY_GOOD, 18 * S);
    store_tags_lost(s->store, (int[]){ 0 }, 1, 19 * S);
    assert_quality(look(s, 0, 23 * S - 1)->quality, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE);
    assert_quality(look(s, 0, 23 * S)->quality, QUALITY_BAD_COMMUNICATION_ERROR);
    assert_quality(look(s, 1, 1000 * S)->quality, QUALITY_BAD_COMMUNICATION_ERROR); /* no own sample arrives */
    for (int t = 12; t <= 16; t++)
        write_one(s, 1, 42, QUALITY_GOOD, t * S);
    assert_quality(look(s, 1, 16 * S)->quality, QUALITY_UNCERTAIN_SENSOR_NOT_ACCURATE);
    /* the core could not read tag 2, but this daemon can; the value has not changed since before */
    write_one(s, 2, 7, QUALITY_GOOD, 9 * S);
    assert_quality(look(s, 2, 10 * S)->quality, QUALITY_GOOD);
}

/* A source that knows that it has missed messages marks its last values, but not the tags that never had one. */
CASE(missed_values_make_the_last_ones_unusable)
{
    for (int dead = 0; dead < 2; dead++) {
        set_up_again(s);
        write_one(s, 0, 7, QUALITY_GOOD, 10 * S);
        store_values_missed(s->store, (int[]){ 0, 1 }, 2, dead, 11 * S);
        assert_quality(look(s, 0, 11 * S)->quality, dead ? QUALITY_BAD_COMMUNICATION_ERROR : QUALITY_UNCERTAIN_LAST_USABLE);
        assert_quality(look(s, 0, 15 * S)->quality, QUALITY_BAD_COMMUNICATION_ERROR);
        assert_quality(look(s, 1, 11 * S)->quality, QUALITY_BAD_WAITING);
        write_one(s, 0, 8, QUALITY_GOOD, 12 * S);
        assert_quality(look(s, 0, 12 * S)->quality, QUALITY_GOOD);
    }
}

/* A tag whose source was lost gets samples from another source. It sends the last value again with the original timestamp,
   which the daemon's clock shifts slightly. The reading must become usable again. */
CASE(a_value_told_again_is_good_again)
{
    write_one(s, 0, 42, QUALITY_GOOD, 10 * S);
    store_write(s->store, &(struct sample){ .tag = 0, .value = 7, .quality = QUALITY_GOOD }, 1, 10 * S - 1, 1010 * S);
    assert_true(look(s, 0, 10 * S)->value == 42); /* while the first source is alive, the older sample of the second source is ignored */
    store_tags_dead(s->store, &(int){ 0 }, 1, 20 * S);
    assert_true(quality_is_bad(look(s, 0, 21 * S)->quality));
    store_write(s->store, &(struct sample){ .tag = 0, .value = 9, .quality = QUALITY_GOOD }, 1, 10 * S - 1, 1009 * S);
    /* this sample is older than the last known value, so it must not make the reading usable */
    assert_true(quality_is_bad(look(s, 0, 21 * S)->quality));
    store_write(s->store, &(struct sample){ .tag = 0, .value = 42, .quality = QUALITY_GOOD }, 1, 10 * S - 1, 1010 * S);
    assert_true(look(s, 0, 21 * S)->value == 42);
    assert_false(quality_is_bad(look(s, 0, 11 * S)->quality));
    /* a tag that was refused, and never had a value */
    write_one(s, 1, 0, QUALITY_BAD_CONFIGURATION, 10 * S);
    store_tags_dead(s->store, &(int){ 1 }, 1, 20 * S);
    write_one(s, 1, 8, QUALITY_GOOD, 9 * S);
    assert_quality(look(s, 1, 10 * S)->quality, QUALITY_GOOD);
}

CASE(all_who_listen_hear_until_they_leave)
{
    int64_t one = 0, other = 0;
    store_listen(s->store, count_events, &one);
    store_listen(s->store, count_events, &other);
    write_one(s, 0, 1, QUALITY_GOOD, 3);
    store_unlisten(s->store, count_events, &one);
    store_link_lost(s->store, 0, 10);
    assert_int_equal(one, 3);
    assert_int_equal(other, 3 + 2 * 10); /* both tags of the link */
}

/* Before the first sample the store knows no UTC time. If a source is lost then, the loss must not be reported with a time in
   1970. */
CASE(what_is_lost_at_first_is_not_told_at_a_wrong_time)
{
    int64_t heard = 0;
    store_listen(s->store, count_events, &heard);
    store_link_lost(s->store, 0, 10);
    assert_int_equal(heard, 0);
    assert_int_equal(look(s, 0, 10)->quality, QUALITY_BAD_NO_COMMUNICATION); /* every snapshot shows the loss */
    write_one(s, 0, 1, QUALITY_GOOD, 13);
    store_link_lost(s->store, 0, 20);
    assert_true(heard > 13);
}

TEST(qualities_have_names_and_classes)
{
    assert_string_equal(quality_name(QUALITY_GOOD), "Good");
    assert_string_equal(quality_name(QUALITY_BAD_COMMUNICATION_ERROR), "Bad_CommunicationError");
    assert_string_equal(quality_name(0x80FF0000u), "Bad");
    assert_string_equal(quality_name(0x40FF0000u), "Uncertain");
    assert_string_equal(quality_class(QUALITY_GOOD), "good");
    assert_string_equal(quality_class(QUALITY_UNCERTAIN_UNITS_EXCEEDED), "uncertain");
    assert_string_equal(quality_class(QUALITY_BAD_WAITING), "bad");
    assert_string_equal(quality_class(0xC0000000u), "bad");
}

CASE(a_value_that_never_moves_is_doubted)
{
    s->plant->tags[0].validity.flatline_s = 60;
    set_up_again(s);
    for (int t = 0; t < 60; t++) {
        write_one(s, 0, 7, QUALITY_GOOD, t * S);
        assert_quality(look(s, 0, t * S)->quality, QUALITY_GOOD);
    }
    write_one(s, 0, 7, QUALITY_GOOD, 60 * S);
    assert_quality(look(s, 0, 60 * S)->quality, QUALITY_UNCERTAIN_SENSOR_NOT_ACCURATE);
    assert_true(look(s, 0, 60 * S)->value == 7);
    assert_quality(look(s, 0, 66 * S)->quality, QUALITY_BAD_COMMUNICATION_ERROR); /* and old, which is worse */
    write_one(s, 0, 7.001, QUALITY_GOOD, 67 * S);
    assert_quality(look(s, 0, 67 * S)->quality, QUALITY_GOOD);
    for (int t = 68; t < 1000; t++)
        write_one(s, 1, 7, QUALITY_GOOD, t * S);
    assert_quality(look(s, 1, 1000 * S)->quality, QUALITY_GOOD); /* this tag has no flatline_s */
}

/* A controller has stopped, and its gateway still answers with the last values. The heartbeat tag, which no longer changes,
   reveals that. Tags whose quality comes from another tag of this controller must then be Bad as well. */
CASE(a_stopped_heartbeat_makes_quality_tags_unreadable)
{
    s->plant->sources[0].heartbeat_s = 3;
    s->plant->sources[0].heartbeat_tag = 1;
    s->plant->tags[2].validity.quality = (struct plant_quality_tag){ .tag = 0, .mask = 1, .want = 1 };
    set_up_again(s);
    for (int t = 0; t < 10; t++) {
        for (int tag = 0; tag < 3; tag++)
            write_one(s, tag, 1, QUALITY_GOOD, t * S);
        assert_quality(look(s, 2, t * S)->quality, t < 3 ? QUALITY_GOOD : QUALITY_UNCERTAIN);
    }
}

CASE(a_stopped_heartbeat_makes_all_bad)
{
    s->plant->sources[0].heartbeat_s = 3;
    s->plant->sources[0].heartbeat_tag = 1;
    set_up_again(s);
    write_one(s, 0, 20, QUALITY_GOOD, 0);
    assert_quality(look(s, 0, 0)->quality, QUALITY_BAD_WAITING); /* the heartbeat tag has no reading yet */
    for (int t = 0; t < 10; t++) {
        write_one(s, 0, 20, QUALITY_GOOD, t * S);
        write_one(s, 1, t, QUALITY_GOOD, t * S);
        write_one(s, 2, 20, QUALITY_GOOD, t * S);
        assert_quality(look(s, 0, t * S)->quality, QUALITY_GOOD);
    }
    for (int t = 10; t < 20; t++) {
        uint32_t wanted = t < 12 ? QUALITY_GOOD : QUALITY_BAD_DEVICE_FAILURE;
        for (int tag = 0; tag < 3; tag++)
            write_one(s, tag, tag == 1 ? 9 : 20, QUALITY_GOOD, t * S);
        assert_quality(look(s, 0, t * S)->quality, wanted);
        assert_quality(look(s, 1, t * S)->quality, wanted);
        assert_quality(look(s, 2, t * S)->quality, QUALITY_GOOD); /* another source */
    }
    write_one(s, 1, 10, QUALITY_GOOD, 20 * S);
    assert_quality(look(s, 0, 20 * S)->quality, QUALITY_GOOD);
    write_one(s, 1, 0, QUALITY_BAD_CONFIGURATION, 21 * S); /* the heartbeat tag can no longer be read, which counts as no heartbeat */
    assert_quality(look(s, 0, 22 * S)->quality, QUALITY_GOOD);
    assert_quality(look(s, 0, 23 * S)->quality, QUALITY_BAD_DEVICE_FAILURE);
}

CASE(a_heartbeat_that_is_refused_from_the_start)
{
    s->plant->sources[0].heartbeat_s = 3;
    s->plant->sources[0].heartbeat_tag = 1;
    set_up_again(s);
    write_one(s, 1, 0, QUALITY_BAD_CONFIGURATION, 0);
    write_one(s, 0, 20, QUALITY_GOOD, 0);
    assert_quality(look(s, 0, 0)->quality, QUALITY_BAD_CONFIGURATION);
}

static void on_sample_event(void *arg, const struct sample_event *event)
{
    uint32_t *qualities = arg;
    qualities[event->tag] = event->quality;
}

CASE(other_tags_vouch)
{
    uint32_t heard[3] = { 1, 1, 1 };
    s->plant->tags[0].validity.quality = (struct plant_quality_tag){ .tag = 1, .mask = 0x0C, .want = 0x04 };
    s->plant->tags[2].validity.quality = (struct plant_quality_tag){ .tag = 1, .mask = UINT64_MAX, .want = 0, .negate = true };
    set_up_again(s);
    store_listen(s->store, on_sample_event, heard);
    write_one(s, 0, 20, QUALITY_GOOD, 0);
    write_one(s, 2, 30, QUALITY_GOOD, 0);
    assert_quality(look(s, 0, 0)->quality, QUALITY_UNCERTAIN); /* the quality of tag 0 comes from tag 1, which has no reading yet */
    const struct {
        double word;
        uint32_t pattern, any;
    } cases[] = { { 0x04, QUALITY_GOOD, QUALITY_GOOD },
                  { 0xF7, QUALITY_GOOD, QUALITY_GOOD },
                  { 0x0C, QUALITY_BAD_SENSOR_FAILURE, QUALITY_GOOD },
                  { 0, QUALITY_BAD_SENSOR_FAILURE, QUALITY_BAD_SENSOR_FAILURE },
                  { -1, QUALITY_BAD_SENSOR_FAILURE, QUALITY_GOOD },
                  /* a double cannot represent all 64 bits of this number, so the lowest bits, and with them the quality, are
                     unknown */
                  { 0x1p62 + 0x1p10, QUALITY_UNCERTAIN, QUALITY_UNCERTAIN } };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        write_one(s, 1, cases[i].word, QUALITY_GOOD, S);
        /* the quality of tag 0 changes with tag 1 and must be reported at once, without a new sample of tag 0 */
        assert_quality(heard[0], cases[i].pattern);
        assert_quality(heard[2], cases[i].any);
        assert_quality(look(s, 0, S)->quality, cases[i].pattern);
        assert_quality(look(s, 2, S)->quality, cases[i].any);
    }
    write_one(s, 1, 4, QUALITY_GOOD, S);
    write_one(s, 0, 20, QUALITY_UNCERTAIN_UNITS_EXCEEDED, 2 * S);
    assert_quality(look(s, 0, 2 * S)->quality, QUALITY_UNCERTAIN_UNITS_EXCEEDED); /* the tag's own quality stays */
    write_one(s, 0, 20, QUALITY_GOOD, 3 * S);
    write_one(s, 1, 0, QUALITY_BAD_CONFIGURATION, 3 * S);
    assert_quality(heard[0], QUALITY_UNCERTAIN);
    assert_quality(look(s, 0, 3 * S)->quality, QUALITY_UNCERTAIN);
}

/* The UTC clock is set. Ages of readings come from the monotonic clock, so no reading may become fresh or stale by that; UTC
   times are for display only. */
CASE(a_step_of_the_wall_clock_makes_nothing_fresh_or_stale)
{
    store_write(s->store, &(struct sample){ 0, 7, QUALITY_GOOD }, 1, 10 * S, 1000 * S);
    store_snapshot(s->store, 12 * S, -500000 * S, s->snapshot);
    assert_true(s->snapshot->readings[0].age_ns == 2 * S && s->snapshot->readings[0].quality == QUALITY_GOOD);
    store_snapshot(s->store, 16 * S, 1001 * S, s->snapshot);
    assert_quality(s->snapshot->readings[0].quality, QUALITY_BAD_COMMUNICATION_ERROR);
    store_write(s->store, &(struct sample){ 0, 8, QUALITY_GOOD }, 1, 17 * S, 5 * S); /* the clock was put back */
    store_snapshot(s->store, 18 * S, 6 * S, s->snapshot);
    assert_true(s->snapshot->readings[0].value == 8 && s->snapshot->readings[0].age_ns == S);
}

static void count_call(void *arg)
{
    ++*(int *)arg;
}

CASE(whoever_watches_is_told_once_until_the_next_look)
{
    int told = 0, wanted = 0;
    store_watch(s->store, count_call, &told);
    write_one(s, 0, 20, QUALITY_GOOD, S);
    write_one(s, 1, 30, QUALITY_GOOD, S);
    assert_int_equal(told, ++wanted);
    take(s, S);
    write_one(s, 0, 20, QUALITY_GOOD, 2 * S); /* the same again: only younger */
    assert_int_equal(told, wanted);
    write_one(s, 0, 21, QUALITY_GOOD, 2 * S);
    look(s, 0, 2 * S); /* a snapshot for another reader */
    write_one(s, 0, 22, QUALITY_GOOD, 2 * S);
    assert_int_equal(told, ++wanted);
    take(s, 2 * S);
    store_set_alarm(s->store, 0, 1, 1);
    assert_int_equal(told, ++wanted);
    take(s, 2 * S);
    store_set_alarm(s->store, 0, 1, 1);
    assert_int_equal(told, wanted);
    store_link_up(s->store, 0, 2 * S);
    assert_int_equal(told, ++wanted);
    take(s, 2 * S);
    store_tags_lost(s->store, (int[]){ 1 }, 1, 2 * S);
    assert_int_equal(told, ++wanted);
    take(s, 2 * S);
    store_watch(s->store, NULL, NULL);
    store_link_lost(s->store, 0, 3 * S);
    write_one(s, 0, 1, QUALITY_GOOD, 3 * S);
    assert_int_equal(told, wanted);
}

CASE(says_when_a_reading_gets_stale)
{
    assert_true(take(s, 0) == INT64_MAX);
    write_one(s, 0, 20, QUALITY_GOOD, 1 * S);
    write_one(s, 1, 20, QUALITY_GOOD, 3 * S);
    assert_true(take(s, 3 * S) == 6 * S);
    write_one(s, 0, 20, QUALITY_GOOD, 4 * S);
    assert_true(take(s, 4 * S) == 8 * S);
    assert_true(take(s, 8 * S) == 9 * S);
    assert_true(take(s, 9 * S) == INT64_MAX); /* both readings are stale */
}

/* Writes samples at random and pauses. For each reading that became stale, the store must report the time of that, which must
   be the time from which snapshots show the stale quality. */
CASE(says_since_when_a_reading_is_old)
{
    enum { STEP = S / 100 };
    int found = 0;
    s->plant->sources[0].heartbeat_s = 3;
    s->plant->sources[0].heartbeat_tag = 1;
    s->plant->tags[0].validity.flatline_s = 4;
    s->plant->tags[2].validity.quality = (struct plant_quality_tag){ .tag = 0, .mask = 1, .want = 1 };
    set_up_again(s);
    srand(1);
    int64_t written_ns = S, since_ns[3] = { 0 };
    uint32_t before[3] = { 0 };
    for (int round = 0; round < 300; round++) {
        int64_t pause_ns = (1 + rand() % 80) * (S / 10);
        write_one(s, rand() % 3, rand() % 3, QUALITY_GOOD, written_ns);
        for (int64_t now_ns = written_ns; now_ns < written_ns + pause_ns; now_ns += STEP)
            for (int tag = 0; tag < 3; tag++) {
                uint32_t quality = look(s, tag, now_ns)->quality;
                if (now_ns == written_ns || quality != before[tag])
                    since_ns[tag] = now_ns;
                before[tag] = quality;
                int64_t aged_ns = store_aged_ns(s->store, tag, now_ns);
                assert_true(aged_ns <= now_ns);
                if (since_ns[tag] > written_ns) {
                    assert_true(aged_ns == since_ns[tag]);
                    found++;
                }
            }
        written_ns += pause_ns;
    }
    assert_true(found > 1000);
}

/* After the heartbeat has returned, the reading must be Good again, and store_aged_ns() must no longer report a time at which time
   alone made it Bad (it then returns the present time). */
CASE(a_reading_is_usable_again_when_the_heartbeat_returns)
{
    s->plant->sources[0].heartbeat_s = 2;
    s->plant->sources[0].heartbeat_tag = 1;
    s->plant->tags[0].validity.flatline_s = 3;
    set_up_again(s);
    write_one(s, 0, 20, QUALITY_GOOD, S);
    write_one(s, 1, 1, QUALITY_GOOD, S);
    assert_quality(look(s, 0, 7 * S / 2)->quality, QUALITY_BAD_DEVICE_FAILURE);
    assert_true(store_aged_ns(s->store, 0, 7 * S / 2) == 3 * S);
    write_one(s, 1, 2, QUALITY_GOOD, 9 * S / 2);
    assert_quality(look(s, 0, 5 * S)->quality, QUALITY_GOOD);
    assert_true(store_aged_ns(s->store, 0, 5 * S) == 5 * S);
}

/* Random writes, losses, alarms and pauses. Every change that a snapshot shows must have been reported to listeners before, or
   lie at a time that the store had announced. */
CASE(nothing_changes_unannounced)
{
    struct snapshot *last = test_snapshot(3);
    const uint32_t qualities[] = { QUALITY_GOOD, QUALITY_UNCERTAIN_UNITS_EXCEEDED, QUALITY_BAD_SENSOR_FAILURE };
    int told = 0, announced = 0;
    s->plant->sources[0].heartbeat_s = 3;
    s->plant->sources[0].heartbeat_tag = 1;
    s->plant->tags[2].validity.quality = (struct plant_quality_tag){ .tag = 0, .mask = 1, .want = 1 };
    set_up_again(s);
    store_watch(s->store, count_call, &told);
    srand(1);
    int64_t now_ns = S, next_ns = INT64_MAX;
    for (int i = 0; i < 20000; i++) {
        int tag = rand() % 3, what = rand() % 40;
        now_ns += rand() % (what == 39 ? 4 * S : S / 2);
        if (what < 20)
            write_one(s, tag, rand() % 3, qualities[what % 3], now_ns);
        else if (what == 20)
            store_tags_lost(s->store, &tag, 1, now_ns);
        else if (what == 21)
            store_link_lost(s->store, tag % 2, now_ns);
        else if (what == 22)
            store_link_up(s->store, tag % 2, now_ns);
        else if (what == 23)
            store_tags_dead(s->store, &tag, 1, now_ns);
        else if (what == 24)
            store_set_alarm(s->store, tag, rand() % 2, 1);
        look(s, 0, now_ns);
        for (int j = 0; j < 3; j++)
            if (s->snapshot->readings[j].changes != last->readings[j].changes) {
                assert_true(told || now_ns >= next_ns);
                announced += !told;
            }
        told = 0;
        next_ns = take(s, now_ns);
        assert_true(next_ns > now_ns);
        memcpy(last->readings, s->snapshot->readings, 3 * sizeof(*last->readings));
    }
    assert_true(announced > 100);
}
