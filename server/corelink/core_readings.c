/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts the current readings to bytes and back, little-endian: "PCR1", number of readings, the core's UTC and monotonic
   clocks; then for each reading: tag, quality, value, age, source time. */
#include "corelink/core_readings.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "corelink/little_endian.h"
#include "value/quality.h"

enum { DRIFT = 5000 /* maximum drift between the clocks of two machines: 1 ns in DRIFT ns */ };
static const char MAGIC[4] = { 'P', 'C', 'R', '1' };

void core_sent_init(struct core_sent *sent, size_t tag_count)
{
    *sent = (struct core_sent){ .count = tag_count, .at = mem_array(tag_count, sizeof(*sent->at)) };
}

void core_sent_finish(struct core_sent *sent)
{
    mem_free(sent->at);
    *sent = (struct core_sent){ 0 };
}

static void write_reading(struct text *out, uint32_t tag, const struct reading *reading)
{
    uint8_t bytes[CORE_READING_BYTES];
    uint64_t value;
    memcpy(&value, &reading->value, sizeof(value));
    put32(bytes, tag);
    put32(bytes + 4, reading->quality);
    put64(bytes + 8, value);
    put64(bytes + 16, (uint64_t)reading->age_ns);
    put64(bytes + 24, (uint64_t)reading->received_utc_ns);
    text_add_bytes(out, bytes, sizeof(bytes));
}

void core_readings_write(struct text *out, const struct snapshot *snapshot, struct core_sent *sent)
{
    uint8_t head[CORE_READINGS_HEAD_BYTES];
    size_t begin = out->length;
    uint32_t count = 0;
    memcpy(head, MAGIC, sizeof(MAGIC));
    put32(head + 4, 0);
    put64(head + 8, (uint64_t)snapshot->taken_utc_ns);
    put64(head + 16, (uint64_t)snapshot->taken_mono_ns);
    text_add_bytes(out, head, sizeof(head));
    for (size_t i = 0; i < sent->count; i++) {
        const struct reading *reading = &snapshot->readings[i];
        struct core_sent_reading *before = &sent->at[i];
        if (before->sent && before->changes == reading->changes && before->received_utc_ns == reading->received_utc_ns)
            continue;
        *before = (struct core_sent_reading){ reading->changes, reading->received_utc_ns, true };
        write_reading(out, (uint32_t)i, reading);
        count++;
    }
    put32((uint8_t *)out->at + begin + 4, count);
}

static const char *read_one(struct mirrored *out, size_t tag_count, const uint8_t *at, int64_t now_mono_ns)
{
    uint32_t tag = get32(at);
    uint64_t value = get64(at + 8);
    int64_t age_ns = (int64_t)get64(at + 16);
    if (tag >= tag_count)
        return "the core's message has a reading of an unknown tag: copy the core's tag list to this machine, then reload";
    *out = (struct mirrored){ .tag = (int)tag, .quality = get32(at + 4), .received_utc_ns = (int64_t)get64(at + 24) };
    memcpy(&out->value, &value, sizeof(value));
    out->has_value = age_ns != INT64_MAX;
    if (age_ns < 0 || (out->has_value && (age_ns > now_mono_ns + INT64_C(1000000000) * 86400 * 3650 || !isfinite(out->value))) ||
        (!out->has_value && !quality_is_bad(out->quality)))
        return "the core's message has an invalid reading; do both nodes run the same version?";
    out->received_mono_ns = out->has_value ? now_mono_ns - age_ns : 0;
    return NULL;
}

const char *core_readings_read(struct core_readings *out, size_t tag_count, const void *bytes, size_t count, int64_t now_mono_ns)
{
    const uint8_t *at = bytes;
    if (count < CORE_READINGS_HEAD_BYTES || memcmp(at, MAGIC, sizeof(MAGIC)) != 0)
        return "the core's message is not a list of readings; do both nodes run the same version?";
    out->count = get32(at + 4);
    out->utc_ns = (int64_t)get64(at + 8);
    if (out->count > tag_count || count != CORE_READINGS_HEAD_BYTES + out->count * CORE_READING_BYTES)
        return "the length of the core's message does not match the number of readings in the message; do both nodes run the same version?";
    int64_t core_mono_ns = (int64_t)get64(at + 16);
    if (core_mono_ns < 0)
        return "the core's message has an invalid clock time; do both nodes run the same version?";
    int64_t ahead_ns = now_mono_ns - core_mono_ns;
    if (out->least_ns != INT64_MAX && now_mono_ns > out->at_ns)
        out->least_ns += (now_mono_ns - out->at_ns) / DRIFT;
    out->least_ns = ahead_ns < out->least_ns ? ahead_ns : out->least_ns;
    out->at_ns = now_mono_ns;
    out->late_ns = ahead_ns - out->least_ns;
    for (size_t i = 0; i < out->count; i++) {
        const char *why =
            read_one(&out->at[i], tag_count, at + CORE_READINGS_HEAD_BYTES + i * CORE_READING_BYTES, now_mono_ns - out->late_ns);
        if (why)
            return why;
    }
    return NULL;
}
