/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Alarms for the live readings of a plant: the alarm service journals them, and restores them after kill -9 and from a damaged journal. */
#include "tests/support/test.h"
#include <errno.h>
#include <stdatomic.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "alarm/alarm_service.h"
#include "alarm/journal.h"
#include "alarm/alarms_at_instant.h"
#include "base/clock.h"
#include "history/month.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/sleep.h"
#include "value/quality.h"

enum { TAGS = 1000 };

struct alarm_service_setup {
    char *folder;
    struct log *log;
    struct counters *counters;
    struct plant *plant;
    struct store *store;
    struct alarm_service *alarm_service;
};

static void begin(struct alarm_service_setup *s)
{
    s->folder = temp_folder();
    s->log = test_log();
    s->counters = test_counters();
    s->plant = plant_by_hand_create(TAGS);
    s->plant->alarms = ALARMS_LOCAL;
    plant_by_hand_source(s->plant, "plc", 502);
    for (int i = 0; i < TAGS; i++)
        plant_by_hand_tag(s->plant, test_printf("T-%04d", i), TABLE_HOLDING, i, DATA_INT16)->alarms.limits[LIMIT_H] = 80;
    s->store = test_store(s->plant);
}

static void start(struct alarm_service_setup *s)
{
    const struct alarm_service_params params = {
        .log = s->log, .counters = s->counters, .plant = s->plant, .store = s->store, .folder = s->folder, .keep_days = 400
    };
    s->alarm_service = alarm_service_start(&params);
    assert_non_null(s->alarm_service);
}

static void end(struct alarm_service_setup *s)
{
    alarm_service_stop(&s->alarm_service);
}

TEST_FIXTURE(struct alarm_service_setup, begin, end)

#define CASE(name) TEST_ON(struct alarm_service_setup *s, name, set_up, tear_down)

static void give_all(struct alarm_service_setup *s, double value)
{
    struct sample samples[TAGS];
    for (int i = 0; i < TAGS; i++)
        samples[i] = (struct sample){ i, value, QUALITY_GOOD };
    store_write(s->store, samples, TAGS, clock_mono_ns(), clock_utc_ns());
}

struct alarm_rows {
    int count, unacknowledged;
    int64_t smallest_id;
    char last[400], unit[JOURNAL_UNIT_BYTES];
};

static void count_row(void *arg, const struct journal_row *row)
{
    struct alarm_rows *rows = arg;
    rows->count++;
    rows->unacknowledged += !strcmp(row->after, "unacknowledged");
    rows->smallest_id = row->id;
    snprintf(rows->last, sizeof(rows->last), "%s %s %s %s %d %g %s %s", row->tag, row->kind, row->event, row->after, row->priority,
             row->value, row->who, row->reason);
    snprintf(rows->unit, sizeof(rows->unit), "%s", row->unit ? row->unit : "");
}

static struct alarm_rows read_rows(struct alarm_service_setup *s, const char *tag, int limit, int64_t before_id)
{
    struct alarm_rows rows = { 0 };
    const struct journal_query query = { INT64_MIN, INT64_MAX, before_id, tag, limit };
    assert_int_equal(journal_read(s->log, s->folder, &query, count_row, &rows), 0);
    return rows;
}

static void count_alarm(void *arg, const struct alarm *alarm)
{
    ((int *)arg)[alarm_status_of(alarm)]++;
}

static int wait_for(struct alarm_service_setup *s, enum alarm_status word, int wanted)
{
    int64_t end_ns = clock_mono_ns() + 5 * NS_PER_S;
    for (;;) {
        int words[ALARM_STATUSES] = { 0 };
        alarm_service_changes(s->alarm_service, 0, count_alarm, words);
        if (words[word] == wanted || clock_mono_ns() > end_ns)
            return words[word];
        sleep_ns(10 * NS_PER_MS);
    }
}

