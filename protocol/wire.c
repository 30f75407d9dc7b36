/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes the headers of binary messages byte by byte. */
#include "protocol/wire.h"

#include <math.h>
#include <string.h>

static uint8_t *put(uint8_t *at, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        at[i] = (uint8_t)(value >> (8 * i));
    return at + bytes;
}

static uint8_t *put_f32(uint8_t *at, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof(bits));
    return put(at, bits, 4);
}

static uint8_t *put_vector(uint8_t *at, const float v[3])
{
    for (int i = 0; i < 3; i++)
        at = put_f32(at, v[i]);
    return at;
}

void wire_put_frame(const struct wire_frame *frame, uint8_t out[WIRE_FRAME_HEADER_BYTES])
{
    uint8_t *at = out;
    at = put(at, frame->type, 1);
    at = put(at, frame->codec, 1);
    at = put(at, frame->flags, 2);
    at = put(at, frame->payload_bytes, 4);
    at = put(at, frame->seq, 4);
    at = put(at, frame->camera_seq, 4);
    at = put(at, frame->params_seq, 4);
    at = put(at, frame->oldest_age_ms, 4);
    at = put(at, frame->data_time_us, 8);
    at = put(at, frame->sent_time_us, 8);
    at = put(at, frame->wait_us, 4);
    at = put(at, frame->field_us, 4);
    at = put(at, frame->render_us, 4);
    at = put(at, frame->encode_us, 4);
    at = put(at, frame->x_px, 2);
    at = put(at, frame->y_px, 2);
    at = put(at, frame->width_px, 2);
    at = put(at, frame->height_px, 2);
    at = put(at, frame->full_width_px, 2);
    at = put(at, frame->full_height_px, 2);
    at = put_vector(at, frame->eye_m);
    at = put_vector(at, frame->target_m);
    at = put_vector(at, frame->up);
    at = put_f32(at, frame->fov_deg);
    put_f32(at, frame->height_m);
}

void wire_put_depth(const struct wire_depth *depth, uint8_t out[WIRE_DEPTH_HEADER_BYTES])
{
    enum { PREDICTED_MASKS = 2 };
    uint8_t *at = out;
    at = put(at, WIRE_TYPE_DEPTH, 1);
    at = put(at, PREDICTED_MASKS, 1);
    at = put(at, depth->flags, 2);
    at = put(at, depth->payload_bytes, 4);
    at = put(at, depth->seq, 4);
    at = put(at, depth->x_px, 2);
    at = put(at, depth->y_px, 2);
    at = put(at, depth->width_px, 2);
    at = put(at, depth->height_px, 2);
    at = put(at, depth->full_width_px, 2);
    at = put(at, depth->full_height_px, 2);
    at = put(at, depth->columns, 2);
    at = put(at, depth->rows, 2);
    at = put(at, depth->cell_px, 1);
    at = put(at, depth->mask_side, 1);
    at = put(at, depth->levels, 2);
    at = put_f32(at, depth->base);
    at = put_f32(at, depth->unit);
    put(at, depth->data_bytes, 4);
}

static uint64_t get(const uint8_t **at, size_t bytes)
{
    uint64_t value = 0;
    for (size_t i = 0; i < bytes; i++)
        value |= (uint64_t)(*at)[i] << (8 * i);
    *at += bytes;
    return value;
}

static float get_f32(const uint8_t **at)
{
    uint32_t bits = (uint32_t)get(at, 4);
    float value;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

static bool get_vector(const uint8_t **at, float v[3])
{
    for (int i = 0; i < 3; i++)
        v[i] = get_f32(at);
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static bool in_range(unsigned value, unsigned low, unsigned high)
{
    return value >= low && value <= high;
}

static bool rectangle_valid(const struct wire_frame *frame)
{
    return in_range(frame->full_width_px, 1, WIRE_MAX_FRAME_PX) && in_range(frame->full_height_px, 1, WIRE_MAX_FRAME_PX) &&
           frame->width_px > 0 && frame->height_px > 0 && frame->x_px + frame->width_px <= frame->full_width_px &&
           frame->y_px + frame->height_px <= frame->full_height_px;
}

/* Reads the field of view and the height of an orthographic picture. For a perspective picture the height is reserved and may have any
   value. Returns false if either is out of range. */
static bool get_lens(const uint8_t **at, struct wire_frame *frame)
{
    frame->fov_deg = get_f32(at);
    frame->height_m = get_f32(at);
    if (frame->fov_deg == 0)
        return isfinite(frame->height_m) && frame->height_m > 0;
    frame->height_m = 0;
    return frame->fov_deg >= 1 && frame->fov_deg <= 120;
}

bool wire_get_frame(const uint8_t *bytes, size_t count, struct wire_frame *frame)
{
    if (count < WIRE_FRAME_HEADER_BYTES)
        return false;
    const uint8_t *at = bytes;
    frame->type = (uint8_t)get(&at, 1);
    frame->codec = (uint8_t)get(&at, 1);
    frame->flags = (uint16_t)get(&at, 2);
    frame->payload_bytes = (uint32_t)get(&at, 4);
    frame->seq = (uint32_t)get(&at, 4);
    frame->camera_seq = (uint32_t)get(&at, 4);
    frame->params_seq = (uint32_t)get(&at, 4);
    frame->oldest_age_ms = (uint32_t)get(&at, 4);
    frame->data_time_us = get(&at, 8);
    frame->sent_time_us = get(&at, 8);
    frame->wait_us = (uint32_t)get(&at, 4);
    frame->field_us = (uint32_t)get(&at, 4);
    frame->render_us = (uint32_t)get(&at, 4);
    frame->encode_us = (uint32_t)get(&at, 4);
    frame->x_px = (uint16_t)get(&at, 2);
    frame->y_px = (uint16_t)get(&at, 2);
    frame->width_px = (uint16_t)get(&at, 2);
    frame->height_px = (uint16_t)get(&at, 2);
    frame->full_width_px = (uint16_t)get(&at, 2);
    frame->full_height_px = (uint16_t)get(&at, 2);
    bool finite = get_vector(&at, frame->eye_m);
    finite &= get_vector(&at, frame->target_m);
    finite &= get_vector(&at, frame->up);
    bool lens = get_lens(&at, frame);
    return finite && lens && frame->type == WIRE_TYPE_FRAME && in_range(frame->codec, WIRE_CODEC_JPEG, WIRE_CODEC_H264) && frame->seq > 0 &&
           rectangle_valid(frame) && in_range(frame->payload_bytes, 1, WIRE_MAX_PAYLOAD_BYTES) &&
           count - WIRE_FRAME_HEADER_BYTES == frame->payload_bytes;
}

bool wire_is_given_up(const uint8_t bytes[WIRE_FRAME_HEADER_BYTES], size_t count)
{
    uint32_t payload = 0;
    for (int i = 3; count >= WIRE_FRAME_HEADER_BYTES && i >= 0; i--)
        payload = payload << 8 | bytes[4 + i];
    return payload > count - WIRE_FRAME_HEADER_BYTES && payload <= WIRE_MAX_PAYLOAD_BYTES;
}
