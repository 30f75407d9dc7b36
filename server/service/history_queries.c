/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The threads that read history for HTTP clients. */
#include "service/history_queries.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "corelink/core_history.h"
#include "history/history.h"
#include "history/series_text.h"
#include "service/drift_report.h"
#include "service/remote_history.h"

/* number of threads that read history. A client address uses one at a time, so that its queries do not block those of another address */
enum { THREADS = 2 };
/* size limit of a piece of an answer, in bytes; the piece ends after the tag that reaches the limit */
static const size_t PIECE_BYTES = 256 * 1024;
/* time limit for a piece of an answer; the piece ends after the tag that reaches the limit */
static const int64_t PIECE_NS = 100 * NS_PER_MS;

struct pending_query {
    struct history_query query;
    int next_tag; /* index of the next tag to read; for drift queries, of the next asset */
    /* only for answers in CSV: true: the last line written has the columns for means of time buckets; false: those for single
       values */
    bool buckets;
    bool listed;  /* true: the answer lists a drifting sensor already, so a comma comes before the next one */
    bool wanted;  /* true: the next piece of the answer may be made: the query is new, or its client has requested the piece */
    bool forgotten;
    uint64_t served; /* value of history_queries.served when the newest piece of this query's answer was begun; 0: no piece was begun */
    struct pending_query *next;
};

struct history_queries {
    struct log *log;
    const struct plant *plant;
    const struct scene *scene;
    char *folder; /* folder of the recorded history; NULL: history is read from the core */
    struct core_link *core_link;
    _Atomic bool stop;
    void (*notify)(void *arg);
    void *notify_arg;
    pthread_t threads[THREADS];
    int thread_count;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: protected by `lock` */
    struct pending_query *questions; /* queries that wait for a thread, or for their client to request the next piece, newest first */
    uint64_t at_work[THREADS];       /* account (client address) of the query on which each thread works; 0: none */
    struct pending_query *working[THREADS];
    /* number of pieces of answers begun so far, over all queries; used to find the query that was served longest ago */
    uint64_t served;
    int count;       /* number of all queries, including those that a thread works on */
    struct history_answer *answers, **last;
    bool stopping;
};

/* --- one piece of an answer ------------------------------------------------------------------------------------------- */

static void print_csv(struct pending_query *question, const struct plant_tag *tag, const struct history_series *series, struct text *out)
{
    bool buckets = series->bucket_us > 0;
    if (question->next_tag == 0 || buckets != question->buckets)
        series_text_csv_head(out, buckets);
    question->buckets = buckets;
    series_text_csv(out, tag->name, tag->unit ? tag->unit : "", series);
}

static void print_json(const struct pending_query *question, const struct plant_tag *tag, const struct history_series *series,
                       struct text *out)
{
    const struct history_query *query = &question->query;
    if (question->next_tag == 0)
        text_add(out, "{\"from_us\":%lld,\"to_us\":%lld,\"series\":[", (long long)query->from_us, (long long)query->to_us);
    else
        text_add(out, ",");
    series_text_json(out, tag->name, tag->unit ? tag->unit : "", series);
    if (question->next_tag + 1 == query->tag_count)
        text_add(out, "]}\n");
}

/* Requests the history of the query's next tag from the core, and appends it to the answer (JSON or CSV). The format is the
   same as for history of this daemon's own. Returns false if the core did not answer. */
static bool fetch_tag(const struct history_queries *queries, struct core_history *core, struct pending_query *question, struct text *out)
{
    const struct history_query *query = &question->query;
    const char *tag = queries->plant->tags[query->tags[question->next_tag]].name;
    bool first = question->next_tag == 0, last = question->next_tag + 1 == query->tag_count;
    question->next_tag++;
    return query->csv ? remote_history_csv(core, query, tag, first, &question->buckets, out)
                      : remote_history_json(core, query, tag, first, last, out);
}

/* Returns the number of steps that the query's answer takes: one per tag or, for drift queries, per asset. Each step reads history once. */
static int steps_of(const struct history_queries *queries, const struct history_query *query)
{
    return !query->drift ? query->tag_count : query->tag >= 0 ? 1 : (int)queries->scene->asset_count;
}

