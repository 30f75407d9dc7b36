/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derives the alarms at a past time from the alarm journal, and sets them in a historical snapshot. */
#include "alarm/alarms_at_instant.h"

#include "alarm/journal.h"
#include "base/mem.h"
#include "value/alarm.h"

struct journal_scan {
    const struct plant *plant;
    struct snapshot *snapshot;
    bool begun;
};

static void on_any(void *arg, const struct journal_row *row)
{
    struct journal_scan *scan = arg;
    (void)row;
    scan->begun = true;
}

static bool graver(const struct plant_tag *tag, enum alarm_kind kind, enum alarm_status status, const struct reading *than)
{
    enum alarm_kind other = (enum alarm_kind)than->alarm;
    if (other == ALARM_NONE)
        return true;
    const struct alarm_grade x = { alarm_priority(tag, kind), kind, status },
                             y = { alarm_priority(tag, other), other, (enum alarm_status)than->alarm_status };
    return alarm_graver(&x, &y);
}

static void on_alarm(void *arg, const struct journal_row *row)
{
    struct journal_scan *scan = arg;
    int tag = plant_find_tag(scan->plant, row->tag);
    enum alarm_kind kind = alarm_kind_find(row->kind);
    enum alarm_status status = alarm_status_find(row->after);
    if (tag < 0 || kind == ALARM_NONE || status == ALARM_STATUSES || !alarm_status_is_annunciated(status))
        return;
    struct reading *reading = &scan->snapshot->readings[tag];
    if (!graver(&scan->plant->tags[tag], kind, status, reading))
        return;
    reading->alarm = (uint8_t)kind;
    reading->alarm_status = (uint8_t)status;
}

int alarms_at_instant(struct log *log, struct history_reader *reader, const char *folder, const struct plant *plant,
                      struct snapshot *snapshot)
{
    struct journal_scan scan = { plant, snapshot, false };
    int64_t t_us = snapshot->taken_utc_ns / 1000;
    struct history_gaps gaps;
    int failed = history_gaps(reader, t_us - 1, t_us + 1, &gaps);
    bool known = gaps.count == 0;
    mem_free(gaps.at);
    if (failed || !known)
        return failed;
    const struct journal_query first = { .from_us = INT64_MIN, .to_us = t_us, .before_id = INT64_MAX, .limit = 1 };
    int error = journal_read(log, folder, &first, on_any, &scan);
    if (!error && scan.begun)
        return journal_at(log, folder, t_us, on_alarm, &scan);
    if (!error)
        alarm_by_limits(plant, snapshot);
    return error;
}
