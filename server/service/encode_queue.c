/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames to packets on the workers: the jobs of one chain one after the other, those of different chains side by side. */
#include "service/encode_queue.h"

#include <pthread.h>

#include "base/clock.h"
#include "base/mem.h"
#include "message/names.h"
#include "service/encode_streams.h"

enum { CODECS = WIRE_CODEC_H264 + 1 };

struct idle_encoder {
    enum wire_codec codec;
    struct encoder *encoder;
    struct idle_encoder *next;
};

struct encode_queue {
    struct encode_queue_params params;
    counter *encodes[CODECS], *encode_us[CODECS], *bytes[CODECS], *failures, *chain_count;
    pthread_mutex_t lock;
    pthread_cond_t job_ended;
    /* --- below: under lock */
    struct idle_encoder *idle;
    struct encode_streams chains;
    int jobs;
    int heavy; /* jobs on the workers that are of pictures over HTTP: of many pixels, maybe, and losslessly */
    struct job *heavy_waiting, **heavy_last;
    struct request_group rest; /* of encode_queue_submit */
    struct encode_plan plan;
};

struct job {
    struct encode_queue *encoding;
    struct encode_stream *chain;
    struct frame *frame;        /* NULL: nothing to be encoded */
    struct request_group batch; /* all of one codec and quality */
    struct encoder_params quality;
    bool again;
    uint64_t number, *from;
    struct job *next, *next_heavy;
    bool heavy;
};

struct work {                  /* of a chain */
    struct job *first, **last; /* under lock; the first is running */
    struct encoder *encoder;   /* of a codec that is a stream; and below: only the running job's */
    struct frame *before;      /* what the clients of the chain show, in this quality */
    struct encoder_params quality;
};

/* --- life ---------------------------------------------------------------------------------------------------------------------- */

static void add_counters(struct encode_queue *encoding)
{
    struct counters *counters = encoding->params.counters;
    for (int codec = WIRE_CODEC_JPEG; codec < CODECS; codec++) {
        const char *name = name_of(names_codec, codec);
        char *encodes = mem_printf("plantcast_encodes_total{codec=\"%s\"}", name);
        char *us = mem_printf("plantcast_encode_us_total{codec=\"%s\"}", name);
        char *bytes = mem_printf("plantcast_encode_bytes_total{codec=\"%s\"}", name);
        encoding->encodes[codec] = counters_add(counters, encodes, "counter", "Pictures encoded.");
        encoding->encode_us[codec] = counters_add(counters, us, "counter", "Microseconds spent encoding.");
        encoding->bytes[codec] = counters_add(counters, bytes, "counter", "Bytes that pictures were encoded to.");
        mem_free(encodes);
        mem_free(us);
        mem_free(bytes);
    }
    encoding->failures = counters_add(counters, "plantcast_encode_failures_total", "counter", "Pictures that could not be encoded.");
    encoding->chain_count =
        counters_add(counters, "plantcast_encode_streams", "gauge", "Streams of packets, each for the clients that share it.");
}

struct encode_queue *encode_queue_create(const struct encode_queue_params *params)
{
    struct encode_queue *encoding = mem_new(sizeof(*encoding));
    encoding->params = *params;
    encoding->heavy_last = &encoding->heavy_waiting;
    pthread_mutex_init(&encoding->lock, NULL);
    pthread_cond_init(&encoding->job_ended, NULL);
    add_counters(encoding);
    return encoding;
}

static bool is_busy(const struct encode_stream *chain)
{
    const struct work *work = chain->work;
    return work->first != NULL;
}

void encode_queue_sweep(struct encode_queue *encoding)
{
    for (;;) {
        pthread_mutex_lock(&encoding->lock);
        struct encode_stream *chain = encode_streams_take_empty(&encoding->chains, is_busy);
        pthread_mutex_unlock(&encoding->lock);
        if (!chain)
            return;
        struct work *work = chain->work;
        encoder_destroy(&work->encoder);
        frame_unref(&work->before);
        mem_free(work);
        encode_stream_destroy(&chain);
        counter_inc(encoding->chain_count, -1);
    }
}

void encode_queue_forget(struct encode_queue *encoding, uint64_t client)
{
    pthread_mutex_lock(&encoding->lock);
    encode_streams_forget(&encoding->chains, client);
    pthread_mutex_unlock(&encoding->lock);
}

void encode_queue_drop_idle(struct encode_queue *encoding)
{
    pthread_mutex_lock(&encoding->lock);
    struct idle_encoder *idle = encoding->idle, *next;
    encoding->idle = NULL;
    pthread_mutex_unlock(&encoding->lock);
    for (; idle; idle = next) {
        next = idle->next;
        encoder_destroy(&idle->encoder);
        mem_free(idle);
    }
}