/* Appends the recorded series of the query's next tag to the answer. Returns false if history could not be read. */
static bool read_tag(struct history_queries *queries, struct history_reader *reader, struct pending_query *question, struct text *out)
{
    const struct history_query *query = &question->query;
    const struct plant_tag *tag = &queries->plant->tags[query->tags[question->next_tag]];
    struct history_series series;
    bool good = history_series(reader, tag->name, query->from_us, query->to_us, query->max_points, &series) == 0;
    if (good && query->csv)
        print_csv(question, tag, &series, out);
    else if (good)
        print_json(question, tag, &series, out);
    history_series_finish(&series);
    question->next_tag++;
    return good;
}

/* Appends the drifting sensors of the query's next asset to the answer. Returns false if history could not be read. */
static bool read_asset(struct history_queries *queries, struct history_reader *reader, struct pending_query *question, struct text *out)
{
    const struct history_query *query = &question->query;
    int asset = query->tag >= 0 ? queries->plant->tags[query->tag].asset : question->next_tag;
    struct drift_report report;
    if (question->next_tag == 0)
        drift_text_begin(out, queries->plant, query->group, query->to_us);
    bool good = asset < 0 || drift_report_read(&report, reader, queries->scene, asset, query->group, query->to_us);
    if (good && asset >= 0) {
        drift_text_add(out, queries->plant, &report, query->tag, &question->listed);
        drift_report_finish(&report);
    }
    if (++question->next_tag == steps_of(queries, query))
        drift_text_end(out);
    return good;
}

static bool print_gaps(struct history_reader *reader, const struct history_query *query, struct text *out)
{
    struct history_gaps gaps;
    if (history_gaps(reader, query->from_us, query->to_us, &gaps))
        return false;
    text_add(out, "{\"from_us\":%lld,\"to_us\":%lld,\"gaps\":[", (long long)query->from_us, (long long)query->to_us);
    for (size_t i = 0; i < gaps.count; i++)
        text_add(out, "%s[%lld,%lld]", i ? "," : "", (long long)gaps.at[i].from_us, (long long)gaps.at[i].to_us);
    text_add(out, "]}\n");
    mem_free(gaps.at);
    return true;
}

static bool read_whole(struct history_queries *queries, struct history_reader *reader, struct core_history *core,
                       const struct history_query *query, struct text *out)
{
    if (core)
        return remote_history_whole(core, queries->plant, query, out);
    if (query->gaps)
        return print_gaps(reader, query, out);
    alarms_journal_text(queries->log, queries->folder, queries->plant, &query->alarms, out);
    return true;
}

static struct history_answer *read_piece(struct history_queries *queries, struct history_reader *reader, struct core_history *core,
                                         struct pending_query *question)
{
    const struct history_query *query = &question->query;
    struct history_answer *piece = mem_new(sizeof(*piece));
    struct text text = { 0 };
    int64_t begin_ns = clock_mono_ns();
    bool pieces = !query->journal && !query->gaps && !(query->drift && core), good = core || reader;
    *piece = (struct history_answer){ .client = query->client, .csv = query->journal ? query->alarms.csv : query->csv };
    piece->first = question->next_tag == 0;
    if (good && !pieces)
        good = read_whole(queries, reader, core, query, &text);
    while (good && pieces && question->next_tag < steps_of(queries, query) && text.length < PIECE_BYTES &&
           (text.length == 0 || clock_mono_ns() - begin_ns < PIECE_NS))
        good = core           ? fetch_tag(queries, core, question, &text)
               : query->drift ? read_asset(queries, reader, question, &text)
                              : read_tag(queries, reader, question, &text);
    piece->last = !good || !pieces || question->next_tag == steps_of(queries, query);
    if (good && text.length > 0) { /* copies the text to release its spare capacity, because the piece may wait long for a slow client */
        piece->text = mem_array(text.length + 1, 1);
        piece->length = text.length;
        memcpy(piece->text, text.at, text.length);
    }
    text_finish(&text);
    return piece;
}

