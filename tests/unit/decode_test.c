/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decoding of Modbus registers: every data type in every byte order, from bytes written by hand, and every kind of scaling. */
#include "tests/support/test.h"

#include "value/decode.h"
#include "value/quality.h"

static struct plant_tag tag_of(enum data_type type, enum byte_order order)
{
    return (struct plant_tag){ .signal.table = TABLE_HOLDING, .signal.bit = -1, .signal.type = type, .signal.byte_order = order };
}

static struct sample decode(const struct plant_tag *tag, const uint16_t *words)
{
    struct sample sample = { .tag = -1, .value = -12345, .quality = 0xFFFFFFFF };
    decode_sample(tag, words, &sample);
    return sample;
}

static const struct {
    enum data_type type;
    enum byte_order order;
    uint16_t words[4];
    double value;
} vectors[] = {
    /* -2 = FFFE */
    { DATA_INT16, BYTE_ORDER_NONE, { 0xFFFE }, -2 },
    { DATA_INT16, BYTE_ORDER_ABCD, { 0xFFFE }, -2 },
    { DATA_INT16, BYTE_ORDER_CDAB, { 0xFFFE }, -2 },
    { DATA_INT16, BYTE_ORDER_BADC, { 0xFEFF }, -2 },
    { DATA_INT16, BYTE_ORDER_DCBA, { 0xFEFF }, -2 },
    { DATA_UINT16, BYTE_ORDER_NONE, { 0xFFFE }, 65534 },
    { DATA_UINT16, BYTE_ORDER_DCBA, { 0xFEFF }, 65534 },
    { DATA_BCD, BYTE_ORDER_NONE, { 0x1234 }, 1234 },
    { DATA_BCD, BYTE_ORDER_BADC, { 0x3412 }, 1234 },
    { DATA_BCD, BYTE_ORDER_NONE, { 0x9999 }, 9999 },
    { DATA_BCD, BYTE_ORDER_NONE, { 0x0000 }, 0 },
    { DATA_LBCD, BYTE_ORDER_ABCD, { 0x1234, 0x5678 }, 12345678 },
    { DATA_LBCD, BYTE_ORDER_CDAB, { 0x5678, 0x1234 }, 12345678 },
    { DATA_LBCD, BYTE_ORDER_BADC, { 0x3412, 0x7856 }, 12345678 },
    { DATA_LBCD, BYTE_ORDER_DCBA, { 0x7856, 0x3412 }, 12345678 },
    { DATA_LBCD, BYTE_ORDER_ABCD, { 0x9999, 0x9999 }, 99999999 },
    /* -123456789 = F8A432EB */
    { DATA_INT32, BYTE_ORDER_ABCD, { 0xF8A4, 0x32EB }, -123456789 },
    { DATA_INT32, BYTE_ORDER_CDAB, { 0x32EB, 0xF8A4 }, -123456789 },
    { DATA_INT32, BYTE_ORDER_BADC, { 0xA4F8, 0xEB32 }, -123456789 },
    { DATA_INT32, BYTE_ORDER_DCBA, { 0xEB32, 0xA4F8 }, -123456789 },
    { DATA_UINT32, BYTE_ORDER_ABCD, { 0xF8A4, 0x32EB }, 4171510507.0 },
    { DATA_UINT32, BYTE_ORDER_CDAB, { 0x32EB, 0xF8A4 }, 4171510507.0 },
    { DATA_UINT32, BYTE_ORDER_BADC, { 0xA4F8, 0xEB32 }, 4171510507.0 },
    { DATA_UINT32, BYTE_ORDER_DCBA, { 0xEB32, 0xA4F8 }, 4171510507.0 },
    /* -118.625 = C2ED4000 */
    { DATA_FLOAT32, BYTE_ORDER_ABCD, { 0xC2ED, 0x4000 }, -118.625 },
    { DATA_FLOAT32, BYTE_ORDER_CDAB, { 0x4000, 0xC2ED }, -118.625 },
    { DATA_FLOAT32, BYTE_ORDER_BADC, { 0xEDC2, 0x0040 }, -118.625 },
    { DATA_FLOAT32, BYTE_ORDER_DCBA, { 0x0040, 0xEDC2 }, -118.625 },
    /* The values in hexadecimal: 4886718345 = 0x1 2345 6789; -4886718345 = 0xFFFF FFFE DCBA 9877 (two's complement). */
    { DATA_INT64, BYTE_ORDER_ABCD, { 0xFFFF, 0xFFFE, 0xDCBA, 0x9877 }, -4886718345.0 },
    { DATA_INT64, BYTE_ORDER_CDAB, { 0x9877, 0xDCBA, 0xFFFE, 0xFFFF }, -4886718345.0 },
    { DATA_INT64, BYTE_ORDER_BADC, { 0xFFFF, 0xFEFF, 0xBADC, 0x7798 }, -4886718345.0 },
    { DATA_INT64, BYTE_ORDER_DCBA, { 0x7798, 0xBADC, 0xFEFF, 0xFFFF }, -4886718345.0 },
    { DATA_UINT64, BYTE_ORDER_ABCD, { 0x0000, 0x0001, 0x2345, 0x6789 }, 4886718345.0 },
    { DATA_UINT64, BYTE_ORDER_CDAB, { 0x6789, 0x2345, 0x0001, 0x0000 }, 4886718345.0 },
    { DATA_UINT64, BYTE_ORDER_BADC, { 0x0000, 0x0100, 0x4523, 0x8967 }, 4886718345.0 },
    { DATA_UINT64, BYTE_ORDER_DCBA, { 0x8967, 0x4523, 0x0100, 0x0000 }, 4886718345.0 },
    { DATA_UINT64, BYTE_ORDER_ABCD, { 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF }, 18446744073709551615.0 },
    /* 0.1 = 3FB999999999999A */
    { DATA_FLOAT64, BYTE_ORDER_ABCD, { 0x3FB9, 0x9999, 0x9999, 0x999A }, 0.1 },
    { DATA_FLOAT64, BYTE_ORDER_CDAB, { 0x999A, 0x9999, 0x9999, 0x3FB9 }, 0.1 },
    { DATA_FLOAT64, BYTE_ORDER_BADC, { 0xB93F, 0x9999, 0x9999, 0x9A99 }, 0.1 },
    { DATA_FLOAT64, BYTE_ORDER_DCBA, { 0x9A99, 0x9999, 0x9999, 0xB93F }, 0.1 },
};