CASE(a_thousand_at_once_are_all_written)
{
    start(s);
    give_all(s, 90);
    assert_int_equal(wait_for(s, ALARM_UNACKNOWLEDGED, TAGS), TAGS);
    const struct alarm_act shelve = { ALARM_SHELVE, NS_PER_S * 3600, "kim", "filter is being changed" };
    assert_int_equal(alarm_service_act(s->alarm_service, "T-0007", ALARM_H, &shelve), REFUSAL_NONE);
    assert_int_equal(alarm_service_act(s->alarm_service, "T-0007", ALARM_LL, &shelve), REFUSAL_OTHERWISE);
    assert_int_equal(alarm_service_act(s->alarm_service, "nothing", ALARM_H, &shelve), REFUSAL_OTHERWISE);
    struct snapshot *now = test_snapshot(TAGS);
    store_snapshot(s->store, clock_mono_ns(), clock_utc_ns(), now);
    assert_int_equal(now->readings[6].alarm, ALARM_H);
    assert_int_equal(now->readings[6].alarm_status, ALARM_UNACKNOWLEDGED);
    assert_int_equal(now->readings[7].alarm, ALARM_NONE);
    int64_t between_us = clock_utc_ns() / 1000;
    give_all(s, 20);
    assert_int_equal(wait_for(s, ALARM_RETURNED, TAGS - 1), TAGS - 1);
    alarm_service_stop(&s->alarm_service);
    struct alarm_rows all = read_rows(s, NULL, 100000, INT64_MAX), page = read_rows(s, NULL, 500, INT64_MAX);
    assert_int_equal(all.count, 2 * TAGS + 1);
    assert_int_equal(page.count, 500);
    assert_int_equal(read_rows(s, NULL, 100000, page.smallest_id).count, 2 * TAGS + 1 - 500);
    /* reads two rows of this tag, newest first; one.last is the text of the row read last, the older one */
    struct alarm_rows one = read_rows(s, "T-0007", 2, INT64_MAX);
    assert_string_equal(one.last, "T-0007 H shelve shelved 3 nan kim filter is being changed");
    struct alarm_rows then = { 0 };
    assert_int_equal(journal_at(s->log, s->folder, between_us, count_row, &then), 0);
    assert_int_equal(then.count, TAGS);
    assert_int_equal(then.unacknowledged, TAGS - 1);
}

static int alarms_of(struct alarm_service_setup *s, struct history_reader *reader, int64_t at_us)
{
    struct snapshot *then = test_snapshot(TAGS);
    int count = 0;
    then->taken_utc_ns = at_us * 1000;
    assert_int_equal(alarms_at_instant(s->log, reader, s->folder, s->plant, then), 0);
    for (int i = 0; i < TAGS; i++)
        count += then->readings[i].alarm != ALARM_NONE;
    return count;
}

/* An alarm was active when recording ended: for the time after that, while nothing was recorded, queries must not report it as
   active. */
CASE(while_nothing_was_recorded_no_alarm_is_known)
{
    int error;
    start(s);
    give_all(s, 90);
    assert_int_equal(wait_for(s, ALARM_UNACKNOWLEDGED, TAGS), TAGS);
    alarm_service_stop(&s->alarm_service);
    int64_t ended_us = clock_utc_ns() / 1000;
    struct history_tag *tags = test_memory(history_tags(s->plant));
    struct month_file *file = month_file_open(s->log, s->folder, month_of(ended_us), tags, TAGS, &error);
    assert_int_equal(month_file_note(file, ended_us, "gap", "not recorded for 60 s"), 0);
    month_file_close(&file);
    struct history_reader *reader = history_reader_create(s->log, s->folder);
    assert_int_equal(alarms_of(s, reader, ended_us - 1000), TAGS);
    assert_int_equal(alarms_of(s, reader, ended_us + 30 * US_PER_S), 0);
    assert_int_equal(alarms_of(s, reader, ended_us + 61 * US_PER_S), TAGS);
    history_reader_destroy(&reader);
}

