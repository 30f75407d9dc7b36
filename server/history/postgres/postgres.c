/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that sends the points in the outboxes of the monthly history files to PostgreSQL. */
#include "history/postgres/postgres.h"

#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "history/history.h"
#include "history/month.h"
#include "history/postgres/postgres_restore.h"
#include "value/backoff.h"

enum { BATCH_ROWS = 20000, ROUND_MS = 1000 };
enum { NOTES = 128, SPANS = POSTGRES_SPANS };
/* upper bound on the time between the last recorded points of different tags. If this daemon does not know when it last
   received a sample of the leader, it reads points from the database from this long before its newest recorded point on */
static const int64_t LINE_END_SPREAD_US = 60 * INT64_C(1000000);
/* Upper bound, in nanoseconds, on the delay until a sample is a point in the files of both the leader and the standby. The
   thread waits this long before it deletes points that the leader has sent, and before it reads points from the database that
   this machine lacks. */
static const int64_t OVERLAP_NS = 10 * NS_PER_S;
static const int64_t LOOK_NS = 30 * NS_PER_S, NEWEST_NS = 5 * NS_PER_S, SAY_LOST_NS = 60 * NS_PER_S;

struct waiting_month {
    int month;
    int64_t count;
};

/* For a standby: the newest sequence number in a month's outbox at the time at_ns. Once the leader has sent all points up to
   that time, the standby deletes the points up to this number. */
struct outbox_note {
    int64_t at_ns, seq;
    int month;
};

struct postgres {
    struct postgres_params params;
    char *folder;
    int64_t ended_us; /* UTC time of the last point in the history files when the sending thread started */
    struct history_tag *tags;
    struct {
        counter *up, *points, *waiting, *lost, *restored;
    } counters;
    pthread_t thread;
    bool started;
    int stop_fd; /* eventfd (a descriptor that another thread makes readable) that tells the sending thread to end */
    pthread_mutex_t lock;
    /* --- below: under `lock` */
    bool leads, ends_lines;
    int64_t sent_ns; /* monotonic time T: all points recorded before T are in the database; INT64_MIN: unknown */
    struct postgres_owed owed;
    /* --- below: used by the sending thread only */
    struct postgres_link *link; /* connection to PostgreSQL; NULL: none */
    struct postgres_tables tables;
    struct postgres_restore restore;
    struct backoff backoff;
    struct waiting_month *months;
    size_t month_count;
    int64_t looked_ns, newest_ns, retry_ns, say_lost_ns;
    /* number of points that were deleted from the outboxes without being sent, and that the log does not report yet */
    int64_t lost;
    char said[POSTGRES_WHY_BYTES]; /* text of the last logged error; empty: no error */
    /* alone: this daemon holds the lock that makes it the only writer to the database; flushed: all points that an earlier run
       left in the outboxes have been sent */
    bool alone, flushed;
    struct outbox_note notes[NOTES];
    size_t note_count;
};

static struct log *log_of(const struct postgres *postgres)
{
    return postgres->params.log;
}

static bool ends(const struct postgres *postgres)
{
    struct pollfd fd = { .fd = postgres->stop_fd, .events = POLLIN };
    return poll(&fd, 1, 0) > 0;
}

/* --- the connection to PostgreSQL --------------------------------------------------------------------------------------------- */

/* Closes the connection after an error, and schedules the next attempt. Logs the error only if its cause has changed. */
static void give_up(struct postgres *postgres, const char *why)
{
    char cause[POSTGRES_WHY_BYTES];
    snprintf(cause, sizeof(cause), "%.*s", (int)strcspn(why, "\n"), why);
    if (strcmp(cause, postgres->said) != 0 && !ends(postgres))
        log_event(log_of(postgres), LOG_ERROR, EVENT_HISTORY_UNWRITABLE,
                  "history: PostgreSQL does not accept recorded points (%s); the points are queued in %s, at most %.0f", cause,
                  postgres->folder, postgres->params.plant->history.postgres.spool_points);
    memcpy(postgres->said, cause, sizeof(cause));
    postgres_tables_finish(&postgres->tables);
    postgres_link_close(&postgres->link);
    counter_set(postgres->counters.up, 0);
    int64_t now_ns = clock_mono_ns();
    postgres->retry_ns = now_ns + backoff_next_ns(&postgres->backoff, (uint64_t)now_ns);
}

