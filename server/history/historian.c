/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The historian's thread: takes the samples from the store, selects the points to record, and writes them once a second. */
#include "history/historian.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/files/database.h"
#include "base/mem.h"
#include "base/text/timestamp.h"
#include "base/thread.h"
#include "history/copy.h"
#include "history/history.h"
#include "history/retention.h"
#include "history/month.h"
#include "history/postgres/postgres.h"
#include "history/recorder.h"
#include "history/spool.h"
#include "plant/plant_diff.h"
#include "value/quality.h"

enum {
    QUEUE_MAX = 4000000,   /* maximum number of samples in struct historian_queue, which is emptied once a second */
    WAITING_MAX = 4000000, /* maximum number of recorded rows kept in memory while the disk cannot be written */
    /* number of uncompressed recorded points above which month_file_tidy(), which compresses them, runs early: readers load all
       uncompressed points into memory */
    TIDY_ROWS = 1000000,
    /* marker in the queue, in place of a tag's index: from here on, samples come from this daemon's own store (it became the leader) */
    TAG_LEADS = -1,
    /* marker in the queue, in place of a tag's index: from here on, samples come over a new connection to the leading daemon */
    TAG_FOLLOWS = -2,
    RETRY_MAX_S = 30,
};
static const int64_t TICK_NS = NS_PER_S, TIDY_NS = 1200 * NS_PER_S, KEEP_NS = 60 * NS_PER_S, STEP_NS = 2 * NS_PER_S,
                     LOOK_NS = 20 * NS_PER_MS;
/* Age in microseconds. When the daemon ends, it records again each reading that is not Bad and whose newest sample is at least this old.
   Otherwise the tag's recorded line would end at that sample. */
static const int64_t REPEAT_US = 10 * US_PER_S;

struct loss { /* samples that could not be recorded because too many waited */
    size_t count;
    int64_t from_us, to_us; /* UTC times between which the lost samples arrived; their own times may be far older */
};

struct historian_queue {
    struct sample_event *at; /* samples in order of arrival */
    size_t count, capacity;
    struct loss loss;
};
struct now {
    int64_t mono_ns, utc_ns;
};

struct historian {
    struct log *log;
    const struct plant *plant;
    struct store *store;
    char *folder;
    struct {
        counter *samples, *points, *lost, *waiting, *good, *bytes, *free, *backup;
    } counters;
    struct postgres *postgres; /* thread that sends history to PostgreSQL; NULL: no database is configured */
    atomic_int error;          /* why readings cannot be recorded at the moment, as -errno; 0: they are recorded */
    /* --- below: used by the historian's thread only */
    struct history_tag *tags;
    struct recorder *recorder;
    struct snapshot *snapshot;
    struct recorder_rows waiting, held;
    size_t max_waiting; /* maximum number of rows in `waiting` */
    struct loss loss;   /* samples lost since samples were last recorded; count 0: none */
    /* rows that the previous run could not write to history, read from its spool file; written before any others */
    struct spool_rows spooled;
    char *spool_path; /* path of the previous run's spool file; NULL: there is none */
    struct month_file *file;
    int month;       /* UTC month of the last tick; 0: no tick yet */
    int ended_month; /* past month in which all lines ended, so its file's held rows must be deleted; 0: none */
    struct historian_queue taken;
    bool recovered, failing, stands_by, fills;
    int64_t fill_us;     /* if `fills` is true: UTC time from which on this machine lacks points, which must be read from PostgreSQL */
    int64_t mirrored_us; /* UTC time in microseconds of the newest sample received from the leading daemon; 0: none */
    int64_t retry_ns, retry_after_ns, tidied_ns, kept_ns, utc_ahead_ns;
    struct retention_clock retention_clock;
    bool keeps_old; /* true: months older than keep_days are kept after a jump of the clock */
    struct thread thread;
    /* --- below: under thread.lock */
    struct historian_queue queue;
    /* the plant after a reload: its historian continues the recorded lines (each joins the recorded points of a tag); NULL: the
       daemon ends instead, so the lines end */
    const struct plant *next;
    /* receives the time spans whose points the next historian must still read from PostgreSQL; NULL: not needed */
    struct postgres_owed *owed;
};

/* --- taking samples from the store -------------------------------------------------------------------------------------------- */

static void add_loss(struct loss *loss, const struct loss *more)
{
    if (!loss->count || more->from_us < loss->from_us)
        loss->from_us = more->from_us;
    if (!loss->count || more->to_us > loss->to_us)
        loss->to_us = more->to_us;
    loss->count += more->count;
}

static void queue_samples(struct historian *historian, const struct sample_event *samples, size_t count)
{
    pthread_mutex_lock(&historian->thread.lock);
    struct historian_queue *queue = &historian->queue;
    /* markers always fit: without TAG_LEADS, for example, this daemon would go on as a standby */
    if (queue->count + count <= QUEUE_MAX || samples->tag < 0) {
        mem_grow(&queue->at, &queue->capacity, queue->count + count, sizeof(*queue->at));
        memcpy(queue->at + queue->count, samples, count * sizeof(*samples));
        queue->count += count;
    } else {
        int64_t now_us = clock_utc_ns() / 1000;
        add_loss(&queue->loss, &(struct loss){ count, now_us, now_us });
    }
    pthread_mutex_unlock(&historian->thread.lock);
}

