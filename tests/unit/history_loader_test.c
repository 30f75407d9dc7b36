/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that loads snapshots of the past: they must equal what was recorded. If a client makes several requests, only the
   newest is answered. */
#include "service/history_loader.h"

#include "tests/support/test.h"

#include "base/clock.h"
#include "history/history.h"
#include "history/month.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/sleep.h"
#include "value/quality.h"

static const int64_t BEGIN = INT64_C(1793500000) * US_PER_S;

struct history_loader_setup {
    char *folder;
    struct log *log;
    struct plant *plant;
    struct snapshot_cache *snapshot_cache;
    struct history_loader *loader;
    _Atomic int notified;
};

static void on_answer(void *arg)
{
    struct history_loader_setup *s = arg;
    s->notified++;
}

/* Records a tag that rises by 1 each second for 50 s and then has no value for 10 s. */
static void record(struct history_loader_setup *s)
{
    struct history_tag *tags = history_tags(s->plant);
    struct history_point points[52];
    int error;
    struct month_file *file = month_file_open(s->log, s->folder, month_of(BEGIN), tags, 1, &error);
    for (int i = 0; i <= 50; i++)
        points[i] = (struct history_point){ BEGIN + i * US_PER_S, i, QUALITY_GOOD };
    points[51] = (struct history_point){ BEGIN + 51 * US_PER_S, NAN, QUALITY_BAD_COMMUNICATION_ERROR };
    assert_int_equal(month_file_import(file, 0, points, 52), 0);
    month_file_close(&file);
    mem_free(tags);
}

static void begin(struct history_loader_setup *s)
{
    s->folder = temp_folder();
    s->log = test_log();
    s->plant = plant_by_hand_create(1);
    plant_by_hand_source(s->plant, "plc", 502);
    plant_by_hand_tag(s->plant, "A", TABLE_HOLDING, 0, DATA_FLOAT32)->deadband = 0;
    record(s);
    s->snapshot_cache = snapshot_cache_create();
    const struct history_loader_params params = { .log = s->log,
                                                  .plant = s->plant,
                                                  .folder = s->folder,
                                                  .snapshot_cache = s->snapshot_cache,
                                                  .notify = on_answer,
                                                  .notify_arg = s };
    s->loader = history_loader_create(&params);
}

static void end(struct history_loader_setup *s)
{
    history_loader_destroy(&s->loader);
    snapshot_cache_destroy(&s->snapshot_cache);
}

TEST_FIXTURE(struct history_loader_setup, begin, end)

/* Requests a snapshot of the instant from the loader. Returns the tag's reading at that time. */
static struct reading read_at(struct history_loader_setup *s, int64_t at_us)
{
    int before = s->notified;
    history_loader_ask(s->loader, 7, at_us);
    for (int i = 0; i < 1000 && s->notified == before; i++)
        sleep_ns(10 * NS_PER_MS);
    struct history_loader_answer *answer = history_loader_collect(s->loader);
    assert_non_null(answer);
    assert_true(answer->good && answer->client == 7 && answer->at_us == at_us && !answer->next);
    const struct historical_snapshot *historical = snapshot_cache_take(s->snapshot_cache, at_us);
    assert_non_null(historical);
    assert_true(historical->snapshot.taken_utc_ns == at_us * 1000);
    struct reading reading = historical->snapshot.readings[0];
    snapshot_cache_give(s->snapshot_cache, &historical);
    mem_free(answer);
    return reading;
}

TEST_ON(struct history_loader_setup *s, test_an_instant_is_as_it_was, set_up, tear_down)
{
    struct reading middle = read_at(s, BEGIN + 20500000), gap = read_at(s, BEGIN + 55 * US_PER_S), before = read_at(s, BEGIN - 1);
    assert_true(middle.quality == QUALITY_GOOD && fabs(middle.value - 20.5) < 1e-9);
    assert_true(gap.quality == QUALITY_BAD_COMMUNICATION_ERROR && gap.age_ns == 4 * NS_PER_S);
    assert_true(before.quality == QUALITY_BAD_WAITING);
    assert_true(read_at(s, BEGIN + 20500000).value == middle.value);
    assert_true(history_loader_first_us(s->loader) == BEGIN);
}

TEST_ON(struct history_loader_setup *s, test_only_the_newest_wish_of_a_client_counts, set_up, tear_down)
{
    enum { WISHES = 2000 };
    for (int i = 1; i <= WISHES; i++)
        history_loader_ask(s->loader, 7, BEGIN + i);
    history_loader_ask(s->loader, 8, BEGIN + 5);
    history_loader_forget(s->loader, 9);
    int64_t last_us = 0;
    bool other = false;
    int count = 0;
    for (int i = 0; i < 1000 && !(other && last_us == BEGIN + WISHES); i++) {
        for (struct history_loader_answer *answer = history_loader_collect(s->loader), *next; answer; answer = next) {
            next = answer->next;
            other |= answer->client == 8;
            last_us = answer->client == 7 ? answer->at_us : last_us;
            count++;
            mem_free(answer);
        }
        sleep_ns(5 * NS_PER_MS);
    }
    assert_true(other && last_us == BEGIN + WISHES && count < WISHES);
}