static void connect_now(struct postgres *postgres)
{
    const struct plant *plant = postgres->params.plant;
    char why[POSTGRES_WHY_BYTES];
    if (postgres->link || clock_mono_ns() < postgres->retry_ns)
        return;
    if (!(postgres->link = postgres_link_open(&plant->history.postgres, postgres->stop_fd, why))) {
        give_up(postgres, why);
        return;
    }
    if (!postgres_tables_open(&postgres->tables, postgres->link, plant, postgres->alone, why)) {
        give_up(postgres, *why ? why : postgres_link_why(postgres->link));
        return;
    }
    postgres->newest_ns = 0;
}

/* Marks the database as working: resets the error state. Call it only after a successful write: a connection alone proves
   nothing, because even a server with a full disk accepts connections. */
static void is_well(struct postgres *postgres)
{
    postgres->backoff = (struct backoff){ 0 };
    counter_set(postgres->counters.up, 1);
    if (*postgres->said)
        log_event(log_of(postgres), LOG_INFO, EVENT_HISTORY_WRITTEN,
                  "history: PostgreSQL accepts recorded points again; the queued points are sent");
    *postgres->said = 0;
}

static void restore(struct postgres *postgres)
{
    char why[POSTGRES_WHY_BYTES] = "";
    int64_t points;
    if (!postgres->link || !postgres->restore.wanted)
        return;
    if (!postgres_restore_step(&postgres->restore, &postgres->tables, clock_utc_ns() / 1000, &points, why)) {
        give_up(postgres, *why ? why : postgres_link_why(postgres->link));
        return;
    }
    counter_inc(postgres->counters.restored, points);
}

/* If this daemon has become the leader: reconnects with the lock that makes it the only writer. A tag's recorded line runs
   through its points. Where no daemon continues a tag's line, adds a point without a value to the database, which ends the
   line. */
static void take_lead(struct postgres *postgres)
{
    pthread_mutex_lock(&postgres->lock);
    bool leads = postgres->leads, ends_lines = postgres->ends_lines;
    pthread_mutex_unlock(&postgres->lock);
    if (leads && !postgres->alone) {
        postgres_tables_finish(&postgres->tables);
        postgres_link_close(&postgres->link);
        postgres->alone = true;
        postgres->retry_ns = 0;
        connect_now(postgres);
    }
    if (!leads || !ends_lines || !postgres->link)
        return;
    if (!postgres_restore_end_lines(&postgres->tables, clock_utc_ns() / 1000)) {
        give_up(postgres, postgres_link_why(postgres->link));
        return;
    }
    pthread_mutex_lock(&postgres->lock);
    postgres->ends_lines = false;
    pthread_mutex_unlock(&postgres->lock);
}

/* Returns true if the points of a span can be read: the other daemon has had time to send them, and this daemon has sent its
   own. The caller holds the lock. */
static bool is_due(const struct postgres *postgres, const struct postgres_span *span)
{
    return clock_mono_ns() >= span->at_ns + OVERLAP_NS && postgres->sent_ns >= span->at_ns;
}

/* Reads the points that another daemon recorded in a time span from the database. leads: the span is the time just before this
   daemon became the leader. On becoming leader, this daemon marked the ends of lines in the database; the former leader may
   have sent later points, so the marks are corrected first. */
static bool fill_span(struct postgres *postgres, const struct postgres_span *span, bool leads, int64_t *points,
                      char why[POSTGRES_WHY_BYTES])
{
    return (!leads || postgres_restore_end_span(&postgres->tables, span->from_us, span->to_us)) &&
           postgres_restore_span(&postgres->restore, &postgres->tables, span->from_us, span->to_us, points, why);
}

/* Reads the points of the oldest owed time span from the database: another daemon recorded them, and this machine lacks them.
   First waits until that daemon has had time to send them and our own points are sent. */
