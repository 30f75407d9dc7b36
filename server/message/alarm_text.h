/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Alarms as text: changes for sessions, and programs' HTTP queries. Every returned text is freed with mem_free(). */
#ifndef MESSAGE_ALARM_TEXT_H
#define MESSAGE_ALARM_TEXT_H
#include "alarm/alarm_service.h"
#include "alarm/journal.h"
#include "base/text/text.h"
#include "message/message.h"

/* Cache of the newest message `alarms`: its JSON text is built only once for all sessions that need the same one.
   Zero-initialise; end with alarm_text_cache_finish(). Call only in the event loop. */
struct alarm_text_cache {
    char *text;
    uint64_t since, number;
    int64_t utc_ns; /* time at which the text was built */
};
void alarm_text_cache_finish(struct alarm_text_cache *cache);
/* Returns the message `alarms` with the alarms that changed after change number *number; *number 0: all alarms that are not
   normal. Sets *number to the newest change number. A cached text and its member `time_us` are at most 0.1 s old. cache NULL: the
   text is not cached. */
char *alarms_text(struct alarm_text_cache *cache, struct alarm_service *alarm_service, const struct plant *plant, int64_t now_utc_ns,
                  uint64_t *number);

/* Arguments of an HTTP query of /api/v1/alarms or /api/v1/alarms/journal. */
struct alarm_query {
    bool csv;
    int limit;      /* maximum number of rows */
    int64_t offset; /* for /api/v1/alarms: number of alarms at the beginning of the list to leave out */
    char tag[256];  /* name of the tag or device whose alarms to return; empty: all alarms */
    /* for /api/v1/alarms/journal: time range of the rows, in microseconds UTC; before_id: only rows with smaller ids are
       returned */
    int64_t from_us, to_us, before_id;
};
/* Parses the percent-decoded arguments of an HTTP query, such as `limit=100`, `format=csv`. journal true: also accepts the
   arguments of /api/v1/alarms/journal. Returns false with *error saying what is wrong. */
bool alarm_query_parse(const struct plant *plant, bool journal, const char *const *args, size_t count, int64_t now_us,
                       struct alarm_query *query, struct message_error *error);
/* Returns the alarms that are not normal, as JSON or CSV. */
char *alarms_api_text(struct alarm_service *alarm_service, const struct plant *plant, const struct alarm_query *query, int64_t now_utc_ns);
/* Appends the journal rows that the query selects, as CSV if query->csv, else as JSON. Reads the disk. Returns false, with *out
   emptied, if the journal cannot be read (logged). Call from any thread. */
bool alarms_journal_text(struct log *log, const char *folder, const struct plant *plant, const struct alarm_query *query, struct text *out);

#endif
