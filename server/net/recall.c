/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that reads history for those who ask. */
#include "net/recall.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text.h"
#include "history/history.h"
#include "history/series_text.h"
#include "base/when.h"

/* --- what is asked ------------------------------------------------------------------------------------------------------------ */

static bool take_tags(const struct plant *plant, const char *list, struct recall_order *order, struct message_error *error)
{
    char name[256];
    order->tag_count = 0;
    for (const char *at = list; *at;) {
        size_t n = strcspn(at, ",");
        if (n >= sizeof(name) || order->tag_count == RECALL_TAGS) {
            message_fail(error, "bad_field", "tags: at most %d names of at most %zu bytes", RECALL_TAGS, sizeof(name) - 1);
            return false;
        }
        memcpy(name, at, n);
        name[n] = 0;
        int tag = plant_find_tag(plant, name);
        if (tag < 0) {
            message_fail(error, "unknown_tag", "tags: there is no tag '%.60s'", name);
            return false;
        }
        order->tags[order->tag_count++] = tag;
        at += n + (at[n] == ',');
    }
    return true;
}

static bool take_when(const char *name, const char *text, int64_t now_us, int64_t *out, struct message_error *error)
{
    if (when_parse(text, now_us, out))
        return true;
    message_fail(error, "bad_field", "%s: expected " WHEN_FORMS ", found '%.60s'", name, text);
    return false;
}

static bool take_points(const char *text, struct recall_order *order, struct message_error *error)
{
    char *end;
    long points = strtol(text, &end, 10);
    if (end == text || *end || points < 2 || points > RECALL_POINTS) {
        message_fail(error, "bad_field", "points: expected a number from 2 to %d, found '%.60s'", RECALL_POINTS, text);
        return false;
    }
    order->max_points = (int)points;
    return true;
}

static bool take_format(const char *text, struct recall_order *order, struct message_error *error)
{
    order->csv = !strcmp(text, "csv");
    if (order->csv || !strcmp(text, "json"))
        return true;
    message_fail(error, "bad_field", "format: expected json or csv, found '%.60s'", text);
    return false;
}

static bool take(const struct plant *plant, const char *arg, int64_t now_us, struct recall_order *order, struct message_error *error)
{
    size_t n = strcspn(arg, "=");
    const char *value = arg[n] ? arg + n + 1 : "";
    if (n == 4 && !memcmp(arg, "tags", n))
        return take_tags(plant, value, order, error);
    if (n == 4 && !memcmp(arg, "from", n))
        return take_when("from", value, now_us, &order->from_us, error);
    if (n == 2 && !memcmp(arg, "to", n))
        return take_when("to", value, now_us, &order->to_us, error);
    if (n == 6 && !memcmp(arg, "points", n))
        return take_points(value, order, error);
    if (n == 6 && !memcmp(arg, "format", n))
        return take_format(value, order, error);
    message_fail(error, "unknown_field", "there is no argument '%.*s'; tags, from, to, points and format are", n < 60 ? (int)n : 60, arg);
    return false;
}

bool recall_parse(const struct plant *plant, const char *const *args, size_t count, int64_t now_us, struct recall_order *order,
                  struct message_error *error)
{
    *order = (struct recall_order){ .max_points = 1000, .from_us = INT64_MIN, .to_us = now_us };
    for (size_t i = 0; i < count; i++)
        if (!take(plant, args[i], now_us, order, error))
            return false;
    if (order->from_us == INT64_MIN)
        order->from_us = order->to_us - INT64_C(3600000000);
    if (order->tag_count == 0)
        message_fail(error, "bad_field", "tags: expected the names of tags, with commas between them");
    else if (order->from_us >= order->to_us)
        message_fail(error, "bad_field", "from: expected an earlier instant than to");
    else
        return true;
    return false;
}

