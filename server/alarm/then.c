/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From rows of the journal to what readings say of alarms. */
#include "alarm/then.h"

#include "alarm/journal.h"
#include "base/mem.h"
#include "value/alarm.h"

struct then {
    const struct plant *plant;
    struct snapshot *snapshot;
    bool begun;
};

static void on_any(void *arg, const struct journal_row *row)
{
    struct then *then = arg;
    (void)row;
    then->begun = true;
}

static bool graver(const struct plant_tag *tag, enum alarm_kind kind, enum alarm_word word, const struct reading *than)
{
    enum alarm_kind other = (enum alarm_kind)than->alarm;
    if (other == ALARM_NONE)
        return true;
    const struct alarm_grade x = { alarm_priority(tag, kind), kind, word },
                             y = { alarm_priority(tag, other), other, (enum alarm_word)than->alarm_word };
    return alarm_graver(&x, &y);
}

static void on_alarm(void *arg, const struct journal_row *row)
{
    struct then *then = arg;
    int tag = plant_find_tag(then->plant, row->tag);
    enum alarm_kind kind = alarm_kind_find(row->kind);
    enum alarm_word word = alarm_word_find(row->after);
    if (tag < 0 || kind == ALARM_NONE || word == ALARM_WORDS || !alarm_word_calls(word))
        return;
    struct reading *reading = &then->snapshot->readings[tag];
    if (!graver(&then->plant->tags[tag], kind, word, reading))
        return;
    reading->alarm = (uint8_t)kind;
    reading->alarm_word = (uint8_t)word;
}

int alarms_then(struct log *log, struct history_reader *reader, const char *folder, const struct plant *plant, struct snapshot *snapshot)
{
    struct then then = { plant, snapshot, false };
    int64_t t_us = snapshot->taken_utc_ns / 1000;
    struct history_gaps gaps;
    int failed = history_gaps(reader, t_us - 1, t_us + 1, &gaps);
    bool known = gaps.count == 0;
    mem_free(gaps.at);
    if (failed || !known)
        return failed;
    const struct journal_query first = { .from_us = INT64_MIN, .to_us = t_us, .before_id = INT64_MAX, .limit = 1 };
    int error = journal_read(log, folder, &first, on_any, &then);
    if (!error && then.begun)
        return journal_at(log, folder, t_us, on_alarm, &then);
    if (!error)
        alarm_by_limits(plant, snapshot);
    return error;
}
