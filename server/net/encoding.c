/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames to packets on the workers. */
#include "net/encoding.h"

#include <pthread.h>

#include "base/mem.h"
#include "net/names.h"

struct idle_encoder {
    enum wire_codec codec;
    struct encoder *encoder;
    struct idle_encoder *next;
};

struct encoding {
    struct encoding_params params;
    counter *encodes, *encode_us, *failures;
    pthread_mutex_t lock;
    pthread_cond_t job_ended;
    /* --- below: under lock */
    struct idle_encoder *idle;
    int jobs;
};

struct job {
    struct encoding *encoding;
    struct frame *frame;
    struct batch batch; /* all of one codec and quality */
};

struct encoding *encoding_create(const struct encoding_params *params)
{
    struct encoding *encoding = mem_new(sizeof(*encoding));
    struct counters *counters = params->counters;
    encoding->params = *params;
    pthread_mutex_init(&encoding->lock, NULL);
    pthread_cond_init(&encoding->job_ended, NULL);
    encoding->encodes = counters_add(counters, "plantcast_encodes_total", "counter", "Pictures encoded.");
    encoding->encode_us = counters_add(counters, "plantcast_encode_us_total", "counter", "Microseconds spent encoding.");
    encoding->failures = counters_add(counters, "plantcast_encode_failures_total", "counter", "Pictures that could not be encoded.");
    return encoding;
}

void encoding_destroy(struct encoding **encoding_ptr)
{
    struct encoding *encoding = *encoding_ptr;
    if (!encoding)
        return;
    pthread_mutex_lock(&encoding->lock);
    while (encoding->jobs > 0)
        pthread_cond_wait(&encoding->job_ended, &encoding->lock);
    pthread_mutex_unlock(&encoding->lock);
    for (struct idle_encoder *idle = encoding->idle, *next; idle; idle = next) {
        next = idle->next;
        encoder_destroy(&idle->encoder);
        mem_free(idle);
    }
    pthread_cond_destroy(&encoding->job_ended);
    pthread_mutex_destroy(&encoding->lock);
    mem_free(encoding);
    *encoding_ptr = NULL;
}

static struct encoder *encoder_take(struct encoding *encoding, enum wire_codec codec)
{
    pthread_mutex_lock(&encoding->lock);
    struct idle_encoder **at = &encoding->idle;
    while (*at && (*at)->codec != codec)
        at = &(*at)->next;
    struct idle_encoder *idle = *at;
    if (idle)
        *at = idle->next;
    pthread_mutex_unlock(&encoding->lock);
    struct encoder *encoder = idle ? idle->encoder : encoder_create(encoding->params.log, name_of(names_codec, (int)codec));
    mem_free(idle);
    return encoder;
}

static void encoder_give(struct encoding *encoding, enum wire_codec codec, struct encoder *encoder)
{
    struct idle_encoder *idle = mem_new(sizeof(*idle));
    pthread_mutex_lock(&encoding->lock);
    *idle = (struct idle_encoder){ .codec = codec, .encoder = encoder, .next = encoding->idle };
    encoding->idle = idle;
    pthread_mutex_unlock(&encoding->lock);
}

static struct packet *encode(struct encoding *encoding, struct frame *frame, const struct wish *wish)
{
    struct packet *packet = NULL;
    struct encoder *encoder = encoder_take(encoding, wish->codec);
    if (encoder && encoder_send(encoder, frame, &wish->quality) == 0 && encoder_receive(encoder, &packet) == 0) {
        counter_inc(encoding->encodes, 1);
        counter_inc(encoding->encode_us, packet->encode_ns / 1000);
    } else {
        counter_inc(encoding->failures, 1);
    }
    if (encoder)
        encoder_give(encoding, wish->codec, encoder);
    return packet;
}

static void run_job(void *arg)
{
    struct job *job = arg;
    struct encoding *encoding = job->encoding;
    struct packet *packet = encode(encoding, job->frame, &job->batch.orders[0].wish);
    uint64_t content = job->frame->content;
    frame_unref(&job->frame);
    encoding->params.done(encoding->params.done_arg, content, &job->batch, packet);
    packet_unref(&packet);
    batch_finish(&job->batch);
    mem_free(job);
    pthread_mutex_lock(&encoding->lock);
    encoding->jobs--;
    pthread_cond_broadcast(&encoding->job_ended);
    pthread_mutex_unlock(&encoding->lock);
}

static bool same_coding(const struct order *order, void *arg)
{
    const struct wish *a = &order->wish, *b = arg;
    return a->codec == b->codec && a->quality.quality == b->quality.quality && a->quality.full_chroma == b->quality.full_chroma;
}

void encoding_submit(struct encoding *encoding, struct frame *frame, struct batch *batch)
{
    while (batch->count > 0) {
        struct job *job = mem_new(sizeof(*job));
        struct wish first = batch->orders[0].wish;
        *job = (struct job){ .encoding = encoding, .frame = frame_ref(frame) };
        batch_split(batch, same_coding, &first, &job->batch);
        pthread_mutex_lock(&encoding->lock);
        encoding->jobs++;
        pthread_mutex_unlock(&encoding->lock);
        workers_submit(encoding->params.workers, run_job, job);
    }
}
