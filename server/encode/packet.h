/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An encoded picture. Immutable; counted; one packet may be on its way to many sessions. Thread: any. */
#ifndef ENCODE_PACKET_H
#define ENCODE_PACKET_H
#include <stdatomic.h>

#include "protocol/wire.h"
#include "render/frame.h"

struct packet {
    _Atomic int refs;
    struct frame *frame; /* what it shows, without pixels (frame->bgrx is NULL) */
    enum wire_codec codec;
    bool key;
    uint8_t *bytes;
    size_t count;
    int64_t encode_ns;
};

/* Copies bytes and what the frame says. NULL: out of memory. */
struct packet *packet_create(const struct frame *frame, enum wire_codec codec, bool key, const void *bytes, size_t count);
struct packet *packet_ref(struct packet *packet);
void packet_unref(struct packet **packet); /* &NULL is fine; leaves NULL */

#endif
