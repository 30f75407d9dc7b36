/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An encoded frame. Immutable and reference-counted; one packet may be sent to many sessions. Call from any thread. */
#ifndef ENCODE_PACKET_H
#define ENCODE_PACKET_H
#include <stdatomic.h>
#include <stdbool.h>

#include "protocol/wire.h"
#include "render/frame.h"

enum { PACKET_PARTS = 8, PACKET_SHA256_BYTES = 32 };
struct packet_part { /* a rectangle of the frame, and the range of the packet's bytes that encodes it */
    int x_px, y_px, width_px, height_px;
    size_t begin, count;
};

struct packet {
    _Atomic int refs;
    struct frame *frame; /* metadata of the frame that this packet encodes, without the pixels (frame->bgrx is NULL) */
    enum wire_codec codec;
    bool key;       /* true: the packet can be decoded without earlier packets */
    bool is_signed; /* true: the packet's bytes are a signed PNG file (provenance/signed_picture.h) */
    uint8_t *bytes;
    size_t count;
    /* SHA-256 of the pixels (red, green, blue, rows from the top); only for PNG packets of frames with a record of their readings
       (render/frame_record.h) */
    uint8_t pixels_sha256[PACKET_SHA256_BYTES];
    struct packet_part parts[PACKET_PARTS];
    int part_count;
    int64_t encode_ns;
};

/* Creates a packet of the whole frame. Copies the bytes, and the frame without its pixels. Returns NULL when out of memory. */
struct packet *packet_create(const struct frame *frame, enum wire_codec codec, bool key, const void *bytes, size_t count);
/* Creates a packet of 1..PACKET_PARTS rectangles, whose bytes are contiguous. Returns NULL when out of memory. */
struct packet *packet_create_parts(const struct frame *frame, enum wire_codec codec, const void *bytes, const struct packet_part *parts,
                                   int part_count);
struct packet *packet_ref(struct packet *packet);
void packet_unref(struct packet **packet); /* drops a reference and sets *packet to NULL; accepts a pointer to NULL */

#endif