static void on_sample(void *arg, const struct sample_event *event)
{
    queue_samples(arg, event, 1);
}

void historian_mirror(struct historian *historian, const struct sample_event *samples, size_t count)
{
    if (count)
        queue_samples(historian, samples, count);
}

void historian_follow(struct historian *historian)
{
    queue_samples(historian, &(struct sample_event){ .tag = TAG_FOLLOWS }, 1);
}

void historian_sent_elsewhere(struct historian *historian, int64_t age_ns)
{
    if (historian->postgres)
        postgres_sent_elsewhere(historian->postgres, age_ns);
}

void historian_on_standby(struct historian *historian)
{
    if (historian->postgres)
        postgres_fill_again(historian->postgres);
}

int64_t historian_sent_age_ns(struct historian *historian)
{
    return historian->postgres ? postgres_sent_age_ns(historian->postgres) : INT64_MAX;
}

void historian_lead(struct historian *historian)
{
    queue_samples(historian, &(struct sample_event){ .tag = TAG_LEADS, .utc_ns = clock_utc_ns() }, 1);
    store_listen(historian->store, on_sample, historian);
}

static void lose(struct historian *historian, const struct loss *loss)
{
    if (!historian->loss.count)
        log_event(historian->log, LOG_ERROR, EVENT_HISTORY_LOST,
                  "history: samples are lost from now on, because too many wait to be recorded (at most %zu points)",
                  historian->max_waiting);
    add_loss(&historian->loss, loss);
    counter_inc(historian->counters.lost, (int64_t)loss->count);
}

static void put(struct historian *historian, int tag, const struct history_point *point)
{
    size_t before = historian->waiting.count;
    if (before >= historian->max_waiting) {
        int64_t now_us = clock_utc_ns() / 1000;
        /* the sample arrived since the last tick */
        lose(historian, &(struct loss){ 1, now_us - TICK_NS / 1000, now_us });
        return;
    }
    recorder_put(historian->recorder, tag, point, &historian->waiting);
    counter_inc(historian->counters.points, (int64_t)(historian->waiting.count - before));
}

/* Records a tag's present reading as a point at a time that is not in the future, although no sample arrived then. Also passes
   it to store_tell_aged(), so that a standby records the same point. */
static void put_reading(struct historian *historian, int tag, int64_t mono_ns, int64_t utc_ns)
{
    const struct reading *reading = &historian->snapshot->readings[tag];
    const struct sample_event event = { tag, quality_is_bad(reading->quality) ? NAN : reading->value, reading->quality, mono_ns, utc_ns };
    if (!store_tell_aged(historian->store, &event))
        return;
    put(historian, tag, &(struct history_point){ utc_ns / 1000, event.value, event.quality });
    recorder_set_quality(historian->recorder, tag, utc_ns / 1000, event.quality);
}

/* Records changes of quality that came without a sample: a reading became stale, or a value with a source time before the loss
   of the connection, or before this daemon's start, is Good again. */
static void take_qualities(struct historian *historian, int64_t mono_ns, int64_t utc_ns)
{
    store_snapshot(historian->store, mono_ns, utc_ns, historian->snapshot);
    for (size_t i = 0; i < historian->snapshot->count; i++) {
        if (historian->snapshot->readings[i].quality == recorder_quality(historian->recorder, (int)i))
            continue;
        int64_t aged_ns = store_aged_ns(historian->store, (int)i, mono_ns);
        put_reading(historian, (int)i, aged_ns, utc_ns - (mono_ns - aged_ns));
    }
}

/* Records the readings that are not Bad and whose newest sample is older than before_us, at the beginning of a month and at the end
   of the run. So each month's file has the values at its beginning, and values hold until the daemon ends. Call it after
   take_qualities(). */
static void repeat_readings(struct historian *historian, int64_t before_us, int64_t mono_ns, int64_t utc_ns)
{
    struct history_point newest;
    for (size_t i = 0; i < historian->snapshot->count; i++)
        if (!quality_is_bad(historian->snapshot->readings[i].quality) && recorder_newest(historian->recorder, (int)i, &newest) &&
            newest.t_us < before_us)
            put_reading(historian, (int)i, mono_ns, utc_ns);
}

/* Adds a point without a value just after last_us to every tag's series. The line that joins the tag's recorded points thus
   ends there, and later values are unknown. */
static void leave_out(struct historian *historian, int64_t last_us)
{
    for (size_t i = 0; i < historian->plant->tag_count; i++)
        if (!quality_is_bad(recorder_quality(historian->recorder, (int)i)))
            put(historian, (int)i, &(struct history_point){ last_us + 1, NAN, QUALITY_BAD_NO_COMMUNICATION });
}

/* Handles a new connection to the leading daemon. This machine lacks the samples that the leader recorded since the last mirrored one,
   so they must be read from PostgreSQL. */