TEST(every_type_in_every_byte_order)
{
    for (size_t i = 0; i < sizeof(vectors) / sizeof(vectors[0]); i++) {
        struct plant_tag tag = tag_of(vectors[i].type, vectors[i].order);
        struct sample sample = decode(&tag, vectors[i].words);
        if (sample.value != vectors[i].value)
            fail_msg("vector %zu: %.17g, not %.17g", i, sample.value, vectors[i].value);
        assert_int_equal(sample.quality, QUALITY_GOOD);
        assert_int_equal(sample.tag, -1); /* the caller sets the tag */
    }
}

TEST(takes_as_many_registers_as_its_type)
{
    const int widths[] = { [DATA_BIT] = 1, [DATA_INT16] = 1, [DATA_UINT16] = 1, [DATA_BCD] = 1, [DATA_INT32] = 2, [DATA_UINT32] = 2,
                           [DATA_FLOAT32] = 2, [DATA_LBCD] = 2, [DATA_INT64] = 4, [DATA_UINT64] = 4, [DATA_FLOAT64] = 4 };
    for (int type = DATA_BIT; type <= DATA_LBCD; type++) {
        struct plant_tag tag = tag_of((enum data_type)type, BYTE_ORDER_ABCD);
        assert_int_equal(decode_width(&tag), widths[type]);
        tag.signal.table = TABLE_COIL;
        assert_int_equal(decode_width(&tag), 1);
    }
}

TEST(numbers_are_decoded_as_registers_are)
{
    struct plant_tag tag = { .signal.type = DATA_FLOAT64,
                             .scale.kind = SCALING_LINEAR,
                             .scale.raw_high = 100,
                             .scale.scaled_high = 10,
                             .scale.has_range = true,
                             .scale.sentinel_count = 2,
                             .scale.sentinels = { { .number = -99 }, { .is_bits = true, .bits = 0x8000 } } };
    const struct {
        double raw, value;
        uint32_t quality;
    } numbers[] = { { 50, 5, QUALITY_GOOD }, { 120, 12, QUALITY_UNCERTAIN_UNITS_EXCEEDED }, { -99, 0, QUALITY_BAD_SENSOR_FAILURE },
                    { 32768, 0, QUALITY_BAD_SENSOR_FAILURE }, { -32768, 0, QUALITY_BAD_SENSOR_FAILURE },
                    { INFINITY, 0, QUALITY_BAD_SENSOR_FAILURE }, { NAN, 0, QUALITY_BAD_SENSOR_FAILURE } };
    struct sample sample;
    for (size_t i = 0; i < sizeof(numbers) / sizeof(*numbers); i++) {
        decode_number(&tag, numbers[i].raw, &sample);
        assert_true(sample.value == numbers[i].value && sample.quality == numbers[i].quality);
    }
    decode_number(&tag, 32768.5, &sample); /* not the integer 0x8000 */
    assert_int_equal(sample.quality, QUALITY_UNCERTAIN_UNITS_EXCEEDED);
    tag = (struct plant_tag){ .signal.type = DATA_BIT,
                              .scale.negate = true,
                              .scale.sentinel_count = 1,
                              .scale.sentinels = { { .is_bits = true, .bits = 0xFFFFFFFF } } };
    decode_number(&tag, 7, &sample);
    assert_true(sample.value == 0 && sample.quality == QUALITY_GOOD);
    decode_number(&tag, -1, &sample);
    assert_int_equal(sample.quality, QUALITY_BAD_SENSOR_FAILURE);
}

