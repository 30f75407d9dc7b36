/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes a value as a device does: reverses the scaling, splits the result into bytes (most significant first), and arranges
   them in the tag's byte order. */
#include "sim_encode.h"

#include <math.h>
#include <string.h>

/* For each byte order: which byte of the value (A the most significant) is at each position on the wire. */
static const char *const places_16[] = { "AB", "AB", "AB", "BA", "BA" };
static const char *const places_32[] = { "ABCD", "ABCD", "CDAB", "BADC", "DCBA" };
static const char *const places_64[] = { "ABCDEFGH", "ABCDEFGH", "GHEFCDAB", "BADCFEHG", "HGFEDCBA" };

int sim_encode_width(const struct plant_tag *tag)
{
    static const int widths[] = {
        [DATA_BIT] = 1,    [DATA_INT16] = 1, [DATA_UINT16] = 1, [DATA_BCD] = 1,    [DATA_INT32] = 2, [DATA_UINT32] = 2,
        [DATA_FLOAT32] = 2, [DATA_LBCD] = 2, [DATA_INT64] = 4,  [DATA_UINT64] = 4, [DATA_FLOAT64] = 4,
    };
    bool one_bit = tag->signal.table == TABLE_COIL || tag->signal.table == TABLE_DISCRETE || tag->signal.bit >= 0;
    return one_bit ? 1 : widths[tag->signal.type];
}

static double unscale(const struct tag_scale *scale, double value)
{
    if (scale->negate)
        value = -value;
    if (scale->kind == SCALING_NONE)
        return value;
    double share = (value - scale->scaled_low) / (scale->scaled_high - scale->scaled_low);
    if (scale->kind == SCALING_SQUARE_ROOT)
        share = share < 0 ? 0 : share * share;
    return scale->raw_low + share * (scale->raw_high - scale->raw_low);
}

double sim_encode_raw(const struct plant_tag *tag, double value)
{
    return tag->signal.type == DATA_BIT ? (value != 0) != tag->scale.negate : unscale(&tag->scale, value);
}

static uint64_t whole(double raw, double low, double high)
{
    raw = nearbyint(raw);
    if (raw <= low)
        raw = low;
    if (raw >= high) /* the maxima 2^63 - 1 and 2^64 - 1 are not representable as double, so compare before converting */
        return high >= 18446744073709551615.0 ? UINT64_MAX : high >= 9223372036854775807.0 ? INT64_MAX : (uint64_t)high;
    return raw < 0 ? (uint64_t)(int64_t)raw : (uint64_t)raw;
}

static uint64_t bcd(uint64_t number)
{
    uint64_t digits = 0;
    for (int shift = 0; number; shift += 4, number /= 10)
        digits |= number % 10 << shift;
    return digits;
}

/* Returns the bits of the raw value, right-aligned. */
static uint64_t bits_of(enum data_type type, double raw)
{
    uint64_t bits = 0;
    float single = (float)raw;
    switch (type) {
    case DATA_INT16: return whole(raw, -32768, 32767);
    case DATA_UINT16: return whole(raw, 0, 65535);
    case DATA_INT32: return whole(raw, -2147483648.0, 2147483647.0);
    case DATA_UINT32: return whole(raw, 0, 4294967295.0);
    case DATA_INT64: return whole(raw, -9223372036854775808.0, 9223372036854775807.0);
    case DATA_UINT64: return whole(raw, 0, 18446744073709551615.0);
    case DATA_BCD: return bcd(whole(raw, 0, 9999));
    case DATA_LBCD: return bcd(whole(raw, 0, 99999999));
    case DATA_FLOAT32: memcpy(&bits, &single, sizeof(single)); return bits;
    case DATA_FLOAT64: memcpy(&bits, &raw, sizeof(raw)); return bits;
    default: return raw != 0;
    }
}

static void place(const char *places, uint64_t bits, uint16_t *words)
{
    int count = (int)strlen(places);
    for (int i = 0; i < count; i++) {
        int shift = 8 * (count - 1 - (places[i] - 'A'));
        uint16_t byte = bits >> shift & 0xFF;
        words[i / 2] = (uint16_t)(i % 2 ? words[i / 2] | byte : byte << 8);
    }
}

static void encode_bit(const struct plant_tag *tag, bool on, uint16_t *word)
{
    bool swapped = tag->signal.byte_order == BYTE_ORDER_BADC || tag->signal.byte_order == BYTE_ORDER_DCBA;
    int bit = swapped ? tag->signal.bit ^ 8 : tag->signal.bit;
    *word = (uint16_t)(tag->signal.bit < 0 ? on : (*word & ~(1u << bit)) | (unsigned)on << bit);
}

bool sim_encode(const struct plant_tag *tag, double value, uint16_t *words)
{
    enum data_type type = tag->signal.type;
    bool one_bit = tag->signal.table == TABLE_COIL || tag->signal.table == TABLE_DISCRETE || tag->signal.bit >= 0 || type == DATA_BIT;
    bool holds_nan = !one_bit && (type == DATA_FLOAT32 || type == DATA_FLOAT64);
    if (!isfinite(value) && !holds_nan)
        return false;
    if (one_bit) {
        encode_bit(tag, (value != 0) != tag->scale.negate, words);
        return true;
    }
    const char *const *places = sim_encode_width(tag) == 4 ? places_64 : sim_encode_width(tag) == 2 ? places_32 : places_16;
    place(places[tag->signal.byte_order], bits_of(type, isfinite(value) ? unscale(&tag->scale, value) : value), words);
    return true;
}
