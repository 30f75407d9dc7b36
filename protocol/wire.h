/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes and decodes the binary frame header of plantcast.v1 (PROTOCOL.md). Pure. Thread: any. */
#ifndef PROTOCOL_WIRE_H
#define PROTOCOL_WIRE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define WIRE_SUBPROTOCOL "plantcast.v1"
#define WIRE_FRAME_HEADER_BYTES 112u
#define WIRE_MAX_MESSAGE_BYTES 65536u  /* of a client's text message */
#define WIRE_MAX_FRAME_PX 8192u        /* a side */
#define WIRE_MAX_PAYLOAD_BYTES (64u * 1024 * 1024)
#define WIRE_NO_AGE UINT32_MAX

enum wire_type { WIRE_TYPE_FRAME = 1 };
enum wire_codec { WIRE_CODEC_JPEG = 1, WIRE_CODEC_PNG = 2, WIRE_CODEC_H264 = 3 };
enum wire_flags {
    WIRE_FLAG_KEY = 1,
    WIRE_FLAG_STILL = 2,
    WIRE_FLAG_NO_LIVE_DATA = 4,
    WIRE_FLAG_MORE = 8,
    WIRE_FLAG_DATA = 16,
    WIRE_FLAG_PAST = 32,
    WIRE_FLAG_SIGNED = 64,
};

struct wire_frame { /* in the order of the bytes */
    uint8_t type, codec;
    uint16_t flags;
    uint32_t payload_bytes;
    uint32_t seq;
    uint32_t camera_seq, params_seq;  /* the client's newest camera and parameters that this picture shows */
    uint32_t oldest_age_ms;           /* of the readings that the field is computed from; WIRE_NO_AGE: none */
    uint64_t data_time_us, sent_time_us; /* UTC since 1970, server's clock */
    uint32_t wait_us, field_us, render_us, encode_us; /* input to start of render, then the stages */
    uint16_t x_px, y_px, width_px, height_px;  /* the part of the picture that the payload holds */
    uint16_t full_width_px, full_height_px;
    float eye_m[3], target_m[3], up[3]; /* the camera it was drawn with; plant frame */
    float fov_deg;                      /* vertical, 1..120; 0: orthographic, and the picture is height_m high */
    float height_m;                     /* 0 in perspective */
};

/* Writes a header. */
void wire_put_frame(const struct wire_frame *frame, uint8_t out[WIRE_FRAME_HEADER_BYTES]);
/* Reads the header of a message; bytes: the whole message, header and payload. Checks length, ranges and finiteness; accepts unknown flags.
   Returns false if it is no frame of this protocol; *frame is then undefined. */
bool wire_get_frame(const uint8_t *bytes, size_t count, struct wire_frame *frame);
/* Returns whether the message that begins so, and has `count` bytes in all, is a frame that the server gave up: shorter than its header
   says. */
bool wire_is_given_up(const uint8_t bytes[WIRE_FRAME_HEADER_BYTES], size_t count);

#endif