/* --- scheduling ------------------------------------------------------------------------------------------------------- */

/* Returns whether a thread works on a query of that account (client address). The caller holds the lock. */
static bool is_at_work(const struct history_queries *queries, uint64_t account)
{
    bool any = false;
    for (int i = 0; i < THREADS; i++)
        any |= account && queries->at_work[i] == account;
    return any;
}

/* Returns when the query's account (client address) was last served: the largest `served` among its queries. The caller holds the lock. */
static uint64_t served_of(const struct history_queries *queries, const struct pending_query *question)
{
    uint64_t served = question->served;
    for (const struct pending_query *other = queries->questions; other; other = other->next)
        if (question->query.account && other->query.account == question->query.account && other->served > served)
            served = other->served;
    return served;
}

static bool goes_before(const struct history_queries *queries, const struct pending_query *a, const struct pending_query *b)
{
    uint64_t a_served = served_of(queries, a), b_served = served_of(queries, b);
    /* if two queries were served equally long ago, the older one goes first: the later one in the list, which is sorted newest first */
    return a_served < b_served || (a_served == b_served && a->served <= b->served);
}

/* Removes from the list and returns the query whose account (client address) was served longest ago; NULL: no query can be
   served now. The caller holds the lock. */
static struct pending_query *take_next(struct history_queries *queries)
{
    struct pending_query **best = NULL;
    for (struct pending_query **at = &queries->questions; *at; at = &(*at)->next)
        if ((*at)->wanted && !is_at_work(queries, (*at)->query.account) && (!best || goes_before(queries, *at, *best)))
            best = at;
    struct pending_query *question = best ? *best : NULL;
    if (question)
        *best = question->next;
    return question;
}

/* Adds a finished piece of a query's answer to the list from which the event loop takes answers. The caller holds the lock. */
static void give(struct history_queries *queries, struct pending_query *question, struct history_answer *piece)
{
    bool last = piece->last;
    if (question->forgotten) {
        history_answer_free(&piece);
    } else {
        *queries->last = piece;
        queries->last = &piece->next;
    }
    if (question->forgotten || last) {
        queries->count--;
        mem_free(question);
        return;
    }
    question->next = queries->questions;
    queries->questions = question;
}

struct query_worker {
    struct history_queries *queries;
    int index;
};

static void *history_queries_main(void *arg)
{
    struct query_worker *worker = arg;
    struct history_queries *queries = worker->queries;
    struct history_reader *reader = queries->folder ? history_reader_create(queries->log, queries->folder) : NULL;
    struct core_history *core = queries->folder ? NULL : core_history_create(queries->log, queries->core_link, &queries->stop);
    int index = worker->index;
    if (reader)
        history_reader_show_by(reader, queries->plant);
    mem_free(worker);
    pthread_mutex_lock(&queries->lock);
    while (!queries->stopping) {
        struct pending_query *question = take_next(queries);
        if (!question) {
            pthread_cond_wait(&queries->wake, &queries->lock);
            continue;
        }
        question->wanted = false;
        question->served = ++queries->served;
        queries->at_work[index] = question->query.account;
        queries->working[index] = question;
        pthread_mutex_unlock(&queries->lock);
        struct history_answer *piece = read_piece(queries, reader, core, question);
        pthread_mutex_lock(&queries->lock);
        queries->at_work[index] = 0;
        queries->working[index] = NULL;
        give(queries, question, piece);
        /* wakes the other threads, because another query of the same client address may now be served */
        pthread_cond_broadcast(&queries->wake);
        pthread_mutex_unlock(&queries->lock);
        queries->notify(queries->notify_arg);
        pthread_mutex_lock(&queries->lock);
    }
    pthread_mutex_unlock(&queries->lock);
    history_reader_destroy(&reader);
    core_history_destroy(&core);
    return NULL;
}

/* --- life cycle ------------------------------------------------------------------------------------------------------- */

