/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes frames on the worker threads: a stream's jobs run one after the other, those of different streams in parallel. */
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
    /* --- below: protected by `lock` */
    struct idle_encoder *idle;
    struct encode_streams streams;
    int jobs;
    /* number of running jobs that encode frames for HTTP or for signing; limited, because these frames may be large and lossless */
    int heavy;
    struct encode_job *heavy_waiting, **heavy_last;
    struct request_group rest; /* scratch memory of encode_queue_submit() for requests that need another encode stream */
    struct encode_plan plan;
};

struct encode_job {
    struct encode_queue *queue;
    struct encode_stream *stream;
    struct frame *frame;        /* frame that the job encodes; NULL: nothing needs encoding, because stored packets answer the requests */
    struct request_group group; /* requests with equal codec and quality, all answered with one encoded frame */
    struct encoder_params quality;
    bool again;
    uint64_t number, *from;
    struct encode_job *next, *next_heavy;
    bool heavy;
};

struct stream_work {                  /* encoding jobs and encoder of one encode stream (a sequence of packets that clients share) */
    struct encode_job *first, **last; /* the stream's jobs, oldest first, protected by the lock; the first job is running */
    /* encoder of the stream, for codecs that keep state between frames; only the running job uses this member and those below */
    struct encoder *encoder;
    struct frame *before; /* newest frame encoded for this stream; clients that have all packets show it */
    struct encoder_params quality;
};

/* --- life cycle ------------------------------------------------------------------------------------------------------- */

static void add_counters(struct encode_queue *queue)
{
    struct counters *counters = queue->params.counters;
    for (int codec = WIRE_CODEC_JPEG; codec < CODECS; codec++) {
        const char *name = name_of(names_codec, codec);
        char *encodes = mem_printf("plantcast_encodes_total{codec=\"%s\"}", name);
        char *seconds = mem_printf("plantcast_encode_seconds_total{codec=\"%s\"}", name);
        char *bytes = mem_printf("plantcast_encode_bytes_total{codec=\"%s\"}", name);
        queue->encodes[codec] = counters_add(counters, encodes, "counter", "Pictures encoded, by codec.");
        queue->encode_us[codec] = counters_add_seconds(counters, seconds, "counter", "Seconds spent encoding pictures, by codec.");
        queue->bytes[codec] = counters_add(counters, bytes, "counter", "Total size in bytes of all encoded pictures, by codec.");
        mem_free(encodes);
        mem_free(seconds);
        mem_free(bytes);
    }
    queue->failures = counters_add(counters, "plantcast_encode_failures_total", "counter", "Pictures that could not be encoded.");
    queue->chain_count = counters_add(counters, "plantcast_encode_streams", "gauge",
                                      "Video streams that are being encoded; clients with the same view share one.");
}

struct encode_queue *encode_queue_create(const struct encode_queue_params *params)
{
    struct encode_queue *queue = mem_new(sizeof(*queue));
    queue->params = *params;
    queue->heavy_last = &queue->heavy_waiting;
    pthread_mutex_init(&queue->lock, NULL);
    pthread_cond_init(&queue->job_ended, NULL);
    add_counters(queue);
    return queue;
}

static bool is_busy(const struct encode_stream *stream)
{
    const struct stream_work *work = stream->work;
    return work->first != NULL;
}

void encode_queue_sweep(struct encode_queue *queue)
{
    for (;;) {
        pthread_mutex_lock(&queue->lock);
        struct encode_stream *stream = encode_streams_take_empty(&queue->streams, is_busy);
        pthread_mutex_unlock(&queue->lock);
        if (!stream)
            return;
        struct stream_work *work = stream->work;
        encoder_destroy(&work->encoder);
        frame_unref(&work->before);
        mem_free(work);
        encode_stream_destroy(&stream);
        counter_inc(queue->chain_count, -1);
    }
}