void encode_queue_destroy(struct encode_queue **encoding_ptr)
{
    struct encode_queue *encoding = *encoding_ptr;
    if (!encoding)
        return;
    pthread_mutex_lock(&encoding->lock);
    while (encoding->jobs > 0)
        pthread_cond_wait(&encoding->job_ended, &encoding->lock);
    while (encoding->chains.link_count > 0)
        encode_streams_forget(&encoding->chains, encoding->chains.links[encoding->chains.link_count - 1].client);
    pthread_mutex_unlock(&encoding->lock);
    encode_queue_sweep(encoding);
    encode_queue_drop_idle(encoding);
    mem_free(encoding->chains.links);
    request_group_finish(&encoding->rest);
    mem_free(encoding->plan.from);
    pthread_cond_destroy(&encoding->job_ended);
    pthread_mutex_destroy(&encoding->lock);
    mem_free(encoding);
    *encoding_ptr = NULL;
}

/* --- encoders -------------------------------------------------------------------------------------------------------------------- */

static struct encoder *encoder_take(struct encode_queue *encoding, struct work *work, enum wire_codec codec)
{
    const char *name = name_of(names_codec, (int)codec);
    if (encoder_is_stream(name)) {
        if (!work->encoder)
            work->encoder = encoder_create(encoding->params.log, name, encoding->params.h264_library);
        return work->encoder;
    }
    pthread_mutex_lock(&encoding->lock);
    struct idle_encoder **at = &encoding->idle;
    while (*at && (*at)->codec != codec)
        at = &(*at)->next;
    struct idle_encoder *idle = *at;
    if (idle)
        *at = idle->next;
    pthread_mutex_unlock(&encoding->lock);
    struct encoder *encoder = idle ? idle->encoder : encoder_create(encoding->params.log, name, NULL);
    mem_free(idle);
    return encoder;
}

static void encoder_give(struct encode_queue *encoding, const struct work *work, enum wire_codec codec, struct encoder *encoder)
{
    if (!encoder || encoder == work->encoder)
        return;
    struct idle_encoder *idle = mem_new(sizeof(*idle));
    pthread_mutex_lock(&encoding->lock);
    *idle = (struct idle_encoder){ .codec = codec, .encoder = encoder, .next = encoding->idle };
    encoding->idle = idle;
    pthread_mutex_unlock(&encoding->lock);
}

static void count(struct encode_queue *encoding, const struct packet *packet)
{
    counter_inc(encoding->encodes[packet->codec], 1);
    counter_inc(encoding->encode_us[packet->codec], packet->encode_ns / 1000);
    counter_inc(encoding->bytes[packet->codec], (int64_t)packet->count);
}

/* --- jobs ------------------------------------------------------------------------------------------------------------------------ */

static bool same_quality(const struct encoder_params *a, const struct encoder_params *b)
{
    return a->quality == b->quality && a->full_chroma == b->full_chroma;
}

/* False: it failed. *out NULL: nothing has changed. */
static bool encode(struct job *job, struct packet **out)
{
    struct encode_queue *encoding = job->encoding;
    struct work *work = job->chain->work;
    enum wire_codec codec = job->batch.orders[0].wish.codec;
    struct encoder_params params = job->quality;
    struct encoder *encoder = encoder_take(encoding, work, codec);
    params.before = !job->again && same_quality(&work->quality, &params) ? work->before : NULL;
    params.workers = encoding->params.workers;
    bool good = encoder && encoder_send(encoder, job->frame, &params) == 0;
    if (good && encoder_receive(encoder, out) == 0)
        count(encoding, *out);
    encoder_give(encoding, work, codec, encoder);
    if (!good) {
        counter_inc(encoding->failures, 1);
        encoder_destroy(&work->encoder);
    }
    frame_unref(&work->before);
    work->before = good ? frame_ref(job->frame) : NULL;
    work->quality = job->quality;
    return good;
}

/* Under lock: the lowest number that jobs after this one still have to give to someone. */
static uint64_t still_needed(const struct job *job)
{
    uint64_t least = UINT64_MAX;
    for (; job; job = job->next)
        for (size_t i = 0; i < job->batch.count; i++)
            least = job->from[i] < least ? job->from[i] : least;
    return least;
}

struct run {
    struct packet *packets[ENCODE_STREAM_KEPT];
    int count; /* negative: gone */
};

static void take_run(struct job *job, size_t order, struct run *run)
{
    pthread_mutex_lock(&job->encoding->lock);
    run->count = encode_stream_catch_up(job->chain, job->from[order], job->number, run->packets);
    for (int i = 0; i < run->count; i++)
        packet_ref(run->packets[i]);
    pthread_mutex_unlock(&job->encoding->lock);
}

static void answer(struct job *job)
{
    const struct encode_queue_params *params = &job->encoding->params;
    struct run run;
    for (size_t i = 0; i < job->batch.count; i++) {
        take_run(job, i, &run);
        params->done(params->done_arg, &job->batch.orders[i], run.packets, run.count < 0 ? 0 : run.count, run.count < 0);
        for (int p = 0; p < run.count; p++)
            packet_unref(&run.packets[p]);
    }
    params->all_done(params->done_arg);
}

static void job_destroy(struct job *job)
{
    frame_unref(&job->frame);
    request_group_finish(&job->batch);
    mem_free(job->from);
    mem_free(job);
}

