/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Alarms as text: for sessions as they change, and for programs that ask over HTTP. Every text returned is freed with mem_free. */
#ifndef MESSAGE_ALARM_TEXT_H
#define MESSAGE_ALARM_TEXT_H
#include "alarm/alarm_service.h"
#include "alarm/journal.h"
#include "base/text/text.h"
#include "message/message.h"

/* The last text, for the next session that needs the same. Zero-initialise; alarm_text_cache_finish. Thread: the loop. */
struct alarm_text_cache {
    char *text;
    uint64_t since, number;
};
void alarm_text_cache_finish(struct alarm_text_cache *cache);
/* Returns the message `alarms`: what changed after *number (0: all that is not normal). Sets *number to the newest change. cache NULL:
   the text is made anew. */
char *alarms_text(struct alarm_text_cache *cache, struct alarm_service *alarm_service, const struct plant *plant, int64_t now_utc_ns,
                  uint64_t *number);

/* A query of /api/v1/alarms or /api/v1/alarms/journal. */
struct alarm_query {
    bool csv;
    int limit;                         /* rows at most */
    int64_t offset;                    /* of alarms: rows to skip */
    char tag[256];                     /* or a device; "": all */
    int64_t from_us, to_us, before_id; /* of the journal */
};
/* Parses `limit=100&format=csv`, decoded. journal: the journal's arguments are understood too. Returns false with *error saying what is
   wrong. */
bool alarm_query_parse(const struct plant *plant, bool journal, const char *const *args, size_t count, int64_t now_us,
                       struct alarm_query *query, struct message_error *error);
/* Returns the alarms that are not normal, as JSON or CSV. */
char *alarms_api_text(struct alarm_service *alarm_service, const struct plant *plant, const struct alarm_query *query, int64_t now_utc_ns);
/* Appends the rows of the journal that the query asks for, as CSV if query->csv, else as JSON. Reads the disk; any thread. Returns false,
   with *out emptied, if it cannot be read, already logged. */
bool alarms_journal_text(struct log *log, const char *folder, const struct alarm_query *query, struct text *out);

#endif