void encode_queue_forget(struct encode_queue *queue, uint64_t client)
{
    pthread_mutex_lock(&queue->lock);
    encode_streams_forget(&queue->streams, client);
    pthread_mutex_unlock(&queue->lock);
}

void encode_queue_drop_idle(struct encode_queue *queue)
{
    pthread_mutex_lock(&queue->lock);
    struct idle_encoder *idle = queue->idle, *next;
    queue->idle = NULL;
    pthread_mutex_unlock(&queue->lock);
    for (; idle; idle = next) {
        next = idle->next;
        encoder_destroy(&idle->encoder);
        mem_free(idle);
    }
}

void encode_queue_destroy(struct encode_queue **encoding_ptr)
{
    struct encode_queue *queue = *encoding_ptr;
    if (!queue)
        return;
    pthread_mutex_lock(&queue->lock);
    while (queue->jobs > 0)
        pthread_cond_wait(&queue->job_ended, &queue->lock);
    while (queue->streams.link_count > 0)
        encode_streams_forget(&queue->streams, queue->streams.links[queue->streams.link_count - 1].client);
    pthread_mutex_unlock(&queue->lock);
    encode_queue_sweep(queue);
    encode_queue_drop_idle(queue);
    mem_free(queue->streams.links);
    request_group_finish(&queue->rest);
    mem_free(queue->plan.from);
    pthread_cond_destroy(&queue->job_ended);
    pthread_mutex_destroy(&queue->lock);
    mem_free(queue);
    *encoding_ptr = NULL;
}

/* --- encoders --------------------------------------------------------------------------------------------------------- */

static struct encoder *encoder_take(struct encode_queue *queue, struct stream_work *work, enum wire_codec codec)
{
    const char *name = name_of(names_codec, (int)codec);
    if (encoder_is_stream(name)) {
        if (!work->encoder)
            work->encoder = encoder_create(queue->params.log, name, queue->params.h264_library);
        return work->encoder;
    }
    pthread_mutex_lock(&queue->lock);
    struct idle_encoder **at = &queue->idle;
    while (*at && (*at)->codec != codec)
        at = &(*at)->next;
    struct idle_encoder *idle = *at;
    if (idle)
        *at = idle->next;
    pthread_mutex_unlock(&queue->lock);
    struct encoder *encoder = idle ? idle->encoder : encoder_create(queue->params.log, name, NULL);
    mem_free(idle);
    return encoder;
}

static void encoder_give(struct encode_queue *queue, const struct stream_work *work, enum wire_codec codec, struct encoder *encoder)
{
    if (!encoder || encoder == work->encoder)
        return;
    struct idle_encoder *idle = mem_new(sizeof(*idle));
    pthread_mutex_lock(&queue->lock);
    *idle = (struct idle_encoder){ .codec = codec, .encoder = encoder, .next = queue->idle };
    queue->idle = idle;
    pthread_mutex_unlock(&queue->lock);
}

static void count(struct encode_queue *queue, const struct packet *packet)
{
    counter_inc(queue->encodes[packet->codec], 1);
    counter_inc(queue->encode_us[packet->codec], packet->encode_ns / 1000);
    counter_inc(queue->bytes[packet->codec], (int64_t)packet->count);
}

/* --- jobs ------------------------------------------------------------------------------------------------------------- */

static bool same_quality(const struct encoder_params *a, const struct encoder_params *b)
{
    return a->quality == b->quality && a->full_chroma == b->full_chroma;
}