/* Returns the plant after a change of its files: T-0003 has no limit, T-0005 is not latched any more, and the last tag is gone. */
static struct plant *changed_plant(void)
{
    struct plant *plant = plant_by_hand_create(TAGS);
    plant->alarms = ALARMS_LOCAL;
    plant_by_hand_source(plant, "plc", 502);
    for (int i = 0; i < TAGS - 1; i++)
        plant_by_hand_tag(plant, test_printf("T-%04d", i), TABLE_HOLDING, i, DATA_INT16)->alarms.limits[LIMIT_H] = i == 3 ? NAN : 80;
    return plant;
}

/* Starts the service of the changed plant, and stops it and the old plant's one. */
static void change_plant(struct alarm_service_setup *s, struct plant *plant, struct alarm_service *before, bool mirrors)
{
    const struct alarm_service_params params = { .log = s->log,
                                                 .counters = s->counters,
                                                 .plant = plant,
                                                 .store = test_store(plant),
                                                 .folder = s->folder,
                                                 .keep_days = 400,
                                                 .mirrors = mirrors,
                                                 .before = before };
    s->alarm_service = alarm_service_start(&params);
    assert_non_null(s->alarm_service);
    alarm_service_stop(&s->alarm_service);
    alarm_service_stop(&before);
}

/* Raises all alarms. Acknowledges the one of T-0005, whose value then returns to normal, so that only its latch keeps it. Returns the
   number of rows. */
static int raise_all(struct alarm_service_setup *s)
{
    const struct alarm_act act = { ALARM_ACKNOWLEDGE, 0, "kim", "" };
    s->plant->tags[5].alarms.settings.latch = true;
    mem_free(s->plant->tags[TAGS - 1].unit);
    s->plant->tags[TAGS - 1].unit = mem_strdup("bar");
    start(s);
    give_all(s, 90);
    assert_int_equal(wait_for(s, ALARM_UNACKNOWLEDGED, TAGS), TAGS);
    assert_int_equal(alarm_service_act(s->alarm_service, "T-0005", ALARM_H, &act), REFUSAL_NONE);
    store_write(s->store, &(struct sample){ 5, 20, QUALITY_GOOD }, 1, clock_mono_ns(), clock_utc_ns());
    assert_int_equal(wait_for(s, ALARM_LATCHED, 1), 1);
    return TAGS + 2;
}

static void expect_ended(struct alarm_service_setup *s, const char *reason)
{
    static const char *const tags[] = { "T-0003", "T-0005", "T-0999" };
    struct alarm_rows active = { 0 };
    for (size_t i = 0; i < 3; i++)
        assert_string_equal(read_rows(s, tags[i], 1, INT64_MAX).last, test_printf("%s H clear normal 3 nan  %s", tags[i], reason));
    assert_string_equal(read_rows(s, "T-0999", 1, INT64_MAX).unit, "bar");
    assert_int_equal(journal_at(s->log, s->folder, clock_utc_ns() / 1000, count_row, &active), 0);
    assert_int_equal(active.count, TAGS - 3);
}

CASE(an_alarm_that_a_reload_ends_is_cleared_in_the_journal)
{
    int rows = raise_all(s);
    alarm_service_halt(s->alarm_service);
    change_plant(s, changed_plant(), s->alarm_service, false);
    assert_int_equal(read_rows(s, NULL, 100000, INT64_MAX).count, rows + 3);
    expect_ended(s, "a reload removed or changed this alarm");
}

CASE(an_alarm_that_a_restart_ends_is_cleared_in_the_journal)
{
    int rows = raise_all(s);
    alarm_service_stop(&s->alarm_service);
    for (int i = 0; i < 2; i++) {
        change_plant(s, changed_plant(), NULL, false);
        assert_int_equal(read_rows(s, NULL, 100000, INT64_MAX).count, rows + 3);
    }
    expect_ended(s, "a restart removed or changed this alarm");
}