bool recall_parse_gaps(const char *const *args, size_t count, int64_t now_us, struct recall_order *order, struct message_error *error)
{
    *order = (struct recall_order){ .gaps = true, .from_us = INT64_MIN, .to_us = now_us };
    for (size_t i = 0; i < count; i++) {
        bool from = !strncmp(args[i], "from=", 5);
        if (!from && strncmp(args[i], "to=", 3) != 0) {
            message_fail(error, "unknown_field", "there is no argument '%.60s'; from and to are", args[i]);
            return false;
        }
        if (!take_when(from ? "from" : "to", strchr(args[i], '=') + 1, now_us, from ? &order->from_us : &order->to_us, error))
            return false;
    }
    if (order->from_us == INT64_MIN)
        order->from_us = order->to_us - INT64_C(3600000000);
    if (order->from_us < order->to_us)
        return true;
    message_fail(error, "bad_field", "from: expected an earlier instant than to");
    return false;
}

/* --- the thread --------------------------------------------------------------------------------------------------------------- */

struct recall {
    struct log *log;
    const struct plant *plant;
    char *folder;
    struct history_reader *reader; /* of the thread */
    void (*notify)(void *arg);
    void *notify_arg;
    pthread_t thread;
    bool started;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: under lock */
    struct recall_order waiting[RECALL_WAITING]; /* oldest first */
    int waiting_count;
    struct recall_answer *answers, **last;
    bool stopping;
};

static bool read_series(struct recall *recall, const struct recall_order *order, struct history_series *series)
{
    int error = 0;
    for (int i = 0; i < order->tag_count && !error; i++)
        error = history_series(recall->reader, recall->plant->tags[order->tags[i]].name, order->from_us, order->to_us, order->max_points,
                               &series[i]);
    return !error;
}

static void print_csv(struct recall *recall, const struct recall_order *order, const struct history_series *series, struct text *out)
{
    bool buckets = false;
    for (int i = 0; i < order->tag_count; i++) {
        if (i == 0 || (series[i].bucket_us > 0) != buckets)
            series_text_csv_head(out, buckets = series[i].bucket_us > 0);
        const struct plant_tag *tag = &recall->plant->tags[order->tags[i]];
        series_text_csv(out, tag->name, tag->unit ? tag->unit : "", &series[i]);
    }
}

static void print_json(struct recall *recall, const struct recall_order *order, const struct history_series *series, struct text *out)
{
    text_add(out, "{\"from_us\":%lld,\"to_us\":%lld,\"series\":[", (long long)order->from_us, (long long)order->to_us);
    for (int i = 0; i < order->tag_count; i++) {
        const struct plant_tag *tag = &recall->plant->tags[order->tags[i]];
        text_add(out, i ? "," : "");
        series_text_json(out, tag->name, tag->unit ? tag->unit : "", &series[i]);
    }
    text_add(out, "]}\n");
}

static struct recall_answer *answer_journal(struct recall *recall, const struct recall_order *order)
{
    struct recall_answer *out = mem_new(sizeof(*out));
    struct text text = { 0 };
    out->client = order->client;
    out->csv = order->alarms.csv;
    alarms_journal_text(recall->log, recall->folder, &order->alarms, &text);
    out->text = text.at;
    out->length = text.length;
    return out;
}

static struct recall_answer *answer_gaps(struct recall *recall, const struct recall_order *order)
{
    struct recall_answer *out = mem_new(sizeof(*out));
    struct history_gaps gaps;
    struct text text = { 0 };
    out->client = order->client;
    if (history_gaps(recall->reader, order->from_us, order->to_us, &gaps))
        return out;
    text_add(&text, "{\"from_us\":%lld,\"to_us\":%lld,\"gaps\":[", (long long)order->from_us, (long long)order->to_us);
    for (size_t i = 0; i < gaps.count; i++)
        text_add(&text, "%s[%lld,%lld]", i ? "," : "", (long long)gaps.at[i].from_us, (long long)gaps.at[i].to_us);
    text_add(&text, "]}\n");
    mem_free(gaps.at);
    out->text = text.at;
    out->length = text.length;
    return out;
}

static struct recall_answer *answer(struct recall *recall, const struct recall_order *order)
{
    struct recall_answer *out = mem_new(sizeof(*out));
    struct history_series *series = mem_array((size_t)order->tag_count, sizeof(*series));
    struct text text = { 0 };
    out->client = order->client;
    out->csv = order->csv;
    if (read_series(recall, order, series))
        (order->csv ? print_csv : print_json)(recall, order, series, &text);
    out->text = text.at;
    out->length = text.length;
    for (int i = 0; i < order->tag_count; i++)
        history_series_finish(&series[i]);
    mem_free(series);
    return out;
}