/* Encodes the job's frame. Returns false on failure. *out becomes NULL if the picture has not changed since the stream's last frame. */
static bool encode(struct encode_job *job, struct packet **out)
{
    struct encode_queue *queue = job->queue;
    struct stream_work *work = job->stream->work;
    enum wire_codec codec = job->group.tickets[0].request.codec;
    struct encoder_params params = job->quality;
    struct encoder *encoder = encoder_take(queue, work, codec);
    params.before = !job->again && same_quality(&work->quality, &params) ? work->before : NULL;
    params.workers = queue->params.workers;
    bool good = encoder && encoder_send(encoder, job->frame, &params) == 0;
    if (good && encoder_receive(encoder, out) == 0)
        count(queue, *out);
    encoder_give(queue, work, codec, encoder);
    if (!good) {
        counter_inc(queue->failures, 1);
        encoder_destroy(&work->encoder);
    }
    frame_unref(&work->before);
    work->before = good ? frame_ref(job->frame) : NULL;
    work->quality = job->quality;
    return good;
}

/* Returns the lowest sequence number of the packets that this job or a later job of the stream still has to deliver to a
   client. The caller holds the lock. */
static uint64_t still_needed(const struct encode_job *job)
{
    uint64_t least = UINT64_MAX;
    for (; job; job = job->next)
        for (size_t i = 0; i < job->group.count; i++)
            least = job->from[i] < least ? job->from[i] : least;
    return least;
}

struct packet_run {
    struct packet *packets[ENCODE_STREAM_KEPT];
    int count; /* number of packets to deliver to the client; negative: some of the packets were dropped already */
};

static void take_run(struct encode_job *job, size_t ticket, struct packet_run *run)
{
    pthread_mutex_lock(&job->queue->lock);
    run->count = encode_stream_catch_up(job->stream, job->from[ticket], job->number, run->packets);
    for (int i = 0; i < run->count; i++)
        packet_ref(run->packets[i]);
    pthread_mutex_unlock(&job->queue->lock);
}

static void answer(struct encode_job *job)
{
    const struct encode_queue_params *params = &job->queue->params;
    struct packet_run run;
    for (size_t i = 0; i < job->group.count; i++) {
        take_run(job, i, &run);
        params->done(params->done_arg, &job->group.tickets[i], run.packets, run.count < 0 ? 0 : run.count, run.count < 0);
        for (int p = 0; p < run.count; p++)
            packet_unref(&run.packets[p]);
    }
    params->all_done(params->done_arg);
}

static void job_destroy(struct encode_job *job)
{
    frame_unref(&job->frame);
    request_group_finish(&job->group);
    mem_free(job->from);
    mem_free(job);
}

static void run_job(void *arg);

/* Starts an encoding job on a worker thread. Frames for HTTP and frames to be signed may use at most half of the workers. */
static void start(struct encode_queue *queue, struct encode_job *job)
{
    int most = workers_count(queue->params.workers) / 2;
    pthread_mutex_lock(&queue->lock);
    bool waits = job->heavy && queue->heavy >= (most > 1 ? most : 1);
    if (waits) {
        *queue->heavy_last = job;
        queue->heavy_last = &job->next_heavy;
    } else {
        queue->heavy += job->heavy;
    }
    pthread_mutex_unlock(&queue->lock);
    if (!waits)
        workers_submit(queue->params.workers, run_job, job);
}

/* Starts the next waiting job for an HTTP or signed frame, after another has ended. */
static void start_heavy(struct encode_queue *queue)
{
    pthread_mutex_lock(&queue->lock);
    struct encode_job *job = queue->heavy_waiting;
    if (job)
        queue->heavy_waiting = job->next_heavy;
    if (!queue->heavy_waiting)
        queue->heavy_last = &queue->heavy_waiting;
    queue->heavy -= !job;
    pthread_mutex_unlock(&queue->lock);
    if (job)
        workers_submit(queue->params.workers, run_job, job);
}