/* The core that leads writes these rows, and sends them. */
CASE(a_core_that_mirrors_another_clears_no_alarm_in_the_journal)
{
    int rows = raise_all(s);
    alarm_service_halt(s->alarm_service);
    change_plant(s, changed_plant(), s->alarm_service, true);
    change_plant(s, changed_plant(), NULL, true);
    assert_int_equal(read_rows(s, NULL, 100000, INT64_MAX).count, rows);
}

/* An alarm journalled one second before a kill survives it, and later transitions continue from that state. */
CASE(killed_at_any_moment_it_goes_on)
{
    pid_t child = fork();
    if (child == 0) {
        start(s);
        give_all(s, 90);
        wait_for(s, ALARM_UNACKNOWLEDGED, TAGS);
        const struct alarm_act act = { ALARM_ACKNOWLEDGE, 0, "kim", "" };
        for (int i = 0; i < 400; i++)
            alarm_service_act(s->alarm_service, test_printf("T-%04d", i), ALARM_H, &act);
        for (;;)
            pause();
    }
    int64_t end_ns = clock_mono_ns() + 10 * NS_PER_S;
    while (read_rows(s, NULL, 100000, INT64_MAX).count < TAGS + 400 && clock_mono_ns() < end_ns)
        sleep_ns(20 * NS_PER_MS);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    start(s);
    assert_int_equal(wait_for(s, ALARM_ACKNOWLEDGED, 400), 400);
    assert_int_equal(wait_for(s, ALARM_UNACKNOWLEDGED, TAGS - 400), TAGS - 400);
    give_all(s, 90);
    sleep_ns(400 * NS_PER_MS);
    alarm_service_stop(&s->alarm_service);
    assert_int_equal(read_rows(s, NULL, 100000, INT64_MAX).count, TAGS + 400); /* still there is nothing new */
}

static double counted(struct alarm_service_setup *s, const char *name)
{
    return (double)*counters_add(s->counters, name, "counter", "");
}

/* The device of a thousand tags does not answer: each tag's alarm is journalled, but only the device's one calls for
   acknowledgement. */
CASE(a_lost_device_is_no_flood)
{
    int all[TAGS];
    for (int i = 0; i < TAGS; i++) {
        all[i] = i;
        s->plant->tags[i].validity.stale_s = 600;
        s->plant->tags[i].alarms.settings.on_delay_s = 0.3; /* the LINK alarm waits until all tags are Bad */
    }
    s->store = test_store(s->plant);
    start(s);
    give_all(s, 50);
    store_tags_dead(s->store, all, TAGS, clock_mono_ns());
    store_link_lost(s->store, 0, clock_mono_ns());
    assert_int_equal(wait_for(s, ALARM_SUPPRESSED, TAGS), TAGS);
    assert_int_equal(wait_for(s, ALARM_UNACKNOWLEDGED, 1), 1);
    struct alarm_counts counts;
    alarm_service_counts(s->alarm_service, &counts);
    assert_int_equal(counts.active, 1);
    const struct alarm_act act = { ALARM_ACKNOWLEDGE, 0, "kim", "" };
    assert_int_equal(alarm_service_act(s->alarm_service, "plc", ALARM_LINK, &act), REFUSAL_NONE);
    assert_int_equal(alarm_service_act(s->alarm_service, "T-0001", ALARM_LINK, &act), REFUSAL_OTHERWISE);
    give_all(s, 50);
    assert_int_equal(wait_for(s, ALARM_SUPPRESSED, 0), 0);
    alarm_service_stop(&s->alarm_service);
    assert_int_equal((int)counted(s, "plantcast_alarms_raised_total"), 1);
    struct alarm_rows one = read_rows(s, "T-0007", 2, INT64_MAX), device = read_rows(s, "plc", 10, INT64_MAX);
    assert_int_equal(one.count, 2);
    assert_string_equal(one.last, "T-0007 BAD raise suppressed 4 nan  plc");
    assert_int_equal(device.count, 3);
    assert_string_equal(device.last, "plc LINK raise unacknowledged 3 nan  ");
}