static void fill(struct postgres *postgres)
{
    pthread_mutex_lock(&postgres->lock);
    struct postgres_span span = postgres->owed.spans[0];
    bool due = postgres->owed.span_count && is_due(postgres, &span), leads = postgres->leads;
    pthread_mutex_unlock(&postgres->lock);
    if (!due || !postgres->link || postgres->restore.wanted)
        return;
    char why[POSTGRES_WHY_BYTES] = "";
    int64_t points;
    if (!fill_span(postgres, &span, leads, &points, why)) {
        give_up(postgres, *why ? why : postgres_link_why(postgres->link));
        return;
    }
    pthread_mutex_lock(&postgres->lock);
    memmove(postgres->owed.spans, postgres->owed.spans + 1, --postgres->owed.span_count * sizeof(span));
    pthread_mutex_unlock(&postgres->lock);
    counter_inc(postgres->counters.restored, points);
    log_info(log_of(postgres), "history: read %lld points from PostgreSQL, covering the %.0f s in which another core led",
             (long long)points, (double)(span.to_us - span.from_us) / 1e6);
}

/* --- waiting points ----------------------------------------------------------------------------------------------------------- */

static void count_month(struct postgres *postgres, struct waiting_month *month)
{
    int error;
    struct month_outbox *outbox = month_outbox_open(log_of(postgres), postgres->folder, month->month, &error);
    month->count = 0;
    if (outbox)
        month_outbox_count(outbox, &month->count);
    month_outbox_close(&outbox);
}

/* Counts the points in the outboxes. Counts the newest month each time, but the others only rarely, because only imports and
   clock changes add points there. */
static void look_for_points(struct postgres *postgres)
{
    size_t count;
    int *months = month_list(postgres->folder, &count);
    bool all = count != postgres->month_count || clock_mono_ns() - postgres->looked_ns >= LOOK_NS;
    if (all) {
        mem_free(postgres->months);
        postgres->months = mem_array(count + 1, sizeof(*postgres->months));
        postgres->month_count = count;
        postgres->looked_ns = clock_mono_ns();
    }
    for (size_t i = 0; i < count; i++)
        if (all || i + 1 == count || postgres->months[i].month != months[i]) {
            postgres->months[i].month = months[i];
            count_month(postgres, &postgres->months[i]);
        }
    mem_free(months);
}

static int64_t waiting(const struct postgres *postgres)
{
    int64_t sum = 0;
    for (size_t i = 0; i < postgres->month_count; i++)
        sum += postgres->months[i].count;
    return sum;
}

/* If more than spool_points wait in the outboxes, deletes the oldest points there; the history files still have them. */
static void drop_oldest(struct postgres *postgres)
{
    int64_t over = waiting(postgres) - (int64_t)postgres->params.plant->history.postgres.spool_points, lost = 0;
    for (size_t i = 0; i < postgres->month_count && over > 0; i++) {
        struct waiting_month *month = &postgres->months[i];
        int64_t drop = month->count < over ? month->count : over, before = month->count;
        int error;
        struct month_outbox *outbox = drop ? month_outbox_open(log_of(postgres), postgres->folder, month->month, &error) : NULL;
        if (outbox && month_outbox_shorten(outbox, before - drop) == 0)
            month_outbox_count(outbox, &month->count);
        lost += before - month->count;
        over -= before - month->count;
        month_outbox_close(&outbox);
        if (month->count == before && drop)
            break;
    }
    counter_inc(postgres->counters.lost, lost);
    postgres->lost += lost;
    if (postgres->lost && clock_mono_ns() >= postgres->say_lost_ns) {
        log_event(log_of(postgres), LOG_ERROR, EVENT_HISTORY_LOST,
                  "history: the queue for PostgreSQL is full: %lld points remain only in the local files", (long long)postgres->lost);
        postgres->say_lost_ns = clock_mono_ns() + SAY_LOST_NS;
        postgres->lost = 0;
    }
}

/* --- sending ------------------------------------------------------------------------------------------------------------------ */