static void drop(struct recall *recall, int index)
{
    memmove(recall->waiting + index, recall->waiting + index + 1,
            (size_t)(recall->waiting_count - index - 1) * sizeof(recall->waiting[0]));
    recall->waiting_count--;
}

static bool next_order(struct recall *recall, struct recall_order *order)
{
    pthread_mutex_lock(&recall->lock);
    while (!recall->stopping && !recall->waiting_count)
        pthread_cond_wait(&recall->wake, &recall->lock);
    bool stopping = recall->stopping;
    if (!stopping) {
        *order = recall->waiting[0];
        drop(recall, 0);
    }
    pthread_mutex_unlock(&recall->lock);
    return !stopping;
}

static void *run(void *arg)
{
    struct recall *recall = arg;
    struct recall_order order;
    while (next_order(recall, &order)) {
        struct recall_answer *one = (order.journal ? answer_journal : order.gaps ? answer_gaps : answer)(recall, &order);
        pthread_mutex_lock(&recall->lock);
        *recall->last = one;
        recall->last = &one->next;
        pthread_mutex_unlock(&recall->lock);
        recall->notify(recall->notify_arg);
    }
    return NULL;
}

struct recall *recall_create(struct log *log, const struct plant *plant, const char *folder, void (*notify)(void *arg), void *arg)
{
    struct recall *recall = mem_new(sizeof(*recall));
    pthread_mutex_init(&recall->lock, NULL);
    pthread_cond_init(&recall->wake, NULL);
    recall->log = log;
    recall->plant = plant;
    recall->folder = mem_strdup(folder);
    recall->reader = history_reader_create(log, folder);
    history_reader_show_by(recall->reader, plant);
    recall->notify = notify;
    recall->notify_arg = arg;
    recall->last = &recall->answers;
    int error = pthread_create(&recall->thread, NULL, run, recall);
    recall->started = !error;
    if (error) {
        log_err(log, "history: no thread to read it: %s", strerror(error));
        recall_destroy(&recall);
    }
    return recall;
}

static void free_answers(struct recall_answer *answers)
{
    for (struct recall_answer *next; answers; answers = next) {
        next = answers->next;
        mem_free(answers->text);
        mem_free(answers);
    }
}

void recall_destroy(struct recall **pointer)
{
    struct recall *recall = *pointer;
    if (!recall)
        return;
    pthread_mutex_lock(&recall->lock);
    recall->stopping = true;
    pthread_cond_signal(&recall->wake);
    pthread_mutex_unlock(&recall->lock);
    if (recall->started)
        pthread_join(recall->thread, NULL);
    free_answers(recall->answers);
    history_reader_destroy(&recall->reader);
    mem_free(recall->folder);
    pthread_cond_destroy(&recall->wake);
    pthread_mutex_destroy(&recall->lock);
    mem_free(recall);
    *pointer = NULL;
}

bool recall_ask(struct recall *recall, const struct recall_order *order)
{
    pthread_mutex_lock(&recall->lock);
    bool room = recall->waiting_count < RECALL_WAITING;
    if (room) {
        recall->waiting[recall->waiting_count++] = *order;
        pthread_cond_signal(&recall->wake);
    }
    pthread_mutex_unlock(&recall->lock);
    return room;
}

void recall_forget(struct recall *recall, uint64_t client)
{
    pthread_mutex_lock(&recall->lock);
    for (int i = recall->waiting_count - 1; i >= 0; i--)
        if (recall->waiting[i].client == client)
            drop(recall, i);
    pthread_mutex_unlock(&recall->lock);
}

struct recall_answer *recall_collect(struct recall *recall)
{
    pthread_mutex_lock(&recall->lock);
    struct recall_answer *answers = recall->answers;
    recall->answers = NULL;
    recall->last = &recall->answers;
    pthread_mutex_unlock(&recall->lock);
    return answers;
}
