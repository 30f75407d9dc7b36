/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes and decodes the headers of the binary messages of plantcast.v1 (PROTOCOL.md). Pure. Call from any thread. */
#ifndef PROTOCOL_WIRE_H
#define PROTOCOL_WIRE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define WIRE_SUBPROTOCOL "plantcast.v1"
#define WIRE_FRAME_HEADER_BYTES 112u
#define WIRE_DEPTH_HEADER_BYTES 44u
#define WIRE_MAX_MESSAGE_BYTES 65536u /* largest text message in bytes that a client may send */
#define WIRE_MAX_FRAME_PX 8192u       /* largest width or height */
#define WIRE_MAX_PAYLOAD_BYTES (64u * 1024 * 1024)
#define WIRE_NO_AGE UINT32_MAX

enum wire_type { WIRE_TYPE_FRAME = 1, WIRE_TYPE_DEPTH = 2 };
enum wire_codec { WIRE_CODEC_JPEG = 1, WIRE_CODEC_PNG = 2, WIRE_CODEC_H264 = 3 };
enum wire_flags {
    WIRE_FLAG_KEY = 1,
    WIRE_FLAG_STILL = 2,
    WIRE_FLAG_NO_LIVE_DATA = 4,
    WIRE_FLAG_MORE = 8,
    WIRE_FLAG_DATA = 16,
    WIRE_FLAG_PAST = 32,
    WIRE_FLAG_SIGNED = 64,
    WIRE_FLAG_DEPTH = 128,
};
enum wire_depth_flags { WIRE_DEPTH_ORTHOGRAPHIC = 1, WIRE_DEPTH_MORE = 2 };

struct wire_frame { /* header of the binary message with a frame; the members are in the order of the bytes in the message */
    uint8_t type, codec;
    uint16_t flags;
    uint32_t payload_bytes;
    uint32_t seq;
    /* sequence numbers of the client's newest `camera` and `params` messages whose content this frame shows */
    uint32_t camera_seq, params_seq;
    uint32_t oldest_age_ms; /* age of the oldest reading that the frame shows; WIRE_NO_AGE: it shows no reading */
    /* time of the readings, and time when the frame was sent: microseconds since 1970, UTC, by the server's clock */
    uint64_t data_time_us, sent_time_us;
    /* durations in microseconds: from client input to start of rendering, computing the field, rendering, encoding */
    uint32_t wait_us, field_us, render_us, encode_us;
    uint16_t x_px, y_px, width_px, height_px; /* rectangle of the view, in pixels, whose picture is the payload */
    uint16_t full_width_px, full_height_px;
    /* camera of this frame in plant coordinates: position of the eye, point that it looks at, up direction; metres */
    float eye_m[3], target_m[3], up[3];
    float fov_deg;                      /* vertical field of view in degrees, 1..120; 0: orthographic, and height_m applies */
    float height_m;                     /* height of the visible area of an orthographic picture, metres; 0: perspective */
};

/* header of a depth grid, a message with the distances of a picture's surfaces; its bytes, after type and encoding, are in this order */
struct wire_depth {
    uint16_t flags;
    uint32_t payload_bytes, seq;
    uint16_t x_px, y_px, width_px, height_px; /* rectangle of the picture, in pixels, that the grid covers */
    uint16_t full_width_px, full_height_px;
    uint16_t columns, rows; /* of cells */
    uint8_t cell_px, mask_side;
    uint16_t levels; /* largest code */
    /* base: depth that the code 1 means; unit: difference of depth between two successive codes; both in 1/m (perspective) or m
       (orthographic) */
    float base, unit;
    uint32_t data_bytes; /* size of the inflated payload */
};

/* Writes a header. */
void wire_put_depth(const struct wire_depth *depth, uint8_t out[WIRE_DEPTH_HEADER_BYTES]);
void wire_put_frame(const struct wire_frame *frame, uint8_t out[WIRE_FRAME_HEADER_BYTES]);
/* Reads the header of a message. bytes: the whole message, header and payload. Checks length, ranges and finiteness; accepts unknown flags.
   Returns false if the message is no frame of this protocol; *frame is then undefined. */
bool wire_get_frame(const uint8_t *bytes, size_t count, struct wire_frame *frame);
/* Returns true if a message of `count` bytes is a frame that the server cut short: the message is shorter than its header says. */
bool wire_is_given_up(const uint8_t bytes[WIRE_FRAME_HEADER_BYTES], size_t count);

#endif
