/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that sends alarms to recipients outside of Plantcast. */
#include "notify/notifier.h"

#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "notify/delivery.h"
#include "notify/notify_text.h"
#include "notify/outbox.h"

enum { TICK_MS = 1000, REST_MS = 60000, FILE_BYTES = 64 << 20 };

struct recipient_counters {
    counter *sent, *failed, *waiting, *mailboxes;
};

struct notifier {
    struct notifier_params params;
    char *path;
    pthread_t thread;
    bool started;
    _Atomic bool stopping;
    _Atomic uint64_t kept_number;
    pthread_mutex_t kept_lock;
    char *kept; /* content of notify.json (pending messages), protected by kept_lock; NULL: none yet */
    struct delivery *delivery;
    /* --- below: members that only the notifier's thread uses */
    struct outbox *outbox;
    struct recipient_counters *counters; /* by recipient: its counters */
    counter *lost, *spool_good;
    bool *failing;   /* by recipient: true: the last attempt to send a message to this recipient failed */
    uint64_t number; /* number of the last alarm change that the notifier has processed */
    bool looked, unsaved;
    /* value of outbox_counts.lost that the metrics already include; not 0 at the start if a reload restored the outbox */
    int64_t lost_before;
};

static int64_t now_us(void)
{
    return clock_utc_ns() / 1000;
}

/* --- the file --------------------------------------------------------------------------------------------------------------- */

static int put_file(const char *path, const char *text, bool durable)
{
    struct atomic_file file;
    int error = atomic_file_begin(&file, path, 0600);
    if (!error && (error = atomic_file_write(&file, text, strlen(text))))
        atomic_file_abandon(&file);
    else if (!error)
        error = atomic_file_commit(&file, durable);
    return error;
}

/* Makes `text`, the content of notify.json, available for a standby core; takes ownership of `text`. */
static void publish(struct notifier *notifier, char *text)
{
    pthread_mutex_lock(&notifier->kept_lock);
    mem_free(notifier->kept);
    notifier->kept = text;
    pthread_mutex_unlock(&notifier->kept_lock);
    atomic_fetch_add(&notifier->kept_number, 1);
    if (notifier->params.kept)
        notifier->params.kept(notifier->params.kept_arg);
}

uint64_t notifier_number(struct notifier *notifier)
{
    return atomic_load(&notifier->kept_number);
}

char *notifier_kept(struct notifier *notifier)
{
    pthread_mutex_lock(&notifier->kept_lock);
    char *text = mem_strdup(notifier->kept ? notifier->kept : "{}");
    pthread_mutex_unlock(&notifier->kept_lock);
    return text;
}

int notifier_put_kept(const char *folder, const char *text)
{
    char *path = mem_printf("%s/" NOTIFIER_FILE, folder);
    int error = put_file(path, text, false);
    mem_free(path);
    return error;
}

static void save(struct notifier *notifier)
{
    notifier->unsaved |= outbox_is_changed(notifier->outbox);
    if (!notifier->unsaved)
        return;
    char *text = json_text(outbox_save(notifier->outbox), 0);
    publish(notifier, mem_strdup(text)); /* passes the text to a standby core first, because writing notify.json may take long */
    int error = put_file(notifier->path, text, true);
    mem_free(text);
    if (error)
        log_err(notifier->params.log, "notify: %s cannot be written (%s): after a restart, alarms may be sent twice or not at all",
                notifier->path, strerror(-error));
    counter_set(notifier->spool_good, !error);
    notifier->unsaved = error != 0;
}

static void restore(struct notifier *notifier)
{
    size_t bytes;
    char *text = text_read_file(notifier->path, FILE_BYTES, &bytes);
    json_t *saved = text ? json_loadb(text, bytes, 0, NULL) : NULL;
    if ((!text && errno != ENOENT) || (text && !(saved && outbox_restore(notifier->outbox, saved))))
        log_warn(notifier->params.log, "notify: %s cannot be read and is replaced; active alarms are sent again", notifier->path);
    json_decref(saved);
    mem_free(text);
}