/* Sends one batch of an outbox's points. *more: true if another batch follows. Returns false if the database or the file
   failed, so that sending must stop. */
static bool send_batch(struct postgres *postgres, struct month_outbox *outbox, struct waiting_month *month, bool newest, bool *more)
{
    struct month_outbox_batch batch = { 0 };
    bool good = month_outbox_read(outbox, BATCH_ROWS, &batch) == 0;
    *more = batch.row_count == BATCH_ROWS;
    if (good && (batch.row_count || newest)) {
        good = postgres_tables_write(&postgres->tables, month->month, &batch, newest);
        if (good)
            is_well(postgres);
        else
            give_up(postgres, postgres_link_why(postgres->link));
    }
    if (good && batch.row_count) {
        counter_inc(postgres->counters.points, (int64_t)batch.row_count);
        good = month_outbox_delete(outbox, batch.rows[batch.row_count - 1].seq) == 0;
        month->count -= (int64_t)batch.row_count;
    }
    month_outbox_batch_finish(&batch);
    return good;
}

static bool send_month(struct postgres *postgres, struct waiting_month *month, bool newest)
{
    int error;
    bool good = true, more = month->count > 0 || newest;
    struct month_outbox *outbox = more ? month_outbox_open(log_of(postgres), postgres->folder, month->month, &error) : NULL;
    while (outbox && more && good) {
        good = send_batch(postgres, outbox, month, newest, &more);
        newest = false;
        counter_set(postgres->counters.waiting, waiting(postgres));
    }
    month_outbox_close(&outbox);
    return good;
}

/* On a standby: OVERLAP_NS after points were recorded, deletes those that the leader has sent to the database from the outbox. */
static void forget_sent(struct postgres *postgres)
{
    pthread_mutex_lock(&postgres->lock);
    int64_t until_ns = postgres->sent_ns;
    pthread_mutex_unlock(&postgres->lock);
    size_t done = 0;
    while (done < postgres->note_count && until_ns != INT64_MIN && postgres->notes[done].at_ns <= until_ns - OVERLAP_NS)
        done++;
    if (done) {
        const struct outbox_note *note = &postgres->notes[done - 1];
        int error;
        struct month_outbox *outbox = month_outbox_open(log_of(postgres), postgres->folder, note->month, &error);
        if (outbox)
            month_outbox_delete(outbox, note->seq);
        month_outbox_close(&outbox);
        postgres->note_count -= done;
        memmove(postgres->notes, postgres->notes + done, postgres->note_count * sizeof(*postgres->notes));
    }
}

/* On a standby: notes the newest sequence number in the newest month's outbox. When a new month begins, points of the previous
   month may be sent twice; the database then replaces each point with an identical one. */
static void note_outbox(struct postgres *postgres)
{
    int error, month = postgres->month_count ? postgres->months[postgres->month_count - 1].month : 0;
    int64_t seq = 0;
    struct month_outbox *outbox =
        postgres->month_count && postgres->note_count < NOTES ? month_outbox_open(log_of(postgres), postgres->folder, month, &error) : NULL;
    if (outbox && month_outbox_last(outbox, &seq) == 0 && seq)
        postgres->notes[postgres->note_count++] = (struct outbox_note){ clock_mono_ns(), seq, month };
    month_outbox_close(&outbox);
}

/* Sends the points in all outboxes. With those of the newest month, it also sends the newest samples, which are not recorded
   yet, every few seconds and when the daemon ends. */
static void send_all(struct postgres *postgres)
{
    int64_t now_ns = clock_mono_ns();
    bool newest = postgres->alone && (!postgres->newest_ns || now_ns - postgres->newest_ns >= NEWEST_NS || ends(postgres)), good = true;
    for (size_t i = 0; i < postgres->month_count && postgres->link && good; i++)
        good = send_month(postgres, &postgres->months[i], newest && i + 1 == postgres->month_count);
    if (newest && good && postgres->link)
        postgres->newest_ns = now_ns;
    if (!good || !postgres->link || waiting(postgres))
        return;
    postgres->flushed = true;
    if (postgres->alone) {
        pthread_mutex_lock(&postgres->lock);
        /* sets sent_ns to the time one round ago, because the historian may have added points to one outbox while this round
           was sending another */
        postgres->sent_ns = now_ns - ROUND_MS * NS_PER_MS;
        pthread_mutex_unlock(&postgres->lock);
    }
}

