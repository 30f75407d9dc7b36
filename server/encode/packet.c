/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Packets: an encoded frame with the frame's metadata, but without its raw pixels. */
#include "encode/packet.h"

#include <string.h>

#include "base/mem.h"
#include "render/depth_grid.h"
#include "render/frame_record.h"

static void *copy_of(const void *list, size_t count, size_t bytes_each)
{
    void *copy = mem_array(count, bytes_each);
    if (count)
        memcpy(copy, list, count * bytes_each);
    return copy;
}

/* Copies a frame without its pixels, because a packet may wait for a slow client and must not hold megabytes meanwhile. The
   copy needs its own references to the record and the depth grids, because frame_unref() drops them. */
static struct frame *without_pixels(const struct frame *frame)
{
    struct frame *copy = mem_new(sizeof(*copy));
    /* copies only the members from `view` on: the ones before it include the reference count, which other threads may be changing */
    size_t plain = offsetof(struct frame, view);
    memcpy((char *)copy + plain, (const char *)frame + plain, sizeof(*copy) - plain);
    atomic_init(&copy->refs, 1);
    copy->bgrx = NULL;
    copy->whole = NULL;
    copy->pool = NULL;
    copy->markers = copy_of(frame->markers, frame->marker_count, sizeof(*frame->markers));
    copy->record = frame_record_ref(frame->record);
    for (int half = 0; half < 2; half++)
        copy->depth[half] = depth_grid_ref(frame->depth[half]);
    copy->labels = copy_of(frame->labels, frame->label_count, sizeof(*frame->labels));
    return copy;
}

static struct packet *make(const struct frame *frame, enum wire_codec codec, bool key, const void *bytes, const struct packet_part *parts,
                           int part_count)
{
    struct packet *packet = mem_new(sizeof(*packet));
    atomic_init(&packet->refs, 1);
    packet->count = parts[part_count - 1].begin + parts[part_count - 1].count;
    packet->bytes = mem_try_array(packet->count, 1);
    if (!packet->bytes) {
        mem_free(packet);
        return NULL;
    }
    memcpy(packet->bytes, bytes, packet->count);
    memcpy(packet->parts, parts, (size_t)part_count * sizeof(*parts));
    packet->part_count = part_count;
    packet->codec = codec;
    packet->key = key;
    packet->frame = without_pixels(frame);
    return packet;
}

struct packet *packet_create(const struct frame *frame, enum wire_codec codec, bool key, const void *bytes, size_t count)
{
    struct packet_part whole = { .width_px = frame->width_px, .height_px = frame->height_px, .count = count };
    return make(frame, codec, key, bytes, &whole, 1);
}

struct packet *packet_create_parts(const struct frame *frame, enum wire_codec codec, const void *bytes, const struct packet_part *parts,
                                   int part_count)
{
    return make(frame, codec, false, bytes, parts, part_count);
}

struct packet *packet_ref(struct packet *packet)
{
    atomic_fetch_add_explicit(&packet->refs, 1, memory_order_relaxed);
    return packet;
}

void packet_unref(struct packet **packet_ptr)
{
    struct packet *packet = *packet_ptr;
    *packet_ptr = NULL;
    if (!packet || atomic_fetch_sub_explicit(&packet->refs, 1, memory_order_acq_rel) != 1)
        return;
    frame_unref(&packet->frame);
    mem_free(packet->bytes);
    mem_free(packet);
}