static void begin_to_follow(struct historian *historian)
{
    if (historian->mirrored_us)
        leave_out(historian, historian->mirrored_us);
    historian->fills = true;
    historian->fill_us = historian->mirrored_us;
}

static void take_mirrored(struct historian *historian, int64_t t_us)
{
    if (historian->fills && historian->postgres)
        postgres_fill(historian->postgres, historian->fill_us, t_us);
    historian->fills = false;
    if (t_us > historian->mirrored_us)
        historian->mirrored_us = t_us;
}

/* Stops mirroring the leading daemon, because this daemon becomes the leader at t_us. The former leader may have recorded more
   after the connection was lost, and sent it to PostgreSQL: those points must be read from there. */
static void begin_to_lead(struct historian *historian, int64_t t_us)
{
    if (historian->mirrored_us)
        leave_out(historian, historian->mirrored_us);
    historian->stands_by = historian->fills = false;
    if (historian->postgres)
        postgres_lead(historian->postgres, historian->mirrored_us, t_us);
}

/* Returns true if a sample got its UTC time after the wall clock was set, false if before. ahead_ns: UTC minus monotonic time
   now; step_ns: by how much the clock was set forward. */
static bool is_after_step(const struct sample_event *event, int64_t ahead_ns, int64_t step_ns)
{
    int64_t off_ns = event->utc_ns - event->mono_ns - ahead_ns;
    return llabs(off_ns) < llabs(off_ns + step_ns);
}

/* Passes the queued samples to the recorder. step_ns: by how many nanoseconds the wall clock was set since the last call; 0: it
   was not set. */
static void take_events(struct historian *historian, const struct now *now, int64_t step_ns)
{
    pthread_mutex_lock(&historian->thread.lock);
    struct historian_queue taken = historian->queue;
    historian->queue = historian->taken;
    pthread_mutex_unlock(&historian->thread.lock);
    int64_t ahead_ns = now->utc_ns - now->mono_ns;
    bool left_out = step_ns <= 0;
    for (size_t i = 0; i < taken.count; i++) {
        const struct sample_event *event = &taken.at[i];
        if (event->tag == TAG_LEADS) {
            begin_to_lead(historian, event->utc_ns / 1000);
            continue;
        }
        if (event->tag == TAG_FOLLOWS) {
            begin_to_follow(historian);
            continue;
        }
        if (historian->stands_by)
            take_mirrored(historian, event->utc_ns / 1000);
        if (!left_out && is_after_step(event, ahead_ns, step_ns)) {
            leave_out(historian, (event->utc_ns - step_ns) / 1000);
            left_out = true;
        }
        put(historian, event->tag, &(struct history_point){ event->utc_ns / 1000, event->value, event->quality });
    }
    if (!left_out)
        leave_out(historian, (now->utc_ns - step_ns) / 1000);
    counter_inc(historian->counters.samples, (int64_t)taken.count);
    if (taken.loss.count)
        lose(historian, &taken.loss);
    taken.count = 0;
    taken.loss = (struct loss){ 0 };
    historian->taken = taken;
}

/* --- writing to disk ---------------------------------------------------------------------------------------------------------- */

static void make_folder(struct historian *historian)
{
    if (mkdir(historian->folder, 0777) != 0 && errno != EEXIST)
        log_lasting_err(historian->log, "%s: cannot be created: %s", historian->folder, strerror(errno));
}

static struct month_file *open_month(struct historian *historian, int month, int *error)
{
    struct month_file *file =
        month_file_open(historian->log, historian->folder, month, historian->tags, historian->plant->tag_count, error);
    if (file && historian->postgres && (*error = month_file_use_outbox(file)))
        month_file_close(&file);
    return file;
}

/* Notes a gap in recording in the month file's table of events, if `file` is not NULL. Returns the text for the caller's log line;
   free it with mem_free(). */
static char *note_gap(struct month_file *file, int64_t from_us, int64_t to_us)
{
    char *text = mem_printf(HISTORY_GAP_TEXT, (double)(to_us - from_us) / 1e6);
    if (file)
        month_file_note(file, from_us, "gap", text);
    return text;
}

/* Called after a start. If the previous daemon was killed: records each tag's newest sample, ends the line through the tag's
   recorded points there, and notes the gap in recording in the month file's table of events. */
static int recover(struct historian *historian)
{
    size_t count;
    int error = 0, *months = month_list(historian->folder, &count);
    for (size_t i = count > 2 ? count - 2 : 0; i < count && !error; i++) {
        struct month_file *file = open_month(historian, months[i], &error);
        int64_t ended_us = INT64_MIN;
        if (!file)
            break;
        error = month_file_recover(file, QUALITY_BAD_NO_COMMUNICATION, !historian->stands_by, &ended_us);
        if (!error)
            error = month_file_tidy(file);
        if (!error && ended_us != INT64_MIN) {
            char *text = note_gap(file, ended_us, clock_utc_ns() / 1000);
            log_info(historian->log, "history: %s", text);
            mem_free(text);
        }
        if (error == -EBADMSG) {
            month_file_set_aside(&file);
            error = 0;
        }
        month_file_close(&file);
    }
    mem_free(months);
    historian->recovered = !error;
    return error;
}