static void on_change(void *arg)
{
    atomic_int *calls = arg;
    (*calls)++;
}

CASE(who_listens_is_told_of_changes)
{
    atomic_int calls = 0;
    start(s);
    alarm_service_listen(s->alarm_service, on_change, &calls);
    give_all(s, 90);
    assert_int_equal(wait_for(s, ALARM_UNACKNOWLEDGED, TAGS), TAGS);
    for (int i = 0; calls == 0 && i < 200; i++)
        sleep_ns(10000000);
    assert_in_range(calls, 1, 50); /* not each of a thousand */
    int before = calls;
    const struct alarm_act act = { .event = ALARM_ACKNOWLEDGE, .who = "somebody", .reason = "" };
    assert_int_equal(alarm_service_act(s->alarm_service, "T-0001", ALARM_H, &act), REFUSAL_NONE);
    assert_true(calls > before);
    alarm_service_listen(s->alarm_service, NULL, NULL);
    before = calls;
    assert_int_equal(alarm_service_act(s->alarm_service, "T-0002", ALARM_H, &act), REFUSAL_NONE);
    assert_int_equal(calls, before);
}

CASE(a_damaged_journal_is_set_aside)
{
    char garbage[8192];
    memset(garbage, 'x', sizeof(garbage));
    temp_write(s->folder, JOURNAL_FILE, garbage, sizeof(garbage));
    start(s);
    give_all(s, 90);
    assert_int_equal(wait_for(s, ALARM_UNACKNOWLEDGED, TAGS), TAGS);
    alarm_service_stop(&s->alarm_service); /* stopping writes all pending rows */
    assert_int_equal(read_rows(s, NULL, 100000, INT64_MAX).count, TAGS);
}

/* Starts a journal while the folder `blocked` has the name of one of its files, and returns its error. Then removes the folder, and
   waits until the journal works, although no alarm changes. */
static int error_while_blocked(struct alarm_service_setup *s, const char *blocked, int error_before)
{
    const struct alarms_listener listener = { 0 };
    const struct journal_params params = {
        .log = s->log, .counters = s->counters, .folder = s->folder, .keep_days = 400, .error_before = error_before
    };
    struct alarms *alarms = alarms_create(s->plant, &listener);
    assert_int_equal(mkdir(blocked, 0755), 0);
    struct journal *journal = journal_start(&params, alarms, (struct instant){ clock_mono_ns(), clock_utc_ns() });
    int error = journal_error(journal);
    assert_int_equal((int)counted(s, "plantcast_alarm_journal_good"), 0);
    assert_int_equal(rmdir(blocked), 0);
    for (int i = 0; journal_error(journal) && i < 3000; i++)
        sleep_ns(10000000);
    assert_int_equal(journal_error(journal), 0);
    assert_int_equal((int)counted(s, "plantcast_alarm_journal_good"), 1);
    assert_true(journal_stop(&journal));
    alarms_destroy(&alarms);
    return error;
}

/* The journal cannot be read when the daemon starts, and can be used a moment later. */
CASE(a_journal_that_failed_is_tried_again_without_alarms)
{
    assert_int_equal(error_while_blocked(s, test_printf("%s/" JOURNAL_FILE, s->folder), 0), -EISDIR);
}

/* A reload replaces a journal that could not be written. The new one finds no file, and has no rows to write. */
CASE(a_new_journal_keeps_the_error_of_the_old_one_until_it_writes)
{
    assert_int_not_equal(error_while_blocked(s, test_printf("%s/" JOURNAL_FILE "-wal", s->folder), -ENOSPC), 0);
}