static void run_job(void *arg);

/* Pictures over HTTP leave half of the workers to streams. */
static void start(struct encode_queue *encoding, struct job *job)
{
    int most = workers_count(encoding->params.workers) / 2;
    pthread_mutex_lock(&encoding->lock);
    bool waits = job->heavy && encoding->heavy >= (most > 1 ? most : 1);
    if (waits) {
        *encoding->heavy_last = job;
        encoding->heavy_last = &job->next_heavy;
    } else {
        encoding->heavy += job->heavy;
    }
    pthread_mutex_unlock(&encoding->lock);
    if (!waits)
        workers_submit(encoding->params.workers, run_job, job);
}

/* One of them is done: the next takes its place. */
static void start_heavy(struct encode_queue *encoding)
{
    pthread_mutex_lock(&encoding->lock);
    struct job *job = encoding->heavy_waiting;
    if (job)
        encoding->heavy_waiting = job->next_heavy;
    if (!encoding->heavy_waiting)
        encoding->heavy_last = &encoding->heavy_waiting;
    encoding->heavy -= !job;
    pthread_mutex_unlock(&encoding->lock);
    if (job)
        workers_submit(encoding->params.workers, run_job, job);
}

static void run_job(void *arg)
{
    struct job *job = arg;
    struct encode_queue *encoding = job->encoding;
    struct encode_stream *chain = job->chain;
    struct work *work = chain->work;
    struct packet *packet = NULL;
    bool good = !job->frame || encode(job, &packet);
    pthread_mutex_lock(&encoding->lock);
    if (!good)
        encode_stream_break(chain);
    else if (job->frame)
        encode_stream_keep(chain, packet, still_needed(job));
    pthread_mutex_unlock(&encoding->lock);
    packet_unref(&packet);
    answer(job);
    pthread_mutex_lock(&encoding->lock);
    struct job *next = work->first = job->next;
    if (!next)
        work->last = &work->first;
    pthread_mutex_unlock(&encoding->lock);
    bool heavy = job->heavy;
    job_destroy(job);
    if (heavy)
        start_heavy(encoding);
    if (next)
        start(encoding, next);
    encode_queue_sweep(encoding);
    pthread_mutex_lock(&encoding->lock);
    encoding->jobs--;
    pthread_cond_broadcast(&encoding->job_ended);
    pthread_mutex_unlock(&encoding->lock);
}

/* --- from frames to jobs ------------------------------------------------------------------------------------------------------------ */

static bool same_coding(const struct request_ticket *order, void *arg)
{
    const struct frame_request *a = &order->wish, *b = arg;
    return a->codec == b->codec && a->overlay == b->overlay && same_quality(&a->quality, &b->quality);
}

/* Under lock. */
static struct job *make_job(struct encode_queue *encoding, struct frame *frame, struct request_group *orders)
{
    struct encode_plan *plan = &encoding->plan;
    struct job *job = mem_new(sizeof(*job));
    *job = (struct job){ .encoding = encoding, .chain = plan->chain, .number = plan->number, .batch = *orders, .from = plan->from };
    job->frame = plan->encode ? frame_ref(frame) : NULL;
    job->quality = orders->orders[0].wish.quality;
    job->quality.key = plan->key;
    job->again = plan->again;
    job->heavy = job->frame && orders->orders[0].wish.urgency == URGENCY_SNAPSHOT;
    *orders = (struct request_group){ 0 };
    plan->from = NULL;
    plan->from_capacity = 0;
    encoding->jobs++;
    return job;
}

/* Under lock. True: nothing of the chain is under way, so that this one may start. */
static bool append(struct encode_queue *encoding, struct job *job)
{
    struct work *work = job->chain->work;
    if (!work) {
        work = job->chain->work = mem_new(sizeof(*work));
        work->last = &work->first;
        counter_inc(encoding->chain_count, 1);
    }
    bool idle = work->first == NULL;
    *work->last = job;
    work->last = &job->next;
    return idle;
}

static void submit_group(struct encode_queue *encoding, struct frame *frame, struct request_group *group)
{
    while (group->count > 0) {
        struct request_group orders = *group;
        pthread_mutex_lock(&encoding->lock);
        encode_streams_plan(&encoding->chains, frame, &orders, clock_mono_ns(), &encoding->plan, &encoding->rest);
        *group = encoding->rest;
        encoding->rest = (struct request_group){ 0 };
        struct job *job = make_job(encoding, frame, &orders);
        bool starts = append(encoding, job);
        pthread_mutex_unlock(&encoding->lock);
        if (starts)
            start(encoding, job);
    }
    request_group_finish(group);
}

void encode_queue_submit(struct encode_queue *encoding, struct frame *frame, struct request_group *batch)
{
    while (batch->count > 0) {
        struct frame_request first = batch->orders[0].wish;
        struct request_group group = { 0 };
        request_group_split(batch, same_coding, &first, &group);
        submit_group(encoding, frame, &group);
    }
}