TEST(bits)
{
    struct plant_tag tag = tag_of(DATA_BIT, BYTE_ORDER_NONE);
    const uint16_t word = 0x8005;
    for (tag.signal.bit = 0; tag.signal.bit < 16; tag.signal.bit++)
        assert_true(decode(&tag, &word).value == (tag.signal.bit == 0 || tag.signal.bit == 2 || tag.signal.bit == 15));
    tag.signal.byte_order = BYTE_ORDER_BADC; /* 0x0580 */
    tag.signal.bit = 7;
    assert_true(decode(&tag, &word).value == 1);
    tag.scale.negate = true;
    assert_true(decode(&tag, &word).value == 0);

    struct plant_tag coil = { .signal.table = TABLE_COIL, .signal.type = DATA_BIT, .signal.bit = -1 };
    assert_true(decode(&coil, (uint16_t[]){ 1 }).value == 1);
    assert_true(decode(&coil, (uint16_t[]){ 0 }).value == 0);
    coil.scale.negate = true;
    assert_true(decode(&coil, (uint16_t[]){ 0 }).value == 1);
}

/* `Open Circuit` lists raw values, so `Negate Value` must not change which bit matches. */
TEST(the_failure_value_of_a_negated_bit_is_raw)
{
    struct plant_tag tag = { .signal.table = TABLE_COIL,
                             .signal.type = DATA_BIT,
                             .signal.bit = -1,
                             .scale.negate = true,
                             .scale.sentinel_count = 1,
                             .scale.sentinels = { { .number = 1 } } };
    for (uint16_t bit = 0; bit < 2; bit++) {
        uint32_t want = bit ? QUALITY_BAD_SENSOR_FAILURE : QUALITY_GOOD;
        struct sample sample;
        assert_int_equal(decode(&tag, &bit).quality, want);
        decode_number(&tag, bit, &sample);
        assert_int_equal(sample.quality, want);
    }
}

static struct plant_tag scaled(enum scaling scaling, double raw_low, double raw_high, double low, double high)
{
    struct plant_tag tag = tag_of(DATA_INT16, BYTE_ORDER_NONE);
    tag.scale.kind = scaling;
    tag.scale.raw_low = raw_low;
    tag.scale.raw_high = raw_high;
    tag.scale.scaled_low = low;
    tag.scale.scaled_high = high;
    return tag;
}

static void check_scaled(const struct plant_tag *tag, int raw, double value, uint32_t quality)
{
    struct sample sample = decode(tag, (uint16_t[]){ (uint16_t)raw });
    if (fabs(sample.value - value) > 1e-9)
        fail_msg("raw %d: %.12g, not %.12g", raw, sample.value, value);
    assert_string_equal(quality_name(sample.quality), quality_name(quality));
}

TEST(linear_scaling)
{
    struct plant_tag tag = scaled(SCALING_LINEAR, 4000, 20000, -50, 350); /* 4..20 mA in microamperes */
    check_scaled(&tag, 4000, -50, QUALITY_GOOD);
    check_scaled(&tag, 6000, 0, QUALITY_GOOD); /* exactly 0 is a reading */
    check_scaled(&tag, 12000, 150, QUALITY_GOOD);
    check_scaled(&tag, 20000, 350, QUALITY_GOOD);
    check_scaled(&tag, 20800, 370, QUALITY_UNCERTAIN_UNITS_EXCEEDED); /* extrapolates beyond the range */
    check_scaled(&tag, 3600, -60, QUALITY_UNCERTAIN_UNITS_EXCEEDED);
    tag.scale.negate = true;
    check_scaled(&tag, 12000, -150, QUALITY_GOOD);
    struct plant_tag reversed = scaled(SCALING_LINEAR, 0, 1000, 100, 0);
    check_scaled(&reversed, 250, 75, QUALITY_GOOD);
    check_scaled(&reversed, 1010, -1, QUALITY_UNCERTAIN_UNITS_EXCEEDED);
    struct plant_tag falling = scaled(SCALING_LINEAR, 1000, 0, 0, 100);
    check_scaled(&falling, 250, 75, QUALITY_GOOD);
    check_scaled(&falling, -10, 101, QUALITY_UNCERTAIN_UNITS_EXCEEDED);
}