/* Closes the month's file, because rows of month `next` follow. Keeps the file's held rows (newest samples, not recorded yet),
   because the lines of their tags may continue in this month: a row of `next` may only be a value that its source dates in
   another month. Deletes the held rows after a change of month, because recorder_end() has recorded their samples. The spool
   file of the previous run has rows of a later month only after such a change. */
static int leave_month(struct historian *historian, int next)
{
    int month = month_file_month(historian->file), error = month_file_tidy(historian->file);
    bool ended = month == historian->ended_month;
    if (!error && month < next && (ended || historian->spool_path)) {
        error = month_file_clear_held(historian->file);
        historian->ended_month = ended && !error ? 0 : historian->ended_month;
    }
    if (!error)
        month_file_close(&historian->file);
    return error;
}

static int enter_month(struct historian *historian, int month)
{
    int error = 0;
    if (historian->file && month_file_month(historian->file) == month)
        return 0;
    if (historian->file)
        error = leave_month(historian, month);
    if (!error)
        historian->file = open_month(historian, month, &error);
    return error;
}

/* Returns the index after the last of the rows, from row `begin` on, that belong to the same month as row `begin`. */
static size_t same_month(const struct recorder_rows *rows, size_t begin)
{
    int month = month_of(rows->at[begin].point.t_us);
    int64_t from_us = month_begin_us(month), to_us = month_begin_us(month + 1);
    size_t end = begin + 1;
    while (end < rows->count && rows->at[end].point.t_us >= from_us && rows->at[end].point.t_us < to_us)
        end++;
    return end;
}

/* Sorts rows by month, so that each month's file is opened only once. Rows of the same month keep their order. */
static void sort_by_month(struct recorder_rows *rows)
{
    if (!rows->count || same_month(rows, 0) == rows->count)
        return;
    struct history_row *sorted = mem_array(rows->count, sizeof(*sorted));
    size_t done = 0;
    for (int64_t from_us = INT64_MIN, to_us; done < rows->count; from_us = to_us) {
        int64_t first_us = INT64_MAX;
        for (size_t i = 0; i < rows->count; i++)
            if (rows->at[i].point.t_us >= from_us && rows->at[i].point.t_us < first_us)
                first_us = rows->at[i].point.t_us;
        to_us = month_begin_us(month_of(first_us) + 1);
        for (size_t i = 0; i < rows->count; i++)
            if (rows->at[i].point.t_us >= from_us && rows->at[i].point.t_us < to_us)
                sorted[done++] = rows->at[i];
    }
    memcpy(rows->at, sorted, rows->count * sizeof(*sorted));
    mem_free(sorted);
}

/* Writes rows to the files of their months, and removes the written rows from `rows`. held: the rows are newest samples that
   the filter has not recorded yet. */
static int write_rows(struct historian *historian, struct recorder_rows *rows, bool held)
{
    size_t done = 0;
    int error = 0;
    sort_by_month(rows);
    while (done < rows->count && !error) {
        size_t end = same_month(rows, done);
        const struct history_row *at = rows->at + done;
        if ((error = enter_month(historian, month_of(at->point.t_us))))
            break;
        size_t count = end - done;
        error = held ? month_file_write(historian->file, NULL, 0, at, count) : month_file_write(historian->file, at, count, NULL, 0);
        if (!error)
            done = end;
    }
    memmove(rows->at, rows->at + done, (rows->count - done) * sizeof(*rows->at));
    rows->count -= done;
    return error;
}

/* Replaces held rows of past months with points. So only the files of the present month and of later ones have held rows, and a
   past month's file needs no further end of a line after a crash. */
static void record_old_held(struct historian *historian)
{
    struct recorder_rows *held = &historian->held;
    const int64_t from_us = month_begin_us(historian->month);
    size_t left = 0;
    for (size_t i = 0; i < held->count; i++)
        if (held->at[i].point.t_us >= from_us)
            held->at[left++] = held->at[i];
        else
            recorder_end_tag(historian->recorder, held->at[i].tag, &historian->waiting);
    held->count = left;
}

/* Writes the rows that were recorded in the last second. They usually belong to one month and are then written in one
   transaction. */
static int write_second(struct historian *historian)
{
    struct recorder_rows *rows = &historian->waiting, *held = &historian->held;
    recorder_held(historian->recorder, held);
    record_old_held(historian);
    if (!rows->count && !held->count)
        return 0;
    const struct history_row *first = rows->count ? rows->at : held->at;
    if ((!rows->count || same_month(rows, 0) == rows->count) && (!held->count || same_month(held, 0) == held->count) &&
        (!held->count || month_of(held->at->point.t_us) == month_of(first->point.t_us))) {
        int error = enter_month(historian, month_of(first->point.t_us));
        if (!error)
            error = month_file_write(historian->file, rows->at, rows->count, held->at, held->count);
        if (!error)
            rows->count = held->count = 0;
        return error;
    }
    int error = write_rows(historian, rows, false);
    return error ? error : write_rows(historian, held, true);
}

