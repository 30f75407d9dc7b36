/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Byte order, data type, scaling: from registers to engineering units. */
#include "value/decode.h"

#include <math.h>
#include <string.h>

#include "value/quality.h"

static bool is_bit(const struct plant_tag *tag)
{
    return tag->table == TABLE_COIL || tag->table == TABLE_DISCRETE || tag->bit >= 0 || tag->type == DATA_BIT;
}

int decode_width(const struct plant_tag *tag)
{
    if (is_bit(tag))
        return 1;
    switch (tag->type) {
    case DATA_INT32:
    case DATA_UINT32:
    case DATA_FLOAT32:
    case DATA_LBCD:
        return 2;
    case DATA_INT64:
    case DATA_UINT64:
    case DATA_FLOAT64:
        return 4;
    default:
        return 1;
    }
}

/* The named order is that of the bytes on the wire, A the most significant: so B first means swapped within each word, and
   C or D first means that the least significant word comes first. */
static uint64_t join_words(enum byte_order order, const uint16_t *words, int count)
{
    bool swap_bytes = order == BYTE_ORDER_BADC || order == BYTE_ORDER_DCBA;
    bool low_word_first = order == BYTE_ORDER_CDAB || order == BYTE_ORDER_DCBA;
    uint64_t joined = 0;
    for (int i = 0; i < count; i++) {
        uint16_t word = words[low_word_first ? count - 1 - i : i];
        if (swap_bytes)
            word = (uint16_t)(word << 8 | word >> 8);
        joined = joined << 16 | word;
    }
    return joined;
}

static double float_of(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof(value));
    return (double)value;
}

static double double_of(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

static double bcd_of(uint32_t digits)
{
    double value = 0;
    for (int shift = 28; shift >= 0; shift -= 4) {
        unsigned digit = digits >> shift & 15;
        if (digit > 9)
            return NAN;
        value = value * 10 + digit;
    }
    return value;
}

static double raw_of(const struct plant_tag *tag, const uint16_t *words)
{
    uint64_t joined = join_words(tag->byte_order, words, decode_width(tag));
    switch (tag->type) {
    case DATA_INT16:
        return (int16_t)joined;
    case DATA_INT32:
        return (int32_t)joined;
    case DATA_INT64:
        return (double)(int64_t)joined;
    case DATA_FLOAT32:
        return float_of((uint32_t)joined);
    case DATA_FLOAT64:
        return double_of(joined);
    case DATA_BCD:
    case DATA_LBCD:
        return bcd_of((uint32_t)joined);
    default:
        return (double)joined;
    }
}

static double bit_of(const struct plant_tag *tag, uint16_t word)
{
    bool in_register = tag->table == TABLE_INPUT || tag->table == TABLE_HOLDING;
    if (in_register)
        word = (uint16_t)join_words(tag->byte_order, &word, 1);
    bool set = in_register && tag->bit >= 0 ? word >> tag->bit & 1 : word != 0;
    return set != tag->negate;
}

static bool beyond(double raw, double a, double b)
{
    return raw < fmin(a, b) || raw > fmax(a, b);
}

static double scale(const struct plant_tag *tag, double raw)
{
    double part = (raw - tag->raw_low) / (tag->raw_high - tag->raw_low);
    if (tag->scaling == SCALING_SQUARE_ROOT)
        part = part > 0 ? sqrt(part) : 0;
    return tag->scaled_low + part * (tag->scaled_high - tag->scaled_low);
}

void decode_sample(const struct plant_tag *tag, const uint16_t *words, struct sample *out)
{
    double value = is_bit(tag) ? bit_of(tag, words[0]) : raw_of(tag, words);
    out->quality = QUALITY_GOOD;
    if (!isfinite(value)) { /* before scaling, which would hide it */
        out->value = 0;
        out->quality = QUALITY_BAD_SENSOR_FAILURE;
        return;
    }
    if (!is_bit(tag) && tag->scaling != SCALING_NONE) {
        if (beyond(value, tag->raw_low, tag->raw_high))
            out->quality = QUALITY_UNCERTAIN_UNITS_EXCEEDED;
        value = scale(tag, value);
    }
    if (!is_bit(tag) && tag->negate)
        value = -value;
    out->value = isfinite(value) ? value : 0;
    if (!isfinite(value))
        out->quality = QUALITY_BAD_SENSOR_FAILURE;
}