/* --- sending ---------------------------------------------------------------------------------------------------------------- */

static const struct notify_recipient *recipient_of(const struct notifier *notifier, int recipient)
{
    return &notifier->params.plant->notify->recipients[recipient];
}

static void on_end(void *arg, int recipient, const char *why, bool is_refused, int refused_mailboxes)
{
    struct notifier *notifier = arg;
    struct log *log = notifier->params.log;
    const char *id = recipient_of(notifier, recipient)->id;
    if (why) {
        counter_inc(notifier->counters[recipient].failed, 1);
        switch (outbox_failed(notifier->outbox, recipient, is_refused, now_us())) {
        case OUTBOX_RETRIED:
            if (!notifier->failing[recipient])
                log_err(log, "notify: %s cannot be reached: %s; messages are queued and sent later", id, why);
            notifier->failing[recipient] = true;
            break;
        case OUTBOX_SHORTENED:
            log_err(log, "notify: %s refuses a message: %s; sending only the %d most urgent alarms of the message", id, why, OUTBOX_SHORT);
            break;
        case OUTBOX_DROPPED: log_err(log, "notify: %s refuses a message: %s; the message is dropped", id, why); break;
        }
    } else {
        outbox_sent(notifier->outbox, recipient, now_us());
        /* saves the outbox at once: if the daemon were killed first, it would send the message again after its restart */
        save(notifier);
        counter_inc(notifier->counters[recipient].sent, 1);
        counter_inc(notifier->counters[recipient].mailboxes, refused_mailboxes);
        if (notifier->failing[recipient])
            log_info(log, "notify: %s accepts messages again", id);
        notifier->failing[recipient] = false;
    }
}

/* Sends all due messages. Saves the outbox before sending a message, so that a restarted daemon repeats the same message
   instead of making another one. */
static void send_due(struct notifier *notifier)
{
    for (int i = 0; i < (int)notifier->params.plant->notify->recipient_count; i++) {
        struct outbox_message message;
        if (!delivery_is_idle(notifier->delivery, i) || !outbox_next(notifier->outbox, i, now_us(), &message))
            continue;
        size_t bytes;
        char *body = notify_text(notifier->params.plant, recipient_of(notifier, i), &message, now_us(), &bytes);
        save(notifier);
        char *why = delivery_start(notifier->delivery, i, body, bytes);
        if (why)
            on_end(notifier, i, why, false, 0);
        mem_free(why);
    }
}

/* --- the thread ------------------------------------------------------------------------------------------------------------- */

static void wake(void *arg)
{
    struct notifier *notifier = arg;
    delivery_wake(notifier->delivery);
}

static void on_alarm(void *arg, const struct alarm *alarm)
{
    struct notifier *notifier = arg;
    outbox_put(notifier->outbox, alarm, !notifier->looked, now_us());
}

static void count(struct notifier *notifier)
{
    for (int i = 0; i < (int)notifier->params.plant->notify->recipient_count; i++)
        counter_set(notifier->counters[i].waiting, outbox_counts(notifier->outbox, i).waiting);
    int64_t lost = outbox_counts(notifier->outbox, 0).lost;
    if (lost > notifier->lost_before) {
        log_err(notifier->params.log, "notify: %lld alarm messages lost: not stored, refused, or not delivered within a day",
                (long long)(lost - notifier->lost_before));
        counter_inc(notifier->lost, lost - notifier->lost_before);
    }
    notifier->lost_before = lost;
}

static void *notifier_main(void *arg)
{
    struct notifier *notifier = arg;
    while (!atomic_load(&notifier->stopping)) {
        notifier->number = alarm_service_changes(notifier->params.alarm_service, notifier->number, on_alarm, notifier);
        if (!notifier->looked)
            outbox_end_unseen(notifier->outbox, now_us());
        notifier->looked = true;
        outbox_tick(notifier->outbox, now_us());
        send_due(notifier);
        save(notifier);
        count(notifier);
        delivery_wait(notifier->delivery, outbox_rests(notifier->outbox) ? REST_MS : TICK_MS, on_end, notifier);
    }
    save(notifier);
    return NULL;
}