/* Deletes the held rows of the month in which all lines ended. leave_month() has done that, unless the file of a later month was
   already open: a standby, or a source, may have a clock ahead of this machine's. */
static int clear_ended_month(struct historian *historian)
{
    int month = historian->ended_month, error = 0;
    char name[MONTH_NAME_BYTES];
    if (!month || !historian->file || month_file_month(historian->file) == month)
        return 0;
    month_name(month, name);
    char *path = mem_printf("%s/%s", historian->folder, name);
    if (access(path, F_OK) == 0 && !(error = enter_month(historian, month)))
        error = month_file_clear_held(historian->file);
    mem_free(path);
    historian->ended_month = error ? month : 0;
    return error;
}

static void measure_free(struct historian *historian)
{
    struct statvfs disk;
    if (statvfs(historian->folder, &disk) == 0)
        counter_set(historian->counters.free, (int64_t)(disk.f_bavail * disk.f_frsize));
}

/* Updates the metric with the time of the last `plantcast backup`. Also reserves disk space again for the spool (the file for
   rows that cannot be written to the history), if the spool has used it. */
static void look_around(struct historian *historian)
{
    struct stat backup;
    spool_reserve(historian->folder);
    char *path = mem_printf("%s/" HISTORY_BACKUP_STAMP, historian->folder);
    if (stat(path, &backup) == 0)
        counter_set(historian->counters.backup, (int64_t)backup.st_mtime);
    mem_free(path);
}

static int tidy_sometimes(struct historian *historian, int64_t mono_ns)
{
    if (!historian->file || (mono_ns - historian->tidied_ns < TIDY_NS && month_file_waiting(historian->file) < TIDY_ROWS))
        return 0;
    historian->tidied_ns = mono_ns;
    return month_file_tidy(historian->file);
}

static void warn_of_jump(struct historian *historian)
{
    static const char kept[] = "history: nothing older than keep_days is deleted for a week, because";
    const struct retention_clock *clock = &historian->retention_clock;
    char from[TIMESTAMP_BYTES], to[TIMESTAMP_BYTES];
    if (!clock->pause_to_us) {
        log_warn(historian->log, "%s the clock of this machine was set forward by more than a week; check the clock", kept);
        return;
    }
    timestamp_print(clock->pause_from_us, from);
    timestamp_print(clock->pause_to_us, to);
    log_warn(historian->log, "%s the history has no readings from %s to %s; if the clock is wrong, correct it within the week", kept, from,
             to);
}

/* Returns true if no month must be deleted for its age, because the clock may have been set far forward. Logs the first such result. */
static bool keeps_old(struct historian *historian, int64_t mono_ns, int64_t utc_ns)
{
    bool kept_old = historian->keeps_old;
    historian->keeps_old = !retention_by_age(&historian->retention_clock, historian->log, historian->folder, mono_ns, utc_ns);
    if (historian->keeps_old && !kept_old && historian->plant->history.keep_days > 0)
        warn_of_jump(historian);
    return historian->keeps_old;
}

static void apply_retention(struct historian *historian, int64_t mono_ns, int64_t utc_ns)
{
    const struct plant_history *history = &historian->plant->history;
    struct retention_limits limits = { history->keep_days, history->keep_gb * 1e9, historian->postgres != NULL };
    int64_t unsent;
    if (historian->kept_ns && mono_ns - historian->kept_ns < KEEP_NS)
        return;
    if (!historian->kept_ns)
        retention_check(historian->log, historian->folder, &limits);
    historian->kept_ns = mono_ns;
    if (keeps_old(historian, mono_ns, utc_ns))
        limits.days = 0;
    counter_set(historian->counters.bytes, retention_apply(historian->log, historian->folder, &limits, utc_ns / 1000, &unsent));
    if (historian->postgres)
        postgres_count_lost(historian->postgres, unsent);
    look_around(historian);
}

/* Closes the month's file after the rows of the spool file were written to it. The file's held rows (newest samples that are
   not recorded yet) are not deleted, so that recover() handles them as after a crash. */
static int leave_file(struct historian *historian)
{
    int error = month_file_tidy(historian->file);
    if (!error)
        month_file_close(&historian->file);
    return error;
}

/* Writes the rows of the previous run's spool file to the files of their months. This must happen before recover(), which
   determines from these files when that run ended. */
static int write_spooled(struct historian *historian)
{
    if (!historian->spool_path)
        return 0;
    make_folder(historian);
    int error = write_rows(historian, &historian->spooled.kept, false);
    if (!error)
        error = write_rows(historian, &historian->spooled.held, true);
    if (error)
        return error;
    log_event(historian->log, LOG_INFO, EVENT_HISTORY_WRITTEN,
              "history: the points in the spool file %s were recorded, and the file was deleted", historian->spool_path);
    unlink(historian->spool_path);
    mem_free(historian->spool_path);
    historian->spool_path = NULL;
    return historian->file && !historian->recovered ? leave_file(historian) : 0;
}