struct history_queries *history_queries_create(struct log *log, const struct plant *plant, const struct scene *scene, const char *folder,
                                               struct core_link *core_link, void (*notify)(void *arg), void *arg)
{
    struct history_queries *queries = mem_new(sizeof(*queries));
    pthread_mutex_init(&queries->lock, NULL);
    pthread_cond_init(&queries->wake, NULL);
    queries->log = log;
    queries->plant = plant;
    queries->scene = scene;
    queries->folder = folder ? mem_strdup(folder) : NULL;
    queries->core_link = core_link;
    queries->notify = notify;
    queries->notify_arg = arg;
    queries->last = &queries->answers;
    for (int i = 0, error = 0; i < THREADS && !error; i++) {
        struct query_worker *worker = mem_new(sizeof(*worker));
        *worker = (struct query_worker){ queries, i };
        error = pthread_create(&queries->threads[i], NULL, history_queries_main, worker);
        queries->thread_count += !error;
        if (!error)
            continue;
        mem_free(worker);
        log_err(log, "history: cannot start a thread that reads history: %s", strerror(error));
    }
    if (queries->thread_count < THREADS)
        history_queries_destroy(&queries);
    return queries;
}

void history_answer_free(struct history_answer **answer)
{
    mem_free((*answer)->text);
    mem_free(*answer);
    *answer = NULL;
}

void history_queries_destroy(struct history_queries **pointer)
{
    struct history_queries *queries = *pointer;
    if (!queries)
        return;
    pthread_mutex_lock(&queries->lock);
    queries->stopping = true;
    atomic_store(&queries->stop, true);
    pthread_cond_broadcast(&queries->wake);
    pthread_mutex_unlock(&queries->lock);
    for (int i = 0; i < queries->thread_count; i++)
        pthread_join(queries->threads[i], NULL);
    for (struct history_answer *answer = queries->answers, *next; answer; answer = next) {
        next = answer->next;
        history_answer_free(&answer);
    }
    for (struct pending_query *question = queries->questions, *next; question; question = next) {
        next = question->next;
        mem_free(question);
    }
    mem_free(queries->folder);
    pthread_cond_destroy(&queries->wake);
    pthread_mutex_destroy(&queries->lock);
    mem_free(queries);
    *pointer = NULL;
}

/* --- for the event loop ----------------------------------------------------------------------------------------------- */

bool history_queries_ask(struct history_queries *queries, const struct history_query *query)
{
    pthread_mutex_lock(&queries->lock);
    bool room = queries->count < HISTORY_QUERIES_MOST;
    if (room) {
        struct pending_query *question = mem_new(sizeof(*question));
        *question = (struct pending_query){ .query = *query, .wanted = true, .next = queries->questions };
        queries->questions = question;
        queries->count++;
        pthread_cond_broadcast(&queries->wake);
    }
    pthread_mutex_unlock(&queries->lock);
    return room;
}

void history_queries_continue(struct history_queries *queries, uint64_t client)
{
    pthread_mutex_lock(&queries->lock);
    for (struct pending_query *question = queries->questions; question; question = question->next)
        question->wanted |= question->query.client == client;
    pthread_cond_broadcast(&queries->wake);
    pthread_mutex_unlock(&queries->lock);
}

void history_queries_forget(struct history_queries *queries, uint64_t client)
{
    pthread_mutex_lock(&queries->lock);
    for (int i = 0; i < THREADS; i++)
        if (queries->working[i] && queries->working[i]->query.client == client)
            queries->working[i]->forgotten = true;
    for (struct pending_query **at = &queries->questions; *at;) {
        struct pending_query *question = *at;
        if (question->query.client != client) {
            at = &question->next;
            continue;
        }
        *at = question->next;
        queries->count--;
        mem_free(question);
    }
    pthread_mutex_unlock(&queries->lock);
}

struct history_answer *history_queries_collect(struct history_queries *queries)
{
    pthread_mutex_lock(&queries->lock);
    struct history_answer *answers = queries->answers;
    queries->answers = NULL;
    queries->last = &queries->answers;
    pthread_mutex_unlock(&queries->lock);
    return answers;
}
