/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts a device's registers to readings: byte order, data type, scaling, unit. */
#include "value/decode.h"

#include <math.h>
#include <string.h>

#include "plant/sources/address.h"
#include "value/quality.h"

static bool is_bit(const struct tag_signal *signal)
{
    return signal->table == TABLE_COIL || signal->table == TABLE_DISCRETE || signal->bit >= 0 || signal->type == DATA_BIT;
}

int decode_width(const struct plant_tag *tag)
{
    return is_bit(&tag->signal) ? 1 : data_type_registers(tag->signal.type);
}

/* Joins 16-bit registers to one number. A byte order such as ABCD names the bytes in their order on the wire, where A is the most
   significant byte. If B or D comes first, the bytes within each register are swapped. If C or D comes first, the least significant
   register comes first. */
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
    uint64_t joined = join_words(tag->signal.byte_order, words, decode_width(tag));
    switch (tag->signal.type) {
    case DATA_INT16: return (int16_t)joined;
    case DATA_INT32: return (int32_t)joined;
    case DATA_INT64: return (double)(int64_t)joined;
    case DATA_FLOAT32: return float_of((uint32_t)joined);
    case DATA_FLOAT64: return double_of(joined);
    case DATA_BCD:
    case DATA_LBCD: return bcd_of((uint32_t)joined);
    default: return (double)joined;
    }
}

/* Returns the bit of a tag as the device sent it: 0 or 1, before `negate`. */
static bool raw_bit_of(const struct plant_tag *tag, uint16_t word)
{
    bool in_register = tag->signal.table == TABLE_INPUT || tag->signal.table == TABLE_HOLDING;
    if (in_register)
        word = (uint16_t)join_words(tag->signal.byte_order, &word, 1);
    return in_register && tag->signal.bit >= 0 ? word >> tag->signal.bit & 1 : word != 0;
}

static bool beyond(double raw, double a, double b)
{
    return raw < fmin(a, b) || raw > fmax(a, b);
}

/* Returns true if a published number has these bits as an unsigned or signed integer of 16, 32 or 64 bits. */
static bool has_bits(double raw, uint64_t bits)
{
    int64_t number = bits <= UINT16_MAX ? (int16_t)bits : bits <= UINT32_MAX ? (int32_t)bits : (int64_t)bits;
    return raw == (double)bits || raw == (double)number;
}

/* Returns true if a device's value is this number, or the nearest 32-bit float: a device that sends 32-bit floats sends -999.9 as
   -999.90002. */
static bool is_number(double raw, double number)
{
    return raw == number || raw == (double)(float)number;
}

/* Returns true if a device's value is one of the special values that report a failure, such as an open circuit. bits: the bits
   of the registers; NULL: the source received a number instead of registers. */
static bool is_sentinel(const struct tag_scale *scale, const uint64_t *bits, double raw)
{
    for (int i = 0; i < scale->sentinel_count; i++) {
        const struct plant_sentinel *sentinel = &scale->sentinels[i];
        if (!sentinel->is_bits ? is_number(raw, sentinel->number) : bits ? sentinel->bits == *bits : has_bits(raw, sentinel->bits))
            return true;
    }
    return false;
}

/* Returns the quality of a current in mA by NAMUR NE 43. From 3.8 to 20.5 mA it is a measurement. At most 3.6 or at least 21 mA
 * means that the transmitter or its loop has failed. */
static uint32_t judge_current(const struct tag_scale *scale, double raw)
{
    static const double MEASURED_LOW_MA = 3.8, MEASURED_HIGH_MA = 20.5, FAILED_LOW_MA = 3.6, FAILED_HIGH_MA = 21;
    double ma = 4 + 16 * (raw - scale->raw_low) / (scale->raw_high - scale->raw_low);
    /* tolerance for the transmitter's rounding: half a step of the integer that the device sends, converted to mA */
    double half_step_ma = 8 / (scale->raw_high - scale->raw_low);
    double rounding_ma = half_step_ma < 0.05 ? half_step_ma : 0;
    if (ma <= FAILED_LOW_MA + rounding_ma || ma >= FAILED_HIGH_MA - rounding_ma)
        return QUALITY_BAD_SENSOR_FAILURE;
    return ma < MEASURED_LOW_MA - rounding_ma || ma > MEASURED_HIGH_MA + rounding_ma ? QUALITY_UNCERTAIN_UNITS_EXCEEDED : QUALITY_GOOD;
}

/* Returns the quality of a value by the instrument's range. raw: the number that the device sent; value: the number after
   scaling and negation, in the tag's own unit. */
static uint32_t judge_range(const struct tag_scale *scale, double raw, double value)
{
    if (scale->ne43)
        return judge_current(scale, raw);
    if (scale->kind != SCALING_NONE ? beyond(raw, scale->raw_low, scale->raw_high)
                                    : scale->has_range && beyond(value, scale->scaled_low, scale->scaled_high))
        return QUALITY_UNCERTAIN_UNITS_EXCEEDED;
    return QUALITY_GOOD;
}

static double scaled(const struct tag_scale *scale, double raw)
{
    double part = (raw - scale->raw_low) / (scale->raw_high - scale->raw_low);
    if (scale->kind == SCALING_SQUARE_ROOT)
        part = part > 0 ? sqrt(part) : 0;
    return scale->scaled_low + part * (scale->scaled_high - scale->scaled_low);
}

static void fail(struct sample *out)
{
    out->value = 0;
    out->quality = QUALITY_BAD_SENSOR_FAILURE;
}

/* Decodes a numeric value: scaling, unit and quality. raw: the number that the device sent; bits: as in is_sentinel(). */
static void decode_analog(const struct tag_scale *scale, const uint64_t *bits, double raw, struct sample *out)
{
    /* recognises special values, which report a failure, before scaling: once scaled, they would look like measurements */
    if (!isfinite(raw) || is_sentinel(scale, bits, raw)) {
        fail(out);
        return;
    }
    double value = scale->kind == SCALING_NONE ? raw : scaled(scale, raw);
    if (scale->negate)
        value = -value;
    out->value = unit_change_value(&scale->change, value);
    out->quality = judge_range(scale, raw, value);
    if (!isfinite(out->value))
        fail(out);
}

/* Decodes a bit. bits and raw: as in decode_analog(). Special values are compared before `negate`, because they are raw values. */
static void decode_bit(const struct tag_scale *scale, const uint64_t *bits, double raw, struct sample *out)
{
    out->value = (raw != 0) != scale->negate;
    out->quality = QUALITY_GOOD;
    if (!isfinite(raw) || is_sentinel(scale, bits, raw))
        fail(out);
}

void decode_sample(const struct plant_tag *tag, const uint16_t *words, struct sample *out)
{
    uint64_t bits = join_words(tag->signal.byte_order, words, decode_width(tag));
    if (is_bit(&tag->signal))
        decode_bit(&tag->scale, &bits, raw_bit_of(tag, words[0]), out);
    else
        decode_analog(&tag->scale, &bits, raw_of(tag, words), out);
}

void decode_number(const struct plant_tag *tag, double raw, struct sample *out)
{
    if (tag->signal.type == DATA_BIT)
        decode_bit(&tag->scale, NULL, raw, out);
    else
        decode_analog(&tag->scale, NULL, raw, out);
}

uint32_t decode_quality(const struct plant_tag *tag, double value)
{
    return isfinite(value) ? judge_range(&tag->scale, value, value) : QUALITY_BAD_SENSOR_FAILURE;
}
