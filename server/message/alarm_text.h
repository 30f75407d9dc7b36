/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is said of alarms: to sessions as they change, and to programs that ask. Every result is freed with mem_free. */
#ifndef MESSAGE_ALARM_TEXT_H
#define MESSAGE_ALARM_TEXT_H
#include "alarm/alarm_service.h"
#include "alarm/journal.h"
#include "base/text.h"
#include "message/message.h"

/* What was last said, for the next session that is to hear the same. Zero-initialise. */
struct alarm_text_cache {
    char *text;
    uint64_t since, number;
};
void alarm_text_cache_finish(struct alarm_text_cache *said);
/* The message `alarms`: what changed after *number (0: all that is not normal), which is brought up to date. said NULL: nothing is kept. */
char *alarms_text(struct alarm_text_cache *said, struct alarm_service *alarm_service, const struct plant *plant, int64_t now_utc_ns,
                  uint64_t *number);

/* `/api/v1/alarms` and `/api/v1/alarms/journal`. */
struct alarm_query {
    bool csv;
    int limit;                         /* rows, at most */
    int64_t offset;                    /* of alarms: so many are passed over */
    char tag[256];                     /* or device; "": of all */
    int64_t from_us, to_us, before_id; /* of the journal */
};
/* `limit=100&format=csv`, decoded. False: *error says which is wrong. */
bool alarm_query_parse(const struct plant *plant, bool journal, const char *const *args, size_t count, int64_t now_us,
                       struct alarm_query *query, struct message_error *error);
char *alarms_api_text(struct alarm_service *alarm_service, const struct plant *plant, const struct alarm_query *query, int64_t now_utc_ns);
/* False: it could not be read; logged. */
bool alarms_journal_text(struct log *log, const char *folder, const struct alarm_query *query, struct text *out);

#endif