static void *postgres_main(void *arg)
{
    struct postgres *postgres = arg;
    struct pollfd fd = { .fd = postgres->stop_fd, .events = POLLIN };
    bool last;
    do {
        /* runs one more round after the stop signal, so that points written before the signal are sent */
        last = poll(&fd, 1, ROUND_MS) > 0;
        if (!last || !*postgres->said)
            connect_now(postgres);
        take_lead(postgres);
        if (!last) {
            restore(postgres);
            fill(postgres);
        }
        look_for_points(postgres);
        drop_oldest(postgres);
        counter_set(postgres->counters.waiting, waiting(postgres));
        if (postgres->alone || !postgres->flushed) {
            /* If this machine's files are being restored, sends nothing yet. The restore must first end each tag's recorded
               line that earlier recordings left open in the database, with a point without a value. */
            if (!postgres->restore.wanted || postgres->restore.next_month != INT_MAX)
                send_all(postgres);
        } else {
            forget_sent(postgres);
            note_outbox(postgres);
        }
    } while (!last);
    return NULL;
}

static void add_counters(struct postgres *postgres, struct counters *counters)
{
    postgres->counters.up =
        counters_add(counters, "plantcast_postgres_up", "gauge", "1 while the site's PostgreSQL database accepts recorded points.");
    postgres->counters.points =
        counters_add(counters, "plantcast_postgres_points_total", "counter", "Recorded points that PostgreSQL has received.");
    postgres->counters.waiting =
        counters_add(counters, "plantcast_postgres_waiting_points", "gauge", "Recorded points waiting on disk for PostgreSQL.");
    postgres->counters.lost = counters_add(counters, "plantcast_postgres_lost_total", "counter",
                                           "Points never sent to PostgreSQL because the queue was full or keep_gb was reached.");
    postgres->counters.restored =
        counters_add(counters, "plantcast_postgres_restored_total", "counter", "Points restored from PostgreSQL into history.");
}

void postgres_count_lost(struct postgres *postgres, int64_t points)
{
    counter_inc(postgres->counters.lost, points);
}

void postgres_sent_elsewhere(struct postgres *postgres, int64_t age_ns)
{
    pthread_mutex_lock(&postgres->lock);
    if (!postgres->leads)
        postgres->sent_ns = clock_mono_ns() - age_ns;
    pthread_mutex_unlock(&postgres->lock);
}

int64_t postgres_sent_age_ns(struct postgres *postgres)
{
    pthread_mutex_lock(&postgres->lock);
    int64_t sent_ns = postgres->sent_ns;
    pthread_mutex_unlock(&postgres->lock);
    return sent_ns == INT64_MIN ? INT64_MAX : clock_mono_ns() - sent_ns;
}

/* Returns the UTC time of the last point in the history files or, without files, the oldest time that retention keeps. */
static int64_t end_of_files_us(struct postgres *postgres)
{
    const int64_t day_us = INT64_C(86400000000);
    int64_t first_us, last_us = clock_utc_ns() / 1000 - (int64_t)postgres->params.plant->history.keep_days * day_us;
    size_t count;
    int *months = month_list(postgres->folder, &count), error;
    for (size_t i = 0; i < count; i++) {
        struct month_file *file = month_file_read(log_of(postgres), postgres->folder, months[i], &error);
        if (file)
            month_file_span(file, &first_us, &last_us);
        month_file_close(&file);
    }
    mem_free(months);
    return last_us;
}

/* Adds a time span whose points must be read from the database. The caller holds the lock. */
static void add_span(struct postgres *postgres, const struct postgres_span *span)
{
    struct postgres_span *last = &postgres->owed.spans[SPANS - 1];
    /* the list is full, because the connection breaks often: extends the last span instead of adding another */
    if (postgres->owed.span_count == SPANS)
        *last = (struct postgres_span){ last->from_us, span->to_us, span->at_ns };
    else
        postgres->owed.spans[postgres->owed.span_count++] = *span;
}