/* Adds a row to the journal of a folder, by a journal that deletes rows older than 30 days. */
static void add_row(struct alarm_service_setup *s, const char *folder, int64_t utc_ns)
{
    const struct alarms_listener listener = { 0 };
    const struct journal_params params = { .log = s->log, .counters = test_counters(), .folder = folder, .keep_days = 30 };
    struct journal_entry entry = { .alarm = { .kind = ALARM_H, .limit = NAN, .value = NAN }, .changed = true, .utc_ns = utc_ns };
    struct alarms *alarms = alarms_create(s->plant, &listener);
    struct journal *journal = journal_start(&params, alarms, (struct instant){ clock_mono_ns(), clock_utc_ns() });
    strcpy(entry.tag, "T-0000");
    journal_add_entry(journal, &entry);
    assert_true(journal_stop(&journal));
    alarms_destroy(&alarms);
}

/* Records a point of the first tag in the history of a folder. */
static void record_point(struct alarm_service_setup *s, const char *folder, int64_t t_us)
{
    int error;
    struct history_tag *tags = test_memory(history_tags(s->plant));
    struct month_file *file = month_file_open(s->log, folder, month_of(t_us), tags, s->plant->tag_count, &error);
    assert_int_equal(month_file_import(file, 0, &(struct history_point){ t_us, 1, QUALITY_GOOD }, 1), 0);
    month_file_close(&file);
}

/* The history has a pause of a year before the present, which may be due to a wrong clock. Old rows of the journal must stay. */
CASE(a_jump_of_the_clock_deletes_no_rows)
{
    const int64_t now_us = clock_utc_ns() / 1000, old_us = now_us - 365 * 86400 * US_PER_S;
    record_point(s, s->folder, old_us);
    add_row(s, s->folder, old_us * 1000);
    add_row(s, s->folder, now_us * 1000);
    assert_int_equal(read_rows(s, NULL, 100, INT64_MAX).count, 2);
    for (int day = 70; day >= 0; day -= 5)
        record_point(s, s->folder, now_us - day * 86400 * US_PER_S);
    add_row(s, s->folder, (now_us + 1) * 1000);
    assert_int_equal(read_rows(s, NULL, 100, INT64_MAX).count, 2);
}

static void mirror(void *arg, const struct journal_entry *row)
{
    alarm_service_mirror_row(arg, row);
}

/* The journal's second row, the last one that the standby has, was written while the clock was an hour ahead. Later rows have
   earlier times, but must be sent all the same, each once. */
CASE(a_returning_standby_gets_each_row_that_it_lacks_once)
{
    int64_t now_ns = clock_utc_ns() / 1000 * 1000;
    char *leader_folder = s->folder, *folder = test_printf("%s/standby", s->folder);
    start(s);
    struct alarm_service *leader = s->alarm_service;
    struct counters *counters = s->counters;
    s->folder = folder;
    s->counters = test_counters();
    start(s);
    for (int i = 0; i < 3; i++) {
        struct journal_entry row = { .alarm = { .kind = ALARM_H, .priority = 1, .limit = NAN }, .changed = true, .value = i / 3. };
        row.utc_ns = now_ns + i * NS_PER_S + (i == 1 ? 3600 * NS_PER_S : 0);
        snprintf(row.tag, sizeof(row.tag), "T-0001");
        alarm_service_mirror_row(leader, &row);
        if (i == 1)
            alarm_service_mirror_row(s->alarm_service, &row);
    }
    for (int i = 0; i < 2; i++) {
        alarm_service_stop(&s->alarm_service);
        assert_int_equal(read_rows(s, NULL, 100, INT64_MAX).count, i ? 3 : 1);
        start(s);
        assert_int_equal(alarm_service_rows(leader, 0, mirror, s->alarm_service), 3);
    }
    alarm_service_stop(&s->alarm_service);
    assert_int_equal(read_rows(s, NULL, 100, INT64_MAX).count, 3);
    s->counters = counters;
    s->folder = leader_folder;
    s->alarm_service = leader;
}