/* --- start and stop --------------------------------------------------------------------------------------------------------- */

static counter *add_counter(const struct notifier *notifier, const char *name, const char *recipient, const char *type, const char *help)
{
    char *whole = mem_printf("%s{recipient=\"%s\"}", name, recipient);
    counter *added = counters_add(notifier->params.counters, whole, type, help);
    mem_free(whole);
    return added;
}

static void add_counters(struct notifier *notifier)
{
    const struct plant_notify *notify = notifier->params.plant->notify;
    struct counters *counters = notifier->params.counters;
    notifier->counters = mem_array(notify->recipient_count + 1, sizeof(*notifier->counters));
    notifier->failing = mem_array(notify->recipient_count + 1, sizeof(*notifier->failing));
    for (size_t i = 0; i < notify->recipient_count; i++) {
        const char *id = notify->recipients[i].id;
        notifier->counters[i].sent =
            add_counter(notifier, "plantcast_notify_sent_total", id, "counter", "Alarm messages delivered, by recipient.");
        notifier->counters[i].failed = add_counter(notifier, "plantcast_notify_failed_total", id, "counter",
                                                   "Attempts to deliver an alarm message that failed, by recipient.");
        notifier->counters[i].waiting =
            add_counter(notifier, "plantcast_notify_waiting", id, "gauge", "Alarms whose message waits for delivery, by recipient.");
        notifier->counters[i].mailboxes = add_counter(notifier, "plantcast_notify_mailboxes_refused_total", id, "counter",
                                                      "Refusals of single mailboxes by a mail server that took the mail for others.");
    }
    notifier->lost = counters_add(counters, "plantcast_notify_lost_total", "counter",
                                  "Alarm messages lost: not stored, refused, or not delivered within a day.");
    notifier->spool_good = counters_add(counters, "plantcast_notify_spool_good", "gauge",
                                        "1 while alarm messages that wait for delivery can be stored on disk.");
    counter_set(notifier->spool_good, 1);
}

struct notifier *notifier_start(const struct notifier_params *params)
{
    struct notifier *notifier = mem_new(sizeof(*notifier));
    notifier->params = *params;
    notifier->path = mem_printf("%s/" NOTIFIER_FILE, params->folder);
    notifier->outbox = outbox_create(params->plant);
    pthread_mutex_init(&notifier->kept_lock, NULL);
    add_counters(notifier);
    restore(notifier);
    publish(notifier, json_text(outbox_save(notifier->outbox), 0));
    notifier->delivery = delivery_create(params->log, params->plant->notify);
    if (notifier->delivery)
        alarm_service_listen(params->alarm_service, wake, notifier);
    int error = notifier->delivery ? pthread_create(&notifier->thread, NULL, notifier_main, notifier) : 0;
    notifier->started = notifier->delivery && !error;
    if (error)
        log_err(params->log, "notify: cannot start a thread: %s", strerror(error));
    if (!notifier->started)
        notifier_stop(&notifier);
    return notifier;
}

void notifier_halt(struct notifier *notifier)
{
    atomic_store(&notifier->stopping, true);
    alarm_service_listen(notifier->params.alarm_service, NULL, NULL);
    if (notifier->started) {
        delivery_wake(notifier->delivery);
        pthread_join(notifier->thread, NULL);
    }
    notifier->started = false;
}

void notifier_stop(struct notifier **pointer)
{
    struct notifier *notifier = *pointer;
    if (!notifier)
        return;
    notifier_halt(notifier);
    delivery_destroy(&notifier->delivery);
    for (size_t i = 0; i < notifier->params.plant->notify->recipient_count; i++)
        counter_set(notifier->counters[i].waiting, 0);
    outbox_destroy(&notifier->outbox);
    pthread_mutex_destroy(&notifier->kept_lock);
    mem_free(notifier->kept);
    mem_free(notifier->counters);
    mem_free(notifier->failing);
    mem_free(notifier->path);
    mem_free(notifier);
    *pointer = NULL;
}