static struct postgres_span span_of(const struct postgres *postgres, int64_t from_us, int64_t to_us)
{
    return (struct postgres_span){ from_us ? from_us : postgres->ended_us - LINE_END_SPREAD_US, to_us, clock_mono_ns() };
}

void postgres_fill(struct postgres *postgres, int64_t from_us, int64_t to_us)
{
    const struct postgres_span span = span_of(postgres, from_us, to_us);
    pthread_mutex_lock(&postgres->lock);
    add_span(postgres, &span);
    pthread_mutex_unlock(&postgres->lock);
}

void postgres_lead(struct postgres *postgres, int64_t from_us, int64_t to_us)
{
    pthread_mutex_lock(&postgres->lock);
    postgres->leads = true;
    postgres->ends_lines = !from_us;
    postgres->sent_ns = INT64_MIN;
    postgres->owed.led = span_of(postgres, from_us, to_us);
    add_span(postgres, &postgres->owed.led);
    pthread_mutex_unlock(&postgres->lock);
}

/* Queues another read of the time just before this daemon became the leader, because a standby may have sent more points of
   that time. The queue holds at most two such reads: the first is never moved back, however often a standby reconnects; the
   second runs once the points of the newest connection have arrived. */
void postgres_fill_again(struct postgres *postgres)
{
    struct postgres_span *newest = NULL;
    int waiting = 0;
    pthread_mutex_lock(&postgres->lock);
    postgres->owed.led.at_ns = clock_mono_ns();
    for (size_t i = 0; i < postgres->owed.span_count; i++)
        if (postgres->owed.spans[i].from_us == postgres->owed.led.from_us && postgres->owed.spans[i].to_us == postgres->owed.led.to_us)
            waiting++, newest = &postgres->owed.spans[i];
    if (waiting > 1)
        newest->at_ns = postgres->owed.led.at_ns;
    else if (postgres->owed.led.to_us)
        add_span(postgres, &postgres->owed.led);
    pthread_mutex_unlock(&postgres->lock);
}

struct postgres *postgres_start(const struct postgres_params *params)
{
    struct postgres *postgres = mem_new(sizeof(*postgres));
    postgres->params = *params;
    postgres->folder = mem_strdup(params->folder);
    postgres->tags = history_tags(params->plant);
    postgres->stop_fd = eventfd(0, EFD_CLOEXEC);
    pthread_mutex_init(&postgres->lock, NULL);
    postgres->alone = postgres->leads = !params->stands_by;
    postgres->sent_ns = INT64_MIN;
    if (params->owed)
        postgres->owed = *params->owed;
    postgres->ended_us = params->stands_by ? end_of_files_us(postgres) : 0;
    postgres_restore_init(&postgres->restore, params->log, params->plant, postgres->tags, postgres->folder);
    postgres->restore.begins = params->stands_by;
    add_counters(postgres, params->counters);
    int error = postgres->stop_fd < 0 ? errno : pthread_create(&postgres->thread, NULL, postgres_main, postgres);
    postgres->started = !error;
    if (error) {
        log_err(params->log, "history: cannot start the thread for PostgreSQL: %s", strerror(error));
        postgres_stop(&postgres, NULL);
    }
    return postgres;
}

void postgres_stop(struct postgres **pointer, struct postgres_owed *owed)
{
    struct postgres *postgres = *pointer;
    if (!postgres)
        return;
    if (postgres->started) {
        eventfd_write(postgres->stop_fd, 1);
        pthread_join(postgres->thread, NULL);
    }
    if (owed)
        *owed = postgres->owed;
    postgres_tables_finish(&postgres->tables);
    postgres_link_close(&postgres->link);
    if (postgres->stop_fd >= 0)
        close(postgres->stop_fd);
    pthread_mutex_destroy(&postgres->lock);
    mem_free(postgres->months);
    mem_free(postgres->tags);
    mem_free(postgres->folder);
    mem_free(postgres);
    *pointer = NULL;
}