static void run_job(void *arg)
{
    struct encode_job *job = arg;
    struct encode_queue *queue = job->queue;
    struct encode_stream *stream = job->stream;
    struct stream_work *work = stream->work;
    struct packet *packet = NULL;
    bool good = !job->frame || encode(job, &packet);
    pthread_mutex_lock(&queue->lock);
    if (!good)
        encode_stream_break(stream);
    else if (job->frame)
        encode_stream_keep(stream, packet, still_needed(job));
    pthread_mutex_unlock(&queue->lock);
    packet_unref(&packet);
    answer(job);
    pthread_mutex_lock(&queue->lock);
    struct encode_job *next = work->first = job->next;
    if (!next)
        work->last = &work->first;
    pthread_mutex_unlock(&queue->lock);
    bool heavy = job->heavy;
    job_destroy(job);
    if (heavy)
        start_heavy(queue);
    if (next)
        start(queue, next);
    encode_queue_sweep(queue);
    pthread_mutex_lock(&queue->lock);
    queue->jobs--;
    pthread_cond_broadcast(&queue->job_ended);
    pthread_mutex_unlock(&queue->lock);
}

/* --- from frames to jobs ---------------------------------------------------------------------------------------------- */

static bool same_part(const struct frame_part *a, const struct frame_part *b)
{
    return a->x_px == b->x_px && a->y_px == b->y_px && a->width_px == b->width_px && a->height_px == b->height_px;
}

static bool same_coding(const struct request_ticket *ticket, void *arg)
{
    const struct frame_request *a = &ticket->request, *b = arg;
    return a->codec == b->codec && a->overlay == b->overlay && a->record == b->record && same_quality(&a->quality, &b->quality) &&
           same_part(&a->part, &b->part);
}

/* Makes a job that encodes the frame for these requests (tickets) as queue->plan says. The caller holds the lock. */
static struct encode_job *make_job(struct encode_queue *queue, struct frame *frame, struct request_group *tickets)
{
    struct encode_plan *plan = &queue->plan;
    const struct frame_request *first = &tickets->tickets[0].request;
    struct encode_job *job = mem_new(sizeof(*job));
    *job = (struct encode_job){ .queue = queue, .stream = plan->stream, .number = plan->number, .group = *tickets, .from = plan->from };
    job->frame = plan->encode ? frame_ref(frame) : NULL;
    job->quality = first->quality;
    job->quality.key = plan->key;
    job->again = plan->again;
    job->heavy = job->frame && (first->urgency == URGENCY_SNAPSHOT || first->record);
    *tickets = (struct request_group){ 0 };
    plan->from = NULL;
    plan->from_capacity = 0;
    queue->jobs++;
    return job;
}

/* Appends the job to its stream. Returns true if the stream was idle and the job can start. The caller holds the lock. */
static bool append(struct encode_queue *queue, struct encode_job *job)
{
    struct stream_work *work = job->stream->work;
    if (!work) {
        work = job->stream->work = mem_new(sizeof(*work));
        work->last = &work->first;
        counter_inc(queue->chain_count, 1);
    }
    bool idle = work->first == NULL;
    *work->last = job;
    work->last = &job->next;
    return idle;
}

static void submit_group(struct encode_queue *queue, struct frame *frame, struct request_group *same)
{
    while (same->count > 0) {
        struct request_group tickets = *same;
        pthread_mutex_lock(&queue->lock);
        encode_streams_plan(&queue->streams, frame, &tickets, clock_mono_ns(), &queue->plan, &queue->rest);
        *same = queue->rest;
        queue->rest = (struct request_group){ 0 };
        struct encode_job *job = make_job(queue, frame, &tickets);
        bool starts = append(queue, job);
        pthread_mutex_unlock(&queue->lock);
        if (starts)
            start(queue, job);
    }
    request_group_finish(same);
}

void encode_queue_submit(struct encode_queue *queue, struct frame *frame, struct request_group *group)
{
    while (group->count > 0) {
        struct frame_request first = group->tickets[0].request;
        struct request_group same = { 0 };
        request_group_split(group, same_coding, &first, &same);
        struct frame *shown = first.part.width_px ? frame_cut(frame, &first.part) : frame_ref(frame);
        submit_group(queue, shown, &same);
        frame_unref(&shown);
    }
}
