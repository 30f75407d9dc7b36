/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts the readings at a past instant to bytes and back, little-endian: "PCI1", number of readings, start of the history;
   then for each tag in the plant's order: quality, alarm and its state, value, age, source time. */
#include "corelink/core_instant.h"

#include <endian.h>
#include <math.h>
#include <string.h>

#include "value/alarm.h"
#include "value/quality.h"

static const char MAGIC[4] = { 'P', 'C', 'I', '1' };

static void put(uint8_t *at, uint64_t value, size_t bytes)
{
    value = htole64(value);
    memcpy(at, &value, bytes);
}

static uint64_t get(const uint8_t *at, size_t bytes)
{
    uint64_t value = 0;
    memcpy(&value, at, bytes);
    return le64toh(value);
}

void core_instant_write(struct text *out, int64_t first_us, const struct snapshot *snapshot)
{
    uint8_t head[CORE_INSTANT_HEAD_BYTES];
    size_t count = snapshot ? snapshot->count : 0;
    memcpy(head, MAGIC, sizeof(MAGIC));
    put(head + 4, count, 4);
    put(head + 8, (uint64_t)first_us, 8);
    text_add_bytes(out, head, sizeof(head));
    for (size_t i = 0; i < count; i++) {
        const struct reading *reading = &snapshot->readings[i];
        uint8_t bytes[CORE_INSTANT_READING_BYTES] = { 0 };
        uint64_t value;
        memcpy(&value, &reading->value, sizeof(value));
        put(bytes, reading->quality, 4);
        bytes[4] = reading->alarm;
        bytes[5] = reading->alarm_status;
        put(bytes + 8, value, 8);
        put(bytes + 16, (uint64_t)reading->age_ns, 8);
        put(bytes + 24, (uint64_t)reading->received_utc_ns, 8);
        text_add_bytes(out, bytes, sizeof(bytes));
    }
}

static bool read_one(const uint8_t *at, struct reading *out)
{
    uint64_t value = get(at + 8, 8);
    *out = (struct reading){ .quality = (uint32_t)get(at, 4),
                             .alarm = at[4],
                             .alarm_status = at[5],
                             .age_ns = (int64_t)get(at + 16, 8),
                             .received_utc_ns = (int64_t)get(at + 24, 8) };
    memcpy(&out->value, &value, sizeof(value));
    return out->age_ns >= 0 && out->alarm < ALARM_KINDS && out->alarm_status < ALARM_STATUSES &&
           (quality_is_bad(out->quality) || isfinite(out->value));
}

const char *core_instant_read(const void *bytes, size_t count, int64_t *first_us, struct snapshot *snapshot)
{
    const uint8_t *at = bytes;
    if (count < CORE_INSTANT_HEAD_BYTES || memcmp(at, MAGIC, sizeof(MAGIC)) != 0)
        return "the core's answer has an unknown format; do both nodes run the same version?";
    size_t readings = get(at + 4, 4);
    *first_us = (int64_t)get(at + 8, 8);
    if (*first_us < 0 || count != CORE_INSTANT_HEAD_BYTES + readings * CORE_INSTANT_READING_BYTES)
        return "the length of the core's answer does not match the number of readings in the answer; do both nodes run the same version?";
    if (snapshot && readings != snapshot->count)
        return "the core's answer has readings of more or fewer tags than this plant has: copy the core's plant file and tag list to "
               "this machine, then reload";
    for (size_t i = 0; snapshot && i < readings; i++)
        if (!read_one(at + CORE_INSTANT_HEAD_BYTES + i * CORE_INSTANT_READING_BYTES, &snapshot->readings[i]))
            return "the core's answer has an invalid reading; do both nodes run the same version?";
    return NULL;
}
