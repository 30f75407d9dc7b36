/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts samples to bytes, little-endian: "PCS1", number of samples; then for each sample: tag, quality, value, time. */
#include "corelink/core_samples.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/mem.h"
#include "corelink/little_endian.h"
#include "value/quality.h"

static const char MAGIC[4] = { 'P', 'C', 'S', '1' };

struct core_samples {
    struct store *store;
    pthread_mutex_t lock; /* protects the queue of samples; may be taken while holding the store's lock */
    /* --- below: under `lock` */
    struct sample_event *at;
    size_t count, capacity;
    bool lost;
};

static void on_sample(void *arg, const struct sample_event *event)
{
    struct core_samples *samples = arg;
    pthread_mutex_lock(&samples->lock);
    if (samples->count < CORE_SAMPLES_MOST) {
        mem_grow(&samples->at, &samples->capacity, samples->count + 1, sizeof(*samples->at));
        samples->at[samples->count++] = *event;
    } else {
        samples->lost = true;
    }
    pthread_mutex_unlock(&samples->lock);
}

struct core_samples *core_samples_listen(struct store *store)
{
    struct core_samples *samples = mem_new(sizeof(*samples));
    samples->store = store;
    pthread_mutex_init(&samples->lock, NULL);
    /* listens to all samples of the store, like this daemon's historian, so that the standby records the same points */
    store_listen_all(store, on_sample, samples);
    return samples;
}

void core_samples_end(struct core_samples **pointer)
{
    struct core_samples *samples = *pointer;
    if (!samples)
        return;
    store_unlisten(samples->store, on_sample, samples);
    pthread_mutex_destroy(&samples->lock);
    mem_free(samples->at);
    mem_free(samples);
    *pointer = NULL;
}

static void write_one(struct text *out, const struct sample_event *event)
{
    uint8_t bytes[CORE_SAMPLE_BYTES];
    uint64_t value;
    memcpy(&value, &event->value, sizeof(value));
    put32(bytes, (uint32_t)event->tag);
    put32(bytes + 4, event->quality);
    put64(bytes + 8, value);
    put64(bytes + 16, (uint64_t)event->utc_ns);
    text_add_bytes(out, bytes, sizeof(bytes));
}

int core_samples_write(struct core_samples *samples, struct text *out)
{
    uint8_t head[CORE_SAMPLES_HEAD_BYTES];
    pthread_mutex_lock(&samples->lock);
    size_t count = samples->count < CORE_SAMPLES_AT_ONCE ? samples->count : CORE_SAMPLES_AT_ONCE;
    bool lost = samples->lost;
    if (count && !lost) {
        memcpy(head, MAGIC, sizeof(MAGIC));
        put32(head + 4, (uint32_t)count);
        text_add_bytes(out, head, sizeof(head));
        for (size_t i = 0; i < count; i++)
            write_one(out, &samples->at[i]);
        samples->count -= count;
        memmove(samples->at, samples->at + count, samples->count * sizeof(*samples->at));
    }
    pthread_mutex_unlock(&samples->lock);
    return lost ? -1 : (int)count;
}

bool core_samples_is(const void *bytes, size_t count)
{
    return count >= CORE_SAMPLES_HEAD_BYTES && memcmp(bytes, MAGIC, sizeof(MAGIC)) == 0;
}

static bool read_one(struct sample_event *out, size_t tag_count, const uint8_t *at, int64_t now_mono_ns)
{
    uint32_t tag = get32(at);
    uint64_t value = get64(at + 8);
    if (tag >= tag_count)
        return false;
    *out = (struct sample_event){ .tag = (int)tag, .quality = get32(at + 4), .mono_ns = now_mono_ns, .utc_ns = (int64_t)get64(at + 16) };
    memcpy(&out->value, &value, sizeof(value));
    return out->utc_ns > 0 && isfinite(out->value) == !quality_is_bad(out->quality);
}

const char *core_samples_read(struct sample_event **out, size_t *out_count, size_t tag_count, const void *bytes, size_t count,
                              int64_t now_mono_ns)
{
    const uint8_t *at = bytes;
    *out = NULL;
    *out_count = 0;
    if (!core_samples_is(bytes, count))
        return "the core's message is not a list of samples; do both nodes run the same version?";
    size_t told = get32(at + 4);
    if (told > CORE_SAMPLES_AT_ONCE || count != CORE_SAMPLES_HEAD_BYTES + told * CORE_SAMPLE_BYTES)
        return "the length of the core's message does not match the number of samples in the message; do both nodes run the same version?";
    struct sample_event *samples = mem_array(told + 1, sizeof(*samples));
    for (size_t i = 0; i < told; i++)
        if (!read_one(&samples[i], tag_count, at + CORE_SAMPLES_HEAD_BYTES + i * CORE_SAMPLE_BYTES, now_mono_ns)) {
            mem_free(samples);
            return "the core's message has an invalid sample; do both nodes run the same version?";
        }
    *out = samples;
    *out_count = told;
    return NULL;
}
