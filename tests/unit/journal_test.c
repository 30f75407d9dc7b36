/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queries of the alarm journal: paging, and each alarm's state at an instant, compared with a plain loop over all rows. */
#include "tests/support/test.h"
#include <inttypes.h>

#include "alarm/journal_file.h"

enum { ROWS = 3000, TAGS = 7, KINDS = 3, BEGIN_US = 1000000 };

struct expected_row {
    int tag, kind;
    int64_t t_us;
    enum alarm_status after;
};

struct journal_setup {
    char *folder;
    struct log *log;
    struct journal_file *file;
    struct expected_row rows[ROWS]; /* by id, from 1 on */
};

static void write_rows(struct journal_setup *s)
{
    struct journal_entry *entries = mem_array(ROWS, sizeof(*entries));
    for (int i = 0; i < ROWS; i++) {
        const struct expected_row *row = &s->rows[i];
        entries[i] = (struct journal_entry){
            .alarm = { .kind = (enum alarm_kind)(ALARM_LL + row->kind), .priority = 2, .limit = NAN, .value = NAN },
            .changed = true,
            .event = row->after == ALARM_NORMAL ? ALARM_CLEAR : ALARM_RAISE,
            .after = row->after,
            .utc_ns = row->t_us * 1000,
            .value = i,
        };
        snprintf(entries[i].tag, sizeof(entries[i].tag), "T-%d", row->tag);
    }
    assert_int_equal(journal_file_write(s->file, entries, ROWS), 0);
    mem_free(entries);
}

/* Fills the journal with random rows, many of them at the same instant as in an alarm flood, then deletes some so that row
   numbers have gaps. */
static void begin(struct journal_setup *s)
{
    bool renewed;
    int error;
    unsigned seed = (unsigned)sweep_seed();
    int64_t t_us = BEGIN_US;
    s->folder = temp_folder();
    s->log = test_log();
    s->file = journal_file_open(s->log, s->folder, &renewed, &error);
    assert_non_null(s->file);
    for (int i = 0; i < ROWS; i++) {
        t_us += rand_r(&seed) % 3 ? 0 : rand_r(&seed) % 1000;
        s->rows[i] = (struct expected_row){ rand_r(&seed) % TAGS, rand_r(&seed) % KINDS, t_us,
                                           rand_r(&seed) % 2 ? ALARM_NORMAL : ALARM_UNACKNOWLEDGED };
    }
    write_rows(s);
}

static void end(struct journal_setup *s)
{
    journal_file_close(&s->file);
}

TEST_FIXTURE(struct journal_setup, begin, end)

#define CASE(name) TEST_ON(struct journal_setup *s, name, set_up, tear_down)

struct found_rows {
    int64_t ids[ROWS];
    int count;
};

static void on_row(void *arg, const struct journal_row *row)
{
    struct found_rows *found = arg;
    assert_true(found->count < ROWS);
    found->ids[found->count++] = row->id;
}

static void check_at(struct journal_setup *s, int64_t t_us)
{
    int64_t last[TAGS][KINDS] = { 0 };
    int wanted = 0;
    struct found_rows found = { .count = 0 };
    for (int i = 0; i < ROWS && s->rows[i].t_us <= t_us; i++)
        last[s->rows[i].tag][s->rows[i].kind] = i + 1;
    assert_int_equal(journal_file_at(s->file, t_us, on_row, &found), 0);
    for (int tag = 0; tag < TAGS; tag++)
        for (int kind = 0; kind < KINDS; kind++) {
            int64_t id = last[tag][kind];
            if (!id || s->rows[id - 1].after == ALARM_NORMAL)
                continue;
            int k = 0;
            while (k < found.count && found.ids[k] != id)
                k++;
            assert_true(k < found.count);
            wanted++;
        }
    assert_int_equal(found.count, wanted);
}

CASE(each_alarm_is_as_it_was_then)
{
    check_at(s, BEGIN_US - 1);
    check_at(s, INT64_MAX);
    for (int i = 0; i < ROWS; i += 37) {
        check_at(s, s->rows[i].t_us);
        check_at(s, s->rows[i].t_us - 1);
    }
}

/* Asserts that paging backwards from the newest row returns every row in the time range exactly once, for one tag or for all. */
static void check_pages(struct journal_setup *s, const char *tag, int64_t from_us, int64_t to_us, int limit)
{
    struct journal_query query = { from_us, to_us, INT64_MAX, tag, limit };
    int at = ROWS;
    for (;;) {
        struct found_rows found = { .count = 0 };
        assert_int_equal(journal_file_rows(s->file, &query, on_row, &found), 0);
        for (int k = 0; k < found.count; k++) {
            do
                assert_true(--at >= 0);
            while (s->rows[at].t_us < from_us || s->rows[at].t_us > to_us || (tag && s->rows[at].tag != atoi(tag + 2)));
            assert_int_equal(found.ids[k], at + 1);
        }
        if (found.count < limit)
            break;
        query.before_id = found.ids[found.count - 1];
    }
    while (--at >= 0)
        assert_true(s->rows[at].t_us < from_us || s->rows[at].t_us > to_us || (tag && s->rows[at].tag != atoi(tag + 2)));
}

CASE(pages_follow_each_other)
{
    check_pages(s, NULL, INT64_MIN, INT64_MAX, 7);
    check_pages(s, NULL, s->rows[700].t_us, s->rows[2100].t_us, 100);
    check_pages(s, "T-3", INT64_MIN, INT64_MAX, 11);
    check_pages(s, "T-3", s->rows[900].t_us, s->rows[901].t_us, 1);
    check_pages(s, NULL, s->rows[ROWS - 1].t_us + 1, INT64_MAX, 5);
}

/* Paging continues from the last row of the page before, even if that row has been deleted meanwhile. */
CASE(a_page_after_rows_that_are_gone)
{
    struct found_rows found = { .count = 0 };
    const struct journal_query query = { INT64_MIN, INT64_MAX, 500, NULL, ROWS };
    assert_int_equal(journal_file_forget(s->file, INT64_MAX), 0);
    assert_int_equal(journal_file_rows(s->file, &query, on_row, &found), 0);
    assert_int_equal(found.count, 0);
    assert_int_equal(journal_file_at(s->file, INT64_MAX, on_row, &found), 0);
    assert_int_equal(found.count, 0);
}