TEST(square_root_scaling)
{
    struct plant_tag tag = scaled(SCALING_SQUARE_ROOT, 0, 10000, 0, 50); /* flow from a differential pressure */
    check_scaled(&tag, 0, 0, QUALITY_GOOD);
    check_scaled(&tag, 2500, 25, QUALITY_GOOD);
    check_scaled(&tag, 10000, 50, QUALITY_GOOD);
    check_scaled(&tag, 12100, 55, QUALITY_UNCERTAIN_UNITS_EXCEEDED);
    check_scaled(&tag, -5, 0, QUALITY_UNCERTAIN_UNITS_EXCEEDED); /* the square root of a negative value gives 0 with quality Uncertain */
}

TEST(unscaled_negation)
{
    struct plant_tag tag = tag_of(DATA_INT16, BYTE_ORDER_NONE);
    tag.scale.negate = true;
    assert_true(decode(&tag, (uint16_t[]){ 5 }).value == -5);
}

TEST(what_is_no_number_is_a_sensor_failure)
{
    const uint16_t floats[][2] = { { 0x7FC0, 0 }, { 0x7F80, 0 }, { 0xFF80, 0 } }; /* NaN, +Inf, -Inf */
    for (int i = 0; i < 3; i++) {
        struct plant_tag tag = tag_of(DATA_FLOAT32, BYTE_ORDER_ABCD);
        assert_int_equal(decode(&tag, floats[i]).quality, QUALITY_BAD_SENSOR_FAILURE);
        tag.scale.kind = SCALING_SQUARE_ROOT; /* this scaling raises negative values to 0; a NaN must stay Bad instead of becoming 0 */
        tag.scale.raw_high = tag.scale.scaled_high = 1;
        assert_int_equal(decode(&tag, floats[i]).quality, QUALITY_BAD_SENSOR_FAILURE);
        assert_true(isfinite(decode(&tag, floats[i]).value));
    }
    struct plant_tag wide = tag_of(DATA_FLOAT64, BYTE_ORDER_ABCD);
    assert_int_equal(decode(&wide, (uint16_t[]){ 0x7FF8, 0, 0, 0 }).quality, QUALITY_BAD_SENSOR_FAILURE);
    struct plant_tag bcd = tag_of(DATA_BCD, BYTE_ORDER_NONE);
    assert_int_equal(decode(&bcd, (uint16_t[]){ 0x123A }).quality, QUALITY_BAD_SENSOR_FAILURE);
    assert_int_equal(decode(&bcd, (uint16_t[]){ 0xFFFF }).quality, QUALITY_BAD_SENSOR_FAILURE);
    struct plant_tag lbcd = tag_of(DATA_LBCD, BYTE_ORDER_ABCD);
    assert_int_equal(decode(&lbcd, (uint16_t[]){ 0x1234, 0x567A }).quality, QUALITY_BAD_SENSOR_FAILURE);
}

static uint32_t quality_of_raw(struct plant_tag *tag, int raw)
{
    return decode(tag, &(uint16_t){ (uint16_t)raw }).quality;
}

/* A current loop of 4 to 20 mA, of which common analogue cards make counts from 0 to 27648 (1728 per milliampere). Currents far
   outside that range mean that the loop has failed. */
TEST(a_current_says_that_its_loop_has_failed)
{
    struct plant_tag tag = tag_of(DATA_INT16, BYTE_ORDER_NONE);
    tag.scale.kind = SCALING_LINEAR;
    tag.scale.has_range = true;
    tag.scale.raw_high = 27648;
    tag.scale.scaled_high = 100;
    /* currents only slightly outside 4 to 20 mA mean a value beyond the range, not a failed transmitter (NAMUR NE 43) */
    assert_int_equal(quality_of_raw(&tag, -691), QUALITY_UNCERTAIN_UNITS_EXCEEDED);
    tag.scale.ne43 = true;
    const struct {
        double ma;
        uint32_t quality;
    } cases[] = {
        { 0, QUALITY_BAD_SENSOR_FAILURE }, { 3.6, QUALITY_BAD_SENSOR_FAILURE }, { 3.65, QUALITY_UNCERTAIN_UNITS_EXCEEDED },
        { 3.79, QUALITY_UNCERTAIN_UNITS_EXCEEDED }, { 3.8, QUALITY_GOOD }, { 4, QUALITY_GOOD }, { 20, QUALITY_GOOD },
        { 20.5, QUALITY_GOOD },
        { 20.51, QUALITY_UNCERTAIN_UNITS_EXCEEDED }, { 20.9, QUALITY_UNCERTAIN_UNITS_EXCEEDED }, { 21, QUALITY_BAD_SENSOR_FAILURE },
        { 22, QUALITY_BAD_SENSOR_FAILURE },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++)
        assert_int_equal(quality_of_raw(&tag, (int)lrint((cases[i].ma - 4) * 1728)), cases[i].quality);
    double below = decode(&tag, &(uint16_t){ (uint16_t)lrint(-0.2 * 1728) }).value;
    assert_true(fabs(below + 1.25) < 0.01); /* 3.8 mA is below the range, but is still a measured value: -1.25 % */
}