static int write_all(struct historian *historian, int64_t mono_ns, int64_t utc_ns)
{
    int error = write_spooled(historian);
    if (!error && !historian->file) {
        if (!historian->waiting.count)
            return 0; /* does nothing if there are no rows to write, so that no empty history folder is created */
        make_folder(historian);
    }
    if (!error && !historian->recovered)
        error = recover(historian);
    if (!error)
        error = write_second(historian);
    if (!error)
        error = clear_ended_month(historian);
    if (!error)
        error = tidy_sometimes(historian, mono_ns);
    if (!error || error == -ENOSPC) /* deletes old months also while the disk is full, because that frees space */
        apply_retention(historian, mono_ns, utc_ns);
    if (error == -EBADMSG && historian->file)
        month_file_set_aside(&historian->file);
    return error;
}

static void try_to_write(struct historian *historian, int64_t mono_ns, int64_t utc_ns, bool now)
{
    if (historian->failing && !now && mono_ns < historian->retry_ns)
        return;
    int error = write_all(historian, mono_ns, utc_ns);
    if (error) {
        historian->held.count = 0;
        recorder_hold_again(historian->recorder);
        int64_t wait_ns = historian->retry_after_ns * 2;
        historian->retry_after_ns = wait_ns < NS_PER_S ? NS_PER_S : wait_ns > RETRY_MAX_S * NS_PER_S ? RETRY_MAX_S * NS_PER_S : wait_ns;
        historian->retry_ns = mono_ns + historian->retry_after_ns;
        if (!historian->failing || error != atomic_load(&historian->error))
            log_event(historian->log, LOG_ERROR, EVENT_HISTORY_UNWRITABLE,
                      "history: the history cannot be written to disk (%s); new samples are kept in memory", database_error_text(error));
    } else if (historian->failing) {
        log_event(historian->log, LOG_INFO, EVENT_HISTORY_WRITTEN,
                  "history: writing to disk works again; the samples kept in memory are recorded");
        historian->retry_after_ns = 0;
    }
    historian->failing = error != 0;
    atomic_store(&historian->error, error);
    counter_set(historian->counters.good, !error);
}

int historian_error(struct historian *historian)
{
    return atomic_load(&historian->error);
}

/* --- start and stop ----------------------------------------------------------------------------------------------------------- */

/* Reads the monotonic and the UTC clock at nearly the same moment: repeats the readings if the thread was interrupted in between. */
static struct now look_at_clocks(void)
{
    struct now now;
    int64_t began_ns;
    int looks = 0;
    do {
        began_ns = clock_mono_ns();
        now.utc_ns = clock_utc_ns();
        now.mono_ns = clock_mono_ns();
    } while (now.mono_ns - began_ns > LOOK_NS && ++looks < 100);
    return now;
}

/* Returns by how many nanoseconds the wall clock was set (not advanced) since the last call; 0: it was not set. */
static int64_t watch_clock(struct historian *historian, const struct now *now)
{
    int64_t ahead_ns = now->utc_ns - now->mono_ns, step_ns = historian->utc_ahead_ns ? ahead_ns - historian->utc_ahead_ns : 0;
    historian->utc_ahead_ns = ahead_ns;
    return llabs(step_ns) > STEP_NS ? step_ns : 0;
}

/* Notes in the month's table of events that the wall clock was set, because the points' times alone do not show it. */
static void note_step(struct historian *historian, int64_t utc_ns, int64_t step_ns)
{
    char *text = mem_printf(step_ns > 0 ? HISTORY_FORWARD_TEXT : HISTORY_BACK_TEXT, fabs((double)step_ns) / 1e9);
    log_warn(historian->log, "history: %s", text);
    if (historian->file)
        month_file_note(historian->file, utc_ns / 1000, "clock", text);
    mem_free(text);
}

/* Before the historian of the reloaded plant takes over, ends every tag's recorded line at its newest sample. A tag that the
   reloaded plant lacks, or for which plant_kept_signals() is false, also gets a point without a value, which marks the end of its
   data. */
static void end_lines(struct historian *historian, int64_t utc_ns)
{
    if (!historian->next)
        return;
    bool *kept = mem_array(historian->next->tag_count, sizeof(*kept));
    plant_kept_signals(historian->plant, historian->next, kept);
    for (size_t i = 0; i < historian->plant->tag_count; i++) {
        int next = plant_find_tag(historian->next, historian->plant->tags[i].name);
        if (next < 0 || !kept[next])
            recorder_put(historian->recorder, (int)i, &(struct history_point){ utc_ns / 1000, NAN, QUALITY_BAD_NO_COMMUNICATION },
                         &historian->waiting);
    }
    mem_free(kept);
    recorder_end(historian->recorder, &historian->waiting);
}

/* Call once points can be recorded again after samples were lost. Ends every tag's line when the first lost sample arrived, but not
   before the tag's newest recorded sample, so that no value is known for the time of the loss. Notes the gap. The following
   take_qualities() then records all present readings that are not Bad. At the daemon's end, no readings are recorded afterwards. The
   added points may exceed max_waiting by one for each tag. */
