/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The last pictures, by what they show and how they are coded. */
#include "net/recent.h"

#include <pthread.h>

#include "base/clock.h"
#include "base/mem.h"

enum { KEPT = 16 };
#define KEPT_BYTES (16u * 1024 * 1024)
static const int64_t KEPT_NS = 500 * NS_PER_MS; /* ages and the clock in a picture are no older than this */

struct entry {
    uint64_t content;
    enum wire_codec codec;
    struct encoder_params quality;
    struct packet *packet; /* NULL: being encoded, if busy */
    bool busy;
    int64_t made_ns;
    struct batch waiting;
};

struct recent {
    counter *shared;
    pthread_mutex_t lock;
    /* --- below: under lock */
    struct entry entries[KEPT];
};

struct recent *recent_create(struct counters *counters)
{
    struct recent *recent = mem_new(sizeof(*recent));
    recent->shared =
        counters_add(counters, "plantcast_encodes_shared_total", "counter", "Pictures that were there already for another client.");
    pthread_mutex_init(&recent->lock, NULL);
    return recent;
}

static void forget(struct entry *entry)
{
    packet_unref(&entry->packet);
    batch_finish(&entry->waiting);
    *entry = (struct entry){ 0 };
}

void recent_destroy(struct recent **recent)
{
    if (!*recent)
        return;
    for (int i = 0; i < KEPT; i++)
        forget(&(*recent)->entries[i]);
    pthread_mutex_destroy(&(*recent)->lock);
    mem_free(*recent);
    *recent = NULL;
}

/* Later pictures of the others build on earlier ones. */
static bool stands_alone(const struct wish *wish)
{
    return wish->codec != WIRE_CODEC_H264 && !wish->overlay;
}

static bool same_coding(const struct entry *entry, const struct wish *wish)
{
    return stands_alone(wish) && entry->codec == wish->codec && entry->quality.quality == wish->quality.quality &&
           entry->quality.full_chroma == wish->quality.full_chroma;
}

/* Under lock. */
static struct entry *find(struct recent *recent, uint64_t content, const struct wish *wish)
{
    for (int i = 0; i < KEPT; i++) {
        struct entry *entry = &recent->entries[i];
        if ((entry->busy || entry->packet) && entry->content == content && same_coding(entry, wish))
            return entry;
    }
    return NULL;
}

/* Under lock. The oldest makes room; NULL: all are busy. */
static struct entry *make_room(struct recent *recent, size_t bytes)
{
    for (;;) {
        struct entry *free_one = NULL, *oldest = NULL;
        size_t sum = bytes;
        for (int i = 0; i < KEPT; i++) {
            struct entry *entry = &recent->entries[i];
            sum += entry->packet ? entry->packet->count : 0;
            if (!entry->busy && !entry->packet)
                free_one = entry;
            else if (entry->packet && (!oldest || entry->made_ns < oldest->made_ns))
                oldest = entry;
        }
        if ((free_one && sum <= KEPT_BYTES) || !oldest)
            return free_one;
        forget(oldest);
    }
}

static bool belongs(const struct order *order, void *arg)
{
    return same_coding(arg, &order->wish);
}

static void add_all(const struct batch *from, struct batch *into)
{
    for (size_t i = 0; i < from->count; i++)
        batch_add(into, &from->orders[i]);
}

bool recent_join(struct recent *recent, uint64_t content, struct batch *batch, struct batch *joined, struct packet **packet)
{
    int64_t now_ns = clock_mono_ns();
    joined->count = 0;
    *packet = NULL;
    pthread_mutex_lock(&recent->lock);
    for (size_t i = 0; i < batch->count && joined->count == 0; i++) {
        struct entry *entry = find(recent, content, &batch->orders[i].wish);
        if (!entry || (entry->packet && now_ns - entry->made_ns > KEPT_NS))
            continue;
        batch_split(batch, belongs, entry, joined);
        if (entry->packet)
            *packet = packet_ref(entry->packet);
        else
            add_all(joined, &entry->waiting);
    }
    pthread_mutex_unlock(&recent->lock);
    counter_inc(recent->shared, (int64_t)joined->count);
    return joined->count > 0;
}

void recent_begin(struct recent *recent, uint64_t content, const struct batch *batch)
{
    pthread_mutex_lock(&recent->lock);
    for (size_t i = 0; i < batch->count; i++) {
        const struct wish *wish = &batch->orders[i].wish;
        struct entry *entry = stands_alone(wish) ? find(recent, content, wish) : NULL;
        if (!stands_alone(wish) || (entry && entry->busy))
            continue;
        if (entry)
            forget(entry);
        else
            entry = make_room(recent, 0);
        if (entry)
            *entry = (struct entry){ .content = content, .codec = wish->codec, .quality = wish->quality, .busy = true };
    }
    pthread_mutex_unlock(&recent->lock);
}

void recent_end(struct recent *recent, uint64_t content, const struct wish *wish, struct packet *packet, struct batch *waiting)
{
    waiting->count = 0;
    pthread_mutex_lock(&recent->lock);
    struct entry *entry = find(recent, content, wish);
    if (entry && entry->busy) {
        add_all(&entry->waiting, waiting);
        forget(entry);
        entry = packet ? make_room(recent, packet->count) : NULL;
        if (entry)
            *entry = (struct entry){ .content = content, .codec = wish->codec, .quality = wish->quality };
        if (entry) {
            entry->packet = packet_ref(packet);
            entry->made_ns = clock_mono_ns();
        }
    }
    pthread_mutex_unlock(&recent->lock);
}