TEST(an_open_circuit_s_value_is_no_reading)
{
    struct plant_tag tag = tag_of(DATA_INT16, BYTE_ORDER_NONE);
    assert_int_equal(quality_of_raw(&tag, 0x8000), QUALITY_GOOD); /* off by default */
    tag.scale.sentinels[0] = (struct plant_sentinel){ .is_bits = true, .bits = 0x8000 };
    tag.scale.sentinels[1] = (struct plant_sentinel){ .number = 32767 };
    tag.scale.sentinel_count = 2;
    assert_int_equal(quality_of_raw(&tag, 0x8000), QUALITY_BAD_SENSOR_FAILURE);
    assert_int_equal(quality_of_raw(&tag, 32767), QUALITY_BAD_SENSOR_FAILURE);
    assert_int_equal(quality_of_raw(&tag, 32766), QUALITY_GOOD);
    assert_int_equal(quality_of_raw(&tag, 0), QUALITY_GOOD);
    struct plant_tag number = tag_of(DATA_FLOAT32, BYTE_ORDER_CDAB);
    number.scale.sentinels[0].number = -9999;
    number.scale.sentinel_count = 1;
    assert_int_equal(decode(&number, (uint16_t[]){ 0x3C00, 0xC61C }).quality, QUALITY_BAD_SENSOR_FAILURE);
    /* A value that means "sensor failed" in the tag list. A 32-bit float cannot represent -999.9; the nearest one, C479F99A,
       must be recognised. */
    number.scale.sentinels[0].number = -999.9;
    assert_int_equal(decode(&number, (uint16_t[]){ 0xF99A, 0xC479 }).quality, QUALITY_BAD_SENSOR_FAILURE);
    assert_int_equal(decode(&number, (uint16_t[]){ 0xF99B, 0xC479 }).quality, QUALITY_GOOD);
    struct sample sample;
    decode_number(&number, (double)-999.9F, &sample); /* a value from OPC UA or Sparkplug can be a 32-bit float as well */
    assert_int_equal(sample.quality, QUALITY_BAD_SENSOR_FAILURE);
    decode_number(&number, -999.9, &sample); /* JSON */
    assert_int_equal(sample.quality, QUALITY_BAD_SENSOR_FAILURE);
}

TEST(a_range_without_scaling_is_the_instrument_s)
{
    struct plant_tag tag = tag_of(DATA_INT16, BYTE_ORDER_NONE);
    tag.scale.has_range = true;
    tag.scale.scaled_low = -50;
    tag.scale.scaled_high = 150;
    assert_int_equal(quality_of_raw(&tag, 150), QUALITY_GOOD);
    assert_int_equal(quality_of_raw(&tag, -50), QUALITY_GOOD);
    struct sample above = decode(&tag, &(uint16_t){ 151 });
    assert_true(above.quality == QUALITY_UNCERTAIN_UNITS_EXCEEDED && above.value == 151);
    assert_int_equal(quality_of_raw(&tag, -51), QUALITY_UNCERTAIN_UNITS_EXCEEDED);
    tag.scale.negate = true; /* the range applies to the value that Plantcast shows */
    assert_int_equal(quality_of_raw(&tag, -150), QUALITY_GOOD);
    assert_int_equal(quality_of_raw(&tag, -151), QUALITY_UNCERTAIN_UNITS_EXCEEDED);
    assert_int_equal(quality_of_raw(&tag, 50), QUALITY_GOOD);
    assert_int_equal(quality_of_raw(&tag, 51), QUALITY_UNCERTAIN_UNITS_EXCEEDED);
    struct sample sample;
    decode_number(&tag, -120, &sample);
    assert_true(sample.quality == QUALITY_GOOD && sample.value == 120);
}