static void end_loss(struct historian *historian)
{
    const struct loss loss = historian->loss;
    struct history_point newest;
    historian->loss.count = 0;
    for (size_t i = 0; i < historian->plant->tag_count; i++) {
        if (recorder_newest(historian->recorder, (int)i, &newest) && history_point_usable(&newest)) {
            int64_t end_us = loss.from_us > newest.t_us ? loss.from_us : newest.t_us + 1;
            recorder_put(historian->recorder, (int)i, &(struct history_point){ end_us, NAN, QUALITY_BAD_NO_COMMUNICATION },
                         &historian->waiting);
        }
        if (!quality_is_bad(recorder_quality(historian->recorder, (int)i)))
            recorder_set_quality(historian->recorder, (int)i, loss.to_us, QUALITY_BAD_NO_COMMUNICATION);
    }
    char *text = note_gap(historian->file, loss.from_us, loss.to_us);
    log_event(historian->log, LOG_WARN, EVENT_HISTORY_LOST, "history: %zu samples were lost: %s", loss.count, text);
    mem_free(text);
}

static void tick(struct historian *historian, bool last)
{
    const struct now now = look_at_clocks();
    int64_t mono_ns = now.mono_ns, utc_ns = now.utc_ns, step_ns = watch_clock(historian, &now);
    /* ignores steps of a standby's own clock, because its samples have the leading daemon's times */
    step_ns = historian->stands_by ? 0 : step_ns;
    if (historian->loss.count && historian->waiting.count < historian->max_waiting)
        end_loss(historian);
    take_events(historian, &now, step_ns);
    if (!historian->stands_by)
        take_qualities(historian, mono_ns, utc_ns);
    if (step_ns)
        note_step(historian, utc_ns, step_ns);
    int month = month_of(utc_ns / 1000);
    bool new_month = historian->month && historian->month != month;
    if (new_month) {
        /* At the end of a month, records every tag's newest sample in the old month's file. A tag's line that continues in the
           next month then starts from a point on disk, not from a sample that is only in memory and would be lost in a crash. */
        recorder_end(historian->recorder, &historian->waiting);
        historian->ended_month = historian->month;
    }
    historian->month = month;
    if (!historian->stands_by && (new_month || last))
        repeat_readings(historian, new_month ? month_begin_us(month) : utc_ns / 1000 - REPEAT_US, mono_ns, utc_ns);
    if (last && historian->loss.count)
        end_loss(historian);
    if (last)
        end_lines(historian, utc_ns);
    try_to_write(historian, mono_ns, utc_ns, last);
    counter_set(historian->counters.waiting, (int64_t)historian->waiting.count);
    measure_free(historian);
}

/* Ends the recorded lines of the previous run at that run's newest samples. Used if the rows in that run's spool file still
   cannot be written to history: they are then spooled again, together with the rows of this run. */
static void end_spooled_lines(struct spool_rows *rows)
{
    struct recorder_rows *kept = &rows->kept;
    int64_t ended_us = INT64_MIN;
    mem_grow(&kept->at, &kept->capacity, kept->count + 2 * rows->held.count + 1, sizeof(*kept->at));
    for (size_t i = 0; i < rows->held.count; i++)
        ended_us = rows->held.at[i].point.t_us > ended_us ? rows->held.at[i].point.t_us : ended_us;
    for (size_t i = 0; i < rows->held.count; i++) {
        const struct history_row *held = &rows->held.at[i];
        kept->at[kept->count++] = *held;
        kept->at[kept->count++] = (struct history_row){ held->tag, { ended_us + 1, NAN, QUALITY_BAD_NO_COMMUNICATION } };
    }
    rows->held.count = 0;
}

/* Saves the rows that cannot be written to history in a spool file, for the next start. Tries the paths of spool_places() in turn. */
static void spool(struct historian *historian)
{
    char **places = spool_places(historian->folder);
    /* puts the rows of the previous run first, if they could not be written to history */
    struct spool_rows *rows = &historian->spooled;
    end_spooled_lines(rows);
    size_t before = rows->kept.count;
    mem_grow(&rows->kept.at, &rows->kept.capacity, before + historian->waiting.count + 1, sizeof(*rows->kept.at));
    memcpy(rows->kept.at + before, historian->waiting.at, historian->waiting.count * sizeof(*rows->kept.at));
    rows->kept.count += historian->waiting.count;
    recorder_hold_again(historian->recorder);
    recorder_held(historian->recorder, &rows->held);
    int error = -ENOENT;
    char **place = places;
    while (*place && (error = spool_write(*place, historian->plant, rows)))
        place++;
    if (error)
        log_event(historian->log, LOG_ERROR, EVENT_HISTORY_LOST,
                  "history: %zu points lost: neither the database nor the spool could be written (%s)", rows->kept.count + rows->held.count,
                  strerror(-error));
    else
        log_event(historian->log, LOG_WARN, EVENT_HISTORY_UNWRITABLE,
                  "history: %zu points could not be written; they wait in the spool file %s for the next start",
                  rows->kept.count + rows->held.count, *place);
    if (!error && historian->spool_path && strcmp(historian->spool_path, *place) != 0)
        unlink(historian->spool_path); /* deletes the old spool file, because the new one contains its rows */
    spool_places_free(places);
}

static void take_spool(struct historian *historian)
{
    char **places = spool_places(historian->folder);
    for (char **place = places; *place && !historian->spool_path; place++) {
        size_t foreign = 0;
        int error = spool_read(*place, historian->plant, &historian->spooled, &foreign);
        if (error && error != -ENOENT && error != -ENOTDIR)
            log_err(historian->log, "history: the spool file %s cannot be read and is kept: %s", *place, strerror(-error));
        if (foreign)
            log_warn(historian->log,
                     "history: spool file %s: %zu points dropped: their tags are no longer in the tag list, or their units cannot be "
                     "converted to the tags' present units",
                     *place, foreign);
        if (!error)
            historian->spool_path = mem_strdup(*place);
    }
    spool_places_free(places);
}

static void *historian_main(void *arg)
{
    struct historian *historian = arg;
    int64_t next_ns = clock_mono_ns();
    do
        tick(historian, false);
    while (thread_wait_for_tick(&historian->thread, TICK_NS, &next_ns));
    tick(historian, true);
    if (historian->file)
        month_file_tidy(historian->file);
    if (historian->file && historian->next && enter_month(historian, historian->month) == 0)
        month_file_clear_held(historian->file);
    if (historian->failing || historian->waiting.count)
        spool(historian);
    return NULL;
}

static void add_counters(struct historian *historian, struct counters *counters)
{
    historian->counters.samples =
        counters_add(counters, "plantcast_history_samples_total", "counter", "Samples (readings) received for recording in the history.");
    historian->counters.points =
        counters_add(counters, "plantcast_history_points_total", "counter", "Points (recorded samples) stored in the history.");
    historian->counters.lost = counters_add(counters, "plantcast_history_lost_total", "counter",
                                            "Samples (readings) lost because the history could not store them.");
    historian->counters.waiting = counters_add(counters, "plantcast_history_waiting_points", "gauge",
                                               "Points (recorded samples) waiting to be written to the history.");
    historian->counters.good = counters_add(counters, "plantcast_history_good", "gauge", "1 while the history can be written to disk.");
    historian->counters.bytes =
        counters_add(counters, "plantcast_history_bytes", "gauge", "Disk space in bytes used by all history files.");
    historian->counters.free =
        counters_add(counters, "plantcast_history_free_bytes", "gauge", "Free disk space in bytes in the history folder.");
    historian->counters.backup = counters_add(counters, "plantcast_backup_timestamp_seconds", "gauge",
                                              "Time of the last backup, in seconds since 1970; 0: unknown.");
}

static bool start_postgres(struct historian *historian, struct counters *counters, const struct postgres_owed *owed)
{
    const struct postgres_params params = {
        .log = historian->log,
        .counters = counters,
        .plant = historian->plant,
        .folder = historian->folder,
        .stands_by = historian->stands_by,
        .owed = owed,
    };
    return !historian->plant->history.postgres.url || (historian->postgres = postgres_start(&params));
}

struct historian *historian_start(const struct historian_params *params)
{
    struct historian *historian = mem_new(sizeof(*historian));
    thread_init(&historian->thread);
    historian->log = params->log;
    historian->plant = params->plant;
    historian->store = params->store;
    historian->folder = mem_strdup(params->folder);
    historian->recovered = params->follows;
    historian->stands_by = params->stands_by;
    historian->max_waiting = params->max_waiting ? params->max_waiting : WAITING_MAX;
    historian->tags = history_tags(params->plant);
    historian->recorder = recorder_create(params->plant, clock_utc_ns() / 1000);
    historian->snapshot = snapshot_create(params->plant->tag_count);
    take_spool(historian);
    add_counters(historian, params->counters);
    if (!start_postgres(historian, params->counters, params->owed)) {
        historian_stop(&historian);
        return NULL;
    }
    if (!params->stands_by)
        store_listen(params->store, on_sample, historian);
    if (!thread_start(&historian->thread, params->log, "history", historian_main, historian))
        historian_stop(&historian);
    return historian;
}

void historian_stop(struct historian **pointer)
{
    struct historian *historian = *pointer;
    if (!historian)
        return;
    store_unlisten(historian->store, on_sample, historian);
    thread_stop(&historian->thread);
    postgres_stop(&historian->postgres, historian->owed);
    month_file_close(&historian->file);
    recorder_destroy(&historian->recorder);
    snapshot_destroy(&historian->snapshot);
    mem_free(historian->tags);
    mem_free(historian->waiting.at);
    mem_free(historian->held.at);
    mem_free(historian->spooled.kept.at);
    mem_free(historian->spooled.held.at);
    mem_free(historian->spool_path);
    mem_free(historian->queue.at);
    mem_free(historian->taken.at);
    mem_free(historian->folder);
    thread_finish(&historian->thread);
    mem_free(historian);
    *pointer = NULL;
}

void historian_end(struct historian **historian, const struct plant *next, struct postgres_owed *owed)
{
    if (!*historian)
        return;
    pthread_mutex_lock(&(*historian)->thread.lock);
    (*historian)->next = next;
    (*historian)->owed = owed;
    pthread_mutex_unlock(&(*historian)->thread.lock);
    historian_stop(historian);
}
